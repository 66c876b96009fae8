"""A worker is a process that runs jobs one after another, until a job changes the state of the process.

The functions before `work` run in the parent. `work` and the functions after it run in the worker. This module imports
no engine, so workers start quickly also without a fork server.
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

# These modules import all engines. Rows must not depend on all engines, so the modules are imported by name at run
# time.
GUARD, REGISTRY = "planar_crosscheck", "engines.registry"
IMPORTED_ONCE = ("reports.model.measure", REGISTRY)  # The fork server imports these modules for all workers.
PATIENCE = 30.0  # Longest time until a killed process has ended [s]. The process may write a core dump.
READY = b"ready"
SPENT = 152  # 128 + SIGXCPU, the exit code of a worker that ends itself because its job has used up its CPU time.
SAFE_PATH = "PYTHONSAFEPATH"  # With this variable, Python does not add the current folder to sys.path.
OURS = "crosscheck"  # The value of PYTHONSAFEPATH. Workers remove it, so that processes of jobs do not inherit it.
PARENT_DEATH_SIGNAL = 1  # PR_SET_PDEATHSIG of prctl(2).
CHECK_INTERVAL = 0.2  # Time between two readings of the CPU time in a worker [s].
# When a process is started, all child processes are polled. The exit code of an ended process is then consumed, even if
# another thread supervises this process.
_reading = threading.Lock()


def cpu_time(process: int) -> float | None:
    """CPU seconds of all threads of a process, or None if the system does not report them for another process. The
    number of the clock on Linux follows clock_getcpuclockid(3). No CPU timer (ITIMER_PROF, RLIMIT_CPU) is set, since it
    would reduce the resolution of this clock to 4 ms. The same clock also times the stepping."""
    try:
        return time.clock_gettime((~process << 3) | 2)
    except (AttributeError, OSError, OverflowError):
        return None


def worker_count() -> int:
    """Number of processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def stop_all() -> None:
    """Kill every worker of this process before an exit without cleanup."""
    for child in multiprocessing.active_children():
        _kill(child)


def _kill(process: BaseProcess) -> None:
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
    job: Any = None  # A `supervisor.Job`, or None while the worker is idle.
    awake: float = 0.0  # Time since the start of the worker or of its job [s], while the parent was awake.
    cpu: float | None = None  # CPU time at the start of the job [s], or None if the system does not report it.

    def used_cpu(self) -> float:
        now = cpu_time(self.process.pid or 0)
        return 0.0 if now is None or self.cpu is None else now - self.cpu

    def exit_code(self) -> int | None:
        """The exit code after a wait of up to PATIENCE, or None if it is unknown or the process has not ended."""
        ended = wait([self.process.sentinel], PATIENCE)
        with _reading:
            if ended:  # The sentinel of a spawned process is closed before the exit code is available.
                self.process.join(PATIENCE)
            return self.process.exitcode

    def stop(self) -> None:
        _kill(self.process)
        self.connection.close()
        if self.exit_code() is not None:
            self.process.close()


def start_method(*modules: str) -> Any:
    """The multiprocessing context: a fork server that imports these modules, or spawn if there is no fork server."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    # The standard library would create a temporary folder that is not removed after an interruption.
    vars(multiprocessing.current_process())["_config"].setdefault("tempdir", str(socket_folder()))
    context.set_forkserver_preload([*IMPORTED_ONCE, *modules])
    return context


def start_early(*modules: str) -> None:
    """Start the fork server, which also imports these modules, without waiting for it. Without a fork server each
    worker imports the modules, which is only slower."""
    if start_method(*modules).get_start_method() == "forkserver":
        from multiprocessing import forkserver

        one_thread_each()
        with process_start(), suppress(OSError):
            forkserver.ensure_running()


def one_thread_each() -> None:
    """Set BLAS to one thread. A waiting BLAS thread uses CPU time, which is the sum over all threads."""
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")


def start_worker(context: Any, folder: str, limit: float, wall: float) -> Worker:
    """Start a process that runs `work` with these limits. Raises OSError or EOFError if this is impossible."""
    ours, theirs = context.Pipe()
    process = context.Process(target=work, args=(theirs, folder, limit, wall), daemon=True)
    with theirs, warnings.catch_warnings():
        warnings.simplefilter("ignore")  # warnings of a killed resource tracker
        try:
            with _reading:
                process.start()
        except BaseException:
            ours.close()
            raise
    return Worker(process, ours)


@contextmanager
def process_start() -> Iterator[None]:
    """Block Ctrl-C while a process starts. Otherwise Ctrl-C could print a traceback and prevent the supervision. The
    started processes inherit the blocked signal. `python -c` starts them and would import modules from the current
    folder first, so PYTHONSAFEPATH is set."""
    is_set = SAFE_PATH in os.environ
    os.environ.setdefault(SAFE_PATH, OURS)
    before = None
    if hasattr(signal, "pthread_sigmask"):
        # The resource tracker starts first, since its start unblocks Ctrl-C. A new tracker warns if the old one was
        # killed.
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
    with suppress(OSError):
        text = (folder / f"{pid}.log").read_text(encoding="utf-8", errors="replace")
        lines = list(filter(None, map(str.strip, text.splitlines())))
        first = next((at for at, line in enumerate(lines) if "abort" in line.lower() or "error" in line.lower()), 0)
        # Chipmunk prints a line that ends with a colon, and below it the reason and the failed condition.
        count = 3 if lines and lines[first].endswith(":") else 1
        return " ".join(lines[first : first + count])[:300]
    return ""


PARENT_SEES_CPU = cpu_time(os.getpid()) is not None  # Whether the parent can read the CPU time of a worker.
_deadline = [float("inf")]  # The CPU time at which `_watch` ends the current job, or infinity between jobs.


def work(connection: Connection, folder: str, limit: float, wall: float) -> None:
    """Answer jobs until the connection is closed, or until a job has changed the state of the process. A job is a
    pickled (function, item). The answer is a pickled (whether this worker accepts another job, the pickled result or
    Loss). limit: CPU seconds of one job. wall: seconds after which the parent ends the job. After twice this time the
    worker ends itself, since the parent must have ended."""
    # Ctrl-C reaches all processes of a terminal, but only the parent handles it.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_SETMASK, ())
    if os.environ.get(SAFE_PATH) == OURS:
        del os.environ[SAFE_PATH]
    if hasattr(os, "setpgid"):
        os.setpgid(0, 0)  # So the worker and the processes of its jobs can be killed together.
    _end_with_the_parent()
    try:
        _redirect(Path(folder))
    except FileNotFoundError:  # An interrupted command has removed the folder.
        os._exit(1)
    # Since the check in the parent, a folder that hides this package may have been created.
    if hidden := import_module(GUARD).clash():
        print(hidden, file=sys.stderr, flush=True)
        os._exit(1)
    threading.Thread(target=_watch, daemon=True).start()
    connection.send_bytes(READY)
    stays, number = True, os.getpid()
    while stays:
        try:
            job = connection.recv_bytes()
        except (EOFError, OSError):
            break
        os.ftruncate(2, 0)  # So the log contains only the output of this job.
        stays, answer = _answer(job, limit, wall)
        if os.getpid() != number:  # A process that the job has forked must not answer.
            os._exit(0)
        connection.send_bytes(pickle.dumps((stays, answer)))
    os._exit(0)  # sys.exit would wait for threads that a job has started.


def _end_with_the_parent() -> None:
    """Request that Linux kills this process when its parent, the fork server, ends. The thread `_watch` is not enough,
    since native code may hold the interpreter lock. The fork server ends with the command after all workers have closed
    a pipe."""
    with suppress(ImportError, AttributeError, KeyError, OSError, TypeError):
        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
        from multiprocessing import forkserver

        server = vars(forkserver._forkserver)
        os.close(server["_forkserver_alive_fd"])
        server["_forkserver_alive_fd"] = None


def _redirect(folder: Path) -> None:
    os.chdir(folder)
    log = os.open(f"{os.getpid()}.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    tempfile.tempdir = os.environ["TMPDIR"] = str(folder)  # Files of engines are deleted with this folder.
    os.dup2(log, 1)
    os.dup2(log, 2)
    os.close(log)


def _watch() -> None:
    """End the process when the parent has ended, or at the CPU deadline if the parent can't read the CPU time. It runs
    in a thread."""
    parent = multiprocessing.parent_process()
    assert parent is not None
    while parent.is_alive():
        parent.join(None if PARENT_SEES_CPU else CHECK_INTERVAL)
        if not PARENT_SEES_CPU and time.process_time() > _deadline[0]:
            os._exit(SPENT)
    os._exit(1)


def _answer(job: bytes, limit: float, wall: float) -> tuple[bool, bytes]:
    """Run a job; return (whether the state of the process is unchanged, the pickled result or Loss)."""
    try:
        # An engine may be imported here, which does not count as CPU time of the job or as a change of the process.
        function, item = pickle.loads(job)
    except BaseException as error:  # nothing was run
        return False, pickle.dumps(Loss(Outcome.LOST, f"a worker can't read it: {describe(error)}"))
    try:
        before, start = _process_state(), time.process_time()
        with _timers(limit, wall):
            result = function(item)
        if time.process_time() - start > limit:
            result = out_of_time(limit)
        # `compare` runs builds in other folders, so elsewhere is False.
        if sentence := import_module(REGISTRY).mislabelled(elsewhere=False):
            result = Loss(Outcome.LOST, sentence)
        return _process_state() == before, pickle.dumps(result)
    except BaseException as error:  # Any exception of an engine is a result, also SystemExit.
        # The library of the engine may be in an inconsistent state, so this process gets no further job.
        return False, pickle.dumps(failure(error))


@contextmanager
def _timers(limit: float, wall: float) -> Iterator[None]:
    """Set a system timer that ends the process even in native code that never returns to the interpreter."""
    _deadline[0] = time.process_time() + limit
    if hasattr(signal, "setitimer"):
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        signal.setitimer(signal.ITIMER_REAL, 2 * wall)  # The parent should end the job after `wall`.
    try:
        yield
    finally:
        _deadline[0] = float("inf")
        if hasattr(signal, "setitimer"):
            for timer in (signal.ITIMER_PROF, signal.ITIMER_REAL, signal.ITIMER_VIRTUAL):
                signal.setitimer(timer, 0)


def _process_state() -> tuple[Any, ...]:
    """The state of the process that a job may change. A worker with a changed state is replaced."""
    try:
        folder = os.getcwd()
        streams = [(os.fstat(number).st_dev, os.fstat(number).st_ino) for number in (1, 2)]
    except OSError as error:
        folder, streams = "", [str(error)]
    handlers = [signal.getsignal(number) for number in sorted(signal.valid_signals())]
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ()) if hasattr(signal, "pthread_sigmask") else set()
    python_streams = (sys.stdout, sys.stderr, getattr(sys.stdout, "closed", True), getattr(sys.stderr, "closed", True))
    return folder, streams, handlers, blocked, python_streams, threading.active_count(), dict(os.environ)
