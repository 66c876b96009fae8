"""A Pin, a Weld, a Rod, a Gear and a Drive in MuJoCo, where no coordinate of the tree stands for them.

A pin or a weld that closes a loop is a `connect`. It has three rows; out of the plane nothing can move, so the third
row is empty and harmless. The angles of a weld, and of a gear, are sums of tree coordinates with constant coefficients:
a fixed tendon, held by an equality that has no velocity term and needs none.

`RodBy` names what holds a rod:

- "tendon": MuJoCo's own parts alone, an equality of a spatial tendon between two sites. Up to 4.0.1 it leaves out the
  velocity term -(dJ/dt) v, which its spring has to make up for by a gap.
- "rows": the rod's own row, written by a callback in every stage.

A driven rotation is a tree coordinate that turns at a given rate. `DriveBy` names what keeps it:

- "inertia": nothing can accelerate the coordinate, because its armature is many times the mechanism's own inertia.
- "overwrite": its position and velocity are overwritten after every step (`engines.mujoco.running`). The solver still
  takes the coordinate as one that forces accelerate, so it misjudges the forces in the loop.

Where a driven rotation is a sum of several coordinates, a fixed tendon adds them up, less the angle of a clock: a wheel
of its own that turns at the rate and that nothing can accelerate. An equality holds the tendon at its length, so the
drive is as soft as a loop is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building
from engines.tree import Tree, world_offset
from reference.joints import Drive, Gear, Pin, Rod, Weld
from reference.mechanism import Mechanism

RodBy = Literal["tendon", "rows"]
DriveBy = Literal["inertia", "overwrite"]


def add_pins(building: Building, pins: Sequence[Pin | Weld]) -> None:
    """Add a `connect` each, bound by MuJoCo in the assembled start pose; its force acts on `name1`: the second body."""
    for pin in pins:
        names = ["world" if name is None else f"body {building.index(name)}" for name in (pin.first, pin.second)]
        name, point = (pin.second, pin.second_point) if pin.second is not None else (pin.first, pin.first_point)
        if pin.second is None:
            # The anchor is given in the frame of name1; on a body it stays as exact as the body's frame.
            names.reverse()
        loop = building.hold(mujoco.mjtEq.mjEQ_CONNECT, names[1], names[0], rows=2)
        loop.data[:3] = [*world_offset(building.mechanism, name, point), 0.0]


def add_welds(building: Building, welds: Sequence[Weld]) -> None:
    """Add the welds that close loops."""
    add_pins(building, welds)
    for weld in welds:
        _hold_angles(building, f"weld {weld.name}", building.tree.turning(weld.first, weld.second))


def add_gears(building: Building, gears: Sequence[Gear]) -> None:
    """Add the gears: the second body's angle less `ratio` times the first's stays as it is at the start."""
    for gear in gears:
        signs = dict(building.tree.turning(None, gear.second))
        for column, sign in building.tree.turning(None, gear.first).items():
            signs[column] = signs.get(column, 0.0) - gear.ratio * sign
        _hold_angles(building, f"gear {gear.name}", signs)


def _hold_angles(building: Building, name: str, signs: Mapping[int, float]) -> None:
    """An equality of the sum of coordinates; none where no coordinate can change it."""
    turning = {column: sign for column, sign in signs.items() if sign}
    if turning:
        building.add_sum(name, turning)
        building.hold_tendon(name)


def add_rods(building: Building, rods: Sequence[Rod], by: RodBy) -> None:
    """Add the rods by this construction."""
    for rod in rods:
        if by == "rows":
            building.write("rod", rod, (*rod.first_point, *rod.second_point, rod.length, *building.gains))
        else:
            building.add_between(f"rod {rod.name}", rod)
            building.hold_tendon(f"rod {rod.name}")


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
            inertia = inertia_scale(building.mechanism)
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


def inertia_scale(mechanism: Mechanism) -> float:
    """About the largest inertia that a joint of the mechanism can feel [kg m^2]."""
    return sum(body.inertia + body.mass * mechanism.length_scale**2 for body in mechanism.bodies)
