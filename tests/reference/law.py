"""Comparison of a formula of the reference in double precision with the same formula in fifty digits.

Since every argument is rounded to double precision, the allowed error of a value is the sum over the arguments of
|f(..., a (1 + eps), ...) - f(a)|, in fifty digits, plus one rounding of the value. The sum replaces the condition
number and is finite also at a singular position. Components of a vector may have the rounding of the vector.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import mpmath as mp
import numpy as np
from numpy.typing import NDArray

DIGITS = 50
EPS = float(np.finfo(float).eps)
Draw = Callable[[np.random.Generator], tuple[float, ...]]


class Outside(ValueError):
    """Arguments for which the formula in fifty digits has no value."""


@dataclass(frozen=True)
class Law:
    """A formula in double precision (`ours`) and in fifty digits (`exact`), with the same arguments and results.

    vectors: slices of values that are the components of one vector. angles: indices of values that are compared up to
    whole turns. size: returns magnitudes whose rounding is allowed instead of the values'.
    """

    name: str
    draw: Draw
    ours: Callable[..., Sequence[Any] | NDArray[Any]]
    exact: Callable[..., Sequence[Any]]
    vectors: tuple[slice, ...] = ()
    angles: tuple[int, ...] = ()
    size: Callable[..., Sequence[Any]] | None = None


@dataclass(frozen=True)
class Miss:
    """The error of one value; `ratio` is the error divided by the allowed error of the value."""

    ratio: float
    law: str
    value: int
    arguments: tuple[float, ...]
    found: float
    expected: float

    def __str__(self) -> str:
        numbers = ", ".join(map(repr, self.arguments))
        return (
            f"{self.law}: value {self.value} at ({numbers}) is {self.found!r} instead of {self.expected!r}: "
            f"{self.ratio:.3g} times what a rounding of the arguments excuses"
        )


def differences(law: Law, values: Sequence[Any], others: Sequence[Any]) -> list[float]:
    """Absolute differences of two lists of values; whole turns do not count in angles."""
    gaps = [one - other for one, other in zip(values, others, strict=True)]
    for k in law.angles:
        gaps[k] -= 2 * mp.pi * mp.nint(gaps[k] / (2 * mp.pi))
    return [float(abs(gap)) for gap in gaps]


def moved_by_roundings(law: Law, numbers: list[Any], exact: list[Any]) -> list[float] | None:
    """The change of each value if every argument changes by a rounding, or None if the formula has no value nearby."""
    out = [0.0] * len(exact)
    for index, number in enumerate(numbers):
        moves = []
        for sign in (1, -1):
            try:
                near = law.exact(*numbers[:index], number * (1 + sign * mp.mpf(EPS)), *numbers[index + 1 :])
            except (Outside, ZeroDivisionError):
                continue
            moves.append(differences(law, near, exact))
        if not moves:
            return None
        out = [total + max(move) for total, *move in zip(out, *moves, strict=True)]
    return out


def misses(law: Law, arguments: tuple[float, ...]) -> list[Miss] | None:
    """The errors of all values, or None if one of the two formulas has no value at these arguments."""
    with mp.workdps(DIGITS):
        numbers = [mp.mpf(argument) for argument in arguments]
        try:
            exact = list(law.exact(*numbers))
            found = np.asarray(law.ours(*arguments), dtype=float).ravel().tolist()
        except (ValueError, ZeroDivisionError):
            return None
        moved = moved_by_roundings(law, numbers, exact)
        if moved is None:
            return None
        size = [abs(float(value)) for value in (law.size(*numbers) if law.size else exact)]
        for vector in law.vectors:
            size[vector] = [math.hypot(*size[vector])] * len(size[vector])
        excused = [EPS * own + move for own, move in zip(size, moved, strict=True)]
        for vector in law.vectors:
            excused[vector] = [max(excused[vector])] * len(excused[vector])
        finite = [value if math.isfinite(value) else math.inf for value in found]
        off = differences(law, [mp.mpf(value) if value < math.inf else mp.mpf(1e300) for value in finite], exact)
        return [
            Miss(miss / (excuse + 1e-300), law.name, k, arguments, found[k], float(exact[k]))
            for k, (miss, excuse) in enumerate(zip(off, excused, strict=True))
        ]


def searched(law: Law, cases: int, seed: int) -> Iterator[Miss]:
    """The largest error for each of `cases` random arguments; arguments without a value are drawn again."""
    rng, left, tried = np.random.default_rng(seed), cases, 0
    while left:
        tried += 1
        if tried > 20 * cases:
            raise AssertionError(f"{law.name}: of {tried} drawn arguments only {cases - left} have a value")
        found = misses(law, law.draw(rng))
        if found is not None:
            left -= 1
            yield max(found, key=lambda miss: miss.ratio)


def decades(rng: np.random.Generator, low: float = -9, high: float = 9) -> float:
    """A positive random number with a uniform logarithm."""
    return float(10 ** rng.uniform(low, high))


def near(rng: np.random.Generator, place: float, width: float = 1.0) -> float:
    """A random number at a distance of 1e-15 to 1 widths from `place` on either side."""
    return place + width * float(rng.choice([-1, 1])) * decades(rng, -15, 0)


def angle(rng: np.random.Generator, singular: Sequence[float] = (0.0, math.pi / 2, math.pi, -math.pi / 2)) -> float:
    """A random angle within a turn [rad]; half of the angles are near a singular angle."""
    if rng.random() < 0.5:
        return float(rng.uniform(-math.pi, math.pi))
    return near(rng, float(rng.choice(singular)))
