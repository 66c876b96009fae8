"""The methods that the skate's and the wheels' pages compare, by name; and what is read from their motions."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from engines import Engine
from engines.mujoco import methods as mujoco_methods
from engines.mujoco.methods import limited_tendon
from engines.pymunk import methods as pymunk_methods
from engines.pymunk.engine import limited_groove
from engines.registry import VARIANTS
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.page import Material, Observation
from reports.write.experiments import observe
from reports.write.tables import number
from reports.write.unmeasured import UNMEASURED

CONSTRUCTIONS: tuple[Engine, ...] = (*pymunk_methods.SKATES, *mujoco_methods.SKATES)
_KNOWN = {f"{engine.name} {engine.variant}": engine for engine in (*VARIANTS, *CONSTRUCTIONS)}


def method(name: str) -> Engine:
    """The engine called "pymunk groove"; raises KeyError for an unknown name."""
    return _KNOWN[name]


def known(names: Iterable[str]) -> dict[str, Engine]:
    """The engines of these names; a name that is not registered here is left out."""
    return {name: _KNOWN[name] for name in names if name in _KNOWN}


def limited(limit: float) -> tuple[Engine, ...]:
    """Skates that slip when they would have to give more than this side force [N]."""
    return limited_groove(limit), limited_tendon(limit)


# What a user would take, and the best of each kind.
ORDINARY: tuple[Engine, ...] = tuple(
    engine for engine in VARIANTS if engine.name != "lagrange" or engine.variant.startswith("rk4")
)


# Between these rates [rad/s] a turning on the straight run grows as the linearised motion says: far above where it
# starts, and its square is still below a thousandth of that of the largest rate.
GROWING = (2e-3, 4e-2)


def growth_of(t: np.ndarray, rate: np.ndarray) -> float:
    """The slope of log |turning rate| over time [1/s] between the rates of GROWING; NaN when it never gets there."""
    size = np.abs(rate)
    late = int(np.argmax(size > GROWING[1])) if np.any(size > GROWING[1]) else 0
    chosen = (np.arange(len(t)) < late) & (size > GROWING[0])
    if chosen.sum() < 3:
        return float("nan")
    return float(np.polyfit(t[chosen], np.log(size[chosen]), 1)[0])


def turned_at(t: np.ndarray, rate: np.ndarray) -> float:
    """When it turns fastest [s], which is when the exact sleigh slides neither way."""
    return float(t[int(np.argmax(np.abs(rate)))])


BACKWARDS = SleighBackwards()


TURNING_ROUND = tuple(Cell(BACKWARDS, engine, 1) for engine in (*ORDINARY, *CONSTRUCTIONS))


def backwards(material: Material) -> list[Observation]:
    """The growth of a small turning and the time of turning round, in each method."""
    t = np.linspace(0, BACKWARDS.duration, BACKWARDS.samples + 1)
    truth = BACKWARDS.motion(t).twist[:, 0, 2]
    found = [
        Observation("linearised exact motion", "", rf"grows as $e^{{{BACKWARDS.growth_rate():.4g}\,t}}$"),
        Observation("exact motion", "", _grown(t, truth)),
    ]
    for cell in TURNING_ROUND:
        setting = f"step {number(cell.step)} s"
        found += observe(material, cell, setting, lambda run: _grown(run.t, run.twist[:, 0, 2]))
    return found


def _grown(t: np.ndarray, rate: np.ndarray) -> str:
    grows = growth_of(t, rate)
    if np.isnan(grows):
        return f"does not turn round: at most {number(float(np.abs(rate).max()))} rad/s"
    return f"{grows:.4f} per second; fastest, {np.abs(rate).max():.3f} rad/s, at {turned_at(t, rate):.2f} s"


def first_beyond(scene: ChaplyginSleigh, limit: float) -> float | None:
    """When the exact lateral force first exceeds a limit [N], to 1e-4 of the duration [s]; None if never."""
    t = np.linspace(0, scene.duration, 10_001)
    over = np.flatnonzero(np.abs(scene.lateral_force(t)) > limit)
    return float(t[over[0]]) if over.size else None


def slipping(material: Material) -> list[Observation]:
    """When the exact lateral force exceeds a friction's limit, and when engines with that limit slip."""
    found = []
    for limit, cells in LIMITED.items():
        exact = first_beyond(BACKWARDS, limit)
        when = f"exceeds it at {exact:.3f} s" if exact is not None else f"never: at most {PEAK:.4f} N"
        found.append(Observation("exact lateral force", f"{limit:g} N", when))
        for cell in cells:
            found += observe(material, cell, f"{limit:g} N", _slipped)
    return found


def _slipped(run: Trajectory) -> str:
    when = slips_at(run)
    if when is None:
        return "holds"
    return f"slips by {SLIPS:g} m/s at {when:.2f} s, at most {np.abs(slip_of(run)).max():.2g}"


def slip_of(run: Trajectory) -> np.ndarray:
    """The skate's sideways velocity (times,) [m/s]."""
    return BACKWARDS.mechanism().slip(run.pose, run.twist)[:, 0]


def slips_at(run: Trajectory) -> float | None:
    """When it slips by more than SLIPS first [s]; None if it holds."""
    over = np.flatnonzero(np.abs(slip_of(run)) > SLIPS)
    return float(run.t[over[0]]) if over.size else None


def delays(material: Material) -> dict[str, Any]:
    """`least`, `most` [s]: how long after the exact force passes a limit an engine with that limit slips."""
    found = []
    for limit, cells in LIMITED.items():
        exact = first_beyond(BACKWARDS, limit)
        slipped = map(slips_at, material.motions(cells).values())
        found += [when - exact for when in slipped if exact is not None and when is not None]
    return {"least": min(found, default=UNMEASURED), "most": max(found, default=UNMEASURED)}


PEAK = float(np.abs(BACKWARDS.lateral_force(np.linspace(0, BACKWARDS.duration, 10_001))).max())


# A friction's limit [N] -> runs with it.
LIMITED = {limit: tuple(Cell(BACKWARDS, engine, 10) for engine in limited(limit)) for limit in (0.1, 0.3, 0.5, 0.7)}


SLIPS = 2e-3  # m/s: above what either method lets pass at this step while it holds
