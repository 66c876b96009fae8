"""The methods that roll, contacts and constraints apart, and their cells."""

from __future__ import annotations

from collections.abc import Iterable

from engines import Engine, mujoco, pymunk
from engines.pymunk import methods as pymunk_methods
from reference.scene import Scene
from reports.grid.cells import Cell

CONTACTS: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
CONSTRAINTS: tuple[Engine, ...] = (pymunk_methods.ROLL_PIVOT, mujoco.EXTENDED)


def cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)
