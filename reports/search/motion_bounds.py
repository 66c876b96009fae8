"""What a motion and its reactions may be off by, whatever the step: rounding, declared give, a solver's tolerance.

Each bound is derived from the mechanism and from what an engine says of itself, and none from what was found.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Promise, Softness
from engines.exudyn import Exudyn
from engines.mujoco import MuJoCo
from engines.pinocchio import Pinocchio
from engines.tree import spanning_tree
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.instant_mujoco import left_by_its_solver
from reports.search.law import ROUNDINGS, Constrained, carried, driving_force, ideal, response, rounded, written

Array = NDArray[np.float64]

SPAN = 0.4  # of the mechanism's own time scale: nothing has had time to become chaotic
SAMPLES, COARSE = 4, 10  # and steps between samples
# Above what the promised order lets expect of the coarser step: the next power of the step, and samples (as in
# engines.conformance.moving).
ROOM = 2.5
# Relative to the motion: rounding, that of combined runs and of a drive which a large inertia holds.
LEAST = {"motion": 1e-8, "reactions": 1e-5}


def size_of(mechanism: Mechanism, truth: Trajectory, promise: Promise) -> float:
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


def shares(mechanism: Mechanism, truth: Trajectory, promise: Promise, off: Constrained) -> dict[str, float]:
    """What poses (bodies, 3) and forces (rows,) are off by, as parts of the motion and of the largest force."""
    moved = np.abs(off.motion * [1.0, 1.0, mechanism.length_scale]).max()
    pulled = np.abs(off.force * np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)).max(initial=0.0)
    return {
        "motion": float(moved) / size_of(mechanism, truth, promise),
        "reactions": float(pulled) / force_size(mechanism, truth),
    }


def force_size(mechanism: Mechanism, truth: Trajectory) -> float:
    """The largest force [N] that the motion has to do with; a reaction that is NaN is none that is known."""
    force = max(driving_force(mechanism, twist) for twist in truth.twist)
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    reaction = np.abs(np.nan_to_num(truth.reaction) * size)
    return max(force, float(reaction.max(initial=0.0)), np.finfo(float).tiny)


def least_of(engine: Engine, mechanism: Mechanism, promise: Promise, truth: Trajectory, parts: int) -> dict[str, float]:
    """What errors may be in a run whose steps are these parts of the coarse one: of rounding, and of declared give."""
    dt = SPAN * mechanism.time_scale / SAMPLES / COARSE
    size, force = size_of(mechanism, truth, promise), force_size(mechanism, truth)
    reactions = rounded_reactions(mechanism, promise, truth, dt / 2)
    motion = max(drifted(mechanism, truth, SAMPLES * COARSE * parts), left_open(mechanism, truth)) / size
    if isinstance(engine, Pinocchio):
        summed = shares(mechanism, truth, promise, _rounded_about_origin(mechanism, truth))
        motion, reactions = max(motion, summed["motion"]), max(reactions, summed["reactions"])
    softness = engine.softness(mechanism, dt / parts)
    if softness is not None:
        if softness == engine.softness(mechanism, dt):  # else it is tied to the step, and so to the promised order
            motion = max(motion, ROOM * _given_way(softness, mechanism, truth) / size)
        reactions = max(reactions, _rounded_gaps(softness, mechanism) / force)
    return {"motion": motion, "reactions": reactions}


def rounded_reactions(mechanism: Mechanism, promise: Promise, truth: Trajectory, dt: float) -> float:
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
    return rounded * float(np.max(forces, initial=0.0)) / force_size(mechanism, truth)


def left_by_newton(engine: Engine, mechanism: Mechanism, truth: Trajectory, dt: float) -> Constrained:
    """What Newton's method of MuJoCo or Exudyn may leave in motions (bodies, 3) and reactions (rows,); 0 of any other.

    Exudyn's ends where one norm of what is left of forces [N], torques [N m] and what is held [m or rad; of index 2 as
    rates] is below `relative` times what it begins with, which is about the largest force, and `absolute`. A
    light body then accelerates by that over its mass, for the whole motion; and of a gap that is left in a step the
    next one makes an acceleration 1 / (beta dt^2) times as large, beta = 1/4 or above, of a rate 2 / dt. One that ends
    by what it still moves, in its own units, leaves no more than is below LEAST.
    """
    own = engine.within(mechanism)
    if not isinstance(own, Exudyn) or own.own_units:
        still = 0 * mechanism.pose
        moved = left_by_its_solver(own, mechanism, dt, truth.t[-1]) if isinstance(own, MuJoCo) else still
        return Constrained(moved, np.zeros(mechanism.row_count))
    left = own.relative * force_size(mechanism, truth) * max(1.0, mechanism.length_scale) + own.absolute
    rows, lasts = mechanism.rows(mechanism.pose), truth.t[-1]
    back, light = response(rows, mechanism.inertias), 1 / mechanism.inertias.reshape(-1)
    force, gap = np.full(len(light), left), np.full(len(rows), left)
    pushed = np.abs((np.eye(len(light)) - back.motion @ rows) * light) @ force * lasts**2 / 2
    rates = own.integrator == "TrapezoidalIndex2"
    held = np.abs(back.motion) @ gap * (lasts if rates else 1.0)
    pulled = np.abs(back.force) @ gap * (2 / dt if rates else 4 / dt**2)
    return Constrained((pushed + held).reshape(-1, 3), pulled)


def drifted(mechanism: Mechanism, truth: Trajectory, steps: int) -> float:
    """How far [m] so many steps may carry anything by their rounding, which joints close what it opens.

    A step writes each number of a pose twice, as its sum and after joints are closed, and rounds it by half a unit each
    time: e = eps |q|, and eps |v| t of a velocity. Where motions hardly change so do roundings, and they add up as
    steps do. Of e a step leaves P e, P = 1 - H with H = M^-1 J^T (J M^-1 J^T)^-1 J, which the next ones keep; rounding
    of the last gap leaves H e. So a rounded place turns a body by it over its arm, far more than an angle is rounded.
    """
    turn = np.array([1.0, 1.0, mechanism.length_scale])
    least = mechanism.pose_unit  # arms, and the cosine of an angle
    worst = 0.0
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        numbers = np.maximum(np.abs(pose), least) + np.abs(twist) * SPAN * mechanism.time_scale
        rows = mechanism.rows(pose)
        held = response(rows, mechanism.inertias).motion @ rows
        carried = (steps * np.abs(np.eye(len(held)) - held) + np.abs(held)) @ numbers.reshape(-1)
        worst = max(worst, float((carried.reshape(-1, 3) * turn).max()))
    return np.finfo(float).eps * worst


def left_open(mechanism: Mechanism, truth: Trajectory) -> float:
    """How far bodies are off [m] by the gaps that the judge itself leaves, 1e-12 of the length: more than slow motions
    are, of a mechanism of which one arm is long."""
    size, worst = np.array([1.0, 1.0, mechanism.length_scale]), 0.0
    for pose, t in zip(truth.pose, truth.t, strict=True):
        back = np.abs(response(mechanism.rows(pose), mechanism.inertias).motion)
        gap = np.abs(np.nan_to_num(mechanism.gap(pose, t)))
        worst = max(worst, float(((back @ gap).reshape(-1, 3) * size).max()))
    return worst


def _rounded_about_origin(mechanism: Mechanism, truth: Trajectory) -> Constrained:
    """What poses (bodies, 3) and reactions (rows,) lose in Pinocchio, which adds up forces in the world's frame.

    In the equation of a joint's coordinate stand the masses m of all that hangs on it, times what each joint of their
    chains adds to their acceleration: a_j + r_j alpha_j, r_j from the joint. Joints may move against each other: a
    light body is lost beside a heavy one that hangs on it. These forces F, and those that act, have torques |p| F about
    the world's origin, for bodies and for joints, and velocities add m v (v + omega |p|) (Featherstone 2008, equation
    2.70). Of n coordinates a solution rounds 3 n + 1 times (Higham 2002, theorem 10.4), and sums 2 n + 6 times, by half
    a unit each. Rounding has no sign, so squares are added. What is rounded, u, acts on bodies as forces: with
    `rounded` da = S M^-1 u, of which the motion is da t^2 / 2, and df = A^-1 J M^-1 u.
    """
    tree = spanning_tree(mechanism)
    own = {link.body: link for link in tree.links}
    often = (5 * tree.coordinates + 7) ** 0.5 / 2 * np.finfo(float).eps
    moved, pulled = np.zeros_like(mechanism.pose), np.zeros(mechanism.row_count)
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        law, free = ideal(mechanism, pose, twist), mechanism.unconstrained(pose, twist)
        asked = np.abs(free) + np.abs(law.motion)
        asked[:, :2] = np.hypot(asked[:, 0], asked[:, 1])[:, None]
        for body in own:
            above: int | None = body
            while above is not None:
                link = own[above]
                added = law.motion[above] - (0.0 if link.parent is None else law.motion[link.parent])
                arm = np.hypot(*(pose[body] - pose[above])[:2]) + np.hypot(*link.anchor)
                asked[body, :2] += np.hypot(*added[:2]) + arm * (abs(added[2]) + twist[above, 2] ** 2)
                asked[body, 2] += abs(added[2])
                above = link.parent
        summed, far, fast = mechanism.inertias * asked, np.hypot(*pose[:, :2].T), np.hypot(*twist[:, :2].T)
        summed[:, 2] += far * summed[:, 0] + mechanism.inertias[:, 0] * fast * (fast + far * np.abs(twist[:, 2]))
        for link in reversed(tree.links):
            if link.parent is not None:
                summed[link.parent] += summed[link.body]
            summed[link.body, 2] += (far[link.body] + np.hypot(*link.anchor)) * summed[link.body, 0]
        rows, bias = mechanism.rows(pose), mechanism.bias(pose, twist)
        doubt = np.zeros(len(rows)), often * summed
        off = rounded(rows, law, bias, mechanism.inertias, free, np.zeros((len(rows), 0)), doubt)
        moved, pulled = np.maximum(moved, off.motion), np.maximum(pulled, off.force)
    return Constrained(moved * truth.t[-1] ** 2 / 2, pulled)


def _given_way(softness: Softness, mechanism: Mechanism, truth: Trajectory) -> float:
    """How far bodies are off [m] since joints give way as the engine declares, where that falls with no power of dt.

    A row obeys J a = ... - damping slip - stiffness gap - R f with R a share of its own A = J M^-1 J^T: its gap is
    R f / stiffness at most, a blade's slip R f / damping. A light body's row that carries the force of a heavy one
    gives way far, for its A is large; two rows of a joint are alike in this, so that their axes make no difference.
    Joints make the smallest motion of it, M^-1 J^T (J M^-1 J^T)^-1 gap.
    """
    rows, begin = mechanism.rows(mechanism.pose), 0
    own = np.sum(rows**2 / mechanism.inertias.reshape(-1), axis=1)
    for joint in mechanism.joints:
        straight = begin + np.flatnonzero(~mechanism.turning[begin : begin + joint.size])
        begin += joint.size
        own[straight] = own[straight].sum() / max(len(straight), 1)
    pulled = softness.compliance * own * np.abs(np.nan_to_num(truth.reaction)).max(axis=0)
    gap = pulled / np.where(mechanism.holonomic, softness.stiffness, softness.damping / truth.t[-1])
    moved = np.abs(response(rows, mechanism.inertias).motion) @ (gap * softness.rows)
    return float((moved.reshape(-1, 3) * [1.0, 1.0, mechanism.length_scale]).max())


def _rounded_gaps(softness: Softness, mechanism: Mechanism) -> float:
    """What force [N] stiff rows make of rounded gaps: (J M^-1 J^T)^-1 stiffness eps, a unit of the places' numbers."""
    far = max(mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
    gap = ROUNDINGS * np.finfo(float).eps * np.where(mechanism.turning, 1.0, far)
    arms = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    asked = softness.stiffness * gap * mechanism.holonomic * softness.rows
    force = np.abs(response(mechanism.rows(mechanism.pose), mechanism.inertias).force) @ asked
    return float((force * arms).max(initial=0.0))
