"""What stands for a Slot in pymunk: a groove joint where it is exact, and a link across the line elsewhere.

- "exact": a `GrooveJoint` if the groove is in a body of known motion and its anchor at the centre of mass of the second
  body, or that body can't turn: then pushing along the normal moves the anchor along the normal. Else a `Link`.
- "groove": a `GrooveJoint` wherever the point is, as a user would. Off the centre of mass of a body that turns, its
  impulse is not the one that stops the motion across the groove, at any step, unless the arm from the centre of mass to
  the point lies along or across the groove; `tests/engines/test_pymunk_sweeps.py` measures it. It solves both
  directions and keeps the part along the normal (applyImpulse and grooveConstrain in Chipmunk's cpGrooveJoint.c), which
  is the right impulse only if the normal is an eigenvector of the two bodies' 2 by 2 inverse mass at the anchor.

A `Link` is a pin joint from far along the line's normal, aimed anew before every step. A `PinJoint` keeps the distance
of two points, so its row is their relative velocity along the line between them. With one end at the point and the
other, in the first body, straight across the line from it, this is the row of a Slot or a Skate, whatever they join.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, isinf, sin
from typing import Literal

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import Constraint, GrooveJoint, PinJoint

from reference.joints import Skate, Slot, Vector

SlotConstruction = Literal["exact", "groove"]

# A groove ends, a slot does not: this many lengths of the mechanism from where the slide stands at the start. Rounding
# grows in proportion.
REACH = 1e3


def slide(
    joint: Slot,
    construction: SlotConstruction,
    first: pymunk.Body,
    second: pymunk.Body,
    first_point: Vector,
    second_point: Vector,
    length: float,
) -> tuple[list[Constraint], list[Callable[[float], None]]]:
    """Constraints and what to do before each step; points from the engine's origins, `length` [m] of the mechanism."""
    known = first.body_type != pymunk.Body.DYNAMIC
    if construction == "groove" or (known and groove_is_exact(second_point, turns=not isinf(second.moment))):
        cosine, sine, reach = cos(joint.line_angle), sin(joint.line_angle), REACH * length
        x, y = first.world_to_local(second.local_to_world(second_point))
        # A slide may stand farther away than the mechanism is long.
        along = cosine * (x - first_point[0]) + sine * (y - first_point[1])
        back, front = (
            (first_point[0] + place * cosine, first_point[1] + place * sine) for place in (along - reach, along + reach)
        )
        return [GrooveJoint(first, second, back, front, second_point)], []
    link = Link(joint, first, second, second_point, first_point, reach=length)
    return [link.constraint], [link]


def groove_is_exact(point: Vector, turns: bool) -> bool:
    """Whether every normal is an eigenvector of a body's inverse mass at this point; `turns`: a push can turn it."""
    return point == (0.0, 0.0) or not turns


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
        *,
        reach: float,
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
