"""A mechanism as a tree of planar joints and the loops that close it, and the way from tree coordinates to poses.

Each body's frame is parallel to the world's at t = 0 and stands at the centre of mass there, so that all tree
coordinates are zero at the start: the mechanism begins assembled, exactly, and angles are never wrapped.
"""

from __future__ import annotations

import math
from collections import defaultdict, deque
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from engines.contract import Unsupported
from engines.remembered import by_identity
from reference.joints import Drive, Joint, Pin, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.plane import components
from reference.rolling.roll import Roll

Array = NDArray[np.float64]
Holding = Pin | Slot | Weld  # the joints that may hold a link

# CPU time [s] of the force elements at one state, see `pushes`.
TREE_FORCES_COST = 250e-6


@dataclass(frozen=True)
class Link:
    """A body in the tree: hinged on its parent by a pin, sliding in it by a slot, or moving freely if it has neither.

    A weld is a hinge that doesn't turn.

    `parent` is a body's index, or None for the ground. `arm` is the joint seen from the parent's centre of mass (from
    the world's origin if that is the ground), `anchor` the same point from the body's own, and `direction` the slot's
    line, all (x, y) [m] with world directions at t = 0. `column` is its first tree coordinate. In order, a free body
    has x, y and a rotation, a hinged one a rotation, one in a slot the way along it and, if it `turns`, a rotation.
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
        """How many of its coordinates are lengths: they come first."""
        return {"free": 2, "hinge": 0, "slot": 1}[self.kind]

    @property
    def columns(self) -> range:
        """Its tree coordinates."""
        return range(self.column, self.column + self.slides + self.turns)

    @property
    def rotation(self) -> int | None:
        """The tree coordinate that turns this body against its parent, if it has one."""
        return self.columns[-1] if self.turns else None


@dataclass(frozen=True)
class Tree:
    """Links, parents before children, and the joints that no link stands for."""

    mechanism: Mechanism
    links: tuple[Link, ...]
    loops: tuple[Pin | Slot | Weld, ...]
    kept: tuple[Drive, ...] = ()  # drives of rate zero that hold because the tree has no rotation there

    @cached_property
    def coordinates(self) -> int:
        return sum(len(link.columns) for link in self.links)

    @cached_property
    def _held(self) -> frozenset[str]:
        closing = {joint.name for joint in self.loops}
        holding = (joint.name for joint in self.mechanism.joints if isinstance(joint, Holding))
        return frozenset((*(name for name in holding if name not in closing), *(drive.name for drive in self.kept)))

    def holds(self, joint: Joint) -> bool:
        """Whether the tree's coordinates satisfy the joint by themselves."""
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
        """Whether rows of a solver hold the joint like one that closes a loop: neither the tree, nor a driven
        coordinate, skates and rolls not counted."""
        return joint.name in self._looping

    @property
    def closed(self) -> bool:
        """Whether any joint is held by a row of the solver: skates and rolls not counted."""
        return bool(self._looping)

    def turning(self, first: str | None, second: str | None) -> dict[int, float]:
        """The tree coordinates whose sum, with these signs, is the rotation of the second body against the first."""
        signs: dict[int, float] = {}
        for name, sign in ((second, 1.0), (first, -1.0)):
            for link in self.path_to_ground(name):
                if link.rotation is not None:
                    signs[link.rotation] = signs.get(link.rotation, 0.0) + sign
        return {column: sign for column, sign in sorted(signs.items()) if sign}

    def path_to_ground(self, name: str | None) -> Iterator[Link]:
        """The links from a body to the ground, the body's own first; none for the ground."""
        body = None if name is None else self.mechanism.body_index(name)
        while body is not None:
            link = self._link_of[body]
            yield link
            body = link.parent

    @cached_property
    def _link_of(self) -> dict[int, Link]:
        return {link.body: link for link in self.links}

    @cached_property
    def geared(self) -> tuple[Drive, ...]:
        """The drives that no single coordinate stands for."""
        drives = [joint for joint in self.mechanism.joints if isinstance(joint, Drive) and joint not in self.kept]
        return tuple(drive for drive in drives if len(self.turning(drive.first, drive.second)) != 1)

    def start_rates(self) -> Array:
        """The tree velocities (coordinates,) [m/s, rad/s] of the mechanism's start."""
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
        """Poses, twists and accelerations (times, bodies, 3) of tree motions (times, coordinates) [m, rad, s].

        NaN where these are not finite.
        """
        pose, twist, change = np.empty((3, len(position), len(self.mechanism.bodies), 3))
        with np.errstate(all="ignore"):
            states = self._states(position.T, velocity.T, acceleration.T, np.cos, np.sin)
        for body, state in enumerate(states):
            for part, begin in ((pose, 0), (twist, 3), (change, 6)):
                part[:, body, 0], part[:, body, 1], part[:, body, 2] = state[begin : begin + 3]
        pose[..., 2] += self.mechanism.pose[:, 2]
        return pose, twist, change

    def instant(self, position: Array, velocity: Array) -> tuple[Array, Array]:
        """Poses and twists (bodies, 3) at tree coordinates and rates (coordinates,): `motion` of one time.

        In plain floats, which for one time are ten times as fast as arrays. NaN where one of these is not finite.
        """
        if not (np.isfinite(position).all() and np.isfinite(velocity).all()):
            pose, twist = np.full((2, len(self.mechanism.bodies), 3), math.nan)
            return pose, twist
        rest = [0.0] * self.coordinates
        states = np.array(self._states(position.tolist(), velocity.tolist(), rest, math.cos, math.sin))
        pose, twist = states[:, :3], states[:, 3:6]
        pose[:, 2] += self.mechanism.pose[:, 2]
        return pose, twist

    def _states(self, way: Any, rate: Any, gain: Any, cos: Any, sin: Any) -> list[tuple[Any, ...]]:
        """By body x, y and by how much it has turned, the rates of these, and the rates of those.

        `way`, `rate`, `gain`: by tree coordinate a float, or an array of times, with the functions that take such.
        Bodies turn by the angle's change, not by the angle: at t = 0 the pose is then the start, to rounding.
        """
        start = self.mechanism.pose.tolist()
        ground = (0.0,) * 9
        states = [ground] * len(start)
        for link in self.links:
            column, last = link.column, link.column + link.slides
            x, y, turned, vx, vy, spin, ax, ay, spun = ground if link.parent is None else states[link.parent]
            own_turned, own_spin, own_spun = turned, spin, spun
            if link.turns:
                own_turned, own_spin, own_spun = turned + way[last], spin + rate[last], spun + gain[last]
            if link.kind == "free":
                x, y = start[link.body][0] + way[column], start[link.body][1] + way[column + 1]
                vx, vy, ax, ay = rate[column], rate[column + 1], gain[column], gain[column + 1]
            else:
                cosine, sine = cos(turned), sin(turned)
                arm_x, arm_y = link.arm
                if link.kind == "slot":
                    along_x, along_y = link.direction
                    arm_x, arm_y = arm_x + way[column] * along_x, arm_y + way[column] * along_y
                    along_x, along_y = cosine * along_x - sine * along_y, sine * along_x + cosine * along_y
                    vx, vy = vx + rate[column] * along_x, vy + rate[column] * along_y
                    coriolis = 2 * spin * rate[column]
                    ax = ax + gain[column] * along_x - coriolis * along_y
                    ay = ay + gain[column] * along_y + coriolis * along_x
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
    """Poses (bodies, 3) [m, m, rad], and what force elements do to bodies (bodies, 3) [N, N, N m].

    For engines that have no springs, or springs of another law: as their users do, before every step. position,
    velocity (coordinates,): tree coordinates [m, rad] and their rates. NaN where these are NaN or infinite.
    """
    pose, twist = tree.instant(position, velocity)
    return pose, np.asarray(tree.mechanism.applied.on(pose, twist), dtype=np.float64)


def spanning_tree(mechanism: Mechanism, hanging: bool = True) -> Tree:
    """The tree that grows breadth first from the ground along welds, pins and slots; all it doesn't reach moves freely.

    Not `hanging`, every body moves freely. Every one of them that holds no link is a loop. A slot holds a link
    where its slotted body comes first; welds are preferred, then pins. A drive of rate zero across it keeps the
    angle. The trees of the last mechanisms are kept: a report asks for one once a joint.
    """
    return _tree_of(mechanism, hanging)


@by_identity()
def _tree_of(mechanism: Mechanism, hanging: bool) -> Tree:
    joints = [joint for joint in mechanism.joints if isinstance(joint, Holding)]
    resting = [joint for joint in mechanism.joints if isinstance(joint, Drive) and joint.turning_rate == 0]
    links: list[Link] = []
    kept: list[Drive] = []
    holding: set[str] = set()
    order = (Weld, Pin, Slot)
    for name, parent, joint in _hung(mechanism, sorted(joints, key=lambda j: order.index(type(j))) if hanging else []):
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
        holding.add(joint.name)
    return Tree(mechanism, tuple(links), tuple(joint for joint in joints if joint.name not in holding), tuple(kept))


def _hung(mechanism: Mechanism, joints: list[Holding]) -> Iterator[tuple[str, str | None, Holding | None]]:
    """Every body, breadth first from the ground, with its parent and the joint between them; None for free bodies."""
    placed: set[str | None] = {None}
    joints_of = defaultdict[str | None, list[Holding]](list)
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
                    assert child is not None  # the ground is placed first
                    placed.add(child)
                    frontier.append(child)
                    yield child, parent, joint


def world_offset(mechanism: Mechanism, name: str | None, point: tuple[float, float]) -> tuple[float, float]:
    """A body's own point, from its centre of mass, with world directions at t = 0 [m]."""
    if name is None:
        return point
    x, y = components(mechanism.pose[mechanism.body_index(name), 2], *point)
    return float(x), float(y)


def refuse_slots_in_loops(tree: Tree, engine: str) -> None:
    """Raises Unsupported for slots that no coordinate of the tree stands for."""
    for joint in tree.loops:
        if isinstance(joint, Slot):
            raise Unsupported(f"joint {joint.name!r}: our adapter of {engine} builds no slot that closes a loop")
