"""What kind of motion a mechanism makes, by its joints, loads and start alone: orders of methods depend on it."""

from __future__ import annotations

from reference.checks import validated
from reference.joints import Drive, Pin
from reference.mechanism import Mechanism


@validated
def starts_at_rest(mechanism: Mechanism) -> bool:
    """Whether no body moves at t = 0."""
    return not mechanism.twist.any()


@validated
def is_prescribed(mechanism: Mechanism) -> bool:
    """Whether joints and drives leave no pose free, so that forces have no say, and nothing is left to be integrated.

    With a skate velocities may be prescribed, and poses not: they are what the integrator makes of the velocities.
    """
    return mechanism.degrees_of_freedom()[0] == 0


@validated
def turns_steadily(mechanism: Mechanism) -> bool:
    """Whether nothing changes any body's rate: no gravity, no force, and no joint but pins and drives to the ground."""
    grounded = all(isinstance(joint, Pin | Drive) and None in (joint.first, joint.second) for joint in mechanism.joints)
    return grounded and not any(mechanism.gravity) and not mechanism.forces


@validated
def over_three(mechanism: Mechanism) -> float:
    """Bodies in threes, at least one: what the cost of a step with three bodies is multiplied by."""
    return max(1.0, len(mechanism.bodies) / 3)
