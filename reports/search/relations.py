"""A motion does not depend on how its mechanism is described: turned, shifted, mirrored, renamed, in other units.

The changes are those of the conformance kit, applied to random mechanisms; the case's number selects one change.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Engine
from engines.conformance.same import Change, Isometry, joints_swapped, relabelled
from reference.joints import Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.search.law import (
    INSTANT_STEP,
    INSTANT_STEPS,
    NOISE_MARGIN,
    CheckSkipped,
    Errors,
    Fault,
    difference,
    iter_nudged,
    turned_in_a_step,
)
from reports.search.parts import Recipe
from reports.search.recipe import build

Array = NDArray[np.float64]
State = tuple[Array, Array]  # pose and twist (bodies, 3) after the last step, in the mechanism's own description

# The descriptions differ by rounding. Methods that combine runs amplify it up to a hundred times; with very stiff
# constraints half of the digits are lost.
DESCRIPTION_TOLERANCE = 1e-7
LOW_PRECISION_ROUNDINGS = 1e4  # roundings of an engine of lower precision: displacements are small differences
POSITION_ROUNDING = 1e-6  # relative to a position: smaller displacements are affected by its rounding
MAX_NOISE = 0.1  # relative to the motion: with more noise the check detects nothing
ESTIMATE_MARGIN = 10.0  # times a method's error estimate: a larger error contradicts it
TOO_LONG = CheckSkipped("steps are too long for what turns, so that rounding grows at will")

CHANGES: dict[str, Change] = {
    "turned": Isometry(turn=0.7),
    "shifted": Isometry(shift=(3.7, -2.9)),
    "mirrored": Isometry(mirrored=True),
    "renamed": relabelled,
    "swapped": joints_swapped,
}
# Decades of length and of mass: in another unit the same mechanism has other numbers.
UNIT_CHANGES = {"in other lengths": (-3, 0), "in other masses": (0, 2)}
RELATIONS = (*CHANGES, *UNIT_CHANGES)


def relation_errors(engine: Engine, recipe: Recipe, number: int) -> Errors | CheckSkipped:
    """(error, tolerance) of the poses and velocities in another description, relative to the motion."""
    mechanism = build(recipe)
    if any(isinstance(joint, Roll) for joint in mechanism.joints) and engine.uses_contacts:
        return CheckSkipped("whether two shapes that just touch do touch depends on rounding")
    if _turns_too_far(mechanism, mechanism.pose, mechanism.twist):
        return TOO_LONG
    name = RELATIONS[number % len(RELATIONS)]
    if (
        name in UNIT_CHANGES and engine.variant == "default"
    ):  # an impedance grows over a millimetre, a slop is a decimetre
        return CheckSkipped("settings as shipped have lengths in them")
    described = describe_otherwise(recipe, mechanism, name)
    if isinstance(described, CheckSkipped):
        return described
    changed, back = described
    comparison = _compare_runs(engine, mechanism, changed, back, engine.stricter(mechanism))
    return comparison if isinstance(comparison, CheckSkipped) else {name: comparison}


def describe_otherwise(
    recipe: Recipe, mechanism: Mechanism, name: str
) -> tuple[Mechanism, Callable[[Trajectory], State]] | CheckSkipped:
    """The mechanism in another description, and the function that transforms a run's last state back."""
    if name in UNIT_CHANGES:
        longer, heavier = UNIT_CHANGES[name]
        of_length, of_mass, of_time = recipe.decades
        other, length = build(replace(recipe, decades=(of_length + longer, of_mass + heavier, of_time))), 10.0**longer
        unit = np.array([length, length, 1.0])
        begins = difference(mechanism, other.twist / unit, mechanism.twist)
        if max(begins, abs(other.length_scale / (length * mechanism.length_scale) - 1)) > DESCRIPTION_TOLERANCE:
            return CheckSkipped("no joint has an arm: a metre stands for the mechanism's length, whatever the unit")
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
    """(error, tolerance); see `reports.search.law` for the noise in the tolerance."""

    def run(described: Mechanism) -> Trajectory:
        return engine.build(described, INSTANT_STEP * described.time_scale)(1, INSTANT_STEPS)

    first, second = run(mechanism), run(changed)
    if any(item.unresolved_at is not None and np.isfinite(item.pose).all() for item in (first, second)):
        return CheckSkipped("it says itself that it is unresolved in one of the descriptions")
    away, duration = float(np.abs(changed.pose[:, :2]).max()), INSTANT_STEPS * INSTANT_STEP * mechanism.time_scale
    floor = max(DESCRIPTION_TOLERANCE, LOW_PRECISION_ROUNDINGS * engine.precision)

    def apart(state: State, other: State, of: Mechanism) -> float:
        # A shift costs digits of a place, those of its distance; a velocity those of a place divided by a step.
        least = POSITION_ROUNDING * max(away, float(np.abs(of.pose[:, :2]).max()))
        if any(isinstance(joint, Weld) for joint in of.joints):  # whose angle is measured, and closed as a gap
            least += NOISE_MARGIN * engine.angle_error * of.length_scale / floor
        far = np.array([[least, 0.0, 0.0]])
        moved, speed = other[0] - of.pose, far * INSTANT_STEPS / duration
        return max(
            difference(of, state[0] - of.pose, moved, (of.twist * duration, 1e-6 * of.pose, far)),
            difference(of, state[1], other[1], (of.twist, speed)),
        )

    state, other = (first.pose[-1], first.twist[-1]), back(second)
    error = apart(other, state, mechanism)
    if error <= floor:
        return error, floor
    if stricter is not None:  # its solver leaves another part in each description
        return _compare_runs(stricter, mechanism, changed, back)
    if first.warnings or second.warnings:
        return CheckSkipped("descriptions differ, and it says itself that something is wrong")
    if not np.isfinite(state[0]).all():
        if engine.variant == "default":
            return CheckSkipped("settings as shipped lose the motion in either description")
        raise Fault(f"it was lost within {INSTANT_STEPS} steps, and says nothing")
    if _turns_too_far(mechanism, *state):
        return TOO_LONG
    if first.estimate is not None:  # what rounding makes of a motion has to be in it
        size = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
        claimed = float((first.estimate / size).max())
        missed = [float(np.abs((a - b) / size).max()) for a, b in zip(other, state, strict=True)]
        if not missed[0] <= max(CLAIM, ESTIMATE_MARGIN * claimed):
            return error, floor
        if max(missed[0], missed[1] * duration) <= claimed:
            return CheckSkipped("descriptions differ by less than what it says itself that it misses")
    noise = 0.0
    for of, plain in ((mechanism, first), (changed, second)):
        last_state = plain.pose[-1], plain.twist[-1]
        for nudged, undo in iter_nudged(of, away):
            pose, twist, _ = undo(run(nudged))
            noise = max(noise, apart((pose[-1], twist[-1]), last_state, of))
    if NOISE_MARGIN * noise > MAX_NOISE:
        return CheckSkipped("rounding, or what its solver leaves, changes the motion by more than a hundredth")
    return error, max(floor, NOISE_MARGIN * noise)


def _turns_too_far(mechanism: Mechanism, pose: Array, twist: Array) -> bool:
    return turned_in_a_step(mechanism, INSTANT_STEP * mechanism.time_scale, pose, twist) > 1
