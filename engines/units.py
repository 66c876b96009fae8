"""A mechanism in other units of mass and time. The motion is the same, but the engine computes with other numbers."""

from __future__ import annotations

import math
from dataclasses import replace

from reference.mechanism import Mechanism


def power_of_two(value: float) -> float:
    """The power of two nearest to a value. Such a unit causes no rounding errors."""
    return 2.0 ** round(math.log2(value))


def counted_in(mechanism: Mechanism, mass: float = 1.0, time: float = 1.0) -> Mechanism:
    """The mechanism with masses in units of `mass` [kg] and times in units of `time` [s]; lengths are in metres."""
    x, y = mechanism.gravity
    bodies = [
        replace(
            body,
            mass=body.mass / mass,
            inertia=body.inertia / mass,
            twist=(body.twist[0] * time, body.twist[1] * time, body.twist[2] * time),
        )
        for body in mechanism.bodies
    ]
    joints = tuple(joint.in_units(mass, time) for joint in mechanism.joints)
    forces = tuple(force.in_units(mass, time) for force in mechanism.forces)
    return Mechanism(tuple(bodies), joints, (x * time**2, y * time**2), forces)
