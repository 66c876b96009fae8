"""Handlers for Ctrl-C, SIGTERM and SIGHUP that end the program without a traceback and remove temporary folders.

The exit status is 128 plus the number of the signal, for example 130 after Ctrl-C.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

SIGNALS = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))


class Interrupted(KeyboardInterrupt):
    """A signal with this number interrupts the program."""

    def __init__(self, number: int = signal.SIGINT) -> None:
        super().__init__()
        self.status = 128 + number


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], Any]) -> Iterator[None]:
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in SIGNALS}
    ours = [number for number, old in before.items() if old not in (signal.SIG_IGN, None)]
    for number in ours:
        signal.signal(number, handler)
    try:
        yield
    finally:
        for number in ours:
            if signal.getsignal(number) is handler:
                signal.signal(number, before[number])


def _end(number: int, frame: FrameType | None) -> None:
    # No exception is raised here, since it could be lost during the import of a compiled module. A module that is not
    # completely imported has nothing to clean up.
    for module, name in (("reports.run.worker", "stop_all"), ("reports.run.files", "remove_all")):
        getattr(sys.modules.get(module), name, lambda: None)()
    os._exit(128 + number)


def ending_at_once() -> Any:
    """A context for work that changes no files. A signal ends the process immediately."""
    return _handled(_end)


@contextmanager
def delayed_signals() -> Iterator[Callable[[], None]]:
    """A context that yields a function `check`. After a signal, `check` and the end of the context raise Interrupted.
    So work stops only where it can be continued later. A second signal raises Interrupted immediately."""
    pressed: list[int] = []

    def keep(number: int, frame: FrameType | None) -> None:
        pressed.append(number)
        if len(pressed) > 1:
            raise Interrupted(number)

    def check() -> None:
        if pressed:
            raise Interrupted(pressed[0])

    with _handled(keep):
        try:
            yield check
        finally:
            check()


def from_now_on_ignored() -> None:
    """Ignore Ctrl-C from now on, since all output has been written and the interpreter shuts down."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
