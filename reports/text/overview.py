"""All mechanisms in one table: what each engine's variants reach in a scene, at what cost, and whether more helps."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from reports.grid.convergence import Verdict, best_of, by_method, sweeps
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.pages.page import Page
from reports.text.tables import markdown, milliseconds, number

COLUMNS = tuple((engine, variant) for engine in ("pymunk", "mujoco") for variant in ("default", "tuned", "extended"))
BEGIN, END = "<!-- overview: written by `crosscheck report` -->", "<!-- end of overview -->"


def overview(entries: Iterable[tuple[Page, Sequence[Measurement]]], folder: str = "") -> str:
    """The table; `entries` are a page and the judged rows of the scenes to show; `folder` is where the pages stand."""
    lines = []
    for page, rows in entries:
        for scene in dict.fromkeys(row.scene for row in rows):
            own = [row for row in rows if row.scene == scene]
            name = f"[{scene.replace('_', ' ')}]({folder}{page.name}.md)"
            lines.append([name, *(_cell(own, page.quantity, *column) for column in COLUMNS)])
    return markdown(["scene", *(" ".join(column) for column in COLUMNS)], lines, left=1 + len(COLUMNS))


def _cell(rows: Sequence[Measurement], quantity: str, engine: str, variant: str) -> str:
    """'1.7e-12 rad, 11 ms, order 6', '9e-3 rad, 2 ms, stays', or the outcome where no step gave an answer.

    The last words say what a smaller step brings: an order only where the error falls to the finest step.
    """
    members = [row for row in rows if (row.engine, row.variant) == (engine, variant)]
    best = best_of(members, engine, variant, quantity)
    if best is None:
        return ", ".join(dict.fromkeys(row.outcome for row in members)) or "-"
    sweep = by_method(sweeps(members), quantity)[members[0].scene, engine, variant]
    finest = min(members, key=lambda row: row.step)
    match sweep.verdict:
        case _ if not Outcome(finest.outcome).comparable:
            end = f", then **{finest.outcome}**"
        case Verdict.PLATEAU:
            end = ", **stays**"
        case Verdict.ROUNDING:
            end = ", to rounding"
        case Verdict.FALLS if sweep.points >= 2:
            end = f", order {sweep.order:.1f}"
        case Verdict.LEVELS:
            end = ", **levels off**"
        case Verdict.GROWS:
            end = ", **grows**"
        case Verdict.ERRATIC:
            end = ", **erratic**"
        case _:
            end = ""
    return f"{number(getattr(best, quantity))} {sweep.quantity.unit}, {milliseconds(best.cpu)} ms{end}"


def with_overview(text: str, table: str) -> str:
    """A document with the table between its two marks; raises ValueError where a mark is missing."""
    before, begin, rest = text.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise ValueError(f"the document lacks the marks {BEGIN!r} and {END!r}")
    return f"{before}{begin}\n{table}\n{end}{after}"
