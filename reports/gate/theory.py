"""The gate of theory: what a method's order, its softness and rounding may cost in a scene, against what it cost."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from engines import EXACT, Promise, Softness, Unpromised
from reports.gate.checks import Check
from reports.gate.prediction import Prediction
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.grid.quantities import QUANTITIES

# Check -> the quantities that it holds.
HELD: dict[str, tuple[str, ...]] = {
    "error": ("angle", "position"),
    "rate": ("rate", "velocity"),
    "gap": ("gap", "slip"),
    "energy": ("energy",),
    "reaction": ("reaction",),
}
ROUNDING = {quantity.name: quantity.rounding for quantity in QUANTITIES}


# Room above the judge's own error of the same order. Methods of one order differ in their constants: a spring of five
# steps has 5^2 / 2 at second order, and the grid's right methods lie within a decade of the judge, most within a third
# of one. It is narrow enough only because a method's own coarser steps bound it too.
ROOM = 20.0
# Room above the error of the declared softness: its estimate of a row's own inertia is right within about this.
ROOM_SOFT = 2.0
# Room above what a method's own coarser steps let expect of a finer one: their constant is known, and what is left is
# the next power of the step, and that a largest error over samples is met at another one. It is below the three of half
# a decade, so that an error that stays is seen between the two finest steps even at first order.
ROOM_OWN = 2.5
# Coarser steps that tell what a method costs: at a single one two errors may cancel by luck.
ENOUGH = 2


def terms(
    quantity: str,
    prediction: Prediction,
    promise: Promise,
    softness: Softness | None,
    step: float,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[float, float, float]:
    """What step, softness and rounding cost in a quantity, before any room is given; `as_soft`: see `theory`."""
    rounding = ROUNDING["velocity" if quantity == "slip" else quantity]
    if quantity in ("rate", "velocity", "slip", "energy"):
        rounding *= promise.amplified
    if quantity == "reaction" and promise.differences:
        # A change of velocity: a combination of runs carries its rounding as it carries that of velocities.
        carried = ROUNDING["velocity"] * promise.amplified
        rounding += carried * promise.differences / step / prediction.acceleration
    if promise.of(quantity) == EXACT:
        return 0.0, 0.0, rounding
    cost = prediction.error(quantity, promise.step(quantity), step)
    cost += prediction.closing(quantity, prediction.error("gap", promise.step("gap"), step), softness)
    if quantity == "reaction" and promise.differences:
        cost += prediction.differenced(promise.of(quantity), step)
    return cost, prediction.give(quantity, softness) if as_soft is None else as_soft[quantity], rounding


def theory(
    prediction: Prediction,
    promise: Promise | Unpromised,
    softness: Softness | None,
    row: Measurement,
    coarser: Sequence[Measurement] = (),
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """The checks of one row, those whose quantity it knows; a run that can't be compared fails by its outcome alone.

    `coarser`: the same method's rows at larger steps. What they cost, scaled by the promised order, bounds the row too
    where they are ENOUGH, or where the judge itself has lost the motion.
    `as_soft`: the judge's errors with this very softness, where no other tells of it in proportion.
    Where no order is promised the outcome alone is held.
    """
    outcome = Outcome(row.outcome)
    if outcome is Outcome.UNSUPPORTED:
        return ()
    checks = [Check("outcome", "outcome", 0.0 if outcome.comparable else math.inf, 1.0, sentence=f", {row.outcome}")]
    if not outcome.comparable or isinstance(promise, Unpromised):
        return tuple(checks)
    usable = [other for other in coarser if other.step > row.step and Outcome(other.outcome).comparable]
    for name, quantities in HELD.items():
        for quantity in quantities:
            measured = getattr(row, quantity)
            if math.isnan(measured):
                continue
            cost, soft, rounding = terms(quantity, prediction, promise, softness, row.step, as_soft)
            cost, soft = ROOM * cost, ROOM_SOFT * soft
            order = promise.of(quantity)
            if order < EXACT and len(usable) >= (ENOUGH if math.isfinite(cost + soft) else 1):
                known = [getattr(other, quantity) * (row.step / other.step) ** order for other in usable]
                own = ROOM_OWN * max(known)
                # Where the judge's soft run lost the motion, the method's own steps are all that is known.
                cost, soft = (min(cost, own), soft) if math.isfinite(soft) else (own, 0.0)
            bound = min(cost + soft + rounding, prediction.refused(quantity))
            checks.append(
                Check(name, quantity, measured, bound, (("step", cost), ("softness", soft), ("rounding", rounding)))
            )
    return tuple(checks)
