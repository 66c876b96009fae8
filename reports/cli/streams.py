"""Standard streams: opened where they are closed, written without a traceback, left without a complaint."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from reports.model.ending import FileTrouble, visible


@contextmanager
def written() -> Iterator[None]:
    """Raises FileTrouble where standard output can't be written inside, and BrokenPipeError if its reader has ended."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as reason:
        raise FileTrouble(f"the output can't be written: {reason.strerror or reason}") from None


def said(words: str) -> None:
    """A line on standard error, at once."""
    print(f"crosscheck: {visible(words)}", file=sys.stderr, flush=True)


def open_streams() -> None:
    """Give streams that are closed the null device, lest a file that is opened take their number, and be written."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (it stays open)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # names of files, and signs that the locale lacks


def leave_streams() -> None:
    """What could not be written is dropped; Python would try again on its way out, and complain."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
