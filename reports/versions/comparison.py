"""Comparison of the rows of two versions of an engine by the rules of `reports.gate.change`."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cached_property
from statistics import median
from typing import NamedTuple

from reports.gate.change import Old, drift, growth, identity
from reports.model.checks import Check
from reports.model.convergence import by_method, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES

SAME_ORDER = 0.5  # Smaller differences of observed orders are not reported.


class Difference(NamedTuple):
    """A quantity that differs by more than a factor of three between two rows, or an outcome that differs."""

    before: Measurement
    after: Measurement
    quantity: str
    worse: bool

    def value(self, row: Measurement) -> float | str:
        return getattr(row, self.quantity)

    @property
    def factor(self) -> float:
        """The ratio of the larger value to the smaller value, or infinity for an outcome."""
        if self.quantity == "outcome":
            return math.inf
        low, high = sorted((getattr(self.before, self.quantity), getattr(self.after, self.quantity)))
        return high / low if low > 0 else math.inf


class OrderChange(NamedTuple):
    """A difference between observed orders of the angle error, for a method in a scene."""

    scene: str
    method: str
    before: float
    after: float


@dataclass(frozen=True)
class RowComparison:
    """The comparison of pairs (earlier row, later row) that belong to the same cell."""

    pairs: tuple[tuple[Measurement, Measurement], ...]

    @cached_property
    def differences(self) -> tuple[Difference, ...]:
        return tuple(difference for pair in self.pairs for difference in _differences(*pair))

    @property
    def worse(self) -> tuple[Difference, ...]:
        return tuple(difference for difference in self.differences if difference.worse)

    @cached_property
    def grown(self) -> tuple[Check, ...]:
        """Failed checks that the errors of a method have not grown over all scenes."""
        return tuple(
            check for check in growth((later, _old(earlier)) for earlier, later in self.pairs) if not check.passed
        )

    @cached_property
    def orders(self) -> tuple[OrderChange, ...]:
        old, new = (
            (by_method(sweeps(rows), "angle") for rows in zip(*self.pairs, strict=True)) if self.pairs else ({}, {})
        )
        both = [(old[key], new[key]) for key in old if key in new]
        changed = [(a, b) for a, b in both if abs(a.order - b.order) > SAME_ORDER]
        return tuple(OrderChange(a.scene, a.method, a.order, b.order) for a, b in changed)

    @cached_property
    def cost(self) -> float:
        """The median of the ratios of CPU times, or NaN if no pair was timed."""
        timed = [pair for pair in self.pairs if all(Outcome(row.outcome).comparable and row.cpu > 0 for row in pair)]
        return median(later.cpu / earlier.cpu for earlier, later in timed) if timed else math.nan

    @property
    def costs(self) -> dict[str, float]:
        """Method -> `cost`, without methods that were not timed."""
        parts = self.by("method").items()
        return {method: part.cost for (method,), part in parts if not math.isnan(part.cost)}

    def by(self, *names: str) -> dict[tuple[str, ...], RowComparison]:
        """Values of these properties of a row -> the comparison of the pairs with these values."""
        groups: dict[tuple[str, ...], list[tuple[Measurement, Measurement]]] = {}
        for pair in self.pairs:
            groups.setdefault(tuple(getattr(pair[1], name) for name in names), []).append(pair)
        return {values: RowComparison(tuple(pairs)) for values, pairs in sorted(groups.items())}

    @property
    def chief(self) -> Difference:
        """The largest difference for the worse, else the largest one, else the angle at the smallest step."""
        if not self.differences:
            return Difference(*min(self.pairs, key=lambda pair: pair[1].step), "angle", False)
        return max(self.differences, key=lambda difference: (difference.worse, difference.factor))

    @property
    def verdict(self) -> str:
        if not self.differences:
            return "nothing changed"
        if self.worse:
            return "WORSE"
        chief = self.chief
        return "better" if chief.quantity != "outcome" or Outcome(chief.after.outcome).comparable else "other"


def compared(before: Iterable[Measurement], after: Iterable[Measurement]) -> RowComparison:
    new = {identity(row): row for row in after}
    old = {identity(row): row for row in before}
    return RowComparison(tuple((row, new[key]) for key, row in old.items() if key in new))


def _differences(before: Measurement, after: Measurement) -> Sequence[Difference]:
    first, second = Outcome(before.outcome), Outcome(after.outcome)
    if first != second and not (first.comparable and second.comparable):
        return [Difference(before, after, "outcome", second.grade > first.grade)]
    worse, better = drift(after, _old(before)), drift(before, _old(after))
    failed = [(check, True) for check in worse] + [(check, False) for check in better]
    return [Difference(before, after, check.quantity, is_worse) for check, is_worse in failed if not check.passed]


def _old(row: Measurement) -> Old:
    errors = {quantity.name: getattr(row, quantity.name) for quantity in QUANTITIES}
    return Old(Outcome(row.outcome), errors, row.reaction_rows, row.cpu)
