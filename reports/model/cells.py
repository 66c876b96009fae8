"""A cell is one scene in one engine variant at one step. This module also defines which cells are run.

The steps of a sweep are half a decade apart; `usual_cells` have the steps that users choose.
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

# Steps per sampling interval. With samples 1e-2 s apart the steps are about 1e-2, 3e-3, 1e-3 ... 3e-5 s. At least three
# points are needed to distinguish a slope from a plateau.
QUICK = (1, 3, 10)
FULL = (1, 3, 10, 30, 100, 300)

# The largest estimated CPU time [s] of a cell of a sweep, except for the coarsest step. The estimate is not a
# measurement, so that the grid and errors.csv are the same on every machine.
COST_LIMIT = 0.8
# A step finer than those of QUICK is left out if the declared order has already divided the error by this factor at a
# coarser step, since the remaining error is rounding. So methods of order 4 have five steps, of order 6 or more three.
DIVIDED = 1e8
BESIDE_LIMIT = 0.5  # s; longest cell of an engine that is an extra.
SLOW_TO_BUILD = 1.0  # s; an engine that needs longer to build a model runs only in experiments of pages.

# Printed form -> step [s]: a frame of a screen, as in pymunk's examples; MuJoCo's default; half of this default.
USUAL_STEPS = {"1/60 s": 1 / 60, "2 ms": 2e-3, "1 ms": 1e-3}
# Steps with a smaller relative difference count as equal, since the duration of a scene is a whole number of steps. At
# order 4 the error then differs by at most 4 %.
SAME_STEP = 0.01
# Variants in the overview and in charts: an engine's defaults, its documented settings, and with code of this suite;
# ideal constraints at order 1 and 4.
FEATURED = ("default", "tuned", "extended", "euler projection", "rk4 projection")
MOST_VARIANTS = 3  # In the overview and in charts, for an engine without a variant in FEATURED.
# Printed form of a step -> the engine whose users choose it; engines with another such step do not run it.
HABITS = {"1/60 s": "pymunk", "2 ms": "mujoco"}
OWN_VARIANTS = (
    "extended",
    "euler projection",
    "rk4 projection",
)  # with code of this suite, so that no user chooses a step


@dataclass(frozen=True)
class Cell(Valid):
    """A scene in an engine at one step. Raises ValueError unless both counts are positive integers.

    Cells that differ only in `purpose` are equal, so that an experiment at a step of the sweep uses the sweep's row.
    """

    scene: Scene
    engine: Engine
    every: Count  # steps between two samples
    purpose: Purpose = field(default="sweep", compare=False)
    samples: Count | None = None  # number of sampling intervals; that of the scene if None

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
        """A digest of everything on which the result depends: a stored result with the same key is valid."""
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
        """A digest of everything on which the exact motion depends, except the instants (`measure.exact_motion`)."""
        sources = fingerprint(self.scene, folders=("reference",))
        parts = (self.scene.name, type(self.scene).__qualname__, repr(self.scene), sources)
        return digest("\0".join(parts), LONG)


_fingerprint = lru_cache(maxsize=4096)(fingerprint)  # shared by the cells of a scene in an engine at all steps


def estimated_cost(cell: Cell) -> float:
    """Estimated CPU time of one run [s] by the engine's formula, which does not depend on the machine."""
    # Rounded to a nanosecond, so that rounding does not decide whether a cell exceeds a limit.
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
    except Exception as error:  # any exception of a third party's engine
        raise BadInput(f"{method_name(engine)}: {method} of {scene.name}: {describe(error)}") from error


@lru_cache(maxsize=512)
def mechanism_of(scene: Scene) -> Mechanism:
    """The scene's mechanism, cached, since cells, tables and pictures need it hundreds of times."""
    return scene.mechanism()


def sweep_cells(
    scenes: Iterable[Scene],
    engines: Iterable[Engine],
    steps: Iterable[int],
    cost_limit: float = COST_LIMIT,
    divided: float = DIVIDED,
) -> tuple[Cell, ...]:
    """The cells of all scenes in all engines at these numbers of steps per sample, coarse steps first.

    The coarsest step is always included. The other cells are left out for the reasons of `too_much`.
    """
    engines, scenes, steps = tuple(engines), tuple(scenes), sorted(steps)
    cells = [Cell(scene, engine, every) for every in steps for scene in scenes for engine in engines]
    return tuple(cell for cell in cells if cell.every == steps[0] or not too_much(cell, cost_limit, divided))


def beside_cells(scenes: Iterable[Scene], engines: Iterable[Engine], sweep: bool = False) -> tuple[Cell, ...]:
    """Cells of engines outside the grid at QUICK steps that take at most BESIDE_LIMIT: all with `sweep`, else one.

    Without `sweep` only the finest such step is run.
    """
    engines = tuple(engine for engine in engines if engine.build_time < SLOW_TO_BUILD)
    out: list[Cell] = []
    for scene in scenes:
        for engine in engines:
            cells = [Cell(scene, engine, every, "beside") for every in QUICK]
            cheap = [cell for cell in cells if estimated_cost(cell) <= BESIDE_LIMIT]
            out += cheap if sweep else cheap[-1:]
    return tuple(out)


def too_much(cell: Cell, cost_limit: float = COST_LIMIT, divided: float = DIVIDED) -> str:
    """The reason why a sweep leaves out a step that is not its coarsest; empty if it is run."""
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
    """Engine -> its variants in FEATURED in that order, or its first MOST_VARIANTS; `methods` are (engine, variant)."""
    variants: dict[str, dict[str, None]] = {}
    for engine, variant in methods:
        variants.setdefault(engine, {})[variant] = None
    return {
        engine: tuple(name for name in FEATURED if name in names) or tuple(names)[:MOST_VARIANTS]
        for engine, names in variants.items()
    }


def is_run_at(name: str, engine: str, variant: str) -> bool:
    """Whether a method is run at the step of USUAL_STEPS with this printed form."""
    if name not in HABITS:
        return True
    return variant not in OWN_VARIANTS and (HABITS[name] == engine or engine not in HABITS.values())


def usual_cells(scenes: Iterable[Scene], engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """The usual variants of the engines at USUAL_STEPS, without steps of the sweep and without long runs."""
    engines = tuple(engines)
    usual = usual_variants((engine.name, engine.variant) for engine in engines)
    chosen = [engine for engine in engines if engine.variant in usual[engine.name]]
    return tuple(cell for scene in scenes for engine in chosen for cell in _cells(scene, engine))


def _cells(scene: Scene, engine: Engine) -> Iterator[Cell]:
    for name, step in USUAL_STEPS.items():
        if not is_run_at(name, engine.name, engine.variant):
            continue
        every = max(1, round(scene.spacing / step))
        if not is_step(scene.spacing / every, step):  # the step does not divide the sampling, so the sampling changes
            cell = Cell(scene, engine, every, "usual", samples=max(1, round(scene.duration / (every * step))))
        elif every not in FULL:
            cell = Cell(scene, engine, every, "usual")
        else:
            continue
        if is_step(cell.step, step) and estimated_cost(cell) <= COST_LIMIT:
            yield cell
