"""Lines of a table that are read from kept motions: what is seen in each, or why it has none."""

from __future__ import annotations

from collections.abc import Callable

from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.errors import usable_samples
from reports.model.outcomes import Outcome
from reports.model.page import Material, Observation
from reports.model.tasks import Motion, trajectory_of


def observe(material: Material, cell: Cell, setting: str, say: Callable[[Trajectory], str]) -> tuple[Observation, ...]:
    """The line of one engine, with what `say` reads from its motion; none where it was not run or has no such joint.

    Whatever else became of the run stands in its line: one engine's fault must not cost the page. `say` reads any
    finite motion; where it raises, the mistake is ours and passes.
    """
    answer = material.answers.get(Motion(cell))
    if answer is None or answer.outcome == Outcome.UNSUPPORTED:
        return ()
    told = _read(trajectory_of(answer), say) if answer.finished else answer.told
    return (Observation(f"{cell.engine.name} {cell.engine.variant}", setting, told),)


def _read(run: Trajectory, say: Callable[[Trajectory], str]) -> str:
    count = usable_samples(run)
    if count < len(run.t):
        return f"**{Outcome.DIVERGED}**: not finite from {run.t[count]:.4g} s"
    return say(run)
