"""A prescribed rotation in pymunk: a body of known motion where the ground drives it, or else a motor between two.

Against the ground, a driven body that is also pinned to it is kinematic and turns about its pin; any other has an
infinite moment of inertia: no impulse changes its rate, so it keeps its angle, or turns, exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import pymunk
from pymunk.constraints import SimpleMotor

from reference.checks import validated
from reference.joints import Drive, Pin, Vector
from reference.mechanism import Body, Mechanism


@dataclass(frozen=True)
class Crank:
    """A body pinned to the ground and driven against it: its motion is known, so no constraint has to find it."""

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


@validated
def find_cranks(mechanism: Mechanism) -> dict[str, Crank]:
    """The bodies that are pinned to the ground and driven against it, by name; each by its first pin and drive."""
    pins = _grounded(mechanism, Pin)
    return {name: Crank(pins[name], drive) for name, drive in _grounded(mechanism, Drive).items() if name in pins}


@validated
def find_turned(mechanism: Mechanism) -> dict[str, Drive]:
    """The first drive against the ground of every body that has one, cranks or not, by the body's name."""
    return _grounded(mechanism, Drive)


def _grounded(mechanism: Mechanism, kind: type[Any]) -> dict[str, Any]:
    """The first joint of a kind between each body and the ground, by the body's name."""
    found: dict[str, Any] = {}
    for joint in mechanism.joints:
        if isinstance(joint, kind) and None in (joint.first, joint.second):
            found.setdefault(str(joint.second if joint.first is None else joint.first), joint)
    return found


def _rate(joint: Drive) -> float:
    """Of a body driven against the ground, in the world [rad/s]."""
    return joint.turning_rate if joint.first is None else -joint.turning_rate


def crank_body(crank: Crank, body: Body, unit: float) -> pymunk.Body:
    """A kinematic body whose origin is the pin: its drift keeps the pin in place and the angle linear, exactly.

    `unit` [s] is the engine's unit of time.
    """
    kinematic = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
    kinematic.position, kinematic.angle = crank.ground_point, body.pose[2]
    kinematic.angular_velocity = _rate(crank.drive) * unit
    return kinematic


def turned_body(drive: Drive, body: Body, unit: float) -> pymunk.Body:
    """A body that impulses move and cannot turn; its place and velocity are still to be set."""
    turned = pymunk.Body(body.mass, float("inf"))
    turned.angular_velocity = _rate(drive) * unit
    return turned


def motor(joint: Drive, first: pymunk.Body, second: pymunk.Body, unit: float) -> SimpleMotor:
    """One velocity row: it holds the rate and knows no angle, so what the sweeps leave adds up as a drift."""
    # Chipmunk drives omega_first - omega_second to the motor's rate (applyImpulse in its cpSimpleMotor.c).
    return SimpleMotor(first, second, -joint.turning_rate * unit)
