"""A prescribed rotation in MuJoCo, which has no joint for it: a tree coordinate that turns at a given rate.

Where the rotation is a sum of several coordinates, a fixed tendon adds them up, less the angle of a clock: a wheel of
its own that turns at the rate and that nothing can accelerate. An equality holds the tendon at its length, so the drive
is as soft as a loop is. The sum's coefficients are constant: MuJoCo's tendon equalities, which have no velocity term,
need none here.

`DriveBy` names what keeps the rate:

- "inertia": nothing can accelerate the coordinate, because its armature is many times the mechanism's own inertia.
- "servo": a velocity servo drives it.
- "overwrite": its position and velocity are overwritten after every step (`engines.mujoco.running`). The solver still
  takes the coordinate as one that forces accelerate, so it misjudges the forces in the loop. Measured on the driven
  four-bar linkage with steps of 1e-3 and 1e-4 s: 0.14 rad and 0.14 rad with the loop as shipped, 1.6e-2 rad and 1.5e-4
  rad with the stiff loop of *tuned* (held by a test in `tests/engines/test_mujoco.py`).
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building
from engines.tree import Tree
from reference.joints import Drive
from reference.mechanism import Mechanism

DriveBy = Literal["inertia", "servo", "overwrite"]


@dataclass(frozen=True)
class DrivenCoordinate:
    """A tree coordinate that turns at a prescribed rate [rad/s]."""

    column: int
    rate: float


def driven_coordinates(tree: Tree, drives: Sequence[Drive]) -> tuple[DrivenCoordinate, ...]:
    """What each drive turns, of those that turn one coordinate. Raises Unsupported where two turn the same one."""
    driven: list[DrivenCoordinate] = []
    for drive in drives:
        ((column, sign),) = tree.turning(drive.first, drive.second).items()
        if column in [other.column for other in driven]:
            raise Unsupported(f"drive {drive.name!r} turns a joint that another drive turns already")
        driven.append(DrivenCoordinate(column, sign * drive.turning_rate))
    return tuple(driven)


def add_geared_drives(building: Building, drives: Sequence[Drive], by: DriveBy, armature: float) -> tuple[str, ...]:
    """A tendon for each drive over several coordinates; the names of the clocks' joints. Raises Unsupported."""
    clocks = []
    for drive in drives:
        signs = building.tree.turning(drive.first, drive.second)
        if by != "inertia" or not signs:
            first, second = (repr(name) if name else "the ground" for name in (drive.first, drive.second))
            what = "a sum of coordinates" if signs else "no coordinate"
            raise Unsupported(
                f"drive {drive.name!r}: the rotation of {second} against {first} is {what} of MuJoCo's tree here; "
                + (f"{by!r} drives single ones, take 'inertia'" if signs else "nothing can drive it")
            )
        name = f"drive {drive.name}"
        tendon = building.add_sum(name, signs)
        if drive.turning_rate:
            mass = sum(body.mass for body in building.mechanism.bodies)
            inertia = _inertia_scale(building.mechanism)
            clock = building.spec.worldbody.add_body(
                name=name, ipos=[0.0, 0.0, 0.0], mass=mass, inertia=[inertia] * 3, explicitinertial=True
            )
            hinge = mujoco.mjtJoint.mjJNT_HINGE
            clock.add_joint(name=name, type=hinge, axis=[0.0, 0.0, 1.0], armature=armature * inertia)
            tendon.wrap_joint(name, -1.0)
            building.start_rates[name] = drive.turning_rate
            clocks.append(name)
        building.hold_tendon(name)
    return tuple(clocks)


def add_drives(
    spec: Any, mechanism: Mechanism, driven: Sequence[DrivenCoordinate], by: DriveBy, armature: float, servo_gain: float
) -> None:
    """Give each driven coordinate its armature [times the mechanism's inertia] or its servo [N m s/rad]."""
    for one in driven:
        name = f"coordinate {one.column}"
        if by == "inertia":
            spec.joint(name).armature = armature * _inertia_scale(mechanism)
        if by == "servo":
            spec.add_actuator(target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT).set_to_velocity(servo_gain)


def _inertia_scale(mechanism: Mechanism) -> float:
    """About the largest inertia that a joint of the mechanism can feel [kg m^2]."""
    return sum(body.inertia + body.mass * mechanism.length_scale**2 for body in mechanism.bodies)
