"""A short motion and its reactions against the judge, at two steps, with the order that the engine promises.

The judge moves one mechanism at a time: no two cases are of one shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Promise, Softness, Unpromised
from engines.lagrange import TRUTH
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.law import (
    ROUNDINGS,
    Fault,
    NotAsked,
    carried,
    constrained,
    difference,
    driving_force,
    force_difference,
    place,
    turned_in_a_step,
)

Array = NDArray[np.float64]

SPAN = 0.4  # of the mechanism's own time scale: nothing has had time to become chaotic
SAMPLES, COARSE = 4, 10  # and steps between samples
# Above what the promised order lets expect of the coarser step: the next power of the step, and samples (as in
# engines.conformance.moving).
ROOM = 2.5
# Relative to the motion: rounding, that of combined runs and of a drive which a large inertia holds.
LEAST = {"motion": 1e-8, "reactions": 1e-5}
LOST = 10.0  # times the motion: nothing is left of it, whatever a coarser step gives
ESTIMATED = 10.0  # times its own estimate an error may be
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
    if max(turned_in_a_step(mechanism, dt, *state) for state in zip(truth.pose, truth.twist, strict=True)) > 1:
        raise NotAsked("steps are too long for what turns, so that no order is seen")
    fine = _run(engine, mechanism, dt / 2, 2 * COARSE)
    if coarse.warnings or fine.warnings:
        raise NotAsked("it says itself that something is wrong")
    found, finest = [_apart(mechanism, run, truth, promise) for run in (coarse, fine)], dt / 2
    if _misses(promise, found):  # a coarser error may be small by chance: it must not fall between the next two either
        finest = dt / 4
        found = [found[1], _apart(mechanism, _run(engine, mechanism, finest, 4 * COARSE), truth, promise)]
    out = {name: (found[1][name], _may_be(promise, name, found[0][name])) for name in found[1]}
    rounded = _rounded_reactions(mechanism, promise, truth, finest)
    softness = engine.softness(mechanism, finest)
    if softness is not None:
        if softness == engine.softness(mechanism, dt):  # else it is tied to the step, and so to the promised order
            soft = ROOM * _given_way(softness, mechanism, truth) / _size(mechanism, truth, promise)
            out["motion"] = (out["motion"][0], min(max(out["motion"][1], soft), LOST))
        rounded = max(rounded, _rounded_gaps(softness, mechanism) / _force_size(mechanism, truth))
    out["reactions"] = (out["reactions"][0], max(out["reactions"][1], rounded))
    if fine.estimate is not None:
        size = np.array([1.0, 1.0, mechanism.length_scale])
        told = float(np.abs(fine.estimate * size).max()) / _size(mechanism, truth, promise)
        out["estimate"] = (
            _apart(mechanism, fine, truth, promise)["motion"],
            min(ESTIMATED * told + LEAST["motion"], LOST),
        )
    return out


def _run(engine: Engine, mechanism: Mechanism, dt: float, every: int) -> Trajectory:
    run = engine.build(mechanism, dt)(SAMPLES, every)
    if not np.isfinite(run.pose).all() and not run.warnings and run.reset_at is None:
        raise Fault(f"at a step of {dt:.3g} s it lost the motion, and says nothing")
    return run


def _size(mechanism: Mechanism, truth: Trajectory, promise: Promise) -> float:
    """How far anything moves [m], or would without joints; at least so far that rounded places are below LEAST.

    A combination of runs carries more of them: those that the steps of its finest run add up, as a random walk does.
    """
    size = np.array([1.0, 1.0, mechanism.length_scale])
    moved = float(np.abs((truth.pose - mechanism.pose) * size).max())
    pulled = np.abs(mechanism.unconstrained(mechanism.pose, mechanism.twist) * size).max()
    free = float(pulled) * (SPAN * mechanism.time_scale) ** 2 / 2
    steps = SAMPLES * 4 * COARSE * promise.differences if promise.amplified > 1 else 1
    rounded = ROUNDINGS * np.finfo(float).eps * promise.amplified * max(steps, 1) ** 0.5
    return max(moved, free, rounded * place(mechanism, mechanism.pose) / LEAST["motion"])


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
    size = np.array([1.0, 1.0, mechanism.length_scale])
    speed = float(np.abs(truth.twist * size).max()) + place(mechanism, truth.pose) * promise.differences / dt
    rounded = ROUNDINGS * np.finfo(float).eps * speed / dt
    arms = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    force = max(float((carried(mechanism, pose, rounded).force * arms).max(initial=0.0)) for pose in truth.pose)
    return promise.amplified * promise.differences * force / _force_size(mechanism, truth)


def _misses(promise: Promise, found: list[dict[str, float]]) -> bool:
    return any(found[1][name] > _may_be(promise, name, found[0][name]) for name in found[1])


def _given_way(softness: Softness, mechanism: Mechanism, truth: Trajectory) -> float:
    """How far bodies are off [m] since joints give way as the engine declares, where that falls with no power of dt.

    A row obeys J a = ... - damping slip - stiffness gap - R f with R a share of its own A = J M^-1 J^T: its gap is
    R f / stiffness at most, a blade's slip R f / damping. A light body's row that carries the force of a heavy one
    gives way far, for its A is large. Joints make the smallest motion of it, M^-1 J^T (J M^-1 J^T)^-1 gap.
    """
    own = np.sum(mechanism.rows(mechanism.pose) ** 2 / mechanism.inertias.reshape(-1), axis=1)
    pulled = softness.compliance * own * np.abs(np.nan_to_num(truth.reaction)).max(axis=0)
    gap = pulled / np.where(mechanism.holonomic, softness.stiffness, softness.damping / truth.t[-1])
    return float((_answer(mechanism, gap, softness.rows)[0] * [1.0, 1.0, mechanism.length_scale]).max())


def _rounded_gaps(softness: Softness, mechanism: Mechanism) -> float:
    """What force [N] stiff rows make of rounded gaps: (J M^-1 J^T)^-1 stiffness eps, a unit of the places' numbers."""
    far = max(mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
    gap = ROUNDINGS * np.finfo(float).eps * np.where(mechanism.turning, 1.0, far)
    arms = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    asked = softness.stiffness * gap * mechanism.holonomic
    return float((_answer(mechanism, asked, softness.rows)[1] * arms).max(initial=0.0))


def _answer(mechanism: Mechanism, right: Array, which: tuple[bool, ...]) -> tuple[Array, Array]:
    """The most that `right` (rows,) of these rows makes of motions (bodies, 3) and of forces (rows,)."""
    rows, still = mechanism.rows(mechanism.pose), np.zeros_like(mechanism.pose)
    motion, force = still, np.zeros(len(rows))
    for row in np.flatnonzero(which):
        law = constrained(rows, right * (np.arange(len(rows)) == row), mechanism.inertias, still)
        motion, force = motion + np.abs(law.motion), force + np.abs(law.force)
    return motion, force


def _gives_way(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether joints give way visibly, and at half the step nearly as much."""
    coarse, fine = (engine.softness(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    ways = [soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine)]
    return ways[1] > HARD and 2 * ways[1] > ways[0]
