"""The format of numbers, text tables and Markdown tables.

This module does not import numpy, so that commands start quickly.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from unicodedata import combining, east_asian_width

DASH = "-"
ENFORCED_BY = "joints enforced by"


def number(value: float, digits: int = 2, unknown: str = DASH, infinite: str = "∞") -> str:
    """A number with `digits` significant digits, such as 1.3e-4, 1e-3, 0.25 or 12. `unknown` is the text for NaN."""
    if not math.isfinite(value):
        return unknown if math.isnan(value) else infinite
    if value == 0:
        return "0"
    if abs(value) < 1e4 and abs(float(f"{value:.{digits - 1}e}")) >= 1e-2:
        return f"{value:.{digits}g}" if abs(value) < 10**digits - 0.5 else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"


def words_of(cell: str | float) -> str:
    """The text of a cell. All digits of an integer are kept."""
    return cell if isinstance(cell, str) else str(cell) if isinstance(cell, int) else number(cell)


def milliseconds(seconds: float, unknown: str = DASH) -> str:
    return number(1e3 * seconds, unknown=unknown)


def step_words(seconds: float, unknown: str = DASH) -> str:
    """A step with its unit, such as '0.33 ms'."""
    return unknown if math.isnan(seconds) else f"{number(1e3 * seconds)} ms"


def text_table(
    header: Sequence[str],
    rows: Iterable[Sequence[str]],
    left: int | None = None,
    separators: tuple[str, str] = ("  ", "  "),
    rule: tuple[str, str] | None = None,
) -> list[str]:
    """The lines of a table for a terminal; the first line is the header.

    Args:
        left: the number of columns that are aligned to the left, or None for all columns.
        separators: the texts between columns in the header and in the rows.
        rule: (character, text between columns) of a line below the header.
    """
    lines = [tuple(header), *map(tuple, rows)]
    widths = [max(map(display_width, column)) for column in zip(*lines, strict=True)]
    left = len(widths) if left is None else left

    def padded(line: Sequence[str], separator: str) -> str:
        spaces = [" " * (width - display_width(cell)) for cell, width in zip(line, widths, strict=True)]
        cells = [cell + pad if i < left else pad + cell for i, (cell, pad) in enumerate(zip(line, spaces, strict=True))]
        return separator.join(cells).rstrip()

    head = [padded(lines[0], separators[0])]
    head += [rule[1].join(rule[0] * width for width in widths)] if rule else []
    return head + [padded(line, separators[1]) for line in lines[1:]]


def display_width(text: str) -> int:
    if text.isascii():
        return len(text)
    return sum(0 if combining(char) else 2 if east_asian_width(char) in "WF" else 1 for char in text)


def markdown(
    header: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1, enforcement: Mapping[str, str] | None = None
) -> str:
    """A Markdown table; the first `left` columns are aligned to the left. `enforcement` (method -> what enforces the
    joints) becomes the second column, after the methods."""
    if enforcement:
        header, left = [header[0], ENFORCED_BY, *header[1:]], left + 1
        rows = [[row[0], enforcement.get(row[0], DASH), *row[1:]] for row in rows]
    lines = [_line(header), _line(["---" if i < left else "--:" for i in range(len(header))])]
    return "\n".join(lines + [_line([cell.replace("|", "\\|").replace("\n", " ") for cell in row]) for row in rows])


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"
