"""Richardson's extrapolation to zero step, and estimates of its error, as functions of arrays.

levels: relative numbers of steps of the runs, in ascending order.
powers: powers of the step that the combination removes from the error, one fewer than levels.
values (levels, times, ...): results of the runs.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from reference.checks import Count, InvalidMechanism, Numbers, validated

Array = NDArray[np.float64]

# Safety factor on the predicted error.
CAUTION = 4
# The estimated error is at least this share of the last difference. The value was fitted to 1300 random mechanisms in
# three engines.
LEAST = 0.5
# Safety factor on the difference from an extrapolation with a further run of 1.5 times as many steps. The error of the
# further extrapolation is six times smaller, so the difference is the error to within a fifth.
DECIDED = 1.5


@validated
def extrapolation_weights(levels: tuple[Count, ...], powers: tuple[Count, ...]) -> Array:
    """Weights w (levels,) of runs at steps dt / level, with sum w = 1 and sum w level^-power = 0 for every power."""
    if len(set(levels)) != len(levels) or len(set(powers)) != len(powers) or len(levels) != len(powers) + 1:
        raise InvalidMechanism(
            f"extrapolation: levels are {levels!r} and powers {powers!r}; all must differ, with one power fewer"
        )
    steps = levels[0] / np.array(levels, dtype=float)
    matrix = np.array([steps**power for power in (0, *powers)])
    return np.linalg.solve(matrix, np.eye(len(levels))[0])


@validated
def combine(values: Numbers, weights: Array) -> Array:
    """The weighted sum of values (levels, ...), or NaN if a value is not finite.

    The sum is the finest value plus weighted differences from the finest value. If values are equal at all levels, as
    at t = 0, the sum has no rounding error.
    """
    with np.errstate(all="ignore"):
        finest = values[-1]
        out = finest + np.tensordot(weights[:-1], values[:-1] - finest, axes=1)
    return np.where(np.all(np.isfinite(values), axis=0), out, np.nan)


def differences(values: Array, levels: tuple[int, ...], powers: tuple[int, ...]) -> list[Array]:
    """Absolute differences (times, ...) between the extrapolations of the k + 1 and the k finest runs, k = 1, 2, ..."""
    extrapolations = [
        combine(values[-count:], extrapolation_weights(levels[-count:], powers[: count - 1]))
        for count in range(1, len(levels) + 1)
    ]
    with np.errstate(all="ignore"):
        return [np.abs(more - fewer) for fewer, more in pairwise(extrapolations)]


@validated
def expected_error(
    values: Numbers, levels: tuple[Count, ...], powers: tuple[Count, ...], least: float | Array = LEAST
) -> Array:
    """The estimated error (times, ...) of an extrapolation of values (levels, times, ...), all in one unit.

    The `differences` decrease with k if the runs have an error expansion. The last difference is the error of the
    extrapolation without the coarsest run. The ratio of successive differences predicts the remaining error. Ratios
    increase in asymptotic series, so the larger of the last ratio and its extrapolation is used. The estimate is
    CAUTION times the prediction. The estimate is at least the share `least` (times,) of the last difference, which may
    cross zero. The estimate is at most the error that a single wrong run would cause. Ratios use the largest
    differences up to each time.
    """
    steps = differences(values, levels, powers)
    with np.errstate(all="ignore"):
        sizes = [np.fmax.accumulate(np.fmax.reduce(d.reshape(len(d), -1), axis=1, initial=0.0)) for d in steps]
        ratios = [np.nan_to_num(finer / rough, nan=0.0) for rough, finer in pairwise(sizes[-3:])]
        rising = [np.nan_to_num(last**2 / before, nan=0.0) for before, last in pairwise(ratios)]
        weights = extrapolation_weights(levels, powers)
        fewer = np.array([0.0, *extrapolation_weights(levels[1:], powers[:-1])])
        most = np.abs(weights / (weights - fewer)).max()
        expected = CAUTION * np.max([ratios[-1], *rising], axis=0) if ratios else most
        factor = np.clip(expected, np.minimum(least, most), most)
        return steps[-1] * np.reshape(factor, (-1, *(1,) * (steps[-1].ndim - 1)))


def decided_error(
    values: Array, combined: Array, further: Array, levels: tuple[int, ...], powers: tuple[int, ...]
) -> Array:
    """The error of `combined`, estimated from an extrapolation in which `further` replaces the coarsest run."""
    weights = extrapolation_weights((*levels[1:], further_level(levels)), powers)
    with np.errstate(all="ignore"):
        return DECIDED * np.abs(combine(np.concatenate([values[1:], further[None]]), weights) - combined)


def further_level(levels: tuple[int, ...]) -> int:
    """The level of the further run, which is 1.5 times the finest level, rounded up."""
    return -(-3 * levels[-1] // 2)
