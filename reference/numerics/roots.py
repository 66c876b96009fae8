"""Roots of an increasing function for many targets, and the first time at which a function is negative."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from reference.validators import Array

# Newton's method takes fewer than ten iterations on these curves; bisection to rounding adds about sixty iterations.
MAX_ITERATIONS = 200
# A relative Newton step of at most this length ends the iteration, since the error is then below rounding. A smaller
# limit could be below the noise of the function.
LAST_NEWTON_STEP = 1e-10


def solve_increasing(
    function: Callable[[Array], tuple[Array, Array]],
    target: ArrayLike,
    guess: ArrayLike,
    scale: float,
    limits: tuple[float, float] = (-np.inf, np.inf),
) -> Array:
    """The roots x (...) of function(x) = target (...), with errors of a few roundings of max(|x|, scale).

    `function` returns its values (...) and slopes (...). The function must increase within `limits` and is evaluated
    only there; x is clipped to the limits. Raises ArithmeticError if a target is out of reach or not finite.
    """
    target = np.asarray(target, dtype=float)
    x = np.clip(np.array(np.broadcast_to(np.asarray(guess, dtype=float), target.shape)), *limits)
    low, high = np.full(x.shape, limits[0]), np.full(x.shape, limits[1])
    if not np.all(np.isfinite(target)):
        raise ArithmeticError("a target of the root search is not finite")
    last_step = np.full(x.shape, np.inf)
    for _ in range(MAX_ITERATIONS):
        value, slope = function(x)
        missing = target - value
        low, high = np.where(missing >= 0, x, low), np.where(missing <= 0, x, high)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            following: NDArray[Any] = x + missing / slope
            middle = 0.5 * (low + high)
        # Bisect if the Newton step is not much shorter than the last step, since Newton's method may oscillate.
        shrinks = (np.abs(following - x) <= 0.75 * last_step) | ~np.isfinite(middle)
        newton = np.isfinite(following) & (following >= low) & (following <= high) & shrinks
        following = np.where(newton, following, middle)
        # If one bound is infinite, there is no middle, and x takes a long step towards this bound.
        following = np.where(np.isfinite(following), following, x + np.sign(missing) * (np.abs(x) + scale))
        last_step = np.abs(following - x)
        x = following
        enough = np.where(newton, LAST_NEWTON_STEP, 4 * np.finfo(float).eps)
        if np.all(last_step <= enough * np.maximum(np.abs(x), scale)):
            return x
    raise ArithmeticError(f"no root was found within {MAX_ITERATIONS} iterations; the target may be out of reach")


# A function of times (times,) returns values (functions, times) and the size (times,) of the terms that are summed.
Function = Callable[[Array], tuple[Array, Array]]

# Degree of a Chebyshev series over one interval.
SERIES_DEGREE = 32
# Rounding of a few hundred operations, relative to the size of the terms. A negative value within this rounding counts
# as zero.
SUM_ROUNDING = 1e-13
# Largest coefficient in the last quarter of a converged series, relative to the size of the terms.
CONVERGED = 1e-12
# If halving an interval reduces the last quarter of coefficients by less than this factor, the cause is noise or a
# jump. For an analytic function the factor is 2^-24.
IMPROVES = 0.25

_LOBATTO_POINTS = chebyshev.chebpts2(SERIES_DEGREE + 1)
_LOBATTO_TO_SERIES = np.linalg.inv(chebyshev.chebvander(_LOBATTO_POINTS, SERIES_DEGREE))


def root(function: Callable[[float], float], low: float, high: float) -> float:
    """The root of a function whose signs differ at `low` and `high`, to rounding of the larger bound."""
    from scipy.optimize import brentq  # imported here, since the import is slow

    least = max(4 * np.finfo(float).eps * max(abs(low), abs(high)), np.finfo(float).tiny)
    return float(brentq(function, low, high, xtol=least, rtol=np.float64(1e-15)))  # type: ignore[arg-type]


def first_below(function: Function, knots: Array) -> tuple[float, int] | None:
    """The first time at which a function is negative, and its index, or None if every function is at least -rounding.

    `knots` (knots,) [s] are the ends of a motion's steps; functions have few extrema between two knots. The search
    covers the times from the first to the last knot.
    """
    for begin, end, values, series, noise in _pieces(function, knots):
        brackets = [
            (*bracket, index)
            for index, (at_points, coefficients) in enumerate(zip(values, series, strict=True))
            if (bracket := _crossing(begin, end, at_points, coefficients, noise)) is not None
        ]
        crossings = []
        for low, high, index in brackets:

            def value(t: float, index: int = index) -> float:
                return float(function(np.array([t]))[0][index, 0])

            # The signs of the function decide, since the series has the error `noise`.
            if not value(low) > 0:
                crossings.append((low, index))
            elif value(high) < 0:
                crossings.append((root(value, low, high), index))
        if crossings:
            return min(crossings)
    return None


def _pieces(function: Function, knots: Array) -> list[tuple[float, float, Array, Array, float]]:
    begin, end = knots[:-1], knots[1:]
    last_tail = np.full(len(begin), np.inf)
    pieces: list[tuple[float, float, Array, Array, float]] = []
    while begin.size:
        times = np.clip(
            begin[:, None] + 0.5 * (end - begin)[:, None] * (1 + _LOBATTO_POINTS), begin[:, None], end[:, None]
        )
        flat, size = function(times.ravel())
        values = np.moveaxis(flat.reshape(len(flat), *times.shape), 0, 1)  # (pieces, functions, nodes)
        series = values @ _LOBATTO_TO_SERIES.T
        sizes = size.reshape(times.shape).max(axis=1)
        tail = np.abs(series[..., -(SERIES_DEGREE // 4) :]).max(axis=(1, 2))
        done = (tail <= CONVERGED * sizes) | (tail > IMPROVES * last_tail) | (begin + 0.25 * (end - begin) == begin)
        for index in np.flatnonzero(done):
            noise = SUM_ROUNDING * float(sizes[index])
            pieces.append((float(begin[index]), float(end[index]), values[index], series[index], noise))
        middle = 0.5 * (begin[~done] + end[~done])
        begin, end = np.concatenate([begin[~done], middle]), np.concatenate([middle, end[~done]])
        last_tail = np.tile(tail[~done], 2)
    return sorted(pieces, key=lambda piece: piece[0])


def _crossing(begin: float, end: float, values: Array, series: Array, noise: float) -> tuple[float, float] | None:
    """Two times around the first change of a series from above zero to below -noise, or None without such a change.

    If the series is never above zero before it is below -noise, the first time is `begin`.
    """
    if values.min() >= -noise and series[0] - np.abs(series[1:]).sum() > 0:
        return None
    slopes = chebyshev.chebroots(np.trim_zeros(chebyshev.chebder(series), "b"))
    # Rounding can move two nearly equal roots off the real axis, so roots near the axis are included.
    flat = np.real(slopes[np.abs(np.imag(slopes)) < 1e-3])
    places = np.unique(np.concatenate([_LOBATTO_POINTS, np.clip(flat, -1, 1)]))
    heights = chebyshev.chebval(places, series)
    below = np.flatnonzero(heights < -noise)
    if not below.size:
        return None
    above = np.flatnonzero(heights[: below[0]] > 0)
    last_above = places[above[-1]] if above.size else places[0]
    times = [begin + 0.5 * (end - begin) * (1 + float(point)) for point in (last_above, places[below[0]])]
    return times[0], min(times[1], end)
