"""Two bars that reach from a pivot to a moving point, and quantities with two derivatives; vectors are complex."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from reference.checks import Positive, Sign, Valid

Array = NDArray[Any]


class Moving(NamedTuple):
    """A quantity (...,) and its first two derivatives by one coordinate."""

    value: Array
    first: Array
    second: Array

    def plus(self, other: Moving) -> Moving:
        """The sum of two."""
        return Moving(*(a + b for a, b in zip(self, other, strict=True)))

    def times(self, factor: complex) -> Moving:
        """A fixed multiple."""
        return Moving(*(factor * part for part in self))

    def shifted(self, by: complex) -> Moving:
        """With a constant added."""
        return Moving(self.value + by, self.first, self.second)


def direction(angle: Moving) -> Moving:
    """exp(i angle), an angle in rad."""
    unit = np.exp(1j * angle.value)
    return Moving(unit, 1j * angle.first * unit, (1j * angle.second - angle.first**2) * unit)


@dataclass(frozen=True)
class Dyad(Valid):
    """Bars of `first` and `second` [m], one after the other, from a pivot to a point.

    `side` is 1 where the joint between them is to the left of the line from the pivot to the point, -1 to the right.
    """

    first: Positive
    second: Positive
    side: Sign

    def angles(self, reach: Moving) -> tuple[Moving, Moving]:
        """Directions of both bars [rad], from -pi to pi, for the complex vector `reach` [m] from pivot to point.

        NaN where the bars don't reach. reach = a e^(i mu) + b e^(i nu), so the part of a derivative along one bar is
        the turning of the other alone.
        """
        a, b = self.first, self.second
        with np.errstate(invalid="ignore", divide="ignore"):
            distance = np.abs(reach.value)
            along = (distance**2 + a**2 - b**2) / (2 * distance)
            across = self.side * np.sqrt(a**2 - along**2)
            unit = reach.value / distance
            one, other = unit * (along + 1j * across) / a, unit * (distance - along - 1j * across) / b
            folded = np.imag(one * np.conj(other))  # sin(mu - nu): zero where the bars are in line

            def rates(change: Array) -> tuple[Array, Array]:
                along_b, along_a = np.real(change * np.conj(other)), np.real(change * np.conj(one))
                return -along_b / (a * folded), along_a / (b * folded)

            mu, nu = rates(reach.first)
            mu_second, nu_second = rates(reach.second + a * one * mu**2 + b * other * nu**2)
            return Moving(np.angle(one), mu, mu_second), Moving(np.angle(other), nu, nu_second)
