"""Roots: of an increasing function for many targets at once; the first instant at which a value falls below zero."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

# Newton takes fewer than ten rounds on the curves here; bisection of a double's whole range takes about sixty more.
ROUNDS = 200
SHORT = 1e-10


def solve_increasing(
    function: Callable[[Array], tuple[Array, Array]],
    target: ArrayLike,
    guess: ArrayLike,
    scale: float,
    limits: tuple[float, float] = (-np.inf, np.inf),
) -> Array:
    """x (...) with function(x) = target (...), to a few roundings of max(|x|, scale).

    `function` gives the value and the slope, both (...); it is evaluated within `limits` only, where it must increase,
    and the answer is clipped to them. Raises ArithmeticError when a target is out of reach or not finite.
    """
    target = np.asarray(target, dtype=float)
    x = np.clip(np.array(np.broadcast_to(np.asarray(guess, dtype=float), target.shape)), *limits)
    low, high = np.full(x.shape, limits[0]), np.full(x.shape, limits[1])
    if not np.all(np.isfinite(target)):
        raise ArithmeticError("a target of the root search is not finite")
    before = np.full(x.shape, np.inf)
    for _ in range(ROUNDS):
        value, slope = function(x)
        missing = target - value
        low, high = np.where(missing >= 0, x, low), np.where(missing <= 0, x, high)
        with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
            following: NDArray[Any] = x + missing / slope
            middle = 0.5 * (low + high)
        # A step that is not much shorter than the one before may go to and fro for ever: halve the bracket instead.
        shrinks = (np.abs(following - x) <= 0.75 * before) | ~np.isfinite(middle)
        newton = np.isfinite(following) & (following >= low) & (following <= high) & shrinks
        following = np.where(newton, following, middle)
        # A bracket open on one side has no middle: walk towards that side instead.
        following = np.where(np.isfinite(following), following, x + np.sign(missing) * (np.abs(x) + scale))
        moved = np.abs(following - x)
        x, before = following, moved
        # A Newton step this short squares to less than rounding; asking for more would wait on the noise of `function`.
        enough = np.where(newton, SHORT, 4 * np.finfo(float).eps)
        if np.all(moved <= enough * np.maximum(np.abs(x), scale)):
            return x
    raise ArithmeticError(f"no root was found within {ROUNDS} rounds; the target may be out of reach")


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
    from scipy.optimize import brentq  # half of the time that all engines take to be imported

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
