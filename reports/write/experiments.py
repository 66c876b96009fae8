"""Rendering of experiments, and observations on motions."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
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
from reports.write import row_tables, tables
from reports.write.columns import displayed_variant
from reports.write.rows import Rows
from reports.write.templates import template


@dataclass(frozen=True)
class RenderedExperiment:
    """The texts and tables of an experiment. observations, grid: tables in Markdown, which are empty without
    observations or rows. unrun: whether the experiment has cells or tasks of which none was run."""

    title: str
    expected: str
    observations: str
    grid: str
    remark: str
    unrun: bool = False


def render_experiment(failure: Failure, material: Material) -> RenderedExperiment:
    rows = [without_incomparable_errors(cell, material.rows[cell]) for cell in failure.cells if cell in material.rows]
    experiment = Rows(rows)

    def at(method: str, step: float) -> Any:
        return experiment.of(method=method, purpose="").near(step)

    observations = tuple(failure.observations(material)) if failure.observations else ()
    was_run = rows or any(task in material.answers for task in failure.tasks)
    lines = [[seen.method, seen.setting, seen.outcome] for seen in observations]
    grid = row_tables.cell_table(rows, failure.columns) if failure.columns else row_tables.outcome_grid(rows)
    return RenderedExperiment(
        failure.title,
        template(failure.expected).render(**failure.context(material)),
        tables.markdown(["method", "setting", "outcome"], lines, left=3) if observations else "",
        grid if rows else "",
        template(failure.remark).render(at=at, count=experiment.count, **failure.context(material)),
        unrun=not was_run and bool(failure.cells or failure.tasks),
    )


def without_incomparable_errors(cell: Cell, row: Measurement) -> Measurement:
    """The row. If only the sample at t = 0 can be compared, the errors by the reference motion become NaN."""
    if cell.scene.comparable_until >= cell.scene.duration / cell.sample_count:
        return row
    return replace(row, **{quantity.name: math.nan for quantity in QUANTITIES if quantity.needs_truth})


def observe(
    material: Material, cell: Cell, setting: str, describe: Callable[[Trajectory], str]
) -> tuple[Observation, ...]:
    """The observation on one motion; empty if it was not run or if the engine does not build the mechanism. `describe`
    is called only with a finite motion. For another motion the observation is the outcome of the run.
    """
    answer = material.answers.get(Motion(cell))
    if answer is None or answer.outcome == Outcome.UNSUPPORTED:
        return ()
    outcome = answer.told
    if answer.finished:
        run = trajectory_of(answer)
        count = usable_samples(run)
        is_finite = count == len(run.t)
        outcome = describe(run) if is_finite else f"**{Outcome.DIVERGED}**: not finite from {run.t[count]:.4g} s"
    method = f"{cell.engine.name} {displayed_variant(cell.scene, cell.engine)}"
    return (Observation(method, setting, outcome),)


def observe_each(
    material: Material, cells: Iterable[Cell], describe: Callable[[Cell, Trajectory], str]
) -> list[Observation]:
    """The observations on the motions of cells. The setting of an observation is the step."""
    return [
        line
        for cell in cells
        for line in observe(material, cell, f"step {tables.number(cell.step)} s", partial(describe, cell))
    ]
