"""A check compares a measured number with a bound. The gates produce checks, and reports print them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES

CHECKS = ("outcome", *dict.fromkeys(quantity.check for quantity in QUANTITIES), "order")
CHANGE = "change"  # The check against a baseline, whose failure no known deviation excuses.
BEGINNINGS = ("upstream:", "by design:", "ours:")
WORSE_DEVIATION = 2.0  # A deviation fails if it exceeds the known deviation by this factor.
BACK = 0.5  # If a known deviation is below this share of the bound, its entry is outdated, and the check fails.
ROUNDED = 10.0  # The factor for amplified rounding. Another processor changed such deviations by factors of 2 and 1/17.


@dataclass(frozen=True)
class Check:
    """A comparison of a measured value with a bound. The check fails if the value exceeds the bound."""

    name: str  # One of CHECKS, or "change".
    quantity: str  # A field of Measurement.
    measured: float
    bound: float
    terms: tuple[tuple[str, float], ...] = ()  # (name, summand of the bound).
    sentence: str = ""

    @property
    def nearness(self) -> float:
        """The ratio measured / bound, or infinity if `measured` is not finite. Above 1 the check fails."""
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
    """A known failure of a check, with either a factor or an outcome. Raises ValueError."""

    reason: str  # Text that begins with "upstream:", "by design:" or "ours:".
    factor: float | None = None  # Largest ratio measured / bound.
    outcome: Outcome | None = None  # The known outcome.
    rounding: bool = False  # Whether the error is amplified rounding, which depends on the processor.

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
        """Text for a table: the factor, such as '2.5', or the outcome, such as 'torn'."""
        return f"{self.factor:.4g}" if self.outcome is None else self.outcome


def nearest(checks: Iterable[Check]) -> Check:
    """The check with the largest ratio of measured value to bound. Raises ValueError without checks."""
    return max(checks, key=lambda check: check.nearness)


def complaints(checks: Iterable[Check], known: Mapping[str, Deviation], outcome: str = "") -> tuple[str, ...]:
    """Sentences about unexpected failures, and about known deviations that have grown or no longer occur. outcome:
    outcome of the checked run, which must be the known outcome of a deviation."""
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
