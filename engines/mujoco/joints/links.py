"""Constructions of pins, welds, rods, gears, drives and slots that the kinematic tree does not enforce.

A pin or a weld that closes a loop is a `connect`. One row of the `connect` is normal to the plane and therefore empty.
The angle of a weld or a gear is the length of a fixed tendon, which is a sum of tree coordinates with constant factors.
An equality keeps this length constant, without a velocity term because the factors are constant.

`RodBy` is the construction of a rod.

- "tendon": an equality of a spatial tendon between two sites. Up to 4.0.1 the equality lacks the velocity term -(dJ/dt)
  v, so a gap of its spring supplies this force.
- "rows": a row for the rod that a callback writes in every stage.

If the rotation of a drive is a tree coordinate, the armature of the coordinate is so large that no force can accelerate
it. If the rotation is a sum of several coordinates, a fixed tendon is the difference between this sum and the angle of
a clock. The clock is an auxiliary wheel with the prescribed rate and a large armature. An equality keeps the length of
the tendon constant, so the drive is as soft as a loop.

If a slot keeps the centre of mass of a free body on a line of the ground, the slot is an equality of a fixed tendon.
`SlotBy` is the construction of other slots.

- "halves": the second body is split into two halves with the same centre of mass. Joints of the tree let one half slide
  and turn in the first body, and a `weld` joins the halves.
- "rows": a row for the slot that a callback writes in every stage, in a fifth less time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Literal

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco.builder import DrivenCoordinate, ModelBuilder, add_body, add_hinge, add_slide
from engines.tree import Link, Tree, world_offset
from reference.joints import Drive, Gear, Pin, Rod, Slot, Weld
from reference.mechanism import Mechanism
from reference.plane import rotation_velocity

RodBy = Literal["tendon", "rows"]


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
        builder.spec.joint(f"coordinate {column}").armature = _driving_inertia(builder)


def _add_geared_drive(builder: ModelBuilder, drive: Drive, factors: Mapping[int, float]) -> None:
    """Keep the difference between a sum of coordinates and the angle of a clock constant. Raises Unsupported."""
    if not factors:
        first, second = (repr(name) if name else "the ground" for name in (drive.first, drive.second))
        raise Unsupported(
            f"drive {drive.name!r}: the rotation of {second} against {first} is no coordinate of MuJoCo's tree here; "
            "nothing can drive it"
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


SlotBy = Literal["halves", "rows"]


def add_slots(builder: ModelBuilder, slots: Sequence[Slot]) -> None:
    for slot in slots:
        link = free_link_on_fixed_line(slot, builder.tree)
        if link is not None:
            _add_tendon(builder, slot, link.column)
        elif builder.settings.slots == "rows":
            numbers = (*slot.first_point, *slot.second_point, slot.line_angle, *builder.gains)
            builder.add_user_rows("slot", slot, numbers)
        else:
            _add_half(builder, slot)


def free_link_on_fixed_line(slot: Slot, tree: Tree) -> Link | None:
    """The link of the slot's second body, if it is free and the slot keeps its centre of mass on a line of the ground.

    The result is None for other slots.
    """
    link = next((link for link in tree.links if tree.mechanism.bodies[link.body].name == slot.second), None)
    if slot.first is None and link is not None and link.kind == "free" and not any(slot.second_point):
        return link
    return None


def _add_tendon(builder: ModelBuilder, slot: Slot, column: int) -> None:
    across = {column: -math.sin(slot.line_angle), column + 1: math.cos(slot.line_angle)}
    builder.add_fixed_tendon(f"slot {slot.name}", across)
    builder.hold_length(f"slot {slot.name}")


def _add_half(builder: ModelBuilder, slot: Slot) -> None:
    """Let a half of the second body slide and turn in the first body, and weld it to the other half."""
    spec, mechanism = builder.spec, builder.mechanism
    first, second = builder.index(slot.first), builder.index(slot.second)
    base = np.zeros(3) if first is None else mechanism.pose[first]
    centre = np.zeros(2) if second is None else mechanism.pose[second, :2]
    anchor = world_offset(mechanism, slot.second, slot.second_point)
    other = spec.body(f"body {first if second is None else second}")
    mass, inertia = other.mass / 2, other.inertia[2] / 2
    name, line = f"half {slot.name}", slot.line_angle + base[2]
    if second is not None:
        other.mass, other.inertia = mass, [inertia] * 3
        builder.split_bodies.append((name, second))
    half = add_body(builder.spec_body(slot.first), name, mass, inertia, (centre - base[:2]).tolist())
    turn, direction = f"{name}: turn", (math.cos(line), math.sin(line))
    add_slide(half, name, direction)
    add_hinge(half, turn, anchor)
    builder.start_rates |= dict(zip((name, turn), _start_rates(builder, slot, direction), strict=True))
    weld = builder.add_equality(mujoco.mjtEq.mjEQ_WELD, name, builder.spec_name(slot.second), rows=3)
    weld.data[:3] = [*anchor, 0.0]


def _start_rates(builder: ModelBuilder, slot: Slot, direction: tuple[float, float]) -> tuple[float, float]:
    """The initial relative velocities of the bodies: along the slot at the second body's point [m/s], and angular
    [rad/s].
    """
    mechanism = builder.mechanism
    point = np.array(world_offset(mechanism, slot.second, slot.second_point))
    if slot.second is not None:
        point = point + mechanism.pose[mechanism.body_index(slot.second), :2]
    velocity, turning = np.zeros(2), 0.0
    for name, sign in ((slot.first, -1.0), (slot.second, 1.0)):
        if name is not None:
            index = mechanism.body_index(name)
            twist = mechanism.twist[index]
            velocity += sign * (twist[:2] + rotation_velocity(twist[2], point - mechanism.pose[index, :2]))
            turning += sign * twist[2]
    return float(velocity @ np.array(direction)), float(turning)
