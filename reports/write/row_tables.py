"""Tables of measurements and of their convergence."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from reports.model.convergence import ENOUGH_POINTS, Sweep, Verdict, by_method, groups, sweeps
from reports.model.errors import NAN
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES, quantity
from reports.write.tables import DASH, markdown, milliseconds, number, step_words

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
