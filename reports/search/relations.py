"""Check that the motion of a mechanism does not depend on its description.

The mechanism is rotated, shifted, mirrored, renamed or written in other units. The case's number selects one change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Engine
from engines.conformance.same import Change, Isometry, joints_swapped, relabelled
from engines.remembered import by_identity
from reference.joints import Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.search.law import (
    CACHED_MECHANISMS,
    INSTANT_STEP,
    INSTANT_STEPS,
    NOISE_MARGIN,
    CheckSkipped,
    Errors,
    Fault,
    difference,
    iter_nudged,
    turned_at_start,
    turned_in_a_step,
)
from reports.search.parts import Recipe
from reports.search.recipe import build

Array = NDArray[np.float64]
State = tuple[Array, Array]  # pose and twist (bodies, 3) after the last step, in the mechanism's original description

# Methods that combine runs amplify rounding up to a hundred times. Very stiff constraints lose half of the digits.
DESCRIPTION_TOLERANCE = 1e-7
# Tolerance in units of the engine's precision. The tolerance is large, since a displacement is a small difference of
# positions.
LOW_PRECISION_ROUNDINGS = 1e4
POSITION_ROUNDING = 1e-6  # Displacements that are smaller, relative to the position, have large rounding errors.
MAX_NOISE = 0.1  # If the noise relative to the motion is larger, the check detects nothing.
ESTIMATE_MARGIN = 10.0  # An error above ESTIMATE_MARGIN times the error estimate contradicts the estimate.
TOO_LONG = CheckSkipped("something turns by more than a radian in a step, so rounding errors grow without a bound")

CHANGES: dict[str, Change] = {
    "turned": Isometry(turn=0.7),
    "shifted": Isometry(shift=(3.7, -2.9)),
    "mirrored": Isometry(mirrored=True),
    "renamed": relabelled,
    "swapped": joints_swapped,
}
# Powers of ten by which the units of length and mass change.
UNIT_CHANGES = {"in other lengths": (-3, 0), "in other masses": (0, 2)}
RELATIONS = (*CHANGES, *UNIT_CHANGES)


def relation_errors(engine: Engine, mechanism: Mechanism, recipe: Recipe, number: int) -> Errors | CheckSkipped:
    """The error of the motion in another description, and its tolerance, both relative to the motion."""
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.uses_contacts:
        return CheckSkipped("rounding decides whether two shapes touch")
    if turned_at_start(mechanism) > 1:
        return TOO_LONG
    name = RELATIONS[number % len(RELATIONS)]
    # The default settings of MuJoCo and pymunk contain the lengths 1 mm and 0.1 m.
    if name in UNIT_CHANGES and engine.variant == "default":
        return CheckSkipped("the default settings contain lengths")
    described = describe_otherwise(mechanism, recipe, name)
    if isinstance(described, CheckSkipped):
        return described
    changed, back = described
    comparison = _compare_runs(engine, mechanism, changed, back, engine.stricter(mechanism))
    return comparison if isinstance(comparison, CheckSkipped) else {name: comparison}


@by_identity(CACHED_MECHANISMS)  # All engines of a case share the description.
def describe_otherwise(
    mechanism: Mechanism, recipe: Recipe, name: str
) -> tuple[Mechanism, Callable[[Trajectory], State]] | CheckSkipped:
    """The mechanism in another description, and the function that transforms a run's last state back."""
    if name in UNIT_CHANGES:
        longer, heavier = UNIT_CHANGES[name]
        length_decade, mass_decade, time_decade = recipe.decades
        decades = length_decade + longer, mass_decade + heavier, time_decade
        other, length = build(replace(recipe, decades=decades)), 10.0**longer
        unit = np.array([length, length, 1.0])
        twist_error = difference(mechanism, other.twist / unit, mechanism.twist)
        if max(twist_error, abs(other.length_scale / (length * mechanism.length_scale) - 1)) > DESCRIPTION_TOLERANCE:
            return CheckSkipped("no joint has an arm, so the length scale is one metre in every unit")
        return other, lambda run: (run.pose[-1] / unit, run.twist[-1] / unit)
    try:
        changed, back = CHANGES[name](mechanism)
    except ValueError as reason:
        return CheckSkipped(str(reason))

    def last(run: Trajectory) -> State:
        pose, twist, _ = back(run)
        return pose[-1], twist[-1]

    return changed, last


def _compare_runs(
    engine: Engine,
    mechanism: Mechanism,
    changed: Mechanism,
    back: Callable[[Trajectory], State],
    stricter: Engine | None = None,
) -> tuple[float, float] | CheckSkipped:

    def run(described: Mechanism) -> Trajectory:
        return engine.build(described, INSTANT_STEP * described.time_scale)(1, INSTANT_STEPS)

    first, second = run(mechanism), run(changed)
    if any(
        trajectory.unresolved_at is not None and np.isfinite(trajectory.pose).all() for trajectory in (first, second)
    ):
        return CheckSkipped("the engine reports an unresolved motion in one of the descriptions")
    distance, duration = float(np.abs(changed.pose[:, :2]).max()), INSTANT_STEPS * INSTANT_STEP * mechanism.time_scale
    floor = max(DESCRIPTION_TOLERANCE, LOW_PRECISION_ROUNDINGS * engine.precision)

    def state_difference(state: State, other: State, of: Mechanism) -> float:
        # The rounding error of a position is relative to the distance from the origin. The rounding error of a velocity
        # is that of the position divided by the step.
        least = POSITION_ROUNDING * max(distance, float(np.abs(of.pose[:, :2]).max()))
        if any(isinstance(joint, Weld) for joint in of.joints):  # the engine corrects the error of a weld's angle
            least += NOISE_MARGIN * engine.angle_error * of.length_scale / floor
        least_scale = np.array([[least, 0.0, 0.0]])
        moved, least_speed = other[0] - of.pose, least_scale * INSTANT_STEPS / duration
        return max(
            difference(of, state[0] - of.pose, moved, (of.twist * duration, 1e-6 * of.pose, least_scale)),
            difference(of, state[1], other[1], (of.twist, least_speed)),
        )

    state, other = (first.pose[-1], first.twist[-1]), back(second)
    error = state_difference(other, state, mechanism)
    if error <= floor:
        return error, floor
    if stricter is not None:  # the residual of the solver depends on the description
        return _compare_runs(stricter, mechanism, changed, back)
    if first.warnings or second.warnings:
        return CheckSkipped("descriptions differ, and the engine warns that something is wrong")
    if not np.isfinite(state[0]).all():
        if engine.variant == "default":
            return CheckSkipped("the motion diverges with the default settings")
        raise Fault(f"the motion diverged within {INSTANT_STEPS} steps without a warning")
    if turned_in_a_step(mechanism, INSTANT_STEP * mechanism.time_scale, *state) > 1:
        return TOO_LONG
    if first.estimate is not None:  # the estimate must include the effect of rounding
        unit = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
        claimed = float((first.estimate / unit).max())
        pose_error, twist_error = (float(np.abs((a - b) / unit).max()) for a, b in zip(other, state, strict=True))
        if not pose_error <= max(CLAIM, ESTIMATE_MARGIN * claimed):
            return error, floor
        if max(pose_error, twist_error * duration) <= claimed:
            return CheckSkipped("the descriptions differ by less than the method's error estimate")
    noise = 0.0
    for of, plain in ((mechanism, first), (changed, second)):
        last_state = plain.pose[-1], plain.twist[-1]
        for nudged, undo in iter_nudged(of, distance):
            pose, twist, _ = undo(run(nudged))
            noise = max(noise, state_difference((pose[-1], twist[-1]), last_state, of))
    if NOISE_MARGIN * noise > MAX_NOISE:
        return CheckSkipped("rounding or the residual of the solver changes the motion by more than a hundredth")
    return error, max(floor, NOISE_MARGIN * noise)
