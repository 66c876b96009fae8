"""A cell is one scene in one engine variant at one step; the grids say which cells are run."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

from engines import Engine
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.validation import Count, Valid
from reports.grid.fingerprint import fingerprint

Purpose = Literal["sweep", "failure", "growth", "large", "map"]

# Steps per sampling interval, half a decade apart: the one rule by which steps are chosen. With samples 1e-2 s apart
# they are about 1e-2, 3e-3, 1e-3 ... 1e-5 s. Three points are the fewest that can tell a slope from a plateau.
QUICK = (1, 3, 10)
FULL = (1, 3, 10, 30, 100, 300, 1000)

# A step of the full grid is left out when one run would take about this long [s]. The estimate is fixed, not measured,
# so that the grid (and errors.csv) is the same on every machine.
COST_LIMIT = 0.7
# A step of the quick grid, the coarsest apart, is left out only when one run would take about this long [s].
QUICK_LIMIT = 7.0

# About what one step costs [s] with three bodies: an engine may say better in `step_cost` (a number or property).
STEP_COST = {"pymunk": 2e-6, "mujoco": 12e-6, "lagrange": 400e-6}
UNKNOWN_STEP_COST = 50e-6
SWEEP_COST = 13e-9  # of one joint in one sweep, for engines that tell how many `sweeps` a mechanism takes


@dataclass(frozen=True)
class Cell(Valid):
    """A scene in an engine with `every` steps between samples; `samples` replaces the scene's own number if given.

    Scenes and engines are frozen dataclasses, so a cell is data: it travels to a worker process as it is.
    Raises ValueError unless both counts are whole numbers above zero.
    """

    scene: Scene
    engine: Engine
    every: Count
    purpose: Purpose = "sweep"
    samples: Count | None = None

    @property
    def sample_count(self) -> int:
        return self.scene.samples if self.samples is None else self.samples

    @property
    def step(self) -> float:
        """The engine's step [s]."""
        return self.scene.duration / self.sample_count / self.every

    @property
    def label(self) -> str:
        return f"{self.scene.name} / {self.engine.name} {self.engine.variant} / {self.step:.1e} s"

    @cached_property
    def key(self) -> str:
        """A digest of all that the result depends on; equal keys mean that a stored result still holds."""
        parts = (
            self.scene.name,
            repr(self.scene),
            type(self.engine).__qualname__,
            self.engine.name,
            self.engine.variant,
            repr(self.engine),
            self.every,
            self.sample_count,
            self.purpose,
            fingerprint(self.scene, self.engine),
        )
        return hashlib.sha256("\0".join(map(str, parts)).encode()).hexdigest()[:32]


def step_cost(engine: Any, mechanism: Mechanism | None = None) -> float:
    """About how long one step of the cell takes [s] with three bodies.

    An engine that wraps another (`engine`) and runs it at several `levels` takes that many of its steps; one that
    chooses by the mechanism (`chosen`) costs what it has `chosen`; sweeps over many joints are counted.
    """
    if mechanism is not None and hasattr(engine, "chosen"):
        return step_cost(engine.chosen(mechanism), mechanism)
    own = getattr(engine, "step_cost", None)
    if own is not None:
        return float(own)
    if hasattr(engine, "levels") and hasattr(engine, "engine"):
        return sum(engine.levels) * step_cost(engine.engine, mechanism)
    cost = STEP_COST.get(engine.name, UNKNOWN_STEP_COST)
    if mechanism is not None and hasattr(engine, "sweeps"):
        threes = max(1.0, len(mechanism.bodies) / 3)
        cost += SWEEP_COST * len(mechanism.joints) * engine.sweeps(mechanism) / threes
    return cost


def estimated_cost(cell: Cell) -> float:
    """About how long one run takes [s], growing with the number of bodies; deliberately not a measurement."""
    mechanism = cell.scene.mechanism()
    size = max(1.0, len(mechanism.bodies) / 3)
    return cell.sample_count * cell.every * step_cost(cell.engine, mechanism) * size


def sweep_cells(
    scenes: Iterable[Scene], engines: Iterable[Engine], steps: Iterable[int], cost_limit: float = COST_LIMIT
) -> tuple[Cell, ...]:
    """Every scene in every engine at every number of steps per sample, cheap steps first.

    The coarsest step is always there, the other QUICK ones but for very dear ones; finer steps only while their
    estimated cost stays below the limit.
    """
    engines, scenes = tuple(engines), tuple(scenes)
    return tuple(_sweep(scenes, engines, tuple(steps), cost_limit))


def _sweep(
    scenes: tuple[Scene, ...], engines: tuple[Engine, ...], steps: tuple[int, ...], cost_limit: float
) -> Iterator[Cell]:
    for every in sorted(steps):
        for scene in scenes:
            for engine in engines:
                cell = Cell(scene, engine, every)
                limit = max(cost_limit, QUICK_LIMIT) if every <= max(QUICK) else cost_limit
                if every == min(steps) or estimated_cost(cell) <= limit:
                    yield cell
