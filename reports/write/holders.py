"""Who holds the joints, by method: the column that tables of methods have."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache

from engines import Engine
from reference.scene import Scene
from reports.model.cells import Cell, mechanism_of
from reports.model.holding import held_by


@cache
def held_in(scene: Scene, engine: Engine) -> str:
    """Who holds a scene's joints; kept, because a method asks its whole model about each of a hundred joints."""
    return held_by(engine, mechanism_of(scene))


def holders(cells: Iterable[Cell]) -> dict[str, str]:
    """Who holds the joints in these cells, by method; several answers where the cells of a method differ."""
    found: dict[str, dict[str, None]] = {}
    for cell in cells:
        method = f"{cell.engine.name} {cell.engine.variant}"
        found.setdefault(method, {}).setdefault(held_in(cell.scene, cell.engine))
    return {method: " or ".join(told) for method, told in found.items()}
