"""What open pins cost: the work of joints' forces while the points of a pin move apart, beside the energy lost."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from engines import Engine
from reference.trajectory import energy
from reports.model.cells import Cell
from reports.model.tasks import Task, Values


@dataclass(frozen=True)
class OpenWork(Task):
    """`lost`: the change of energy over the motion [J]; `work` (rows,): sum of reaction times opening of a row [J].

    The cell's motion is sampled at every step. A row's gap counts from the first body to the second and its reaction
    acts on the second, so that opening against a force that pulls together is negative work.
    """

    cell: Cell

    @property
    def cost(self) -> float:
        return 0.1

    @property
    def label(self) -> str:
        return f"work at open pins: {self.cell.label}"

    @property
    def engine(self) -> Engine:
        return self.cell.engine

    def run(self) -> Values:
        mechanism = self.cell.scene.mechanism()
        run = self.cell.engine.build(mechanism, self.cell.step)(self.cell.sample_count * self.cell.every, 1)
        gap = np.nan_to_num(mechanism.gap(run.pose, run.t))
        force = np.nan_to_num(run.reaction)  # a change of velocity is not told at the start
        own = energy(mechanism, run)
        work = np.sum((force[1:] + force[:-1]) / 2 * np.diff(gap, axis=0), axis=0)
        return {"lost": np.array(own[-1] - own[0]), "work": work}
