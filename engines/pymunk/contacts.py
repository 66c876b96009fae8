"""Where two rolling curves touch, as a function of the rotation, in plain floats: a step can't wait for arrays.

`reference.rolling` knows the contact for arrays of rotations; one call of it takes longer than a hundred steps of the
engine. Here are the same closed forms for one rotation: straight or round ground under round, elliptic and cam-shaped
bodies. Any other pair asks the reference.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, sin
from typing import Any

from engines.pymunk.boundaries import Point, boundary_of, unplaced
from reference.curves.circles_lines import Line
from reference.rolling.kinematics import Rolling
from reference.validation import InvalidMechanism


class Touch:
    """The contact of one rolling pair; rotations [rad] are those of the body against the ground's, unwrapped.

    Both calls raise InvalidMechanism where the pair can't roll, and ValueError for a rotation that is not finite.
    """

    def __init__(self, rolling: Rolling) -> None:
        self._rolling = rolling
        self._ground, self._body = boundary_of(rolling.ground), boundary_of(rolling.body)
        straight = isinstance(unplaced(rolling.ground), Line)
        bends = not isinstance(unplaced(rolling.body), Line)
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
