"""The observed order and the plateau of the errors in a sweep over steps."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from reference.numerics.roots import root
from reports.model.errors import NAN
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES, Quantity

ROOM_SOFT = 2.0  # Safety factor on the error of the declared softness, which depends on an estimated inertia.
FLAT = 0.35  # A smaller slope is no convergence, since half a decade of steps reduces the error by less than 1.5.
ENOUGH_POINTS = 3  # Fewest points for an order. Two points determine a slope but do not verify it.
ROUNDING_GROWTH = 100.0  # Rounding errors may grow by this factor at finer steps, since a run then has more steps.
NEAR_PLATEAU = 3.0  # An error within this factor of the plateau is not used for the order.
POWERS = (0.5, 8.0)  # Smallest and largest power of the step with which an error may approach its limit.


class Verdict(StrEnum):
    FALLS = "falls"
    ROUNDING = "reaches rounding"
    PLATEAU = "plateau"
    LEVELS = "levels off at the finest step"
    GROWS = "grows as the step shrinks"
    ERRATIC = "erratic"
    TOO_FEW = "not enough points"


class Fit(NamedTuple):
    verdict: Verdict
    order: float = NAN  # Slope of log error over log step in the falling part.
    points: int = 0  # Number of points in the falling part.
    spread: float = NAN  # Largest difference between a local slope and the order.
    plateau: float = NAN  # Limit of the error for step zero, in the unit of the error.
    uncertainty: float = NAN  # Uncertainty of the plateau.


@dataclass(frozen=True)
class Sweep:
    """The `Fit` of a quantity over all comparable steps of an engine variant in a scene."""

    scene: str
    engine: str
    variant: str
    quantity: Quantity
    verdict: Verdict
    order: float
    points: int
    spread: float
    plateau: float
    uncertainty: float
    best: float  # The smallest error.
    best_step: float  # s.

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    @property
    def lucky(self) -> bool:
        """Whether the smallest error is far below the plateau, which means that two errors cancel at its step."""
        return self.verdict is Verdict.PLATEAU and self.best < self.plateau / 2


def fit(steps: Iterable[float], errors: Iterable[float], rounding: float) -> Fit:
    """Determine how errors depend on the step [s]. Errors that are not finite are left out. An error of at most
    `rounding` counts as rounding."""
    return _fit(
        tuple(sorted(((h, e) for h, e in zip(steps, errors, strict=True) if math.isfinite(e)), reverse=True)), rounding
    )


@lru_cache(maxsize=32768)  # A page, the index and the readme need the same sweep.
def _fit(pairs: tuple[tuple[float, float], ...], rounding: float) -> Fit:
    if not pairs:
        return Fit(Verdict.TOO_FEW)
    first = next((index for index, (_, e) in enumerate(pairs) if e <= rounding), len(pairs))
    # At finer steps rounding may grow again with the number of steps, but not by more than ROUNDING_GROWTH.
    reaches = first < len(pairs) and pairs[-1][1] <= ROUNDING_GROWTH * rounding
    above = list(pairs[:first]) if reaches else [(h, e) for h, e in pairs if e > rounding]
    if len(above) < 2:
        return Fit(Verdict.ROUNDING if reaches else Verdict.TOO_FEW)
    h, e = np.array([p[0] for p in above]), np.array([p[1] for p in above])
    slopes = np.diff(np.log(e)) / np.diff(np.log(h))
    falling = _longest_run(slopes > FLAT)
    limit, uncertainty = (NAN, NAN) if reaches else _plateau(h, e, slopes)
    order, points, spread = _order(h, e, slopes, falling, limit)
    if reaches:
        return Fit(Verdict.ROUNDING, order, points, spread)
    if not math.isnan(limit):
        return Fit(Verdict.PLATEAU, order, points, spread, limit, uncertainty)
    if slopes[-1] > FLAT:
        return Fit(Verdict.FALLS, order, points, spread)
    if slopes[-1] < -FLAT and (len(slopes) == 1 or slopes[-2] < FLAT):
        return Fit(Verdict.GROWS, order, points, spread)
    # A single flat interval may be a change of sign of the error. Two flat intervals would be a plateau.
    return Fit(Verdict.LEVELS if slopes[-1] > -FLAT else Verdict.ERRATIC, order, points, spread)


def _longest_run(mask: np.ndarray) -> tuple[int, int]:
    """(start, stop) of the longest run of true values. Among runs of equal length the last run counts."""
    runs = np.flatnonzero(np.diff([False, *mask, False])).reshape(-1, 2).tolist()
    start, stop = max(reversed(runs), key=lambda run: run[1] - run[0], default=(0, 0))
    return start, stop


def _plateau(steps: np.ndarray, errors: np.ndarray, slopes: np.ndarray) -> tuple[float, float]:
    """(limit, uncertainty) if the last two intervals are flat, or NaN. One flat interval suffices if the errors rise to
    a limit after two errors have cancelled at a coarser step."""
    if len(errors) < 3 or abs(slopes[-1]) > FLAT:
        return NAN, NAN
    limit, uncertainty, settles = _limit(steps[-3:], errors[-3:])
    rises = settles and bool(errors[-1] > errors[-2])
    return (limit, uncertainty) if rises or abs(slopes[-2]) <= FLAT else (NAN, NAN)


def _limit(steps: np.ndarray, errors: np.ndarray) -> tuple[float, float, bool]:
    """(limit, uncertainty, whether the errors converge) of a fit limit + factor * step ** power to three points. If no
    power within POWERS fits, the limit is the error at the finest step. The uncertainty is then the largest difference
    between this error and the other two errors."""
    before, last = errors[0] - errors[1], errors[1] - errors[2]
    if last and before / last > 0:
        wanted = before / last

        def excess(power: float) -> float:
            first, second, third = steps**power
            return float((first - second) / (second - third) - wanted)

        if excess(POWERS[0]) <= 0 <= excess(POWERS[1]):
            power = root(excess, *POWERS)
            rest = last / ((steps[1] / steps[2]) ** power - 1)
            return float(errors[2] - rest), float(abs(rest)), True
    return float(errors[2]), float(np.max(np.abs(errors[:2] - errors[2]))), False


def _order(
    steps: np.ndarray, errors: np.ndarray, slopes: np.ndarray, run: tuple[int, int], plateau: float
) -> tuple[float, int, float]:
    """(order, points, spread) of a least-squares fit in the falling part, without coarse outliers and the plateau."""
    start, stop = run[0], run[1] + 1
    if run[0] == run[1]:
        return NAN, 0, NAN
    while stop > start and errors[stop - 1] < NEAR_PLATEAU * plateau:
        stop -= 1
    if stop - start < 2:
        return NAN, 0, NAN
    while stop - start > ENOUGH_POINTS and abs(slopes[start] - np.median(slopes[start : stop - 1])) > 0.5:
        start += 1
    order = float(np.polyfit(np.log(steps[start:stop]), np.log(errors[start:stop]), 1)[0])
    return order, stop - start, float(np.max(np.abs(slopes[start : stop - 1] - order)))


def groups(rows: Iterable[Measurement]) -> dict[tuple[str, str, str], list[Measurement]]:
    """(scene, engine, variant) -> rows of the sweep, from coarse to fine steps."""
    members: dict[tuple[str, str, str], list[Measurement]] = {}
    for row in rows:
        if row.purpose == "sweep":
            members.setdefault((row.scene, row.engine, row.variant), []).append(row)
    return {key: sorted(group, key=lambda row: -row.step) for key, group in members.items()}


def sweeps(rows: Iterable[Measurement], quantities: Iterable[Quantity] = QUANTITIES) -> tuple[Sweep, ...]:
    quantities = tuple(quantities)
    out = []
    for (scene, engine, variant), members in groups(rows).items():
        usable = [row for row in members if Outcome(row.outcome).comparable]
        for quantity in quantities:
            steps, errors = [row.step for row in usable], [getattr(row, quantity.name) for row in usable]
            known = [(error, step) for step, error in zip(steps, errors, strict=True) if math.isfinite(error)]
            best = min(known, default=(NAN, NAN))
            out.append(Sweep(scene, engine, variant, quantity, *fit(steps, errors, quantity.rounding), *best))
    return tuple(out)


def by_method(found: Iterable[Sweep], quantity: str) -> Mapping[tuple[str, str, str], Sweep]:
    return {(s.scene, s.engine, s.variant): s for s in found if s.quantity.name == quantity}


def judged(rows: Iterable[Measurement], quantity: str = "angle") -> list[Measurement]:
    """Replace the outcome `finished` by `converged` or `plateau` if the sweep of the row shows this."""
    rows = list(rows)
    verdicts = by_method(sweeps(rows, [q for q in QUANTITIES if q.name == quantity]), quantity)
    out = []
    for row in rows:
        sweep = verdicts.get((row.scene, row.engine, row.variant))
        if row.purpose == "sweep" and row.outcome == Outcome.FINISHED and sweep is not None:
            checked = sweep.verdict is Verdict.FALLS and sweep.points >= ENOUGH_POINTS
            if checked or sweep.verdict is Verdict.ROUNDING:
                row = replace(row, outcome=Outcome.CONVERGED)
            elif sweep.verdict is Verdict.PLATEAU:
                near = getattr(row, quantity) < NEAR_PLATEAU * sweep.plateau
                row = replace(row, outcome=Outcome.PLATEAU if near else Outcome.FINISHED)
        out.append(row)
    return out
