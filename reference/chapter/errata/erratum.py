"""What an erratum is: a printed formula, the right one, and numbers that decide between them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Values:
    """Three answers to one question, each (n,): as printed, as it must be, and by the derivative of a position."""

    printed: Array
    right: Array
    decides: Array

    @property
    def miss(self) -> float:
        """How far the printed formula is from what decides, the largest component, in the unit of the values."""
        return float(np.abs(self.printed - self.decides).max())

    @property
    def agreement(self) -> float:
        """The same of the right formula: rounding."""
        return float(np.abs(self.right - self.decides).max())


@dataclass(frozen=True)
class Erratum:
    """One slip: its number in the list of errata, where it is, what is printed, what is right, and why; `values()`.

    quoted: the printed formula as the chapter sets it (LaTeX), or its words; corrected: the same without the slip.
    deciding: what decides, in words. dimensions: whether they alone show that something is wrong; the size of the miss
    then depends on the units. by_tolerance: where a claim is wrong and what is printed beside it is a right method
    whose tolerance the chapter does not state, the method's miss at tolerances of ours.
    """

    number: int
    where: str
    printed: str
    right: str
    reason: str
    unit: str
    quoted: str
    corrected: str
    deciding: str
    dimensions: bool
    values: Callable[[], Values]
    by_tolerance: Callable[[], Mapping[float, float]] | None = None
