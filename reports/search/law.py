"""Differences of motions and forces, and how large rounding and a solver's tolerance make them, by one rule.

A check fails where its error is more than MARGIN times the noise of its case, and more than a floor. Noise is the
largest difference of the same case in descriptions that are shifted and turned a little and rounded otherwise, so that
every number of every step is rounded anew, and of the same engine with a solver that goes much farther
(`Engine.alike`). So it has the condition of the case in it: nearly dependent rows, masses far apart, weights of
combined runs, gaps that are closed although they are but rounded.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.conformance.same import Described, Isometry
from engines.constrained import constrained
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reports.gate.change import Nudge

Array = NDArray[np.float64]

MARGIN = 10.0  # noise is the largest of a few draws
NUDGES, NUDGED = 3, 1e-3  # of its place and of a radian: what depends on these themselves changes as little
Errors = Mapping[str, tuple[float, float]]  # by check (error, what it may be)


@dataclass(frozen=True)
class Skip:
    """The reason why a check does not apply to a case, one sentence."""

    reason: str


class Fault(Exception):
    """An error without a number; the message is one sentence that says what is wrong."""


def nudges(mechanism: Mechanism, away: float = 0.0) -> Iterator[Described]:
    """The mechanism shifted by NUDGED of how far `away` [m] it stands, turned by as much, and with rounded numbers.

    Beside each stands the function that describes a run of it back.
    """
    random = np.random.default_rng(NUDGES)
    far = NUDGED * max(away, mechanism.length_scale, float(np.abs(mechanism.pose[:, :2]).max()))
    for seed, (x, y, turn) in enumerate(random.uniform(-1.0, 1.0, (NUDGES, 3)).tolist()):
        moved, back = Isometry(turn=NUDGED * turn, shift=(far * x, far * y))(mechanism)
        with suppress(InvalidMechanism):  # numbers that fit to the last digit alone
            moved = Nudge(seed)(moved)
        yield moved, back


def difference(mechanism: Mechanism, found: Array, expected: Array, scales: tuple[Array, ...] = ()) -> float:
    """The largest difference of two motions (..., bodies, 3), relative to the largest of `expected` and of `scales`.

    Rotations count as the arcs that they make at the mechanism's own length. Infinite where a number is lost.
    """
    return _relative(found, expected, np.array([1.0, 1.0, mechanism.length_scale]), scales)


def force_difference(mechanism: Mechanism, found: Array, expected: Array, scales: tuple[Array, ...] = ()) -> float:
    """The same of forces (..., rows): torques count as the forces that they need at the mechanism's own length.

    Rows whose force is NaN, since the engine can't tell it, are left out.
    """
    known = ~np.isnan(found)
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    return _relative(np.where(known, found, 0.0), np.where(known, expected, 0.0), size, (expected, *scales))


def _relative(found: Array, expected: Array, size: Array, scales: tuple[Array, ...]) -> float:
    largest = max(float(np.abs(values * size).max(initial=0.0)) for values in (expected, *scales))
    error = float(np.abs((found - expected) * size).max(initial=0.0))
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def turned_in_a_step(mechanism: Mechanism, dt: float, pose: Array, twist: Array) -> float:
    """By how much the fastest body, or the direction of a row, turns in a step of dt [s] from a state on: rad.

    A row turns at about the rate |J' v| / (|J| |v|), with the velocities of its bodies: a short rod, say, whose ends
    move apart. Above a radian no integrator follows, and what comes of the motion is rounding.
    """
    rows, bias = mechanism.rows(pose), mechanism.bias(pose, twist)
    size = np.array([1.0, 1.0, mechanism.length_scale])
    parts = np.abs(rows.reshape(len(rows), *twist.shape) / size).max(axis=-1, initial=0.0)  # (rows, bodies)
    moving = parts.max(axis=1, initial=0.0) * ((parts > 0) @ np.abs(twist * size).max(axis=-1))
    change = constrained(rows, bias, mechanism.inertias, mechanism.unconstrained(pose, twist)).motion
    spin = np.abs(twist[:, 2]).max() * dt + np.abs(change[:, 2]).max() * dt**2
    return float(max(spin, dt * (np.abs(bias) / np.where(moving > 0, moving, np.inf)).max(initial=0.0)))


def driving_force(mechanism: Mechanism, twist: Array) -> float:
    """A force [N] that acts in the mechanism: of gravity, of its motion, or of its force elements at the start."""
    rate = np.abs(twist[:, 2]).max()
    speed = np.hypot(twist[:, 0], twist[:, 1]).max()
    pull = np.hypot(*mechanism.gravity) + rate * rate * mechanism.length_scale + speed / mechanism.time_scale
    acting = mechanism.inertias * mechanism.unconstrained(mechanism.pose, mechanism.twist)
    acting = np.abs(acting / np.array([1.0, 1.0, mechanism.length_scale])).max()
    return float(max(mechanism.inertias[:, 0].max() * pull, acting))
