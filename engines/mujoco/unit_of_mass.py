"""A mechanism whose masses are counted in a unit of its own, so that MuJoCo takes how far its rows give way.

A regularisation below mjMINVAL (1e-15) is not taken, and it has a unit: that of an inverse mass.
"""

from __future__ import annotations

import math
from dataclasses import replace

from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.mechanism import Mechanism


def unit_of_mass(mechanism: Mechanism) -> float:
    """About the mechanism's mass [kg]: a power of two, so that no number is rounded for it."""
    return 2.0 ** round(math.log2(sum(body.mass for body in mechanism.bodies)))


def lighter(mechanism: Mechanism, unit: float) -> Mechanism:
    """The mechanism with its masses in this unit [kg]: it moves alike, and all its forces are smaller."""
    bodies = [replace(body, mass=body.mass / unit, inertia=body.inertia / unit) for body in mechanism.bodies]
    return replace(mechanism, bodies=tuple(bodies), forces=tuple(_weaker(force, unit) for force in mechanism.forces))


def _weaker(force: ForceElement, unit: float) -> ForceElement:
    """The same element where masses are counted in this unit [kg]."""
    match force:
        case Spring() | TorsionSpring():
            return replace(force, stiffness=force.stiffness / unit)
        case Damper() | TorsionDamper():
            return replace(force, damping=force.damping / unit)
        case Torque():
            return replace(force, torque=force.torque / unit)
        case Force():
            return replace(force, force=(force.force[0] / unit, force.force[1] / unit))
