"""What a boundary is: point, tangent angle and curvature by arc length, and the one convention for all of them.

The one convention (it replaces the chapter's "counter-clockwise", which fails for holes and straight ground):

* every boundary is traversed with its OWN MATERIAL ON THE LEFT: counter-clockwise round a disc, clockwise round a hole;
* the tangent angle is the direction of traversal, unwrapped: it goes on beyond a turn;
* curvature = d angle / d arc is positive where the boundary bends towards its material, so that of a ring is negative;
* flat ground with its material below is therefore traversed towards -x.

When B rolls on A the two tangents are opposite, angle_A + pi = theta + angle_B, and the contact runs forward on A and
backward on B: arc_A + arc_B is constant, and d arc_A / d theta = 1 / (curvature_A + curvature_B).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, Numbers, Valid, take, validated
from reference.plane import rotated

Array = NDArray[np.float64]
Vector = tuple[float, float]


class Curve(Valid, ABC):
    """A boundary by arc length [m], in the frame of the body that owns it; subclasses are frozen dataclasses.

    `length` [m] once round, infinite if it doesn't close; `limits` [m] the arcs that exist; `curvature_range` [1/m] the
    infimum and supremum of the curvature. All functions take arrays of any shape and are continuous over many turns.

    Each curve has its own natural parameter p, in which it is written; the functions of arc follow from those of p.
    """

    @property
    def length(self) -> float:
        return math.inf

    @property
    def limits(self) -> tuple[float, float]:
        return (-math.inf, math.inf)

    @property
    @abstractmethod
    def curvature_range(self) -> tuple[float, float]: ...

    @abstractmethod
    def parameter(self, arc: ArrayLike) -> Array:
        """The natural parameter (...) at arcs (...) [m]."""

    @abstractmethod
    def parameter_at(self, angle: ArrayLike) -> Array:
        """The natural parameter (...) where the unwrapped tangent angle is `angle` (...) [rad].

        Raises InvalidMechanism where the curve has no such tangent, or where it is straight and has it everywhere.
        """

    @abstractmethod
    def arc_of(self, p: ArrayLike) -> Array:
        """Arcs (...) [m] at natural parameters (...)."""

    @abstractmethod
    def speed_of(self, p: ArrayLike) -> Array:
        """d arc / d p (...), positive."""

    @abstractmethod
    def point_of(self, p: ArrayLike) -> Array:
        """Points (..., 2) [m] at natural parameters (...)."""

    @abstractmethod
    def angle_of(self, p: ArrayLike) -> Array:
        """Unwrapped directions of traversal (...) [rad] at natural parameters (...)."""

    @abstractmethod
    def curvature_of(self, p: ArrayLike) -> Array:
        """d angle / d arc (...) [1/m] at natural parameters (...)."""

    @validated
    def point(self, arc: ArrayLike) -> Array:
        """Points (..., 2) [m] at arcs (...) [m]."""
        return self.point_of(self.parameter(arc))

    @validated
    def angle(self, arc: ArrayLike) -> Array:
        """Unwrapped direction of traversal (...) [rad] at arcs (...) [m]."""
        return self.angle_of(self.parameter(arc))

    @validated
    def curvature(self, arc: ArrayLike) -> Array:
        """d angle / d arc (...) [1/m] at arcs (...) [m]."""
        return self.curvature_of(self.parameter(arc))

    @validated
    def arc(self, angle: ArrayLike) -> Array:
        """Arcs (...) [m] where the unwrapped tangent angle is `angle` (...) [rad]: the inverse of `angle`."""
        return self.arc_of(self.parameter_at(angle))


class ByArc(Curve):
    """A curve whose natural parameter is its arc length."""

    def parameter(self, arc: ArrayLike) -> Array:
        return along(arc)

    def arc_of(self, p: ArrayLike) -> Array:
        return along(p)

    def speed_of(self, p: ArrayLike) -> Array:
        return np.ones(np.shape(p))


def along(arc: ArrayLike) -> Array:
    """Arcs or angles as an array of floats, refused if they are no numbers; NaN stays NaN, a search may pass there."""
    if type(arc) is np.ndarray and arc.dtype == np.float64:  # at every step of a search
        return arc
    return take("curve", "the place", arc, Numbers)


def within(owner: str, arc: ArrayLike, limits: tuple[float, float], why: str) -> Array:
    """Raise InvalidMechanism, with the arc and the reason, unless every arc lies within the limits [m]."""
    arc = along(arc)
    slack = 1e-12 * max((abs(limit) for limit in limits if math.isfinite(limit)), default=0.0)
    outside = ~((arc >= limits[0] - slack) & (arc <= limits[1] + slack))
    if np.any(outside):
        raise InvalidMechanism(
            f"{owner}: there is no arc {float(arc[outside].flat[0])!r} m; it ends at {limits[0]:g} and "
            f"{limits[1]:g} m, {why}"
        )
    return arc


@dataclass(frozen=True)
class Placed(Curve):
    """A curve turned by `turn` [rad] about its origin and then shifted by `shift` [m]."""

    curve: Curve
    shift: Vector = (0.0, 0.0)
    turn: float = 0.0

    @property
    def length(self) -> float:
        return self.curve.length

    @property
    def limits(self) -> tuple[float, float]:
        return self.curve.limits

    @property
    def curvature_range(self) -> tuple[float, float]:
        return self.curve.curvature_range

    def parameter(self, arc: ArrayLike) -> Array:
        return self.curve.parameter(arc)

    def parameter_at(self, angle: ArrayLike) -> Array:
        return self.curve.parameter_at(along(angle) - self.turn)

    def arc_of(self, p: ArrayLike) -> Array:
        return self.curve.arc_of(p)

    def speed_of(self, p: ArrayLike) -> Array:
        return self.curve.speed_of(p)

    def point_of(self, p: ArrayLike) -> Array:
        return rotated(self.turn, self.curve.point_of(p)) + np.asarray(self.shift)

    def angle_of(self, p: ArrayLike) -> Array:
        return self.curve.angle_of(p) + self.turn

    def curvature_of(self, p: ArrayLike) -> Array:
        return self.curve.curvature_of(p)
