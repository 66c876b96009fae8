"""A worker as its parent sees it: a process, the connection to it, the job that it was given."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import warnings
from collections.abc import Hashable, Iterator
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from reports.run.temporary import lasting_folder
from reports.run.worker import cpu_time, work

IMPORTED_ONCE = ("reports.model.measure", "engines.registry")  # by the fork server, for all workers
PATIENCE = 30.0  # s for a process that has ended to be gone: its memory may have to be written first


@dataclass
class Job:
    """An item to be worked on; `earlier`: how its first worker ended, empty if it was not tried before."""

    item: Any
    earlier: str = ""
    earlier_outside: bool = False


def stop_all() -> None:
    """End every worker of this process; for a process that ends where it stands."""
    for child in multiprocessing.active_children():
        _kill(child)


def _kill(process: BaseProcess) -> None:
    """With what its jobs have forked."""
    with contextlib.suppress(OSError):
        if hasattr(os, "killpg") and process.pid is not None:
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


@dataclass
class Worker:
    process: BaseProcess
    connection: Connection
    ready: bool = False
    used: bool = False
    job: Job | None = None
    awake: float = 0.0  # s since it was started or given its job, as far as the parent was awake
    cpu: float | None = None  # s of CPU time when it was given its job; None where the system does not tell
    kin: Hashable = None  # of its last job, see `reports.run.waiting`
    processor: int | None = None  # where it stays

    def used_cpu(self) -> float:
        """CPU seconds that its job has used so far; zero where the system does not tell."""
        now = cpu_time(self.process.pid or 0)
        return 0.0 if now is None or self.cpu is None else now - self.cpu

    def exit_code(self) -> int | None:
        """Of a worker whose connection has ended; None if nobody knows how the process ended."""
        self.process.join(PATIENCE)
        return self.process.exitcode

    def stop(self) -> None:
        """End the process, whatever it does, and what it has started."""
        _kill(self.process)
        self.process.join(PATIENCE)
        self.connection.close()
        if self.process.exitcode is not None:
            self.process.close()


def start_method(*modules: str) -> Any:
    """How worker processes start: by a fork server, which imports these modules once for all, where there is one."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    # Where the fork server's socket lies: it would be left behind by an interruption.
    vars(multiprocessing.current_process())["_config"].setdefault("tempdir", str(lasting_folder()))
    context.set_forkserver_preload([*IMPORTED_ONCE, *modules])
    return context


def start_early(*modules: str) -> None:
    """Have the fork server import these modules too, while the caller does something else.

    Where there is none, or it can't be started now, workers import for themselves: only time is lost.
    """
    if start_method(*modules).get_start_method() == "forkserver":
        from multiprocessing import forkserver

        one_thread_each()
        with interrupts_held(), contextlib.suppress(OSError):
            forkserver.ensure_running()


def one_thread_each() -> None:
    """CPU time is counted over all threads of a process: a threaded BLAS would be charged for waiting."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def start_worker(context: Any, folder: str, limit: float, wall: float, processor: int | None) -> Worker:
    """Start a process that runs `work` on these terms. Raises OSError or EOFError if none can be started."""
    ours, theirs = context.Pipe()
    process = context.Process(target=work, args=(theirs, folder, limit, wall, processor), daemon=True)
    # About a resource tracker killed in this moment.
    with theirs, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            process.start()
        except BaseException:
            ours.close()
            raise
    return Worker(process, ours, processor=processor)


@contextlib.contextmanager
def interrupts_held() -> Iterator[None]:
    """Ctrl-C waits until a process has started: it would print a traceback there, and leave it without a parent here.

    Processes started meanwhile inherit this: a worker ignores Ctrl-C from then on, the fork server as long as it lives.
    """
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # The standard library warns when its resource tracker was killed, and starts another; nothing here needs it.
    # Starting one ends the holding of Ctrl-C, so it comes first.
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def last_words(folder: Path, pid: int | None) -> str:
    """In what words native code said why it aborts, if it did."""
    with contextlib.suppress(OSError):
        text = (folder / f"{pid}.log").read_text(encoding="utf-8", errors="replace")
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        first = next((at for at, line in enumerate(lines) if "abort" in line.lower() or "error" in line.lower()), 0)
        # Chipmunk's reason and the condition that failed stand below a line that ends with a colon.
        count = 3 if lines and lines[first].endswith(":") else 1
        return " ".join(lines[first : first + count])[:300]
    return ""
