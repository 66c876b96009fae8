"""The force elements that act besides joints and gravity: springs, dampers, constant forces and torques.

The vocabulary is closed, like that of the joints: `FORCES` has every class. Besides the facts of `elements.Element`, an
element has two functions of the poses and twists of its two bodies (..., 3), which are zero for the ground:
`on(first, second, first_twist, second_twist)` is the generalised force (..., 6) [N, N, N m] on x, y and angle of the
first body and then of the second; `potential(first, second)` (...) [J] has the negative derivative `on` by the poses,
apart from damping. Both are analytic, so they can be differentiated by a complex step. The force
on the first body is opposite to that on the second.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, get_args

import numpy as np
from numpy.typing import NDArray

from reference.checks import Name, NonNegative, Positive
from reference.couplings import OfTerms
from reference.elements import BetweenTwo, Element, Pair, Place, UnitExponents, Vector
from reference.joints import Body
from reference.plane import apart, distance, from_body, length_of, point_rows

AnyArray = NDArray[Any]
Bodies = Mapping[str, Body]

# Extension of a spring, relative to its length, up to which it is rounding.
ROUNDED_EXTENSION = 1e-12


class ForceFacts(Element):
    """Base of force elements."""

    @property
    def dissipates(self) -> bool:
        """Whether the element takes energy and stores none."""
        return False

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        """The rate [1/s] of the motion that the force alone gives its bodies, at these points; `length` [m]."""
        raise NotImplementedError

    def fallback_length(self, span: float, is_guided: bool) -> float:
        """A length [m] for a mechanism whose points all coincide; `span` [m]: the distance of the points at t = 0.

        `is_guided`: a slot's line is the line of the force in all positions.
        """
        return 0.0


@dataclass(frozen=True)
class _ForceOfTwo(BetweenTwo, ForceFacts):
    """Base of the force elements between two bodies."""


class _Dissipative(_ForceOfTwo):
    """Base of the elements that take energy and store none."""

    @property
    def dissipates(self) -> bool:
        return True

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """Zero (...) [J]."""
        return np.zeros_like(first[..., 2] + second[..., 2])


@dataclass(frozen=True)
class Spring(_ForceOfTwo):
    """A linear massless spring between a point of each body: it pulls by stiffness (distance - rest length).

    stiffness [N/m]; rest_length [m], which may be zero; points [m] are in the bodies' own frames, from the centre of
    mass, on the ground (None) world coordinates. Shorter than its rest length it pushes.
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
        """The rest length, or the span if that is zero; the extension at t = 0 of a spring along a slot."""
        if not is_guided:
            return self.rest_length or span
        extension = abs(span - self.rest_length)
        return extension if extension > ROUNDED_EXTENSION * span else 0.0

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6) [N, N, N m]; NaN where the points coincide, unless the rest length is zero."""
        points = self.first_point, self.second_point
        vector, rows = apart(first, second, *points), point_rows(first, second, *points)
        rest = np.asarray(self.rest_length)
        with np.errstate(divide="ignore", invalid="ignore"):
            stretched = 1 - np.where(rest == 0, 0.0, rest / np.where(rest == 0, 1.0, length_of(vector)))
            pull = (np.asarray(self.stiffness) * stretched)[..., None]
            return -pull * (vector[..., 0, None] * rows[..., 0, :] + vector[..., 1, None] * rows[..., 1, :])

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """stiffness (distance - rest length)^2 / 2 (...) [J]."""
        length = length_of(apart(first, second, self.first_point, self.second_point))
        return 0.5 * np.asarray(self.stiffness) * (length - np.asarray(self.rest_length)) ** 2


@dataclass(frozen=True)
class Damper(_Dissipative):
    """A linear damper between a point of each body: damping times the rate at which their distance grows.

    damping [N s/m]; points [m] as of a Spring. Engines call a spring and a damper between the same points a damped
    spring.
    """

    acts_along_line: ClassVar[bool] = True
    unit_exponents: ClassVar[UnitExponents] = {"damping": (1, -1)}

    first_point: Vector
    second_point: Vector
    damping: Positive

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return self.damping * _inverse_mass(places, bodies)

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6) [N, N, N m]; NaN where the points coincide: it has no direction there."""
        _, row = distance(first, second, self.first_point, self.second_point)
        rate = np.sum(row[..., :3] * first_twist + row[..., 3:] * second_twist, axis=-1)
        return -(np.asarray(self.damping) * rate)[..., None] * row


@dataclass(frozen=True)
class TorsionSpring(_ForceOfTwo):
    """A linear torsion spring between two bodies: stiffness times (relative angle - rest angle).

    stiffness [N m/rad]; rest_angle [rad] of the second body against the first, the difference of the poses' angles, not
    wrapped.
    """

    unit_exponents: ClassVar[UnitExponents] = {"stiffness": (1, -2)}

    stiffness: Positive
    rest_angle: float = 0.0

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(self.stiffness * _inverse_inertia(self, bodies))

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6) [N, N, N m]: torques alone."""
        return _couple(-np.asarray(self.stiffness) * self._twisted(first, second))

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """stiffness (relative angle - rest angle)^2 / 2 (...) [J]."""
        return 0.5 * np.asarray(self.stiffness) * self._twisted(first, second) ** 2

    def _twisted(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """The angle (...) of the spring minus its rest angle [rad]."""
        return second[..., 2] - first[..., 2] - np.asarray(self.rest_angle)


@dataclass(frozen=True)
class TorsionDamper(_Dissipative):
    """A linear torsion damper between two bodies: damping [N m s/rad] times their relative rate of turning."""

    unit_exponents: ClassVar[UnitExponents] = {"damping": (1, -1)}

    damping: Positive

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return self.damping * _inverse_inertia(self, bodies)

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6) [N, N, N m]: torques alone."""
        return _couple(-np.asarray(self.damping) * (second_twist[..., 2] - first_twist[..., 2]))


@dataclass(frozen=True)
class Torque(_ForceOfTwo):
    """A constant torque [N m] on the second body, and its opposite on the first."""

    unit_exponents: ClassVar[UnitExponents] = {"torque": (1, -2)}

    torque: float

    def fastest_rate(self, places: tuple[Place, ...], bodies: Bodies, length: float) -> float:
        return math.sqrt(abs(self.torque) * _inverse_inertia(self, bodies))

    def on(self, first: AnyArray, second: AnyArray, first_twist: AnyArray, second_twist: AnyArray) -> AnyArray:
        """Generalised force (..., 6) [N, N, N m]."""
        return _couple(np.asarray(self.torque) + np.zeros_like(first[..., 2] + second[..., 2]))

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """Minus torque times relative angle (...) [J]."""
        return -np.asarray(self.torque) * (second[..., 2] - first[..., 2])


@dataclass(frozen=True)
class Force(ForceFacts):
    """A constant force (x, y) [N] in the world's directions, at a point of the second body.

    second_point [m] is in the body's own frame, from its centre of mass. `first` is always the ground.
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
        """Generalised force (..., 6) [N, N, N m]; the first body's share is zero."""
        arm_x, arm_y = from_body(second[..., 2], self.second_point)
        x, y = np.moveaxis(np.asarray(self.force), -1, 0)
        out = np.zeros((*arm_x.shape, 6), dtype=arm_x.dtype)
        out[..., 3], out[..., 4], out[..., 5] = x, y, arm_x * y - arm_y * x
        return out

    def potential(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """Minus force times position of the point (...) [J], zero at the world's origin."""
        arm_x, arm_y = from_body(second[..., 2], self.second_point)
        x, y = np.moveaxis(np.asarray(self.force), -1, 0)
        return -(x * (second[..., 0] + arm_x) + y * (second[..., 1] + arm_y))


@dataclass(frozen=True)
class CoupledForce(OfTerms, ForceFacts):
    """A tendon over several joints: force - stiffness (sum - rest) - damping rate, along the sum of `terms`.

    `rate` is that of the sum. If the sum is in metres: force [N], stiffness [N/m], damping [N s/m], rest [m]; if it is
    in rad or has no unit: [N m], [N m/rad], [N m s/rad], [rad]. Each body gets the force times the sum's derivative by
    its coordinates. See `couplings`; the functions take poses and twists of all bodies and, last, of the ground.
    """

    unit_exponents: ClassVar[UnitExponents] = {
        "force": (1, -2),
        "stiffness": (1, -2),
        "damping": (1, -1),
    }

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
        """The sum (...) of the terms at poses (..., bodies + 1, 3); `ends` has the indices of each term's bodies."""
        return sum(
            (term.value(poses[..., a, :], poses[..., b, :]) for term, (a, b) in zip(self.terms, ends, strict=True)),
            np.zeros(poses.shape[:-2]),
        )

    def push(self, poses: AnyArray, twists: AnyArray, ends: Ends, out: AnyArray) -> None:
        """Add the generalised forces [N, N, N m] to `out` (..., bodies + 1, 3), at poses and twists of that shape."""
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
        """stiffness (sum - rest)^2 / 2 - force sum (...) [J]."""
        total = self.total(poses, ends)
        return 0.5 * self.stiffness * (total - self.rest) ** 2 - self.force * total


ForceElement = Spring | Damper | TorsionSpring | TorsionDamper | Torque | Force | CoupledForce
# Every force class. Tables of forces in engines and tools are tested against this tuple.
FORCES: tuple[type[ForceElement], ...] = get_args(ForceElement)
Ends = tuple[tuple[int, int], ...]  # indices of the first and the second body of each term


def _inverse_mass(places: tuple[Place, ...], bodies: Bodies) -> float:
    """The largest inverse of the mass that a force between these points accelerates [1/kg]."""
    ends = [(bodies[name], point) for name, point in places if name is not None]
    return sum(1 / body.mass + (x * x + y * y) / body.inertia for body, (x, y) in ends)


def _inverse_inertia(element: BetweenTwo, bodies: Bodies) -> float:
    """The inverse of the inertia that a torque between the element's bodies accelerates [1/(kg m^2)]."""
    return sum(1 / bodies[name].inertia for name in (element.first, element.second) if name is not None)


def _couple(torque: AnyArray) -> AnyArray:
    """The generalised force (..., 6) of a torque (...) [N m] on the second body and its opposite on the first."""
    out = np.zeros((*torque.shape, 6), dtype=torque.dtype)
    out[..., 2], out[..., 5] = -torque, torque
    return out
