"""What a template says where a number is missing: a clause without all its numbers vanishes, and no page breaks.

A lookup that finds no row gives `UNMEASURED`, which stands for a row as well as for a number: it is false, it is NaN,
and each of its attributes is itself. A template that prints it, or any NaN, prints MARK. `{% filter if_measured %}`
leaves out the text up to `{% endfilter %}` if a mark is in it; `without_marks` makes words of the marks that remain.
"""

from __future__ import annotations

import re
from functools import partial
from typing import Any

from reports.write import tables

MARK = "\ue000"  # of Unicode's private characters: no text has it
WORDS = "(not measured)"
# A picture alone on its line, whose file is missing.
PICTURE = re.compile(rf"^!\[[^\n]*\]\({MARK}\)\n", re.MULTILINE)


class Unmeasured(float):
    """The NaN that stands for a row that is not there, and for every number in it."""

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
        return MARK


UNMEASURED: Any = Unmeasured()


class Known(dict[Any, Any]):
    """What is there by its key; UNMEASURED for any other key."""

    def __missing__(self, key: Any) -> Any:
        return UNMEASURED


def marked(value: Any) -> Any:
    """A value as it is printed; MARK for None and NaN."""
    return MARK if value is None or value != value else value


def if_measured(clause: str) -> str:
    """A clause with all its numbers; nothing if one is missing."""
    return "" if MARK in clause else clause


# Numbers in sentences, where a dash can't stand for an unknown one.
number = partial(tables.number, unknown=MARK)
milliseconds = partial(tables.milliseconds, unknown=MARK)
step = partial(tables.step_words, unknown=MARK)


def formatted(pattern: str, *values: Any) -> str:
    """Values in a pattern of the % operator; MARK if one is unknown."""
    return MARK if any(marked(value) is MARK for value in values) else pattern % values


FILTERS = {
    "if_measured": if_measured,
    "number": number,
    "milliseconds": milliseconds,
    "step": step,
    "format": formatted,
}


def without_marks(text: str) -> str:
    """A page without pictures whose files are missing, and with WORDS for the numbers that are."""
    return PICTURE.sub("", text).replace(MARK, WORDS)
