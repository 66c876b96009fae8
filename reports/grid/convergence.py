"""What a sweep over steps tells: the observed order (discretisation) and the plateau (the model), kept apart."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from reports.grid.errors import NAN
from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.grid.quantities import QUANTITIES, Quantity

# A local slope below this is no convergence: half a decade of steps then wins less than a factor 1.5.
FLAT = 0.35
# Fewest points that carry an order with a word on its fit; two points give a slope and nothing to check it by.
ENOUGH = 3
# Rounding may grow by this much after it was met: steps a hundred times as small are a hundred times as many.
ROUNDING_GROWTH = 100.0
# An error this close to the plateau is the sum of both, and its slope is neither.
NEAR_PLATEAU = 3.0


class Verdict(StrEnum):
    """What the error does as the step goes to zero."""

    FALLS = "falls"
    ROUNDING = "reaches rounding"
    PLATEAU = "plateau"
    LEVELS = "levels off at the finest step"
    GROWS = "grows as the step shrinks"
    ERRATIC = "erratic"
    TOO_FEW = "not enough points"


@dataclass(frozen=True)
class Sweep:
    """One quantity of one scene in one engine variant, over all steps that ended without failing.

    order: slope of log error over log step on `points` points of the falling part (NaN without two); spread: the
    largest difference of a local slope from it; plateau: the error that stays, in the quantity's unit (NaN without
    one); best: the smallest error met, at `best_step` [s].
    """

    scene: str
    engine: str
    variant: str
    quantity: Quantity
    verdict: Verdict
    order: float
    points: int
    spread: float
    plateau: float
    best: float
    best_step: float

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"


def local_slopes(steps: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Slopes of log error over log step between neighbours, steps descending."""
    return np.diff(np.log(errors)) / np.diff(np.log(steps))


def fit(steps: Iterable[float], errors: Iterable[float], rounding: float) -> tuple[Verdict, float, int, float, float]:
    """(verdict, order, points, spread, plateau) of errors at steps; see Sweep. Not finite or zero steps are left out.

    An error at or below `rounding` is rounding, whatever it does there.
    """
    pairs = sorted(((h, e) for h, e in zip(steps, errors, strict=True) if math.isfinite(e)), reverse=True)
    if not pairs:
        return Verdict.TOO_FEW, NAN, 0, NAN, NAN
    first = next((index for index, (_, e) in enumerate(pairs) if e <= rounding), len(pairs))
    # After it has met rounding an error may grow again, as rounding does with the number of steps; not by much more.
    reaches = first < len(pairs) and pairs[-1][1] <= ROUNDING_GROWTH * rounding
    above = pairs[:first] if reaches else [(h, e) for h, e in pairs if e > rounding]
    if len(above) < 2:
        return (Verdict.ROUNDING if reaches else Verdict.TOO_FEW), NAN, 0, NAN, NAN
    h, e = np.array([p[0] for p in above]), np.array([p[1] for p in above])
    slopes = local_slopes(h, e)
    falling = _longest_run(slopes > FLAT)
    plateau = _plateau(slopes, e) if not reaches else NAN
    order, points, spread = _order(h, e, slopes, falling, plateau)
    if reaches:
        return Verdict.ROUNDING, order, points, spread, NAN
    if not math.isnan(plateau):
        return Verdict.PLATEAU, order, points, spread, plateau
    if slopes[-1] > FLAT:
        return Verdict.FALLS, order, points, spread, NAN
    if slopes[-1] < -FLAT and (len(slopes) == 1 or slopes[-2] < FLAT):
        return Verdict.GROWS, order, points, spread, NAN
    # One flat interval alone may be a crossing of signs; two would have been a plateau.
    return (Verdict.LEVELS if slopes[-1] > -FLAT else Verdict.ERRATIC), order, points, spread, NAN


def _longest_run(mask: np.ndarray) -> tuple[int, int]:
    """(start, stop) of the longest run of true values, the finest of equals."""
    best, start = (0, 0), None
    for index, value in enumerate([*mask, False]):
        if value and start is None:
            start = index
        elif not value and start is not None:
            if index - start >= best[1] - best[0]:
                best = (start, index)
            start = None
    return best


def _plateau(slopes: np.ndarray, errors: np.ndarray) -> float:
    """The error of the flat end, NaN unless it covers at least two intervals (or all there are)."""
    flat = 0
    for slope in slopes[::-1]:
        if abs(slope) > FLAT:
            break
        flat += 1
    return float(np.exp(np.mean(np.log(errors[-flat - 1 :])))) if flat >= 2 else NAN


def _order(
    steps: np.ndarray, errors: np.ndarray, slopes: np.ndarray, run: tuple[int, int], plateau: float
) -> tuple[float, int, float]:
    """Least squares over the falling run, without steps too coarse for the slope and errors near the plateau."""
    start, stop = run[0], run[1] + 1
    if run[0] == run[1]:
        return NAN, 0, NAN
    while stop > start and errors[stop - 1] < NEAR_PLATEAU * plateau:
        stop -= 1
    if stop - start < 2:
        return NAN, 0, NAN
    while stop - start > ENOUGH and abs(slopes[start] - np.median(slopes[start : stop - 1])) > 0.5:
        start += 1
    order = float(np.polyfit(np.log(steps[start:stop]), np.log(errors[start:stop]), 1)[0])
    return order, stop - start, float(np.max(np.abs(slopes[start : stop - 1] - order)))


def groups(rows: Iterable[Measurement]) -> dict[tuple[str, str, str], list[Measurement]]:
    """The rows of sweeps by (scene, engine, variant), each from coarse to fine, in the order of their first row."""
    found: dict[tuple[str, str, str], list[Measurement]] = {}
    for row in rows:
        if row.purpose == "sweep":
            found.setdefault((row.scene, row.engine, row.variant), []).append(row)
    return {key: sorted(members, key=lambda row: -row.step) for key, members in found.items()}


def sweeps(rows: Iterable[Measurement]) -> tuple[Sweep, ...]:
    """Every quantity of every group of rows."""
    out = []
    for (scene, engine, variant), members in groups(rows).items():
        usable = [row for row in members if Outcome(row.outcome).comparable]
        for quantity in QUANTITIES:
            values = [(row.step, getattr(row, quantity.name)) for row in usable]
            steps, errors = [step for step, _ in values], [error for _, error in values]
            verdict, order, points, spread, plateau = fit(steps, errors, quantity.rounding)
            known = [(error, step) for step, error in values if math.isfinite(error)]
            best, best_step = min(known, default=(NAN, NAN))
            out.append(
                Sweep(scene, engine, variant, quantity, verdict, order, points, spread, plateau, best, best_step)
            )
    return tuple(out)


def by_method(found: Iterable[Sweep], quantity: str) -> Mapping[tuple[str, str, str], Sweep]:
    """The sweeps of one quantity by (scene, engine, variant)."""
    return {(s.scene, s.engine, s.variant): s for s in found if s.quantity.name == quantity}


def judged(rows: Iterable[Measurement], quantity: str = "angle") -> list[Measurement]:
    """The rows with `finished` replaced by what their sweep says: converged or plateau, where it says either."""
    rows = list(rows)
    verdicts = by_method(sweeps(rows), quantity)
    out = []
    for row in rows:
        sweep = verdicts.get((row.scene, row.engine, row.variant))
        if row.purpose == "sweep" and row.outcome == Outcome.FINISHED and sweep is not None:
            checked = sweep.verdict is Verdict.FALLS and sweep.points >= ENOUGH
            if checked or sweep.verdict is Verdict.ROUNDING:
                row = replace(row, outcome=Outcome.CONVERGED)
            elif sweep.verdict is Verdict.PLATEAU:
                near = getattr(row, quantity) < NEAR_PLATEAU * sweep.plateau
                row = replace(row, outcome=Outcome.PLATEAU if near else Outcome.FINISHED)
        out.append(row)
    return out


def best_of(rows: Iterable[Measurement], engine: str, variant: str, quantity: str = "angle") -> Measurement | None:
    """The row with the least error of one method that can be compared; None without one."""
    usable = [
        row
        for row in rows
        if (row.engine, row.variant) == (engine, variant)
        and Outcome(row.outcome).comparable
        and math.isfinite(getattr(row, quantity))
    ]
    return min(usable, key=lambda row: getattr(row, quantity), default=None)
