"""The first instant at which a function along a motion falls below zero, found on polynomials that the motion sets.

A motion's own steps say how fast it changes everywhere, not at its start alone. Between two of them a function is taken
as a Chebyshev series, halved until the series has come to its end (Boyd, Solving Transcendental Equations, 2014). Where
the slope of a series vanishes is known from eigenvalues, so a fall between any two looks is seen, however short.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import NDArray
from scipy.optimize import brentq

Array = NDArray[np.float64]
# times (times,) to values (functions, times), and the size (times,) of the terms of which these are the small sum.
Function = Callable[[Array], tuple[Array, Array]]

DEGREE = 32
# In parts of the size: a fall less deep than this is the rounding of a few hundred operations.
ROUNDING = 1e-13
ENDED = 1e-12  # of the size: what the last quarter of a series may still have
# A series whose end falls by less than this when its interval is halved is at the noise of the function, or at a jump.
# Each analytic series falls far faster, by 2^-24 in its last quarter.
IMPROVES = 0.25

_NODES = chebyshev.chebpts2(DEGREE + 1)
_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_NODES, DEGREE))


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """Where a function of one number changes its sign between these, to rounding of the larger."""
    least = max(4 * np.finfo(float).eps * max(abs(low), abs(high)), np.finfo(float).tiny)
    return float(brentq(function, low, high, xtol=least, rtol=np.float64(1e-15)))  # type: ignore[arg-type]


def first_below(function: Function, knots: Array) -> tuple[float, int] | None:
    """The first time at which a value is below zero, from the first to the last of `knots` (knots,) [s], and which.

    `knots` are the ends of a motion's steps, within which no function of it turns often. None where none falls deeper
    than rounding.
    """
    for begin, end, values, series, noise in _pieces(function, knots):
        found = [
            (*instant, index)
            for index, (own, terms) in enumerate(zip(values, series, strict=True))
            if (instant := _fall(begin, end, own, terms, noise)) is not None
        ]
        crossings = []
        for before, after, index in found:

            def value(t: float, index: int = index) -> float:
                return float(function(np.array([t]))[0][index, 0])

            # The series may be off by the noise: at the ends the function itself has to have the signs.
            if not value(before) > 0:
                crossings.append((before, index))
            elif value(after) < 0:
                crossings.append((root(value, before, after), index))
        if crossings:
            return min(crossings)
    return None


def _pieces(function: Function, knots: Array) -> list[tuple[float, float, Array, Array, float]]:
    """Intervals in order, each with values at the nodes and series (functions, DEGREE + 1), and the noise in them."""
    begin, end = knots[:-1], knots[1:]
    before = np.full(len(begin), np.inf)
    pieces: list[tuple[float, float, Array, Array, float]] = []
    while begin.size:
        times = np.clip(begin[:, None] + 0.5 * (end - begin)[:, None] * (1 + _NODES), begin[:, None], end[:, None])
        flat, size = function(times.ravel())
        values = np.moveaxis(flat.reshape(len(flat), *times.shape), 0, 1)  # (pieces, functions, nodes)
        series = values @ _TO_SERIES.T
        sizes = size.reshape(times.shape).max(axis=1)
        left = np.abs(series[..., -(DEGREE // 4) :]).max(axis=(1, 2))
        done = (left <= ENDED * sizes) | (left > IMPROVES * before) | (begin + 0.25 * (end - begin) == begin)
        for index in np.flatnonzero(done):
            noise = ROUNDING * float(sizes[index])
            pieces.append((float(begin[index]), float(end[index]), values[index], series[index], noise))
        middle = 0.5 * (begin[~done] + end[~done])
        begin, end = np.concatenate([begin[~done], middle]), np.concatenate([middle, end[~done]])
        before = np.tile(left[~done], 2)
    return sorted(pieces, key=lambda piece: piece[0])


def _fall(begin: float, end: float, values: Array, series: Array, noise: float) -> tuple[float, float] | None:
    """Two times between which a series falls from above zero to below the noise, or its begin twice; None if never."""
    if values.min() >= -noise and series[0] - np.abs(series[1:]).sum() > 0:
        return None
    slopes = chebyshev.chebroots(np.trim_zeros(chebyshev.chebder(series), "b"))
    # A pair of roots that is nearly double may be found beside the real line; one place too many does no harm.
    flat = np.real(slopes[np.abs(np.imag(slopes)) < 1e-3])
    places = np.unique(np.concatenate([_NODES, np.clip(flat, -1, 1)]))
    heights = chebyshev.chebval(places, series)
    below = np.flatnonzero(heights < -noise)
    if not below.size:
        return None
    above = np.flatnonzero(heights[: below[0]] > 0)
    before = places[above[-1]] if above.size else places[0]
    times = [begin + 0.5 * (end - begin) * (1 + float(place)) for place in (before, places[below[0]])]
    return times[0], min(times[1], end)
