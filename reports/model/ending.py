"""How the program ends: its exit statuses, and the exceptions that become one line on stderr."""

from __future__ import annotations

from typing import ClassVar

FINE = 0
BROKEN = 1
REFUSED = 2
INTERRUPTED = 130  # what a shell expects of a program ended by Ctrl-C
UNREAD = 141  # what a shell shows of a program that writes into a pipe which nobody reads any more

STATUSES = (
    f"Exit status: {FINE} fine; {BROKEN} something ran but is broken; {REFUSED} bad input or trouble with a file, and "
    f"one line says what to do; {INTERRUPTED} Ctrl-C, "
    "and 128 plus its number after SIGTERM or SIGHUP."
)


class Ending(Exception):
    """A sentence for one line on stderr; the program ends with `status`."""

    status: ClassVar[int]


class Broken(Ending):
    """What ran, and why it is broken."""

    status = BROKEN


class BadInput(Ending, ValueError):
    """Which value, why, and what would be valid."""

    status = REFUSED


class FileTrouble(Ending):
    """Which file, what is wrong with it, and what to do."""

    status = REFUSED
