"""Linear relations between relative coordinates of any number of bodies: mimic joints, rack and pinion, tendons.

A `Term` is a factor times one relative coordinate of two bodies. The row of a sum of terms is the sum of the terms'
rows. A `Coupling` keeps such a sum constant, and a `forces.CoupledForce` acts along such a sum.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Name, Valid
from reference.elements import Element, JointElement, Pair
from reference.plane import AnyArray, apart, direction_row


@dataclass(frozen=True)
class Term(Valid):
    """`factor` times a relative coordinate of two bodies.

    The coordinate is the second body's angle minus the first body's angle [rad], not wrapped. If `sliding`, the
    coordinate is the position [m] of `second_point` of the second body along a line in the first body. The line passes
    through `first_point` at `line_angle` [rad]. Points [m] are in the body's frame, from the centre of mass; points on
    the ground (None) are world coordinates.
    """

    holonomic: ClassVar[bool] = True

    first: Name | None
    second: Name | None
    factor: float
    sliding: bool = False
    first_point: tuple[float, float] = (0.0, 0.0)
    line_angle: float = 0.0
    second_point: tuple[float, float] = (0.0, 0.0)

    def value(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """The value (...) of the term at poses (..., 3) of the two bodies."""
        if not self.sliding:
            return self.factor * (second[..., 2] - first[..., 2])
        line = first[..., 2] + self.line_angle
        x, y = np.moveaxis(apart(first, second, self.first_point, self.second_point), -1, 0)
        return self.factor * (np.cos(line) * x + np.sin(line) * y)

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        return self.value(first, second)[..., None]

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        """The derivative (..., 1, 6): columns are the first body's x, y, angle and then the second's."""
        if self.sliding:
            line = first[..., 2] + self.line_angle
            along = self.factor * np.cos(line), self.factor * np.sin(line)
            return direction_row(first, second, self.second_point, *along)
        rows = np.zeros((*np.broadcast_shapes(first.shape, second.shape)[:-1], 1, 6), np.result_type(first, second))
        rows[..., 0, 2], rows[..., 0, 5] = -self.factor, self.factor
        return rows


@dataclass(frozen=True)
class OfTerms(Element):
    """An element that acts along the sum of its `terms`. Raises InvalidMechanism if there is no term."""

    name: Name
    terms: tuple[Term, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.terms:
            raise InvalidMechanism(f"{type(self).__name__} {self.name!r}: it has no terms; give at least one")

    @property
    def pairs(self) -> tuple[Pair, ...]:
        return tuple((term.first, term.second) for term in self.terms)

    @property
    def first(self) -> str | None:
        """The first body of the first term, for messages that name two bodies of an element."""
        return self.terms[0].first

    @property
    def second(self) -> str | None:
        return self.terms[0].second


@dataclass(frozen=True)
class Coupling(OfTerms, JointElement):
    """A linear relation of relative coordinates: the sum of the `terms` is `offset`.

    Examples are gear trains and mimic joints with terms of hinge angles, and a rack and pinion or a screw with a
    sliding term and an angle. Row: the rate of the sum. Reaction: the generalised force along the sum, which is a force
    [N] if the first term is sliding, otherwise a torque [N m]. Each body gets the reaction times the derivative of the
    sum by the body's coordinates. The bearings carry the remaining forces, as for a `Gear`.
    """

    offset: float = 0.0

    @property
    def labels(self) -> tuple[str, ...]:
        return ("along",) if self.terms[0].sliding else ("torque",)

    @property
    def is_angular(self) -> tuple[bool, ...]:
        return (not self.terms[0].sliding,)

    @property
    def fallback_lengths(self) -> tuple[float, ...]:
        """The displacement of the first sliding term per radian of each angle [m], such as the radius of a pinion."""
        slide = next((abs(term.factor) for term in self.terms if term.sliding and term.factor), None)
        if slide is None:
            return ()
        return tuple(abs(term.factor) / slide for term in self.terms if not term.sliding and term.factor)
