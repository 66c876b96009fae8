"""Slots that no slide of the tree stands for: a linear equality where the line rests, else a weld or a written row.

`SlotBy` names what holds those whose line moves, or whose point a rotation moves:

- "halves": MuJoCo's own parts alone. The second body is cut into two halves of the same centre of mass; one of them
  slides and turns in the first body by joints of the tree, and a `weld` holds it to the other.
- "rows": the slot's own row, written by a callback in every stage.

Beside halves a row saves a body, two coordinates, five of six rows of the solver (three of a weld's are empty in the
plane) and a fifth of a step's time. By the settings of TUNED and steps of about 1e-3 s a slotted lever misses 2.8e-7
rad with its row and 6.2e-7 with halves, an arm and a block in free coordinates 4.4e-6 and 1.4e-6.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np

from engines.mujoco.construction import Building
from engines.tree import Link, Tree, world_offset
from reference.joints import Slot
from reference.plane import rotation_velocity

SlotBy = Literal["halves", "rows"]


def add_slots(building: Building, slots: Sequence[Slot], by: SlotBy) -> None:
    """Add the slots that the tree doesn't hold."""
    for slot in slots:
        link = resting_line(slot, building.tree)
        if link is not None:
            _add_tendon(building, slot, link.column)
        elif by == "rows":
            building.write("slot", slot, (*slot.first_point, *slot.second_point, slot.line_angle, *building.gains))
        else:
            _add_half(building, slot)


def resting_line(slot: Slot, tree: Tree) -> Link | None:
    """The slotted body's link where a sum of two of its coordinates is the slot's gap: no rotation moves the point."""
    link = next((link for link in tree.links if tree.mechanism.bodies[link.body].name == slot.second), None)
    if slot.first is None and link is not None and link.kind == "free" and not any(slot.second_point):
        return link
    return None


def _add_tendon(building: Building, slot: Slot, column: int) -> None:
    across = {column: -math.sin(slot.line_angle), column + 1: math.cos(slot.line_angle)}
    building.add_sum(f"slot {slot.name}", across)
    building.hold_tendon(f"slot {slot.name}")


def _add_half(building: Building, slot: Slot) -> None:
    """Half of the second body on a slide and a hinge in the first, welded to the other half.

    Halves, because a weld is the softer the lighter the lighter part is. Where the second is the ground, the half can
    weigh anything, since it rests: it is as heavy as half of the first, of which nothing is cut off.
    """
    spec, mechanism = building.spec, building.mechanism
    first, second = building.index(slot.first), building.index(slot.second)
    base = np.zeros(3) if first is None else mechanism.pose[first]
    centre = np.zeros(2) if second is None else mechanism.pose[second, :2]
    anchor = world_offset(mechanism, slot.second, slot.second_point)
    other = spec.body(f"body {first if second is None else second}")
    mass, inertia = other.mass / 2, other.inertia[2] / 2
    name, line = f"half {slot.name}", slot.line_angle + base[2]
    if second is not None:
        other.mass, other.inertia = mass, [inertia] * 3
        building.halves.append((name, second))
    half = building.carrier(slot.first).add_body(
        name=name,
        pos=[*(centre - base[:2]), 0.0],
        ipos=[0.0, 0.0, 0.0],
        mass=mass,
        inertia=[inertia] * 3,
        explicitinertial=True,
    )
    turn, direction = f"{name}: turn", (math.cos(line), math.sin(line))
    half.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_SLIDE, axis=[*direction, 0.0])
    half.add_joint(name=turn, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 0.0, 1.0], pos=[*anchor, 0.0])
    building.start_rates |= dict(zip((name, turn), _start_rates(building, slot, direction), strict=True))
    other_half = "world" if second is None else f"body {second}"
    weld = building.hold(mujoco.mjtEq.mjEQ_WELD, name, other_half, rows=3)
    weld.data[:3] = [*anchor, 0.0]


def _start_rates(building: Building, slot: Slot, direction: tuple[float, float]) -> tuple[float, float]:
    """The rates of the second body's point along the slot [m/s], and of the second body's rotation [rad/s], both
    against the first body at the start.
    """
    mechanism = building.mechanism
    at = np.array(world_offset(mechanism, slot.second, slot.second_point))
    if slot.second is not None:
        at = at + mechanism.pose[mechanism.body_index(slot.second), :2]
    velocity, turning = np.zeros(2), 0.0
    for name, sign in ((slot.first, -1.0), (slot.second, 1.0)):
        if name is not None:
            index = mechanism.body_index(name)
            twist = mechanism.twist[index]
            velocity += sign * (twist[:2] + rotation_velocity(twist[2], at - mechanism.pose[index, :2]))
            turning += sign * twist[2]
    return float(velocity @ np.array(direction)), float(turning)
