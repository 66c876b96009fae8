"""A formula of the reference beside the same formula in fifty digits, and how far a double may be from it.

A double knows each of its arguments to half a rounding. So no formula can be asked for more than what its value moves
by when the arguments move by a rounding each: |f(..., a (1 + eps), ...) - f(a)|, in fifty digits, added over all
arguments. That is the condition number of the arguments, and at a singular position, where the derivative is infinite,
it is still finite. To it comes one rounding of the value itself: of the vector, where the value is one of its
components.
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
    """The formula in fifty digits has no value at these numbers."""


@dataclass(frozen=True)
class Law:
    """`ours` in doubles and `exact` in fifty digits take the same arguments and give the same values, in order.

    `vectors` are slices of values that are the components of one vector; `angles` are values known up to whole turns;
    `size` gives the size of each value's whole motion, where a value that passes zero is a part of one.
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
    """How far one value was off, in parts of what its arguments excuse."""

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
    """The sizes of the differences of two rows of values; of angles, up to whole turns."""
    gaps = [one - other for one, other in zip(values, others, strict=True)]
    for k in law.angles:
        gaps[k] -= 2 * mp.pi * mp.nint(gaps[k] / (2 * mp.pi))
    return [float(abs(gap)) for gap in gaps]


def moved_by_roundings(law: Law, numbers: list[Any], exact: list[Any]) -> list[float] | None:
    """How far the values move when each argument moves by a rounding, added up; None where there is no value near."""
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
    """One for each value; None where the law or the reference has none at these arguments."""
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
    """The worst value of each of `cases` drawn arguments that have values."""
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
    """A positive number whose logarithm is uniform."""
    return float(10 ** rng.uniform(low, high))


def near(rng: np.random.Generator, place: float, width: float = 1.0) -> float:
    """A number at a distance of 1e-15 to 1 widths from a place, on either side."""
    return place + width * float(rng.choice([-1, 1])) * decades(rng, -15, 0)


def angle(rng: np.random.Generator, singular: Sequence[float] = (0.0, math.pi / 2, math.pi, -math.pi / 2)) -> float:
    """Any angle within a turn [rad], half of the times near one of the singular ones."""
    if rng.random() < 0.5:
        return float(rng.uniform(-math.pi, math.pi))
    return near(rng, float(rng.choice(singular)))
