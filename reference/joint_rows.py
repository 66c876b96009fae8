"""The joints of a mechanism evaluated all at once: gaps, velocity rows J, products J v; one numpy expression a kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism
from reference.joints import Joint
from reference.memory import require_room


@dataclass(frozen=True)
class JointGroup:
    """Joints of one kind, stacked so that one numpy expression serves them all."""

    joint: Any  # of the kind, each numeric field an array with the joints along its first axis
    first: NDArray[np.intp]  # (joints,) index of the body; the ground is the index after the last body
    second: NDArray[np.intp]
    rows: NDArray[np.intp]  # (joints, size) where their rows stand in the mechanism

    def blocks(self, everything: NDArray[Any]) -> NDArray[Any]:
        """Velocity rows (..., joints, size, 6) at poses of bodies and ground (..., bodies + 1, 3)."""
        return self.joint.rows(everything[..., self.first, :], everything[..., self.second, :])


@dataclass(frozen=True)
class JointRows:
    """The rows of all joints between `bodies` bodies, `count` rows in the order of the joints."""

    groups: tuple[JointGroup, ...]
    bodies: int
    count: int

    @classmethod
    def of(cls, joints: Sequence[Joint], index: Mapping[str | None, int]) -> JointRows:
        """Of joints between bodies whose places `index` gives by name, and the ground's, the last, under None."""
        kinds: dict[Any, list[tuple[Joint, range]]] = {}  # one that can't stack is a kind of its own
        start = 0
        for joint in joints:
            kind = type(joint) if getattr(joint, "stackable", True) else joint.name
            kinds.setdefault(kind, []).append((joint, range(start, start + joint.size)))
            start += joint.size
        groups = tuple(
            JointGroup(
                joint=stacked([joint for joint, _ in members]),
                first=np.array([index[joint.first] for joint, _ in members]),
                second=np.array([index[joint.second] for joint, _ in members]),
                rows=np.array([list(where) for _, where in members]),
            )
            for members in kinds.values()
        )
        return cls(groups, index[None], start)

    def with_ground(self, pose: NDArray[Any]) -> NDArray[Any]:
        """Poses or twists (..., bodies, 3) with the ground's, zero, after them."""
        if pose.shape[-2:] != (self.bodies, 3):
            raise InvalidMechanism(
                f"mechanism: poses have the shape {pose.shape}; they must be of (..., {self.bodies}, 3), "
                "x, y and angle of every body"
            )
        return np.concatenate([pose, np.zeros((*pose.shape[:-2], 1, 3), dtype=pose.dtype)], axis=-2)

    def gap(self, pose: NDArray[Any], t: NDArray[Any]) -> NDArray[Any]:
        """See `Mechanism.gap`."""
        everything = self.with_ground(pose)
        out = np.full((*everything.shape[:-2], self.count), np.nan, dtype=everything.dtype)
        for group in self.groups:
            if group.joint.holonomic:
                first, second = everything[..., group.first, :], everything[..., group.second, :]
                out[..., group.rows] = group.joint.gap(first, second, t[..., None])
        return out

    def dense(self, pose: NDArray[Any]) -> NDArray[Any]:
        """J (..., rows, 3 bodies), see `Mechanism.rows`."""
        everything = self.with_ground(pose)
        leading = everything.shape[:-2]
        kind = np.result_type(everything, float)
        shape = (*leading, self.count, self.bodies + 1, 3)
        require_room("mechanism: dense rows", shape, kind.itemsize)
        out = np.zeros(shape, dtype=kind)
        for group in self.groups:
            block = group.blocks(everything)
            out[..., group.rows, group.first[:, None], :] += block[..., 0:3]
            out[..., group.rows, group.second[:, None], :] += block[..., 3:6]
        return out[..., :-1, :].reshape((*leading, self.count, 3 * self.bodies))

    def velocities(self, pose: NDArray[Any], twist: NDArray[Any]) -> NDArray[Any]:
        """J v (..., rows) joint by joint: O(joints), where J alone is O(joints bodies)."""
        poses, twists = self.with_ground(pose), self.with_ground(twist)
        leading = np.broadcast_shapes(poses.shape[:-2], twists.shape[:-2])
        out = np.zeros((*leading, self.count), dtype=np.result_type(poses, twists, float))
        for group in self.groups:
            ends = np.concatenate([twists[..., group.first, :], twists[..., group.second, :]], axis=-1)
            out[..., group.rows] = (group.blocks(poses) @ ends[..., None])[..., 0]
        return out


def stacked(joints: Sequence[Any]) -> Any:
    """One joint, or force element, that stands for several of its kind: every numeric field becomes an array."""
    if not getattr(joints[0], "stackable", True):
        return joints[0]
    numeric = [f.name for f in fields(joints[0]) if f.name not in ("name", "first", "second")]
    stacked = copy(joints[0])  # not made anew: arrays are no valid fields of one joint
    stacked.__dict__.update({name: np.array([getattr(joint, name) for joint in joints]) for name in numeric})
    return stacked
