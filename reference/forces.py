"""The force elements: springs, dampers, constant forces and torques.

The tuple `FORCES` has all classes. Besides the properties of `elements.Element`, an element has two functions of the
poses and twists of its two bodies (..., 3), which are zero for the ground. `on(first, second, first_twist,
second_twist)` is the generalised force (..., 6) [N, N, N m] on x, y and angle of the first body, then of the second.
`potential(first, second)` (...) [J] is the potential energy; without damping, `on` is its negative derivative. Both
functions are analytic, so they can be differentiated by a complex step.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, get_args

import numpy as np

from reference.checks import Name, NonNegative, Positive
from reference.couplings import OfTerms
from reference.elements import BetweenTwo, Element, Pair, Place, UnitExponents, Vector
from reference.joints import Body
from reference.plane import AnyArray, apart, distance, from_body, length_of, point_rows

Bodies = Mapping[str, Body]

# Relative extension of a spring up to which the extension counts as a rounding error.
ROUNDED_EXTENSION = 1e-12


class ForceFacts(Element):
    """Base of force elements."""

    @property
    def dissipates(self) -> bool:
        """Whether the element dissipates energy and stores none."""
        return False

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        """The rate [1/s] of the bodies' motion under this force alone, in a mechanism of `length` [m]."""
        raise NotImplementedError

    def fallback_length(self, span: float, is_guided: bool) -> float:
        """A length [m] that is used if the points of each body coincide.

        span: the distance [m] of the element's points at t = 0. is_guided: the force acts along a slot's line at all
        times.
        """
        return 0.0


@dataclass(frozen=True)
class _ForceOfTwo(BetweenTwo, ForceFacts):
    pass


class _Dissipative(_ForceOfTwo):
    @property
    def dissipates(self) -> bool:
        return True

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return np.zeros_like(first[..., 2] + second[..., 2])


@dataclass(frozen=True)
class Spring(_ForceOfTwo):
    """A linear massless spring between a point of each body, with the tension stiffness * (distance - rest length).

    stiffness [N/m]; rest_length [m], which may be zero. Points [m] are in the bodies' own frames, from the centre of
    mass; points on the ground (None) are world coordinates.
    """

    acts_along_line: ClassVar[bool] = True
    unit_exponents: ClassVar[UnitExponents] = {"stiffness": (1, -2)}

    first_point: Vector
    second_point: Vector
    stiffness: Positive
    rest_length: NonNegative = 0.0

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(self.stiffness * _inverse_mass(places, bodies))

    def fallback_length(self, span: float, is_guided: bool) -> float:
        """The rest length, or the span if the rest length is zero. For a spring along a slot, the extension at t =
        0."""
        if not is_guided:
            return self.rest_length or span
        extension = abs(span - self.rest_length)
        return extension if extension > ROUNDED_EXTENSION * span else 0.0

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6), or NaN if the points coincide and the rest length is not zero."""
        points = self.first_point, self.second_point
        vector, rows = apart(first, second, *points), point_rows(first, second, *points)
        rest = np.asarray(self.rest_length)
        with np.errstate(divide="ignore", invalid="ignore"):
            stretched = 1 - np.where(rest == 0, 0.0, rest / np.where(rest == 0, 1.0, length_of(vector)))
            pull = (np.asarray(self.stiffness) * stretched)[..., None]
            return -pull * (vector[..., 0, None] * rows[..., 0, :] + vector[..., 1, None] * rows[..., 1, :])

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        length = length_of(apart(first, second, self.first_point, self.second_point))
        return 0.5 * np.asarray(self.stiffness) * (length - np.asarray(self.rest_length)) ** 2


@dataclass(frozen=True)
class Damper(_Dissipative):
    """A linear damper between a point of each body, with the tension damping times the rate of the distance.

    damping [N s/m]; points [m] as in `Spring`.
    """

    acts_along_line: ClassVar[bool] = True
    unit_exponents: ClassVar[UnitExponents] = {"damping": (1, -1)}

    first_point: Vector
    second_point: Vector
    damping: Positive

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return self.damping * _inverse_mass(places, bodies)

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6), or NaN if the points coincide, since the force then has no direction."""
        _, row = distance(first, second, self.first_point, self.second_point)
        rate = np.sum(row[..., :3] * first_twist + row[..., 3:] * second_twist, axis=-1)
        return -(np.asarray(self.damping) * rate)[..., None] * row


@dataclass(frozen=True)
class TorsionSpring(_ForceOfTwo):
    """A linear torsion spring between two bodies, with the torque stiffness * (relative angle - rest angle).

    stiffness [N m/rad]; rest_angle [rad] of the second body relative to the first. The relative angle is not wrapped.
    """

    unit_exponents: ClassVar[UnitExponents] = {"stiffness": (1, -2)}

    stiffness: Positive
    rest_angle: float = 0.0

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(self.stiffness * _inverse_inertia(self, bodies))

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        return _couple(-np.asarray(self.stiffness) * self._twisted(first, second))

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return 0.5 * np.asarray(self.stiffness) * self._twisted(first, second) ** 2

    def _twisted(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return second[..., 2] - first[..., 2] - np.asarray(self.rest_angle)


@dataclass(frozen=True)
class TorsionDamper(_Dissipative):
    """A linear torsion damper, whose torque is damping [N m s/rad] times the relative rotation rate of the bodies."""

    unit_exponents: ClassVar[UnitExponents] = {"damping": (1, -1)}

    damping: Positive

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return self.damping * _inverse_inertia(self, bodies)

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        return _couple(-np.asarray(self.damping) * (second_twist[..., 2] - first_twist[..., 2]))


@dataclass(frozen=True)
class Torque(_ForceOfTwo):
    """A constant torque [N m] on the second body, and its opposite on the first."""

    unit_exponents: ClassVar[UnitExponents] = {"torque": (1, -2)}

    torque: float

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(abs(self.torque) * _inverse_inertia(self, bodies))

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        return _couple(np.asarray(self.torque) + np.zeros_like(first[..., 2] + second[..., 2]))

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return -np.asarray(self.torque) * (second[..., 2] - first[..., 2])


@dataclass(frozen=True)
class Force(ForceFacts):
    """A constant force (x, y) [N] in the world's directions, at a point of the second body.

    second_point [m] is in the body's frame, from the centre of mass. `first` is always the ground.
    """

    first: ClassVar[None] = None
    unit_exponents: ClassVar[UnitExponents] = {"force": (1, -2)}

    name: Name
    second: Name
    second_point: Vector
    force: Vector

    @property
    def pairs(self) -> tuple[Pair, ...]:
        return ((None, self.second),)

    @property
    def points(self) -> tuple[Place, ...]:
        return ((self.second, self.second_point),)

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(math.hypot(*self.force) * _inverse_mass(places, bodies) / length)

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        arm_x, arm_y = from_body(second[..., 2], self.second_point)
        x, y = np.moveaxis(np.asarray(self.force), -1, 0)
        out = np.zeros((*arm_x.shape, 6), dtype=arm_x.dtype)
        out[..., 3], out[..., 4], out[..., 5] = x, y, arm_x * y - arm_y * x
        return out

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        arm_x, arm_y = from_body(second[..., 2], self.second_point)
        x, y = np.moveaxis(np.asarray(self.force), -1, 0)
        return -(x * (second[..., 0] + arm_x) + y * (second[..., 1] + arm_y))


@dataclass(frozen=True)
class CoupledForce(OfTerms, ForceFacts):
    """A tendon over several joints: the force along the sum of `terms` is force - stiffness * (sum - rest) - damping *
    rate.

    `rate` is the rate of the sum. The units of force, stiffness, damping and rest are N, N/m, N s/m and m, or N m, N
    m/rad, N m s/rad and rad if the sum is an angle. Each body gets the force times the derivative of the sum by the
    body's coordinates. The functions of this class have the poses and twists of all bodies as arguments, with the
    ground last.
    """

    unit_exponents: ClassVar[UnitExponents] = {"force": (1, -2), "stiffness": (1, -2), "damping": (1, -1)}

    force: float = 0.0
    stiffness: NonNegative = 0.0
    damping: NonNegative = 0.0
    rest: float = 0.0

    @property
    def dissipates(self) -> bool:
        return self.damping > 0

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        inverse_mass = sum(
            term.factor**2 * (1 / bodies[name].mass if term.sliding else 1 / bodies[name].inertia)
            for term in self.terms
            for name in (term.first, term.second)
            if name is not None
        )
        unit = length if self.terms[0].sliding else 1.0
        stiffness = max(self.stiffness, abs(self.force) / unit)
        return max(math.sqrt(stiffness * inverse_mass), self.damping * inverse_mass)

    def total(self, poses: AnyArray, ends: Ends) -> AnyArray:
        """The sum (...) of the terms at poses (..., bodies + 1, 3), with the indices `ends` of each term's bodies."""
        return sum(
            (term.value(poses[..., a, :], poses[..., b, :]) for term, (a, b) in zip(self.terms, ends, strict=True)),
            np.zeros(poses.shape[:-2]),
        )

    def push(self, poses: AnyArray, twists: AnyArray, ends: Ends, out: AnyArray) -> None:
        """Add the generalised forces to `out` (..., bodies + 1, 3), at poses and twists of the same shape."""
        rows = [
            term.rows(poses[..., a, :], poses[..., b, :])[..., 0, :]
            for term, (a, b) in zip(self.terms, ends, strict=True)
        ]
        rate = sum(
            np.sum(row[..., :3] * twists[..., a, :] + row[..., 3:] * twists[..., b, :], axis=-1)
            for row, (a, b) in zip(rows, ends, strict=True)
        )
        along = self.force - self.stiffness * (self.total(poses, ends) - self.rest) - self.damping * rate
        for row, (a, b) in zip(rows, ends, strict=True):
            out[..., a, :] += along[..., None] * row[..., :3]
            out[..., b, :] += along[..., None] * row[..., 3:]

    def potential(self, poses: AnyArray, ends: Ends) -> AnyArray:
        total = self.total(poses, ends)
        return 0.5 * self.stiffness * (total - self.rest) ** 2 - self.force * total


ForceElement = Spring | Damper | TorsionSpring | TorsionDamper | Torque | Force | CoupledForce
# Tests compare the tables of forces in engines and tools with this tuple.
FORCES: tuple[type[ForceElement], ...] = get_args(ForceElement)
Ends = tuple[tuple[int, int], ...]  # indices of the first and the second body of each term


def _inverse_mass(places: tuple[Place, ...], bodies: Bodies) -> float:
    ends = [(bodies[name], point) for name, point in places if name is not None]
    return sum(1 / body.mass + (x * x + y * y) / body.inertia for body, (x, y) in ends)


def _inverse_inertia(element: BetweenTwo, bodies: Bodies) -> float:
    return sum(1 / bodies[name].inertia for name in (element.first, element.second) if name is not None)


def _couple(torque: AnyArray) -> AnyArray:
    out = np.zeros((*torque.shape, 6), dtype=torque.dtype)
    out[..., 2], out[..., 5] = -torque, torque
    return out
