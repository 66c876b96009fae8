"""A motion does not depend on how its mechanism is described: turned, shifted, mirrored, renamed, in other units.

The changes are those of the conformance kit, on mechanisms that nobody chose. One change a case, by the case's number.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Engine
from engines.bullet import Bullet
from engines.conformance.same import Change, Isometry, joints_swapped, relabelled
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.tree import spanning_tree
from reference.joints import Drive, Roll, Weld
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.instant_mujoco import solved
from reports.search.law import (
    ESTIMATED,
    ROUNDINGS,
    Fault,
    NotAsked,
    difference,
    response,
    turned_in_a_step,
)
from reports.search.motion_bounds import left_by_newton
from reports.search.parts import Recipe
from reports.search.recipe import build

Array = NDArray[np.float64]
STEP = 0.01  # of the mechanism's own time scale
STEPS = 5
CONVERGED = 1e-12  # of the slowest mode, after the iterations of a step of Bullet
MOST_ITERATIONS = 2_000_000
# Rounding alone differs. A method that combines runs carries up to a hundred times as much of it, one that hardens its
# constraints gives away half of the digits.
SAME = 1e-7
# The same of an engine that computes with fewer digits, and says so as its `precision`: of what moves, places keep few.
ROUGHLY = 1e4
NUDGES, NUDGED = 3, 1e-3
# rad: what Box2D reads of a weld's angle is off by half of this, in each direction by another (`instant_box2d`); it is
# the only one with so few digits that has welds.
MISREAD = 2 * 2.8e-5
ROUNDED = 1e-6  # of a place: beside a motion that is smaller, its rounding is seen
SEEN = 20.0  # roundings of a place; six, and in one of 600 mechanisms thirteen, were met

TOO_LONG = "steps are too long for what turns, so that rounding grows at will"

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

    MuJoCo and MJX are asked without what their solver leaves within its tolerance (`instant_mujoco.solved`), and Bullet
    with as many iterations as its loops need, for what they leave is declared, and another in each description.
    """
    match engine:
        case MuJoCo():
            engine = solved(engine)
        case Mjx():
            engine = replace(engine, settings=solved(engine.settings))
        case Bullet():
            found = _errors(engine, recipe, number)
            if max(found.values()) <= bound(engine):
                return found
            engine = replace(engine, iterations=_iterations(build(recipe), number), residual=0.0)
    return _errors(engine, recipe, number)


def _iterations(mechanism: Mechanism, number: int) -> int:
    """After how many iterations of Bullet nothing is left of its slowest mode, in both descriptions; raises NotAsked.

    It solves the rows J that close a tree one after the other, for the tree's own coordinates: Gauss-Seidel of
    A = J S M^-1 J^T, with S what the tree leaves free. An iteration leaves the spectral radius of 1 - L^-1 A, L its
    lower triangle, and the axes of the world are those of a pin's rows, so that this differs between descriptions.
    """
    change = CHANGES.get(NAMES[number % len(NAMES)])
    slowest = max(_left(each) for each in (mechanism, change(mechanism)[0] if change else mechanism))
    iterations = math.ceil(math.log(CONVERGED) / math.log(slowest)) if slowest > 0 else 1
    if iterations > MOST_ITERATIONS:
        raise NotAsked(f"iterations leave {slowest:.6f} of the slowest mode each, so that they don't converge")
    return iterations


def _left(mechanism: Mechanism) -> float:
    tree, rows, light = spanning_tree(mechanism), mechanism.rows(mechanism.pose), 1 / mechanism.inertias.reshape(-1)
    solved = [tree.closes_by(joint) or isinstance(joint, Drive) for joint in mechanism.joints for _ in joint.labels]
    held, closing = rows[~np.array(solved)], rows[np.array(solved)]
    loose = np.eye(len(light)) - response(held, mechanism.inertias).motion @ held
    matrix = closing @ (loose * light) @ closing.T
    change = np.eye(len(matrix)) - np.linalg.pinv(np.tril(matrix)) @ matrix
    return float(np.clip(np.abs(np.linalg.eigvals(change)).max(initial=0.0), 0.0, 1 - 1e-12))


def _errors(engine: Engine, recipe: Recipe, number: int) -> dict[str, float]:
    mechanism = build(recipe)
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.touches:
        raise NotAsked("whether two shapes that just touch do touch depends on rounding")
    if turned_in_a_step(mechanism, STEP * mechanism.time_scale, mechanism.pose, mechanism.twist) > 1:
        raise NotAsked(TOO_LONG)
    name = NAMES[number % len(NAMES)]
    if name in UNITS:
        if engine.variant == "default":  # an impedance that grows over a millimetre, a slop of a decimetre
            raise NotAsked("settings as shipped have lengths in them")
        return {name: _in_units(engine, recipe, mechanism, UNITS[name])}
    try:
        changed, back = CHANGES[name](mechanism)
    except ValueError as reason:
        raise NotAsked(str(reason)) from None
    run = _run(engine, changed)
    pose, twist, _ = back(run)
    away = float(np.abs(changed.pose[:, :2]).max())
    return {name: _apart(mechanism, engine, pose[-1], twist[-1], changed, run, away)}


def _run(engine: Engine, mechanism: Mechanism) -> Trajectory:
    run = engine.build(mechanism, STEP * mechanism.time_scale)(1, STEPS)
    if run.unresolved_at is not None and np.isfinite(run.pose).all():
        raise NotAsked("it says itself that it is unresolved in one of the descriptions")
    return run


def _apart(
    mechanism: Mechanism,
    engine: Engine,
    pose: Array,
    twist: Array,
    changed: Mechanism,
    run: Trajectory,
    away: float = 0.0,
) -> float:
    """How different a pose and a twist are from those of the mechanism itself; `away` [m] is how far the other stood.

    A shift costs digits of a place, those of its distance; and a velocity those of a place divided by a step. Raises
    NotAsked where they differ and either run has warnings, or where rounding makes as much of a difference: in the
    `changed` description and its own `run`, or in the mechanism's.
    """
    own = _run(engine, mechanism)
    step = STEP * mechanism.time_scale

    def error(one: Mechanism, told: Trajectory, pose: Array, twist: Array) -> float:
        rounded = _rounded(engine, one) * max(away, float(np.abs(one.pose[:, :2]).max()))
        moved, far = told.pose[-1] - one.pose, np.array([[rounded, 0.0, 0.0]]) + _misread(engine, one) / bound(engine)
        return max(
            difference(one, pose - one.pose, moved, (one.twist * STEPS * step, 1e-6 * one.pose, far)),
            difference(one, twist, told.twist[-1], (one.twist, far / step)),
        )

    found = error(mechanism, own, pose, twist)
    if found <= bound(engine):
        return found
    if own.warnings or run.warnings:
        raise NotAsked("descriptions differ, and it says itself that something is wrong")
    if engine.variant != "default" and not np.isfinite(own.pose[-1]).all():
        raise Fault(f"it was lost within {STEPS} steps, and says nothing")
    if own.estimate is not None:  # what rounding makes of a motion has to be in it
        size = mechanism.pose_unit
        claimed = max(CLAIM, ESTIMATED * float((own.estimate / size).max()))
        apart = float(np.abs((pose - own.pose[-1]) / size).max())
        if not apart <= claimed:
            return found
        faster = float(np.abs((twist - own.twist[-1]) / size).max()) * STEPS * step
        if max(apart, faster) <= (own.estimate / size).max():
            raise NotAsked("descriptions differ by less than what it says itself that it misses")
    if np.isfinite(own.pose[-1]).all() and turned_in_a_step(mechanism, step, own.pose[-1], own.twist[-1]) > 1:
        raise NotAsked(TOO_LONG)
    apart = np.maximum(np.abs(pose - own.pose[-1]), np.abs(twist - own.twist[-1]) * step)
    if np.all(apart <= left_by_newton(engine, mechanism, own, step).motion):
        raise NotAsked("descriptions differ by no more than the tolerance of Newton's method that it declares")
    for one, told in ((mechanism, own), (changed, run)):
        for change in _nudges(one, away):
            nudged, back = change(one)
            pose, twist, _ = back(_run(engine, nudged))
            if found <= ROUNDINGS * error(one, told, pose[-1], twist[-1]):
                raise NotAsked("descriptions differ by no more than what it makes of rounding")
    return found


def _misread(engine: Engine, mechanism: Mechanism) -> Array:
    """How far bodies (bodies, 3) [m, m, rad] are moved as the angles of welds are misread, and so closed as gaps.

    Of a gap of one row, all bodies move by a column of M^-1 J^T (J M^-1 J^T)^-1: a light one on a pin at a welded one's
    far end turns by more than the gap.
    """
    welds = [isinstance(joint, Weld) and label == "torque" for joint in mechanism.joints for label in joint.labels]
    if not engine.precision or not any(welds):
        return np.zeros_like(mechanism.pose)
    motion = response(mechanism.rows(mechanism.pose), mechanism.inertias).motion
    return MISREAD * np.abs(motion[:, welds]).sum(axis=1).reshape(-1, 3)


def _nudges(mechanism: Mechanism, away: float) -> Iterator[Change]:
    """Shifts by NUDGED of how far `away` [m] it stands, and turns by as much: every number of every step rounds anew.

    What an engine makes of it is its condition: of nearly dependent rows, masses far apart, weights of combined runs,
    gaps that are closed although they are but rounded, and of steps in which a light body is flung about. Shifted by a
    unit of rounding, steps round as before. What depends on the place or the direction itself changes by NUDGED alone.
    """
    random = np.random.default_rng(NUDGES)
    far = NUDGED * max(away, mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
    for x, y, turn in random.uniform(-1.0, 1.0, (NUDGES, 3)).tolist():
        yield Isometry(turn=NUDGED * turn, shift=(far * x, far * y))


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
    unit = np.array([length, length, 1.0])
    begins = difference(mechanism, other.twist / unit, mechanism.twist)
    if max(begins, abs(other.length_scale / (length * mechanism.length_scale) - 1)) > SAME:
        raise NotAsked("no joint has an arm: a metre stands for the mechanism's length, whatever the unit")
    run = _run(engine, other)
    return _apart(mechanism, engine, run.pose[-1] / unit, run.twist[-1] / unit, other, run)
