"""Selections of rows. A missing row is UNMEASURED, so that a template can leave out a clause without numbers."""

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

# Neighbouring steps of a grid differ by a factor of about 3.2, so the nearest step differs by less than this factor.
NEAREST_WITHIN = 2.0


class Rows(tuple[Measurement, ...]):
    """Rows with selections for templates and claims."""

    __slots__ = ()

    def of(self, scene: str = "", method: str = "", purpose: str = "sweep") -> Rows:
        """The rows with this scene, method ("mujoco tuned") and purpose. An empty text selects all."""
        wanted = {"scene": scene, "method": method, "purpose": purpose}
        return Rows(
            row for row in self if all(not value or getattr(row, name) == value for name, value in wanted.items())
        )

    def known(self, name: str) -> Rows:
        return Rows(row for row in self if math.isfinite(getattr(row, name)))

    def near(self, step: float) -> Any:
        """The row with the step nearest to `step` [s], or UNMEASURED if the ratio of the steps is NEAREST_WITHIN or
        more."""
        row = min(self, key=lambda row: abs(math.log(row.step / step)), default=None)
        return row if row is not None and max(row.step / step, step / row.step) < NEAREST_WITHIN else UNMEASURED

    def at(self, step: float) -> Any:
        rows = (row for row in self if is_step(row.step, step))
        return next((row for row in rows if Outcome(row.outcome).comparable), UNMEASURED)

    def best(self, name: str = "angle") -> Any:
        usable = (row for row in self.known(name) if Outcome(row.outcome).comparable)
        return min(usable, key=lambda row: getattr(row, name), default=UNMEASURED)

    def finest(self) -> Any:
        return min(self, key=lambda row: row.step, default=UNMEASURED)

    def sweep(self, name: str = "angle") -> Any:
        """The convergence of an error. The rows must be those of one method in one scene."""
        return next(iter(by_method(sweeps(self, [quantity(name)]), name).values()), UNMEASURED)

    def outcomes(self) -> list[str]:
        return list(dict.fromkeys(str(row.outcome) for row in self))

    def count(self, *outcomes: str) -> Any:
        """The number of rows with one of `outcomes`, or of all rows without arguments."""
        return sum(not outcomes or row.outcome in outcomes for row in self) if self else UNMEASURED

    def points(self, name: str) -> list[tuple[float, float]]:
        """Pairs (step [s], error) of all rows with a positive finite error, failed runs included."""
        values = ((row.step, getattr(row, name)) for row in self)
        return [(step, error) for step, error in values if 0 < error < math.inf]


def lookups(material: Material, scenes: Iterable[Scene]) -> dict[str, Any]:
    """The functions by which templates look up rows of scenes. Templates can call `best(scene, engine, variant)`,
    `sweep(scene, engine, variant, quantity)`, `at(scene, engine, variant, every)` and `ended(scene, engine, variant)`.
    The function `ended` returns the outcomes of the method."""
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
    """The rows of the pages' scenes, sorted by decreasing step. Rows of scenes with other parameters are left out."""
    scenes = {scene.name: scene for page in pages for scene in page.scenes}
    rows = {
        cell: row
        for material in pages.values()
        for cell, row in material.rows.items()
        if scenes.get(cell.scene.name) == cell.scene
    }
    return Rows(sorted(rows.values(), key=lambda row: -row.step))
