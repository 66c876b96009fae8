"""Properties of a motion that follow from the joints, loads and start; convergence orders depend on them."""

from __future__ import annotations

from reference.checks import validated
from reference.joints import Drive, Pin
from reference.mechanism import Mechanism


@validated
def starts_at_rest(mechanism: Mechanism) -> bool:
    return not mechanism.twist.any()


@validated
def is_prescribed(mechanism: Mechanism) -> bool:
    """Whether joints and drives determine all poses, so that nothing is integrated and forces have no effect.

    With a skate, the velocities may be determined and the poses not: these follow by integration.
    """
    return mechanism.degrees_of_freedom()[0] == 0


@validated
def turns_steadily(mechanism: Mechanism) -> bool:
    """Whether all rates are constant: no gravity, no force, and no joint but pins and drives to the ground."""
    grounded = all(isinstance(joint, Pin | Drive) and None in (joint.first, joint.second) for joint in mechanism.joints)
    return grounded and not any(mechanism.gravity) and not mechanism.forces


@validated
def over_three(mechanism: Mechanism) -> float:
    """The number of bodies divided by three, at least 1: the factor on the cost of a step with three bodies."""
    return max(1.0, len(mechanism.bodies) / 3)
