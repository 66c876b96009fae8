"""A mechanism as a tree of planar joints and the loops that close it, and the way from tree coordinates to poses.

Each body's frame is parallel to the world's at t = 0 and stands at the centre of mass there, so that all tree
coordinates are zero at the start: the mechanism begins assembled, exactly, and angles are never wrapped.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.joints import Pin, turn
from reference.mechanism import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Link:
    """A body in the tree: hinged on its parent by a pin, or moving freely (slide x, slide y, hinge) if it has none.

    `parent` is a body's index, or None for the ground. Of a hinged body, `arm` is the hinge seen from the parent's
    centre of mass (from the world's origin if that is the ground), and `anchor` the same point from its own, both
    (x, y) [m] with world directions at t = 0. `column` is its first tree coordinate; `rotation` its last.
    """

    body: int
    parent: int | None
    hinged: bool
    arm: tuple[float, float]
    anchor: tuple[float, float]
    column: int

    @property
    def rotation(self) -> int:
        """The tree coordinate that turns this body."""
        return self.column if self.hinged else self.column + 2


@dataclass(frozen=True)
class Tree:
    """Links, parents before children, and the pins that no link stands for."""

    mechanism: Mechanism
    links: tuple[Link, ...]
    loops: tuple[Pin, ...]

    @property
    def coordinates(self) -> int:
        return sum(1 if link.hinged else 3 for link in self.links)

    def rotation_of(self, first: str | None, second: str | None) -> tuple[int, float] | None:
        """The tree coordinate of the second body's rotation against the first, and its sign; None if there is none."""
        index = {None: None, **{body.name: i for i, body in enumerate(self.mechanism.bodies)}}
        for link in self.links:
            if (link.parent, link.body) == (index[first], index[second]):
                return link.rotation, 1.0
            if (link.body, link.parent) == (index[first], index[second]):
                return link.rotation, -1.0
        return None

    def start_rates(self) -> Array:
        """The tree velocities (coordinates,) [m/s, rad/s] of the mechanism's start."""
        twist, rates = self.mechanism.twist, np.zeros(self.coordinates)
        for link in self.links:
            if not link.hinged:
                rates[link.column : link.column + 2] = twist[link.body, :2]
            base = 0.0 if link.parent is None else twist[link.parent, 2]
            rates[link.rotation] = twist[link.body, 2] - base
        return rates

    def motion(self, position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (times, bodies, 3) of tree motions (times, coordinates) [m, rad, s]."""
        start, times = self.mechanism.pose, len(position)
        bodies = len(self.mechanism.bodies)
        pose, twist, change = (np.zeros((times, bodies + 1, 3)) for _ in range(3))  # the ground stands last and rests
        turned = np.zeros((times, bodies + 1))
        for link in self.links:
            body, base, last = link.body, bodies if link.parent is None else link.parent, link.rotation
            turned[:, body] = turned[:, base] + position[:, last]
            pose[:, body, 2] = start[body, 2] + turned[:, body]
            twist[:, body, 2] = twist[:, base, 2] + velocity[:, last]
            change[:, body, 2] = change[:, base, 2] + acceleration[:, last]
            if not link.hinged:
                plane = slice(link.column, link.column + 2)
                pose[:, body, :2] = start[body, :2] + position[:, plane]
                twist[:, body, :2] = velocity[:, plane]
                change[:, body, :2] = acceleration[:, plane]
                continue
            offsets = [(base, np.array(link.arm), 1.0), (body, np.array(link.anchor), -1.0)]
            # The arms turn by the angle's change, not by the angle: at t = 0 the pose is then the start, to rounding.
            pose[:, body, :2] = pose[:, base, :2]
            twist[:, body, :2] = twist[:, base, :2]
            change[:, body, :2] = change[:, base, :2]
            for which, offset, sign in offsets:
                x, y = turn(turned[:, which], offset)
                rate, gain = twist[:, which, 2], change[:, which, 2]
                pose[:, body, :2] += sign * np.stack([x, y], axis=-1)
                twist[:, body, :2] += sign * np.stack([-rate * y, rate * x], axis=-1)
                change[:, body, :2] += sign * np.stack([-gain * y - rate**2 * x, gain * x - rate**2 * y], axis=-1)
        return pose[:, :bodies], twist[:, :bodies], change[:, :bodies]


def spanning_tree(mechanism: Mechanism, pins: Iterable[Pin]) -> Tree:
    """The tree that grows breadth first from the ground along the pins; a body that they don't reach moves freely.

    With no `pins` every body moves freely; every pin of the mechanism that holds no link is a loop.
    """
    usable, loops = list(pins), [joint for joint in mechanism.joints if isinstance(joint, Pin)]
    links: list[Link] = []
    placed: dict[str | None, int | None] = {None: None}
    frontier: list[str | None] = [None]
    column = 0

    def place(name: str, parent: str | None, hinge: tuple[tuple[float, float], tuple[float, float]] | None) -> None:
        nonlocal column
        body = mechanism.body_index(name)
        arm, anchor = hinge or ((0.0, 0.0), (0.0, 0.0))
        links.append(Link(body, placed[parent], hinge is not None, arm, anchor, column))
        column += 1 if hinge else 3
        placed[name] = body
        frontier.append(name)

    waiting = [body.name for body in mechanism.bodies]
    while waiting:
        while frontier:
            parent = frontier.pop(0)
            for pin in usable:
                if parent not in (pin.first, pin.second):
                    continue
                child, point = (pin.second, pin.second_point) if parent == pin.first else (pin.first, pin.first_point)
                if child in placed or child is None:
                    continue
                place(child, parent, _hinge(mechanism, parent, child, point))
                waiting.remove(child)
                loops.remove(pin)
        if waiting:
            place(waiting.pop(0), None, None)
    return Tree(mechanism, tuple(links), tuple(loops))


def world_offset(mechanism: Mechanism, name: str | None, point: tuple[float, float]) -> tuple[float, float]:
    """A body's own point, from its centre of mass, with world directions at t = 0 [m]."""
    if name is None:
        return point
    x, y = turn(mechanism.pose[mechanism.body_index(name), 2], np.array(point))
    return float(x), float(y)


def _hinge(
    mechanism: Mechanism, parent: str | None, child: str, point: tuple[float, float]
) -> tuple[tuple[float, float], tuple[float, float]]:
    anchor = world_offset(mechanism, child, point)
    base = np.zeros(2) if parent is None else mechanism.pose[mechanism.body_index(parent), :2]
    arm = mechanism.pose[mechanism.body_index(child), :2] + anchor - base
    return (float(arm[0]), float(arm[1])), anchor
