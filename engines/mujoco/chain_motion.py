"""How the links of a tree move with its coordinates, in plain floats, for rows that are written while it is stepped.

A motion is (x, y, turned, vx, vy, omega, ax, ay, px, py, dx, dy) of a link: its centre of mass, how far it has turned
since the start, their rates; (ax, ay) is the acceleration of its centre of mass where no coordinate accelerates,
(px, py) the point about which its rotation turns it, (dx, dy) the direction of its slide.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from engines.tree import Tree

Motion = tuple[float, float, float, float, float, float, float, float, float, float, float, float]
RESTING: Motion = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
# Of a link that hangs on another: its arm there and its anchor on itself, at the start and in the world's directions,
# and the direction of its slide.
Hanging = tuple[float, float, float, float, float, float]


def hung(base: Motion, link: Hanging, along: float, speed: float, turn: float, spin: float) -> Motion:
    """The motion of a link that hangs on another: `along` its slide at a speed, turned against it by `turn` at `spin`.

    Plain arithmetic: `engines.mujoco.native_rows` compiles it as it stands.
    """
    arm_x, arm_y, anchor_x, anchor_y, way_x, way_y = link
    base_x, base_y, turned, vx, vy, omega, ax, ay, _, _, _, _ = base
    cosine, sine = math.cos(turned), math.sin(turned)
    dx, dy = cosine * way_x - sine * way_y, sine * way_x + cosine * way_y
    x = cosine * arm_x - sine * arm_y + along * dx
    y = sine * arm_x + cosine * arm_y + along * dy
    coriolis, square = 2 * omega * speed, omega * omega
    vx, vy = vx + speed * dx - omega * y, vy + speed * dy + omega * x
    ax, ay = ax - coriolis * dy - square * x, ay + coriolis * dx - square * y
    x, y = base_x + x, base_y + y
    turned, omega = turned + turn, omega + spin
    cosine, sine = math.cos(turned), math.sin(turned)
    own_x, own_y = cosine * anchor_x - sine * anchor_y, sine * anchor_x + cosine * anchor_y
    square = omega * omega
    return (
        x - own_x, y - own_y, turned, vx + omega * own_y, vy - omega * own_x, omega,
        ax + square * own_x, ay + square * own_y, x, y, dx, dy,
    )  # fmt: skip


def ancestry(tree: Tree, bodies: Sequence[int]) -> list[int]:
    """Indices of the links of these bodies and of all that they hang on, parents before children."""
    own = {link.body: index for index, link in enumerate(tree.links)}
    wanted: set[int] = set()
    for body in bodies:
        at: int | None = body
        while at is not None:
            wanted.add(own[at])
            at = tree.links[own[at]].parent
    return sorted(wanted)


def columns_of(tree: Tree, index: int, address: Sequence[int]) -> tuple[int | None, int, int | None, int | None]:
    """Where the link's slides in x and y, its slide along a slot, and its rotation stand in qvel."""
    link = tree.links[index]
    columns = [address[column] for column in link.columns]
    if link.kind == "free":
        return columns[0], columns[1], None, columns[2]
    if link.kind == "hinge":
        return None, 0, None, columns[0] if columns else None  # none: welded
    return None, 0, columns[0], columns[1] if len(columns) > 1 else None


def kinematics(
    tree: Tree, index: int, address: Sequence[int], place: Mapping[int | None, int]
) -> Callable[[Sequence[Motion], Sequence[float], Sequence[float]], Motion]:
    """The link's motion by those of all links, of which `place` tells the parent's, and by qpos and qvel."""
    link = tree.links[index]
    start_x, start_y, _ = tree.mechanism.pose[link.body].tolist()
    columns = [address[column] for column in link.columns]
    if link.kind == "free":
        column_x, column_y, rotation = columns

        def free(_moving: Any, q: Sequence[float], v: Sequence[float]) -> Motion:
            x, y = start_x + q[column_x], start_y + q[column_y]
            return x, y, q[rotation], v[column_x], v[column_y], v[rotation], 0.0, 0.0, x, y, 0.0, 0.0

        return free
    parent, own = place[link.parent], hanging(tree, index)
    slide = columns[0] if link.kind == "slot" else None
    turning = columns[-1] if link.turns else None

    def moved(moving: Sequence[Motion], q: Sequence[float], v: Sequence[float]) -> Motion:
        along, speed = (0.0, 0.0) if slide is None else (q[slide], v[slide])
        turn, spin = (0.0, 0.0) if turning is None else (q[turning], v[turning])
        return hung(moving[parent], own, along, speed, turn, spin)

    return moved


def hanging(tree: Tree, index: int) -> Hanging:
    """What `hung` is told of a link."""
    link = tree.links[index]
    way_x, way_y = link.direction if link.kind == "slot" else (0.0, 0.0)
    return (*link.arm, *link.anchor, way_x, way_y)
