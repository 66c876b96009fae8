"""Who holds the joints, by method: the column that tables of methods have."""

from __future__ import annotations

from collections.abc import Iterable

from reports.grid.cells import Cell


def holders(cells: Iterable[Cell]) -> dict[str, str]:
    """Who holds the joints in these cells, by method."""
    return {}
