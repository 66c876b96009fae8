"""One row across a line, in pymunk: a pin joint from far along the line's normal, aimed anew before every step.

A `PinJoint` keeps the distance of two points, so its row is their relative velocity along the line between them. With
one end at the point and the other, in the first body, straight across the line from it, this is the row of a Slot or a
Skate, whatever bodies they join. A `GrooveJoint` is not: it solves both directions and keeps the part along the normal
(applyImpulse and grooveConstrain in Chipmunk's cpGrooveJoint.c), which is the right impulse only if the normal is an
eigenvector of the two bodies' 2 by 2 inverse mass at the anchor.
"""

from __future__ import annotations

from math import cos, sin

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import PinJoint

from reference.joints import Skate, Slot, Vector


class Link:
    """The pin joint of one Slot or Skate between any two bodies; `reach` [m] is its length.

    Points are from the origins of the engine's bodies.
    """

    def __init__(
        self,
        joint: Slot | Skate,
        first: pymunk.Body,
        second: pymunk.Body,
        second_point: Vector,
        first_point: Vector = (0.0, 0.0),
        reach: float = 10.0,
    ) -> None:
        self.constraint = PinJoint(first, second, (reach, reach), second_point)
        self.constraint.distance = reach
        self._bodies = (first._body, second._body)
        self._point, self._line_point, self._reach = second_point, first_point, reach
        # A slot's line turns with the first body and shows a gap; a blade turns with the second and has none.
        self._slot = isinstance(joint, Slot)
        self._angle = joint.line_angle if isinstance(joint, Slot) else joint.angle

    def __call__(self, ahead: float) -> None:
        """Aim for where the bodies will be after a drift of `ahead` [s, or the model's unit]."""
        (x1, y1, angle1), (x2, y2, angle2) = (drifted(body, ahead) for body in self._bodies)
        cosine, sine = cos(angle2), sin(angle2)
        x, y = self._point
        x, y = x2 - x1 + cosine * x - sine * y, y2 - y1 + sine * x + cosine * y
        cosine, sine = cos(angle1), sin(angle1)
        x, y = cosine * x + sine * y, cosine * y - sine * x  # the point in the first body
        line = self._angle if self._slot else self._angle + angle2 - angle1
        left_x, left_y = -sin(line), cos(line)
        reach = self._reach
        if self._slot:
            reach -= left_x * (x - self._line_point[0]) + left_y * (y - self._line_point[1])
        lib.cpPinJointSetAnchorA(self.constraint._constraint, (x + reach * left_x, y + reach * left_y))


def drifted(body: object, ahead: float) -> tuple[float, float, float]:
    """Pose of a body (its C pointer) after the drift of its next step: exactly where the engine will put it."""
    place, velocity = lib.cpBodyGetPosition(body), lib.cpBodyGetVelocity(body)
    angle = lib.cpBodyGetAngle(body) + lib.cpBodyGetAngularVelocity(body) * ahead
    return place.x + velocity.x * ahead, place.y + velocity.y * ahead, angle
