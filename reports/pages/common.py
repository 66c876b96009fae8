"""What experiments on several pages share: the methods that they ask, and the cells of a method at some steps."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace

from engines import Engine, mujoco, pymunk
from engines.registry import VARIANTS
from reference.scene import Scene
from reports.model.cells import Cell

PUBLIC: tuple[Engine, ...] = (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED)
ALL: tuple[Engine, ...] = (*PUBLIC, pymunk.EXTENDED, mujoco.EXTENDED)
# What is run in every scene, without ideal constraints.
ENGINES_ALONE: tuple[Engine, ...] = tuple(engine for engine in VARIANTS if engine.name != "lagrange")


def sweeps(count: int) -> Engine:
    """pymunk closing every gap in one step, by this many sweeps."""
    return replace(pymunk.DEFAULT, variant=f"{count} sweeps, all of the gap", iterations=count, error_bias=0.0)


def cells(
    scene: Scene, engines: Iterable[Engine], every: Iterable[int], samples: int | None = None
) -> tuple[Cell, ...]:
    """The cells of an experiment: a scene in engines with so many steps between samples."""
    steps = tuple(every)
    return tuple(Cell(scene, engine, count, "failure", samples) for engine in engines for count in steps)


def steps_for(engine: Engine, every: tuple[int, ...]) -> tuple[int, ...]:
    """What runs a cell at many steps is at rounding with the longest already."""
    return every[:1] if engine.variant == "extended" else every


def cells_to_rounding(
    scene: Scene, engines: Iterable[Engine], every: tuple[int, ...], samples: int | None = None
) -> tuple[Cell, ...]:
    """The same, of each engine at `steps_for` it."""
    return tuple(cell for engine in engines for cell in cells(scene, (engine,), steps_for(engine, every), samples))
