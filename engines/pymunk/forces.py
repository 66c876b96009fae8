"""Force elements in pymunk: its damped springs, of which only one part acts, and forces set anew before every step.

A spring is a kick at the pose after the drift, like gravity, and costs no order. A damper takes part in the sweeps: it
shrinks the velocity that they have reached so far by exp(-damping dt / mass felt), after the kicks of the same step and
not half before and half after them. That is of first order. Chipmunk forgets a body's force and torque in every step,
and adds them after the drift, so they are set for the pose that the drift will lead to, which is known exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, sin

import pymunk
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import Constraint, DampedRotarySpring, DampedSpring

from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Vector

Own = Callable[[str | None, Vector], Vector]  # a point of a body [m], from the engine's origin


def spring(element: ForceElement, first: pymunk.Body, second: pymunk.Body, own: Own, unit: float) -> Constraint | None:
    """pymunk's spring for an element, in the `unit` [s] of time; None for one that is applied, or that moves nothing.

    A body whose motion is prescribed feels no force, and a spring between two of those would divide by zero.
    """
    match element:
        case Spring() | Damper() if pymunk.Body.DYNAMIC in (first.body_type, second.body_type):
            anchors = own(element.first, element.first_point), own(element.second, element.second_point)
            if isinstance(element, Spring):
                return DampedSpring(first, second, *anchors, element.rest_length, element.stiffness * unit * unit, 0.0)
            return DampedSpring(first, second, *anchors, 0.0, 0.0, element.damping * unit)
        case TorsionSpring() | TorsionDamper() if _turns(first) or _turns(second):
            # Chipmunk's relative angle is that of the first against the second (cpDampedRotarySpring.c).
            if isinstance(element, TorsionSpring):
                return DampedRotarySpring(first, second, -element.rest_angle, element.stiffness * unit * unit, 0.0)
            return DampedRotarySpring(first, second, 0.0, 0.0, element.damping * unit)
    return None


def _turns(body: pymunk.Body) -> bool:
    """Whether a torque would change a body's rate."""
    return body.body_type == pymunk.Body.DYNAMIC and body.moment < float("inf")


def applied(
    forces: Sequence[ForceElement], bodies: dict[str, pymunk.Body], own: Own, unit: float
) -> list[Callable[[float], None]]:
    """What sets constant forces and torques before a step: one function a body, none for a body without."""
    points: dict[str, list[tuple[Vector, Vector]]] = {}
    torques: dict[str, float] = {}
    for element in forces:
        match element:
            case Force():
                x, y = element.force
                own_point = own(element.second, element.second_point)
                points.setdefault(element.second, []).append((own_point, (x * unit * unit, y * unit * unit)))
            case Torque():
                for name, sign in ((element.first, -1.0), (element.second, 1.0)):
                    if name is not None:
                        torques[name] = torques.get(name, 0.0) + sign * element.torque * unit * unit
            case _:
                pass
    return [
        _pushing(bodies[name], points.get(name, []), torques.get(name, 0.0))
        for name in dict.fromkeys((*points, *torques))
        if bodies[name].body_type == pymunk.Body.DYNAMIC
    ]


def _pushing(body: pymunk.Body, points: list[tuple[Vector, Vector]], torque: float) -> Callable[[float], None]:
    pointer = body._body
    x, y = sum(force[0] for _, force in points), sum(force[1] for _, force in points)
    # The moment of all forces at the angle 0, and a quarter of a turn later.
    across = sum(point[0] * force[1] - point[1] * force[0] for point, force in points)
    along = -sum(point[0] * force[0] + point[1] * force[1] for point, force in points)

    def push(ahead: float) -> None:
        angle = lib.cpBodyGetAngle(pointer) + lib.cpBodyGetAngularVelocity(pointer) * ahead
        lib.cpBodySetForce(pointer, (x, y))
        lib.cpBodySetTorque(pointer, torque + cos(angle) * across + sin(angle) * along)

    return push
