"""Copies of a mechanism with other numbers, for `run_batch`."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import Annotated, Any

import numpy as np

from engines.lagrange.records import System
from engines.lagrange.system import FORCE_FIELDS, JOINT_FIELDS, Key
from reference.checks import InvalidMechanism, Valid
from reference.forces import Force
from reference.joints import Body
from reference.mechanism import Mechanism
from reference.validators import Array, of_shape

States = Annotated[Array, of_shape("mechanisms", "bodies", 3)]

POINTS = {"first_point": ("first_x", "first_y"), "second_point": ("second_x", "second_y")}
GRAVITY = "gravity"
INVERSE_LENGTH: Key = ("constants", 0, "inverse_length")


@dataclass(frozen=True)
class ParameterSweep(Valid):
    """`count` copies of a mechanism with other numbers.

    numbers: arrays by "NAME.FIELD", for example "crank.mass" (count,) or "B.first_point" (count, 2), for fields of
        bodies, joints and forces; "gravity" (count, 2).
    pose, twist: the starts (count, bodies, 3) [m, m, rad]. None: the start of the mechanism is moved to the nearest
        pose and twist that satisfy the joints of each copy.

    Raises InvalidMechanism for unknown names, shapes that do not agree, and numbers that the mechanism refuses.
    """

    mechanism: Mechanism
    numbers: Any  # a mapping
    pose: States | None = None
    twist: States | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.numbers, Mapping) or not self.numbers:
            raise InvalidMechanism("sweep: it has no numbers; give arrays by name, such as {'crank.mass': masses}")
        sizes = {key: len(values) for key, values in self.arrays.items()}
        states = {"pose": self.pose, "twist": self.twist}
        sizes |= {name: len(state) for name, state in states.items() if state is not None}
        if len({*sizes.values()}) != 1:
            raise InvalidMechanism(f"sweep: the arrays have different numbers of mechanisms: {sizes}")
        for name, state in states.items():
            if state is not None and state.shape[1] != len(self.mechanism.bodies):
                raise InvalidMechanism(
                    f"sweep: {name} has {state.shape[1]} bodies; the mechanism has {len(self.mechanism.bodies)}"
                )

    def __len__(self) -> int:
        return len(next(iter(self.arrays.values())))

    @cached_property
    def arrays(self) -> dict[str, Array]:
        """The checked numbers by their key, (count,) or (count, 2)."""
        return {key: self._checked(key, values) for key, values in self.numbers.items()}

    def _checked(self, key: str, values: Any) -> Array:
        group, index, field = self._member(key)
        owner = getattr(self.mechanism, group)[index] if group else self.mechanism
        try:
            array = np.array(values, dtype=float)
        except (TypeError, ValueError):
            raise InvalidMechanism(f"sweep: {key!r} is no array of numbers") from None
        expected = np.shape(getattr(owner, field))
        if array.ndim != 1 + len(expected) or array.shape[1:] != expected or not len(array):
            words = ", ".join(["mechanisms", *map(str, expected)]) + "," * (not expected)
            raise InvalidMechanism(f"sweep: {key!r} has the shape {array.shape}; it must be ({words})")
        if not np.isfinite(array).all():
            raise InvalidMechanism(f"sweep: {key!r} has a value that is not finite")
        flat = array.reshape(len(array), -1)
        extremes = {int(i) for values in (flat, -flat, np.abs(flat)) for i in values.argmin(axis=0)}
        for number in extremes if group else ():
            _replaced(owner, field, array[number])  # raises InvalidMechanism for a number that the class refuses
        return array

    def _member(self, key: str) -> tuple[str, int, str]:
        """The group, the number in the group and the field; the group is empty for gravity."""
        if key == GRAVITY:
            return "", 0, key
        name, _, field = str(key).rpartition(".")
        found = [
            (group, index, field)
            for group in ("bodies", "joints", "forces")
            for index, element in enumerate(getattr(self.mechanism, group))
            if element.name == name and field in _record_fields(element)
        ]
        if len(found) == 1:
            return found[0]
        known = [
            f"{element.name}.{own}"
            for group in (self.mechanism.bodies, self.mechanism.joints, self.mechanism.forces)
            for element in group
            for own in _record_fields(element)
        ]
        count = "no" if not found else f"{len(found)}"
        raise InvalidMechanism(f"sweep: {key!r} names {count} numbers; there are {', '.join([GRAVITY, *known])}")

    def records(self, system: System) -> Iterator[tuple[Key, Array]]:
        """The changed numbers of the records of the mechanism's system, each with its values (count,)."""
        for key, array in self.arrays.items():
            group, index, field = self._member(key)
            if not group:
                yield from ((("constants", 0, f"gravity_{axis}"), array[:, k]) for k, axis in enumerate("xy"))
                continue
            names = _record_fields(getattr(self.mechanism, group)[index])[field]
            columns = (1 / array if group == "bodies" else array).reshape(len(array), -1).T
            yield from (((group, index, name), column) for name, column in zip(names, columns, strict=True))
            if field == "turning_rate":
                yield ("equations", int(system.joints[index]["row"]), "rate"), array
        lengths = self._lengths()
        if np.ptp(lengths):
            yield INVERSE_LENGTH, 1 / lengths

    def _lengths(self) -> Array:
        """The length scales (count,), up to a factor of three and without the points on the ground."""
        lengths = np.zeros(len(self))
        for element in (*self.mechanism.joints, *self.mechanism.forces):
            for field in _record_fields(element):
                name = {"first_point": element.first, "second_point": element.second, "length": ""}.get(field)
                if name is not None:
                    values = self.arrays.get(f"{element.name}.{field}", np.array([getattr(element, field)]))
                    lengths = np.maximum(lengths, np.abs(values).reshape(len(values), -1).max(axis=1))
        return np.where(lengths > 0, lengths, self.mechanism.length_scale)

    def alone(self, number: int, pose: Array, twist: Array) -> Mechanism:
        """One of the mechanisms, with a start (bodies, 3)."""
        changed: dict[str, list[Any]] = {
            group: list(getattr(self.mechanism, group)) for group in ("bodies", "joints", "forces")
        }
        gravity = self.mechanism.gravity
        for key, array in self.arrays.items():
            group, index, field = self._member(key)
            if group:
                changed[group][index] = _replaced(changed[group][index], field, array[number])
            else:
                gravity = tuple(array[number].tolist())
        states = zip(changed["bodies"], pose.tolist(), twist.tolist(), strict=True)
        changed["bodies"] = [replace(body, pose=tuple(q), twist=tuple(v)) for body, q, v in states]
        parts = {group: tuple(members) for group, members in changed.items()}
        return Mechanism(**parts, gravity=gravity)


def _replaced(element: Any, field: str, value: Array) -> Any:
    return replace(element, **{field: float(value) if value.ndim == 0 else tuple(value.tolist())})


def _record_fields(element: Any) -> dict[str, tuple[str, ...]]:
    """The fields of a body, joint or force that are numbers, with the names of their fields in a record."""
    if isinstance(element, Body):
        return {"mass": ("inverse_mass",), "inertia": ("inverse_inertia",)}
    _, attributes = (JOINT_FIELDS | FORCE_FIELDS).get(type(element), (None, {}))
    out = {attribute: (name,) for name, attribute in attributes.items()}
    own = {field.name for field in fields(element)}
    out |= {point: names for point, names in POINTS.items() if point in own}
    return out | ({"force": ("x", "y")} if isinstance(element, Force) else {})
