"""A mechanism as a tree of planar joints with loop-closing joints, and poses from tree coordinates.

At t = 0 the frame of a body is parallel to the world's frame, and its origin is the centre of mass. All tree
coordinates are zero at t = 0, so the mechanism is assembled exactly. Angles are never wrapped.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeVar

import numpy as np
from numpy.typing import NDArray

from engines.remembered import by_identity
from reference.joints import Drive, Joint, Pin, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.plane import components
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
TreeJoint = Pin | Slot | Weld  # joints that can connect a link to its parent
Connecting = TypeVar("Connecting", bound=TreeJoint)

# CPU time of `pushes` [s].
TREE_FORCES_COST = 250e-6


@dataclass(frozen=True)
class Link:
    """A body in the tree, which is free or has a pin, weld or slot to its parent.

    A free body has the coordinates x, y and rotation. A body in a slot has a displacement along the slot and, if it
    `turns`, a rotation.

    parent: index of the parent body, or None for the ground.
    column: index of the body's first tree coordinate.
    arm (x, y) [m]: from the parent's centre of mass, or the world's origin, to the joint at t = 0.
    anchor (x, y) [m]: from the body's centre of mass to the joint at t = 0.
    direction (x, y): unit vector of the slot's line at t = 0.
    """

    body: int
    parent: int | None
    kind: Literal["free", "hinge", "slot"]
    column: int
    arm: tuple[float, float] = (0.0, 0.0)
    anchor: tuple[float, float] = (0.0, 0.0)
    direction: tuple[float, float] = (0.0, 0.0)
    turns: bool = True

    @property
    def slides(self) -> int:
        """The number of coordinates that are lengths, which precede the rotation."""
        return {"free": 2, "hinge": 0, "slot": 1}[self.kind]

    @property
    def columns(self) -> range:
        return range(self.column, self.column + self.slides + self.turns)

    @property
    def rotation(self) -> int | None:
        """The index of the body's rotation relative to the parent, or None."""
        return self.columns[-1] if self.turns else None


@dataclass(frozen=True)
class Tree:
    """Links, with parents before children, and the joints that close loops.

    kept: drives of rate zero between bodies that cannot turn relative to each other in the tree.
    """

    mechanism: Mechanism
    links: tuple[Link, ...]
    loops: tuple[Pin | Slot | Weld, ...]
    kept: tuple[Drive, ...] = ()

    @cached_property
    def coordinates(self) -> int:
        return sum(len(link.columns) for link in self.links)

    @cached_property
    def _held(self) -> frozenset[str]:
        closing = {joint.name for joint in self.loops}
        names = {joint.name for joint in self.mechanism.joints if isinstance(joint, TreeJoint)}
        return frozenset(names - closing | {drive.name for drive in self.kept})

    def holds(self, joint: Joint) -> bool:
        """Whether all values of the tree coordinates satisfy the joint."""
        return joint.name in self._held

    @cached_property
    def _looping(self) -> frozenset[str]:
        geared = {drive.name for drive in self.geared}
        return frozenset(
            joint.name
            for joint in self.mechanism.joints
            if not (self.holds(joint) or isinstance(joint, Skate | Roll))
            and (not isinstance(joint, Drive) or joint.name in geared)
        )

    def closes_by(self, joint: Joint) -> bool:
        """Whether a solver needs loop-closing rows for the joint.

        A skate, a roll, or a drive of a single tree coordinate needs no loop-closing rows.
        """
        return joint.name in self._looping

    @property
    def closed(self) -> bool:
        return bool(self._looping)

    def turning(self, first: str | None, second: str | None) -> dict[int, float]:
        """Factors by coordinate; their weighted sum is the rotation of the second body relative to the first."""
        signs: dict[int, float] = {}
        for name, sign in ((second, 1.0), (first, -1.0)):
            for link in self.path_to_ground(name):
                if link.rotation is not None:
                    signs[link.rotation] = signs.get(link.rotation, 0.0) + sign
        return {column: sign for column, sign in sorted(signs.items()) if sign}

    def path_to_ground(self, name: str | None) -> Iterator[Link]:
        """The links from a body to the ground, including the link of the body."""
        body = None if name is None else self.mechanism.body_index(name)
        while body is not None:
            link = self._link_of[body]
            yield link
            body = link.parent

    @cached_property
    def _link_of(self) -> dict[int, Link]:
        return {link.body: link for link in self.links}

    @cached_property
    def drives(self) -> tuple[Drive, ...]:
        """The drives that the tree coordinates do not satisfy by themselves."""
        return tuple(joint for joint in self.mechanism.joints if isinstance(joint, Drive) and joint not in self.kept)

    @cached_property
    def geared(self) -> tuple[Drive, ...]:
        return tuple(drive for drive in self.drives if len(self.turning(drive.first, drive.second)) != 1)

    @cached_property
    def unit_twists(self) -> Array:
        """The twists (coordinates, bodies * 3) at t = 0 due to a unit rate of each tree coordinate."""
        still = np.zeros(self.coordinates)
        twists = [self.instant(still, unit)[1].ravel() for unit in np.eye(self.coordinates)]
        return np.array(twists).reshape(self.coordinates, 3 * len(self.mechanism.bodies))

    def start_rates(self) -> Array:
        """The rates of the tree coordinates (coordinates,) [m/s, rad/s] at t = 0."""
        twist, rates = self.mechanism.twist, np.zeros(self.coordinates)
        ground = np.zeros(3)
        for link in self.links:
            own, base = twist[link.body], ground if link.parent is None else twist[link.parent]
            if link.kind == "free":
                rates[link.column : link.column + 2] = own[:2]
            if link.kind == "slot":
                (arm_x, arm_y), (x, y) = link.arm, link.anchor
                moving = own[:2] + own[2] * np.array([-y, x]) - base[:2] - base[2] * np.array([-arm_y, arm_x])
                rates[link.column] = moving @ np.array(link.direction)
            if link.rotation is not None:
                rates[link.rotation] = own[2] - base[2]
        return rates

    def motion(self, position: Array, velocity: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (times, bodies, 3) from tree coordinates and their derivatives (times,
        coordinates).

        Results are NaN at times with a coordinate that is not finite.
        """
        pose, twist, change = np.empty((3, len(position), len(self.mechanism.bodies), 3))
        with np.errstate(all="ignore"):
            states = self._states(position.T, velocity.T, acceleration.T, np.cos, np.sin)
        for body, state in enumerate(states):
            for values, begin in ((pose, 0), (twist, 3), (change, 6)):
                values[:, body, 0], values[:, body, 1], values[:, body, 2] = state[begin : begin + 3]
        pose[..., 2] += self.mechanism.pose[:, 2]
        return pose, twist, change

    def instant(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Poses and twists (bodies, 3) from tree coordinates and rates (coordinates,), NaN if a value is not finite."""
        if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
            pose, twist = np.full((2, len(self.mechanism.bodies), 3), math.nan)
            return pose, twist
        acceleration = [0.0] * self.coordinates
        states = np.array(self._states(position.tolist(), velocity.tolist(), acceleration, math.cos, math.sin))
        pose, twist = states[:, :3], states[:, 3:6]
        pose[:, 2] += self.mechanism.pose[:, 2]
        return pose, twist

    def _states(self, position: Any, rate: Any, change: Any, cos: Any, sin: Any) -> list[tuple[Any, ...]]:
        """x, y and the rotation since t = 0 of each body, with their first and second derivatives.

        position, rate, change: tree coordinates and their two derivatives, as floats or arrays of times.
        cos, sin: functions of floats or arrays.
        Rotations begin at zero, so the pose at t = 0 is equal to the mechanism's start up to rounding.
        """
        start = self.mechanism.pose.tolist()
        ground = (0.0,) * 9
        states = [ground] * len(start)
        for link in self.links:
            column, last = link.column, link.column + link.slides
            x, y, turned, vx, vy, spin, ax, ay, spun = ground if link.parent is None else states[link.parent]
            own_turned, own_spin, own_spun = turned, spin, spun
            if link.turns:
                own_turned, own_spin, own_spun = turned + position[last], spin + rate[last], spun + change[last]
            if link.kind == "free":
                x, y = start[link.body][0] + position[column], start[link.body][1] + position[column + 1]
                vx, vy, ax, ay = rate[column], rate[column + 1], change[column], change[column + 1]
            else:
                cosine, sine = cos(turned), sin(turned)
                arm_x, arm_y = link.arm
                if link.kind == "slot":
                    along_x, along_y = link.direction
                    arm_x, arm_y = arm_x + position[column] * along_x, arm_y + position[column] * along_y
                    along_x, along_y = cosine * along_x - sine * along_y, sine * along_x + cosine * along_y
                    vx, vy = vx + rate[column] * along_x, vy + rate[column] * along_y
                    coriolis = 2 * spin * rate[column]
                    ax = ax + change[column] * along_x - coriolis * along_y
                    ay = ay + change[column] * along_y + coriolis * along_x
                arm_x, arm_y = cosine * arm_x - sine * arm_y, sine * arm_x + cosine * arm_y
                cosine, sine = cos(own_turned), sin(own_turned)
                own_x, own_y = link.anchor
                own_x, own_y = cosine * own_x - sine * own_y, sine * own_x + cosine * own_y
                inward, own_inward = spin * spin, own_spin * own_spin
                x, y = x + arm_x - own_x, y + arm_y - own_y
                vx, vy = vx - spin * arm_y + own_spin * own_y, vy + spin * arm_x - own_spin * own_x
                ax = ax - spun * arm_y - inward * arm_x + own_spun * own_y + own_inward * own_x
                ay = ay + spun * arm_x - inward * arm_y - own_spun * own_x + own_inward * own_y
            states[link.body] = (x, y, own_turned, vx, vy, own_spin, ax, ay, own_spun)
        return states


def pushes(tree: Tree, position: Array, velocity: Array) -> tuple[Array, Array]:
    """Poses (bodies, 3) [m, m, rad], and the loads of force elements on bodies (bodies, 3) [N, N, N m].

    If a value is not finite, results are NaN.
    """
    pose, twist = tree.instant(position, velocity)
    return pose, np.asarray(tree.mechanism.applied.on(pose, twist), dtype=np.float64)


def spanning_tree(mechanism: Mechanism, hanging: bool = True) -> Tree:
    """The tree of a mechanism, built breadth first from the ground along welds, then pins, then slots.

    A body that the tree does not reach is free. Without `hanging`, all bodies are free. A slot connects a link to its
    parent only if the parent has the line; a drive of rate zero between the two bodies then removes the rotation. All
    other welds, pins and slots close loops. The last trees are cached.
    """
    return _tree_of(mechanism, hanging)


@by_identity()
def _tree_of(mechanism: Mechanism, hanging: bool) -> Tree:
    joints = [joint for joint in mechanism.joints if isinstance(joint, TreeJoint)]
    resting = [joint for joint in mechanism.joints if isinstance(joint, Drive) and joint.turning_rate == 0]
    links: list[Link] = []
    kept: list[Drive] = []
    connecting: set[str] = set()
    order = (Weld, Pin, Slot)
    candidates = sorted(joints, key=lambda joint: order.index(type(joint))) if hanging else []
    for name, parent, joint in with_parents(mechanism, candidates):
        body, column = mechanism.body_index(name), links[-1].columns.stop if links else 0
        if joint is None:
            links.append(Link(body, None, "free", column))
            continue
        base = None if parent is None else mechanism.body_index(parent)
        anchor = world_offset(mechanism, name, joint.second_point if name == joint.second else joint.first_point)
        at = mechanism.pose[body, :2] + anchor - (0.0 if base is None else mechanism.pose[base, :2])
        arm = (float(at[0]), float(at[1]))
        if isinstance(joint, Slot):
            angle = joint.line_angle + (0.0 if base is None else mechanism.bodies[base].pose[2])
            drives = [drive for drive in resting if {drive.first, drive.second} == {parent, name}]
            kept.extend(drives)
            direction = (math.cos(angle), math.sin(angle))
            links.append(Link(body, base, "slot", column, arm, anchor, direction, not drives))
        else:
            links.append(Link(body, base, "hinge", column, arm, anchor, turns=isinstance(joint, Pin)))
        connecting.add(joint.name)
    return Tree(mechanism, tuple(links), tuple(joint for joint in joints if joint.name not in connecting), tuple(kept))


def with_parents(
    mechanism: Mechanism, joints: Sequence[Connecting]
) -> Iterator[tuple[str, str | None, Connecting | None]]:
    """Triples (body, parent, joint to the parent) in the order of the tree; a free body has no parent and no joint."""
    placed: set[str | None] = {None}
    joints_of = defaultdict[str | None, list[Connecting]](list)
    for joint in joints:
        joints_of[joint.first].append(joint)
        joints_of[joint.second].append(joint)
    for start in (None, *(body.name for body in mechanism.bodies)):
        if start is not None:
            if start in placed:
                continue
            placed.add(start)
            yield start, None, None
        frontier = deque([start])
        while frontier:
            parent = frontier.popleft()
            for joint in joints_of[parent]:
                child = joint.second if joint.first == parent else joint.first
                hangs = joint.first == parent or (joint.second == parent and isinstance(joint, Pin | Weld))
                if hangs and child not in placed:
                    assert child is not None  # the ground is never a child
                    placed.add(child)
                    frontier.append(child)
                    yield child, parent, joint


def world_ends(mechanism: Mechanism, joint: Joint) -> list[tuple[int | None, tuple[float, float]]]:
    """For each point of a joint: the index of its body, None for the ground, and the `world_offset`."""
    return [
        (None if name is None else mechanism.body_index(name), world_offset(mechanism, name, point))
        for name, point in joint.points
    ]


def world_offset(mechanism: Mechanism, name: str | None, point: tuple[float, float]) -> tuple[float, float]:
    """The vector [m] from a body's centre of mass to a point of the body, in the world's axes at t = 0."""
    if name is None:
        return point
    x, y = components(mechanism.pose[mechanism.body_index(name), 2], *point)
    return float(x), float(y)
