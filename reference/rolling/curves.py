"""The base of boundaries that are described by arc length, and the boundaries line, side, disc and hole.

These conventions replace the chapter's "counter-clockwise", which fails for holes and straight ground.

* A boundary is traversed with its MATERIAL ON THE LEFT: counter-clockwise round a disc, clockwise round a hole.
* The tangent angle is the direction of traversal, unwrapped.
* The curvature d angle / d arc is positive if the boundary bends towards its material, and negative for a ring.
* Flat ground with its material below is traversed towards -x.

When B rolls on A the tangents are opposite, angle_A + pi = theta + angle_B. The contact moves forward on A and backward
on B, so that arc_A + arc_B is constant, with d arc_A / d theta = 1 / (curvature_A + curvature_B).
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Numbers, Positive, Valid, validate, validated
from reference.plane import rotated
from reference.validators import Array

Vector = tuple[float, float]


class Curve(Valid, ABC):
    """A boundary described by arc length [m] in a body's frame; subclasses are frozen dataclasses.

    `length` [m] is the circumference, or infinite if the curve is not closed. `limits` [m] are the first and last arc.
    `curvature_range` [1/m] is the infimum and supremum of the curvature. All functions take arrays of any shape and are
    continuous over many turns. A curve is defined by functions of a natural parameter p.
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
        """The natural parameter (...) at which the unwrapped tangent angle is `angle` (...) [rad].

        Raises InvalidMechanism if the curve is straight or has no such tangent.
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
    """Return arcs or angles, which may be NaN, as an array of floats; raise InvalidMechanism for other types."""
    if type(arc) is np.ndarray and arc.dtype == np.float64:  # fast path
        return arc
    return validate("curve", "the place", arc, Numbers)


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
    """A curve that is rotated by `turn` [rad] about its origin and then shifted by `shift` [m]."""

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


def straight_has_no_inverse(owner: str) -> InvalidMechanism:
    return InvalidMechanism(
        f"{owner}: it is straight, so its direction does not determine a point; use a curved boundary"
    )


@dataclass(frozen=True)
class Line(ByArc):
    """A straight boundary through a point [m], traversed towards `heading` [rad] with the material on the left.

    The default heading pi is flat ground with its material below; pi + slope is an incline that rises to +x.
    """

    heading: float = math.pi
    through: Vector = (0.0, 0.0)

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (0.0, 0.0)

    def point_of(self, p: ArrayLike) -> Array:
        return np.asarray(self.through) + along(p)[..., None] * [math.cos(self.heading), math.sin(self.heading)]

    def angle_of(self, p: ArrayLike) -> Array:
        return np.full(np.shape(p), float(self.heading))

    def curvature_of(self, p: ArrayLike) -> Array:
        return np.zeros(np.shape(p))

    def parameter_at(self, angle: ArrayLike) -> Array:
        raise straight_has_no_inverse("line")


@dataclass(frozen=True)
class Side(ByArc):
    """The lower side of a square about the origin, traversed to +x; arcs are between -side/2 and side/2 [m].

    Arcs beyond the ends are refused, since the ends are corners of infinite curvature.
    """

    side: Positive

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (0.0, 0.0)

    @property
    def limits(self) -> tuple[float, float]:
        return (-self.side / 2, self.side / 2)

    def _within(self, arc: ArrayLike) -> Array:
        return within("side of a square", arc, self.limits, "at corners of infinite curvature; stay between them")

    def point_of(self, p: ArrayLike) -> Array:
        arc = self._within(p)
        return np.stack([arc, np.full(arc.shape, -self.side / 2)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return np.zeros(self._within(p).shape)

    def curvature_of(self, p: ArrayLike) -> Array:
        return np.zeros(self._within(p).shape)

    def parameter_at(self, angle: ArrayLike) -> Array:
        raise straight_has_no_inverse("side of a square")


@dataclass(frozen=True)
class _Round(ByArc):
    radius: Positive
    centre: Vector = (0.0, 0.0)

    sense: ClassVar[float] = 1.0  # -1 if clockwise

    @property
    def length(self) -> float:
        return 2 * math.pi * self.radius

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (self.sense / self.radius, self.sense / self.radius)

    def point_of(self, p: ArrayLike) -> Array:
        polar = along(p) * (self.sense / self.radius)
        return np.asarray(self.centre) + self.radius * np.stack([np.cos(polar), np.sin(polar)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return self.sense * (along(p) / self.radius + math.pi / 2)

    def curvature_of(self, p: ArrayLike) -> Array:
        return np.full(np.shape(p), self.sense / self.radius)

    def parameter_at(self, angle: ArrayLike) -> Array:
        return self.radius * (self.sense * along(angle) - math.pi / 2)


@dataclass(frozen=True)
class Circle(_Round):
    """A disc's rim, with arc 0 at +x, where the tangent angle is pi/2."""


@dataclass(frozen=True)
class Ring(_Round):
    """A round hole in surrounding material, traversed clockwise; arc 0 is at +x, with tangent angle -pi/2."""

    sense: ClassVar[float] = -1.0
