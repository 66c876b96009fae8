"""A motion at sampled times, and what can be said of it without a reference: energy, joint gap, slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Numbers, Valid, validated
from reference.kinds import NOT_FINITE, of_shape
from reference.mechanism import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Trajectory(Valid):
    """Poses, twists and reactions at times t, in the order of the mechanism's bodies and rows.

    The truth and every engine give one of these, the first sample at t = 0. An engine also says what it cost
    (`stepping`), what it warned of, whether it reset itself, and its own estimate of its error if its method has one.
    """

    _copies: ClassVar[bool] = False  # nothing is kept that follows from its arrays, and they may be large

    t: Annotated[Array, of_shape("times")]  # (times,) s
    pose: Annotated[Numbers, of_shape("times", "bodies", 3)]  # (times, bodies, 3) m, m, rad; angles not wrapped
    twist: Annotated[
        Numbers, of_shape("times", "bodies", 3)
    ]  # (times, bodies, 3) m/s, m/s, rad/s, at the same instants as the poses
    reaction: Annotated[
        Numbers, of_shape("times", "rows")
    ]  # (times, rows) N or N m, M a = f + J^T reaction; NaN where unknown
    stepping: Annotated[float, NOT_FINITE] = float(
        "nan"
    )  # s of CPU in the stepping loop, recording included; NaN for a truth
    warnings: tuple[str, ...] = ()  # what the engine itself said
    reset_at: float | None = None  # s, the time at which the engine started anew by itself; samples from there are NaN
    estimate: Annotated[Numbers, of_shape("times", "bodies", 3)] | None = (
        None  # (times, bodies, 3) the method's own estimate of its error in the poses
    )
    unresolved_at: float | None = None  # s, from when on that estimate is above what the method claims


@validated
def energy(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """Kinetic energy and the potential (`Mechanism.potential`) of gravity and forces (times,) [J].

    It stays where no drive and no damper takes part.
    """
    kinetic = 0.5 * np.sum(mechanism.inertias * trajectory.twist**2, axis=(-2, -1))
    return kinetic + mechanism.potential(trajectory.pose)


@validated
def joint_gap(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """How far every joint is open (times, rows) [m, rad for a drive]; NaN in rows that constrain velocity only."""
    return mechanism.gap(trajectory.pose, trajectory.t)


@validated
def slip(mechanism: Mechanism, trajectory: Trajectory) -> Array:
    """J v - rate (times, rows) [m/s, rad/s]: how fast every joint is violated."""
    return mechanism.slip(trajectory.pose, trajectory.twist)
