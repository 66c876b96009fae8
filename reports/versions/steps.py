"""Where a line over versions has a step: from its entries alone, by the rule of the gate's baseline."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import pairwise

from reports.gate.change import WORSE
from reports.model.outcomes import Outcome
from reports.run.installed import numbers
from reports.versions.table import Entry


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


def by_version(found: Sequence[Step]) -> dict[tuple[str, str, str], list[Step]]:
    """(engine, last version before, version) -> the steps that stand between these two."""
    out: dict[tuple[str, str, str], list[Step]] = {}
    for step in found:
        out.setdefault((step.after.engine, step.before.version, step.after.version), []).append(step)
    return out
