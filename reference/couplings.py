"""Linear relations of relative coordinates, between any number of bodies: a mimic joint, rack and pinion, a tendon.

A `Term` is a factor times one relative coordinate of two bodies; the row of a sum of terms is the sum of their rows. A
`Coupling` keeps such a sum constant; `forces.CoupledForce` acts along it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, Name, Valid
from reference.elements import Element, JointElement, Pair
from reference.plane import apart, direction_row

AnyArray = NDArray[Any]


@dataclass(frozen=True)
class Term(Valid):
    """`factor` times a relative coordinate of two bodies.

    The coordinate is the second body's angle less the first's [rad], not wrapped. If `sliding`, it is the position of
    the point `second_point` of the second body along a line in the first [m], which passes through `first_point` at
    `line_angle` [rad]. Points [m] are in the bodies' own frames, from the centre of mass; on the ground (None) they are
    world coordinates.
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
        """factor times the coordinate (...) at poses (..., 3)."""
        if not self.sliding:
            return self.factor * (second[..., 2] - first[..., 2])
        line = first[..., 2] + self.line_angle
        x, y = np.moveaxis(apart(first, second, self.first_point, self.second_point), -1, 0)
        return self.factor * (np.cos(line) * x + np.sin(line) * y)

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        """`value` as a part of a row's gap (..., 1)."""
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
    """An element along the sum of its `terms`. Raises InvalidMechanism if there is no term."""

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
        """The first body of the first term, for messages that name an element by two bodies."""
        return self.terms[0].first

    @property
    def second(self) -> str | None:
        return self.terms[0].second


@dataclass(frozen=True)
class Coupling(OfTerms, JointElement):
    """A linear relation of relative coordinates: the sum of the `terms` is `offset`.

    With terms of hinge angles it is a gear train or a mimic joint; with a slide and a hinge, rack and pinion or a
    screw. Row: the rate of the sum. Reaction: the generalised force along the sum, a force [N] if the first term is
    sliding, else a torque [N m]. Each body gets it times the sum's derivative by its coordinates; the frame, as in a
    `Gear`, takes the rest.
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
        """How far the first slide moves per radian of each angle [m], as the radius of a pinion."""
        slide = next((abs(term.factor) for term in self.terms if term.sliding and term.factor), None)
        if slide is None:
            return ()
        return tuple(abs(term.factor) / slide for term in self.terms if not term.sliding and term.factor)
