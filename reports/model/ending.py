"""The exit statuses of the program, and the exceptions that are printed as one line on stderr."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import ClassVar

LONGEST_MESSAGE = 500  # characters of the description of an exception
FINE = 0
BROKEN = 1
REFUSED = 2
INTERRUPTED = 130  # The status that shells expect after Ctrl-C.
UNREAD = 141  # 128 + SIGPIPE: the reader of the pipe has ended.

STATUSES = (
    f"Exit status: {FINE} fine; {BROKEN} something ran but is broken; {REFUSED} bad input or trouble with a file, and "
    f"one line says what to do; {INTERRUPTED} Ctrl-C, "
    "and 128 plus its number after SIGTERM or SIGHUP."
)


class Ending(Exception):
    """A sentence for one line on stderr; the program ends with `status`."""

    status: ClassVar[int]


class Broken(Ending):
    """A run or a check failed; the message names it and the reason."""

    status = BROKEN


class BadInput(Ending, ValueError):
    """Input that is refused; the message names the value, the reason and valid values."""

    status = REFUSED


class FileTrouble(Ending):
    """A file that cannot be used; the message names the file, the reason and the remedy."""

    status = REFUSED


NONE_ABSENT: Mapping[str, str] = MappingProxyType({})


def nearest(kind: str, word: str, known: Iterable[str], absent: Mapping[str, str] = NONE_ABSENT) -> BadInput:
    """The error about an unknown word, with the nearest known one if any is similar, regardless of case.

    `absent`: name -> a sentence on how to install it, for known names that are not available here.
    """
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
    """The text with escapes for characters that control a terminal or the direction of text, as in names of files."""
    if text.isprintable():
        return text
    return "".join(
        letter if letter == "\n" or letter.isprintable() else letter.encode("unicode_escape").decode()
        for letter in text
    )


def describe(error: BaseException) -> str:
    """'Type: message', also for an exception whose message can't be computed."""
    try:
        message = str(error)
    except Exception:
        message = "(it can't be printed)"
    return f"{type(error).__name__}: {message}"[:LONGEST_MESSAGE].encode("utf-8", "replace").decode("utf-8")
