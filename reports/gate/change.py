"""The gate of change: a row against the same cell of a baseline, and what rounding may do to it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from reports.gate.baseline import Old
from reports.gate.checks import CHANGE, Check
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.grid.quantities import DIGITS, QUANTITIES

# With other versions an error may become this many times as large.
WORSE = 3.0
# What starts that differ by one rounding do, seen in a few of them, is this much short of the most it may do.
ROOM = 10.0
# The last of the digits in a baseline's file is rounded; half of it would do for a number that begins with 1.
PRINTED = 10.0 ** (1 - DIGITS)


def change(row: Measurement, old: Old, nudged: Sequence[Measurement] = ()) -> tuple[Check, ...]:
    """The checks of a row that was made with the baseline's versions: the same numbers, to rounding.

    `nudged`: the same cell from starts that are rounded otherwise, which tell what rounding does to it; without them
    numbers have to be the same in all printed digits.
    """
    if not (Outcome(row.outcome).comparable and old.outcome.comparable):
        same = row.outcome == old.outcome or any(other.outcome == old.outcome for other in nudged)
        told = f", {row.outcome}; it was {old.outcome}"
        return (Check(CHANGE, "outcome", 0.0 if same else math.inf, 1.0, sentence=told),)
    out = []
    for name, before in known(old).items():
        now = getattr(row, name)
        if math.isnan(now) and math.isnan(before):
            continue
        spread = max((abs(getattr(other, name) - now) for other in nudged), default=0.0)
        terms = (("printed digits", PRINTED * abs(before)), ("rounding", ROOM * spread))
        told = f", {now:.4g}; it was {before:.4g}"
        out.append(Check(CHANGE, name, abs(now - before), sum(value for _, value in terms), terms, told))
    return tuple(out)


def drift(row: Measurement, old: Old) -> tuple[Check, ...]:
    """The checks of a row that was made with other versions: no error more than WORSE times as large."""
    if not old.outcome.comparable:
        return ()
    if not Outcome(row.outcome).comparable:
        return (Check(CHANGE, "outcome", math.inf, 1.0, sentence=f", {row.outcome}; it was {old.outcome}"),)
    rounding = {quantity.name: quantity.rounding for quantity in QUANTITIES}
    out = []
    for name, before in known(old).items():
        now = getattr(row, name)
        if not math.isnan(before):
            told = f", {now:.4g}; it was {before:.4g}"
            terms = (("baseline", before), ("rounding", rounding[name]))
            out.append(Check(CHANGE, name, now, WORSE * (before + rounding[name]), terms, told))
    return tuple(out)


def known(old: Old) -> Mapping[str, float]:
    """The errors that are compared."""
    return old.errors


def moved(row: Measurement, old: Old) -> bool:
    """Whether a row differs from its baseline in what is printed."""
    return any(not check.passed for check in change(row, old))
