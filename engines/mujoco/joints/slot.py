"""Slots that no slide of the tree stands for: a linear equality where the line rests, else a weld or a written row.

`SlotBy` names what holds those whose line moves, or whose point a rotation moves:

- "halves": MuJoCo's own parts alone. The second body is cut into two halves of the same centre of mass; one of them
  slides and turns in the first body by joints of the tree, and a `weld` holds it to the other.
- "rows": the slot's own row, written by a callback in every stage.

Beside halves a row saves a body, two coordinates, five of six rows of the solver (three of a weld's are empty in the
plane) and a fifth of a step's time. By the settings of TUNED and steps of about 1e-3 s a slotted lever misses 2.8e-7
rad with its row and 6.2e-7 with halves, an arm and a block in free coordinates 4.4e-6 and 1.4e-6.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Literal

import mujoco
import numpy as np

from engines.mujoco.construction import Building
from engines.mujoco.written_rows import Law, Row, State, WrittenJoint
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
            body = building.index(slot.second)
            stiffness, damping = building.stiffness.gains(building.mechanism, building.dt)
            rows = slot_rows(slot, stiffness, damping)
            building.written.append(WrittenJoint(building.index(slot.first), body, 1, rows))
        else:
            _add_half(building, slot)


def resting_line(slot: Slot, tree: Tree) -> Link | None:
    """The slotted body's link where a sum of two of its coordinates is the slot's gap: no rotation moves the point."""
    link = next((link for link in tree.links if tree.mechanism.bodies[link.body].name == slot.second), None)
    if slot.first is None and link is not None and link.kind == "free" and not any(slot.second_point):
        return link
    return None


def _add_tendon(building: Building, slot: Slot, column: int) -> None:
    tendon = building.spec.add_tendon(name=f"slot {slot.name}")
    tendon.wrap_joint(f"coordinate {column}", -math.sin(slot.line_angle))
    tendon.wrap_joint(f"coordinate {column + 1}", math.cos(slot.line_angle))
    building.spec.add_equality(
        type=mujoco.mjtEq.mjEQ_TENDON,
        objtype=mujoco.mjtObj.mjOBJ_TENDON,
        name1=f"slot {slot.name}",
        solref=list(building.stiffness.reference(building.mechanism, building.dt)),
        solimp=list(building.stiffness.impedance),
    )
    building.size += 1


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
    carrier = spec.worldbody if first is None else spec.body(f"body {first}")
    half = carrier.add_body(
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
    building.start_rates |= {name: _along(building, slot, direction), turn: _turning(building, slot)}
    weld = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_WELD,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        name1=name,
        name2="world" if second is None else f"body {second}",
        solref=list(building.stiffness.reference(mechanism, building.dt)),
        solimp=list(building.stiffness.impedance),
    )
    weld.data[:3] = [*anchor, 0.0]
    building.size += 3


def _along(building: Building, slot: Slot, direction: tuple[float, float]) -> float:
    """How fast the second body's point moves along the slot at the start, relative to the first's material [m/s]."""
    mechanism = building.mechanism
    at = np.array(world_offset(mechanism, slot.second, slot.second_point))
    if slot.second is not None:
        at = at + mechanism.pose[mechanism.body_index(slot.second), :2]
    velocity = np.zeros(2)
    for name, sign in ((slot.first, -1.0), (slot.second, 1.0)):
        if name is not None:
            index = mechanism.body_index(name)
            twist = mechanism.twist[index]
            velocity += sign * (twist[:2] + rotation_velocity(twist[2], at - mechanism.pose[index, :2]))
    return float(velocity @ np.array(direction))


def _turning(building: Building, slot: Slot) -> float:
    """How fast the second body turns against the first at the start [rad/s]."""
    mechanism = building.mechanism
    rates = [
        0.0 if name is None else mechanism.twist[mechanism.body_index(name), 2] for name in (slot.first, slot.second)
    ]
    return float(rates[1] - rates[0])


def slot_rows(slot: Slot, stiffness: float, damping: float) -> Law:
    """The slot's row and -(dJ/dt) v - damping slip - stiffness gap, see `reference.joints.Slot`."""
    return Law(slot_row, (*slot.first_point, *slot.second_point, slot.line_angle, stiffness, damping))


def slot_row(numbers: tuple[float, float, float, float, float, float, float], first: State, second: State) -> Row:
    """Of a point on either body [m], the line's angle [rad], stiffness [1/s^2] and damping [1/s]."""
    first_x, first_y, second_x, second_y, line, stiffness, damping = numbers
    x1, y1, angle1, vx1, vy1, omega1 = first
    x2, y2, angle2, vx2, vy2, omega2 = second
    cosine, sine = math.cos(angle1), math.sin(angle1)
    own_x1, own_y1 = cosine * first_x - sine * first_y, sine * first_x + cosine * first_y
    cosine, sine = math.cos(angle2), math.sin(angle2)
    own_x2, own_y2 = cosine * second_x - sine * second_y, sine * second_x + cosine * second_y
    along_x, along_y = math.cos(angle1 + line), math.sin(angle1 + line)
    arm_x, arm_y = x2 + own_x2 - x1, y2 + own_y2 - y1
    across_x, across_y = arm_x - own_x1, arm_y - own_y1
    rate_x = vx2 - omega2 * own_y2 - vx1 + omega1 * own_y1
    rate_y = vy2 + omega2 * own_x2 - vy1 - omega1 * own_x1
    gap = along_x * across_y - along_y * across_x
    slip = along_x * rate_y - along_y * rate_x - omega1 * (along_x * across_x + along_y * across_y)
    square1, square2 = omega1 * omega1, omega2 * omega2
    moved_x, moved_y = square1 * own_x1 - square2 * own_x2, square1 * own_y1 - square2 * own_y2
    changing = along_x * moved_y - along_y * moved_x - square1 * gap
    changing -= 2 * omega1 * (along_x * rate_x + along_y * rate_y)
    return (
        along_y, -along_x, -along_x * arm_x - along_y * arm_y,
        -along_y, along_x, along_y * own_y2 + along_x * own_x2,
        -changing - damping * slip - stiffness * gap,
    )  # fmt: skip
