"""A short motion and its reactions against the judge, at two steps or more, with the order that the engine promises.

The judge moves one mechanism at a time: no two cases are of one shape.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np

from engines import Engine, Promise, Unpromised
from engines.lagrange import HELD, TRUTH
from engines.pymunk import Pymunk
from engines.pymunk.contraction import contraction_at
from engines.remembered import by_identity
from reference.joints import Roll
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.gate.judge import TABLEAUS, giving_way, in_numpy, own_inertia
from reports.search.law import (
    ESTIMATED,
    Fault,
    NotAsked,
    difference,
    force_difference,
    turned_in_a_step,
)
from reports.search.motion_bounds import (
    COARSE,
    LEAST,
    ROOM,
    SAMPLES,
    SPAN,
    drifted,
    force_size,
    least_of,
    left_by_newton,
    left_open,
    rounded_reactions,
    shares,
    size_of,
)

# An order shows where steps are short against all that happens: a rod that turns fast, impulses that settle in many
# steps, a gap that is closed in a time of its own. So they are halved, up to this many parts, until it shows for
# poses and for reactions; an error that was small by chance does not count against the next. What never falls is a
# fault, as rounding that grows with shorter steps excuses no more than it does at the first. A step at which the
# motion is lost, as anybody sees, is too long, if it is right at shorter ones: kept impulses of rows that turn within
# it grow, say. A method that tells its own error has to tell that, too.
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
    coarse = _run(engine, mechanism, dt, COARSE)
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
        finer = _run(engine, mechanism, dt / (2 * parts), 2 * parts * COARSE)
        if not out and (coarse.warnings or finer.warnings):
            raise NotAsked("it says itself that something is wrong")
        parts *= 2
        if finer.warnings:
            warned, silent = True, 0
            continue
        silent += 1
        longest = max(longest, silent)
        run, coarser = finer, _apart(mechanism, run, truth, promise)
        least, apart = least_of(engine, mechanism, promise, truth, parts), _apart(mechanism, run, truth, promise)
        if apart["motion"] * size_of(mechanism, truth, promise) > OFF * mechanism.length_scale:
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
        newton = shares(mechanism, truth, promise, left_by_newton(engine, mechanism, truth, dt / parts))
        if all(error <= max(bound, newton[name]) for name, (error, bound) in out.items()):
            raise NotAsked("what is missed is within the tolerance of Newton's method that it declares")
        out |= _as_declared(engine, mechanism, promise, truth, run, parts)
        if _misses(out) and not _resolved(mechanism, promise, truth, max(4, int(parts * (1 - left)))):
            raise NotAsked("something passes within a step: a textbook method shows no order at these steps either")
    if run.estimate is not None:
        size = np.array([1.0, 1.0, mechanism.length_scale])
        both = max(float(np.abs(each * size).max()) for each in (run.estimate, truth.estimate) if each is not None)
        # The judge may miss as much as it says, too, and what it leaves open.
        told = (both + left_open(mechanism, truth)) / size_of(mechanism, truth, promise)
        missed = _apart(mechanism, run, truth, promise)["motion"]
        out["estimate"] = (missed, min(ESTIMATED * told + LEAST["motion"], LOST))
    return out


@by_identity(ASKED)
def judged(mechanism: Mechanism) -> Trajectory:
    """What the judge says of a mechanism, which many engines are asked about."""
    return TRUTH.build(mechanism, SPAN * mechanism.time_scale / SAMPLES)(SAMPLES, 1)


def _run(engine: Engine, mechanism: Mechanism, dt: float, every: int) -> Trajectory:
    run = engine.build(mechanism, dt)(SAMPLES, every)
    if run.estimate is not None and not run.warnings and not np.isfinite(run.pose).all():
        raise Fault(f"at a step of {dt:.3g} s it lost the motion, though it tells its own error")
    return run


def _apart(mechanism: Mechanism, run: Trajectory, truth: Trajectory, promise: Promise) -> dict[str, float]:
    largest = np.array([[size_of(mechanism, truth, promise), 0.0, 0.0]])
    moved = [
        difference(mechanism, own - mechanism.pose, right - mechanism.pose, (largest,))
        for own, right in zip(run.pose[1:], truth.pose[1:], strict=True)
    ]
    most = force_size(mechanism, truth)
    pulled = [
        force_difference(mechanism, own, right, (most,))
        for own, right in zip(run.reaction[1:], truth.reaction[1:], strict=True)
    ]
    return {"motion": max(moved), "reactions": max(pulled)}


def _may_be(promise: Promise, name: str, coarser: float, least: float) -> float:
    order = promise.of("angle" if name == "motion" else "reaction")
    return min(max(ROOM * coarser * 0.5 ** min(order, 20.0), LEAST[name], least), LOST)


def _misses(found: dict[str, tuple[float, float]]) -> bool:
    return any(not error <= bound for error, bound in found.values())


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
    rounded = drifted(mechanism, truth, SAMPLES * COARSE * parts) / size_of(mechanism, truth, promise)
    least = {"motion": rounded, "reactions": rounded_reactions(mechanism, own, truth, spacing / COARSE / 2)}
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
    least = least_of(engine, mechanism, promise, truth, parts)
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


def _gives_way(engine: Engine, mechanism: Mechanism, dt: float) -> bool:
    """Whether joints give way visibly, and at half the step nearly as much."""
    coarse, fine = (engine.softness(mechanism, step) for step in (dt, dt / 2))
    if coarse is None or fine is None:
        return False
    ways = [soft.compliance / soft.stiffness / mechanism.time_scale**2 for soft in (coarse, fine)]
    return ways[1] > HARD and 2 * ways[1] > ways[0]
