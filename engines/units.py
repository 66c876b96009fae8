"""A mechanism whose masses and times are counted in other units: it moves alike, and engines have other numbers."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import assert_never

from reference.forces import CoupledForce, Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive
from reference.mechanism import Mechanism


def power_of_two(value: float) -> float:
    """The nearest: a unit by which no number is rounded."""
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
    joints = [
        replace(joint, turning_rate=joint.turning_rate * time) if isinstance(joint, Drive) else joint
        for joint in mechanism.joints
    ]
    forces = tuple(_counted(force, mass, time) for force in mechanism.forces)
    return Mechanism(tuple(bodies), tuple(joints), (x * time**2, y * time**2), forces)


def _counted(force: ForceElement, mass: float, time: float) -> ForceElement:
    match force:
        case Spring() | TorsionSpring():
            return replace(force, stiffness=force.stiffness / mass * time**2)
        case Damper() | TorsionDamper():
            return replace(force, damping=force.damping / mass * time)
        case Torque():
            return replace(force, torque=force.torque / mass * time**2)
        case Force():
            x, y = force.force
            return replace(force, force=(x / mass * time**2, y / mass * time**2))
        case CoupledForce():
            return replace(
                force,
                force=force.force / mass * time**2,
                stiffness=force.stiffness / mass * time**2,
                damping=force.damping / mass * time,
            )
        case _:
            assert_never(force)
