"""Numbers and rows as text: the one number format, the one text table, and Markdown tables."""

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
    """A number as text with this many significant digits: 1.3e-4, 1e-3, 0.25, 12.

    All of `reports` formats numbers by this function. A caller passes its own texts for NaN and infinity:
    `number(error, infinite="gave up")` for a run that diverged, `number(value, unknown=UNKNOWN_MARK)` in a sentence.
    """
    if not math.isfinite(value):
        return unknown if math.isnan(value) else infinite
    if value == 0:
        return "0"
    if abs(value) < 1e4 and abs(float(f"{value:.{digits - 1}e}")) >= 1e-2:
        return f"{value:.{digits}g}" if abs(value) < 10**digits - 0.5 else f"{value:.0f}"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return f"{mantissa.rstrip('0').rstrip('.') if '.' in mantissa else mantissa}e{int(exponent)}"


def words_of(cell: str | float) -> str:
    """A cell as text: a text unchanged, an integer with all digits, another number by `number`."""
    return cell if isinstance(cell, str) else str(cell) if isinstance(cell, int) else number(cell)


def milliseconds(seconds: float, unknown: str = DASH) -> str:
    """CPU seconds as milliseconds, without the unit."""
    return number(1e3 * seconds, unknown=unknown)


def step_words(seconds: float, unknown: str = DASH) -> str:
    """A step with its unit: '10 ms', '0.33 ms'."""
    return unknown if math.isnan(seconds) else f"{number(1e3 * seconds)} ms"


def text_table(
    header: Sequence[str],
    rows: Iterable[Sequence[str]],
    left: int | None = None,
    separators: tuple[str, str] = ("  ", "  "),
    rule: tuple[str, str] | None = None,
) -> list[str]:
    """Lines of a table in aligned columns, for a terminal; the header is the first line.

    Args:
        left: how many of the first columns are aligned to the left; None for all of them.
        separators: the text between two columns in the header, and in the rows.
        rule: (character, text between two columns) of a line below the header; None for no such line.
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
    """The width of a text on a terminal: two columns for a wide character, none for a combining one."""
    if text.isascii():
        return len(text)
    return sum(0 if combining(char) else 2 if east_asian_width(char) in "WF" else 1 for char in text)


def markdown(
    header: Sequence[str], rows: Iterable[Sequence[str]], left: int = 1, enforcement: Mapping[str, str] | None = None
) -> str:
    """A Markdown table; the first `left` columns are texts, the others numbers. A bar in a cell is escaped.

    `enforcement`: what enforces the joints, by method. It becomes a column after the first one, which has the methods.
    """
    if enforcement:
        header, left = [header[0], ENFORCED_BY, *header[1:]], left + 1
        rows = [[row[0], enforcement.get(row[0], DASH), *row[1:]] for row in rows]
    lines = [_line(header), _line(["---" if i < left else "--:" for i in range(len(header))])]
    return "\n".join(lines + [_line([cell.replace("|", "\\|").replace("\n", " ") for cell in row]) for row in rows])


def _line(cells: Iterable[str]) -> str:
    return "| " + " | ".join(cells) + " |"


ERROR_HEADER = ("method", "outcome", "step", *(f"{q.label} [{q.unit}]" for q in QUANTITIES), "CPU [ms/s]")


def error_rows(rows: Iterable[Measurement]) -> list[list[str]]:
    """The largest error of each quantity in each cell of one scene, by method and step, for ERROR_HEADER."""
    return [
        [row.method, row.outcome, step_words(row.step)]
        + [number(getattr(row, q.name)) for q in QUANTITIES]
        + [milliseconds(row.cpu)]
        for members in groups(rows).values()
        for row in members
    ]


def order_rows(swept: Iterable[Sweep], quantities: Sequence[str]) -> list[list[str]]:
    """A line for each method: its name, then order and plateau of each quantity."""
    swept = tuple(swept)
    keys = dict.fromkeys((s.scene, s.engine, s.variant) for s in swept)
    columns = [by_method(swept, name) for name in quantities]
    return [[f"{e} {v}", *(sweep_words(c[s, e, v]) for c in columns)] for s, e, v in keys]


def sweep_words(sweep: Sweep, lost: str = "") -> str:
    """'1.99 (±0.13, 4 points)', '3.9 (2 points, unchecked), then rounding', 'plateau **2e-5**', or a dash.

    `lost`: the outcome of the finest step, if that can't be compared.
    """
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
    """The error of a run; its outcome if the run can't be compared; a dash without a run."""
    if row is None:
        return DASH
    return number(getattr(row, name)) if Outcome(row.outcome).comparable else str(row.outcome)


def outcome_grid(rows: Iterable[Measurement]) -> str:
    """A table of an experiment: a line for each method, a column for each step, the outcome and a number in each cell.

    Raises ValueError if two rows have the same method and step.
    """
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
    """The outcome with one number: the gap of a torn loop, otherwise the angle error."""
    if Outcome(row.outcome).comparable:
        return f"{number(row.angle)} rad"
    if row.outcome == Outcome.TORN and math.isfinite(row.gap):
        return f"**{row.outcome}** {number(max(row.gap, 0.0))} m"
    return f"**{row.outcome}**"


def cell_table(rows: Iterable[Measurement], columns: Sequence[str]) -> str:
    """A line for each row: method (with the outcome of a failed run), step, the largest errors of these quantities."""
    quantities = [quantity(name) for name in columns]
    body = []
    for row in rows:
        failed = "" if Outcome(row.outcome).comparable else f" **{row.outcome}**"
        body.append([row.method + failed, step_words(row.step), *(number(getattr(row, q.name)) for q in quantities)])
    return markdown(["method", "step", *(f"{q.label} [{q.unit}]" for q in quantities)], body)


SUMMARY_HEADER = ("method", "angle error [rad]", "at step", "CPU [ms/s]", "order", "plateau [rad]", "outcomes")


def summary_rows(rows: Iterable[Measurement]) -> list[list[str]]:
    """A line for each method of one scene, for SUMMARY_HEADER: least angle error, order (and its points), plateau."""
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
