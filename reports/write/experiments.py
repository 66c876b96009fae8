"""Experiments in which methods fail, as the tables and sentences of a page; and lines on motions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.errors import usable_samples
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Observation
from reports.model.quantities import QUANTITIES
from reports.model.tasks import Motion, trajectory_of
from reports.write import tables
from reports.write.columns import told_variant
from reports.write.rows import Rows
from reports.write.templates import template


@dataclass(frozen=True)
class ToldExperiment:
    """An experiment ready for the templates: `observations` and `grid` are tables, empty without rows."""

    title: str
    expected: str
    observations: str
    grid: str
    remark: str
    unrun: bool = False  # whether there is something to run, and nothing of it was


def told_experiment(failure: Failure, material: Material) -> ToldExperiment:
    """What is said of an experiment from what was run of it."""
    rows = [compared_only(cell, material.rows[cell]) for cell in failure.cells if cell in material.rows]
    seen = tuple(failure.observations(material)) if failure.observations else ()
    run = rows or any(task in material.answers for task in failure.tasks)
    lines = [[o.method, o.setting, o.outcome] for o in seen]
    return ToldExperiment(
        failure.title,
        template(failure.expected).render(**failure.context(material)),
        tables.markdown(["method", "setting", "outcome"], lines, left=3) if seen else "",
        (tables.cell_table(rows, failure.columns) if failure.columns else tables.outcome_grid(rows)) if rows else "",
        told_remark(failure, rows, material),
        unrun=not run and bool(failure.cells or failure.tasks),
    )


def told_remark(failure: Failure, rows: Sequence[Measurement], material: Material) -> str:
    """What the outcomes teach, with its numbers from the rows of the experiment."""

    asked = Rows(rows)

    def at(method: str, step: float) -> Any:
        return asked.of(method=method, purpose="").near(step)

    return template(failure.remark).render(at=at, count=asked.count, **failure.context(material))


def compared_only(cell: Cell, row: Measurement) -> Measurement:
    """The row without its errors where the scene ends before its first sample: only the start was compared."""
    if cell.scene.comparable_until >= cell.scene.duration / cell.sample_count:
        return row
    names = {q.name for q in QUANTITIES} - {"gap", "slip"}  # joints are held against themselves, without a truth
    return replace(row, **dict.fromkeys(names, math.nan))


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


def observe_each(
    material: Material, cells: Iterable[Cell], say: Callable[[Cell, Trajectory], str]
) -> list[Observation]:
    """The lines of several cells, each under its step."""
    return [
        line
        for cell in cells
        for line in observe(material, cell, f"step {tables.number(cell.step)} s", partial(say, cell))
    ]


def _read(run: Trajectory, say: Callable[[Trajectory], str]) -> str:
    count = usable_samples(run)
    if count < len(run.t):
        return f"**{Outcome.DIVERGED}**: not finite from {run.t[count]:.4g} s"
    return say(run)
