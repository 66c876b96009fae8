"""What templates say with numbers: the best row and the sweep of a method, asked for by name."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

from reference.scene import Scene
from reports.model.convergence import best_of, by_method, sweeps
from reports.model.measure import Measurement
from reports.model.page import Material
from reports.write.unmeasured import UNMEASURED

# Steps of the grids are half a decade apart: one of them is nearer to any step between its ends than this factor.
ABOUT = 2.0


def nearest_step(rows: Iterable[Measurement], step: float) -> Measurement | None:
    """The row whose step is nearest to this one, by ratio; None if none is within a factor of ABOUT."""
    row = min(rows, key=lambda row: abs(math.log(row.step / step)), default=None)
    return row if row is not None and max(row.step / step, step / row.step) < ABOUT else None


def told(material: Material, scenes: Iterable[Scene]) -> dict[str, Any]:
    """`best(scene, engine, variant)`, `sweep(scene, engine, variant, quantity)`, `at(scene, engine, variant, every)`.

    Each gives UNMEASURED without such a row. `ended(scene, engine, variant)`: what became of the method's steps.
    """
    rows = material.sweep(scenes)
    found = tuple(sweeps(rows))

    def best(scene: str, engine: str, variant: str) -> Any:
        return best_of((row for row in rows if row.scene == scene), engine, variant) or UNMEASURED

    def sweep(scene: str, engine: str, variant: str, quantity: str = "angle") -> Any:
        return by_method(found, quantity).get((scene, engine, variant), UNMEASURED)

    def at(scene: str, engine: str, variant: str, every: int) -> Any:
        asked = (scene, engine, variant, every)
        return next((row for row in rows if (row.scene, row.engine, row.variant, row.every) == asked), UNMEASURED)

    def ended(scene: str, engine: str, variant: str) -> list[str]:
        own = (row.outcome for row in rows if (row.scene, row.engine, row.variant) == (scene, engine, variant))
        return list(dict.fromkeys(map(str, own)))

    return {"best": best, "sweep": sweep, "at": at, "ended": ended}
