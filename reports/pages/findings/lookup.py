"""The rows that findings speak of, asked for by scene, method and step."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from reports.model.cells import Cell
from reports.model.convergence import by_method, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.usual_steps import is_step
from reports.write.unmeasured import UNMEASURED

Points = list[tuple[float, float]]  # (step [s], error), from coarse to fine


class Rows:
    """What was measured in the scenes of the pages; scenes with other numbers are left out."""

    def __init__(self, pages: Mapping[Page, Material]) -> None:
        scenes = {scene.name: scene for page in pages for scene in page.scenes}
        self._scenes = scenes
        self._rows: dict[Cell, Measurement] = {
            cell: row
            for material in pages.values()
            for cell, row in material.rows.items()
            if scenes.get(cell.scene.name) == cell.scene
        }

    def seconds(self, scene: str) -> float:
        """How long a scene is [s]; NaN where there is none of this name."""
        return self._scenes[scene].duration if scene in self._scenes else math.nan

    def of(self, scene: str, method: str, purpose: str = "sweep") -> list[Measurement]:
        """A method's rows from coarse to fine."""
        found = [
            row
            for cell, row in self._rows.items()
            if (cell.scene.name, cell.purpose, row.method) == (scene, purpose, method)
        ]
        return sorted(found, key=lambda row: -row.step)

    def at(self, step: float, scene: str, method: str, purpose: str = "sweep") -> Any:
        """The row at this step [s]; UNMEASURED without one, or with one that can't be compared."""
        rows = (row for row in self.of(scene, method, purpose) if is_step(row.step, step))
        return next((row for row in rows if Outcome(row.outcome).comparable), UNMEASURED)

    def sweep(self, scene: str, method: str, quantity: str = "angle") -> Any:
        """What the error does as the step goes to zero; UNMEASURED without rows."""
        found = by_method(sweeps(self.of(scene, method)), quantity)
        return next(iter(found.values()), UNMEASURED)


def points(rows: Iterable[Measurement], quantity: str) -> Points:
    """Errors by step, those of failed runs too where they are known."""
    values = ((row.step, getattr(row, quantity)) for row in rows)
    return [(step, error) for step, error in values if 0 < error < math.inf]
