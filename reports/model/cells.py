"""A cell is one scene in one engine variant at one step; the grids say which cells are run."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Literal

from engines import Engine, Promise, method_name
from reference.checks import Count, Valid
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.digest import LONG, digest
from reports.model.ending import BadInput, describe
from reports.model.fingerprint import fingerprint

Purpose = Literal["sweep", "usual", "beside", "failure", "growth", "large", "map"]

# Steps per sampling interval, half a decade apart: the one rule by which steps are chosen. With samples 1e-2 s apart
# they are about 1e-2, 3e-3, 1e-3 ... 3e-5 s. Three points are the fewest that can tell a slope from a plateau.
QUICK = (1, 3, 10)
FULL = (1, 3, 10, 30, 100, 300)

# A step, the coarsest apart, is left out when one run would take about this long [s]. The estimate is fixed, not
# measured, so that the grid (and errors.csv) is the same on every machine.
COST_LIMIT = 0.8
# Beyond QUICK, finer steps end where the promised order has divided the coarsest one's error by this: what is left then
# is rounding, or no error of the step. So methods of order 4 get five steps, those of order 6 and more three.
DIVIDED = 1e8


@dataclass(frozen=True)
class Cell(Valid):
    """A scene in an engine with `every` steps between samples; `samples` replaces the scene's own number if given.

    Scenes and engines are frozen dataclasses, so a cell is data: it travels to a worker process as it is. What it is
    run for makes no other cell of it: an experiment at a step of the sweep takes the sweep's row.
    Raises ValueError unless both counts are whole numbers above zero.
    """

    scene: Scene
    engine: Engine
    every: Count
    purpose: Purpose = field(default="sweep", compare=False)
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
        return f"{self.scene.name} / {method_name(self.engine)} / {self.step:.1e} s"

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
            _fingerprint(self.scene, self.engine),
        )
        return digest("\0".join(map(str, parts)), LONG)

    @cached_property
    def truth(self) -> str:
        """A digest of all that the scene's exact motion depends on, but for the instants (`reports.model.truths`)."""
        sources = fingerprint(self.scene, folders=("reference",))
        parts = (self.scene.name, type(self.scene).__qualname__, repr(self.scene), sources)
        return digest("\0".join(parts), LONG)


@lru_cache(maxsize=4096)  # a scene in an engine has a cell for every step
def _fingerprint(scene: Scene, engine: Engine) -> str:
    return fingerprint(scene, engine)


def estimated_cost(cell: Cell) -> float:
    """About how long one run takes [s], by the engine's own formula; deliberately not a measurement."""
    # To a nanosecond: which side of a limit a cell is on is not to be decided by rounding.
    return round(cell.sample_count * cell.every * _step_cost(cell.scene, cell.engine), 9)


def estimated_seconds(cell: Cell) -> float:
    """The same with the making of a model that takes long, as its engine says."""
    return estimated_cost(cell) + cell.engine.building


@lru_cache(maxsize=4096)
def _step_cost(scene: Scene, engine: Engine) -> float:
    try:
        cost = float(engine.step_cost(mechanism_of(scene)))
    except Exception as error:  # whatever somebody else's engine does
        raise BadInput(f"{method_name(engine)}: step_cost of {scene.name}: {describe(error)}") from error
    if not cost >= 0:
        raise BadInput(f"{method_name(engine)}: step_cost of {scene.name} is {cost}; it must be a time [s]")
    return cost


@lru_cache(maxsize=512)
def mechanism_of(scene: Scene) -> Mechanism:
    """The scene's mechanism, made once: cells, tables and pictures ask for it hundreds of times."""
    return scene.mechanism()


def sweep_cells(
    scenes: Iterable[Scene],
    engines: Iterable[Engine],
    steps: Iterable[int],
    cost_limit: float = COST_LIMIT,
    divided: float = DIVIDED,
) -> tuple[Cell, ...]:
    """Every scene in every engine at every number of steps per sample, cheap steps first.

    The coarsest step is always there, the other QUICK ones while their estimated cost stays below COST_LIMIT; finer
    ones while it stays below `cost_limit`, and the promised order has divided the error by no more than `divided`.
    """
    engines, scenes = tuple(engines), tuple(scenes)
    return tuple(_sweep(scenes, engines, tuple(steps), cost_limit, divided))


# Of engines that are extras: no cell that takes longer than this [s], building included.
BESIDE_LIMIT = 0.5
# A model that takes as long as this to build [s] is run where a page asks for it, and in no grid.
SLOW_TO_BUILD = 1.0


def beside_cells(scenes: Iterable[Scene], engines: Iterable[Engine], sweep: bool = False) -> tuple[Cell, ...]:
    """Engines that are no part of a scene's grid and stand beside it on its page, each at the finest of the QUICK steps
    that is cheap enough; at all of these with `sweep`.
    """
    engines = tuple(engine for engine in engines if engine.building < SLOW_TO_BUILD)
    found: list[Cell] = []
    for scene in scenes:
        for engine in engines:
            cells = [Cell(scene, engine, every, "beside") for every in QUICK]
            cheap = [cell for cell in cells if estimated_cost(cell) <= BESIDE_LIMIT]
            found += cheap if sweep else cheap[-1:]
    return tuple(found)


def _sweep(
    scenes: tuple[Scene, ...], engines: tuple[Engine, ...], steps: tuple[int, ...], cost_limit: float, divided: float
) -> Iterator[Cell]:
    for every in sorted(steps):
        for scene in scenes:
            for engine in engines:
                cell = Cell(scene, engine, every)
                if every == min(steps) or not too_much(cell, cost_limit, divided):
                    yield cell


def too_much(cell: Cell, cost_limit: float = COST_LIMIT, divided: float = DIVIDED) -> str:
    """Why a sweep leaves a step out that is not its coarsest; empty if it does not."""
    cost = estimated_cost(cell)
    most = max(cost_limit, COST_LIMIT) if cell.every <= max(QUICK) else cost_limit
    if cost > most:
        return f"step_cost says {cost:.4g} s, and a run may take {most:g} s"
    if cell.every > max(QUICK) and cell.every ** _promised_order(cell.scene, cell.engine) > divided:
        return f"its order has divided the error by {divided:.0e} at a coarser step"
    return ""


@lru_cache(maxsize=4096)
def _promised_order(scene: Scene, engine: Engine) -> float:
    """Of poses; 0 where none is promised."""
    try:
        promise = engine.order(mechanism_of(scene))
    except Exception as error:  # whatever somebody else's engine does
        raise BadInput(f"{method_name(engine)}: order of {scene.name}: {describe(error)}") from error
    return promise.order if isinstance(promise, Promise) else 0.0
