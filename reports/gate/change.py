"""The gate of change: a row against the same cell of a baseline, and a method against itself over all its scenes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from statistics import median

from reports.gate.baseline import Old
from reports.model.checks import CHANGE, Check
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import room

# With other versions an error may become this many times as large: by luck, as where two errors no longer cancel.
WORSE = 3.0
# The median of n draws scatters 1.25 / sqrt(n) times as much as one draw does (of a normal distribution).
SCATTER = 1.2533
# What a few other roundings do is this much short of the most that rounding may do.
ROOM = 10.0
# A method is dear where it takes this many times the CPU time of the baseline: told always, since no other machine and
# no load of this one makes as much.
DEAR = 10.0


def change(row: Measurement, old: Old, nudged: Sequence[Measurement] = (), amplified: float = 1.0) -> tuple[Check, ...]:
    """The checks of a row that was made with the baseline's versions: the same numbers, to rounding.

    The bound is the `room` of the quantity (`reports.model.quantities`), which is never zero, and what `nudged`, the
    same cell in other roundings, differ by: where the motion amplifies rounding. `amplified`: as `Promise.amplified`.
    """
    if not (Outcome(row.outcome).comparable and old.outcome.comparable):
        same = row.outcome == old.outcome or any(other.outcome == old.outcome for other in nudged)
        return (_outcome(row, old, same),)
    others = [other for other in nudged if Outcome(other.outcome).comparable]
    out = []
    for name, before in old.errors.items():
        now = getattr(row, name)
        if math.isnan(now) and math.isnan(before):
            continue
        known = [value for other in others if math.isfinite(value := getattr(other, name))]
        spread = max((abs(value - now) for value in known), default=0.0)
        digits, rounding = room(name, before, amplified)
        terms = (("printed digits", digits), ("rounding", rounding), ("as other roundings", ROOM * spread))
        told = f", {now:.4g}; it was {before:.4g}"
        out.append(Check(CHANGE, name, abs(now - before), sum(value for _, value in terms), terms, told))
    return (*out, *_reactions(row, old))


def drift(row: Measurement, old: Old) -> tuple[Check, ...]:
    """The checks of a row that was made with other versions: no error more than WORSE times as large, none unknown that
    was a number, and no other outcome; but for a run that can be compared by now."""
    if not (Outcome(row.outcome).comparable and old.outcome.comparable):
        return (_outcome(row, old, row.outcome == old.outcome or Outcome(row.outcome).comparable),)
    out = []
    for name, before in old.errors.items():
        now = getattr(row, name)
        if not math.isnan(before):
            rounding = room(name, before)[1]
            told = f", {now:.4g}; it was {before:.4g}"
            terms = (("baseline", before), ("rounding", rounding))
            out.append(Check(CHANGE, name, now, WORSE * (before + rounding), terms, told))
    return (*out, *_reactions(row, old))


def _outcome(row: Measurement, old: Old, same: bool) -> Check:
    told = f", {row.outcome}; it was {old.outcome}"
    return Check(CHANGE, "outcome", 0.0 if same else math.inf, 1.0, sentence=told)


def _reactions(row: Measurement, old: Old) -> tuple[Check, ...]:
    """A reaction's error is of the rows that an engine tells: none of them may fall silent."""
    silent = old.reaction_rows - row.reaction_rows
    told = f", rows without a reaction; it told {old.reaction_rows} of them"
    return (Check(CHANGE, "reaction_rows", float(silent), 0.0, sentence=told),) if silent > 0 else ()


def known_by_now(row: Measurement, old: Old) -> tuple[str, ...]:
    """Sentences on what a baseline of other versions has no number for, and the row has."""
    if not Outcome(row.outcome).comparable:
        return ()
    if not old.outcome.comparable:
        return (f"outcome: {row.outcome}; it was {old.outcome}",)
    found = ((name, getattr(row, name)) for name, before in old.errors.items() if math.isnan(before))
    return tuple(f"{name}: {now:.4g}; it was not known" for name, now in found if not math.isnan(now))


def growth(pairs: Iterable[tuple[Measurement, Old]]) -> tuple[Check, ...]:
    """Whether a method's errors grew with other versions over all its scenes: one check a method and quantity.

    In one scene luck may make an error WORSE times as large or small. Luck of n scenes has no common sign: the median
    of the logarithms of their factors scatters SCATTER / sqrt(n) times as much as one of them, so the median factor is
    held below WORSE to that power. The cells of a scene share its luck, so they count as one, by the median of their
    own factors. Errors below rounding have the factor 1.
    """
    factors: dict[tuple[str, str], dict[str, list[float]]] = {}
    for row, old in pairs:
        if not (Outcome(row.outcome).comparable and old.outcome.comparable):
            continue
        for name, before in old.errors.items():
            now, rounding = getattr(row, name), room(name, before)[1]
            if math.isfinite(now) and math.isfinite(before):
                of_scenes = factors.setdefault((row.method, name), {})
                of_scenes.setdefault(row.scene, []).append((now + rounding) / (before + rounding))
    out = []
    for (method, name), of_scenes in factors.items():
        measured = median(median(own) for own in of_scenes.values())
        bound = WORSE ** min(1.0, SCATTER / math.sqrt(len(of_scenes)))
        told = f", {method}: the median factor of its error over {len(of_scenes)} scenes"
        out.append(Check(CHANGE, name, measured, bound, sentence=told))
    return tuple(out)


def cost(pairs: Iterable[tuple[Measurement, Old]]) -> float:
    """How many times the baseline's CPU time a method takes, over the cells that both have timed; NaN without one.

    The sum counts, which is that of the longest runs: a run of a millisecond is timed badly.
    """
    timed = [
        (row.cpu, old.cpu)
        for row, old in pairs
        if Outcome(row.outcome).comparable and old.outcome.comparable and row.cpu > 0 and old.cpu > 0
    ]
    return sum(now for now, _ in timed) / sum(before for _, before in timed) if timed else math.nan


def moved(row: Measurement, old: Old, amplified: float = 1.0) -> bool:
    """Whether a row differs from its baseline by more than printing and rounding may change."""
    return any(not check.passed for check in change(row, old, amplified=amplified))
