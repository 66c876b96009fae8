"""Constructions of pins, welds, rods, gears and drives that the kinematic tree does not enforce.

A pin or a weld that closes a loop is a `connect`. One row of the `connect` is normal to the plane and therefore empty.
The angle of a weld or a gear is the length of a fixed tendon, which is a sum of tree coordinates with constant factors.
An equality keeps this length constant, without a velocity term because the factors are constant.

`RodBy` is the construction of a rod.

- "tendon": an equality of a spatial tendon between two sites. Up to 4.0.1 the equality lacks the velocity term -(dJ/dt)
  v, so a gap of its spring supplies this force.
- "rows": a row for the rod that a callback writes in every stage.

`DriveBy` is the construction of a drive whose rotation is a tree coordinate.

- "inertia": the armature is so large that no force can accelerate the coordinate.
- "overwrite": our code overwrites position and velocity after every step (`engines.mujoco.running`). MuJoCo's solver
  does not know this motion, so the forces in a loop are wrong.

If the rotation is a sum of several coordinates, a fixed tendon is the difference between this sum and the angle of a
clock. The clock is an auxiliary wheel with the prescribed rate and a large armature. An equality keeps the length of
the tendon constant, so the drive is as soft as a loop.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco

from engines import Unsupported
from engines.mujoco.builder import DrivenCoordinate, ModelBuilder, add_body, add_hinge
from engines.tree import world_offset
from reference.joints import Drive, Gear, Pin, Rod, Weld
from reference.mechanism import Mechanism

RodBy = Literal["tendon", "rows"]
DriveBy = Literal["inertia", "overwrite"]


def add_pins(builder: ModelBuilder, pins: Sequence[Pin | Weld]) -> None:
    """Add a `connect` for each pin, whose `name1` is the second body unless the second body is the ground."""
    for pin in pins:
        names = [builder.spec_name(name) for name in (pin.first, pin.second)]
        name, point = (pin.second, pin.second_point) if pin.second is not None else (pin.first, pin.first_point)
        if pin.second is None:
            # The anchor is in the frame of `name1`; a body's frame causes smaller rounding errors than the world's
            # frame.
            names.reverse()
        connect = builder.add_equality(mujoco.mjtEq.mjEQ_CONNECT, names[1], names[0], rows=2)
        connect.data[:3] = [*world_offset(builder.mechanism, name, point), 0.0]


def add_welds(builder: ModelBuilder, welds: Sequence[Weld]) -> None:
    add_pins(builder, welds)
    for weld in welds:
        builder.hold_sum(f"weld {weld.name}", builder.tree.turning(weld.first, weld.second))


def add_gears(builder: ModelBuilder, gears: Sequence[Gear]) -> None:
    """Keep second angle - ratio * first angle at its initial value."""
    for gear in gears:
        factors = dict(builder.tree.turning(None, gear.second))
        for column, sign in builder.tree.turning(None, gear.first).items():
            factors[column] = factors.get(column, 0.0) - gear.ratio * sign
        builder.hold_sum(f"gear {gear.name}", factors)


def add_rods(builder: ModelBuilder, rods: Sequence[Rod]) -> None:
    for rod in rods:
        if builder.settings.rods == "rows":
            numbers = (*rod.first_point, *rod.second_point, rod.length, *builder.gains)
            builder.add_user_rows("rod", rod, numbers)
        else:
            builder.add_spatial_tendon(f"rod {rod.name}", rod)
            builder.hold_length(f"rod {rod.name}")


def add_drives(builder: ModelBuilder, drives: Sequence[Drive]) -> None:
    """Drive a coordinate or a sum of coordinates. Raises Unsupported for a second drive of a coordinate."""
    for drive in drives:
        factors = builder.tree.turning(drive.first, drive.second)
        if len(factors) != 1:
            _add_geared_drive(builder, drive, factors)
            continue
        ((column, sign),) = factors.items()
        if column in [other.column for other in builder.driven]:
            raise Unsupported(f"drive {drive.name!r} turns a joint that another drive turns already")
        builder.driven.append(DrivenCoordinate(column, sign * drive.turning_rate))
        if builder.settings.drive == "inertia":
            builder.spec.joint(f"coordinate {column}").armature = _driving_inertia(builder)


def _add_geared_drive(builder: ModelBuilder, drive: Drive, factors: Mapping[int, float]) -> None:
    """Keep the difference between a sum of coordinates and the angle of a clock constant. Raises Unsupported."""
    by = builder.settings.drive
    if by != "inertia" or not factors:
        first, second = (repr(name) if name else "the ground" for name in (drive.first, drive.second))
        rotation = "a sum of coordinates" if factors else "no coordinate"
        raise Unsupported(
            f"drive {drive.name!r}: the rotation of {second} against {first} is {rotation} of MuJoCo's tree here; "
            + (f"{by!r} drives single ones, take 'inertia'" if factors else "nothing can drive it")
        )
    name = f"drive {drive.name}"
    tendon = builder.add_fixed_tendon(name, factors)
    if drive.turning_rate:
        mass = sum(body.mass for body in builder.mechanism.bodies)
        clock = add_body(builder.spec.worldbody, name, mass, inertia_scale(builder.mechanism))
        add_hinge(clock, name, armature=_driving_inertia(builder))
        tendon.wrap_joint(name, -1.0)
        builder.start_rates[name] = drive.turning_rate
        builder.clocks.append(name)
    builder.hold_length(name)


def _driving_inertia(builder: ModelBuilder) -> float:
    return builder.settings.armature * inertia_scale(builder.mechanism)


def inertia_scale(mechanism: Mechanism) -> float:
    """An estimate [kg m^2] of the largest inertia about a joint."""
    return sum(body.inertia + body.mass * mechanism.length_scale**2 for body in mechanism.bodies)
