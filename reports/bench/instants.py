"""How many random mechanisms a second `crosscheck search` asks one instant of, in one process."""

from __future__ import annotations

import time
from collections.abc import Iterable
from dataclasses import dataclass

from reports.search.subjects import Adapted, Alone, Subject

SEED, CASES = 1, 60


@dataclass(frozen=True)
class InstantCost:
    """CPU seconds of drawing one case, and of asking it; `asked`: the part of the cases with a law of an instant."""

    name: str
    drawing: float
    asking: float
    asked: float

    @property
    def rate(self) -> float:
        """Cases a second of CPU time."""
        return 1 / (self.drawing + self.asking)


def instant_costs(engines: Iterable, cases: int = CASES) -> list[InstantCost]:
    """For each of these engines, with joints and forces of every kind, and for MuJoCo alone."""
    subjects: list[Subject] = [*(Adapted(engine) for engine in engines), Alone()]
    return [_cost(subject, cases) for subject in subjects]


def _cost(subject: Subject, cases: int) -> InstantCost:
    begin = time.process_time()
    drawn = [subject.draw(SEED, number, subject.kinds, 0) for number in range(cases)]
    middle = time.process_time()
    told = [subject.ask(case, number, ("instant",)) for number, case in enumerate(drawn)]  # type: ignore[arg-type]
    end = time.process_time()
    asked = sum(bool(one.errors) for one in told) / cases
    return InstantCost(subject.name, (middle - begin) / cases, (end - middle) / cases, asked)
