"""A cell is one scene in one engine variant at one step; the grids say which cells are run.

The grid of sweeps has half decades of the step; `usual_cells` are at the steps that people use, which these miss.
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

# Steps per sampling interval, half a decade apart: the one rule by which steps are chosen. With samples 1e-2 s apart
# they are about 1e-2, 3e-3, 1e-3 ... 3e-5 s. At least three points are needed to distinguish a slope from a plateau.
QUICK = (1, 3, 10)
FULL = (1, 3, 10, 30, 100, 300)

# A step, the coarsest apart, is left out when one run would take about this long [s]. The estimate is fixed, not
# measured, so that the grid (and errors.csv) is the same on every machine.
COST_LIMIT = 0.8
# Beyond QUICK, finer steps end where the promised order has divided the coarsest one's error by this: the rest is then
# rounding, or no error of the step. So methods of order 4 get five steps, those of order 6 and more three.
DIVIDED = 1e8
BESIDE_LIMIT = 0.5  # s, building included: longest cell of an engine that is an extra
SLOW_TO_BUILD = 1.0  # s: a model that takes longer to build is run only in experiments of pages, and in no grid

# Steps [s] by their printed form: a frame of a screen, as in pymunk's examples; MuJoCo's default; half of it.
USUAL_STEPS = {"1/60 s": 1 / 60, "2 ms": 2e-3, "1 ms": 1e-3}
# Steps that differ by less than this share are one: a scene's time is a whole number of steps, so that 1/60 s may be a
# little less there. At order 4 an error differs by four times as much, which two printed digits show just so.
SAME = 0.01
# The methods that the overview and the charts show: an engine as shipped, by documented settings, and with code around
# it; ideal constraints at order 1 and 4.
FEATURED = ("default", "tuned", "extended", "euler projection", "rk4 projection")
SHOWN = 3  # variants of an engine that has none of these: more columns than others have would be unreadable
# A step that is the habit of one engine's users: other engines that have such a step of their own are not run at it.
HABITS = {"1/60 s": "pymunk", "2 ms": "mujoco"}
OURS = (
    "extended",
    "euler projection",
    "rk4 projection",
)  # variants with code of this suite, so that users have no habit


@dataclass(frozen=True)
class Cell(Valid):
    """A scene in an engine with `every` steps between samples; `samples` replaces the scene's own number if given.

    Scenes and engines are frozen dataclasses, so a cell can be pickled for a worker process. Cells that differ only
    in `purpose` are equal: an experiment at a step of the sweep uses the sweep's row.
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
        """A digest of all that the scene's exact motion depends on, but for the instants (`measure.exact_motion`)."""
        sources = fingerprint(self.scene, folders=("reference",))
        parts = (self.scene.name, type(self.scene).__qualname__, repr(self.scene), sources)
        return digest("\0".join(parts), LONG)


_fingerprint = lru_cache(maxsize=4096)(fingerprint)  # a scene in an engine has a cell for every step


def estimated_cost(cell: Cell) -> float:
    """About how long one run takes [s], by the engine's own formula; deliberately not a measurement."""
    # To a nanosecond: which side of a limit a cell is on is not to be decided by rounding.
    return round(cell.sample_count * cell.every * _step_cost(cell.scene, cell.engine), 9)


def estimated_seconds(cell: Cell) -> float:
    """`estimated_cost` and the time to build a model [s], as the engine declares it."""
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
    """The scene's mechanism, cached: cells, tables and pictures need it hundreds of times."""
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
    engines, scenes, steps = tuple(engines), tuple(scenes), sorted(steps)
    cells = [Cell(scene, engine, every) for every in steps for scene in scenes for engine in engines]
    return tuple(cell for cell in cells if cell.every == steps[0] or not too_much(cell, cost_limit, divided))


def beside_cells(scenes: Iterable[Scene], engines: Iterable[Engine], sweep: bool = False) -> tuple[Cell, ...]:
    """Cells of engines outside a scene's grid, which its page shows beside it: each at the finest of the QUICK steps
    that is cheap enough; with `sweep` at all that are.
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
    """The declared order of the poses; 0 without one."""
    promise = _call(engine, "order", scene)
    return promise.order if isinstance(promise, ConvergenceOrder) else 0.0


def is_step(step: float, wanted: float) -> bool:
    """Whether a step [s] is printed as this one."""
    return abs(step - wanted) <= SAME * wanted


def usual_variants(methods: Iterable[tuple[str, str]]) -> dict[str, tuple[str, ...]]:
    """Engine -> its variants in FEATURED, in that order, or its first ones where it has none of them.

    `methods` are (engine, variant).
    """
    variants: dict[str, dict[str, None]] = {}
    for engine, variant in methods:
        variants.setdefault(engine, {})[variant] = None
    return {
        engine: tuple(name for name in FEATURED if name in names) or tuple(names)[:SHOWN]
        for engine, names in variants.items()
    }


def is_run_at(name: str, engine: str, variant: str) -> bool:
    """Whether a method is run at the usual step of this name."""
    if name not in HABITS:
        return True
    return variant not in OURS and (HABITS[name] == engine or engine not in HABITS.values())


def usual_cells(scenes: Iterable[Scene], engines: Iterable[Engine]) -> tuple[Cell, ...]:
    """The engines' usual variants at USUAL_STEPS, where the sweep has no such step and a run does not take too long."""
    engines = tuple(engines)
    usual = usual_variants((engine.name, engine.variant) for engine in engines)
    chosen = [engine for engine in engines if engine.variant in usual[engine.name]]
    return tuple(cell for scene in scenes for engine in chosen for cell in _cells(scene, engine))


def _cells(scene: Scene, engine: Engine) -> Iterator[Cell]:
    for name, step in USUAL_STEPS.items():
        if not is_run_at(name, engine.name, engine.variant):
            continue
        every = max(1, round(scene.spacing / step))
        if not is_step(scene.spacing / every, step):  # then with samples at other times
            cell = Cell(scene, engine, every, "usual", samples=max(1, round(scene.duration / (every * step))))
        elif every not in FULL:
            cell = Cell(scene, engine, every, "usual")
        else:
            continue
        if is_step(cell.step, step) and estimated_cost(cell) <= COST_LIMIT:
            yield cell
