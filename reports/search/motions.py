"""A short motion and its reactions against the judge, at two steps, with the order that the engine promises.

The judge moves one mechanism at a time: no two cases are of one shape.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Promise, Unpromised
from engines.lagrange import HELD, TRUTH
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.judge import TABLEAUS, in_numpy
from reports.search.law import Fault, NotAsked, difference, driving_force, force_difference

Array = NDArray[np.float64]

SPAN = 0.4  # of the mechanism's own time scale: nothing has had time to become chaotic
SAMPLES, COARSE = 4, 10  # and steps between samples
# Above what the promised order lets expect of the coarser step: the next power of the step, and samples (as in
# engines.conformance.moving).
ROOM = 2.5
# Relative to the motion: rounding, that of combined runs and of a drive which a large inertia holds.
LEAST = {"motion": 1e-8, "reactions": 1e-5}
ROUNDINGS = 10.0  # of a place or a velocity
FINEST = 16  # parts of the coarse step
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
    if truth.unresolved_at is not None:
        raise NotAsked(f"the judge itself does not hold {HELD:g}, as it says")
    fine = _run(engine, mechanism, dt / 2, 2 * COARSE)
    if coarse.warnings or fine.warnings:
        raise NotAsked("it says itself that something is wrong")
    found, parts = [_apart(mechanism, run, truth, promise) for run in (coarse, fine)], 2
    finest = FINEST if promise.amplified == 1 else 4
    while _misses(promise, found, _rounded(mechanism, promise, truth, parts)) and parts < finest:
        # A coarser error may be small by chance, and an order is that of short steps: a fault shows it at none of them.
        parts *= 2
        run = _run(engine, mechanism, dt / parts, parts * COARSE)
        if run.warnings:
            raise NotAsked("it says itself that something is wrong")
        found = [found[1], _apart(mechanism, run, truth, promise)]
    rounded = _rounded(mechanism, promise, truth, parts)
    if _misses(promise, found, rounded) and not _resolved(mechanism, promise, truth, parts):
        raise NotAsked("something passes within a step: a textbook method shows no order at these steps either")
    out = {name: (found[1][name], _may_be(promise, name, found[0][name], rounded[name])) for name in found[1]}
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
    place = _place(mechanism)
    steps = SAMPLES * 4 * COARSE * promise.differences if promise.amplified > 1 else 1
    carried = promise.amplified * max(steps, 1) ** 0.5
    return max(moved, free, carried * ROUNDINGS * np.finfo(float).eps * place / LEAST["motion"])


def _place(mechanism: Mechanism) -> float:
    """How large the numbers [m] are in which a mechanism's places are written."""
    return max(mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))


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


def _may_be(promise: Promise, name: str, coarser: float, rounded: float) -> float:
    order = promise.of("angle" if name == "motion" else "reaction")
    return min(max(ROOM * coarser * 0.5 ** min(order, 20.0), LEAST[name], rounded), LOST)


def _rounded(mechanism: Mechanism, promise: Promise, truth: Trajectory, parts: int) -> dict[str, float]:
    """What rounding leaves in the errors of a run whose steps are these parts of the coarse one."""
    dt = SPAN * mechanism.time_scale / SAMPLES / COARSE
    return {
        "motion": _drifted(mechanism, truth, SAMPLES * COARSE * parts) / _size(mechanism, truth, promise),
        "reactions": _rounded_reactions(mechanism, promise, truth, dt / max(parts, 4)),
    }


def _rounded_reactions(mechanism: Mechanism, promise: Promise, truth: Trajectory, dt: float) -> float:
    """What rounding of velocities [m/s], divided by a step [s], leaves in reactions, as a part of them.

    An engine that reads them so closes in every step what it sees of a gap, and that is rounded as places are.
    """
    size = np.array([1.0, 1.0, mechanism.length_scale])
    speed = float(np.abs(truth.twist * size).max()) + _place(mechanism) * promise.differences / dt
    force = ROUNDINGS * np.finfo(float).eps * speed / dt * mechanism.inertias[:, 0].max()
    return promise.amplified * promise.differences * force / _force_size(mechanism, truth)


def _resolved(mechanism: Mechanism, promise: Promise, truth: Trajectory, parts: int) -> bool:
    """Whether a textbook method of the promised order, or 4, shows it from the steps before these parts to these.

    A spring that shrinks to nothing for less than a step pushes one way and then the other: what a method makes of that
    depends on where its stages fall, and its error on no power of the step.
    """
    order = max((each for each in TABLEAUS if each <= promise.order), default=1)
    spacing = SPAN * mechanism.time_scale / SAMPLES
    try:
        runs = [in_numpy(mechanism, SAMPLES, spacing, order, n * COARSE, None, True) for n in (parts // 2, parts)]
    except ValueError:  # it went where curves can't touch
        return False
    found = [_apart(mechanism, run, truth, Promise(order)) for run in runs]
    return not _misses(Promise(order), found, _rounded(mechanism, Promise(order), truth, parts))


def _drifted(mechanism: Mechanism, truth: Trajectory, steps: int) -> float:
    """How far [m] so many steps may carry anything by their rounding, which joints close what it opens.

    A step writes each number of a pose twice, as its sum and after joints are closed, and rounds it by half a unit each
    time: e = eps |q|, and eps |v| t of a velocity. Where motions hardly change so do roundings, and they add up as
    steps do. Of e a step leaves P e, P = 1 - H with H = M^-1 J^T (J M^-1 J^T)^-1 J, which the next ones keep; rounding
    of the last gap leaves H e. So a rounded place turns a body by it over its arm, far more than an angle is rounded.
    """
    root, turn = np.sqrt(mechanism.inertias.reshape(-1)), np.array([1.0, 1.0, mechanism.length_scale])
    least = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])  # arms, and the cosine of an angle
    worst = 0.0
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        numbers = np.maximum(np.abs(pose), least) + np.abs(twist) * SPAN * mechanism.time_scale
        rows = mechanism.rows(pose) / root
        turned = np.linalg.svd(rows / np.linalg.norm(rows, axis=1)[:, None], full_matrices=False)[2]
        held = turned.T @ turned
        carried = (steps * np.abs(np.eye(len(root)) - held) + np.abs(held)) @ (root * numbers.reshape(-1)) / root
        worst = max(worst, float((carried.reshape(-1, 3) * turn).max()))
    return np.finfo(float).eps * worst


def _misses(promise: Promise, found: list[dict[str, float]], rounded: dict[str, float]) -> bool:
    return any(found[1][name] > _may_be(promise, name, found[0][name], rounded[name]) for name in found[1])


def _gives_way(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether joints give way visibly, and at half the step nearly as much."""
    coarse, fine = (engine.softness(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    ways = [soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine)]
    return ways[1] > HARD and 2 * ways[1] > ways[0]
