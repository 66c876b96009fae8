"""A short motion and its reactions against the judge, at two steps or more, with the order that the engine promises.

The judge moves one mechanism at a time: no two cases are of one shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Promise, Unpromised
from engines.lagrange import TRUTH
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.law import (
    ESTIMATED,
    ROUNDINGS,
    Fault,
    NotAsked,
    carried,
    difference,
    driving_force,
    force_difference,
    written,
)

Array = NDArray[np.float64]

SPAN = 0.4  # of the mechanism's own time scale: nothing has had time to become chaotic
SAMPLES, COARSE = 4, 10  # and steps between samples
# Above what the promised order lets expect of the coarser step: the next power of the step, and samples (as in
# engines.conformance.moving).
ROOM = 2.5
# Relative to the motion: rounding, that of combined runs and of a drive which a large inertia holds.
LEAST = {"motion": 1e-8, "reactions": 1e-5}
# An order shows where steps are short against all that happens: a rod that turns fast, impulses that settle in many
# steps, a gap that is closed in a time of its own. So they are halved, up to this many parts, until it shows for poses
# and for reactions; an error that was small by chance does not count against the next. What never falls is a fault, as
# rounding that grows with shorter steps excuses no more than it does at the first.
FINEST = 64
LOST = 10.0  # times the motion: nothing is left of it, whatever a coarser step gives
HARD = 1e-10  # of the time scale squared: joints that give way by less are ideal here


def errors(engine: Engine, mechanism: Mechanism) -> dict[str, tuple[float, float]]:
    """(error at the finer step, what it may be) of "motion", "reactions" and, of an engine that gives one, "estimate".

    Raises NotAsked where nothing is promised or joints give way for good; Fault where a motion is lost in silence.
    """
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.touches:
        raise NotAsked("shapes that touch may part, and those with corners do not roll as the curves do, at any step")
    dt = SPAN * mechanism.time_scale / SAMPLES / COARSE
    coarse = _run(engine, mechanism, dt, COARSE)
    promise = engine.order(mechanism)
    if isinstance(promise, Unpromised):
        raise NotAsked(f"no order is promised: {promise.reason}")
    if _gives_way(engine, mechanism, dt):
        raise NotAsked("joints give way as the engine says, by the same at every step")
    truth = TRUTH.build(mechanism, SPAN * mechanism.time_scale / SAMPLES)(SAMPLES, 1)
    if not np.isfinite(truth.pose).all():
        raise NotAsked("the judge itself finds no motion")
    rounded = _rounded_reactions(mechanism, promise, truth, dt / 2)
    out: dict[str, tuple[float, float]] = {}
    parts, run = 1, coarse
    while parts < FINEST and (not out or any(not error <= bound for error, bound in out.values())):
        finer = _run(engine, mechanism, dt / (2 * parts), 2 * parts * COARSE)
        if not out and (coarse.warnings or finer.warnings):
            raise NotAsked("it says itself that something is wrong")
        if finer.warnings:
            break
        parts, run, coarser = 2 * parts, finer, _apart(mechanism, run, truth, promise)
        for name, error in _apart(mechanism, run, truth, promise).items():
            may_be = max(_may_be(promise, name, coarser[name]), rounded if name == "reactions" else 0.0)
            if name not in out or not out[name][0] <= out[name][1]:
                out[name] = (error, may_be)
    if not np.isfinite(run.pose).all():
        raise Fault(f"at a step of {dt / parts:.3g} s it lost the motion, and says nothing")
    if run.estimate is not None:
        size = np.array([1.0, 1.0, mechanism.length_scale])
        told = float(np.abs(run.estimate * size).max()) / _size(mechanism, truth, promise)
        missed = _apart(mechanism, run, truth, promise)["motion"]
        out["estimate"] = (missed, min(ESTIMATED * told + LEAST["motion"], LOST))
    return out


def _run(engine: Engine, mechanism: Mechanism, dt: float, every: int) -> Trajectory:
    """Settings as shipped know no step that is too long: they may lose a motion with all but the finest."""
    run = engine.build(mechanism, dt)(SAMPLES, every)
    lost = not np.isfinite(run.pose).all() and engine.variant != "default"
    if lost and not run.warnings and run.reset_at is None:
        raise Fault(f"at a step of {dt:.3g} s it lost the motion, and says nothing")
    return run


def _size(mechanism: Mechanism, truth: Trajectory, promise: Promise) -> float:
    """How far anything moves [m], or would without joints; at least so far that rounded places are below LEAST.

    A combination of runs carries more of them: those that the steps of its finest run add up, as a random walk does.
    And an engine that closes gaps moves by what the joints make of a rounded one (`carried`).
    """
    size = np.array([1.0, 1.0, mechanism.length_scale])
    moved = float(np.abs((truth.pose - mechanism.pose) * size).max())
    pulled = np.abs(mechanism.unconstrained(mechanism.pose, mechanism.twist) * size).max()
    free = float(pulled) * (SPAN * mechanism.time_scale) ** 2 / 2
    steps = SAMPLES * 4 * COARSE * promise.differences if promise.amplified > 1 else 1
    rounded = ROUNDINGS * np.finfo(float).eps * promise.amplified * max(steps, 1) ** 0.5
    numbers = written(mechanism)
    if promise.differences:
        numbers = np.array([carried(mechanism, pose, numbers).motion for pose in truth.pose])
    return max(moved, free, rounded * float((numbers * size).max()) / LEAST["motion"])


def _apart(mechanism: Mechanism, run: Trajectory, truth: Trajectory, promise: Promise) -> dict[str, float]:
    largest = np.array([[_size(mechanism, truth, promise), 0.0, 0.0]])
    moved = [difference(mechanism, pose, right, (largest,)) for pose, right in _moves(mechanism, run, truth)]
    most = _force_size(mechanism, truth)
    pulled = [
        force_difference(mechanism, own, right, (most,))
        for own, right in zip(run.reaction[1:], truth.reaction[1:], strict=True)
    ]
    return {"motion": max(moved), "reactions": max(pulled)}


def _force_size(mechanism: Mechanism, truth: Trajectory) -> float:
    """The largest force [N] that the motion has to do with."""
    force = max(driving_force(mechanism, twist) for twist in truth.twist)
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    return max(force, float(np.abs(truth.reaction * size).max(initial=0.0)), np.finfo(float).tiny)


def _moves(mechanism: Mechanism, run: Trajectory, truth: Trajectory) -> list[tuple[Array, Array]]:
    return [
        (own - mechanism.pose, right - mechanism.pose) for own, right in zip(run.pose[1:], truth.pose[1:], strict=True)
    ]


def _may_be(promise: Promise, name: str, coarser: float) -> float:
    order = promise.of("angle" if name == "motion" else "reaction")
    return min(max(ROOM * coarser * 0.5 ** min(order, 20.0), LEAST[name]), LOST)


def _rounded_reactions(mechanism: Mechanism, promise: Promise, truth: Trajectory, dt: float) -> float:
    """What rounding of velocities [m/s], divided by a step [s], leaves in reactions, as a part of them.

    An engine that reads them so closes in every step what it sees of a gap, and that is rounded as places are. What
    joints make of it grows with how nearly their rows depend on each other: see `carried`.
    """
    arms = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    forces = []
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        numbers = np.abs(twist) + written(mechanism) * promise.differences / dt
        forces.append(carried(mechanism, pose, numbers).force * arms)
    rounded = ROUNDINGS * np.finfo(float).eps / dt * promise.amplified * promise.differences
    return rounded * float(np.max(forces, initial=0.0)) / _force_size(mechanism, truth)


def _gives_way(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether joints give way visibly, and at half the step nearly as much."""
    coarse, fine = (engine.softness(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    ways = [soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine)]
    return ways[1] > HARD and 2 * ways[1] > ways[0]
