"""The steps that people use, which the half decades of the sweep miss: each engine's usual methods are run at them."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from engines import Engine
from reference.scene import Scene
from reports.model.cells import COST_LIMIT, FULL, Cell, estimated_cost

# Seconds by how they are printed: a picture of a screen, as in pymunk's examples; MuJoCo's own; half of that.
USUAL_STEPS = {"1/60 s": 1 / 60, "2 ms": 2e-3, "1 ms": 1e-3}

# Steps that differ by less than this share are one: a scene's time is a whole number of steps, so that 1/60 s may be a
# little less there. At order 4 an error differs by four times as much, which two printed digits show just so.
SAME = 0.01

# The methods that the overview and the charts show: an engine as shipped, by documented settings, and with code around
# it; ideal constraints at order 1 and 4.
FEATURED = ("default", "tuned", "extended", "euler projection", "rk4 projection")
# Of an engine whose variants have other names, this many: more columns than the others have would be unreadable.
SHOWN = 3
# A step that is the habit of one engine's users: other engines that have such a step of their own are not run at it.
HABITS = {"1/60 s": "pymunk", "2 ms": "mujoco"}
# Variants that nobody has without code of ours, and so no habit.
OURS = ("extended", "euler projection", "rk4 projection")


def is_step(step: float, wanted: float) -> bool:
    """Whether a step [s] is told as this one."""
    return abs(step - wanted) <= SAME * wanted


def usual_variants(methods: Iterable[tuple[str, str]]) -> dict[str, tuple[str, ...]]:
    """Engine -> its variants in FEATURED, in that order, or its first ones where it has none of them.

    `methods` are (engine, variant).
    """
    found: dict[str, dict[str, None]] = {}
    for engine, variant in methods:
        found.setdefault(engine, {})[variant] = None
    return {
        engine: tuple(name for name in FEATURED if name in own) or tuple(own)[:SHOWN] for engine, own in found.items()
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
