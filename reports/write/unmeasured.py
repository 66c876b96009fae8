"""Missing numbers in templates. A clause that lacks a number is left out.

A lookup without a row returns `UNMEASURED`. UNMEASURED is false and NaN, and each of its attributes is UNMEASURED. A
template prints NaN as UNKNOWN_MARK. `{% filter if_measured %}` removes the text up to `{% endfilter %}` if this text
contains UNKNOWN_MARK. `without_marks` replaces other marks by NOT_MEASURED.
"""

from __future__ import annotations

import re
from functools import partial
from typing import Any

from reports.write import tables

UNKNOWN_MARK = "\ue000"  # a private-use character, which no text contains
NOT_MEASURED = "(not measured)"
# A line with only a picture that has no file.
MISSING_PICTURE = re.compile(rf"^!\[[^\n]*\]\({UNKNOWN_MARK}\)\n", re.MULTILINE)


class Unmeasured(float):
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
    def __missing__(self, key: Any) -> Any:
        return UNMEASURED


def marked(value: Any) -> Any:
    return UNKNOWN_MARK if value is None or value != value else value


def if_measured(clause: str) -> str:
    return "" if UNKNOWN_MARK in clause else clause


# A dash for an unknown number could be read as a minus sign in a sentence.
number = partial(tables.number, unknown=UNKNOWN_MARK)
milliseconds = partial(tables.milliseconds, unknown=UNKNOWN_MARK)
step = partial(tables.step_words, unknown=UNKNOWN_MARK)


def formatted(pattern: str, *values: Any) -> str:
    """`pattern % values`, or UNKNOWN_MARK if a value is unknown."""
    return UNKNOWN_MARK if any(marked(value) is UNKNOWN_MARK for value in values) else pattern % values


FILTERS = {
    "if_measured": if_measured,
    "number": number,
    "milliseconds": milliseconds,
    "step": step,
    "format": formatted,
}


def without_marks(text: str) -> str:
    """The text without pictures that have no file, and with NOT_MEASURED for missing numbers."""
    return MISSING_PICTURE.sub("", text).replace(UNKNOWN_MARK, NOT_MEASURED)
