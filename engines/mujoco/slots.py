"""Slots that no slide of the tree stands for: a linear equality where the line rests, a written row elsewhere."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Literal

import mujoco

from engines import Unsupported
from engines.mujoco.construction import Building
from engines.mujoco.tree import Link, Tree
from engines.mujoco.written_rows import Row, State, WrittenJoint
from reference.joints import Slot

SlotBy = Literal["tendon", "rows"]


def add_slots(building: Building, slots: Sequence[Slot], by: SlotBy) -> None:
    """Add the slots that the tree doesn't hold. Raises Unsupported where public constructions don't suffice."""
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
            raise Unsupported(
                f"slot {slot.name!r} is neither a slide of MuJoCo's tree nor a resting line for the centre of a free "
                "body; MuJoCo has no such equality, only rows written in a callback would do"
            )


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


def slot_rows(slot: Slot, stiffness: float, damping: float) -> Callable[[float, State, State], Sequence[Row]]:
    """The slot's row and -(dJ/dt) v - damping slip - stiffness gap, see `reference.joints.Slot`."""
    (first_x, first_y), (second_x, second_y), line = slot.first_point, slot.second_point, slot.line_angle
    sine_of, cosine_of = math.sin, math.cos

    def rows(_t: float, first: State, second: State) -> Sequence[Row]:
        x1, y1, angle1, vx1, vy1, omega1 = first
        x2, y2, angle2, vx2, vy2, omega2 = second
        cosine, sine = cosine_of(angle1), sine_of(angle1)
        own_x1, own_y1 = cosine * first_x - sine * first_y, sine * first_x + cosine * first_y
        cosine, sine = cosine_of(angle2), sine_of(angle2)
        own_x2, own_y2 = cosine * second_x - sine * second_y, sine * second_x + cosine * second_y
        along_x, along_y = cosine_of(angle1 + line), sine_of(angle1 + line)
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
            (
                along_y, -along_x, -along_x * arm_x - along_y * arm_y,
                -along_y, along_x, along_y * own_y2 + along_x * own_x2,
                -changing - damping * slip - stiffness * gap,
            ),
        )  # fmt: skip

    return rows
