"""Who holds the joints, by method: the column that tables of methods have."""

from __future__ import annotations

from collections.abc import Iterable

from reports.grid.cells import Cell
from reports.grid.holding import held_by


def holders(cells: Iterable[Cell]) -> dict[str, str]:
    """Who holds the joints in these cells, by method; several answers where the cells of a method differ."""
    found: dict[str, dict[str, None]] = {}
    for cell in cells:
        method = f"{cell.engine.name} {cell.engine.variant}"
        found.setdefault(method, {}).setdefault(held_by(cell.engine, cell.scene.mechanism()))
    return {method: " or ".join(told) for method, told in found.items()}
