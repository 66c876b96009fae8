"""Ctrl-C ends the program with status 130 and without a traceback, whatever it is doing."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType
from typing import Any

from reports.grid.ending import INTERRUPTED


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], Any]) -> Iterator[None]:
    """Inside, Ctrl-C calls the handler. Where Ctrl-C is ignored (a job in the background) it stays ignored."""
    before = signal.getsignal(signal.SIGINT)
    if before is signal.SIG_IGN or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        if signal.getsignal(signal.SIGINT) is handler:
            signal.signal(signal.SIGINT, before)


def _end(number: int, frame: FrameType | None) -> None:
    # An exception would not do: while compiled modules are imported it comes out as another one, or is lost.
    os._exit(INTERRUPTED)


def ending_at_once() -> Any:
    """A context in which Ctrl-C ends the process where it stands; for work that leaves nothing half done."""
    return _handled(_end)


@contextmanager
def kept() -> Iterator[Callable[[], None]]:
    """Inside, Ctrl-C is kept until the function given is called, which then raises KeyboardInterrupt.

    So work is left only where it can be left. The second Ctrl-C does not wait: it raises at once.
    """
    pressed = False

    def keep(number: int, frame: FrameType | None) -> None:
        nonlocal pressed
        if pressed:
            raise KeyboardInterrupt
        pressed = True

    def check() -> None:
        if pressed:
            raise KeyboardInterrupt

    with _handled(keep):
        yield check


def from_now_on_ignored() -> None:
    """For a program that has said all it has to say: Ctrl-C while it is taken down changes nothing."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGINT, signal.SIG_IGN)
