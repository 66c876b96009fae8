"""Where two rolling curves touch, as a function of the rotation, in plain floats: a step can't wait for arrays.

`reference.rolling` knows the contact for arrays of rotations; one call of it takes longer than a hundred steps of the
engine. Here are the same closed forms for one rotation: straight or round ground under round, elliptic and cam-shaped
bodies. Any other pair asks the reference.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, sin
from typing import Any, Protocol

from scipy.special import ellipeinc

from reference.cam import Cam
from reference.checks import InvalidMechanism
from reference.curve import Curve, Placed
from reference.curves import Circle, Line, Ring
from reference.ellipse import Ellipse
from reference.rolling import Rolling

Point = tuple[float, float]


class _Boundary(Protocol):
    """A curve by its natural parameter, as in `reference.curve.Curve`, one float at a time."""

    def point(self, p: float) -> Point: ...
    def angle(self, p: float) -> float: ...
    def arc(self, p: float) -> float: ...
    def curvature(self, p: float) -> float: ...
    def speed(self, p: float) -> float: ...
    def parameter_at(self, angle: float) -> float: ...


@dataclass(frozen=True)
class _Straight:
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
class _Round:
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


class _Oval:
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


class _Lobed:
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


class _Moved:
    """Another boundary, turned and then shifted."""

    def __init__(self, inner: _Boundary, turn: float, shift: Point) -> None:
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


def _boundary(curve: Curve) -> _Boundary | None:
    match curve:
        case Line():
            return _Straight(curve.heading, curve.through)
        case Circle() | Ring():
            return _Round(curve.radius, curve.centre, curve.sense)
        case Ellipse():
            return _Oval(curve)
        case Cam():
            return _Lobed(curve)
        case Placed():
            inner = _boundary(curve.curve)
            return None if inner is None else _Moved(inner, curve.turn, curve.shift)
        case _:
            return None


def _unplaced(curve: Curve) -> Curve:
    while isinstance(curve, Placed):
        curve = curve.curve
    return curve


class Touch:
    """The contact of one rolling pair; rotations [rad] are those of the body against the ground's, unwrapped.

    Both calls raise InvalidMechanism where the pair can't roll, and ValueError for a rotation that is not finite.
    """

    def __init__(self, rolling: Rolling) -> None:
        self._rolling = rolling
        self._ground, self._body = _boundary(rolling.ground), _boundary(rolling.body)
        straight = isinstance(_unplaced(rolling.ground), Line)
        bends = not isinstance(_unplaced(rolling.body), Line)
        self._parameters: Callable[[float], tuple[float, float | None]] | None = None
        if self._ground is not None and self._body is not None and bends:
            start = float(rolling.body.parameter(rolling.body_arc)), float(rolling.ground.parameter(rolling.ground_arc))
            self._start_angles = self._body.angle(start[0]), self._ground.angle(start[1])
            self._last = (rolling.theta, *start)
            self._parameters = self._on_a_line if straight else self._on_a_bend

    def on_body(self, theta: float) -> Point:
        """The contact in the body's frame [m]."""
        if self._parameters is None or self._body is None:
            return self._asked(theta)[1]
        return self._body.point(self._parameters(theta)[0])

    def on_both(self, theta: float) -> tuple[Point, Point]:
        """The contact in the ground's frame, and in the body's [m]."""
        if self._parameters is None or self._body is None or self._ground is None:
            return self._asked(theta)
        p, q = self._parameters(theta)
        if q is None:
            q = self._rolling.ground_arc + (self._rolling.body_arc - self._body.arc(p))
        return self._ground.point(q), self._body.point(p)

    def _asked(self, theta: float) -> tuple[Point, Point]:
        contact = self._rolling.contact(theta)
        cosine, sine = cos(theta), sin(theta)
        x, y = (-float(value) for value in contact.arm)
        return (float(contact.point[0]), float(contact.point[1])), (cosine * x + sine * y, cosine * y - sine * x)

    def _on_a_line(self, theta: float) -> tuple[float, float | None]:
        """The body's parameter, by its angle; that of the line, the arc, is left to who needs it."""
        body: Any = self._body
        return body.parameter_at(self._start_angles[0] - (theta - self._rolling.theta)), None

    def _on_a_bend(self, theta: float) -> tuple[float, float]:
        """Both parameters, by Newton from the last contact: the arcs' sum is kept, the angles' difference is theta."""
        body: Any = self._body
        ground: Any = self._ground
        rolling = self._rolling
        last, p, q = self._last
        total, turned = rolling.ground_arc + rolling.body_arc, theta - rolling.theta
        body_start, ground_start = self._start_angles
        miss_arc, miss_angle = 0.0, last - theta
        close = False
        for _ in range(20):
            body_bend, ground_bend = body.curvature(p), ground.curvature(q)
            bend = body_bend + ground_bend
            if not bend > 0:
                break
            p -= (ground_bend * miss_arc - miss_angle) / (bend * body.speed(p))
            q -= (body_bend * miss_arc + miss_angle) / (bend * ground.speed(q))
            if close:
                self._last = (theta, p, q)
                return p, q
            miss_arc = body.arc(p) + ground.arc(q) - total
            miss_angle = (ground.angle(q) - ground_start) - (body.angle(p) - body_start) - turned
            # Quadratic: from here the next correction leaves nothing but rounding.
            close = abs(miss_arc) * bend < 1e-9 and abs(miss_angle) < 1e-9
        rolling.contact(theta)  # says where and why, if it is the pair's fault
        raise InvalidMechanism(f"rolling: no contact was found at theta = {theta!r} rad from that at {last!r} rad")
