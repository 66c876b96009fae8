"""A motion does not depend on how its mechanism is described: turned, shifted, mirrored, renamed, in other units.

The changes are those of the conformance kit, on mechanisms that nobody chose. One change a case, by the case's number.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Unpromised
from engines.conformance.same import Change, Isometry, joints_swapped, relabelled
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from reference.joints import Roll
from reference.mechanism import Mechanism
from reports.search.instant_mujoco import solved
from reports.search.law import ROUNDINGS, Fault, Lost, NotAsked, carried, difference, place, turned_in_a_step
from reports.search.parts import Recipe
from reports.search.recipe import build

Array = NDArray[np.float64]
STEP = 0.01  # of the mechanism's own time scale
STEPS = 5
# Rounding alone differs. A method that combines runs carries up to a hundred times as much of it, one that hardens its
# constraints gives away half of the digits.
SAME = 1e-7
# The same of an engine that computes with fewer digits, and says so as its `precision`: of what moves, places keep few.
ROUGHLY = 1e4
ROUNDED = 1e-6  # of a place: beside a motion that is smaller, its rounding is seen
SEEN = 20.0  # roundings of a place; six, and in one of 600 mechanisms thirteen, were met

CHANGES: dict[str, Change] = {
    "turned": Isometry(turn=0.7),
    "shifted": Isometry(shift=(3.7, -2.9)),
    "mirrored": Isometry(mirrored=True),
    "renamed": relabelled,
    "swapped": joints_swapped,
}
# Decades of length and of mass: in another unit the same mechanism has other numbers.
UNITS = {"in other lengths": (-3, 0), "in other masses": (0, 2)}
NAMES = (*CHANGES, *UNITS)


def bound(engine: Engine) -> float:
    """By how much descriptions may differ, relative to the motion."""
    return max(SAME, ROUGHLY * engine.precision)


def errors(engine: Engine, recipe: Recipe, number: int) -> dict[str, float]:
    """By what the poses and velocities differ, relative to the motion; raises NotAsked, Fault and Unsupported.

    MuJoCo and MJX are asked without what their solver leaves within its tolerance, for that is declared, and another in
    each description. See `instant_mujoco.solved`.
    """
    match engine:
        case MuJoCo():
            engine = solved(engine)
        case Mjx():
            engine = replace(engine, settings=solved(engine.settings))
    mechanism = build(recipe)
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.touches:
        raise NotAsked("whether two shapes that just touch do touch depends on rounding")
    if turned_in_a_step(mechanism, STEP * mechanism.time_scale, mechanism.pose, mechanism.twist) > 1:
        raise NotAsked("steps are too long for what turns, so that rounding grows at will")
    name = NAMES[number % len(NAMES)]
    if name in UNITS:
        if _has_lengths(engine):
            raise NotAsked("settings as shipped have lengths in them")
        return {name: _in_units(engine, recipe, mechanism, UNITS[name])}
    try:
        changed, back = CHANGES[name](mechanism)
    except ValueError as reason:
        raise NotAsked(str(reason)) from None
    pose, twist, _ = back(_run(engine, changed))
    return {name: _apart(mechanism, engine, pose[-1], twist[-1], float(np.abs(changed.pose[:, :2]).max()))}


def _run(engine: Engine, mechanism: Mechanism):
    run = engine.build(mechanism, STEP * mechanism.time_scale)(1, STEPS)
    if run.unresolved_at is not None and np.isfinite(run.pose).all():
        raise NotAsked("it says itself that it is unresolved in one of the descriptions")
    return run


def _apart(mechanism: Mechanism, engine: Engine, pose: Array, twist: Array, away: float = 0.0) -> float:
    """How different a pose and a twist are from those of the mechanism itself; `away` [m] is how far the other stood.

    A shift costs digits of a place, those of its distance; and a velocity those of a place divided by a step.
    """
    own = _run(engine, mechanism)
    moved, turned = own.pose[-1] - mechanism.pose, pose - mechanism.pose
    if not np.isfinite(own.pose[-1]).all():
        words = f"it was lost within {STEPS} steps: {'; '.join(own.warnings)}"
        raise Lost(words) if own.warnings else Fault(words)
    step = STEP * mechanism.time_scale
    rounded = _rounded(engine, mechanism) * max(away, float(np.abs(mechanism.pose[:, :2]).max()))
    far, fast = np.array([[rounded, 0.0, 0.0]]), np.array([[rounded / step, 0.0, 0.0]])
    shaken, fastest = _shaken(engine, mechanism, away)
    return max(
        difference(mechanism, turned, moved, (mechanism.twist * STEPS * step, 1e-6 * mechanism.pose, far, shaken)),
        difference(mechanism, twist, own.twist[-1], (mechanism.twist, fast, shaken * fastest / step)),
    )


def _shaken(engine: Engine, mechanism: Mechanism, away: float) -> tuple[Array, int]:
    """Motions (bodies, 3) beside which rounded gaps are below SAME, and how many steps of the finest run make one.

    An engine whose reactions are changes of velocity closes in each step what it sees of a gap, rounded as places are:
    velocities are wrong by that over the finest step. The weights of combined runs come on top, and what nearly
    dependent rows make of it (`carried`).
    """
    promise = engine.order(mechanism)
    if isinstance(promise, Unpromised) or not promise.differences:
        return np.zeros_like(mechanism.pose), 1
    rounded = ROUNDINGS * np.finfo(float).eps * promise.amplified * max(away, place(mechanism, mechanism.pose))
    return carried(mechanism, mechanism.pose, rounded / SAME).motion, promise.differences


def _rounded(engine: Engine, mechanism: Mechanism) -> float:
    """Which part of a place counts as moved, since it is rounded.

    With few digits it is seen: a joint closes the gap of rounded places, and turns a body by it over its radius of
    gyration. Differences between two descriptions are in proportion to how far away the mechanism stands.
    """
    if not engine.precision:
        return ROUNDED
    gyration = min(math.sqrt(body.inertia / body.mass) for body in mechanism.bodies)
    return SEEN / ROUGHLY * max(1.0, mechanism.length_scale / gyration)


def _in_units(engine: Engine, recipe: Recipe, mechanism: Mechanism, decades: tuple[int, int]) -> float:
    longer, heavier = decades
    of_length, of_mass, of_time = recipe.decades
    other, length = build(replace(recipe, decades=(of_length + longer, of_mass + heavier, of_time))), 10.0**longer
    if abs(other.length_scale / (length * mechanism.length_scale) - 1) > SAME:
        raise NotAsked("no joint has an arm: a metre stands for the mechanism's length, whatever the unit")
    run = _run(engine, other)
    unit = np.array([length, length, 1.0])
    return _apart(mechanism, engine, run.pose[-1] / unit, run.twist[-1] / unit)


def _has_lengths(engine: Engine) -> bool:
    """Whether its settings are those shipped: an impedance that grows over a millimetre, a slop of a decimetre."""
    return engine.variant == "default"
