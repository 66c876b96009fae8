"""A check is a measured number held below a bound: every gate of the grid gives checks, every report prints them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES

CHECKS = ("outcome", *dict.fromkeys(quantity.check for quantity in QUANTITIES), "order")
CHANGE = "change"  # the check against a baseline, which no known deviation excuses
BEGINNINGS = ("upstream:", "by design:", "ours:")
WORSE_DEVIATION = 2.0  # times the stated deviation: a larger one fails
BACK = 0.5  # of the bound: a known deviation below this no longer occurs, which fails too
ROUNDED = 10.0  # times the stated one for roundings that the motion amplifies; another processor gave 2 and 1/17


@dataclass(frozen=True)
class Check:
    """`measured` must not exceed `bound`; `terms`: the summands of the bound by name, in its unit.

    `name`: one of CHECKS, or "change"; `quantity`: the field of the Measurement.
    """

    name: str
    quantity: str
    measured: float
    bound: float
    terms: tuple[tuple[str, float], ...] = ()
    sentence: str = ""

    @property
    def nearness(self) -> float:
        """measured / bound: above 1 the check fails; infinite for NaN and infinity."""
        if not math.isfinite(self.measured):
            return math.inf
        return self.measured / self.bound if self.bound > 0 else (math.inf if self.measured > 0 else 0.0)

    @property
    def passed(self) -> bool:
        return self.nearness <= 1

    def __str__(self) -> str:
        parts = " + ".join(f"{name} {value:.2g}" for name, value in self.terms)
        total = f" = {parts}" if parts else ""
        return f"{self.name} ({self.quantity}): {self.measured:.3g}, bound {self.bound:.3g}{total}{self.sentence}"


@dataclass(frozen=True)
class Deviation:
    """A check that a method is known to miss.

    reason: begins with whose it is: "upstream:", "by design:" or "ours:". Either factor, how many times its bound it
    takes at most, or the known outcome. rounding: the error is made of roundings that the motion amplifies, so that
    another processor has another one: up to ROUNDED times as large, or none at all. Raises ValueError.
    """

    reason: str
    factor: float | None = None
    outcome: Outcome | None = None
    rounding: bool = False

    def __post_init__(self) -> None:
        if not self.reason.startswith(BEGINNINGS):
            raise ValueError(f"deviation: reason is {self.reason!r}; it must begin with one of {', '.join(BEGINNINGS)}")
        if (self.factor is None) == (self.outcome is None):
            raise ValueError(f"deviation: factor is {self.factor!r} and outcome {self.outcome!r}; give one of them")
        if self.factor is not None and not 1 < self.factor < math.inf:
            raise ValueError(f"deviation: factor is {self.factor!r}; it must be a number above 1")
        if self.outcome is not None and self.outcome.comparable:
            raise ValueError(f"deviation: outcome is {self.outcome!r}; such a run can be compared, so it is none")

    @property
    def told(self) -> str:
        """The known deviation as text for a table: its factor, such as '2.5', or its outcome, such as 'torn'."""
        return f"{self.factor:.4g}" if self.outcome is None else self.outcome


def nearest(checks: Iterable[Check]) -> Check:
    """The check that comes nearest to its bound, or goes farthest beyond it. Raises ValueError without any."""
    return max(checks, key=lambda check: check.nearness)


def complaints(checks: Iterable[Check], known: Mapping[str, Deviation], outcome: str = "") -> tuple[str, ...]:
    """Sentences about unexpected failures, known deviations that grew, and those that no longer occur.

    `outcome`: of the run that is checked, which has to be the one that is known.
    """
    out: list[str] = []
    checks = tuple(checks)
    for check in checks:
        if not check.passed and check.name not in known:
            out.append(str(check))
    for name, deviation in known.items():
        named = [check for check in checks if check.name == name]
        if not named:
            out.append(f"{name}: known to deviate, but there is no such check here ({deviation.reason})")
            continue
        worst = nearest(named)
        if worst.nearness <= BACK and not deviation.rounding:
            out.append(f"{worst}: deviates no longer ({deviation.reason})")
        elif deviation.factor is None:
            if outcome != deviation.outcome:
                out.append(f"{worst}: known is {deviation.outcome} ({deviation.reason})")
        elif worst.nearness > (ROUNDED if deviation.rounding else WORSE_DEVIATION) * deviation.factor:
            out.append(f"{worst}: {worst.nearness:.2g} times the bound, known are {deviation.factor:.2g}")
    return tuple(out)
