"""Prescribed rotations in pymunk: a body of known motion if the ground drives it, a motor between two other bodies.

A body that the ground drives and is pinned to it (a crank) is kinematic and turns about its pin. Without a pin, its
moment of inertia is infinite: no impulse changes its rate, so its angle is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pymunk
from pymunk.constraints import SimpleMotor

from reference.joints import Drive, Pin, Vector
from reference.mechanism import Body, Mechanism


@dataclass(frozen=True)
class Crank:
    """A body that is pinned to the ground and driven by it."""

    pin: Pin
    drive: Drive

    @property
    def own_point(self) -> Vector:
        """The pin in the body's frame [m]."""
        return self.pin.first_point if self.pin.second is None else self.pin.second_point

    @property
    def ground_point(self) -> Vector:
        """The pin in the world [m]."""
        return self.pin.second_point if self.pin.second is None else self.pin.first_point


def find_cranks(mechanism: Mechanism) -> dict[str, Crank]:
    """The cranks by the body's name, each with its first pin and drive."""
    pins = _joints_to_ground(mechanism, Pin)
    return {name: Crank(pins[name], drive) for name, drive in find_turned(mechanism).items() if name in pins}


def find_turned(mechanism: Mechanism) -> dict[str, Drive]:
    """The first drive between the ground and each body, cranks included, by the body's name."""
    return _joints_to_ground(mechanism, Drive)


def _joints_to_ground(mechanism: Mechanism, kind: type[Any]) -> dict[str, Any]:
    """The first joint of a kind between each body and the ground, by the body's name."""
    joints: dict[str, Any] = {}
    for joint in mechanism.joints:
        if isinstance(joint, kind) and None in (joint.first, joint.second):
            joints.setdefault(str(joint.second if joint.first is None else joint.first), joint)
    return joints


def _rate(joint: Drive) -> float:
    """The rate of a body that the ground drives, in the world [rad/s]."""
    return joint.turning_rate if joint.first is None else -joint.turning_rate


def crank_body(crank: Crank, body: Body, unit: float) -> pymunk.Body:
    """A kinematic body whose origin is the pin, so that pin and angle are exact. `unit` [s] is the engine's second."""
    kinematic = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    kinematic.position, kinematic.angle = crank.ground_point, body.pose[2]
    kinematic.angular_velocity = _rate(crank.drive) * unit
    return kinematic


def turned_body(drive: Drive, body: Body, unit: float) -> pymunk.Body:
    """A body that impulses move but do not turn; the caller sets its position and velocity."""
    turned = pymunk.Body(body.mass, float("inf"))
    turned.angular_velocity = _rate(drive) * unit
    return turned


def motor(joint: Drive, first: pymunk.Body, second: pymunk.Body, unit: float) -> SimpleMotor:
    """A row for the relative rate alone: residuals of the iterations add up to a drift of the angle."""
    # Chipmunk drives omega_first - omega_second to the motor's rate (applyImpulse in its cpSimpleMotor.c).
    return SimpleMotor(first, second, -joint.turning_rate * unit)
