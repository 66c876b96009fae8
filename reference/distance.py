"""The distance between a point of one body and a point of another, and its derivative by the two bodies' poses.

Rods, springs and dampers are nothing but functions of it. Poses (..., 3) are of the two bodies, the ground's zero, and
points (..., 2) [m] in the bodies' own frames, on the ground world coordinates. All functions are analytic where the
points are apart, so a complex step passes through them.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.plane import from_body

AnyArray = NDArray[Any]


def apart(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> AnyArray:
    """The vector (..., 2) [m] from the first point to the second."""
    first_x, first_y = from_body(first[..., 2], first_point)
    second_x, second_y = from_body(second[..., 2], second_point)
    x = second[..., 0] + second_x - first[..., 0] - first_x
    y = second[..., 1] + second_y - first[..., 1] - first_y
    return np.stack([x, y], axis=-1)


def point_rows(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> AnyArray:
    """Its derivative (..., 2, 6): columns are the first body's x, y, angle and then the second's."""
    first_x, first_y = from_body(first[..., 2], first_point)
    second_x, second_y = from_body(second[..., 2], second_point)
    rows = np.zeros((*first_x.shape, 2, 6), dtype=np.result_type(first_x, second_x))
    rows[..., 0, 0] = rows[..., 1, 1] = -1
    rows[..., 0, 3] = rows[..., 1, 4] = 1
    rows[..., 0, 2], rows[..., 0, 5] = first_y, -second_y
    rows[..., 1, 2], rows[..., 1, 5] = -first_x, second_x
    return rows


def length_of(vector: AnyArray) -> AnyArray:
    """The length (...) of a vector (..., 2); not its absolute value, so that it stays analytic."""
    return np.sqrt(vector[..., 0] ** 2 + vector[..., 1] ** 2)


def distance(first: AnyArray, second: AnyArray, first_point: Any, second_point: Any) -> tuple[AnyArray, AnyArray]:
    """The distance (...) [m] of the two points and its derivative (..., 6); NaN where they coincide."""
    points = first_point, second_point
    vector, rows = apart(first, second, *points), point_rows(first, second, *points)
    length = length_of(vector)
    with np.errstate(divide="ignore", invalid="ignore"):
        row = (vector[..., 0, None] * rows[..., 0, :] + vector[..., 1, None] * rows[..., 1, :]) / length[..., None]
    return length, row
