"""The promised order against the one that a sweep over steps shows."""

from __future__ import annotations

import math
from collections.abc import Sequence

from engines import EXACT, Promise, Unpromised
from reports.model.checks import Check
from reports.model.convergence import ENOUGH, Verdict, fit
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import quantity

# An observed order may lie this much below the promised one: at a tenth of a radian the next power is a tenth of the
# leading one, half a decade on a thirtieth, and 10^0.5 in steps turns that into 0.1; the sign of it is unknown. A last
# point a few times above rounding takes about as much again.
BELOW = 0.4
# And this much above it: a promise that is one too low is noticed.
ABOVE = 0.95
# Errors above this [rad] are not proportional to what causes them, so no order is read from them.
PROPORTIONAL = 0.1
TOO_FEW = "fewer than three steps have an error above rounding and below a tenth of a radian"


def order(promise: Promise | Unpromised, rows: Sequence[Measurement]) -> tuple[Check, ...]:
    """The check of one method's rows, if they can tell: three points that are above rounding and small enough. With
    fewer it can't fail, and says so.

    measured: how far the observed order is from the promised one, in multiples of what it may be. An error that levels
    off, grows or jumps about has the order 0.
    """
    if isinstance(promise, Unpromised) or promise.order == EXACT:
        return ()
    usable = [row for row in rows if Outcome(row.outcome).comparable and row.angle <= PROPORTIONAL]
    found = fit([row.step for row in usable], [row.angle for row in usable], quantity("angle").rounding)
    above = [row for row in usable if row.angle > quantity("angle").rounding]
    if len(above) < ENOUGH:
        return (Check("order", "angle", 0.0, math.inf, sentence=f", {TOO_FEW}"),)
    flat = found.verdict in (Verdict.PLATEAU, Verdict.LEVELS, Verdict.GROWS, Verdict.ERRATIC)
    observed = 0.0 if flat or found.points < 2 else found.order
    short = promise.order - observed
    value = f" at {found.plateau:.2g} rad" if found.verdict is Verdict.PLATEAU else f", order {observed:.2f}"
    told = f", {found.verdict}{value}"
    return (Check("order", "angle", short / BELOW if short > 0 else -short / ABOVE, 1.0, sentence=told),)
