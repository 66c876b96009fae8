"""Numbers in which many mechanisms of one shape differ: read, checked, and what of a mechanism follows from them."""

from __future__ import annotations

import typing
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from engines.lagrange.flat import MOST_ROWS
from reference.checks import InvalidMechanism, shown
from reference.kinds import NOT_TAKEN, Floats, kind_of, of_shape
from reference.mechanism import Mechanism, open_joint
from reference.rolling.roll import Roll
from reference.rows import JointRows, ranks
from reference.scales import length_scale, time_scale

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Part:
    """A body, joint or force, and those of its numbers that differ: (mechanisms,) or (mechanisms, n) each."""

    usual: Any
    differing: Mapping[str, Array]

    @classmethod
    def of(cls, owner: str, usual: Any, given: Mapping[str, Any]) -> Part:
        """With arrays as they are given; raises InvalidMechanism for what is no number of its, or can't be one."""
        hints = typing.get_type_hints(type(usual), include_extras=True)
        known = [] if isinstance(usual, Roll) else [name for name, value in usual.__dict__.items() if is_number(value)]
        found: dict[str, Array] = {}
        for name, values in given.items():
            if name not in known:
                there = ", ".join(known) or "none that may differ"
                raise InvalidMechanism(f"varied: {owner} has no number {shown(name)}; there are {there}")
            shape, single = np.shape(getattr(usual, name)), kind_of(hints[name])
            kind = kind_of(Annotated[Floats, of_shape("mechanisms", *shape)])
            found[name] = kind.take(values)
            if found[name] is NOT_TAKEN:
                raise InvalidMechanism(f"varied: {owner}: {name} is {shown(values)}; it must be {kind.words}")
            for number, value in enumerate(found[name].tolist() if not shape else ()):
                if single.take(value) is NOT_TAKEN:
                    raise InvalidMechanism(
                        f"varied: {owner}: {name} of mechanism {number} is {value}; it must be {single.words}"
                    )
        return cls(usual, found)

    def some(self, which: slice) -> Part:
        """That of some mechanisms."""
        return Part(self.usual, {name: values[which] for name, values in self.differing.items()})

    def together(self) -> Any:
        """It with arrays in place of these numbers; a vector's components come first, (n, mechanisms)."""
        return _with(self.usual, {name: values.T for name, values in self.differing.items()})

    def each(self, count: int) -> list[Any]:
        """That of every mechanism, unchecked."""
        if not self.differing:
            return [self.usual] * count
        columns = [
            [tuple(value) for value in values.tolist()] if values.ndim > 1 else values.tolist()
            for values in self.differing.values()
        ]
        return [_with(self.usual, dict(zip(self.differing, row, strict=True))) for row in zip(*columns, strict=True)]


def is_number(value: Any) -> bool:
    """Whether a field of a joint or force is a number, or a vector of them."""
    return isinstance(value, float) or (isinstance(value, tuple) and all(isinstance(each, float) for each in value))


def _with(usual: Any, values: Mapping[str, Any]) -> Any:
    changed = copy(usual)  # not made anew: arrays are no valid fields of one joint
    changed.__dict__.update(values)
    return changed


@dataclass(frozen=True)
class Differing:
    """Mechanisms that are as one but for numbers: bodies, joints and forces, and gravity (mechanisms, 2)."""

    mechanism: Mechanism
    bodies: Sequence[Part]
    joints: Sequence[Part]
    forces: Sequence[Part]
    gravity: Array
    pose: Array  # (mechanisms, bodies, 3)
    twist: Array

    def some(self, which: slice) -> Differing:
        """Some of the mechanisms."""
        bodies, joints, forces = (
            [part.some(which) for part in group] for group in (self.bodies, self.joints, self.forces)
        )
        rest = self.gravity[which], self.pose[which], self.twist[which]
        return Differing(self.mechanism, bodies, joints, forces, *rest)

    def rates(self) -> list[Array | float]:
        """The right side of every row, as in `Mechanism.rate`: a number, or one of each mechanism."""
        return [value for part in self.joints for value in part.together().rate]

    def scales(self) -> tuple[Array, Array]:
        """Lengths and times (mechanisms,) [m, s]: those of `Mechanism`, one mechanism after another."""
        count = len(self.gravity)
        same = not any(part.differing for group in (self.joints, self.forces) for part in group)
        bodies, joints, forces = (
            list(zip(*(part.each(count) for part in group), strict=True)) or [()] * count
            for group in (self.bodies, self.joints, self.forces)
        )
        lengths, times = np.empty((2, count))
        falls = self.gravity.tolist()
        for number, own in enumerate(zip(bodies, joints, forces, strict=True)):
            lengths[number] = length = self.mechanism.length_scale if same else length_scale(*own)
            times[number] = time_scale(length, falls[number], *own)
        return lengths, times

    def joint_rows(self) -> JointRows:
        """The rows of all joints in all mechanisms, to be evaluated at poses (mechanisms, bodies, 3)."""
        index: dict[str | None, int] = {body.name: i for i, body in enumerate(self.mechanism.bodies)}
        rows = JointRows.of([self._wide(part) for part in self.joints], {**index, None: len(index)})
        groups = []
        for group in rows.groups:
            # Stacked joints have the joints along their first axis, here the mechanisms come before them.
            wide = {n: np.moveaxis(v, 0, 1) for n, v in group.joint.__dict__.items() if isinstance(v, np.ndarray)}
            groups.append(group if isinstance(group.joint, Roll) else replace(group, joint=_with(group.joint, wide)))
        return replace(rows, groups=tuple(groups))

    def _wide(self, part: Part) -> Any:
        if isinstance(part.usual, Roll):
            return part.usual
        numbers = {name: value for name, value in part.usual.__dict__.items() if is_number(value)}
        count = len(self.gravity)
        return _with(
            part.usual,
            {
                n: part.differing.get(n, np.broadcast_to(value, (count, *np.shape(value))))
                for n, value in numbers.items()
            },
        )

    def refuse_bad_starts(self, lengths: Array, dependent: bool, begin: int) -> None:
        """Raise InvalidMechanism for what `reference.mechanism` refuses, and for rows whose dependence is another one.

        lengths (mechanisms,) [m]; dependent: whether some rows of the first mechanism follow from others; begin: which
        mechanism the first one here is.
        """
        for part in self.forces:
            ends = [
                None if name is None else self.mechanism.body_index(name)
                for name in (part.usual.first, part.usual.second)
            ]
            first, second = (np.zeros_like(self.pose[:, 0]) if end is None else self.pose[:, end] for end in ends)
            on = _with(part.usual, part.differing).on(first, second, np.zeros_like(first), np.zeros_like(first))
            lost = np.flatnonzero(~np.isfinite(on).all(axis=-1))
            if len(lost):
                raise InvalidMechanism(
                    f"varied: force {part.usual.name!r} of mechanism {begin + lost[0]}: at t = 0 its two points "
                    "coincide, so it has no direction; move one of them"
                )
        rows, count = self.mechanism.row_count, len(self.gravity)
        if not rows:
            return
        joints = self.joint_rows()
        rates = np.stack([np.broadcast_to(rate, count) for rate in self.rates()], axis=-1)
        gap, slip = joints.gap(self.pose, np.zeros(count)), joints.velocities(self.pose, self.twist) - rates
        sentence = open_joint(self.mechanism, gap, slip, self.pose, self.twist, lengths, begin)
        if sentence is not None:
            raise InvalidMechanism(f"varied: {sentence}")
        if rows > min(MOST_ROWS, 3 * len(self.mechanism.bodies)):  # then it is the same for all
            return
        other = np.flatnonzero((ranks(joints.dense(self.pose), lengths) < rows) != dependent)
        if len(other):
            own, usual = ("independent", "dependent") if dependent else ("dependent", "independent")
            raise InvalidMechanism(
                f"varied: at t = 0 the rows of mechanism {begin + other[0]} are {own}, but those of the mechanism that "
                f"it varies are {usual}; give it a batch of its own"
            )
