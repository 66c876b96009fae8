"""A cell is one scene in one engine variant at one step. This module also defines which cells are run.

The steps of a sweep are half a decade apart. `usual_cells` have the steps that users choose.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any, Literal

from engines import ConvergenceOrder, Engine, method_name
from reference.checks import Count, Valid
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.ending import BadInput, describe
from reports.model.fingerprint import LONG, digest, fingerprint

Purpose = Literal["sweep", "usual", "beside", "failure", "growth", "large", "map"]

# Steps per sampling interval. If samples are 1e-2 s apart, the steps are about 1e-2, 3e-3 and 1e-3 s. At least three
# points are needed to distinguish a slope from a plateau.
QUICK = (1, 3, 10)
FULL = (1, 3, 10, 30, 100, 300)

# The largest estimated CPU time [s] of a cell in a sweep, except at the coarsest step. An estimate is the same on every
# machine, and so are the grid and errors.csv.
COST_LIMIT = 0.8
# If a finer step would divide the error by more than this factor, the error is only rounding. So steps finer than QUICK
# are left out for methods of high order. Methods of order 4 have five steps.
DIVIDED = 1e8
BESIDE_LIMIT = 0.5  # Longest estimated CPU time of a cell with an extra engine [s].
SLOW_TO_BUILD = 1.0  # An engine that needs more time [s] to build a model runs only in experiments of pages.

# Printed form -> step [s]. The steps are a frame of a screen, MuJoCo's default, and half of MuJoCo's default.
USUAL_STEPS = {"1/60 s": 1 / 60, "2 ms": 2e-3, "1 ms": 1e-3}
# Steps with a smaller relative difference count as equal, since the duration of a scene is a whole number of steps. At
# order 4 the errors of such steps differ by at most 4 %.
SAME_STEP = 0.01
# Variants that are shown in the overview and in charts.
FEATURED = ("default", "tuned", "extended", "euler projection", "rk4 projection")
MOST_VARIANTS = 3  # Number of variants that are shown for an engine without a variant in FEATURED.
# Printed form of a step -> the engine whose users choose this step. Other engines in this table do not run the step.
HABITS = {"1/60 s": "pymunk", "2 ms": "mujoco"}
OWN_VARIANTS = (
    "extended",
    "euler projection",
    "rk4 projection",
)  # Variants with code of this suite have no users who choose a step.


@dataclass(frozen=True)
class Cell(Valid):
    """A scene in an engine at one step. Raises ValueError unless `every` and `samples` are positive integers. Cells
    that differ only in `purpose` are equal. So an experiment at a step of the sweep uses the row of the sweep."""

    scene: Scene
    engine: Engine
    every: Count  # Number of steps between two samples.
    purpose: Purpose = field(default="sweep", compare=False)
    samples: Count | None = None  # Number of sampling intervals, by default that of the scene.

    @property
    def sample_count(self) -> int:
        return self.scene.samples if self.samples is None else self.samples

    @property
    def step(self) -> float:
        return self.scene.duration / self.sample_count / self.every

    @property
    def label(self) -> str:
        return f"{self.scene.name} / {method_name(self.engine)} / {self.step:.1e} s"

    @cached_property
    def key(self) -> str:
        """A digest of everything that affects the result. A stored result with the same key is valid."""
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
        """A digest of everything that affects the exact motion, except the instants (`measure.exact_motion`)."""
        sources = fingerprint(self.scene, folders=("reference",))
        parts = (self.scene.name, type(self.scene).__qualname__, repr(self.scene), sources)
        return digest("\0".join(parts), LONG)


_fingerprint = lru_cache(maxsize=4096)(fingerprint)  # The cells of a scene in an engine share a fingerprint.


def estimated_cost(cell: Cell) -> float:
    """CPU time of one run [s], estimated by the engine's formula independently of the machine."""
    # The time is rounded to a nanosecond, so that rounding errors do not decide whether a cell exceeds a limit.
    return round(cell.sample_count * cell.every * _step_cost(cell.scene, cell.engine), 9)


def estimated_seconds(cell: Cell) -> float:
    """`estimated_cost` plus the engine's declared time to build a model [s]."""
    return estimated_cost(cell) + cell.engine.build_time


@lru_cache(maxsize=4096)
def _step_cost(scene: Scene, engine: Engine) -> float:
    cost = _call(engine, "step_cost", scene, float)
    if not cost >= 0:
        raise BadInput(f"{method_name(engine)}: step_cost of {scene.name} is {cost}; it must be a time [s]")
    return cost


def _call(engine: Engine, method: str, scene: Scene, convert: Callable[[Any], Any] = lambda value: value) -> Any:
    try:
        return convert(getattr(engine, method)(mechanism_of(scene)))
    except Exception as error:  # An engine of a third party may raise any exception.
        raise BadInput(f"{method_name(engine)}: {method} of {scene.name}: {describe(error)}") from error


@lru_cache(maxsize=512)
def mechanism_of(scene: Scene) -> Mechanism:
    """The mechanism of a scene. The result is cached, since it is needed hundreds of times."""
    return scene.mechanism()


def sweep_cells(
    scenes: Iterable[Scene],
    engines: Iterable[Engine],
    steps: Iterable[int],
    cost_limit: float = COST_LIMIT,
    divided: float = DIVIDED,
) -> tuple[Cell, ...]:
    """The cells of all scenes in all engines at these numbers of steps per sample, coarse steps first. The cells with
    the coarsest step are always included. `too_much` gives reasons why other cells are left out."""
    engines, scenes, steps = tuple(engines), tuple(scenes), sorted(steps)
    cells = [Cell(scene, engine, every) for every in steps for scene in scenes for engine in engines]
    return tuple(cell for cell in cells if cell.every == steps[0] or not too_much(cell, cost_limit, divided))


def beside_cells(
    scenes: Iterable[Scene], engines: Iterable[Engine], sweep: bool = False, named: bool = False
) -> tuple[Cell, ...]:
    """Cells of engines outside the grid at the steps in QUICK. Cells that take longer than BESIDE_LIMIT are left out.
    Without `sweep` only the finest step remains. Engines whose models take long to build are included if the user has
    `named` them."""
    engines = tuple(engine for engine in engines if named or engine.build_time < SLOW_TO_BUILD)
    out: list[Cell] = []
    for scene in scenes:
        for engine in engines:
            cells = [Cell(scene, engine, every, "beside") for every in QUICK]
            cheap = [cell for cell in cells if estimated_cost(cell) <= BESIDE_LIMIT]
            out += cheap if sweep else cheap[-1:]
    return tuple(out)


def too_much(cell: Cell, cost_limit: float = COST_LIMIT, divided: float = DIVIDED) -> str:
    """The reason why a sweep leaves out a cell, or an empty text. The coarsest step is never left out."""
    cost = estimated_cost(cell)
    most = max(cost_limit, COST_LIMIT) if cell.every <= max(QUICK) else cost_limit
    if cost > most:
        return f"step_cost says {cost:.4g} s, and a run may take {most:g} s"
    if cell.every > max(QUICK) and cell.every ** _promised_order(cell.scene, cell.engine) > divided:
        return f"its order has divided the error by {divided:.0e} at a coarser step"
    return ""


@lru_cache(maxsize=4096)
def _promised_order(scene: Scene, engine: Engine) -> float:
    promise = _call(engine, "order", scene)
    return promise.order if isinstance(promise, ConvergenceOrder) else 0.0


def is_step(step: float, wanted: float) -> bool:
    return abs(step - wanted) <= SAME_STEP * wanted


def usual_variants(methods: Iterable[tuple[str, str]]) -> dict[str, tuple[str, ...]]:
    """Engine -> the variants in FEATURED in that order, else its first MOST_VARIANTS. methods: (engine, variant)."""
    variants: dict[str, dict[str, None]] = {}
    for engine, variant in methods:
        variants.setdefault(engine, {})[variant] = None
    return {
        engine: tuple(name for name in FEATURED if name in names) or tuple(names)[:MOST_VARIANTS]
        for engine, names in variants.items()
    }


def is_run_at(name: str, engine: str, variant: str) -> bool:
    """Whether a method is run at a step of USUAL_STEPS. name: printed form of the step."""
    if name not in HABITS:
        return True
    return variant not in OWN_VARIANTS and (HABITS[name] == engine or engine not in HABITS.values())


def usual_cells(scenes: Iterable[Scene], engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """The cells of usual variants at USUAL_STEPS, without steps of the sweep and without long runs."""
    engines = tuple(engines)
    usual = usual_variants((engine.name, engine.variant) for engine in engines)
    chosen = [engine for engine in engines if engine.variant in usual[engine.name]]
    return tuple(cell for scene in scenes for engine in chosen for cell in _cells(scene, engine))


def _cells(scene: Scene, engine: Engine) -> Iterator[Cell]:
    for name, step in USUAL_STEPS.items():
        if not is_run_at(name, engine.name, engine.variant):
            continue
        every = max(1, round(scene.spacing / step))
        if not is_step(scene.spacing / every, step):  # The step does not divide the sampling interval.
            cell = Cell(scene, engine, every, "usual", samples=max(1, round(scene.duration / (every * step))))
        elif every not in FULL:
            cell = Cell(scene, engine, every, "usual")
        else:
            continue
        if is_step(cell.step, step) and estimated_cost(cell) <= COST_LIMIT:
            yield cell
