"""All mechanisms, a table an engine: errors at the steps that people use, what a smaller step brings, who holds."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from reports.model.convergence import Sweep, Verdict, by_method, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Page
from reports.model.quantities import quantity
from reports.model.usual_steps import USUAL_STEPS, is_step, usual_variants
from reports.write.holders import held_in
from reports.write.tables import NOTHING, markdown, number

Entry = tuple[Page, Sequence[Measurement]]  # a page, and the rows of those of its scenes that are to be shown


def overviews(entries: Iterable[Entry], steps: Mapping[str, float] = USUAL_STEPS, folder: str = "") -> dict[str, str]:
    """Engine -> its table: the errors of its usual variants at these steps [s] by name, a line a scene.

    `folder` is where the pages stand. No cell has a time: the same versions give the same table on every machine.
    """
    entries = tuple(entries)
    usual = usual_variants((row.engine, row.variant) for _, rows in entries for row in rows)
    return {engine: _table(entries, engine, variants, steps, folder) for engine, variants in usual.items()}


def _table(
    entries: Sequence[Entry], engine: str, variants: Sequence[str], steps: Mapping[str, float], folder: str
) -> str:
    lines = []
    for page, rows in entries:
        for scene in dict.fromkeys(row.scene for row in rows):
            own = [row for row in rows if row.scene == scene]
            unit = quantity(page.quantity).unit
            name = f"[{scene.replace('_', ' ')}]({folder}{page.name}.md), {unit}"
            lines.append([name, *(_cell(page, scene, own, engine, variant, steps) for variant in variants)])
    return markdown(["scene", *(f"{engine} {variant}" for variant in variants)], lines, left=1 + len(variants))


def _cell(
    page: Page, scene: str, rows: Sequence[Measurement], engine: str, variant: str, steps: Mapping[str, float]
) -> str:
    """'0.32, 0.029, 0.01; plateau 0.011; engine', or the outcomes where no step gave an answer."""
    members = [row for row in rows if (row.engine, row.variant) == (engine, variant)]
    if not members:
        return NOTHING
    if not any(Outcome(row.outcome).comparable for row in members):
        outcomes = dict.fromkeys(row.outcome for row in members)
        held = "" if Outcome.UNSUPPORTED in outcomes else _holder(page, scene, engine, variant)
        return "; ".join(filter(None, (", ".join(outcomes), held)))
    sweep = by_method(sweeps(members), page.quantity).get((scene, engine, variant))
    at = [next((row for row in members if is_step(row.step, step)), None) for step in steps.values()]
    errors = [getattr(row, page.quantity) for row in at if row is not None and Outcome(row.outcome).comparable]
    words = [_error(row, page.quantity) for row in at]
    told = words if len(set(words)) > 1 else words[:1]  # "saturated" once
    end = _brought(sweep, members, errors) if sweep else ""
    return "; ".join(filter(None, (", ".join(told), end, _holder(page, scene, engine, variant))))


def _error(row: Measurement | None, name: str) -> str:
    """The error at one step, the outcome where it can't be compared, a dash where the step was not run."""
    if row is None:
        return NOTHING
    return number(getattr(row, name)) if Outcome(row.outcome).comparable else str(row.outcome)


def _brought(sweep: Sweep, members: Iterable[Measurement], told: Sequence[float]) -> str:
    """What a smaller step brings: an order only where the error falls to the finest step."""
    finest = min((row for row in members if row.purpose == "sweep"), key=lambda row: row.step)
    if not Outcome(finest.outcome).comparable:
        return f"**{finest.outcome}** at {_step(finest.step)}"
    match sweep.verdict:
        case Verdict.PLATEAU:
            luck = " (less is luck)" if any(error < sweep.plateau / 2 for error in told) else ""
            return f"**plateau {number(sweep.plateau)}**{luck}"
        case Verdict.ROUNDING:
            return "to rounding"
        case Verdict.FALLS if sweep.points >= 2:
            return f"order {sweep.order:.1f}"
        case Verdict.LEVELS:
            return "**levels off**"
        case Verdict.GROWS | Verdict.ERRATIC:
            return f"**least at {_step(sweep.best_step)}**, then worse"
        case _:
            return ""


def _step(step: float) -> str:
    return f"{number(1e3 * step)} ms"


def _holder(page: Page, scene: str, engine: str, variant: str) -> str:
    """Who holds the scene's joints; empty for a method that is no longer in the page's list."""
    for known in page.scenes:
        for method in page.engines:
            if (known.name, method.name, method.variant) == (scene, engine, variant):
                held = held_in(known, method)
                # An engine as shipped has no joint that our code holds: that is what a user puts in its place.
                return f"{held}, a user's trick" if variant == "default" and "ours" in held.split(": ") else held
    return ""
