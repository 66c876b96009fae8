"""The sum of the force elements of a mechanism, in which the elements of one class are evaluated together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.forces import CoupledForce, Ends, ForceElement
from reference.rows import stacked


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
        poses, twists = self._with_ground(pose), self._with_ground(twist)
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
        poses = self._with_ground(pose)
        out = np.zeros(poses.shape[:-2], dtype=np.result_type(poses, float))
        for group in self.groups:
            out = out + group.element.potential(poses[..., group.first, :], poses[..., group.second, :]).sum(axis=-1)
        for element, ends in self.coupled:
            out = out + element.potential(poses, ends)
        return out

    def _with_ground(self, values: NDArray[Any]) -> NDArray[Any]:
        return np.concatenate([values, np.zeros((*values.shape[:-2], 1, 3), dtype=values.dtype)], axis=-2)
