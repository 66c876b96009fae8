"""Functions of plane vectors: rotation, k x vector, velocity and acceleration on a rotating body, and the vector
between points of two bodies with its derivatives by the poses (..., 3).

Vectors are arrays (..., 2) and broadcast against angles and rates (...). The unit vector k points out of the plane, and
angles are counter-clockwise. All functions are analytic, so they can be differentiated by a complex step.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

AnyArray = NDArray[Any]

# Imaginary step of derivatives, which are exact, since the square of the step is below the smallest double.
COMPLEX_STEP = 1e-100


def components(angle: Any, x: Any, y: Any) -> tuple[Any, Any]:
    """World components (...) of the vector (x, y) (...) of a frame rotated by `angle` (...) [rad]."""
    cosine, sine = np.cos(angle), np.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y


def from_body(angle: Any, point: Any) -> tuple[Any, Any]:
    """World components (...) of the vector `point` (..., 2) in a body's frame at the body's angle (...) [rad]."""
    vector = np.asarray(point)
    return components(angle, vector[..., 0], vector[..., 1])


def rotated(angle: Any, vector: AnyArray) -> AnyArray:
    """The vector (..., 2) rotated by `angle` (...) [rad], such as a body's vector in the world."""
    return np.stack(components(angle, vector[..., 0], vector[..., 1]), axis=-1)


def perpendicular(vector: AnyArray) -> AnyArray:
    """k x vector (..., 2), which is the vector rotated by a quarter turn counter-clockwise."""
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


def placed(points: AnyArray, angle: Any) -> AnyArray:
    """Poses or their derivatives (..., 3) from vectors (..., 2) or complex numbers (...), and angles (...)."""
    vectors = from_complex(points) if np.iscomplexobj(points) else points
    return np.concatenate([vectors, np.asarray(angle)[..., None]], axis=-1)


def swung(arm: AnyArray, angle: Any, rate: Any, angular_acceleration: Any) -> tuple[AnyArray, AnyArray, AnyArray]:
    """Pose, twist and acceleration (..., 3) of a body at the end of an arm (..., 2) [m] that turns about the origin."""
    linear = rotation_acceleration(rate, angular_acceleration, arm)
    return placed(arm, angle), placed(rotation_velocity(rate, arm), rate), placed(linear, angular_acceleration)


def apart(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> AnyArray:
    """The vector (..., 2) [m] from the first point to the second."""
    first_x, first_y = from_body(first[..., 2], first_point)
    second_x, second_y = from_body(second[..., 2], second_point)
    x = second[..., 0] + second_x - first[..., 0] - first_x
    y = second[..., 1] + second_y - first[..., 1] - first_y
    return np.stack([x, y], axis=-1)


def point_rows(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> AnyArray:
    """The derivative of `apart` (..., 2, 6): columns are x, y, angle of the first body and then of the second."""
    first_x, first_y = from_body(first[..., 2], first_point)
    second_x, second_y = from_body(second[..., 2], second_point)
    rows = np.zeros((*first_x.shape, 2, 6), dtype=np.result_type(first_x, second_x))
    rows[..., 0, 0] = rows[..., 1, 1] = -1
    rows[..., 0, 3] = rows[..., 1, 4] = 1
    rows[..., 0, 2], rows[..., 0, 5] = first_y, -second_y
    rows[..., 1, 2], rows[..., 1, 5] = -first_x, second_x
    return rows


def length_of(vector: AnyArray) -> AnyArray:
    """The length (...) of a vector (..., 2) as an analytic function."""
    return np.sqrt(vector[..., 0] ** 2 + vector[..., 1] ** 2)


def distance(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> tuple[AnyArray, AnyArray]:
    """The distance (...) [m] of two points and its derivative (..., 6), or NaN if the points coincide."""
    points = first_point, second_point
    vector, rows = apart(first, second, *points), point_rows(first, second, *points)
    length = length_of(vector)
    with np.errstate(divide="ignore", invalid="ignore"):
        row = (vector[..., 0, None] * rows[..., 0, :] + vector[..., 1, None] * rows[..., 1, :]) / length[..., None]
    return length, row


def direction_row(first: AnyArray, second: AnyArray, second_point: Any, x: Any, y: Any) -> AnyArray:
    """The row (..., 1, 6) of a velocity component in the direction (x, y) (...): a point of the second body moves
    relative to the material of the first body. Columns are x, y, angle of the first body and then of the second body.
    """
    point_x, point_y = from_body(second[..., 2], second_point)
    arm_x, arm_y = second[..., 0] + point_x - first[..., 0], second[..., 1] + point_y - first[..., 1]
    rows = np.zeros((*arm_x.shape, 1, 6), dtype=np.result_type(arm_x, x))
    rows[..., 0, 0], rows[..., 0, 1], rows[..., 0, 2] = -x, -y, x * arm_y - y * arm_x
    rows[..., 0, 3], rows[..., 0, 4], rows[..., 0, 5] = x, y, y * point_x - x * point_y
    return rows
