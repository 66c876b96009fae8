"""Selections of rows by scene, method and step.

A missing row is UNMEASURED, so that a template leaves out the clause that needs it.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from reference.scene import Scene
from reports.model.cells import is_step
from reports.model.convergence import by_method, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.write.unmeasured import UNMEASURED

# The steps of the grids are half a decade apart, so one of them is nearer than this factor to any step in their range.
NEAREST_WITHIN = 2.0


class Rows(tuple[Measurement, ...]):
    """Rows in their order, with the selections that templates and claims use."""

    __slots__ = ()

    def of(self, scene: str = "", method: str = "", purpose: str = "sweep") -> Rows:
        """The rows of a scene, of a method ("mujoco tuned") and of a purpose; an empty text selects all."""
        wanted = {"scene": scene, "method": method, "purpose": purpose}
        return Rows(
            row for row in self if all(not value or getattr(row, name) == value for name, value in wanted.items())
        )

    def known(self, name: str) -> Rows:
        """The rows with a finite value of this quantity."""
        return Rows(row for row in self if math.isfinite(getattr(row, name)))

    def near(self, step: float) -> Any:
        """The row whose step is nearest to this one [s], by ratio, within a factor of NEAREST_WITHIN."""
        row = min(self, key=lambda row: abs(math.log(row.step / step)), default=None)
        return row if row is not None and max(row.step / step, step / row.step) < NEAREST_WITHIN else UNMEASURED

    def at(self, step: float) -> Any:
        """The row at this step [s], if it can be compared."""
        rows = (row for row in self if is_step(row.step, step))
        return next((row for row in rows if Outcome(row.outcome).comparable), UNMEASURED)

    def best(self, name: str = "angle") -> Any:
        """The row with the least error among those that can be compared."""
        usable = (row for row in self.known(name) if Outcome(row.outcome).comparable)
        return min(usable, key=lambda row: getattr(row, name), default=UNMEASURED)

    def finest(self) -> Any:
        """The row at the smallest step."""
        return min(self, key=lambda row: row.step, default=UNMEASURED)

    def sweep(self, name: str = "angle") -> Any:
        """The convergence of an error as the step goes to zero, from rows of one method in one scene."""
        found = by_method(sweeps(self, [quantity(name)]), name)
        return next(iter(found.values()), UNMEASURED)

    def outcomes(self) -> list[str]:
        """The outcomes of the rows, without repetition."""
        return list(dict.fromkeys(str(row.outcome) for row in self))

    def count(self, *outcomes: str) -> Any:
        """The number of rows with one of these outcomes; of all rows without an argument."""
        return sum(not outcomes or row.outcome in outcomes for row in self) if self else UNMEASURED

    def points(self, name: str) -> list[tuple[float, float]]:
        """(step [s], error) of the rows with a positive finite error, also of failed runs."""
        values = ((row.step, getattr(row, name)) for row in self)
        return [(step, error) for step, error in values if 0 < error < math.inf]


def lookups(material: Material, scenes: Iterable[Scene]) -> dict[str, Any]:
    """The functions by which templates look up the sweeps of some scenes.

    `best(scene, engine, variant)`, `sweep(scene, engine, variant, quantity)`, `at(scene, engine, variant, every)`, and
    `ended(scene, engine, variant)`: the outcomes of the method at its steps.
    """
    rows = Rows(material.sweep(scenes))

    def of(scene: str, engine: str, variant: str) -> Rows:
        return rows.of(scene, f"{engine} {variant}")

    return {
        "best": lambda *method: of(*method).best(),
        "sweep": lambda scene, engine, variant, name="angle": of(scene, engine, variant).sweep(name),
        "at": lambda scene, engine, variant, every: next(
            (row for row in of(scene, engine, variant) if row.every == every), UNMEASURED
        ),
        "ended": lambda *method: of(*method).outcomes(),
    }


def rows_of_pages(pages: Mapping[Page, Material]) -> Rows:
    """The rows of the pages' scenes, from coarse to fine, without scenes whose numbers a user changed."""
    scenes = {scene.name: scene for page in pages for scene in page.scenes}
    rows = {
        cell: row
        for material in pages.values()
        for cell, row in material.rows.items()
        if scenes.get(cell.scene.name) == cell.scene
    }
    return Rows(sorted(rows.values(), key=lambda row: -row.step))
