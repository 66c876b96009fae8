"""The velocity rows J of a mechanism and the sum of its forces. Elements of one class are evaluated together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism, require_room
from reference.couplings import Coupling
from reference.forces import CoupledForce, Ends, ForceElement
from reference.joints import Joint


def _with_ground(values: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([values, np.zeros((*values.shape[:-2], 1, 3), dtype=values.dtype)], axis=-2)


@dataclass(frozen=True)
class JointGroup:
    """Joints of one class that are evaluated together, or one term of a coupling.

    joint: each numeric field is an array with the joints along its first axis. first, second (joints,): indices of the
    bodies; the ground has the index after the last body. rows (joints, size): indices of the rows in the mechanism.
    adds: whether the group is a second or later term of a coupling, so that its rows are added. offset: constant of a
    coupling, which the gap of the first term subtracts.
    """

    joint: Any
    first: NDArray[np.intp]
    second: NDArray[np.intp]
    rows: NDArray[np.intp]
    adds: bool = False
    offset: float = 0.0

    def blocks(self, everything: NDArray[Any]) -> NDArray[Any]:
        return self.joint.rows(everything[..., self.first, :], everything[..., self.second, :])

    def places(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows and columns (joints, size, 6) of the entries of `blocks`; the ground's columns are the last three."""
        ends = 3 * np.stack([self.first, self.second], axis=-1)[..., None] + np.arange(3)  # (joints, 2, 3)
        columns = np.broadcast_to(ends.reshape(-1, 1, 6), (*self.rows.shape, 6))
        return np.broadcast_to(self.rows[..., None], columns.shape), columns


@dataclass(frozen=True)
class JointRows:
    """The velocity rows of all joints, in order; `bodies` and `count` are the numbers of bodies and rows."""

    groups: tuple[JointGroup, ...]
    bodies: int
    count: int

    @classmethod
    def of(cls, joints: Sequence[Joint], index: Mapping[str | None, int]) -> JointRows:
        """From joints; `index` maps names of bodies to their indices, and None, the ground, to the last index."""
        by_class: dict[Any, list[tuple[Joint, range]]] = {}  # joints that are not stackable have separate entries
        start, terms = 0, list[JointGroup]()
        for joint in joints:
            if isinstance(joint, Coupling):
                for number, term in enumerate(joint.terms):
                    first, second = np.array([[index[term.first]], [index[term.second]]])
                    offset = 0.0 if number else joint.offset
                    terms.append(JointGroup(term, first, second, np.array([[start]]), number > 0, offset))
                start += 1
                continue
            key = type(joint) if joint.stackable else joint.name
            by_class.setdefault(key, []).append((joint, range(start, start + joint.size)))
            start += joint.size
        groups = tuple(
            JointGroup(
                joint=stacked([joint for joint, _ in members]),
                first=np.array([index[joint.first] for joint, _ in members]),
                second=np.array([index[joint.second] for joint, _ in members]),
                rows=np.array([list(indices) for _, indices in members]),
            )
            for members in by_class.values()
        )
        return cls((*groups, *terms), index[None], start)

    def with_ground(self, pose: NDArray[Any]) -> NDArray[Any]:
        """Poses or twists (..., bodies, 3) with zeros for the ground at the end."""
        if pose.shape[-2:] != (self.bodies, 3):
            raise InvalidMechanism(
                f"mechanism: poses have the shape {pose.shape}; they must be of (..., {self.bodies}, 3), "
                "x, y and angle of every body"
            )
        return _with_ground(pose)

    def gap(self, pose: NDArray[Any], t: NDArray[Any]) -> NDArray[Any]:
        everything = self.with_ground(pose)
        out = np.full((*everything.shape[:-2], self.count), np.nan, dtype=everything.dtype)
        for group in self.groups:
            if group.joint.holonomic:
                first, second = everything[..., group.first, :], everything[..., group.second, :]
                gap = group.joint.gap(first, second, t[..., None])
                out[..., group.rows] = out[..., group.rows] + gap if group.adds else gap - group.offset
        return out

    def dense(self, pose: NDArray[Any]) -> NDArray[Any]:
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
        """J v (..., rows) at the cost O(joints), compared with O(joints * bodies) for a dense J."""
        poses, twists = self.with_ground(pose), self.with_ground(twist)
        leading = np.broadcast_shapes(poses.shape[:-2], twists.shape[:-2])
        out = np.zeros((*leading, self.count), dtype=np.result_type(poses, twists, float))
        for group in self.groups:
            ends = np.concatenate([twists[..., group.first, :], twists[..., group.second, :]], axis=-1)
            out[..., group.rows] += (group.blocks(poses) @ ends[..., None])[..., 0]
        return out


def stacked(joints: Sequence[Any]) -> Any:
    """One object for several joints or force elements of one class, with arrays as numeric fields."""
    if not joints[0].stackable:
        return joints[0]
    numeric = [f.name for f in fields(joints[0]) if f.name not in ("name", "first", "second")]
    stacked = copy(joints[0])  # not validated, since fields of a joint may not be arrays
    stacked.__dict__.update({name: np.array([getattr(joint, name) for joint in joints]) for name in numeric})
    return stacked


@dataclass(frozen=True)
class ForceGroup:
    """Force elements of one class, which are evaluated together.

    element: an object of the class whose numeric fields are arrays with the elements along the first axis. first,
    second (elements,): indices of the bodies; the ground has the index after the last body.
    """

    element: Any
    first: NDArray[np.intp]
    second: NDArray[np.intp]


@dataclass(frozen=True)
class AppliedForces:
    groups: tuple[ForceGroup, ...]
    bodies: int
    coupled: tuple[tuple[CoupledForce, Ends], ...] = ()

    @classmethod
    def of(cls, forces: Sequence[ForceElement], index: Mapping[str | None, int]) -> AppliedForces:
        """Group the elements by class. In `index` None is the ground."""
        by_class: dict[type, list[Any]] = {}
        coupled: list[tuple[CoupledForce, Ends]] = []
        for element in forces:
            if isinstance(element, CoupledForce):
                coupled.append((element, tuple((index[term.first], index[term.second]) for term in element.terms)))
            else:
                by_class.setdefault(type(element), []).append(element)
        groups = tuple(
            ForceGroup(
                element=stacked(members),
                first=np.array([index[element.first] for element in members]),
                second=np.array([index[element.second] for element in members]),
            )
            for members in by_class.values()
        )
        return cls(groups, index[None], tuple(coupled))

    @property
    def dissipate(self) -> bool:
        elements = (*(group.element for group in self.groups), *(element for element, _ in self.coupled))
        return any(element.dissipates for element in elements)

    def on(self, pose: NDArray[Any], twist: NDArray[Any]) -> NDArray[Any]:
        """Generalised forces (..., bodies, 3) [N, N, N m] at poses and twists of the same shape."""
        poses, twists = _with_ground(pose), _with_ground(twist)
        out = np.zeros(poses.shape, dtype=np.result_type(poses, twists, float))
        for group in self.groups:
            ends = (poses[..., group.first, :], poses[..., group.second, :])
            forces = group.element.on(*ends, twists[..., group.first, :], twists[..., group.second, :])
            for index in range(len(group.first)):  # a loop, since several elements may act on one body
                out[..., group.first[index], :] += forces[..., index, :3]
                out[..., group.second[index], :] += forces[..., index, 3:]
        for element, ends in self.coupled:
            element.push(poses, twists, ends, out)
        return out[..., :-1, :]

    def potential(self, pose: NDArray[Any]) -> NDArray[Any]:
        """The sum of the elements' potential energies (...) [J] at poses (..., bodies, 3)."""
        poses = _with_ground(pose)
        out = np.zeros(poses.shape[:-2], dtype=np.result_type(poses, float))
        for group in self.groups:
            out = out + group.element.potential(poses[..., group.first, :], poses[..., group.second, :]).sum(axis=-1)
        for element, ends in self.coupled:
            out = out + element.potential(poses, ends)
        return out
