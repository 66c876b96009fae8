"""The gate of theory: what a method's order, its softness and rounding may cost in a scene, against what it cost."""

from __future__ import annotations

import math
from dataclasses import dataclass

from reports.checks import Check
from reports.judge import Prediction, Softness
from reports.measure import SATURATED, TORN, Measurement
from reports.outcomes import Outcome
from reports.quantities import QUANTITIES

# Check -> the quantities that it holds.
HELD: dict[str, tuple[str, ...]] = {
    "error": ("angle", "position"),
    "rate": ("rate", "velocity"),
    "gap": ("gap", "slip"),
    "energy": ("energy",),
    "reaction": ("reaction",),
}
ROUNDING = {quantity.name: quantity.rounding for quantity in QUANTITIES}


@dataclass(frozen=True)
class Promise:
    """What an engine promises in a scene: the power of the step with which each error falls, and how soft its rows are.

    `order` is that of poses; the others are as large unless they are given.
    """

    order: int
    rate: int | None = None
    gap: int | None = None
    slip: int | None = None
    energy: int | None = None
    reaction: int | None = None
    softness: Softness | None = None

    def of(self, quantity: str) -> int:
        """The order of a quantity of `reports.quantities`."""
        name = {"angle": "order", "position": "order", "velocity": "rate"}.get(quantity, quantity)
        own = getattr(self, name)
        return self.order if own is None else own


# Room above the judge's own error of the same order: methods of one order differ in their constants, of which the
# judge's is one; see `Prediction`.
ROOM = 3.0


def theory(prediction: Prediction, promise: Promise, row: Measurement) -> tuple[Check, ...]:
    """The checks of one row, those whose quantity it knows; a run that can't be compared fails by its outcome alone."""
    outcome = Outcome(row.outcome)
    if outcome is Outcome.UNSUPPORTED:
        return ()
    checks = [Check("outcome", "outcome", 0.0 if outcome.comparable else math.inf, 1.0, sentence=f", {row.outcome}")]
    if not outcome.comparable:
        return tuple(checks)
    for name, quantities in HELD.items():
        for quantity in quantities:
            measured = getattr(row, quantity)
            if not math.isnan(measured):
                checks.append(_held(name, quantity, measured, prediction, promise, row.step))
    return tuple(checks)


def _held(
    name: str, quantity: str, measured: float, prediction: Prediction, promise: Promise, step: float
) -> Check:
    terms = (
        ("step", ROOM * prediction.error(quantity, promise.of(quantity), step)),
        ("softness", ROOM * prediction.give(quantity, promise.softness)),
        ("rounding", ROUNDING[quantity]),
    )
    bound = min(sum(value for _, value in terms), prediction.refused(quantity))
    return Check(name, quantity, measured, bound, terms)
