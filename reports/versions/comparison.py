"""Two columns against each other, and steps in a line over versions: both by the rule of the gate's baseline."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain, pairwise
from statistics import median

from reports.gate.change import WORSE, Identity, Old, drift, growth, identity
from reports.model.checks import Check
from reports.model.convergence import Sweep, sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES
from reports.run.installed import numbers
from reports.versions.table import Entry

SLOPE = 0.5  # orders that differ by more are told: two local slopes of one method do by less


@dataclass(frozen=True)
class Difference:
    """One quantity of a row, or its outcome, that is more than three times as large in one of the two."""

    before: Measurement
    after: Measurement
    quantity: str
    worse: bool

    def value(self, row: Measurement) -> float | str:
        """The quantity in a row; its outcome where that is what differs."""
        return row.outcome if self.quantity == "outcome" else getattr(row, self.quantity)

    @property
    def factor(self) -> float:
        """How many times the larger one is the smaller one; infinite for an outcome."""
        if self.quantity == "outcome":
            return math.inf
        low, high = sorted((getattr(self.before, self.quantity), getattr(self.after, self.quantity)))
        return high / low if low > 0 else math.inf


@dataclass(frozen=True)
class Turn:
    """The order of the angle's error of a method in a scene, where it is another."""

    scene: str
    method: str
    before: float
    after: float


@dataclass(frozen=True)
class Comparison:
    """`pairs`: rows of one cell, before and after; `grown`: failed checks of a method's errors over all scenes;
    `costs`: by method the median of the ratios of CPU times; `cost`: of all rows (NaN without one)."""

    pairs: tuple[tuple[Measurement, Measurement], ...]
    differences: tuple[Difference, ...]
    turns: tuple[Turn, ...]
    cost: float
    grown: tuple[Check, ...] = ()
    costs: Mapping[str, float] = field(default_factory=dict)

    @property
    def worse(self) -> tuple[Difference, ...]:
        return tuple(each for each in self.differences if each.worse)

    def lines(self) -> list[Line]:
        """A line for each method of each scene, in the order of the rows."""
        members: dict[tuple[str, str], list[tuple[Measurement, Measurement]]] = {}
        for before, after in self.pairs:
            members.setdefault((after.scene, after.method), []).append((before, after))
        own: dict[tuple[str, str], list[Difference]] = {key: [] for key in members}
        for each in self.differences:
            own[each.after.scene, each.after.method].append(each)
        return [Line(*key, tuple(pairs), tuple(own[key])) for key, pairs in members.items()]


@dataclass(frozen=True)
class Line:
    """What became of one method in one scene."""

    scene: str
    method: str
    pairs: tuple[tuple[Measurement, Measurement], ...]
    differences: tuple[Difference, ...]

    @property
    def chief(self) -> Difference:
        """What differs most, a worse number before any other; where nothing differs the angle at the finest step."""
        if not self.differences:
            return Difference(*min(self.pairs, key=lambda pair: pair[1].step), "angle", False)
        return max(self.differences, key=lambda each: (each.worse, each.factor))

    @property
    def verdict(self) -> str:
        if not self.differences:
            return "nothing changed"
        if any(each.worse for each in self.differences):
            return "WORSE"
        chief = self.chief
        return "better" if chief.quantity != "outcome" or Outcome(chief.after.outcome).comparable else "other"

    @property
    def cost(self) -> float:
        """The median of the ratios of CPU times; NaN where nothing was timed."""
        ratios = [after.cpu / before.cpu for before, after in self.pairs if _timed(before) and _timed(after)]
        return median(ratios) if ratios else math.nan


def compared(before: Iterable[Measurement], after: Iterable[Measurement]) -> Comparison:
    """Rows of the same cells against each other; a cell that only one has is left out."""
    old, new = _by_cell(before), _by_cell(after)
    pairs = [(old[key], new[key]) for key in old if key in new]
    differences = [found for pair in pairs for found in _differences(*pair)]
    ratios: dict[str, list[float]] = {}
    for a, b in pairs:
        if _timed(a) and _timed(b):
            ratios.setdefault(b.method, []).append(b.cpu / a.cpu)
    cost = median(chain(*ratios.values())) if ratios else math.nan
    turns = _turns([a for a, _ in pairs], [b for _, b in pairs])
    grown = tuple(check for check in growth((b, _old(a)) for a, b in pairs) if not check.passed)
    costs = {method: median(own) for method, own in ratios.items()}
    return Comparison(tuple(pairs), tuple(differences), turns, cost, grown, costs)


def _by_cell(rows: Iterable[Measurement]) -> dict[Identity, Measurement]:
    return {identity(row): row for row in rows}


def _timed(row: Measurement) -> bool:
    return Outcome(row.outcome).comparable and row.cpu > 0


def _differences(before: Measurement, after: Measurement) -> list[Difference]:
    first, second = Outcome(before.outcome), Outcome(after.outcome)
    if first != second and not (first.comparable and second.comparable):
        return [Difference(before, after, "outcome", second.grade > first.grade)]
    lost, won = drift(after, _old(before)), drift(before, _old(after))
    worse = [Difference(before, after, check.quantity, True) for check in lost if not check.passed]
    better = [Difference(before, after, check.quantity, False) for check in won if not check.passed]
    return worse + better


def _old(row: Measurement) -> Old:
    errors = {each.name: getattr(row, each.name) for each in QUANTITIES}
    return Old(Outcome(row.outcome), errors, row.reaction_rows, row.cpu)


def _turns(before: Sequence[Measurement], after: Sequence[Measurement]) -> tuple[Turn, ...]:
    old, new = _orders(before), _orders(after)
    return tuple(
        Turn(*key, old[key].order, new[key].order)
        for key in old
        if key in new and abs(old[key].order - new[key].order) > SLOPE
    )


def _orders(rows: Sequence[Measurement]) -> dict[tuple[str, str], Sweep]:
    return {(each.scene, each.method): each for each in sweeps(rows) if each.quantity.name == "angle"}


@dataclass(frozen=True)
class Step:
    """Two neighbours of one line that differ by more than WORSE, or of which one alone can be compared."""

    before: Entry
    after: Entry

    @property
    def worse(self) -> bool:
        """Whether the newer one is."""
        return size(self.after) > size(self.before)


def size(entry: Entry) -> float:
    """What lines are compared by: the error above rounding; infinite where the run gave none that can be compared."""
    return max(entry.error, entry.rounding) if entry.comparable else math.inf


def ran(entry: Entry) -> bool:
    """Whether a version can run this at all."""
    return Outcome(entry.outcome) not in (Outcome.UNSUPPORTED, Outcome.LOST)


def lines(entries: Iterable[Entry]) -> dict[tuple[str, str, str], tuple[Entry, ...]]:
    """(engine, scene, variant) -> its entries, oldest version first; those that could not be run are left out."""
    found: dict[tuple[str, str, str], list[Entry]] = {}
    for entry in entries:
        if ran(entry):
            found.setdefault((entry.engine, entry.scene, entry.variant), []).append(entry)
    return {key: tuple(sorted(members, key=lambda e: numbers(e.version))) for key, members in found.items()}


def steps(entries: Iterable[Entry]) -> tuple[Step, ...]:
    """Every step of every line, oldest first."""
    found = [
        Step(before, after)
        for members in lines(entries).values()
        for before, after in pairwise(members)
        if differ(size(before), size(after))
    ]
    return tuple(sorted(found, key=lambda step: (step.after.engine, numbers(step.after.version))))


def differ(before: float, after: float) -> bool:
    """Whether one is more than WORSE times the other."""
    if math.isinf(before) or math.isinf(after):
        return before != after
    return max(before, after) > WORSE * min(before, after)


def change(before: Entry, after: Entry) -> str:
    """From one version to the next: "better", "WORSE", "other" where both end without an error to compare; or empty."""
    if differ(size(before), size(after)):
        return "WORSE" if size(after) > size(before) else "better"
    return "" if before.comparable or before.outcome == after.outcome else "other"


def by_version(found: Sequence[Step]) -> dict[tuple[str, str, str], list[Step]]:
    """(engine, last version before, version) -> the steps that stand between these two."""
    out: dict[tuple[str, str, str], list[Step]] = {}
    for step in found:
        out.setdefault((step.after.engine, step.before.version, step.after.version), []).append(step)
    return out
