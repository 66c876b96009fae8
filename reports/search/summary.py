"""What was found of many cases, by subject and check."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from reports.search.chunk import Asked

HEADER = ("subject", "check", "cases", "median", "99 %", "worst", "faults")


@dataclass(frozen=True)
class Line:
    """One check of one subject."""

    subject: str
    check: str
    errors: tuple[float, ...]
    faults: int

    @property
    def quantiles(self) -> tuple[float, float, float]:
        """Median, 99 % and worst; infinite for what has no number."""
        ordered = np.sort(np.array(self.errors))
        places = [math.ceil(share * (len(ordered) - 1)) for share in (0.5, 0.99, 1.0)]
        median, most, worst = (float(ordered[place]) for place in places)
        return median, most, worst


def label(one: Asked) -> str:
    """The subject, and the kinds that were asked for where they are not all of its own."""
    chunk = one.chunk
    kinds = "" if chunk.kinds == chunk.subject.kinds else f" ({', '.join(chunk.kinds)})"
    return f"{chunk.subject.name}{kinds}"


def lines(told: Iterable[Asked]) -> list[Line]:
    """In the order in which subjects and checks first come up."""
    found: dict[tuple[str, str], list[tuple[float, bool]]] = {}
    for one in told:
        for check, (error, bound) in one.told.errors.items():
            found.setdefault((label(one), check), []).append((error, not error <= bound))
    return [
        Line(subject, check, tuple(error for error, _ in pairs), sum(fault for _, fault in pairs))
        for (subject, check), pairs in found.items()
    ]


def summary(told: Sequence[Asked]) -> list[list[str]]:
    """Rows of a table under HEADER; a last line a subject says how many cases it refused."""
    out = [
        [line.subject, line.check, str(len(line.errors)), *map(_short, line.quantiles), str(line.faults)]
        for line in lines(told)
    ]
    for subject, count in refused(told).items():
        out.append([subject, "refused", str(count), "", "", "", ""])
    return out


def refused(told: Iterable[Asked]) -> Mapping[str, int]:
    """How many cases a subject can't build, by its own word."""
    return Counter(label(one) for one in told if any(why.startswith("unsupported") for why in one.told.not_asked))


def _short(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "lost"
