"""Checks of a run: start, instants, CPU time, repeatability, and comparison with the exact motion."""

from __future__ import annotations

import copy
import math
import os
import time
from typing import Any

import numpy as np

from engines import ConvergenceOrder, NotDeclared, Unsupported
from engines.conformance.check import (
    CHECK_SAMPLES,
    CHECK_STEP,
    Array,
    CheckedEngine,
    ConformanceCheck,
    Fails,
    NotApplicable,
    finite,
    projection,
    require,
    require_a_sentence,
    stepped,
)
from engines.conformance.worlds import MOVING, SPINNING, WORLDS, World
from engines.trajectory_check import flaw_of_times
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Pin
from reference.mechanism import Body, Mechanism

# Relative rounding of the start by the conversion to the engine's coordinates and back.
START_ROUNDING = 1e-12
CLOCK_RESOLUTION = 1e-4  # Resolution of an engine's clock of CPU time [s].
COARSE_SAMPLING = (2, 3)  # Number of samples, and of steps between samples.
# Relative difference by rounding between runs with equal steps. Extrapolation multiplies rounding by up to 100.
SAMPLING_TOLERANCE = 1e-9
# Relative difference of reactions, since an iterative solver has another initial guess and single precision rounds
# changes of velocities. A reaction that is divided by a wrong time differs by two thirds.
REACTION_TOLERANCE = 1e-3


def _largest(values: Array) -> float:
    return float(np.max(np.abs(values), initial=0.0))


def samples_at_the_right_times(subject: CheckedEngine, world: World) -> None:
    """The time of sample k is k * every * dt, beginning with t = 0."""
    for samples, every in ((CHECK_SAMPLES, 1), COARSE_SAMPLING):
        run = subject.run(world.mechanism, CHECK_STEP, samples, every)
        if flaw := flaw_of_times(run, CHECK_STEP, samples, every):
            raise Fails(*flaw, "`every` is ignored, or time begins after the first step")


def tells_the_cpu_time_of_stepping(subject: CheckedEngine, world: World) -> None:
    """`stepping` is CPU time from 0 to the CPU time of the whole run.

    The CPU time of a child process is unknown, but it is at most the elapsed time times the number of processors.
    """
    run = subject.build(world.mechanism)
    in_child = subject.engine.steps_in_child
    clock, processors = (time.monotonic, os.cpu_count() or 1) if in_child else (time.process_time, 1)
    begin = clock()
    stepping = stepped(run, CHECK_SAMPLES, 1).stepping
    used = (clock() - begin) * processors
    require(
        math.isfinite(stepping) and 0 <= stepping <= used + CLOCK_RESOLUTION,
        f"stepping = {stepping!r} s",
        f"from 0 to the {used:.3g} s of CPU time that the whole call took",
        "it is elapsed time, in milliseconds, or not measured",
    )


def first_pose_is_the_start(subject: CheckedEngine, world: World) -> None:
    """The poses of the first sample are those of the mechanism at t = 0."""
    _starts(subject, world, "pose")


def first_twist_is_the_start(subject: CheckedEngine, world: World) -> None:
    """The twists of the first sample are those of the mechanism at t = 0."""
    _starts(subject, world, "twist")


def _starts(subject: CheckedEngine, world: World, name: str) -> None:
    first, start = getattr(subject.run(world.mechanism), name)[0], getattr(world.mechanism, name)
    error = _largest(first - start)
    body, coordinate = np.unravel_index(int(np.argmax(np.abs(first - start))), start.shape)
    require(
        error <= START_ROUNDING * (1 + _largest(start)),
        f"a {name} that is {error:.3g} off in {('x', 'y', 'the angle')[coordinate]} of body {body}",
        f"the start to {START_ROUNDING:g} of its size",
        "the first sample is taken after the first step, or the origin of the engine's frame is not the centre of mass",
    )


def gives_the_same_bits(subject: CheckedEngine, world: World) -> None:
    """The runs of two models are equal to the last bit, if both are built before either is run."""
    runs = [subject.build(world.mechanism), subject.build(world.mechanism)]
    first, second = (stepped(run, CHECK_SAMPLES, 1) for run in runs)
    for name in ("t", "pose", "twist", "reaction"):
        values, others = getattr(first, name), getattr(second, name)
        require(
            np.array_equal(values, others, equal_nan=True),
            f"a {name} that differs by {_largest(np.nan_to_num(values - others)):.3g}",
            "the same bits",
            "two models share state, or a solver begins with random numbers or with the result of an earlier run",
        )


def leaves_the_mechanism_alone(subject: CheckedEngine, world: World) -> None:
    """Building and running do not change the mechanism."""
    mechanism = copy.deepcopy(world.mechanism)

    def contents() -> dict[str, Any]:
        names = ("pose", "twist", "inertias", "rate")
        return {"description": repr(mechanism)} | {name: getattr(mechanism, name).copy() for name in names}

    original = contents()
    stepped(subject.engine.build(mechanism, CHECK_STEP), CHECK_SAMPLES, 1)
    for name, value in contents().items():
        same = np.array_equal(original[name], value)
        require(same, f"another {name}", "an unchanged mechanism", "an array of it is changed without a copy")


def sampling_changes_nothing(subject: CheckedEngine, world: World) -> None:
    """A run that records every third state has the same states there, up to rounding, as a run that records all."""
    samples, every = COARSE_SAMPLING
    dense, sparse = subject.run(world.mechanism), subject.run(world.mechanism, CHECK_STEP, samples, every)
    # A run claims no accuracy after `unresolved_at`. The two runs may have different values of `unresolved_at`.
    unresolved = min(math.inf if run.unresolved_at is None else run.unresolved_at for run in (dense, sparse))
    claimed = sparse.t < unresolved
    for name in ("pose", "twist", "reaction"):
        tolerance = REACTION_TOLERANCE if name == "reaction" else SAMPLING_TOLERANCE
        all_values, values = getattr(dense, name), getattr(sparse, name)[claimed]
        expected = all_values[: samples * every + 1 : every][claimed]
        difference = _largest(np.nan_to_num(values) - np.nan_to_num(expected))
        within = difference <= tolerance * (1 + _largest(np.nan_to_num(all_values)))
        require(
            within and np.array_equal(np.isnan(values), np.isnan(expected)),
            f"a {name} that differs by {difference:.3g}",
            f"at most {tolerance:g} of its size",
            "`every` changes the step, or a change of velocity is divided by the wrong time, "
            "or recording a state changes the state of the engine",
        )


def does_not_wrap_angles(subject: CheckedEngine, world: World) -> None:
    """Angles are not wrapped; they continue beyond a whole turn and may start several turns from zero."""
    run = finite(subject.run(world.mechanism))
    error = _largest(run.pose[..., 2] - world.exact(run.t).pose[..., 2])  # a wrapped angle differs by 6.3 rad
    means = "angles are those of a sine and a cosine"
    require(error <= 1.0, f"an angle that is {error:.3g} rad off", "at most 1 rad", means)


SMALL_STEP = 1e-3  # Step [s]; over a few steps, motions of a few rad/s are parabolas to within a percent.
FIRST_STEPS = 3
# In steps. States of another instant have a delay of at least half a step. The parabola has an error of a hundredth of
# a step.
MAX_DELAY = 0.1
# Tolerance relative to the largest reaction. A wrong sign causes an error of 2, a first-order method less than 0.1.
REACTION_ERROR = 0.25


def poses_stand_at_their_instants(subject: CheckedEngine, world: World) -> None:
    """The first poses after the start belong to the times of their samples, not to times half a step away or more."""
    _at_their_instants(subject, world, "pose", "twist")


def twists_stand_at_their_instants(subject: CheckedEngine, world: World) -> None:
    """The first twists after the start belong to the times of their samples, not to times half a step away or more."""
    _at_their_instants(subject, world, "twist", "acceleration")


def _at_their_instants(subject: CheckedEngine, world: World, name: str, derivative: str) -> None:
    """Fails if a fit of the error by derivative * (delay + constant * t) gives a delay above MAX_DELAY.

    The error is projected on admissible motions, since other components of a first-order error may be half a step.
    """
    _declared_order(subject, world)
    run = finite(subject.run(world.mechanism, SMALL_STEP, FIRST_STEPS))
    exact = world.exact(run.t)
    errors, project = getattr(run, name) - getattr(exact, name), projection(world.mechanism)
    direction = project(getattr(exact, derivative)[0])
    delays = [np.vdot(project(error), direction) / np.vdot(direction, direction) / SMALL_STEP for error in errors[1:]]
    _, delay = np.polyfit(np.arange(1, FIRST_STEPS + 1), delays, 1)
    require(
        abs(delay) <= MAX_DELAY,
        f"a {name} that is {abs(delay):.2f} steps {'ahead of' if delay > 0 else 'behind'} its instant",
        f"at most {MAX_DELAY:g} steps",
        "the velocities of a leapfrog method, half a step later, or of the step before are recorded with the poses",
    )


def poses_have_their_order(subject: CheckedEngine, world: World) -> None:
    """The errors of poses fall with the step at least at the declared order, down to rounding."""
    _has_its_order(subject, world, "pose", "angle")


def twists_have_their_order(subject: CheckedEngine, world: World) -> None:
    """The errors of twists fall with the step at least at the declared order, down to rounding."""
    _has_its_order(subject, world, "twist", "rate")


def _declared_order(subject: CheckedEngine, world: World) -> ConvergenceOrder:
    subject.run(world.mechanism)  # an unsupported mechanism has no declared order
    if isinstance(order := subject.engine.order(world.mechanism), NotDeclared):
        raise NotApplicable(f"no order is declared: {order.reason}")
    return order


STEP_DIVISORS = (1, 3, 9)
ORDER_SPACING, ORDER_SAMPLES = 0.02, 3  # Time between samples [s], and number of samples.
# Factor on the predicted error from larger steps, for the next power of the step and for sampling.
ORDER_MARGIN = 2.5
# Relative error by rounding, or by a drive with an inertia of 10^8 times the mechanism's.
SMALLEST_ERROR = 1e-8
# Largest error in roundings of an engine of lower precision. There is about one rounding per step, with either sign, so
# they partly cancel.
LOW_PRECISION_STEPS = 10
# Largest gap divided by acceleration [s^2] of a rigid joint. At 10 m/s^2 the gap is 1 nm, which is below
# SMALLEST_ERROR.
RIGID = 1e-10


def _has_its_order(subject: CheckedEngine, world: World, name: str, quantity: str) -> None:
    order = _declared_order(subject, world).of(quantity)
    if _has_constant_gap(subject, world):
        raise NotApplicable("by the declared regularisation, joints have a gap that does not depend on the step")
    errors = []
    for every in STEP_DIVISORS:
        run = finite(subject.run(world.mechanism, ORDER_SPACING / every, ORDER_SAMPLES, every))
        errors.append(_largest(getattr(run, name) - getattr(world.exact(run.t), name)))
    steps = [f"{ORDER_SPACING / every:.2g}" for every in STEP_DIVISORS]
    ratios = [(every / STEP_DIVISORS[-1]) ** order for every in STEP_DIVISORS[:-1]]
    expected = max(error * ratio for error, ratio in zip(errors[:-1], ratios, strict=True))
    smallest = SMALLEST_ERROR + LOW_PRECISION_STEPS * subject.engine.precision
    bound = max(ORDER_MARGIN * expected, smallest * (1 + _largest(world.mechanism.twist)))
    require(
        errors[-1] <= bound,
        f"errors of {', '.join(f'{error:.2g}' for error in errors)} at steps of {', '.join(steps)} s",
        f"at most {bound:.2g} at the last, by order {order:g}",
        f"the {name} belongs to another instant, or the engine is not of this order",
    )


def _has_constant_gap(subject: CheckedEngine, world: World) -> bool:
    """Whether the declared gap of a joint per prevented acceleration is large and hardly falls with the step."""
    laws = [subject.engine.regularisation(world.mechanism, ORDER_SPACING / every) for every in STEP_DIVISORS[-2:]]
    coarse, fine = (0.0 if law is None else law.compliance / law.stiffness for law in laws)
    return fine > RIGID and fine * (STEP_DIVISORS[-1] / STEP_DIVISORS[-2]) > ORDER_MARGIN * coarse


def reactions_have_sign_and_size(subject: CheckedEngine, world: World) -> None:
    """Reactions are forces on the second body, with the sign and size of the exact reactions."""
    _declared_order(subject, world)  # a method that does not converge has another motion and other forces
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t).reaction
    turning = world.mechanism.is_angular
    known = ~np.isnan(run.reaction).all(axis=0)
    if not known.any():
        raise NotApplicable("the engine provides no reactions here")
    for row in np.flatnonzero(known):
        largest = np.max(np.abs(exact[:, turning == turning[row]]))
        # The median is used, since a new contact may need some steps until it carries the weight.
        error = np.nanmedian((run.reaction[:, row] - exact[:, row]) / largest)
        require(
            abs(error) <= REACTION_ERROR,
            f"{np.nanmedian(run.reaction[:, row]):.4g} {'N m' if turning[row] else 'N'} in row "
            f"{world.mechanism.row_names[row]!r}",
            f"about {np.median(exact[:, row]):.4g}",
            "it is the force on the first body, or an impulse is divided by the wrong step",
        )


# Each force element acts alone on a pinned plate, and changes the plate's angular velocity much during the samples.
_PLATE = Body("plate", 2.0, 0.1, (0.0, 0.0, 0.3), (0.0, 0.0, 2.0))
_HINGE = Pin("hinge", None, "plate", (0.0, 0.0), (0.0, 0.0))
_FAR = ((1.0, -0.5), (0.2, 0.1))
FORCE_EXAMPLES: tuple[ForceElement, ...] = (
    Torque("torque", None, "plate", 3.0),
    Force("force", "plate", (0.2, 0.1), (10.0, -5.0)),
    Spring("spring", None, "plate", *_FAR, 20.0, 0.2),
    Damper("damper", None, "plate", *_FAR, 10.0),
    TorsionSpring("torsion spring", None, "plate", 5.0, -1.0),
    TorsionDamper("torsion damper", None, "plate", 0.5),
)
FORCE_MARGIN = 0.2  # relative error of the change; a first-order method has a far smaller error


def feels_forces_or_refuses_them(subject: CheckedEngine) -> None:
    """Each kind of force element changes the motion by its law, or is refused by Unsupported with one sentence."""
    refused: list[str] = []
    for force in FORCE_EXAMPLES:
        mechanism = Mechanism((_PLATE,), (_HINGE,), (0.0, 0.0), (force,))
        try:
            run = finite(subject.run(mechanism))
        except Unsupported as reason:
            require_a_sentence(str(reason), f"a {type(force).__name__}")
            refused.append(str(reason))
            continue
        found = float(run.twist[-1, 0, 2]) - _PLATE.twist[2]
        expected = _change_of_rate(mechanism, CHECK_STEP * CHECK_SAMPLES)
        require(
            abs(found - expected) < FORCE_MARGIN * abs(expected),
            f"a rate that changes by {found:.3g} rad/s under a {type(force).__name__}",
            f"{expected:.3g} rad/s, or Unsupported",
            "the adapter ignores the mechanism's forces, or one has the wrong sign or unit",
        )
    if len(refused) == len(FORCE_EXAMPLES):
        raise Unsupported(refused[0])


def _change_of_rate(mechanism: Mechanism, until: float) -> float:
    from scipy.integrate import solve_ivp

    pose, twist = np.zeros((1, 3)), np.zeros((1, 3))

    def derivative(_: float, state: Array) -> list[float]:
        pose[0, 2], twist[0, 2] = state
        return [state[1], mechanism.applied.on(pose, twist)[0, 2] / _PLATE.inertia]

    states = solve_ivp(derivative, (0.0, until), [_PLATE.pose[2], _PLATE.twist[2]], rtol=1e-6).y
    return float(states[1, -1] - _PLATE.twist[2])


# Mechanisms with a degree of freedom, and the mechanisms among them that gravity accelerates.
WITH_FREEDOM = tuple(world for world in MOVING if world.name != "driven crank")
UNDER_GRAVITY = tuple(world for world in WITH_FREEDOM if world.name != "sleigh")
CHECKS = tuple(
    ConformanceCheck(function, worlds)
    for worlds, functions in (
        (MOVING, (samples_at_the_right_times, tells_the_cpu_time_of_stepping, gives_the_same_bits)),
        (MOVING, (leaves_the_mechanism_alone, sampling_changes_nothing)),
        (MOVING, (poses_have_their_order, twists_have_their_order)),
        ((*WORLDS, SPINNING), (first_pose_is_the_start, first_twist_is_the_start)),
        ((SPINNING,), (does_not_wrap_angles,)),
        (WORLDS, (reactions_have_sign_and_size,)),
        (WITH_FREEDOM, (poses_stand_at_their_instants,)),
        (UNDER_GRAVITY, (twists_stand_at_their_instants,)),
        ((), (feels_forces_or_refuses_them,)),
    )
    for function in functions
)
