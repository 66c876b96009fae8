"""Rows that are asked for by scene, method and step. What is not there is UNMEASURED, so that its clause can vanish."""

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

# Steps of the grids are half a decade apart: one of them is nearer to any step between its ends than this factor.
ABOUT = 2.0


class Rows(tuple[Measurement, ...]):
    """Rows in their order; every question about some of them is asked here."""

    __slots__ = ()

    def of(self, scene: str = "", method: str = "", purpose: str = "sweep") -> Rows:
        """Those of a scene, of a method ("mujoco tuned") and of a purpose; an empty word leaves it open."""
        asked = {"scene": scene, "method": method, "purpose": purpose}
        wanted = {name: value for name, value in asked.items() if value}
        return Rows(row for row in self if all(getattr(row, name) == value for name, value in wanted.items()))

    def known(self, name: str) -> Rows:
        """Those that have a number for this quantity."""
        return Rows(row for row in self if math.isfinite(getattr(row, name)))

    def near(self, step: float) -> Any:
        """The row whose step is nearest to this one [s], by ratio, within a factor of ABOUT."""
        row = min(self, key=lambda row: abs(math.log(row.step / step)), default=None)
        return row if row is not None and max(row.step / step, step / row.step) < ABOUT else UNMEASURED

    def at(self, step: float) -> Any:
        """The row at this step [s], if it can be compared."""
        rows = (row for row in self if is_step(row.step, step))
        return next((row for row in rows if Outcome(row.outcome).comparable), UNMEASURED)

    def best(self, name: str = "angle") -> Any:
        """The row with the least error of those that can be compared."""
        usable = (row for row in self.known(name) if Outcome(row.outcome).comparable)
        return min(usable, key=lambda row: getattr(row, name), default=UNMEASURED)

    def finest(self) -> Any:
        """The row at the smallest step."""
        return min(self, key=lambda row: row.step, default=UNMEASURED)

    def sweep(self, name: str = "angle") -> Any:
        """What an error does as the step goes to zero, of rows of one method in one scene."""
        found = by_method(sweeps(self, [quantity(name)]), name)
        return next(iter(found.values()), UNMEASURED)

    def outcomes(self) -> list[str]:
        """What became of them, each once."""
        return list(dict.fromkeys(str(row.outcome) for row in self))

    def count(self, *outcomes: str) -> Any:
        """How many ended in one of these ways, or how many there are."""
        return sum(not outcomes or row.outcome in outcomes for row in self) if self else UNMEASURED

    def points(self, name: str) -> list[tuple[float, float]]:
        """(step [s], error) in their order, of failed runs too where the error is known."""
        values = ((row.step, getattr(row, name)) for row in self)
        return [(step, error) for step, error in values if 0 < error < math.inf]


def lookups(material: Material, scenes: Iterable[Scene]) -> dict[str, Any]:
    """What templates ask of the sweeps of some scenes.

    `best(scene, engine, variant)`, `sweep(scene, engine, variant, quantity)`, `at(scene, engine, variant, every)`;
    `ended(scene, engine, variant)`: what became of the method's steps.
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


def own_rows(pages: Mapping[Page, Material]) -> Rows:
    """What was measured in the scenes of the pages, from coarse to fine; scenes with other numbers are left out."""
    scenes = {scene.name: scene for page in pages for scene in page.scenes}
    found = {
        cell: row
        for material in pages.values()
        for cell, row in material.rows.items()
        if scenes.get(cell.scene.name) == cell.scene
    }
    return Rows(sorted(found.values(), key=lambda row: -row.step))
