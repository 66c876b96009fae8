"""Properties of a motion that follow from joints, loads and initial state, and that determine convergence orders."""

from __future__ import annotations

from reference.checks import validated
from reference.joints import Drive, Pin
from reference.mechanism import Mechanism

FORCES_COST = 150e-6  # CPU time [s] of the force elements in numpy, at known poses and twists


@validated
def starts_at_rest(mechanism: Mechanism) -> bool:
    return not mechanism.twist.any()


@validated
def is_prescribed(mechanism: Mechanism) -> bool:
    """Whether joints and drives determine all poses, so that forces have no effect on the motion.

    With a skate, only the velocities may be determined, and poses follow by integration.
    """
    return mechanism.degrees_of_freedom()[0] == 0


@validated
def turns_steadily(mechanism: Mechanism) -> bool:
    """Whether rates are constant: all joints are pins and drives to the ground, without gravity or force elements."""
    grounded = all(isinstance(joint, Pin | Drive) and None in (joint.first, joint.second) for joint in mechanism.joints)
    return grounded and not any(mechanism.gravity) and not mechanism.forces


@validated
def over_three(mechanism: Mechanism) -> float:
    """The cost of a step relative to a step of three bodies: the number of bodies divided by three, at least 1."""
    return max(1.0, len(mechanism.bodies) / 3)
