"""Constructions of slots that are no slide of the kinematic tree.

If a slot keeps the centre of mass of a free body on a line of the ground, the slot is an equality of a fixed tendon.
`SlotBy` is the construction of other slots.

- "halves": the second body is split into two halves with the same centre of mass. Joints of the tree let one half slide
  and turn in the first body, and a `weld` joins the halves.
- "rows": a row for the slot that a callback writes in every stage.

A model with rows has one body, two coordinates and five solver rows less than a model with halves, and a step takes a
fifth less time. (Three of the six rows of a weld are empty in the plane.) The following errors are for TUNED and steps
of about 1e-3 s. A slotted lever has an error of 2.8e-7 rad with rows and 6.2e-7 rad with halves. An arm and a block in
free coordinates have an error of 4.4e-6 with rows and 1.4e-6 with halves.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np

from engines.mujoco.builder import ModelBuilder, add_body, add_hinge, add_slide
from engines.tree import Link, Tree, world_offset
from reference.joints import Slot
from reference.plane import rotation_velocity

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

    The gap of such a slot is a sum of two coordinates with constant factors. The result is None for other slots.
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
    """Let a half of the second body slide and turn in the first body, and weld it to the other half.

    The halves are equal, since a lighter half would increase the compliance of the weld. If the second body is the
    ground, the auxiliary body does not move. The auxiliary body then has half the mass of the first body, which has no
    effect.
    """
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
