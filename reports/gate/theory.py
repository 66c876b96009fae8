"""The gate of theory: what a method's order, its softness and rounding may cost in a scene, against what it cost."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence

from engines import EXACT, Promise, Softness, Unpromised
from reports.gate.prediction import Prediction
from reports.model.checks import Check
from reports.model.convergence import ROOM_SOFT
from reports.model.measure import Measurement
from reports.model.outcomes import SATURATED, Outcome
from reports.model.quantities import QUANTITIES

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
# Room above what a method's own coarser steps let expect of a finer one: their constant is known, and what is left is
# the next power of the step, and that a largest error over samples is met at another one. It is below the three of half
# a decade, so that an error that stays is seen between the two finest steps even at first order.
ROOM_OWN = 2.5
# The same where the motion is prescribed: nothing carries an early error on, so an error is what its own instant makes
# of the step, and the largest is met at the same instant at every step. What is left is the next power: in the driven
# four-bar 6 % of the first at the coarsest step, by the judge's two orders, and less at finer ones.
ROOM_PRESCRIBED = 1.25
# Where a motion is prescribed a pose has no error of the first order, so the velocity that led to it is the mean one of
# its step: that of half a step earlier. Energies are of these velocities, slips and reactions of an instant within the
# step. Parts of a step.
MIDDLE = {"rate": 0.5, "velocity": 0.5, "energy": 0.5, "slip": 1.0, "reaction": 1.0}
# Coarser steps that tell what a method costs: at a single one two errors may cancel by luck.
ENOUGH = 2
# A method without a promise. Room above what its own steps differ by: where no step changes an error by a twentieth of
# it the model is another one. Errors below this part of what there is are let through, since two may be equal by luck;
# and half of the largest reaction is as much as half a radian.
ROOM_UNPROMISED = 20.0
SMALL = 1e-3


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
    if quantity in ("rate", "velocity"):
        # What is rounded in a pose shows in velocities as the motion takes it on; see `Prediction.error`.
        rounding = max(rounding, prediction.speed / prediction.length * ROUNDING["angle"])
    if quantity not in ("gap", "reaction"):
        # The weights of a combination of runs carry the rounding of poses as they carry that of velocities.
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
    soft = prediction.give(quantity, softness) if as_soft is None else as_soft[quantity]
    if promise.integrator is not None:
        soft += prediction.settling(quantity, softness)
    return cost, soft, rounding


def theory(
    prediction: Prediction,
    promise: Promise | Unpromised,
    softness: Softness | None,
    row: Measurement,
    coarser: Sequence[Measurement] = (),
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """The checks of one row, one for each quantity; a run that can't be compared fails by its outcome alone.

    `coarser`: the same method's rows at larger steps. What they cost, scaled by the promised order, bounds the row too
    where they are ENOUGH, or where the judge itself has lost the motion. Where no order is promised, what the method's
    steps change in an error bounds it.
    `as_soft`: the judge's errors with this very softness, where no other tells of it in proportion.
    A number that is none fails, unless the engine says that it can't tell it. Checks that can't fail have an infinite
    bound and say why; `idle` counts them.
    """
    outcome = Outcome(row.outcome)
    if outcome is Outcome.UNSUPPORTED:
        return ()
    checks = [Check("outcome", "outcome", 0.0 if outcome.comparable else math.inf, 1.0, sentence=f", {row.outcome}")]
    usable = [other for other in coarser if other.step > row.step and Outcome(other.outcome).comparable]
    for name, quantities in HELD.items():
        for quantity in quantities:
            measured = getattr(row, quantity)
            reason = _why_not(quantity, outcome, prediction, promise)
            if reason and (math.isnan(measured) or not outcome.comparable):
                checks.append(Check(name, quantity, 0.0, math.inf, sentence=f", {reason}"))
                continue
            if isinstance(promise, Unpromised):
                bound, parts = _without_promise(quantity, prediction, [*usable, row])
            else:
                bound, parts = _promised(quantity, prediction, promise, softness, row, usable, as_soft)
            told = ", no number: who can't tell it promises NaN of it" if math.isnan(measured) else ""
            checks.append(Check(name, quantity, measured, bound, parts, told))
    return tuple(checks)


def _why_not(quantity: str, outcome: Outcome, prediction: Prediction, promise: Promise | Unpromised) -> str:
    """Why there need not be a number that a check could hold; "" where there has to be one."""
    if not outcome.comparable:
        return "the run can't be compared, so its outcome alone is held"
    if not prediction.has(quantity):
        return "the scene has no such number"
    untold = isinstance(promise, Promise) and math.isnan(promise.of(quantity))
    return "the engine says that it can't tell it" if untold else ""


Bound = tuple[float, tuple[tuple[str, float], ...]]


def _promised(
    quantity: str,
    prediction: Prediction,
    promise: Promise,
    softness: Softness | None,
    row: Measurement,
    usable: Sequence[Measurement],
    as_soft: Mapping[str, float] | None,
) -> Bound:
    cost, soft, rounding = terms(quantity, prediction, promise, softness, row.step, as_soft)
    cost, soft = ROOM * cost, ROOM_SOFT * soft
    order = promise.of(quantity)
    rigid = prediction.prescribed and softness is None
    if order < EXACT and len(usable) >= (ENOUGH if math.isfinite(cost + soft) else 1):
        # The next power has its largest share in the coarsest steps.
        nearest = sorted(usable, key=lambda other: other.step)[: ENOUGH if rigid else None]
        known = [getattr(other, quantity) * (row.step / other.step) ** order for other in nearest]
        room = ROOM_PRESCRIBED if rigid else ROOM_OWN
        own = room * max((value for value in known if not math.isnan(value)), default=math.inf)
        # Where the judge's soft run lost the motion, the method's own steps are all that is known.
        cost, soft = (min(cost, own), soft) if math.isfinite(soft) else (own, 0.0)
    if rigid and order == 1 and promise.order > 1:
        cost = min(cost, ROOM_PRESCRIBED * MIDDLE[quantity] * row.step * prediction.earlier[quantity])
    return (
        min(cost + soft + rounding, prediction.refused(quantity)),
        (("step", cost), ("softness", soft), ("rounding", rounding)),
    )


def _without_promise(quantity: str, prediction: Prediction, rows: Sequence[Measurement]) -> Bound:
    """By what the method's own steps differ: a smaller one is what a larger one is wrong against."""
    known = [error for row in rows if not math.isnan(error := getattr(row, quantity))]
    most = SATURATED if quantity == "reaction" else prediction.refused(quantity)
    differ = ROOM_UNPROMISED * (max(known) - min(known)) if len(known) > ENOUGH else math.inf
    return min(max(differ, SMALL * most), most), (("own steps", differ), ("least", SMALL * most))


def idle(checks: Iterable[Check]) -> Counter[str]:
    """How many checks can't fail, by the reason: those with an infinite bound."""
    return Counter(check.sentence.removeprefix(", ") or "no bound" for check in checks if math.isinf(check.bound))
