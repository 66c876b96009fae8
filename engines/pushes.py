"""What force elements do to a tree at one instant: for engines that have no springs, or springs of another law.

Users of these work forces out by themselves too, before every step; so it is in plain floats, which for one time are
ten times as fast as the arrays of `engines.tree`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from engines.tree import Tree

Array = NDArray[np.float64]
RESTS = (0.0,) * 6  # the ground


def pushes(tree: Tree, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Poses (bodies, 3) [m, m, rad], and what force elements do to bodies (bodies, 3) [N, N, N m].

    position, velocity (coordinates,): tree coordinates [m, rad] and their rates. NaN where these are NaN or infinite.
    """
    pose, twist = instant(tree, position, velocity)
    return pose, np.asarray(tree.mechanism.applied.on(pose, twist), dtype=np.float64)


def instant(tree: Tree, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Poses and twists (bodies, 3) at tree coordinates and rates (coordinates,): `Tree.motion` of one time."""
    if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
        pose, twist = np.full((2, len(tree.mechanism.bodies), 3), math.nan)
        return pose, twist
    start, way, rate = tree.mechanism.pose, position.tolist(), velocity.tolist()
    states = [RESTS] * len(start)  # by body: x, y, by how much it has turned, and the rates of these
    for link in tree.links:
        column, last = link.column, link.column + link.slides
        x, y, turned, vx, vy, turning = RESTS if link.parent is None else states[link.parent]
        own_turned = turned + (way[last] if link.turns else 0.0)
        own_turning = turning + (rate[last] if link.turns else 0.0)
        if link.kind == "free":
            x, y = float(start[link.body, 0]) + way[column], float(start[link.body, 1]) + way[column + 1]
            vx, vy = rate[column], rate[column + 1]
        else:
            arm_x, arm_y = link.arm
            if link.kind == "slot":
                along_x, along_y = link.direction
                arm_x, arm_y = arm_x + way[column] * along_x, arm_y + way[column] * along_y
                slide_x, slide_y = _rotated(turned, along_x, along_y)
                vx, vy = vx + rate[column] * slide_x, vy + rate[column] * slide_y
            arm_x, arm_y = _rotated(turned, arm_x, arm_y)
            own_x, own_y = _rotated(own_turned, *link.anchor)
            x, y = x + arm_x - own_x, y + arm_y - own_y
            vx, vy = vx - turning * arm_y + own_turning * own_y, vy + turning * arm_x - own_turning * own_x
        states[link.body] = (x, y, own_turned, vx, vy, own_turning)
    told = np.array(states)
    pose, twist = told[:, :3], told[:, 3:]
    pose[:, 2] += start[:, 2]
    return pose, twist


def _rotated(angle: float, x: float, y: float) -> tuple[float, float]:
    cosine, sine = math.cos(angle), math.sin(angle)
    return cosine * x - sine * y, sine * x + cosine * y
