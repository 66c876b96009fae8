"""Slots that no slide of the tree stands for: a linear equality where the line rests, else a weld or a user row.

`SlotBy` is the construction of a slot whose line moves, or whose point a rotation moves:

- "halves": MuJoCo's own parts alone. The second body is split into two halves with the same centre of mass. One of them
  slides and turns in the first body by joints of the tree, and a `weld` holds it to the other.
- "rows": the slot's own row, written by a callback in every stage.

A row needs one body, two coordinates and five of six solver rows less than halves (three rows of a weld are empty in
the plane), and a fifth less time for a step. With the settings of TUNED and steps of about 1e-3 s, the error of a
slotted lever is 2.8e-7 rad with its row and 6.2e-7 rad with halves; that of an arm and a block in free coordinates is
4.4e-6 and 1.4e-6.
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
    """Add the slots by the construction of the settings."""
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
    """The link of a free body whose centre of mass the slot holds on a line of the ground; None for other slots.

    The gap of such a slot is a sum of two coordinates with constant factors.
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
    """Put half of the second body on a slide and a hinge in the first, and weld it to the other half.

    The compliance of a weld grows as the lighter of its two bodies becomes lighter, so both are halves. Where the
    second body is the ground, the auxiliary body can have any mass, since it rests: it has half of the first body's.
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
    """Rates at t = 0 against the first body: of the second body's point along the slot [m/s], and of its angle [rad/s].

    The point is that of the second body which lies in the slot.
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
