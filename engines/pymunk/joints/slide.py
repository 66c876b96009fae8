"""What stands for a Slot and for a Skate in pymunk: groove joints, links across the line, or repairs of a velocity.

A slot, by `SlotConstruction`:

- "exact": a `GrooveJoint` if the groove is in a body of known motion and its anchor at the centre of mass of the second
  body, or that body can't turn: then pushing along the normal moves the anchor along the normal. Else a `Link`.
- "groove": a `GrooveJoint` wherever the point is, as a user would. Off the centre of mass of a body that turns, its
  impulse is not the one that stops the motion across the groove, at any step, unless the arm from the centre of mass to
  the point lies along or across the groove. It solves both directions and keeps the part along the normal (applyImpulse
  and grooveConstrain in Chipmunk's cpGrooveJoint.c), which is the right impulse only if the normal is an eigenvector of
  the two bodies' 2 by 2 inverse mass at the anchor.

A blade across a rigid body constrains the same motion wherever it touches along its axle, so every construction puts
it at the foot of the perpendicular from the centre of mass: there the arm is along the blade, and a groove's impulse is
the right one. By `SkateConstruction`:

- "centre": after each step the velocity of the centre of mass across the blade is set to zero. Wrong unless the blade
  is there: it is another body's motion.
- "point": after each step the whole velocity is shifted until the blade's point has no velocity across. Slip is zero to
  rounding, and the motion is wrong: a force at the blade turns the body too.
- "projection": the same by an impulse at the blade, with the body's inertia. First order.
- "groove": a `GrooveJoint` in the ground, aimed before each step where the blade will stand after the step's drift. The
  drift is explicit, so this is exact; the motion is of first order, and the slip rounding. On another body than the
  ground it is a `Link`. No friction makes a blade: contacts press in the plane, and a blade presses on nothing there.

A `Link` is a pin joint from far along the line's normal, aimed anew before every step. A `PinJoint` keeps the distance
of two points, so its row is their relative velocity along the line between them. With one end at the point and the
other, in the first body, straight across the line from it, this is the row of a Slot or a Skate, whatever they join.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, isinf, log2, sin
from typing import Literal

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import Constraint, GrooveJoint, PinJoint

from engines import Unsupported
from reference.joints import Skate, Slot, Vector

SlotConstruction = Literal["exact", "groove"]
SkateConstruction = Literal["centre", "point", "projection", "groove"]
Aim = Callable[[float], None]
Repair = Callable[[], None]

# A groove ends, a slot does not: this many lengths of the mechanism from where the slide stands at the start. Rounding
# grows in proportion.
REACH = 1e3
LINK_REACH = 10.0  # lengths of the mechanism: far against what a body turns in a step, near against its rounding


def slide(
    joint: Slot,
    construction: SlotConstruction,
    first: pymunk.Body,
    second: pymunk.Body,
    first_point: Vector,
    second_point: Vector,
    length: float,
) -> tuple[list[Constraint], list[Aim]]:
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


def blade(
    joint: Skate, construction: SkateConstruction, first: pymunk.Body, second: pymunk.Body, point: Vector, length: float
) -> tuple[list[Constraint], list[Aim], list[Repair]]:
    """Constraints, what to do before each step and what after it; raises Unsupported.

    `point` [m] is the blade's from the origin of the engine's second body, which is not the centre of mass of a crank;
    `length` [m] of the mechanism.
    """
    if construction == "groove" and joint.first is not None:
        link = Link(joint, first, second, point, reach=LINK_REACH * length)
        return [link.constraint], [link], []
    if joint.first is not None:
        raise Unsupported(f"joint {joint.name!r}: the construction {construction!r} knows a skate on the ground only")
    if construction == "groove":
        groove = AimedGroove(joint, first, second, length)
        return [groove.constraint], [groove], []
    return [], [], [Zeroed(joint, second, construction)]


def along_blade(joint: Skate) -> float:
    """Where the blade's axle line passes the centre of mass: metres ahead along the blade."""
    return joint.second_point[0] * cos(joint.angle) + joint.second_point[1] * sin(joint.angle)


class AimedGroove:
    """A groove in the ground under the blade, laid anew before every step."""

    def __init__(self, joint: Skate, ground: pymunk.Body, body: pymunk.Body, length: float) -> None:
        along = along_blade(joint)
        anchor = (along * cos(joint.angle), along * sin(joint.angle))
        self.constraint = GrooveJoint(ground, body, (-1.0, 0.0), (1.0, 0.0), anchor)
        self._pointer, self._body = self.constraint._constraint, body._body
        self._angle = joint.angle
        # Its ends [m]: the blade can't come near them in a step, as the groove is laid anew under it. A power of two,
        # so that it rounds alike in mechanisms of nearly the same size, and in those that differ by such a power.
        half = 2.0 ** (1 + round(log2(length))) + abs(along)
        self._back, self._front = along - half, along + half

    def __call__(self, ahead: float) -> None:
        x, y, angle = drifted(self._body, ahead)
        cosine, sine = cos(angle + self._angle), sin(angle + self._angle)
        back, front = self._back, self._front
        lib.cpGrooveJointSetGrooveA(self._pointer, (x + back * cosine, y + back * sine))
        lib.cpGrooveJointSetGrooveB(self._pointer, (x + front * cosine, y + front * sine))


class Zeroed:
    """The velocity across the blade set to zero after every step, with or without regard to the body's inertia."""

    def __init__(self, joint: Skate, body: pymunk.Body, construction: SkateConstruction) -> None:
        self._body, self._angle = body._body, joint.angle
        along = along_blade(joint)
        # What of `omega` counts as velocity across; velocity and rate given to the body for one m/s taken away.
        self._arm, self._push, self._spin = 0.0 if construction == "centre" else along, 1.0, 0.0
        if construction == "projection":
            effective = 1 / (1 / body.mass + along**2 / body.moment)
            self._push, self._spin = effective / body.mass, effective * along / body.moment

    def __call__(self) -> None:
        body = self._body
        angle, rate = lib.cpBodyGetAngle(body) + self._angle, lib.cpBodyGetAngularVelocity(body)
        velocity = lib.cpBodyGetVelocity(body)
        left_x, left_y = -sin(angle), cos(angle)
        across = velocity.x * left_x + velocity.y * left_y + self._arm * rate
        push = self._push * across
        lib.cpBodySetVelocity(body, (velocity.x - push * left_x, velocity.y - push * left_y))
        if self._spin:
            lib.cpBodySetAngularVelocity(body, rate - self._spin * across)
