"""The simplest boundaries: Line, a Side of a square, Circle and Ring (the convention is in `curve`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive
from reference.rolling.curves import Array, ByArc, Vector, along, within


def straight_has_no_inverse(owner: str) -> InvalidMechanism:
    """The error for asking a straight boundary where it has a given direction."""
    return InvalidMechanism(f"{owner}: it is straight, so its direction doesn't tell the place; ask a curved boundary")


@dataclass(frozen=True)
class Line(ByArc):
    """A straight boundary through a point [m], traversed towards `heading` [rad], material on its left.

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
    """The lower side of a square of side `side` [m] about the origin: arcs from -side/2 to side/2, traversed to +x.

    Beyond its ends are corners, where the curvature is infinite: any arc there is refused.
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
    """What a disc and a hole share: a circle of `radius` [m] about `centre` [m], traversed to the left or the right."""

    radius: Positive
    centre: Vector = (0.0, 0.0)

    sense: ClassVar[float] = 1.0  # +1 counter-clockwise, -1 clockwise

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
    """A disc's rim; arc 0 is its point at +x, where the tangent angle is pi/2."""


@dataclass(frozen=True)
class Ring(_Round):
    """A round hole in surrounding material, traversed clockwise; arc 0 is at +x, with tangent angle -pi/2."""

    sense: ClassVar[float] = -1.0
