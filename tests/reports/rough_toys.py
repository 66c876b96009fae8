"""Engines and functions that crash, hang or change their process, for tests of the supervisor."""

from __future__ import annotations

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
from multiprocessing import forkserver
from pathlib import Path
from typing import Any

from reference.trajectory import Trajectory
from tests.toys import Toy


class NeedsTwo(Exception):
    """An error that can be pickled but not unpickled, since its constructor has two arguments."""

    def __init__(self, first: int, second: int) -> None:
        super().__init__(f"{first} and {second}")


class Unprintable(Exception):
    def __str__(self) -> str:
        raise RuntimeError("no words")


class Unreadable:
    def __reduce__(self) -> tuple[object, ...]:
        return NeedsTwo, (1,)


@dataclass(frozen=True)
class RoughToy(Toy):
    """An engine that does the action named by its variant in each run; some actions write a file into `folder`."""

    folder: str = ""

    def spoil(self, exact: Trajectory, dt: float) -> Trajectory:
        ACTIONS[self.variant](self)
        return super().spoil(exact, dt)

    def is_first_call(self) -> bool:
        mark = Path(self.folder) / "mark"
        first = not mark.exists()
        mark.touch()
        return first

    def hold(self, then: str) -> None:
        import fcntl

        file = os.open(Path(self.folder) / then, os.O_CREAT | os.O_WRONLY)
        fcntl.flock(file, fcntl.LOCK_EX)
        (Path(self.folder) / f"{then} is there").touch()
        ACTIONS[then](self)


def throw(error: BaseException) -> None:
    raise error


def kill_self(number: int) -> None:
    os.kill(os.getpid(), number)
    time.sleep(5)


ACTIONS: dict[str, Callable[[RoughToy], Any]] = {
    "segfault": lambda toy: ctypes.string_at(0),
    "kill": lambda toy: kill_self(signal.SIGKILL),
    "segfault once": lambda toy: kill_self(signal.SIGSEGV) if toy.is_first_call() else None,
    "kill once": lambda toy: kill_self(signal.SIGKILL) if toy.is_first_call() else None,
    "sleep": lambda toy: time.sleep(1000),
    "spin": lambda toy: [None for _ in iter(int, 1)],
    # Both native actions hold the interpreter lock, so no other thread of the process runs.
    "native spin": lambda toy: re.match(r"(a|a)*$", "a" * 60 + "b"),
    "native sleep": lambda toy: ctypes.PyDLL(None).sleep(1000),
    "held sleep": lambda toy: toy.hold("sleep"),
    "held native spin": lambda toy: toy.hold("native spin"),
    "short sleep": lambda toy: time.sleep(0.05),
    "needs two": lambda toy: throw(NeedsTwo(1, 2)),
    "unprintable": lambda toy: throw(Unprintable()),
    "system exit": lambda toy: sys.exit(3),
    "closes files": lambda toy: os.closerange(3, 1000),
    "closes streams": lambda toy: sys.stdout.close(),
    "changes environment": lambda toy: os.environ.update(CROSSCHECK_TOY="was here"),
    "changes folder": lambda toy: os.chdir("/"),
    "leaves threads": lambda toy: threading.Thread(target=time.sleep, args=(1000,), daemon=True).start(),
    "installs handlers": lambda toy: str(signal.signal(signal.SIGTERM, lambda *_: None)),
    "blocks signals": lambda toy: str(signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})),
}
DAMAGE: list[str] = []


def act(name: str) -> object:
    match name:
        case "process":
            return os.getpid()
        case "damage":
            time.sleep(0.3)
            DAMAGE.append("something in native memory")
            return None
        case "crash where damaged":
            return os.abort() if DAMAGE else "sound"
        case "unreadable":
            return Unreadable()
        case _:
            return ACTIONS[name](RoughToy())


def dies(*_: object) -> None:
    """A worker that ends before it reports that it is ready."""
    os.kill(os.getpid(), signal.SIGKILL)


def is_free(file: Any) -> bool:
    """Whether no process holds a lock on a file. Unlike a process id, the lock ends with the process."""
    import fcntl

    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    return True


def wait_until(is_true: Callable[[], bool]) -> None:
    """Wait for a condition. Raises AssertionError after 300 s, which is long even for a loaded machine."""
    end = time.monotonic() + 300.0
    while not is_true():
        assert time.monotonic() < end, "it did not come true"
        time.sleep(0.05)


def fork_server() -> int | None:
    """The process id of multiprocessing's fork server, from a private attribute."""
    server: Any = forkserver._forkserver
    return server._forkserver_pid


def end_the_supervisor(item: Any) -> str:
    """Kill the supervising process if a cell has more than 900 steps between samples."""
    if item.every > 900:
        parent = multiprocessing.parent_process()
        assert parent is not None
        os.kill(parent.pid or 0, signal.SIGKILL)
    return "fine"
