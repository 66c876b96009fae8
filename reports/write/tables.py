"""The format of numbers, text tables and Markdown tables."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from unicodedata import combining, east_asian_width

from reports.model.convergence import ENOUGH_POINTS, Sweep, Verdict, by_method, groups, sweeps
from reports.model.errors import NAN
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES, quantity

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


ERROR_HEADER = ("method", "outcome", "step", *(f"{q.label} [{q.unit}]" for q in QUANTITIES), "CPU [ms/s]")


def error_rows(rows: Iterable[Measurement]) -> list[list[str]]:
    return [
        [row.method, row.outcome, step_words(row.step)]
        + [number(getattr(row, q.name)) for q in QUANTITIES]
        + [milliseconds(row.cpu)]
        for members in groups(rows).values()
        for row in members
    ]


def order_rows(swept: Iterable[Sweep], quantities: Sequence[str]) -> list[list[str]]:
    swept = tuple(swept)
    keys = dict.fromkeys((s.scene, s.engine, s.variant) for s in swept)
    columns = [by_method(swept, name) for name in quantities]
    return [[f"{e} {v}", *(sweep_words(c[s, e, v]) for c in columns)] for s, e, v in keys]


def sweep_words(sweep: Sweep, lost: str = "") -> str:
    """A text such as '1.99 (±0.13, 4 points)', '3.9 (2 points, unchecked), then rounding' or 'plateau **2e-5**'. `lost`
    is the outcome at the smallest step, if that run can't be compared."""
    order = ""
    if sweep.points >= 2:
        checked = (
            f"±{sweep.spread:.2g}, {sweep.points} points" if sweep.points >= ENOUGH_POINTS else "2 points, unchecked"
        )
        order = f"{sweep.order:.2f} ({checked})"
    match sweep.verdict:
        case _ if lost and math.isfinite(sweep.best):
            end = f"at the finest step **{lost}**"
        case Verdict.PLATEAU:
            end = f"plateau **{number(sweep.plateau)}**"
        case Verdict.ROUNDING:
            end = "then rounding" if order else "rounding"
        case Verdict.LEVELS | Verdict.GROWS | Verdict.ERRATIC:
            end = f"**{sweep.verdict}**"
        case _:
            end = "" if order or math.isnan(sweep.best) else f"{sweep.verdict}, {number(sweep.best)}"
    return ", ".join(filter(None, (order, end))) or DASH


def error_words(row: Measurement | None, name: str) -> str:
    """The error of a run, the outcome if the run can't be compared, or a dash without a run."""
    if row is None:
        return DASH
    return number(getattr(row, name)) if Outcome(row.outcome).comparable else str(row.outcome)


def outcome_grid(rows: Iterable[Measurement]) -> str:
    """A Markdown table with a line for each method and a column for each step. Raises ValueError if two rows have the
    same method and step."""
    rows = list(rows)
    steps = sorted({row.step for row in rows}, reverse=True)
    by_method_and_step: dict[str, dict[float, str]] = {}
    for row in rows:
        line = by_method_and_step.setdefault(row.method, {})
        if row.step in line:
            raise ValueError(f"outcome grid: there are two rows of {row.method!r} at a step of {step_words(row.step)}")
        line[row.step] = _outcome_in_brief(row)
    body = [[method, *(cells.get(step, "") for step in steps)] for method, cells in by_method_and_step.items()]
    return markdown(["method", *map(step_words, steps)], body, left=len(steps) + 1)


def _outcome_in_brief(row: Measurement) -> str:
    if Outcome(row.outcome).comparable:
        return f"{number(row.angle)} rad"
    if row.outcome == Outcome.TORN and math.isfinite(row.gap):
        return f"**{row.outcome}** {number(max(row.gap, 0.0))} m"
    return f"**{row.outcome}**"


def cell_table(rows: Iterable[Measurement], columns: Sequence[str]) -> str:
    """A Markdown table with the method, the step and the errors of these quantities for each row."""
    quantities = [quantity(name) for name in columns]
    body = []
    for row in rows:
        failed = "" if Outcome(row.outcome).comparable else f" **{row.outcome}**"
        body.append([row.method + failed, step_words(row.step), *(number(getattr(row, q.name)) for q in quantities)])
    return markdown(["method", "step", *(f"{q.label} [{q.unit}]" for q in quantities)], body)


SUMMARY_HEADER = ("method", "angle error [rad]", "at step", "CPU [ms/s]", "order", "plateau [rad]", "outcomes")


def summary_rows(rows: Iterable[Measurement]) -> list[list[str]]:
    rows = list(rows)
    verdicts = by_method(sweeps(rows), "angle")
    out = []
    for key, members in groups(rows).items():
        usable = [row for row in members if Outcome(row.outcome).comparable and math.isfinite(row.angle)]
        best = min(usable, key=lambda row: row.angle, default=None)
        angle, step, cpu = (best.angle, best.step, best.cpu) if best else (NAN, NAN, NAN)
        sweep = verdicts[key]
        order = f"{sweep.order:.1f} ({sweep.points})" if sweep.points >= 2 else DASH
        end = "rounding" if sweep.verdict is Verdict.ROUNDING else number(sweep.plateau)
        outcomes = ", ".join(dict.fromkeys(row.outcome for row in members))
        out.append([members[0].method, number(angle), step_words(step), milliseconds(cpu), order, end, outcomes])
    return out
