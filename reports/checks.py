"""A check is a measured number held below a bound; every gate of the grid gives checks, and every report prints them."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """`measured` must not exceed `bound`; `terms` are what the bound is the sum of, by name, in the same unit.

    `name`: error, rate, gap, energy, reaction, order or outcome; `quantity`: the field of the Measurement.
    """

    name: str
    quantity: str
    measured: float
    bound: float
    terms: tuple[tuple[str, float], ...] = ()
    sentence: str = ""

    @property
    def nearness(self) -> float:
        """measured / bound: above 1 the check fails, infinite for a number that is none."""
        if not math.isfinite(self.measured):
            return math.inf
        return self.measured / self.bound if self.bound > 0 else (math.inf if self.measured > 0 else 0.0)

    @property
    def passed(self) -> bool:
        return self.nearness <= 1

    def __str__(self) -> str:
        parts = " + ".join(f"{name} {value:.2g}" for name, value in self.terms)
        told = f" ({parts})" if parts else ""
        return f"{self.name} ({self.quantity}): {self.measured:.3g}, bound {self.bound:.3g}{told}{self.sentence}"


def failed(checks: Iterable[Check]) -> tuple[Check, ...]:
    """Those that did not pass."""
    return tuple(check for check in checks if not check.passed)
