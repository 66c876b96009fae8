"""Experiments in which methods fail, rendered for a page; and observations on motions."""

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
from reports.write.columns import displayed_variant
from reports.write.rows import Rows
from reports.write.templates import template


@dataclass(frozen=True)
class RenderedExperiment:
    """The texts and tables of an experiment; `observations` and `grid` are empty without rows."""

    title: str
    expected: str
    observations: str
    grid: str
    remark: str
    unrun: bool = False  # the experiment has cells or tasks, and none of them was run


def render_experiment(failure: Failure, material: Material) -> RenderedExperiment:
    """The texts and tables of an experiment from the rows and answers of its run."""
    rows = [without_incomparable_errors(cell, material.rows[cell]) for cell in failure.cells if cell in material.rows]
    observations = tuple(failure.observations(material)) if failure.observations else ()
    was_run = rows or any(task in material.answers for task in failure.tasks)
    lines = [[seen.method, seen.setting, seen.outcome] for seen in observations]
    return RenderedExperiment(
        failure.title,
        template(failure.expected).render(**failure.context(material)),
        tables.markdown(["method", "setting", "outcome"], lines, left=3) if observations else "",
        (tables.cell_table(rows, failure.columns) if failure.columns else tables.outcome_grid(rows)) if rows else "",
        _render_remark(failure, rows, material),
        unrun=not was_run and bool(failure.cells or failure.tasks),
    )


def _render_remark(failure: Failure, rows: Sequence[Measurement], material: Material) -> str:
    experiment = Rows(rows)

    def at(method: str, step: float) -> Any:
        return experiment.of(method=method, purpose="").near(step)

    return template(failure.remark).render(at=at, count=experiment.count, **failure.context(material))


def without_incomparable_errors(cell: Cell, row: Measurement) -> Measurement:
    """The row; without errors that need the truth if the scene's comparison ends before its first sample."""
    if cell.scene.comparable_until >= cell.scene.duration / cell.sample_count:
        return row
    return replace(row, **{quantity.name: math.nan for quantity in QUANTITIES if quantity.needs_truth})


def observe(
    material: Material, cell: Cell, setting: str, describe: Callable[[Trajectory], str]
) -> tuple[Observation, ...]:
    """The observation on one engine's motion; none if it was not run or has no such joint.

    A run that failed or is not finite is reported as such, so that the page is rendered. `describe` gets finite motions
    only; an exception that it raises is an error of this suite and passes through.
    """
    answer = material.answers.get(Motion(cell))
    if answer is None or answer.outcome == Outcome.UNSUPPORTED:
        return ()
    outcome = _describe_finite(trajectory_of(answer), describe) if answer.finished else answer.told
    method = f"{cell.engine.name} {displayed_variant(cell.scene, cell.engine)}"
    return (Observation(method, setting, outcome),)


def observe_each(
    material: Material, cells: Iterable[Cell], describe: Callable[[Cell, Trajectory], str]
) -> list[Observation]:
    """The observations on several cells, each with its step."""
    return [
        line
        for cell in cells
        for line in observe(material, cell, f"step {tables.number(cell.step)} s", partial(describe, cell))
    ]


def _describe_finite(run: Trajectory, describe: Callable[[Trajectory], str]) -> str:
    count = usable_samples(run)
    if count < len(run.t):
        return f"**{Outcome.DIVERGED}**: not finite from {run.t[count]:.4g} s"
    return describe(run)
