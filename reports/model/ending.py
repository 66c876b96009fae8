"""The exit statuses of the program, and the exceptions that are printed as one line on stderr."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import ClassVar

LONGEST_MESSAGE = 500  # Largest number of characters that describe an exception.
FINE = 0
BROKEN = 1
REFUSED = 2
INTERRUPTED = 130  # The status that shells expect after Ctrl-C.
UNREAD = 141  # 128 + SIGPIPE. The reader of the pipe has ended.

STATUSES = (
    f"Exit status: {FINE} fine; {BROKEN} something ran but is broken; {REFUSED} bad input or trouble with a file, and "
    f"one line says what to do; {INTERRUPTED} Ctrl-C, "
    "and 128 plus its number after SIGTERM or SIGHUP."
)


class Ending(Exception):
    """An exception that ends the program with `status`. The message is printed as one line on stderr."""

    status: ClassVar[int]


class Broken(Ending):
    """A run or a check has failed. The message names the run or the check, and the reason."""

    status = BROKEN


class BadInput(Ending, ValueError):
    """An input is not accepted. The message contains the value, the reason and valid values."""

    status = REFUSED


class FileTrouble(Ending):
    """A file cannot be used. The message contains the file, the reason and the remedy."""

    status = REFUSED


NONE_ABSENT: Mapping[str, str] = MappingProxyType({})


def nearest(kind: str, word: str, known: Iterable[str], absent: Mapping[str, str] = NONE_ABSENT) -> BadInput:
    """The error about an unknown word, with the most similar known word, regardless of case. absent: name of an item
    that is not installed -> a sentence on how to install it."""
    names = {name.lower(): name for name in (*known, *absent)}
    low = word.lower()
    near = difflib.get_close_matches(low, names, 1, 0.4)
    if not near:
        near = [name for name in names if low and (low in name or name in low)][:1]
    hint = f"did you mean {names[near[0]]!r}?" if near else f"there are {', '.join(names.values())}"
    if near and names[near[0]] in absent:
        hint += f" {absent[names[near[0]]]}"
    return BadInput(f"unknown {kind} {word!r}: {hint}")


def visible(text: str) -> str:
    """The text with escapes instead of characters that control a terminal or the direction of text."""
    if text.isprintable():
        return text
    return "".join(
        letter if letter == "\n" or letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def describe(error: BaseException) -> str:
    """'Type: message' of an exception. A message that can't be computed is replaced."""
    try:
        message = str(error)
    except Exception:
        message = "(it can't be printed)"
    return f"{type(error).__name__}: {message}"[:LONGEST_MESSAGE].encode("utf-8", "replace").decode("utf-8")
