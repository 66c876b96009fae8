"""Constructions of a Slot and a Skate in pymunk, by groove joints, by pin joints, or by corrected velocities.

A slot is a `GrooveJoint` if its impulse is always correct, and otherwise a `MovedPinJoint`. Chipmunk solves for the
impulse of a groove in both directions and keeps the normal component (applyImpulse and grooveConstrain in
cpGrooveJoint.c). This impulse is correct only if the normal is an eigenvector of the 2 by 2 inverse mass matrix of both
bodies at the anchor. Otherwise motion across the groove remains at any step. The impulse is always correct if two
conditions are satisfied. The motion of the first body is prescribed. The anchor is the centre of mass of the second
body, or impulses cannot turn the second body.

`SkateConstruction` is the construction of a skate. A blade constrains the same motion at every point of its axle. All
constructions move the blade to the foot of the perpendicular from the centre of mass, where the impulse of a groove is
correct.

- "centre": after each step, our code sets the velocity of the centre of mass across the blade to zero, as users often
  do. The motion is wrong unless the blade is at the centre of mass, since a force at the blade also turns the body.
- "point": after each step, our code changes the velocity of the body so that the blade has no slip. The motion is
  wrong, since a force at the blade also turns the body.
- "projection": after each step, an impulse at the blade removes the slip. The motion has order 1.
- "groove": a `GrooveJoint` in the ground, which our code places before each step at the exact pose after the drift. The
  motion has order 1, and the slip is rounding. Between two moving bodies it is a `MovedPinJoint`.

A `MovedPinJoint` is a `PinJoint` that our code places before every step. The row of this joint is the relative velocity
of two anchors along the line between them. One anchor is the point of the joint. The other anchor is a point of the
first body, such that the line between the anchors is perpendicular to the slot or blade. The row is therefore correct
for a Slot or a Skate between any two bodies.
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

SkateConstruction = Literal["centre", "point", "projection", "groove"]
BeforeStep = Callable[[float], None]  # the argument is the duration of the next drift [units of time]
AfterStep = Callable[[], None]

# Half length of a groove relative to the length scale. A slot has no ends, but rounding grows with the length.
GROOVE_HALF_LENGTH = 1e3
# Length of the pin joint of a blade relative to the length scale. A long joint turns little in a step, but rounding is
# larger.
LINK_LENGTH = 10.0


def build_slot(
    joint: Slot,
    first: pymunk.Body,
    second: pymunk.Body,
    first_point: Vector,
    second_point: Vector,
    length: float,
) -> tuple[list[Constraint], list[BeforeStep]]:
    """The constraint of a slot, and its updates before each step.

    Both points [m] are relative to the origins of the pymunk bodies. `length` [m]: length scale of the mechanism.
    """
    is_prescribed = first.body_type != pymunk.Body.DYNAMIC
    if is_prescribed and groove_is_exact(second_point, turns=not isinf(second.moment)):
        cosine, sine, half_length = cos(joint.line_angle), sin(joint.line_angle), GROOVE_HALF_LENGTH * length
        x, y = first.world_to_local(second.local_to_world(second_point))
        # The middle of the groove is at the second body, which may be far from the first.
        along = cosine * (x - first_point[0]) + sine * (y - first_point[1])
        back, front = (
            (first_point[0] + end * cosine, first_point[1] + end * sine)
            for end in (along - half_length, along + half_length)
        )
        return [GrooveJoint(first, second, back, front, second_point)], []
    link = MovedPinJoint(joint, first, second, second_point, first_point, length=length)
    return [link.constraint], [link]


def groove_is_exact(point: Vector, turns: bool) -> bool:
    """Whether every normal is an eigenvector of a body's inverse mass matrix at a point.

    `turns`: whether impulses can turn the body.
    """
    return point == (0.0, 0.0) or not turns


class MovedPinJoint:
    def __init__(
        self,
        joint: Slot | Skate,
        first: pymunk.Body,
        second: pymunk.Body,
        second_point: Vector,
        first_point: Vector = (0.0, 0.0),
        *,
        length: float,
    ) -> None:
        self.constraint = PinJoint(first, second, (length, length), second_point)
        self.constraint.distance = length
        self._bodies = (first._body, second._body)
        self._point, self._line_point, self._length = second_point, first_point, length
        # The line of a slot turns with the first body. A blade turns with the second body, and has no gap.
        self._is_slot = isinstance(joint, Slot)
        self._angle = joint.line_angle if isinstance(joint, Slot) else joint.angle

    def __call__(self, ahead: float) -> None:
        (x1, y1, angle1), (x2, y2, angle2) = (drifted(body, ahead) for body in self._bodies)
        cosine, sine = cos(angle2), sin(angle2)
        x, y = self._point
        x, y = x2 - x1 + cosine * x - sine * y, y2 - y1 + sine * x + cosine * y
        cosine, sine = cos(angle1), sin(angle1)
        x, y = cosine * x + sine * y, cosine * y - sine * x  # the point in the first body
        line = self._angle if self._is_slot else self._angle + angle2 - angle1
        left_x, left_y = -sin(line), cos(line)
        arm = self._length
        if self._is_slot:
            arm -= left_x * (x - self._line_point[0]) + left_y * (y - self._line_point[1])
        lib.cpPinJointSetAnchorA(self.constraint._constraint, (x + arm * left_x, y + arm * left_y))


def drifted(body: object, ahead: float) -> tuple[float, float, float]:
    """The pose of a body (a C pointer) after the next drift, with the rounding of the engine."""
    position, velocity = lib.cpBodyGetPosition(body), lib.cpBodyGetVelocity(body)
    angle = lib.cpBodyGetAngle(body) + lib.cpBodyGetAngularVelocity(body) * ahead
    return position.x + velocity.x * ahead, position.y + velocity.y * ahead, angle


def build_skate(
    joint: Skate, construction: SkateConstruction, first: pymunk.Body, second: pymunk.Body, point: Vector, length: float
) -> tuple[list[Constraint], list[BeforeStep], list[AfterStep]]:
    """The constraints of a skate, and updates before and after each step; raises Unsupported.

    `point` [m]: point of the blade relative to the origin of the second pymunk body. `length` [m]: length scale of the
    mechanism.
    """
    if construction == "groove" and joint.first is not None:
        link = MovedPinJoint(joint, first, second, point, length=LINK_LENGTH * length)
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
    """The distance [m] from the centre of mass to the skate's point, along the blade."""
    return joint.second_point[0] * cos(joint.angle) + joint.second_point[1] * sin(joint.angle)


class AimedGroove:
    def __init__(self, joint: Skate, ground: pymunk.Body, body: pymunk.Body, length: float) -> None:
        along = along_blade(joint)
        anchor = (along * cos(joint.angle), along * sin(joint.angle))
        self.constraint = GrooveJoint(ground, body, (-1.0, 0.0), (1.0, 0.0), anchor)
        self._pointer, self._body = self.constraint._constraint, body._body
        self._angle = joint.angle
        # The body cannot reach the ends [m] of the groove in a step. The length is a power of two, so that similar
        # mechanisms of nearly equal size have the same rounding.
        half = 2.0 ** (1 + round(log2(length))) + abs(along)
        self._back, self._front = along - half, along + half

    def __call__(self, ahead: float) -> None:
        x, y, angle = drifted(self._body, ahead)
        cosine, sine = cos(angle + self._angle), sin(angle + self._angle)
        back, front = self._back, self._front
        lib.cpGrooveJointSetGrooveA(self._pointer, (x + back * cosine, y + back * sine))
        lib.cpGrooveJointSetGrooveB(self._pointer, (x + front * cosine, y + front * sine))


class Zeroed:
    def __init__(self, joint: Skate, body: pymunk.Body, construction: SkateConstruction) -> None:
        self._body, self._angle = body._body, joint.angle
        along = along_blade(joint)
        # _arm [m] leads to the point without slip. _push and _spin are changes of velocity and rate per m/s of slip.
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
