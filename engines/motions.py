"""Properties of a motion that follow from joints, loads and initial state, and that determine convergence orders."""

from __future__ import annotations

from engines.capability import Unsupported
from reference.checks import validated
from reference.joints import Drive, Pin, Slot
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


def motors_of(mechanism: Mechanism, engine: str) -> dict[str, tuple[Drive, float]]:
    """The drive and the sign of its rate, by the name of the pin or slot between the same two bodies.

    Raises Unsupported for a drive without a pin or slot, and for a second drive.
    """
    drives: dict[frozenset[str | None], Drive] = {}
    for joint in mechanism.joints:
        if isinstance(joint, Drive) and drives.setdefault(frozenset((joint.first, joint.second)), joint) is not joint:
            raise Unsupported(f"drive {joint.name!r}: a joint of {engine} has one motor, and this is the second drive")
    motors: dict[str, tuple[Drive, float]] = {}
    for joint in mechanism.joints:
        if isinstance(joint, Pin | Slot) and (drive := drives.pop(frozenset((joint.first, joint.second)), None)):
            motors[joint.name] = drive, 1.0 if drive.second == joint.second else -1.0
    for drive in drives.values():
        raise Unsupported(f"drive {drive.name!r}: a motor of {engine} belongs to a pin or slot of the same two bodies")
    return motors


@validated
def over_three(mechanism: Mechanism) -> float:
    """The cost of a step relative to a step of three bodies: the number of bodies divided by three, at least 1."""
    return max(1.0, len(mechanism.bodies) / 3)
