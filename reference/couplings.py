"""Linear relations of relative coordinates, between any number of bodies: a mimic joint, rack and pinion, a tendon.

A `Term` is a factor times one relative coordinate of two bodies, so that a sum of terms has the rows of each of them,
added up. A `Coupling` holds such a sum at a value; `forces.CoupledForce` pulls along it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, Name, Valid
from reference.plane import apart, direction_row

AnyArray = NDArray[Any]


@dataclass(frozen=True)
class Term(Valid):
    """`factor` times a relative coordinate of two bodies.

    That is the second body's angle less the first's [rad], as the poses count it, not wrapped; or, if it is `sliding`,
    how far the point `second_point` of the second body is along a line in the first [m], which passes through
    `first_point` at `line_angle` [rad]. Points [m] are in the bodies' own frames, from the centre of mass; on the
    ground (None) world coordinates.
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
class Coupling(Valid):
    """A linear relation of relative coordinates: the sum of the `terms` is `offset`.

    Of hinges' angles it is a train of gears or a mimic joint; of a slide and a hinge, rack and pinion or a screw. Row:
    the rate of the sum. Reaction: what acts along it, a force [N] where the first term is sliding, else a torque [N m];
    each body gets it times the sum's derivative by its coordinates, and the frame, as in a `Gear`, takes the rest.
    """

    size: ClassVar[int] = 1
    holonomic: ClassVar[bool] = True

    name: Name
    terms: tuple[Term, ...]
    offset: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        require_terms(f"coupling {self.name!r}", self.terms)

    @property
    def labels(self) -> tuple[str, ...]:
        return ("along",) if self.terms[0].sliding else ("torque",)

    @property
    def rate(self) -> tuple[float, ...]:
        return (0.0,)

    @property
    def first(self) -> str | None:
        """That of the first term, for who names a joint by two bodies."""
        return self.terms[0].first

    @property
    def second(self) -> str | None:
        return self.terms[0].second


def require_terms(owner: str, terms: tuple[Term, ...]) -> None:
    """Raises InvalidMechanism where there is no term."""
    if not terms:
        raise InvalidMechanism(f"{owner}: it has no terms; give at least one")


def pairs(member: Any) -> tuple[tuple[str | None, str | None], ...]:
    """The pairs of bodies between which a joint or a force element acts: one, or one for each term."""
    terms = getattr(member, "terms", None)
    return ((member.first, member.second),) if terms is None else tuple((each.first, each.second) for each in terms)
