"""How a cost or an error grows with the size of the problem: exponents fitted to the large end of a series."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome

NAN = float("nan")
LAST = 3  # points of a fit: a growth law is seen at the large end, where what is paid in any case no longer counts


@dataclass(frozen=True)
class Point:
    """One method at one size: CPU seconds of a step, and the largest angle error [rad] (NaN where only timed)."""

    size: int
    step: float
    error: float
    outcome: str


@dataclass(frozen=True)
class Series:
    """One method over all sizes, small to large."""

    engine: str
    variant: str
    points: tuple[Point, ...]

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    def at(self, size: int) -> Point | None:
        return next((point for point in self.points if point.size == size), None)


def series_of(rows: Mapping[Cell, Measurement], timed: float) -> tuple[Series, ...]:
    """The rows of pendulums by method; cells that ran for less than `timed` seconds count for their cost alone."""
    found: dict[tuple[str, str], list[Point]] = {}
    for cell, row in rows.items():
        size = int(getattr(cell.scene, "links", 0))
        comparable = Outcome(row.outcome).comparable
        whole = cell.scene.duration >= timed * (1 - 1e-9)
        cost = row.cpu * cell.step if comparable or not whole else NAN
        error = row.angle if whole and comparable else NAN
        found.setdefault((row.engine, row.variant), []).append(Point(size, cost, error, str(row.outcome)))
    return tuple(
        Series(engine, variant, tuple(sorted(points, key=lambda point: point.size)))
        for (engine, variant), points in found.items()
    )


def exponent(sizes: Iterable[float], values: Iterable[float], last: int = LAST) -> tuple[float, int, int]:
    """(slope of log value over log size at the `last` finite points, first and last size of the fit).

    NaN and zeros with fewer than two points.
    """
    pairs = [(n, v) for n, v in zip(sizes, values, strict=True) if math.isfinite(v) and v > 0][-last:]
    if len(pairs) < 2:
        return NAN, 0, 0
    n, v = np.log(np.array(pairs, dtype=float)).T
    return float(np.polyfit(n, v, 1)[0]), int(pairs[0][0]), int(pairs[-1][0])


def cost_exponent(series: Series) -> tuple[float, int, int]:
    """Of the CPU time of a step."""
    return exponent([p.size for p in series.points], [p.step for p in series.points])


def error_exponent(series: Series) -> tuple[float, int, int]:
    """Of the angle error."""
    return exponent([p.size for p in series.points], [p.error for p in series.points])
