"""Experiments in which methods fail: a line each for the page, all numbers for the data page; and lines on motions."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.errors import usable_samples
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation
from reports.model.quantities import QUANTITIES, quantity
from reports.model.tasks import Motion, trajectory_of
from reports.write import tables
from reports.write.holders import told_variant
from reports.write.rows import Rows
from reports.write.templates import template


@dataclass(frozen=True)
class ToldExperiment:
    """An experiment ready for the templates: `happened` is one line, the others are tables, empty without rows."""

    title: str
    expected: str
    happened: str
    observations: str
    grid: str
    details: str
    remark: str
    unrun: bool = False  # whether there is something to run, and nothing of it was


def told_experiment(failure: Failure, material: Material, held: Mapping[str, str] | None = None) -> ToldExperiment:
    """What is said of an experiment from what was run of it; `held`: who holds the joints, by method."""
    rows = [compared_only(cell, material.rows[cell]) for cell in failure.cells if cell in material.rows]
    seen = tuple(failure.observations(material)) if failure.observations else ()
    run = rows or any(task in material.answers for task in failure.tasks)
    grid = tables.cell_table(rows, failure.columns, held) if failure.columns else tables.outcome_grid(rows, held)
    return ToldExperiment(
        failure.title,
        template(failure.expected).render(**failure.words(material)),
        happened(rows, seen, failure.columns[0] if failure.columns else "angle"),
        tables.markdown(["method", "setting", "outcome"], [[o.method, o.setting, o.outcome] for o in seen], left=3)
        if seen
        else "",
        grid if rows else "",
        tables.outcome_table(rows, held) if any(row.sentence for row in rows) else "",
        told_remark(failure, rows, material),
        unrun=not run and bool(failure.cells or failure.tasks),
    )


def told_remark(failure: Failure, rows: Sequence[Measurement], material: Material) -> str:
    """What the outcomes teach, with its numbers from the rows of the experiment."""

    asked = Rows(rows)

    def at(method: str, step: float) -> Any:
        return asked.of(method=method, purpose="").near(step)

    return template(failure.remark).render(at=at, count=asked.count, **failure.words(material))


def compared_only(cell: Cell, row: Measurement) -> Measurement:
    """The row without its errors where the scene ends before its first sample: only the start was compared."""
    if cell.scene.comparable_until >= cell.scene.duration / cell.sample_count:
        return row
    names = {q.name for q in QUANTITIES} - {"gap", "slip"}  # joints are held against themselves, without a truth
    return replace(row, **dict.fromkeys(names, math.nan))


def happened(rows: Sequence[Measurement], seen: Sequence[Observation], name: str = "angle") -> str:
    """'Of 12 runs 8 ended with an angle error of 1.0e-5 to 0.33 rad, 3 torn, 1 reset.', or the first and last line of
    what was observed where nothing was run."""
    if rows:
        return _counted(rows, name)
    lines = dict.fromkeys((seen[0], seen[-1])) if seen else ()
    return " ".join(f"{line.method}{f' ({line.setting})' if line.setting else ''}: {line.outcome}." for line in lines)


def _counted(rows: Sequence[Measurement], name: str) -> str:
    told = quantity(name)
    compared = [row for row in rows if Outcome(row.outcome).comparable]
    errors = sorted(value for row in compared if math.isfinite(value := getattr(row, name)))
    parts = []
    if errors:
        least, most = tables.number(errors[0]), tables.number(errors[-1])
        span = least if least == most else f"{least} to {most}"
        parts.append(f"{len(errors)} ended with {_article(told.label)} error of {span} {told.unit}")
    if len(compared) > len(errors):
        parts.append(f"{len(compared) - len(errors)} ended and had nothing to be compared with")
    parts += [f"{count} **{outcome}**" for outcome, count in _others(rows)]
    runs = f"{len(rows)} run{'s' if len(rows) > 1 else ''}"
    return f"Of {runs}: {', '.join(parts)}."


def _others(rows: Iterable[Measurement]) -> list[tuple[str, int]]:
    """The outcomes that are no answer with how often they came, the most frequent first."""
    return Counter(str(row.outcome) for row in rows if not Outcome(row.outcome).comparable).most_common()


def _article(word: str) -> str:
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"


def observe(material: Material, cell: Cell, setting: str, say: Callable[[Trajectory], str]) -> tuple[Observation, ...]:
    """The line of one engine, with what `say` reads from its motion; none where it was not run or has no such joint.

    Whatever else became of the run stands in its line: one engine's fault must not cost the page. `say` reads any
    finite motion; where it raises, the mistake is ours and passes.
    """
    answer = material.answers.get(Motion(cell))
    if answer is None or answer.outcome == Outcome.UNSUPPORTED:
        return ()
    told = _read(trajectory_of(answer), say) if answer.finished else answer.told
    return (Observation(f"{cell.engine.name} {told_variant(cell.scene, cell.engine)}", setting, told),)


def _read(run: Trajectory, say: Callable[[Trajectory], str]) -> str:
    count = usable_samples(run)
    if count < len(run.t):
        return f"**{Outcome.DIVERGED}**: not finite from {run.t[count]:.4g} s"
    return say(run)
