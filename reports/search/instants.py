"""What an engine computes at one instant, against the law that it declares there (`engines.Engine.instants`)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Instant, Unpromised
from engines.conformance.same import Three
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.search.law import (
    MARGIN,
    Errors,
    Skip,
    difference,
    driving_force,
    force_difference,
    nudges,
    turned_in_a_step,
)

STEP = 0.01  # of the mechanism's own time scale
STEPS = 5
LAW = 1e-9  # rounding makes a thousandth of it where rows are independent
ROUNDINGS = 10.0  # of an engine of lower precision


def errors(engine: Engine, mechanism: Mechanism) -> Errors | Skip:
    """By what it misses the law in its first steps, relative to the largest of what enters the law."""
    here = _instants(engine, mechanism)
    if isinstance(here, Unpromised):
        return Skip(here.reason)
    bound = max(LAW, ROUNDINGS * engine.precision)
    missed: dict[str, float] = {}
    for instant in here:
        missed[instant.check] = max(missed.get(instant.check, 0.0), _missed(mechanism, instant))
    if all(error <= bound for error in missed.values()):
        return {check: (error, bound) for check, error in missed.items()}
    noise = dict.fromkeys(missed, 0.0)
    for nudged, back in nudges(mechanism):
        others = _instants(engine, nudged)
        if not isinstance(others, Unpromised):
            for instant, other in zip(here, others, strict=False):  # the later states of one may be left out
                noise[instant.check] = max(noise[instant.check], _apart(mechanism, instant, other, back))
    return {check: (error, max(bound, MARGIN * noise[check])) for check, error in missed.items()}


def _instants(engine: Engine, mechanism: Mechanism) -> Sequence[Instant] | Unpromised:
    """Of the first steps; of the start alone where something turns by a radian in a step, or rolls: the rows of a roll
    are those of a closed gap, and turn by an open one over the radius of curvature.
    """
    dt = STEP * mechanism.time_scale

    def followed(instant: Instant) -> bool:
        return turned_in_a_step(mechanism, dt, *instant.state) <= 1

    rolls = any(isinstance(joint, Roll) for joint in mechanism.joints)
    short = turned_in_a_step(mechanism, dt, mechanism.pose, mechanism.twist) <= 1 and not rolls
    found = engine.within(mechanism).instants(mechanism, dt, STEPS if short else 0)
    if isinstance(found, Unpromised):
        return found
    first = len({instant.check for instant in found})
    return [instant for place, instant in enumerate(found) if place < first or followed(instant)]


def _missed(mechanism: Mechanism, instant: Instant) -> float:
    if instant.found.ndim == 1:
        force = np.full(mechanism.row_count, driving_force(mechanism, instant.state[1]))
        force[mechanism.turning] *= mechanism.length_scale
        return force_difference(mechanism, instant.found, instant.expected, (force, *instant.scales))
    return difference(mechanism, instant.found, instant.expected, instant.scales)


def _apart(mechanism: Mechanism, instant: Instant, other: Instant, back: Callable[[Trajectory], Three]) -> float:
    """By how much another description changes what is found, or what is expected."""

    def described_back(values: NDArray[np.float64]) -> NDArray[np.float64]:
        motion, force = np.zeros((1, len(mechanism.bodies), 3)), np.zeros((1, mechanism.row_count))
        (force if values.ndim == 1 else motion)[0] = values
        _, twist, reaction = back(Trajectory(np.zeros(1), motion, motion, force, 0.0))
        return reaction[0] if values.ndim == 1 else twist[0]

    return sum(
        _missed(
            mechanism,
            replace(
                instant,
                found=described_back(getattr(other, name)),
                expected=getattr(instant, name),
                scales=(*instant.scales, instant.expected),
            ),
        )
        for name in ("found", "expected")
    )
