"""A prescribed rotation in MuJoCo, which has no joint for it: a tree coordinate that turns at a given rate.

`DriveBy` names what keeps the rate:

- "inertia": nothing can accelerate the coordinate, because its armature is many times the mechanism's own inertia.
- "servo": a velocity servo drives it.
- "overwrite": its position and velocity are overwritten after every step (`engines.mujoco.running`). The solver still
  takes the coordinate as one that forces accelerate, so it misjudges the forces in the loop. Measured on the driven
  four-bar linkage with steps of 1e-3 and 1e-4 s: 0.14 rad and 0.14 rad with the loop as shipped, 1.6e-2 rad and 1.5e-4
  rad with the stiff loop of *tuned* (held by a test in `tests/test_mujoco.py`).
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from engines import Unsupported
from engines.mujoco.tree import Tree
from reference.joints import Drive
from reference.mechanism import Mechanism

DriveBy = Literal["inertia", "servo", "overwrite"]


@dataclass(frozen=True)
class DrivenCoordinate:
    """A tree coordinate that turns at a prescribed rate [rad/s]."""

    column: int
    rate: float


def driven_coordinates(tree: Tree, drives: Sequence[Drive]) -> tuple[DrivenCoordinate, ...]:
    """What each drive turns. Raises Unsupported where no coordinate stands for it, or another drive has it already."""
    driven = tuple(_driven_coordinate(tree, joint) for joint in drives)
    for index, one in enumerate(driven):
        if one.column in [other.column for other in driven[:index]]:
            raise Unsupported(f"drive {drives[index].name!r} turns a joint that another drive turns already")
    return driven


def _driven_coordinate(tree: Tree, joint: Drive) -> DrivenCoordinate:
    found = tree.rotation_of(joint.first, joint.second)
    if found is None:
        first, second = (repr(name) if name else "the ground" for name in (joint.first, joint.second))
        raise Unsupported(
            f"drive {joint.name!r}: the rotation of {second} against {first} is no coordinate of MuJoCo's tree here, "
            "and only a coordinate can be driven"
        )
    column, sign = found
    return DrivenCoordinate(column, sign * joint.turning_rate)


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
