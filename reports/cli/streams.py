"""Functions that open, write and close the standard streams without tracebacks."""

from __future__ import annotations

import io
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from reports.model.ending import FileTrouble, visible


@contextmanager
def written() -> Iterator[None]:
    """A context for output that raises BrokenPipeError if the reader has ended, and FileTrouble for other errors."""
    try:
        yield
        sys.stdout.flush()
    except BrokenPipeError:
        raise
    except OSError as reason:
        raise FileTrouble(f"the output can't be written: {reason.strerror or reason}") from None


def said(words: str) -> None:
    print(f"crosscheck: {visible(words)}", file=sys.stderr, flush=True)


def open_streams() -> None:
    """Open closed streams on the null device, so that no other file gets their descriptor and their output."""
    for name, mode in (("stdin", "r"), ("stdout", "w"), ("stderr", "w")):
        if getattr(sys, name) is None:
            setattr(sys, name, open(os.devnull, mode, encoding="utf-8"))  # noqa: SIM115 (it stays open)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # The locale may lack characters.


def leave_streams() -> None:
    """Discard output that can't be written. At its end Python would print an error message about such output."""
    for stream in (sys.stdout, sys.stderr):
        try:
            stream.flush()
        except OSError:
            os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
