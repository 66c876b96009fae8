"""What templates say with numbers: the best row and the sweep of a method, asked for by name."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from reference.scene import Scene
from reports.cells import Cell
from reports.page import Material
from reports.sweep import best_of, by_method, sweeps


def told(material: Material, scenes: Iterable[Scene], extra: Mapping[str, Iterable[Cell]] | None = None) -> dict:
    """`best(scene, engine, variant)`, `sweep(scene, engine, variant, quantity)`, `at(scene, engine, variant, every)`.

    Each gives None without such a row. `extra`: cells of experiments by a name, read by `rows(name)`.
    """
    rows = material.sweep(scenes)
    found = tuple(sweeps(rows))
    known = extra or {}

    def best(scene: str, engine: str, variant: str) -> Any:
        return best_of((row for row in rows if row.scene == scene), engine, variant)

    def sweep(scene: str, engine: str, variant: str, quantity: str = "angle") -> Any:
        return by_method(found, quantity).get((scene, engine, variant))

    def at(scene: str, engine: str, variant: str, every: int) -> Any:
        asked = (scene, engine, variant, every)
        return next((row for row in rows if (row.scene, row.engine, row.variant, row.every) == asked), None)

    def of(name: str) -> list[Any]:
        return material.of(known[name])

    return {"best": best, "sweep": sweep, "at": at, "rows": of}
