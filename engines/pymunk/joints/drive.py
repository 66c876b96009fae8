"""Prescribed rotations in pymunk: bodies that the ground drives, and motors between two other bodies.

A crank is a body with a drive and a pin to the ground. In pymunk a crank is a kinematic body that turns about the pin.
A driven body without a pin to the ground has an infinite moment of inertia.
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
    pin: Pin
    drive: Drive

    @property
    def own_point(self) -> Vector:
        return self.pin.first_point if self.pin.second is None else self.pin.second_point

    @property
    def ground_point(self) -> Vector:
        return self.pin.second_point if self.pin.second is None else self.pin.first_point


def find_cranks(mechanism: Mechanism) -> dict[str, Crank]:
    pins = _joints_to_ground(mechanism, Pin)
    return {name: Crank(pins[name], drive) for name, drive in find_turned(mechanism).items() if name in pins}


def find_turned(mechanism: Mechanism) -> dict[str, Drive]:
    """The first drive between the ground and a body, by the body's name; includes cranks."""
    return _joints_to_ground(mechanism, Drive)


def _joints_to_ground(mechanism: Mechanism, kind: type[Any]) -> dict[str, Any]:
    joints: dict[str, Any] = {}
    for joint in mechanism.joints:
        if isinstance(joint, kind) and None in (joint.first, joint.second):
            joints.setdefault(str(joint.second if joint.first is None else joint.first), joint)
    return joints


def _rate(joint: Drive) -> float:
    return joint.turning_rate if joint.first is None else -joint.turning_rate


def crank_body(crank: Crank, body: Body, unit: float) -> pymunk.Body:
    """A kinematic body whose origin is at the pin, so that pin and angle are exact; `unit` is the unit of time [s]."""
    kinematic = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    kinematic.position, kinematic.angle = crank.ground_point, body.pose[2]
    kinematic.angular_velocity = _rate(crank.drive) * unit
    return kinematic


def turned_body(drive: Drive, body: Body, unit: float) -> pymunk.Body:
    """A body that impulses cannot turn; the caller sets position, angle and velocity."""
    turned = pymunk.Body(body.mass, float("inf"))
    turned.angular_velocity = _rate(drive) * unit
    return turned


def motor(joint: Drive, first: pymunk.Body, second: pymunk.Body, unit: float) -> SimpleMotor:
    """A motor, which keeps the relative rate; the relative angle drifts by the sum of the residuals."""
    # In Chipmunk omega_first - omega_second becomes the motor's rate (applyImpulse in cpSimpleMotor.c).
    return SimpleMotor(first, second, -joint.turning_rate * unit)
