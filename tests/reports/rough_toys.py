"""Engines and functions that treat their own process badly: they test the supervisor, not the reports."""

from __future__ import annotations

import contextlib
import ctypes
import multiprocessing
import os
import re
import signal
import sys
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from multiprocessing import forkserver, resource_tracker
from pathlib import Path
from typing import Any

from reference.trajectory import Trajectory
from reports.run.files import PREFIX
from reports.run.worker import LARGEST
from tests.toys import Toy


class NeedsTwo(Exception):
    """Can be raised and pickled, and not unpickled: its arguments are not those of its constructor."""

    def __init__(self, first: int, second: int) -> None:
        super().__init__(f"{first} and {second}")


class Unprintable(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no words")


class Unreadable:
    """Can be pickled, and not unpickled."""

    def __reduce__(self) -> tuple[object, ...]:
        return NeedsTwo, (1,)


@dataclass(frozen=True)
class RoughToy(Toy):
    """Does what its variant says while it steps; `folder` is where it leaves a mark, if it does."""

    folder: str = ""

    def spoil(self, exact: Trajectory, dt: float) -> Trajectory:
        ACTIONS[self.variant](self)
        return super().spoil(exact, dt)

    def once(self) -> bool:
        """Whether this is the first time."""
        mark = Path(self.folder) / "mark"
        first = not mark.exists()
        mark.touch()
        return first

    def held(self, then: str) -> None:
        """Hold a lock on a file as long as the process lives."""
        import fcntl

        file = os.open(Path(self.folder) / then, os.O_CREAT | os.O_WRONLY)
        fcntl.flock(file, fcntl.LOCK_EX)
        (Path(self.folder) / f"{then} is there").touch()
        ACTIONS[then](self)


def throw(error: BaseException) -> None:
    raise error


def send(number: int) -> None:
    os.kill(os.getpid(), number)
    time.sleep(5)


def close_streams(toy: RoughToy) -> None:
    sys.stdout.close()
    for number in (1, 2):
        with contextlib.suppress(OSError):  # closed with its stream
            os.close(number)


def install_handlers(toy: RoughToy) -> None:
    for number in (signal.SIGTERM, signal.SIGINT, signal.SIGALRM, signal.SIGPROF):
        signal.signal(number, lambda *_: None)
    signal.setitimer(signal.ITIMER_REAL, 0.001, 0.001)


ACTIONS: dict[str, Callable[[RoughToy], Any]] = {
    "segfault": lambda toy: ctypes.string_at(0),
    "abort": lambda toy: os.abort(),
    "exit 255": lambda toy: os._exit(255),
    "kill": lambda toy: send(signal.SIGKILL),
    "segfault once": lambda toy: send(signal.SIGSEGV) if toy.once() else None,
    "kill once": lambda toy: send(signal.SIGKILL) if toy.once() else None,
    "sleep": lambda toy: time.sleep(1000),
    "spin": lambda toy: [None for _ in iter(int, 1)],
    # Both hold the interpreter: no other thread of the process runs.
    "native spin": lambda toy: re.match(r"(a|a)*$", "a" * 60 + "b"),
    "native sleep": lambda toy: ctypes.PyDLL(None).sleep(1000),
    "held sleep": lambda toy: toy.held("sleep"),
    "held native spin": lambda toy: toy.held("native spin"),
    "held native sleep": lambda toy: toy.held("native sleep"),
    "short sleep": lambda toy: time.sleep(0.05),
    "nap": lambda toy: time.sleep(1),
    "needs two": lambda toy: throw(NeedsTwo(1, 2)),
    "unprintable": lambda toy: throw(Unprintable()),
    "long words": lambda toy: throw(RuntimeError("x" * 10_000_000)),
    "system exit": lambda toy: sys.exit(3),
    "interrupt": lambda toy: throw(KeyboardInterrupt()),
    "endless recursion": lambda toy: ACTIONS["endless recursion"](toy),
    "closes streams": close_streams,
    "closes files": lambda toy: os.closerange(3, 1000),
    "changes folder": lambda toy: os.chdir("/"),
    "changes environment": lambda toy: os.environ.update(CROSSCHECK_TOY="was here"),
    "leaves threads": lambda toy: threading.Thread(target=time.sleep, args=(1000,), daemon=True).start(),
    "installs handlers": install_handlers,
    "blocks signals": lambda toy: signal.pthread_sigmask(signal.SIG_BLOCK, signal.valid_signals()),
}
DAMAGE: list[str] = []


def act(name: str) -> object:
    """The result of one of the actions without an engine, or a result of another kind."""
    match name:
        case "process":
            return os.getpid()
        case "probe":
            return probe()
        case "damage":
            time.sleep(0.3)
            DAMAGE.append("something in native memory")
            return None
        case "crash where damaged":
            return os.abort() if DAMAGE else "sound"
        case "unreadable":
            return Unreadable()
        case "huge":
            return bytes(LARGEST)
    return ACTIONS[name](RoughToy())


def spoiled(name: str) -> list[str]:
    """The process after one of the actions."""
    ACTIONS[name](RoughToy())
    return probe()


def is_log(number: int) -> bool:
    """Whether a file descriptor writes into a log in the working folder."""
    try:
        status = os.fstat(number)
    except OSError:
        return False
    return any(os.path.samestat(log.stat(), status) for log in Path().glob("*.log"))


def probe() -> list[str]:
    """What is not as it should be in the process of a worker."""
    wrong = {
        "folder": not Path.cwd().name.startswith(PREFIX),
        "streams": sys.stdout.closed or not all(map(is_log, (1, 2))),
        "handlers": any(callable(handler) for handler in map(signal.getsignal, signal.valid_signals())),
        "blocked signals": bool(signal.pthread_sigmask(signal.SIG_BLOCK, ())),
        "threads": threading.active_count() != 2,  # this one, and that which looks after the parent
        "environment": "CROSSCHECK_TOY" in os.environ,
    }
    return [name for name, value in wrong.items() if value]


def dies(*_: object) -> None:
    """Instead of a worker's work: killed before it says that it is ready."""
    os.kill(os.getpid(), signal.SIGKILL)


def is_free(file: Any) -> bool:
    """Whether no process holds a lock on a file: processes that have ended may still have their number."""
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def wait_until(is_true: Callable[[], bool]) -> None:
    """Raises AssertionError after far longer than a loaded machine takes for what is waited for."""
    end = time.monotonic() + 300.0
    while not is_true():
        assert time.monotonic() < end, "it did not come true"
        time.sleep(0.05)


def helpers() -> tuple[int | None, int | None]:
    """The process ids of multiprocessing's fork server and resource tracker, which it has no public name for."""
    server: Any = forkserver._forkserver
    tracker: Any = resource_tracker._resource_tracker
    return server._forkserver_pid, tracker._pid


def end_the_supervisor(item: Any) -> str:
    """End the process that supervises this one, for a cell with more than 900 steps a sample."""
    if item.every > 900:
        parent = multiprocessing.parent_process()
        assert parent is not None
        os.kill(parent.pid or 0, signal.SIGKILL)
    return "fine"
