"""Boundaries of rolling bodies in plain floats: the closed forms of `reference.curves` for one place at a time."""

from __future__ import annotations

import math
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import Protocol

from scipy.special import ellipeinc

from reference.curves.cam import Cam
from reference.curves.circles_lines import Circle, Line, Ring
from reference.curves.curve import Curve, Placed
from reference.curves.ellipse import Ellipse

Point = tuple[float, float]


class Boundary(Protocol):
    """A curve by its natural parameter, as in `reference.curves.curve.Curve`, one float at a time."""

    def point(self, p: float) -> Point: ...
    def angle(self, p: float) -> float: ...
    def arc(self, p: float) -> float: ...
    def curvature(self, p: float) -> float: ...
    def speed(self, p: float) -> float: ...
    def parameter_at(self, angle: float) -> float: ...


@dataclass(frozen=True)
class Straight:
    heading: float
    through: Point

    def point(self, p: float) -> Point:
        return self.through[0] + p * cos(self.heading), self.through[1] + p * sin(self.heading)

    def angle(self, p: float) -> float:
        return self.heading

    def arc(self, p: float) -> float:
        return p

    def curvature(self, p: float) -> float:
        return 0.0

    def speed(self, p: float) -> float:
        return 1.0

    def parameter_at(self, angle: float) -> float:
        raise NotImplementedError


@dataclass(frozen=True)
class Round:
    radius: float
    centre: Point
    sense: float

    def point(self, p: float) -> Point:
        polar = p * self.sense / self.radius
        return self.centre[0] + self.radius * cos(polar), self.centre[1] + self.radius * sin(polar)

    def angle(self, p: float) -> float:
        return self.sense * (p / self.radius + pi / 2)

    def arc(self, p: float) -> float:
        return p

    def curvature(self, p: float) -> float:
        return self.sense / self.radius

    def speed(self, p: float) -> float:
        return 1.0

    def parameter_at(self, angle: float) -> float:
        return self.radius * (self.sense * angle - pi / 2)


class Oval:
    def __init__(self, ellipse: Ellipse) -> None:
        self.a, self.b, self.half = ellipse.along_x, ellipse.along_y, ellipse.length / 2
        self.flat = 1 - min(self.a / self.b, self.b / self.a) ** 2

    def point(self, p: float) -> Point:
        return self.a * cos(p), self.b * sin(p)

    def angle(self, p: float) -> float:
        sine, cosine = sin(p), cos(p)
        return p + pi / 2 + atan2((self.a - self.b) * sine * cosine, self.a * sine**2 + self.b * cosine**2)

    def arc(self, p: float) -> float:
        half_turns = round(p / pi)
        rest = p - half_turns * pi
        if self.a <= self.b:
            part = self.b * ellipeinc(rest, self.flat)
        else:
            part = self.a * ellipeinc(rest - math.copysign(pi / 2, rest), self.flat)
            part += math.copysign(self.half / 2, rest)
        return half_turns * self.half + float(part)

    def speed(self, p: float) -> float:
        return hypot(self.a * sin(p), self.b * cos(p))

    def curvature(self, p: float) -> float:
        return self.a * self.b / self.speed(p) ** 3

    def parameter_at(self, angle: float) -> float:
        normal = angle - pi / 2
        sine, cosine = sin(normal), cos(normal)
        return normal + atan2((self.b - self.a) * sine * cosine, self.a * cosine**2 + self.b * sine**2)


class Lobed:
    def __init__(self, cam: Cam) -> None:
        self.radius = cam.radius
        count = max(len(cam.cosines), len(cam.sines))
        pad = (0.0,) * count
        rows = zip(range(1, count + 1), (*cam.cosines, *pad), (*cam.sines, *pad), strict=False)
        self.harmonics = tuple((k, c, s) for k, c, s in rows if c or s)
        self.offset = self._bare_arc(0.0)

    def point(self, p: float) -> Point:
        support, slope = self.radius, 0.0
        for k, c, s in self.harmonics:
            cosine, sine = cos(k * p), sin(k * p)
            support += c * cosine + s * sine
            slope += k * (s * cosine - c * sine)
        cosine, sine = cos(p), sin(p)
        return support * cosine - slope * sine, support * sine + slope * cosine

    def angle(self, p: float) -> float:
        return p + pi / 2

    def _bare_arc(self, p: float) -> float:
        total = self.radius * p
        for k, c, s in self.harmonics:
            # The integral of h + h''.
            total += (1 / k - k) * (c * sin(k * p) - s * cos(k * p))
        return total

    def arc(self, p: float) -> float:
        return self._bare_arc(p) - self.offset

    def speed(self, p: float) -> float:
        total = self.radius
        for k, c, s in self.harmonics:
            total += (1 - k * k) * (c * cos(k * p) + s * sin(k * p))
        return total

    def curvature(self, p: float) -> float:
        return 1 / self.speed(p)

    def parameter_at(self, angle: float) -> float:
        return angle - pi / 2


class Moved:
    """Another boundary, turned and then shifted."""

    def __init__(self, inner: Boundary, turn: float, shift: Point) -> None:
        self.inner, self.turn, self.shift = inner, turn, shift
        self._cosine, self._sine = cos(turn), sin(turn)
        self.arc, self.speed, self.curvature = inner.arc, inner.speed, inner.curvature

    def point(self, p: float) -> Point:
        x, y = self.inner.point(p)
        c, s = self._cosine, self._sine
        return c * x - s * y + self.shift[0], s * x + c * y + self.shift[1]

    def angle(self, p: float) -> float:
        return self.inner.angle(p) + self.turn

    def parameter_at(self, angle: float) -> float:
        return self.inner.parameter_at(angle - self.turn)


def boundary_of(curve: Curve) -> Boundary | None:
    """The same curve in plain floats; None for one that has no form of it here."""
    match curve:
        case Line():
            return Straight(curve.heading, curve.through)
        case Circle() | Ring():
            return Round(curve.radius, curve.centre, curve.sense)
        case Ellipse():
            return Oval(curve)
        case Cam():
            return Lobed(curve)
        case Placed():
            inner = boundary_of(curve.curve)
            return None if inner is None else Moved(inner, curve.turn, curve.shift)
        case _:
            return None


def unplaced(curve: Curve) -> Curve:
    """What was turned and shifted."""
    while isinstance(curve, Placed):
        curve = curve.curve
    return curve
