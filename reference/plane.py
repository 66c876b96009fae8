"""Vectors of the plane, once: rotation, k x vector, and the velocity and acceleration that a rotation gives a point.

Vectors are arrays (..., 2) and broadcast against angles and rates (...). k points out of the plane, angles are
counter-clockwise. All functions are analytic, so a complex step passes through them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

AnyArray = NDArray[Any]

# Imaginary step of an analytic function: its square is below the smallest double, so the derivative is exact.
COMPLEX_STEP = 1e-100


def components(angle: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """World components (...) of the vector (x, y) (...) of a frame that stands at `angle` (...) [rad]."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


def from_body(angle: Any, point: Any) -> tuple[Any, Any]:
    """World components (...) of a body's own vector `point` (..., 2) at the body's angle (...) [rad]."""
    vector = np.asarray(point)
    return components(angle, vector[..., 0], vector[..., 1])


def rotated(angle: Any, vector: AnyArray) -> AnyArray:
    """The vector (..., 2) turned by `angle` (...) [rad]: a body's own vector in the world."""
    return np.stack(components(angle, vector[..., 0], vector[..., 1]), axis=-1)


def perpendicular(vector: AnyArray) -> AnyArray:
    """k x vector (..., 2): a quarter turn counter-clockwise."""
    return np.stack([-vector[..., 1], vector[..., 0]], axis=-1)


def rotation_velocity(rate: Any, arm: AnyArray) -> AnyArray:
    """omega k x r (..., 2) [m/s] at the end of an arm r (..., 2) [m] that turns at the rate omega (...) [rad/s]."""
    return np.asarray(rate)[..., None] * perpendicular(arm)


def rotation_acceleration(rate: Any, angular_acceleration: Any, arm: AnyArray) -> AnyArray:
    """alpha k x r - omega^2 r (..., 2) [m/s^2] at the end of an arm r (..., 2) [m]; alpha (...) in rad/s^2."""
    return rotation_velocity(angular_acceleration, arm) - np.asarray(rate)[..., None] ** 2 * arm


def from_complex(number: Any) -> AnyArray:
    """The vector (..., 2) of a complex number x + i y (...)."""
    return np.stack([np.real(number), np.imag(number)], axis=-1)
