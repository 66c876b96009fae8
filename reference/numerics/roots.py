"""The root of an increasing function, for many targets at once: Newton's method that can't leave its bracket."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
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
