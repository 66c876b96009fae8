"""Missing numbers in templates: a clause that lacks a number is left out, and the page is rendered all the same.

A lookup without a row returns `UNMEASURED`, which replaces the row and each of its numbers: it is false, it is NaN, and
each of its attributes is itself. Printed, it becomes UNKNOWN_MARK, as every NaN does. `{% filter if_measured %}` leaves
out the text up to `{% endfilter %}` if it contains a mark; `without_marks` replaces the marks that remain by a text.
"""

from __future__ import annotations

import re
from functools import partial
from typing import Any

from reports.write import tables

UNKNOWN_MARK = "\ue000"  # a private character of Unicode, which no text contains
NOT_MEASURED = "(not measured)"
# A line with nothing but a picture whose file is missing.
MISSING_PICTURE = re.compile(rf"^!\[[^\n]*\]\({UNKNOWN_MARK}\)\n", re.MULTILINE)


class Unmeasured(float):
    """NaN in place of a missing row and of every number in it."""

    def __new__(cls) -> Unmeasured:
        return super().__new__(cls, "nan")

    def __bool__(self) -> bool:
        return False

    def __getattr__(self, name: str) -> Unmeasured:
        if name.startswith("__"):
            raise AttributeError(name)
        return self

    def __getitem__(self, key: Any) -> Unmeasured:
        return self

    def __str__(self) -> str:
        return UNKNOWN_MARK


UNMEASURED: Any = Unmeasured()


class MissingAsNaN(dict[Any, Any]):
    """A dictionary that returns UNMEASURED for a missing key."""

    def __missing__(self, key: Any) -> Any:
        return UNMEASURED


def marked(value: Any) -> Any:
    """The value; UNKNOWN_MARK for None and NaN."""
    return UNKNOWN_MARK if value is None or value != value else value


def if_measured(clause: str) -> str:
    """The clause; an empty text if one of its numbers is missing."""
    return "" if UNKNOWN_MARK in clause else clause


# Numbers in sentences, where a dash in place of an unknown number would be read as a sign.
number = partial(tables.number, unknown=UNKNOWN_MARK)
milliseconds = partial(tables.milliseconds, unknown=UNKNOWN_MARK)
step = partial(tables.step_words, unknown=UNKNOWN_MARK)


def formatted(pattern: str, *values: Any) -> str:
    """The pattern of the % operator with these values; UNKNOWN_MARK if one is unknown."""
    return UNKNOWN_MARK if any(marked(value) is UNKNOWN_MARK for value in values) else pattern % values


FILTERS = {
    "if_measured": if_measured,
    "number": number,
    "milliseconds": milliseconds,
    "step": step,
    "format": formatted,
}


def without_marks(text: str) -> str:
    """The page without pictures whose files are missing, and with NOT_MEASURED for missing numbers."""
    return MISSING_PICTURE.sub("", text).replace(UNKNOWN_MARK, NOT_MEASURED)
