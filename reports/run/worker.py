"""A worker: a process that runs one job after another, each within its CPU time, until one leaves something behind.

The first part runs in the parent: a worker is started and ended. The second, from `work` on, runs in the worker. No
engine is imported here, so that a worker that has to start from nothing is there at once.
"""

from __future__ import annotations

import ctypes
import multiprocessing
import os
import pickle
import signal
import sys
import tempfile
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from pathlib import Path
from typing import Any

from reports.model.ending import describe
from reports.model.outcomes import Loss, Outcome, failure, out_of_time
from reports.run.files import socket_folder

# Rows depend on the files that this module imports, and on no engine but their own. So these, which look at all engines
# and packages, are imported by their names.
GUARD, REGISTRY = "planar_crosscheck", "engines.registry"
IMPORTED_ONCE = ("reports.model.measure", REGISTRY)  # by the fork server, for all workers
PATIENCE = 30.0  # s for a process that has ended to be gone: its memory may have to be written first
READY = b"ready"
SPENT = 152  # exit code of a worker whose job has used up its CPU time, where the parent can't see that: 128 + SIGXCPU
SAFE_PATH = "PYTHONSAFEPATH"  # any value keeps the current folder off the path of a Python that starts
OURS = (
    "crosscheck"  # the value that is set here; workers remove it, so that processes started by a job do not inherit it
)
PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)
CHECK_INTERVAL = 0.2  # s between two readings of its own CPU time
# Starting a process polls all child processes and consumes the exit code of one that has ended. If several threads
# supervise workers, it may be a worker of another thread.
_reading = threading.Lock()


def cpu_time(process: int) -> float | None:
    """CPU seconds of a process, all threads together; None if the system does not report those of another process.

    On Linux by the process's clock, whose number clock_getcpuclockid(3) makes in this way. While a timer for the CPU
    time is set (ITIMER_PROF, RLIMIT_CPU), that clock, by which stepping is timed, moves in jumps of 4 ms only.
    """
    try:
        return time.clock_gettime((~process << 3) | 2)
    except (AttributeError, OSError, OverflowError):
        return None


def stop_all() -> None:
    """End every worker of this process; for a process that ends at once."""
    for child in multiprocessing.active_children():
        _kill(child)


def _kill(process: BaseProcess) -> None:
    """Kill a worker and the processes that its jobs have forked."""
    with suppress(OSError):
        if hasattr(os, "killpg") and process.pid is not None:
            os.killpg(process.pid, signal.SIGKILL)
    process.kill()


@dataclass
class Worker:
    process: BaseProcess
    connection: Connection
    ready: bool = False
    used: bool = False
    job: Any = None  # of `supervisor.Job`; None: it waits for one
    awake: float = 0.0  # s since it was started or given its job, as far as the parent was awake
    cpu: float | None = None  # s of CPU time when it was given its job; None if the system does not report it

    def used_cpu(self) -> float:
        """CPU seconds that its job has used so far; zero if the system does not report them."""
        now = cpu_time(self.process.pid or 0)
        return 0.0 if now is None or self.cpu is None else now - self.cpu

    def exit_code(self) -> int | None:
        """Once the process has ended; None if it can't be known, or it is still there after PATIENCE."""
        ended = wait([self.process.sentinel], PATIENCE)
        with _reading:
            if ended:  # the sentinel of a spawned process is a pipe, closed a moment before the exit code is there
                self.process.join(PATIENCE)
            return self.process.exitcode

    def stop(self) -> None:
        """Kill the process and the processes that it has started."""
        _kill(self.process)
        self.connection.close()
        if self.exit_code() is not None:
            self.process.close()


def start_method(*modules: str) -> Any:
    """How worker processes start: by a fork server, which imports these modules once for all, where there is one."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    # The standard library's own folder would be left behind by an interruption.
    vars(multiprocessing.current_process())["_config"].setdefault("tempdir", str(socket_folder()))
    context.set_forkserver_preload([*IMPORTED_ONCE, *modules])
    return context


def start_early(*modules: str) -> None:
    """Have the fork server import these modules too, while the caller does something else.

    Without a fork server, or if it can't be started now, each worker imports them: only time is lost.
    """
    if start_method(*modules).get_start_method() == "forkserver":
        from multiprocessing import forkserver

        one_thread_each()
        with process_start(), suppress(OSError):
            forkserver.ensure_running()


def one_thread_each() -> None:
    """CPU time is counted over all threads of a process: a threaded BLAS would be charged for waiting."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def start_worker(context: Any, folder: str, limit: float, wall: float) -> Worker:
    """Start a process that runs `work` with these limits. Raises OSError or EOFError if none can be started."""
    ours, theirs = context.Pipe()
    process = context.Process(target=work, args=(theirs, folder, limit, wall), daemon=True)
    with theirs, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about a resource tracker killed in this moment
        try:
            with _reading:
                process.start()
        except BaseException:
            ours.close()
            raise
    return Worker(process, ours)


@contextmanager
def process_start() -> Iterator[None]:
    """Ctrl-C waits until a process has started: it would print a traceback there, and leave it without a parent here.

    Processes started meanwhile inherit this: a worker ignores Ctrl-C from then on, the fork server as long as it lives.
    They are started by `python -c`, which would import files of the current folder in place of any module, so that
    this folder is removed from their path.
    """
    is_set = SAFE_PATH in os.environ
    os.environ.setdefault(SAFE_PATH, OURS)
    before = None
    if hasattr(signal, "pthread_sigmask"):
        # Starting the resource tracker unblocks Ctrl-C, so it comes first. It warns when the old tracker was killed.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            resource_tracker.ensure_running()
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        if before is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
        if not is_set:
            os.environ.pop(SAFE_PATH, None)


def last_words(folder: Path, pid: int | None) -> str:
    """The reason that native code printed before it aborted, if it did."""
    with suppress(OSError):
        text = (folder / f"{pid}.log").read_text(encoding="utf-8", errors="replace")
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        first = next((at for at, line in enumerate(lines) if "abort" in line.lower() or "error" in line.lower()), 0)
        # Chipmunk prints its reason and the failed condition below a line that ends with a colon.
        count = 3 if lines and lines[first].endswith(":") else 1
        return " ".join(lines[first : first + count])[:300]
    return ""


PARENT_SEES_CPU = cpu_time(os.getpid()) is not None  # whether the parent sees when a job has used up its CPU time


class CpuDeadline:
    """The CPU time at which the present job is ended; infinite between jobs."""

    def __init__(self) -> None:
        self.end = float("inf")


def work(connection: Connection, folder: str, limit: float, wall: float) -> None:
    """Answer jobs until the connection ends, or until a job leaves the process changed.

    A job is a pickled (function, item); its answer is a pickled (whether this worker takes another job, the pickled
    result or Loss). `limit`: CPU seconds of one job, `wall`: seconds after which the parent ends it; after twice as
    many it ends itself, should the parent be gone.
    """
    # Ctrl-C reaches every process of a terminal; only the parent handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
    if os.environ.get(SAFE_PATH) == OURS:
        del os.environ[SAFE_PATH]
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # with all that jobs start, so that it can be ended as one
    _end_with_the_parent()
    try:
        _redirect(Path(folder))
    except FileNotFoundError:  # the command was interrupted meanwhile, and has taken its folder away
        os._exit(1)
    # The path came from the parent: a folder before ours may have appeared since.
    if hidden := import_module(GUARD).clash():
        print(hidden, file=sys.stderr, flush=True)
        os._exit(1)
    clock = CpuDeadline()
    threading.Thread(target=_watch, args=(clock,), daemon=True).start()
    connection.send_bytes(READY)
    stays, number = True, os.getpid()
    while stays:
        try:
            job = connection.recv_bytes()
        except (EOFError, OSError):
            break
        os.ftruncate(2, 0)  # what native code prints last is then about this job
        stays, answer = _answer(job, clock, limit, wall)
        if os.getpid() != number:  # a child that a job has forked: its parent answers
            os._exit(0)
        connection.send_bytes(pickle.dumps((stays, answer)))
    os._exit(0)  # not sys.exit: threads that a job has left running must not keep the process


def _end_with_the_parent() -> None:
    """Ask Linux to end this process with the one that started it, the fork server.

    Native code that holds the interpreter keeps the thread that looks after the parent from running. The fork server
    ends with the command, once its workers have closed the pipe that keeps it running.
    """
    with suppress(ImportError, AttributeError, KeyError, OSError, TypeError):
        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
        from multiprocessing import forkserver

        server = vars(forkserver._forkserver)
        os.close(server["_forkserver_alive_fd"])
        server["_forkserver_alive_fd"] = None


def _redirect(folder: Path) -> None:
    """Engines write logs into the working folder and to the standard streams; both go where the parent can look."""
    os.chdir(folder)
    log = os.open(f"{os.getpid()}.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    tempfile.tempdir = os.environ["TMPDIR"] = str(folder)  # temporary files of engines are deleted with this folder
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)


def _watch(clock: CpuDeadline) -> None:
    """In a thread: end the process when its parent is gone, or when its CPU time is used up and the parent can't see
    that."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    while parent.is_alive():
        parent.join(None if PARENT_SEES_CPU else CHECK_INTERVAL)
        if not PARENT_SEES_CPU and time.process_time() > clock.end:
            os._exit(SPENT)
    os._exit(1)


def _answer(job: bytes, clock: CpuDeadline, limit: float, wall: float) -> tuple[bool, bytes]:
    """(whether the process is as it was before, the pickled result or Loss)."""
    try:
        # Imports an engine for the first time, which is no part of the job's CPU time, and may change the process.
        function, item = pickle.loads(job)
    except BaseException as error:  # nothing was run
        return False, pickle.dumps(Loss(Outcome.LOST, f"a worker can't read it: {describe(error)}"))
    try:
        before, start = _process_state(), time.process_time()
        with _timers(clock, limit, wall):
            result = function(item)
        if time.process_time() - start > limit:
            result = out_of_time(limit)
        # A build that `compare` runs may lie elsewhere.
        if sentence := import_module(REGISTRY).mislabelled(elsewhere=False):
            result = Loss(Outcome.LOST, sentence)
        return _process_state() == before, pickle.dumps(result)
    except BaseException as error:  # any exception of an engine is a result, also SystemExit and KeyboardInterrupt
        # The engine may have left its library in an inconsistent state, so this process gets no other job.
        return False, pickle.dumps(failure(error))


@contextmanager
def _timers(clock: CpuDeadline, limit: float, wall: float) -> Iterator[None]:
    """A timer of the system ends the process even inside native code that never returns to the interpreter."""
    clock.end = time.process_time() + limit
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, 2 * wall)  # the parent is gone, or it would have ended this by now
    try:
        yield
    finally:
        clock.end = float("inf")
        if hasattr(signal, "setitimer"):
            for timer in (signal.ITIMER_PROF, signal.ITIMER_REAL, signal.ITIMER_VIRTUAL):
                signal.setitimer(timer, 0)


def _process_state() -> tuple[Any, ...]:
    """Process state that a job could change for the next one; a worker with a changed state is replaced."""
    try:
        folder = os.getcwd()
        streams = [(os.fstat(number).st_dev, os.fstat(number).st_ino) for number in (1, 2)]
    except OSError as error:
        folder, streams = "", [str(error)]
    handlers = [signal.getsignal(number) for number in sorted(signal.valid_signals())]
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ()) if hasattr(signal, "pthread_sigmask") else set()
    python_streams = (sys.stdout, sys.stderr, getattr(sys.stdout, "closed", True), getattr(sys.stderr, "closed", True))
    return folder, streams, handlers, blocked, python_streams, threading.active_count(), dict(os.environ)
