"""Problems 18.5.1 and 18.5.2: velocities and accelerations of the two bar ends of a double pendulum."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.checks import Positive, validated
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scenes.pendulum.link import direction_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class TwoPoints:
    """What problems 18.5.1 and 18.5.2 ask for, each (2,) in m/s or m/s^2: of A, of B relative to A, and of B."""

    a: Array
    b_relative_to_a: Array
    b: Array


@validated
def velocities(length: Positive, angles: tuple[float, float], rates: tuple[float, float]) -> TwoPoints:
    """Problem 18.5.1: A and B are the lower ends of the two bars of a double pendulum, each of `length` [m].

    The angles phi are from the downward vertical, counter-clockwise: r_A = l (sin phi1, -cos phi1).
    """
    first, second = (
        rotation_velocity(length * rate, direction_of(np.asarray(phi))) for phi, rate in zip(angles, rates, strict=True)
    )
    return TwoPoints(first, second, first + second)


@validated
def accelerations(
    length: Positive,
    angles: tuple[float, float],
    rates: tuple[float, float],
    angular_accelerations: tuple[float, float],
) -> TwoPoints:
    """Problem 18.5.2: a_A = l (phi1'' cos phi1 - phi1'^2 sin phi1, phi1'' sin phi1 + phi1'^2 cos phi1), B/A
    likewise.
    """
    first, second = (
        length * rotation_acceleration(rate, alpha, direction_of(np.asarray(phi)))
        for phi, rate, alpha in zip(angles, rates, angular_accelerations, strict=True)
    )
    return TwoPoints(first, second, first + second)
