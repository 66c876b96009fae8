"""Relative differences of motions and forces, and the tolerance for rounding and for an iterative solver.

A check fails if its error exceeds both a floor and NOISE_MARGIN times the noise of the case. The noise is the largest
change of the result if the case is slightly shifted, turned and rounded, or if the solver's tolerance is smaller
(`Engine.stricter`). Nearly dependent rows, large mass ratios and combined runs increase the noise.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Instant, NotDeclared
from engines.conformance.same import Described, Isometry, Three
from engines.constrained import constrained
from engines.remembered import by_identity
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory
from reports.gate.change import Nudge

Array = NDArray[np.float64]

NOISE_MARGIN = 10.0  # The margin is above 1, since the noise is the maximum of few samples.
NUDGE_COUNT, NUDGE_SHARE = 3, 1e-3  # Shifts are NUDGE_SHARE times a distance; rotations are NUDGE_SHARE rad.
LAW_TOLERANCE = 1e-9  # The tolerance is a thousand times the rounding error with independent rows.
PRECISION_MARGIN = 10.0  # Tolerance in units of the engine's precision.
INSTANT_STEP, INSTANT_STEPS = 0.01, 5  # The step is in units of the mechanism's time scale.
# More than `chunk.CHUNK_SIZE`, since all engines run the cases of one chunk before the next chunk.
CACHED_MECHANISMS = 16
Errors = Mapping[str, tuple[float, float]]  # Check -> (error, tolerance).


@dataclass(frozen=True)
class CheckSkipped:
    reason: str


class Fault(Exception):
    """A failure of an engine without a numerical error; the message is the reason."""


def iter_nudged(mechanism: Mechanism, away: float = 0.0) -> Iterator[Described]:
    """Yield copies that are slightly shifted, rotated and rounded, each with a function that transforms a run back. The
    shift is at most NUDGE_SHARE times the maximum of `away` [m], the length scale and the coordinates of bodies. The
    rotation is at most NUDGE_SHARE radians."""
    random = np.random.default_rng(NUDGE_COUNT)
    far = NUDGE_SHARE * max(away, mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
    for seed, (x, y, turn) in enumerate(random.uniform(-1.0, 1.0, (NUDGE_COUNT, 3)).tolist()):
        moved, back = Isometry(turn=NUDGE_SHARE * turn, shift=(far * x, far * y))(mechanism)
        with suppress(InvalidMechanism):  # rounding may open a joint
            moved = Nudge(seed)(moved)
        yield moved, back


def difference(mechanism: Mechanism, found: Array, expected: Array, scales: tuple[Array, ...] = ()) -> float:
    """The largest difference of two motions (..., bodies, 3), relative to the maximum of `expected` and `scales`.
    Angles are multiplied by the mechanism's length scale. The difference is infinite if a number is not finite."""
    return _relative(found, expected, np.array([1.0, 1.0, mechanism.length_scale]), scales)


def force_difference(mechanism: Mechanism, found: Array, expected: Array, scales: tuple[Array, ...] = ()) -> float:
    """The largest relative difference of forces (..., rows). Torques are divided by the mechanism's length scale. A
    force of NaN is not reported by the engine, and is ignored."""
    reported = ~np.isnan(found)
    size = np.where(mechanism.is_angular, 1 / mechanism.length_scale, 1.0)
    return _relative(np.where(reported, found, 0.0), np.where(reported, expected, 0.0), size, (expected, *scales))


def _relative(found: Array, expected: Array, size: Array, scales: tuple[Array, ...]) -> float:
    largest = max(float(np.abs(values * size).max(initial=0.0)) for values in (expected, *scales))
    error = float(np.abs((found - expected) * size).max(initial=0.0))
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def turned_in_a_step(mechanism: Mechanism, dt: float, pose: Array, twist: Array) -> float:
    """The largest rotation [rad] in a step dt [s] from a state. Bodies and directions of constraints are compared. A
    constraint direction turns at about the rate |J' v| / (|J| |v|). Above one radian, the result of every integrator is
    dominated by rounding."""
    rows, bias = mechanism.rows(pose), mechanism.bias(pose, twist)
    size = np.array([1.0, 1.0, mechanism.length_scale])
    parts = np.abs(rows.reshape(len(rows), *twist.shape) / size).max(axis=-1, initial=0.0)  # (rows, bodies)
    moving = parts.max(axis=1, initial=0.0) * ((parts > 0) @ np.abs(twist * size).max(axis=-1))
    change = constrained(rows, bias, mechanism.inertias, mechanism.unconstrained(pose, twist)).motion
    spin = np.abs(twist[:, 2]).max() * dt + np.abs(change[:, 2]).max() * dt**2
    return float(max(spin, dt * (np.abs(bias) / np.where(moving > 0, moving, np.inf)).max(initial=0.0)))


@by_identity(CACHED_MECHANISMS)
def turned_at_start(mechanism: Mechanism) -> float:
    """The result of `turned_in_a_step` for a step of INSTANT_STEP from the start."""
    return turned_in_a_step(mechanism, INSTANT_STEP * mechanism.time_scale, mechanism.pose, mechanism.twist)


def driving_force(mechanism: Mechanism, twist: Array) -> float:
    """The scale [N] of gravity, inertia forces and forces of elements."""
    rate = np.abs(twist[:, 2]).max()
    speed = np.hypot(twist[:, 0], twist[:, 1]).max()
    pull = np.hypot(*mechanism.gravity) + rate * rate * mechanism.length_scale + speed / mechanism.time_scale
    acting = mechanism.inertias * mechanism.unconstrained(mechanism.pose, mechanism.twist)
    acting = np.abs(acting / np.array([1.0, 1.0, mechanism.length_scale])).max()
    return float(max(mechanism.inertias[:, 0].max() * pull, acting))


def instant_errors(engine: Engine, mechanism: Mechanism) -> Errors | CheckSkipped:
    """Errors of an engine's first steps. The engine declares equations for single instants, which the steps must
    satisfy.

    `engines.Engine.instants` returns both sides of the equations. Errors are relative to the largest term.
    """
    declared_instants = _instants(engine, mechanism)
    if isinstance(declared_instants, NotDeclared):
        return CheckSkipped(declared_instants.reason)
    bound = max(LAW_TOLERANCE, PRECISION_MARGIN * engine.precision)
    missed: dict[str, float] = {}
    for instant in declared_instants:
        missed[instant.check] = max(missed.get(instant.check, 0.0), _instant_error(mechanism, instant))
    noise = dict.fromkeys(missed, 0.0)
    if all(error <= bound for error in missed.values()):
        return {check: (error, bound) for check, error in missed.items()}
    for nudged, back in iter_nudged(mechanism):
        others = _instants(engine, nudged)
        if not isinstance(others, NotDeclared):
            # One run may have fewer instants than the other.
            for instant, other in zip(declared_instants, others, strict=False):
                noise[instant.check] = max(noise[instant.check], _nudge_effect(mechanism, instant, other, back))
    return {check: (error, max(bound, NOISE_MARGIN * noise[check])) for check, error in missed.items()}


def _instants(engine: Engine, mechanism: Mechanism) -> Sequence[Instant] | NotDeclared:
    """Instants of the first steps. Only the start is used if the mechanism has a roll, or if a body or a constraint
    turns by more than a radian in a step.

    The equations of a roll assume a closed gap, but the gap is open after a step.
    """
    dt = INSTANT_STEP * mechanism.time_scale

    def is_resolved(instant: Instant) -> bool:
        return turned_in_a_step(mechanism, dt, *instant.state) <= 1

    rolls = any(isinstance(joint, Roll) for joint in mechanism.joints)
    short = turned_at_start(mechanism) <= 1 and not rolls
    declared = engine.stepped(mechanism).instants(mechanism, dt, INSTANT_STEPS if short else 0)
    if isinstance(declared, NotDeclared):
        return declared
    first = len({instant.check for instant in declared})
    return [instant for index, instant in enumerate(declared) if index < first or is_resolved(instant)]


def _instant_error(mechanism: Mechanism, instant: Instant) -> float:
    if instant.found.ndim == 1:
        force = np.full(mechanism.row_count, driving_force(mechanism, instant.state[1]))
        force[mechanism.is_angular] *= mechanism.length_scale
        return force_difference(mechanism, instant.found, instant.expected, (force, *instant.scales))
    return difference(mechanism, instant.found, instant.expected, instant.scales)


def _nudge_effect(mechanism: Mechanism, instant: Instant, other: Instant, back: Callable[[Trajectory], Three]) -> float:
    """The change of `found` plus the change of `expected` between two descriptions."""

    def described_back(values: Array) -> Array:
        motion, force = np.zeros((1, len(mechanism.bodies), 3)), np.zeros((1, mechanism.row_count))
        (force if values.ndim == 1 else motion)[0] = values
        _, twist, reaction = back(Trajectory(np.zeros(1), motion, motion, force, 0.0))
        return reaction[0] if values.ndim == 1 else twist[0]

    scales = (*instant.scales, instant.expected)
    pairs = (other.found, instant.found), (other.expected, instant.expected)
    return sum(
        _instant_error(mechanism, replace(instant, found=described_back(new), expected=old, scales=scales))
        for new, old in pairs
    )
