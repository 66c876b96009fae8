"""Constructions of a Slot and a Skate in pymunk: groove joints, pin joints across the line, corrected velocities.

A slot, by `SlotConstruction`:

- "exact": a `GrooveJoint` if the groove is in a body of known motion and the anchor is the centre of mass of the second
  body, or that body cannot turn: only then does an impulse along the normal move the anchor along the normal. Otherwise
  a `MovedPinJoint`.
- "groove": always a `GrooveJoint`, as a user would build it. Off the centre of mass of a body that turns, its impulse
  does not stop the motion across the groove, at any step, unless the arm from the centre of mass to the point is along
  or across the groove. It solves for both directions and keeps the normal part (applyImpulse and grooveConstrain in
  Chipmunk's cpGrooveJoint.c), which is the right impulse only if the normal is an eigenvector of the two bodies' 2 by 2
  inverse mass at the anchor.

A blade constrains the same motion at every point of its axle, so all constructions place it at the foot of the
perpendicular from the centre of mass: there the arm is along the blade, and a groove's impulse is the right one. By
`SkateConstruction`:

- "centre": after each step, the velocity of the centre of mass across the blade is set to zero. This is wrong unless
  the blade is at the centre of mass: a force at the blade would turn the body.
- "point": after each step, the whole velocity is shifted until the blade's point has none across. The slip is zero to
  rounding, and the motion is wrong for the same reason.
- "projection": the same by an impulse at the blade, with the body's inertia. First order.
- "groove": a `GrooveJoint` in the ground, placed before each step at the pose after the step's drift. The drift is
  explicit, so the pose is exact; the motion is of first order, and the slip is rounding. On another body than the
  ground it is a `MovedPinJoint`. Contact with friction is no alternative: in the plane, nothing presses a blade on the
  ice.

A `MovedPinJoint` is a `PinJoint` that is placed before every step. It keeps the distance of two points, so its row is
their relative velocity along the line between them. One end is the point; the other is a point of the first body
straight across the line. So its row is that of a Slot or a Skate between any two bodies.
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
# Called with the length of the next drift [units of time] before each step; called after each step.
BeforeStep = Callable[[float], None]
AfterStep = Callable[[], None]

# Half the length of a groove, in the mechanism's length scale: a slot has no end. Rounding grows in proportion.
GROOVE_REACH = 1e3
# Length of a blade's pin joint, in the mechanism's length scale: long against the rotation in a step, and short enough
# for rounding.
LINK_REACH = 10.0


def build_slot(
    joint: Slot,
    construction: SlotConstruction,
    first: pymunk.Body,
    second: pymunk.Body,
    first_point: Vector,
    second_point: Vector,
    length: float,
) -> tuple[list[Constraint], list[BeforeStep]]:
    """The constraint and its update before each step. Points are from the engine's origins; `length` [m]: the scale."""
    is_prescribed = first.body_type != pymunk.Body.DYNAMIC
    if construction == "groove" or (is_prescribed and groove_is_exact(second_point, turns=not isinf(second.moment))):
        cosine, sine, reach = cos(joint.line_angle), sin(joint.line_angle), GROOVE_REACH * length
        x, y = first.world_to_local(second.local_to_world(second_point))
        # The groove's middle is at the second body, which may be farther away than the mechanism is long.
        along = cosine * (x - first_point[0]) + sine * (y - first_point[1])
        back, front = (
            (first_point[0] + end * cosine, first_point[1] + end * sine) for end in (along - reach, along + reach)
        )
        return [GrooveJoint(first, second, back, front, second_point)], []
    link = MovedPinJoint(joint, first, second, second_point, first_point, reach=length)
    return [link.constraint], [link]


def groove_is_exact(point: Vector, turns: bool) -> bool:
    """Whether every normal is an eigenvector of a body's inverse mass at a point; `turns`: impulses turn the body."""
    return point == (0.0, 0.0) or not turns


class MovedPinJoint:
    """The pin joint of one Slot or Skate; `reach` [m] is its length, points are from the engine's origins."""

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
        # A slot's line turns with the first body and has a gap; a blade turns with the second and has none.
        self._is_slot = isinstance(joint, Slot)
        self._angle = joint.line_angle if isinstance(joint, Slot) else joint.angle

    def __call__(self, ahead: float) -> None:
        """Place the joint for the poses after a drift of `ahead` [units of time]."""
        (x1, y1, angle1), (x2, y2, angle2) = (drifted(body, ahead) for body in self._bodies)
        cosine, sine = cos(angle2), sin(angle2)
        x, y = self._point
        x, y = x2 - x1 + cosine * x - sine * y, y2 - y1 + sine * x + cosine * y
        cosine, sine = cos(angle1), sin(angle1)
        x, y = cosine * x + sine * y, cosine * y - sine * x  # the point in the first body
        line = self._angle if self._is_slot else self._angle + angle2 - angle1
        left_x, left_y = -sin(line), cos(line)
        reach = self._reach
        if self._is_slot:
            reach -= left_x * (x - self._line_point[0]) + left_y * (y - self._line_point[1])
        lib.cpPinJointSetAnchorA(self.constraint._constraint, (x + reach * left_x, y + reach * left_y))


def drifted(body: object, ahead: float) -> tuple[float, float, float]:
    """The pose of a body (a C pointer) after the drift of its next step, exactly as the engine computes it."""
    position, velocity = lib.cpBodyGetPosition(body), lib.cpBodyGetVelocity(body)
    angle = lib.cpBodyGetAngle(body) + lib.cpBodyGetAngularVelocity(body) * ahead
    return position.x + velocity.x * ahead, position.y + velocity.y * ahead, angle


def build_skate(
    joint: Skate, construction: SkateConstruction, first: pymunk.Body, second: pymunk.Body, point: Vector, length: float
) -> tuple[list[Constraint], list[BeforeStep], list[AfterStep]]:
    """The constraints and their updates before and after each step; raises Unsupported.

    `point` [m] is the blade's from the origin of the engine's second body; `length` [m] is the mechanism's scale.
    """
    if construction == "groove" and joint.first is not None:
        link = MovedPinJoint(joint, first, second, point, reach=LINK_REACH * length)
        return [link.constraint], [link], []
    if joint.first is not None:
        raise Unsupported(
            f"joint {joint.name!r}: the construction {construction!r} needs a skate on the ground; this one is on "
            f"{joint.first!r}"
        )
    if construction == "groove":
        groove = AimedGroove(joint, first, second, length)
        return [groove.constraint], [groove], []
    return [], [], [Zeroed(joint, second, construction)]


def along_blade(joint: Skate) -> float:
    """The coordinate along the blade [m] of the axle line, from the centre of mass."""
    return joint.second_point[0] * cos(joint.angle) + joint.second_point[1] * sin(joint.angle)


class AimedGroove:
    """A groove in the ground under the blade, placed before every step."""

    def __init__(self, joint: Skate, ground: pymunk.Body, body: pymunk.Body, length: float) -> None:
        along = along_blade(joint)
        anchor = (along * cos(joint.angle), along * sin(joint.angle))
        self.constraint = GrooveJoint(ground, body, (-1.0, 0.0), (1.0, 0.0), anchor)
        self._pointer, self._body = self.constraint._constraint, body._body
        self._angle = joint.angle
        # Ends of the groove [m], out of reach within a step. With a power of two, rounding is equal for mechanisms of
        # nearly the same size, and for those whose sizes differ by such a power.
        half = 2.0 ** (1 + round(log2(length))) + abs(along)
        self._back, self._front = along - half, along + half

    def __call__(self, ahead: float) -> None:
        x, y, angle = drifted(self._body, ahead)
        cosine, sine = cos(angle + self._angle), sin(angle + self._angle)
        back, front = self._back, self._front
        lib.cpGrooveJointSetGrooveA(self._pointer, (x + back * cosine, y + back * sine))
        lib.cpGrooveJointSetGrooveB(self._pointer, (x + front * cosine, y + front * sine))


class Zeroed:
    """Sets the velocity across the blade to zero after every step, by its `SkateConstruction`."""

    def __init__(self, joint: Skate, body: pymunk.Body, construction: SkateConstruction) -> None:
        self._body, self._angle = body._body, joint.angle
        along = along_blade(joint)
        # Arm [m] of the measured point; changes of velocity and rate per m/s of velocity across.
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
