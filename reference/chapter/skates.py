"""Two remarks of section 18.5 on skates, computed: the skate is the only one of its kind, and its Coriolis-like term.

A linear condition on the velocity of one body that is the same everywhere in the plane, in every direction, is written
in the body's own axes with constant factors: a u + b v + c theta' = 0, u and v [m/s] the velocity of the centre of
mass along them. With (a, b) = 0 it is theta' = 0, which is integrable. Otherwise divide by |(a, b)|: it is the velocity
of the point P across a blade, where the line along the blade's left normal n = (a, b) / |(a, b)| is the set of all
points with n . (k x P) = c / |(a, b)|. So it is a skate, and w . curl w = -(a^2 + b^2) < 0: never integrable.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.chapter.integrability import Place, exterior_derivatives
from reference.checks import InvalidMechanism, validated
from reference.joints import Skate
from reference.numerics.calculus import derivative

BodyRow = tuple[float, float, float]  # (a, b, c) [1, 1, m]


@validated
def skate_of(row: BodyRow, body: str = "body") -> Skate | None:
    """The skate that holds a row (a, b, c) in the body's axes; None where it only stops the turning (a = b = 0).

    Raises InvalidMechanism for a row of zeros, which holds nothing.
    """
    a, b, c = row
    size = math.hypot(a, b)
    if size == 0:
        if c == 0:
            raise InvalidMechanism(f"skate: row is {row}; one of its three numbers must differ from zero")
        return None
    a, b, c = a / size, b / size, c / size
    return Skate("skate", None, body, (c * b, -c * a), math.atan2(-a, b))


@validated
def one_form(row: BodyRow) -> Callable[[NDArray[Any]], NDArray[Any]]:
    """The row in the coordinates (x, y, theta) of the world: places (..., 3) to rows (..., 1, 3), analytic."""
    a, b, c = row

    def rows(place: NDArray[Any]) -> NDArray[Any]:
        cosine, sine = np.cos(place[..., 2]), np.sin(place[..., 2])
        return np.stack([a * cosine - b * sine, a * sine + b * cosine, c + 0 * cosine], axis=-1)[..., None, :]

    return rows


@validated
def frobenius(row: BodyRow, place: Place) -> float:
    """w . curl w of the row's one-form at a place (x, y, theta), by a complex step: zero everywhere iff integrable."""
    (form,), (slope,) = one_form(row)(place), exterior_derivatives(one_form(row), place)
    return float(form @ np.array([slope[1, 2], slope[2, 0], slope[0, 1]]))


@validated
def coriolis_factors(speed: float, rate: float, angular_acceleration: float = 0.0) -> tuple[float, float]:
    """How often v theta' stands in the acceleration across the direction of v: (of a skate's point, of a slider).

    speed v [m/s], rate theta' [rad/s], neither zero. The skate's point moves at v along i' of its own body, and only i'
    turns. A slider at the same place moves at v along i' of a turning body: i' turns, and so does its growing arm.
    Both are derivatives of a velocity or of a position, taken without either formula.
    """
    if speed == 0 or rate == 0:
        raise InvalidMechanism(f"coriolis_factors: speed is {speed}, rate is {rate}; neither may be zero")

    def along(t: Any) -> Any:
        angle = rate * t + angular_acceleration * t * t / 2
        return np.stack([np.cos(angle), np.sin(angle)])

    # At t = 0 the body's axis i' is the world's x: what lies across is y. A radius [s] in which nothing turns far.
    near = 0.25 / max(abs(rate), math.sqrt(abs(angular_acceleration)))
    skate = derivative(lambda t: speed * along(t), 0.0, radius=near)
    slider = derivative(lambda t: speed * t * along(t), 0.0, order=2, radius=near)
    return float(skate[1] / (speed * rate)), float(slider[1] / (speed * rate))
