"""The force elements of a mechanism evaluated all at once: generalised forces and potentials, one expression a kind."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.forces import ForceElement
from reference.joint_rows import stacked


@dataclass(frozen=True)
class ForceGroup:
    """Force elements of one kind, stacked so that one numpy expression serves them all."""

    element: Any  # of the kind, each numeric field an array with the elements along its first axis
    first: NDArray[np.intp]  # (elements,) index of the body; the ground is the index after the last body
    second: NDArray[np.intp]


@dataclass(frozen=True)
class AppliedForces:
    """All force elements between `bodies` bodies."""

    groups: tuple[ForceGroup, ...]
    bodies: int

    @classmethod
    def of(cls, forces: Sequence[ForceElement], index: Mapping[str | None, int]) -> AppliedForces:
        """Of elements between bodies whose places `index` gives by name, and the ground's, the last, under None."""
        kinds: dict[type, list[ForceElement]] = {}
        for element in forces:
            kinds.setdefault(type(element), []).append(element)
        groups = tuple(
            ForceGroup(
                element=stacked(members),
                first=np.array([index[element.first] for element in members]),
                second=np.array([index[element.second] for element in members]),
            )
            for members in kinds.values()
        )
        return cls(groups, index[None])

    @property
    def dissipate(self) -> bool:
        """Whether any depends on velocities."""
        return any(group.element.dissipates for group in self.groups)

    def on(self, pose: NDArray[Any], twist: NDArray[Any]) -> NDArray[Any]:
        """Generalised forces (..., bodies, 3) [N, N, N m] at poses and twists (..., bodies, 3) of one shape."""
        poses, twists = self._with_ground(pose), self._with_ground(twist)
        out = np.zeros(poses.shape, dtype=np.result_type(poses, twists, float))
        for group in self.groups:
            ends = (poses[..., group.first, :], poses[..., group.second, :])
            forces = group.element.on(*ends, twists[..., group.first, :], twists[..., group.second, :])
            for place in range(len(group.first)):  # several elements may pull at one body
                out[..., group.first[place], :] += forces[..., place, :3]
                out[..., group.second[place], :] += forces[..., place, 3:]
        return out[..., :-1, :]

    def potential(self, pose: NDArray[Any]) -> NDArray[Any]:
        """The sum of the elements' potentials (...) [J] at poses (..., bodies, 3)."""
        poses = self._with_ground(pose)
        out = np.zeros(poses.shape[:-2], dtype=np.result_type(poses, float))
        for group in self.groups:
            out = out + group.element.potential(poses[..., group.first, :], poses[..., group.second, :]).sum(axis=-1)
        return out

    def _with_ground(self, values: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([values, np.zeros((*values.shape[:-2], 1, 3), dtype=values.dtype)], axis=-2)
