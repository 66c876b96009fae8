"""A short motion and its reactions against the judge, at two steps or more, with the order that the engine promises.

The judge moves one mechanism at a time: no two cases are of one shape.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Promise, Softness, Unpromised
from engines.exudyn import Exudyn
from engines.lagrange import HELD, TRUTH
from engines.mujoco import MuJoCo
from engines.pinocchio import Pinocchio
from engines.pymunk import Pymunk
from engines.pymunk.contraction import contraction_at
from engines.remembered import by_identity
from engines.tree import spanning_tree
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.judge import TABLEAUS, giving_way, in_numpy, own_inertia
from reports.search.instant_mujoco import left_by_its_solver
from reports.search.law import (
    ESTIMATED,
    ROUNDINGS,
    Constrained,
    Fault,
    NotAsked,
    carried,
    difference,
    driving_force,
    force_difference,
    ideal,
    response,
    rounded,
    turned_in_a_step,
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
# steps, a gap that is closed in a time of its own. So they are halved, up to this many parts, until it shows for
# poses and for reactions; an error that was small by chance does not count against the next. What never falls is a
# fault, as rounding that grows with shorter steps excuses no more than it does at the first. A step at which the
# motion is lost, as anybody sees, is too long, if it is right at shorter ones: kept impulses of rows that turn within
# it grow, say.
FINEST = 64
LOST = 10.0  # times the motion: nothing is left of it, whatever a coarser step gives
OFF = 0.1  # of a radian, or of the mechanism's length: forces of poses that far away are other forces
ASKED = 16  # mechanisms of which all engines are asked before others come: see `chunk.SIZE`
HARD = 1e-10  # of the time scale squared: joints that give way by less are ideal here


def errors(engine: Engine, mechanism: Mechanism) -> dict[str, tuple[float, float]]:
    """(error at the finer step, what it may be) of "motion", "reactions" and, of an engine that gives one, "estimate".

    Raises NotAsked where nothing is promised or joints give way for good; Fault where a motion is lost in silence.
    """
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.touches:
        raise NotAsked("shapes that touch may part, and those with corners do not roll as the curves do, at any step")
    dt = SPAN * mechanism.time_scale / SAMPLES / COARSE
    coarse = engine.build(mechanism, dt)(SAMPLES, COARSE)
    promise = engine.order(mechanism)
    if isinstance(promise, Unpromised):
        raise NotAsked(f"no order is promised: {promise.reason}")
    if _gives_way(engine, mechanism, dt):
        raise NotAsked("joints give way as the engine says, by the same at every step")
    truth = judged(mechanism)
    if not np.isfinite(truth.pose).all():
        raise NotAsked("the judge itself finds no motion")
    if truth.unresolved_at is not None:
        raise NotAsked(f"the judge itself does not hold {HELD:g}, as it says")
    if max(turned_in_a_step(mechanism, dt, *state) for state in zip(truth.pose, truth.twist, strict=True)) > 1:
        raise NotAsked("steps are too long for what turns, so that no order is seen")
    out: dict[str, tuple[float, float]] = {}
    parts, run, warned, silent, longest = 1, coarse, False, 0, 0
    while parts < FINEST and (not out or _misses(out)):
        finer = engine.build(mechanism, dt / (2 * parts))(SAMPLES, 2 * parts * COARSE)
        if not out and (coarse.warnings or finer.warnings):
            raise NotAsked("it says itself that something is wrong")
        parts *= 2
        if finer.warnings:
            warned, silent = True, 0
            continue
        silent += 1
        longest = max(longest, silent)
        run, coarser = finer, _apart(mechanism, run, truth, promise)
        least, apart = _least(engine, mechanism, promise, truth, parts), _apart(mechanism, run, truth, promise)
        if apart["motion"] * _size(mechanism, truth, promise) > OFF * mechanism.length_scale:
            least["reactions"] = LOST
        for name, error in apart.items():
            known = least[name] < LOST and (coarser[name] < LOST or parts == FINEST)
            if known and (name not in out or not out[name][0] <= out[name][1]):
                out[name] = (error, _may_be(promise, name, coarser[name], least[name]))
    lost = not np.isfinite(run.pose).all()
    if lost or _misses(out):
        if warned and longest < 2:  # what two steps after each other say nothing of is silent
            raise NotAsked("it says itself, at shorter steps, that something is wrong")
        left = _left_by_sweeps(engine, mechanism, truth, dt / parts)
        if lost:
            raise Fault(f"at a step of {dt / parts:.3g} s it lost the motion, and says nothing")
        newton = _shares(mechanism, truth, promise, left_by_newton(engine, mechanism, truth, dt / parts))
        if all(error <= max(bound, newton[name]) for name, (error, bound) in out.items()):
            raise NotAsked("what is missed is within the tolerance of Newton's method that it declares")
        out |= _as_declared(engine, mechanism, promise, truth, run, parts)
        if _misses(out) and not _resolved(mechanism, promise, truth, max(4, int(parts * (1 - left)))):
            raise NotAsked("something passes within a step: a textbook method shows no order at these steps either")
    if run.estimate is not None:
        size = np.array([1.0, 1.0, mechanism.length_scale])
        both = max(float(np.abs(each * size).max()) for each in (run.estimate, truth.estimate) if each is not None)
        # The judge may miss as much as it says, too, and what it leaves open.
        told = (both + _left_open(mechanism, truth)) / _size(mechanism, truth, promise)
        missed = _apart(mechanism, run, truth, promise)["motion"]
        bound = ESTIMATED * told + LEAST["motion"]
        if not missed <= bound:
            bound += _shares(mechanism, truth, promise, left_by_newton(engine, mechanism, truth, dt / parts))["motion"]
        out["estimate"] = (missed, min(bound, LOST))
    return out


@by_identity(ASKED)
def judged(mechanism: Mechanism) -> Trajectory:
    """What the judge says of a mechanism, which many engines are asked about."""
    return TRUTH.build(mechanism, SPAN * mechanism.time_scale / SAMPLES)(SAMPLES, 1)


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
    moved = [
        difference(mechanism, own - mechanism.pose, right - mechanism.pose, (largest,))
        for own, right in zip(run.pose[1:], truth.pose[1:], strict=True)
    ]
    most = _force_size(mechanism, truth)
    pulled = [
        force_difference(mechanism, own, right, (most,))
        for own, right in zip(run.reaction[1:], truth.reaction[1:], strict=True)
    ]
    return {"motion": max(moved), "reactions": max(pulled)}


def _shares(mechanism: Mechanism, truth: Trajectory, promise: Promise, off: Constrained) -> dict[str, float]:
    """What poses (bodies, 3) and forces (rows,) are off by, as parts of the motion and of the largest force."""
    moved = np.abs(off.motion * [1.0, 1.0, mechanism.length_scale]).max()
    pulled = np.abs(off.force * np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)).max(initial=0.0)
    return {
        "motion": float(moved) / _size(mechanism, truth, promise),
        "reactions": float(pulled) / _force_size(mechanism, truth),
    }


def _force_size(mechanism: Mechanism, truth: Trajectory) -> float:
    """The largest force [N] that the motion has to do with; a reaction that is NaN is none that is known."""
    force = max(driving_force(mechanism, twist) for twist in truth.twist)
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    reaction = np.abs(np.nan_to_num(truth.reaction) * size)
    return max(force, float(reaction.max(initial=0.0)), np.finfo(float).tiny)


def _may_be(promise: Promise, name: str, coarser: float, least: float) -> float:
    order = promise.of("angle" if name == "motion" else "reaction")
    return min(max(ROOM * coarser * 0.5 ** min(order, 20.0), LEAST[name], least), LOST)


def _misses(found: dict[str, tuple[float, float]]) -> bool:
    return any(not error <= bound for error, bound in found.values())


def _least(engine: Engine, mechanism: Mechanism, promise: Promise, truth: Trajectory, parts: int) -> dict[str, float]:
    """What errors may be in a run whose steps are these parts of the coarse one: of rounding, and of declared give."""
    dt = SPAN * mechanism.time_scale / SAMPLES / COARSE
    size, force = _size(mechanism, truth, promise), _force_size(mechanism, truth)
    reactions = _rounded_reactions(mechanism, promise, truth, dt / 2)
    motion = max(_drifted(mechanism, truth, SAMPLES * COARSE * parts), _left_open(mechanism, truth)) / size
    if isinstance(engine, Pinocchio):
        summed = _shares(mechanism, truth, promise, _rounded_about_origin(mechanism, truth))
        motion, reactions = max(motion, summed["motion"]), max(reactions, summed["reactions"])
    softness = engine.softness(mechanism, dt / parts)
    if softness is not None:
        if softness == engine.softness(mechanism, dt):  # else it is tied to the step, and so to the promised order
            motion = max(motion, ROOM * _given_way(softness, mechanism, truth) / size)
        reactions = max(reactions, _rounded_gaps(softness, mechanism) / force)
    return {"motion": motion, "reactions": reactions}


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


def _resolved(mechanism: Mechanism, promise: Promise, truth: Trajectory, parts: int) -> bool:
    """Whether a textbook method of the promised order, or 4, shows it up to these parts: twice, for once may be luck.

    A spring that shrinks to nothing for less than a step pushes one way and then the other: what a method makes of that
    depends on where its stages fall, and its error on no power of the step.
    """
    own = Promise(max((each for each in TABLEAUS if each <= promise.order), default=1))
    spacing = SPAN * mechanism.time_scale / SAMPLES
    halved = (parts // 4, parts // 2, parts)
    try:
        runs = [in_numpy(mechanism, SAMPLES, spacing, int(own.order), n * COARSE, None, True) for n in halved]
    except ValueError:  # it went where curves can't touch
        return False
    found = [_apart(mechanism, run, truth, own) for run in runs]
    drifted = _drifted(mechanism, truth, SAMPLES * COARSE * parts) / _size(mechanism, truth, promise)
    least = {"motion": drifted, "reactions": _rounded_reactions(mechanism, own, truth, spacing / COARSE / 2)}
    return not any(
        _misses({name: (fine[name], _may_be(own, name, coarse[name], least[name])) for name in fine})
        for coarse, fine in pairwise(found)
    )


def _as_declared(
    engine: Engine, mechanism: Mechanism, promise: Promise, truth: Trajectory, run: Trajectory, parts: int
) -> dict[str, tuple[float, float]]:
    """How far a run is from the judge's with joints that give way as declared at its step, and how far it may be.

    A softness that is tied to the step falls with its power only where it is small: a light body's gear that turns a
    heavy one gives way by a radian, and a row without its term of velocities loses the energy of a short rod's end
    until the row turns little in its own time constant. The judge's own run shows that, at the same steps, and the
    engine may be ROOM times as far from it as its numbers are open: by the steps, which it takes in other coordinates,
    as far as double steps lead; and by the compliance, a share of an inverse inertia, which the judge takes at each
    pose and MuJoCo at the start: as far as their largest ratio leads.
    """
    spacing = SPAN * mechanism.time_scale / SAMPLES
    softness = engine.softness(mechanism, spacing / COARSE / parts)
    if softness is None or not softness.compliance:
        return {}
    order, gives = int(promise.step("angle")), giving_way(mechanism, softness)

    def judged_as(compliance: float, finer: float = 1.0) -> Trajectory:
        soft = replace(softness, compliance=compliance * softness.compliance)
        every = max(1, int(finer * parts))  # of SAMPLES x COARSE samples, so that fast rows are met
        return in_numpy(mechanism, SAMPLES * COARSE, spacing / COARSE, order, every, soft, least=0.0)

    try:
        right = judged_as(1.0)
        products = [(rows / mechanism.inertias.reshape(-1)) @ rows.T for rows in mechanism.rows(right.pose)]
        own = np.array([own_inertia(each, gives, 0.0)[gives] for each in products])
        others = judged_as(1.0, 0.5), judged_as(float((own.max(axis=0) / own.min(axis=0)).max()))
    except ValueError:  # curves can't touch where it goes
        return {}
    right, *others = (
        replace(each, **{name: getattr(each, name)[::COARSE] for name in ("t", "pose", "twist", "reaction")})
        for each in (right, *others)
    )
    found = [_apart(mechanism, each, right, promise) for each in others]
    least = _least(engine, mechanism, promise, truth, parts)
    return {
        name: (error, max(LEAST[name], least[name], ROOM * max(each[name] for each in found)))
        for name, error in _apart(mechanism, run, right, promise).items()
    }


def _left_by_sweeps(engine: Engine, mechanism: Mechanism, truth: Trajectory, dt: float) -> float:
    """Which part r of the slowest mode a step's sweeps leave, where their number is given: 0 for any other engine.

    Impulses then follow a motion only over 1 / (1 - r) steps, and a share of a gap above (1 - r) / r that is closed in
    one makes them grow (`engines.pymunk.contraction`): as shipped, pymunk closes 99.8 % in a second, whatever the
    mechanism's own time. Raises NotAsked where that is so at this step.
    """
    if not isinstance(engine, Pymunk) or not isinstance(engine.iterations, int):
        return 0.0
    left = max(contraction_at(mechanism, pose) for pose in truth.pose) ** engine.iterations
    if isinstance(engine.error_bias, float) and (1 - engine.error_bias**dt) * left > 1 - left:
        raise NotAsked("its sweeps leave more of an impulse than it may close of a gap at these steps")
    return left


def left_by_newton(engine: Engine, mechanism: Mechanism, truth: Trajectory, dt: float) -> Constrained:
    """What Newton's method of MuJoCo or Exudyn may leave in motions (bodies, 3) and reactions (rows,); 0 of any other.

    Exudyn's ends where one norm of what is left of forces [N], torques [N m] and what is held [m or rad; of index 2 as
    rates] is below `relative` times what it begins with, which is about the largest force, and `absolute`, in the
    engine's own units. A light body then accelerates by that over its mass, for the whole motion; and of a gap that is
    left in a step the next one makes an acceleration 1 / (beta dt^2) times as large, beta = 1/4 or above, of a rate 2 /
    dt.
    """
    own = engine.within(mechanism)
    if not isinstance(own, Exudyn):
        still = 0 * mechanism.pose
        moved = left_by_its_solver(own, mechanism, dt, truth.t[-1]) if isinstance(own, MuJoCo) else still
        return Constrained(moved, np.zeros(mechanism.row_count))
    length, mass, seconds = 1.0, 1.0, 1.0
    if own.own_units:
        length, seconds = mechanism.length_scale, mechanism.time_scale
        mass = max(body.mass for body in mechanism.bodies)
    newton, largest = mass * length / seconds**2, _force_size(mechanism, truth)
    left = own.relative * largest * max(1.0, mechanism.length_scale / length) / newton + own.absolute
    rows, lasts = mechanism.rows(mechanism.pose), truth.t[-1]
    back, light = response(rows, mechanism.inertias), 1 / mechanism.inertias.reshape(-1)
    force = np.tile([left * newton, left * newton, left * newton * length], len(mechanism.bodies))
    gap = left * np.where(mechanism.turning, 1.0, length)
    pushed = np.abs((np.eye(len(light)) - back.motion @ rows) * light) @ force * lasts**2 / 2
    rates = own.integrator == "TrapezoidalIndex2"
    held = np.abs(back.motion) @ gap * (lasts / seconds if rates else 1.0)
    pulled = np.abs(back.force) @ gap * (2 / dt / seconds if rates else 4 / dt**2)
    return Constrained((pushed + held).reshape(-1, 3), pulled)


def _drifted(mechanism: Mechanism, truth: Trajectory, steps: int) -> float:
    """How far [m] so many steps may carry anything by their rounding, which joints close what it opens.

    A step writes each number of a pose twice, as its sum and after joints are closed, and rounds it by half a unit each
    time: e = eps |q|, and eps |v| t of a velocity. Where motions hardly change so do roundings, and they add up as
    steps do. Of e a step leaves P e, P = 1 - H with H = M^-1 J^T (J M^-1 J^T)^-1 J, which the next ones keep; rounding
    of the last gap leaves H e. So a rounded place turns a body by it over its arm, far more than an angle is rounded.
    """
    turn = np.array([1.0, 1.0, mechanism.length_scale])
    least = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])  # arms, and the cosine of an angle
    worst = 0.0
    for pose, twist in zip(truth.pose, truth.twist, strict=True):
        numbers = np.maximum(np.abs(pose), least) + np.abs(twist) * SPAN * mechanism.time_scale
        rows = mechanism.rows(pose)
        held = response(rows, mechanism.inertias).motion @ rows
        carried = (steps * np.abs(np.eye(len(held)) - held) + np.abs(held)) @ numbers.reshape(-1)
        worst = max(worst, float((carried.reshape(-1, 3) * turn).max()))
    return np.finfo(float).eps * worst


def _left_open(mechanism: Mechanism, truth: Trajectory) -> float:
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


def _gives_way(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether joints give way visibly, and at half the step nearly as much."""
    coarse, fine = (engine.softness(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    ways = [soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine)]
    return ways[1] > HARD and 2 * ways[1] > ways[0]
