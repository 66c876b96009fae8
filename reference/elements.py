"""Properties of joints and force elements, with which tools can use an element without knowing its class.

An element has a `name`. The names `first` and `second` are those of bodies, or None for the ground. Points [m] are in
the bodies' own frames, from the centre of mass; points on the ground are world coordinates.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from reference.checks import Name, Valid

Vector = tuple[float, float]
Pair = tuple[str | None, str | None]  # The names of two bodies, with None for the ground.
Place = tuple[str | None, Vector]  # The name of a body, None for the ground, and a point in its frame [m].
UnitExponents = Mapping[str, tuple[int, int]]


class Element(Valid):
    """Base of joints and force elements.

    `stackable`: several elements of the class can be evaluated as one element with arrays in the numeric fields.
    `acts_along_line`: the element acts along the line between its two points.
    `unit_exponents`: a mapping from fields to the exponents of mass and time in the unit, 0 by default.
    """

    stackable: ClassVar[bool] = True
    acts_along_line: ClassVar[bool] = False
    unit_exponents: ClassVar[UnitExponents] = {}

    @property
    def pairs(self) -> tuple[Pair, ...]:
        """The pairs of bodies between which the element acts."""
        raise NotImplementedError

    @property
    def points(self) -> tuple[Place, ...]:
        """The points that define the element, in the order of the bodies."""
        return ()

    @property
    def fixed_points(self) -> tuple[Place, ...]:
        """The points of a body or the ground at which the element acts at all times."""
        return self.points

    def in_units(self, mass: float, time: float) -> Self:
        """The element with masses in units of `mass` [kg] and times in units of `time` [s]."""
        changes: dict[str, Any] = {}
        for field, (of_mass, of_time) in self.unit_exponents.items():
            value = getattr(self, field)
            divisor, factor = mass**of_mass, time**-of_time
            is_vector = isinstance(value, tuple)
            changes[field] = tuple(x / divisor * factor for x in value) if is_vector else value / divisor * factor
        return replace(self, **changes) if changes else self  # type: ignore[type-var]


class JointElement(Element):
    """Base of joints with `size` velocity rows, which are derivatives of a position if `holonomic`."""

    size: ClassVar[int] = 1
    holonomic: ClassVar[bool] = True
    angular: ClassVar[tuple[int, ...]] = ()  # indices of rows that are rotations

    @property
    def is_angular(self) -> tuple[bool, ...]:
        """Whether each row (size,) is a rotation [rad, rad/s, N m] and not a length [m, m/s, N]."""
        return tuple(row in self.angular for row in range(self.size))

    @property
    def rate(self) -> tuple[float, ...]:
        """The right-hand side of the rows J v = rate (size,) [m/s or rad/s]."""
        return (0.0,) * self.size

    @property
    def lengths(self) -> tuple[float, ...]:
        """Lengths of the joint [m] that are used for the mechanism's length."""
        return ()

    @property
    def fallback_lengths(self) -> tuple[float, ...]:
        """Lengths of the joint [m] that are used if the points of each body coincide."""
        return ()

    def guides(self, places: tuple[Place, ...], span: float) -> bool:
        """Whether a force between two places, `span` [m] apart at t = 0, always acts along a line of this joint."""
        return False


@dataclass(frozen=True)
class BetweenTwo(Element):
    """An element between two bodies, or between one body and the ground."""

    name: Name
    first: Name | None
    second: Name | None

    @property
    def pairs(self) -> tuple[Pair, ...]:
        return ((self.first, self.second),)

    @property
    def points(self) -> tuple[Place, ...]:
        places = ((self.first, getattr(self, "first_point", None)), (self.second, getattr(self, "second_point", None)))
        return tuple((body, point) for body, point in places if point is not None)
