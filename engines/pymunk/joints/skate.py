"""What can stand for a Skate in pymunk, which has none: the row at the blade, by an engine's joint or by hand.

A blade across a rigid body constrains the same motion wherever it touches along its axle, so every construction puts
it at the foot of the perpendicular from the centre of mass: there the arm is along the blade, and a `GrooveJoint`'s
impulse is the right one (see `engines.pymunk.joints.slot`).

`SkateConstruction` names them:

- "centre": after each step the velocity of the centre of mass across the blade is set to zero. Wrong unless the blade
  is there: it is another body's motion.
- "point": after each step the whole velocity is shifted until the blade's point has no velocity across. Slip is zero to
  rounding, and the motion is wrong: a force at the blade turns the body too.
- "projection": the same by an impulse at the blade, with the body's inertia. First order.
- "groove": a `GrooveJoint` in the ground, aimed before each step where the blade will stand after the step's drift. The
  drift is explicit, so this is exact; the motion is of first order, and the slip rounding. On another body than the
  ground it is a `Link`.

No friction makes a blade: pymunk's contacts press in the plane, and a blade seen from above presses on nothing there.
"""

from __future__ import annotations

from collections.abc import Callable
from math import cos, log2, sin
from typing import Literal

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import Constraint, GrooveJoint

from engines import Unsupported
from engines.pymunk.joints.slot import Link, drifted
from reference.joints import Skate, Vector

SkateConstruction = Literal["centre", "point", "projection", "groove"]

LINK_REACH = 10.0  # lengths of the mechanism: far against what a body turns in a step, near against its rounding

Aim = Callable[[float], None]
Repair = Callable[[], None]


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
