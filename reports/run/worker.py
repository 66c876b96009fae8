"""A worker: a process that answers one job after another, each within its CPU time, until one leaves something behind.

The first part is its parent's: how it is started and ended. The second, from `work` on, is what runs in it. Nothing of
an engine is imported here, so that a worker that has to start from nothing is there at once.
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
from collections.abc import Iterable, Iterator
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
from reports.run.files import socket_folder, temporary_folders

# Rows depend on the files that this module imports, and on no engine but their own. So these, which look at all engines
# and packages, are imported by their names.
GUARD, REGISTRY = "planar_crosscheck", "engines.registry"
IMPORTED_ONCE = ("reports.model.measure", REGISTRY)  # by the fork server, for all workers
PATIENCE = 30.0  # s for a process that has ended to be gone: its memory may have to be written first
READY = b"ready"
LARGEST = 2**28  # bytes of one result: far above any motion, far below what would fill the memory of the parent
SPENT = 152  # how a worker ends whose job has used up its CPU time, where nobody else sees that: 128 + SIGXCPU
SAFE_PATH = "PYTHONSAFEPATH"  # any value keeps the current folder off the path of a Python that starts
OURS = "crosscheck"  # its value where the user has set none: what a job starts is not meant
PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2)
LOOK = 0.2  # s between two looks at its own CPU time
# Starting a process looks at all others, and takes away the exit code of one that has ended: with several threads, each
# of which supervises workers of its own, that may be another's.
_reading = threading.Lock()


def cpu_time(process: int) -> float | None:
    """CPU seconds of a process, all threads together; None where the system does not tell those of another process.

    On Linux by the process's clock, whose number clock_getcpuclockid(3) makes in this way. A timer for the CPU time
    (ITIMER_PROF, RLIMIT_CPU) would end a process by itself, but while one is set the process's own clock, by which
    stepping is timed, moves in jumps of 4 ms only.
    """
    try:
        return time.clock_gettime((~process << 3) | 2)
    except (AttributeError, OSError, OverflowError):
        return None


def stop_all() -> None:
    """End every worker of this process; for a process that ends where it stands."""
    for child in multiprocessing.active_children():
        _kill(child)
    end_processes_of(temporary_folders())


def end_processes_of(folders: Iterable[Path]) -> None:
    """End what jobs have started in sessions of their own, which outlives the process group of their worker.

    They are known by the folder of the crew, which is their TMPDIR or where they are. Nothing is done without /proc.
    """
    names = [os.fsencode(folder) for folder in folders]
    for process in Path("/proc").glob("[0-9]*") if names else ():
        with suppress(OSError):  # it has ended, or is somebody else's
            where = os.readlink(os.fsencode(process / "cwd"))
            words = (process / "environ").read_bytes().split(b"\0")
            if int(process.name) != os.getpid() and any(where == name or b"TMPDIR=" + name in words for name in names):
                os.kill(int(process.name), signal.SIGKILL)


def _kill(process: BaseProcess) -> None:
    """With what its jobs have forked."""
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
    cpu: float | None = None  # s of CPU time when it was given its job; None where the system does not tell

    def used_cpu(self) -> float:
        """CPU seconds that its job has used so far; zero where the system does not tell."""
        now = cpu_time(self.process.pid or 0)
        return 0.0 if now is None or self.cpu is None else now - self.cpu

    def exit_code(self) -> int | None:
        """Of a worker whose connection has ended; None if nobody knows how the process ended."""
        return _exit_code(self.process)

    def stop(self) -> None:
        """End the process, whatever it does, and what it has started."""
        _kill(self.process)
        self.connection.close()
        if _exit_code(self.process) is not None:
            self.process.close()


def _exit_code(process: BaseProcess) -> int | None:
    """Once the process has ended; None if nobody knows how, or it is still there after PATIENCE."""
    ended = wait([process.sentinel], PATIENCE)
    with _reading:
        if ended:  # of a spawned process it is a pipe, closed a moment before the system tells the exit code
            process.join(PATIENCE)
        return process.exitcode


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

    Where there is none, or it can't be started now, workers import for themselves: only time is lost.
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
    """Start a process that runs `work` on these terms. Raises OSError or EOFError if none can be started."""
    ours, theirs = context.Pipe()
    process = context.Process(target=work, args=(theirs, folder, limit, wall), daemon=True)
    # About a resource tracker killed in this moment.
    with theirs, warnings.catch_warnings():
        warnings.simplefilter("ignore")
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
    folder is kept off their path.
    """
    is_set = SAFE_PATH in os.environ
    os.environ.setdefault(SAFE_PATH, OURS)
    before = None
    if hasattr(signal, "pthread_sigmask"):
        # Starting the resource tracker ends the holding of Ctrl-C, so it comes first. The standard library warns when
        # its tracker was killed, and starts another.
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
    """In what words native code said why it aborts, if it did."""
    with suppress(OSError):
        text = (folder / f"{pid}.log").read_text(encoding="utf-8", errors="replace")
        lines = [line.strip() for line in text.splitlines() if line.strip()]
        first = next((at for at, line in enumerate(lines) if "abort" in line.lower() or "error" in line.lower()), 0)
        # Chipmunk's reason and the condition that failed stand below a line that ends with a colon.
        count = 3 if lines and lines[first].endswith(":") else 1
        return " ".join(lines[first : first + count])[:300]
    return ""


WATCHED = cpu_time(os.getpid()) is not None  # whether the parent sees when a job has used up its CPU time


class Clock:
    """The CPU time at which the present job is ended; infinite between jobs."""

    def __init__(self) -> None:
        self.end = float("inf")


def work(connection: Connection, folder: str, limit: float, wall: float) -> None:
    """Answer jobs until the connection ends, or until a job leaves the process changed.

    A job is a pickled (function, item); its answer is a pickled (whether this worker takes another job, what the
    function gave or a Loss, pickled). `limit`: CPU seconds of one job, `wall`: seconds after which the parent
    ends it; after twice as many it ends itself, should the parent be gone.
    """
    _ignore_interrupts()
    if os.environ.get(SAFE_PATH) == OURS:
        del os.environ[SAFE_PATH]
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # with all that jobs start, so that it can be ended as one
    _end_with_the_parent()
    try:
        _redirect(Path(folder))
    except FileNotFoundError:  # the command was interrupted meanwhile, and has taken its folder away
        os._exit(1)
    if hidden := import_module(
        GUARD
    ).clash():  # the path came from the parent: a folder before ours may have appeared since
        print(hidden, file=sys.stderr, flush=True)
        os._exit(1)
    clock = Clock()
    threading.Thread(target=_watch, args=(clock,), daemon=True).start()
    connection.send_bytes(READY)
    stays, own = True, os.getpid()
    while stays:
        try:
            job = connection.recv_bytes()
        except (EOFError, OSError):
            break
        os.ftruncate(2, 0)  # what native code says last is then about this job
        stays, answer = _answer(job, clock, limit, wall)
        if os.getpid() != own:  # a child that a job has forked: its parent answers
            os._exit(0)
        connection.send_bytes(pickle.dumps((stays, answer)))
    # Not sys.exit: threads that a job has left running must not keep the process.
    os._exit(0)


def _ignore_interrupts() -> None:
    """Ctrl-C reaches every process of a terminal; the parent alone decides what it means."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_SETMASK, ())


def _end_with_the_parent() -> None:
    """Ask Linux to end this process with the one that started it, the fork server.

    Native code that holds the interpreter keeps the thread that looks after the parent from running. The fork server
    ends with the command, once its workers have closed the pipe that tells it that somebody still needs it.
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
    # What an engine makes elsewhere goes with this folder too, however the worker ends.
    tempfile.tempdir = os.environ["TMPDIR"] = str(folder)
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)


def _watch(clock: Clock) -> None:
    """In a thread: end the process when its parent is gone, or when its CPU time is used up and nobody else sees it."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    while parent.is_alive():
        parent.join(None if WATCHED else LOOK)
        if not WATCHED and time.process_time() > clock.end:
            os._exit(SPENT)
    os._exit(1)


def _answer(job: bytes, clock: Clock, limit: float, wall: float) -> tuple[bool, bytes]:
    """(whether the process is as it was before, the pickled result or Loss)."""
    try:
        # Imports an engine for the first time, which is no part of the job's CPU time, and may change the process.
        function, item = pickle.loads(job)
    except BaseException as error:  # nothing was run
        return False, pickle.dumps(Loss(Outcome.LOST, f"a worker can't read it: {describe(error)}"))
    try:
        before = _traces()
        start = time.process_time()
        with _timers(clock, limit, wall):
            result = function(item)
        if time.process_time() - start > limit:
            result = out_of_time(limit)
        if sentence := import_module(REGISTRY).mislabelled(
            elsewhere=False
        ):  # a build that `compare` runs may lie elsewhere
            result = Loss(Outcome.LOST, sentence)
        answer = pickle.dumps(result)
        if len(answer) > LARGEST:
            raise OverflowError(f"a result of {len(answer)} bytes; {LARGEST} can be handed over")
    except BaseException as error:  # what an engine raises is a result, SystemExit and KeyboardInterrupt too
        # It may have stopped half-way through a change of its own library, so nobody else gets this process.
        return False, pickle.dumps(failure(error))
    return _traces() == before, answer


@contextmanager
def _timers(clock: Clock, limit: float, wall: float) -> Iterator[None]:
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


def _traces() -> tuple[Any, ...]:
    """What a job could leave behind for the next one: a worker in which this differs afterwards is replaced."""
    try:
        folder = os.getcwd()
        streams = [(os.fstat(number).st_dev, os.fstat(number).st_ino) for number in (1, 2)]
    except OSError as error:
        folder, streams = "", [str(error)]
    handlers = [signal.getsignal(number) for number in sorted(signal.valid_signals())]
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ()) if hasattr(signal, "pthread_sigmask") else set()
    python_streams = (sys.stdout, sys.stderr, getattr(sys.stdout, "closed", True), getattr(sys.stderr, "closed", True))
    return folder, streams, handlers, blocked, python_streams, threading.active_count(), dict(os.environ)
