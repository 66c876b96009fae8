"""Checks of a run: its start, shapes, instants and cost, that the same run gives the same bits, and the exact motion.

Against the exact motion: which instant a state belongs to, its order, the size of reactions, and whether forces act. An
engine that does not look at them moves as if there were none, without a warning.
"""

from __future__ import annotations

import copy
import math
import os
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from engines import ConvergenceOrder, NotDeclared, Unsupported
from engines.conformance.check import (
    SAMPLES,
    STEP,
    Array,
    Check,
    Fails,
    NotAsked,
    Subject,
    finite,
    require,
    require_a_sentence,
    stepped,
)
from engines.conformance.worlds import MOVING, SPINNING, WORLDS, World
from engines.trajectory_check import flaw_of_times
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin
from reference.mechanism import Body, Mechanism

# Of a coordinate's size: what placing a body, and taking its place back from the engine's own coordinates, may take.
PLACING = 1e-12
GRAIN = 1e-4  # s, of another clock of CPU time than ours
SELDOM = (2, 3)  # samples, and steps between them
# The same steps are taken, so rounding is all that may differ; extrapolation weighs it with up to a hundred.
SAMPLED = 1e-9
# A solver that ends by a tolerance may read the same state from another guess, and a change of velocity over a step is
# what single precision rounds; divided by three times that step it is wrong by two thirds.
READ = 1e-3


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def samples_at_the_right_times(subject: Subject, world: World) -> None:
    """Sample k stands at k times `every` times dt, beginning with t = 0."""
    for samples, every in ((SAMPLES, 1), SELDOM):
        run = subject.run(world.mechanism, STEP, samples, every)
        if flaw := flaw_of_times(run, STEP, samples, every):
            raise Fails(*flaw, "`every` is left out, or time is counted from the first step on")


def tells_the_cpu_time_of_stepping(subject: Subject, world: World) -> None:
    """`stepping` is CPU time: not below zero, and not more than was used during the run.

    The CPU time of a child process cannot be read here. It is below the time that passed, times the processors.
    """
    run = subject.build(world.mechanism)
    if subject.engine.steps_in_child:
        clock, processors = time.monotonic, os.cpu_count() or 1
    else:
        clock, processors = time.process_time, 1
    begin = clock()
    told = stepped(run, SAMPLES, 1)
    used = (clock() - begin) * processors
    require(
        math.isfinite(told.stepping) and 0 <= told.stepping <= used + GRAIN,
        f"stepping = {told.stepping!r} s",
        f"from 0 to the {used:.3g} s of CPU time that the whole call took",
        "the wall's clock is read, or milliseconds, or nothing",
    )


def first_pose_is_the_start(subject: Subject, world: World) -> None:
    """The first sample's poses are the mechanism's start."""
    _starts(subject, world, "pose")


def first_twist_is_the_start(subject: Subject, world: World) -> None:
    """The first sample's twists are the mechanism's start."""
    _starts(subject, world, "twist")


def _starts(subject: Subject, world: World, what: str) -> None:
    found, start = getattr(subject.run(world.mechanism), what)[0], getattr(world.mechanism, what)
    off = _largest(found - start)
    body, place = np.unravel_index(int(np.argmax(np.abs(found - start))), start.shape)
    require(
        off <= PLACING * (1 + _largest(start)),
        f"a {what} that is {off:.3g} off in {('x', 'y', 'the angle')[place]} of body {body}",
        f"the start to {PLACING:g} of its size",
        "the first sample is taken after the first step, or the engine's own frame is not the centre of mass",
    )


def gives_the_same_bits(subject: Subject, world: World) -> None:
    """Two builds, both made before either is run, give the same bits."""
    runs = [subject.build(world.mechanism), subject.build(world.mechanism)]
    first, second = (stepped(run, SAMPLES, 1) for run in runs)
    for name in ("t", "pose", "twist", "reaction"):
        one, other = getattr(first, name), getattr(second, name)
        require(
            np.array_equal(one, other, equal_nan=True),
            f"a {name} that differs by {_largest(np.nan_to_num(one - other)):.3g}",
            "the same bits",
            "two models share something, or a solver begins with random numbers or with what was left before",
        )


def leaves_the_mechanism_alone(subject: Subject, world: World) -> None:
    """Building and running change nothing in the mechanism that was given."""
    given = copy.deepcopy(world.mechanism)

    def numbers() -> dict[str, Any]:
        arrays = {name: getattr(given, name).copy() for name in ("pose", "twist", "inertias", "rate")}
        return {"description": repr(given), **arrays}

    before = numbers()
    stepped(subject.engine.build(given, STEP), SAMPLES, 1)
    for name, now in numbers().items():
        same = np.array_equal(before[name], now)
        require(same, f"another {name}", "the mechanism as it was", "an array of it is written into without a copy")


def sampling_changes_nothing(subject: Subject, world: World) -> None:
    """Every third state of a run is that of a run sampled a third as often, to rounding."""
    samples, every = SELDOM
    often, seldom = subject.run(world.mechanism), subject.run(world.mechanism, STEP, samples, every)
    # From there on a run claims nothing, and at which of its samples it notices depends on where they are.
    unresolved = min(math.inf if run.unresolved_at is None else run.unresolved_at for run in (often, seldom))
    claimed = seldom.t < unresolved
    for name, allowed in (("pose", SAMPLED), ("twist", SAMPLED), ("reaction", READ)):
        whole, other = getattr(often, name), getattr(seldom, name)[claimed]
        same = whole[: samples * every + 1 : every][claimed]
        off = _largest(np.nan_to_num(other) - np.nan_to_num(same))
        within = off <= allowed * (1 + _largest(np.nan_to_num(whole)))
        require(
            within and np.array_equal(np.isnan(other), np.isnan(same)),
            f"a {name} that differs by {off:.3g}",
            f"at most {allowed:g} of its size",
            "`every` changes the step, or a change of velocity is divided by another time than it took, "
            "or sampling disturbs what the engine goes on from",
        )


def does_not_wrap_angles(subject: Subject, world: World) -> None:
    """An angle goes on beyond a whole turn, and starts where the mechanism says though that is several turns."""
    run = finite(subject.run(world.mechanism))
    off = _largest(run.pose[..., 2] - world.exact(run.t).pose[..., 2])
    # A turn is 6.3 rad, and a step 0.6 rad of it.
    require(
        off <= 1.0, f"an angle that is {off:.3g} rad off", "at most 1 rad", "angles are those of a sine and a cosine"
    )


SHORT = 1e-3  # s: within three of these a motion of some radians a second is a parabola to a percent
EARLY = 3  # steps
# Of a step. A state of another instant is half a step off at least; a parabola leaves a hundredth of one.
OFF = 0.1
SIZE = 0.25  # of the largest reaction: a flipped sign is wrong by 2, a method of first order by less than 0.1


def poses_stand_at_their_instants(subject: Subject, world: World) -> None:
    """The first poses after the start lie on the exact motion at their own instants, not half a step or a step off."""
    _at_their_instants(subject, world, "pose", "twist")


def twists_stand_at_their_instants(subject: Subject, world: World) -> None:
    """The first twists after the start belong to their own instants, not half a step later or the step before."""
    _at_their_instants(subject, world, "twist", "acceleration")


def _at_their_instants(subject: Subject, world: World, what: str, derivative: str) -> None:
    """The error is the derivative times (delay + share times t); Fails unless the delay is below OFF.

    Only what the joints leave free is looked at. There a method of any order, even the first, has taken n kicks and n
    drifts after n steps. Across the joints a method of the first order may be off by as much as half a step.
    """
    _promise(subject, world)
    run = finite(subject.run(world.mechanism, SHORT, EARLY))
    exact = world.exact(run.t)
    error, free = getattr(run, what) - getattr(exact, what), _free(world.mechanism)
    moving = free(getattr(exact, derivative)[0])
    along = [np.vdot(free(each), moving) / np.vdot(moving, moving) / SHORT for each in error[1:]]
    _, delay = np.polyfit(np.arange(1, EARLY + 1), along, 1)
    require(
        abs(delay) <= OFF,
        f"a {what} that is {abs(delay):.2f} steps {'ahead of' if delay > 0 else 'behind'} its instant",
        f"at most {OFF:g} steps",
        "a leapfrog's velocities, half a step later, or those of the step before stand with the poses",
    )


def _free(mechanism: Mechanism) -> Callable[[Array], Array]:
    """What takes from velocities (bodies, 3) the part that does work against no joint, in the metric of the masses."""
    root = np.sqrt(mechanism.inertias.reshape(-1))
    _, sizes, directions = np.linalg.svd(mechanism.rows(mechanism.pose) / root)
    free = directions[np.sum(sizes > 1e-9 * sizes[0]) :]
    return lambda velocities: free.T @ (free @ (root * velocities.reshape(-1)))


def poses_have_their_order(subject: Subject, world: World) -> None:
    """Errors of poses fall at least as fast with the step as `order` promises, until rounding is left."""
    _has_its_order(subject, world, "pose", "angle")


def twists_have_their_order(subject: Subject, world: World) -> None:
    """Errors of twists fall at least as fast with the step as `order` promises, until rounding is left."""
    _has_its_order(subject, world, "twist", "rate")


def _promise(subject: Subject, world: World) -> ConvergenceOrder:
    """The engine's promise; raises NotAsked where there is none."""
    subject.run(world.mechanism)  # where it builds nothing it need not promise anything
    if isinstance(promise := subject.engine.order(world.mechanism), NotDeclared):
        raise NotAsked(f"no order is promised: {promise.reason}")
    return promise


REFINED = (1, 3, 9)  # times as many steps as of the others: between them an order shows as a factor of 3^order
SPAN, WHOLE = 0.06, 3  # s, and samples in it
# Room above what the promised order lets expect of the coarser steps: the next power of the step, and samples.
ROOM = 2.5
# Relative to the motion, an error of this size is rounding, or that of a drive whose rate is held by an inertia of a
# hundred million times the mechanism's.
LEAST = 1e-8
# s^2: with it, an acceleration of 10 m/s^2 opens a joint by a nanometre, which is less than LEAST.
HARD = 1e-10


def _has_its_order(subject: Subject, world: World, name: str, quantity: str) -> None:
    order = _promise(subject, world).of(quantity)
    if _gives_way_for_good(subject, world):
        raise NotAsked("joints give way as the engine says, by the same at every step")
    errors = []
    for every in REFINED:
        run = finite(subject.run(world.mechanism, SPAN / WHOLE / every, WHOLE, every))
        errors.append(float(np.max(np.abs(getattr(run, name) - getattr(world.exact(run.t), name)))))
    steps = [f"{SPAN / WHOLE / every:.2g}" for every in REFINED]
    expected = max(error * (every / REFINED[-1]) ** order for error, every in zip(errors, REFINED[:-1], strict=False))
    bound = max(ROOM * expected, LEAST * (1 + float(np.max(np.abs(world.mechanism.twist)))))
    require(
        errors[-1] <= bound,
        f"errors of {', '.join(f'{error:.2g}' for error in errors)} at steps of {', '.join(steps)} s",
        f"at most {bound:.2g} at the last, by order {order:g}",
        f"the {name} is of another instant than the method's own, or the engine is not of this order",
    )


def _gives_way_for_good(subject: Subject, world: World) -> bool:
    """Whether joints give way visibly under a force, and at the smallest step nearly as much as at the one before.

    Compared is the way that a joint gives, over the acceleration that it should prevent [s^2].
    """
    softness = [subject.engine.regularisation(world.mechanism, SPAN / WHOLE / every) for every in REFINED[-2:]]
    coarse, fine = (0.0 if soft is None else soft.compliance / soft.stiffness for soft in softness)
    return fine > HARD and fine * (REFINED[-1] / REFINED[-2]) > ROOM * coarse


def reactions_have_sign_and_size(subject: Subject, world: World) -> None:
    """Reactions are forces on the second body: up where it hangs, and of the size of its weight and m a."""
    _promise(subject, world)  # a method without one holds another motion, with other forces
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t).reaction
    turning = world.mechanism.is_angular
    known = ~np.isnan(run.reaction).all(axis=0)
    if not known.any():
        raise NotAsked("the engine tells no reactions here")
    for row in np.flatnonzero(known):
        largest = np.max(np.abs(exact[:, turning == turning[row]]))
        # The median over the samples: a new contact may need some steps until it carries the weight.
        off = np.nanmedian((run.reaction[:, row] - exact[:, row]) / largest)
        require(
            abs(off) <= SIZE,
            f"{np.nanmedian(run.reaction[:, row]):.4g} {'N m' if turning[row] else 'N'} in row "
            f"{world.mechanism.row_names[row]!r}",
            f"about {np.median(exact[:, row]):.4g}",
            "it is the force on the first body, or an impulse is divided by another step",
        )


# Of a plate on a pin: each element alone, as strong as to change the rate much within the samples of a check.
_PLATE = Body("plate", 2.0, 0.1, (0.0, 0.0, 0.3), (0.0, 0.0, 2.0))
_HINGE = Pin("hinge", None, "plate", (0.0, 0.0), (0.0, 0.0))
_FAR = ((1.0, -0.5), (0.2, 0.1))
FORCES: tuple[ForceElement, ...] = (
    Torque("torque", None, "plate", 3.0),
    Force("force", "plate", (0.2, 0.1), (10.0, -5.0)),
    Spring("spring", None, "plate", *_FAR, 20.0, 0.2),
    Damper("damper", None, "plate", *_FAR, 10.0),
    TorsionSpring("torsion spring", None, "plate", 5.0, -1.0),
    TorsionDamper("torsion damper", None, "plate", 0.5),
)
FELT = 0.2  # of what a force does to the rate: far above what a method of first order misses at these steps


def feels_forces_or_refuses_them(subject: Subject) -> None:
    """Each kind of force changes the motion as it should, or is refused by Unsupported with one sentence."""
    refused: list[str] = []
    for force in FORCES:
        mechanism = Mechanism((_PLATE,), (_HINGE,), (0.0, 0.0), (force,))
        try:
            run = finite(subject.run(mechanism))
        except Unsupported as reason:
            require_a_sentence(str(reason), f"a {type(force).__name__}")
            refused.append(str(reason))
            continue
        found, expected = float(run.twist[-1, 0, 2]) - 2.0, _gained(mechanism, STEP * SAMPLES)
        require(
            abs(found - expected) < FELT * abs(expected),
            f"a rate that changes by {found:.3g} rad/s under a {type(force).__name__}",
            f"{expected:.3g} rad/s, or Unsupported",
            "the mechanism's forces are not looked at when it is built, or one has another sign or unit",
        )
    if len(refused) == len(FORCES):
        raise Unsupported(refused[0])


def _gained(mechanism: Mechanism, until: float) -> float:
    """The change of the plate's rate by then [rad/s], from its one equation of motion."""
    pose, twist = np.zeros((1, 3)), np.zeros((1, 3))

    def derivative(_: float, state: Array) -> list[float]:
        pose[0, 2], twist[0, 2] = state
        return [state[1], mechanism.applied.on(pose, twist)[0, 2] / _PLATE.inertia]

    states = solve_ivp(derivative, (0.0, until), [_PLATE.pose[2], _PLATE.twist[2]], rtol=1e-6).y
    return float(states[1, -1] - _PLATE.twist[2])


# Where the joints leave something free, and where gravity changes that.
FREE = tuple(world for world in MOVING if world.name != "driven crank")
PULLED = tuple(world for world in FREE if world.name != "sleigh")
CHECKS = (
    Check(samples_at_the_right_times, MOVING),
    Check(tells_the_cpu_time_of_stepping, MOVING),
    Check(first_pose_is_the_start, (*WORLDS, SPINNING)),
    Check(first_twist_is_the_start, (*WORLDS, SPINNING)),
    Check(gives_the_same_bits, MOVING),
    Check(leaves_the_mechanism_alone, MOVING),
    Check(sampling_changes_nothing, MOVING),
    Check(does_not_wrap_angles, (SPINNING,)),
    Check(reactions_have_sign_and_size, WORLDS),
    Check(poses_stand_at_their_instants, FREE),
    Check(twists_stand_at_their_instants, PULLED),
    Check(poses_have_their_order, MOVING),
    Check(twists_have_their_order, MOVING),
    Check(feels_forces_or_refuses_them),
)
