"""An error estimate of poses by step doubling, for a method of order 4: runs with steps h, 2h and, if needed, h / 2."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM

Array = NDArray[np.float64]
Counts = NDArray[np.int_]  # of steps since the start, ascending, or indices in such an array

ORDER = 4
# In rad, or relative to the mechanism's length: the largest difference of two runs that rounding may explain.
ROUNDING_DIFFERENCE = 1e-8
MAX_RATIO = 1 / 8  # of the differences of successive step sizes, up to which at least third order is confirmed


@dataclass(frozen=True)
class StepDoubling:
    """Poses of a run with steps h, compared with those of runs with other steps.

    `counts` (times,): the steps h before each pose. Every odd count has both neighbours in it. `watched`: the indices
    of the even counts at which the order is checked. `unit` (3,): the pose unit. `double` (even counts, bodies, 3) and
    `half` (times, bodies, 3): poses of runs with steps 2h and h / 2, less those with steps h; NaN where a run failed.
    """

    counts: Counts
    watched: Counts
    unit: Array
    double: Array
    half: Array | None = None

    @cached_property
    def difference(self) -> Array:
        """The differences to steps 2h (times, bodies, 3).

        After an odd number of steps it is the larger of the differences before and after; NaN where either is.
        """
        even, odd = self.counts[self.counts % 2 == 0], self.counts % 2
        before, after = (self.double[np.searchsorted(even, count)] for count in (self.counts - odd, self.counts + odd))
        return np.where(np.abs(before) > np.abs(after), before, after + 0 * before)

    @cached_property
    def conclusive(self) -> Counts:
        """The leading `watched` indices at which the difference to steps 2h is at most CLAIM."""
        is_small = self.relative(self.difference[self.watched]) <= CLAIM
        return self.watched[: np.argmin([*is_small, False])]

    @property
    def needs_half(self) -> bool:
        """Whether the difference to steps 2h is too large to confirm the order."""
        return len(self.conclusive) < len(self.watched)

    def relative(self, difference: Array) -> Array:
        """The largest component (times,) of differences of poses, in rad or relative to the mechanism's length."""
        return np.max(np.abs(difference) / self.unit, axis=(1, 2))

    def estimate(self) -> tuple[Array, Array]:
        """The error of poses, and the correction that extrapolates them to zero step (times, bodies, 3).

        Rounding in stiff rows does not shrink with h, so differences below ROUNDING_DIFFERENCE are not divided by 15.

        With steps h / 2, let q be the ratio of the differences to these and to 2h, 1/16 for RK4. Up to q = 1/8 at least
        third order is confirmed. If the step were halved further, and each difference were at most half of the one
        before, the others would add up to at most 2 q times the difference. Otherwise each is assumed to be up to 2/3
        of the one before, so that all add up to three times the first: near a change point they fell so slowly that a
        ratio of one half missed a fifth of the error. An error may pass zero, so q is the ratio of the largest
        differences so far.
        """
        size = np.abs(self.difference)
        if self.half is None:
            error = np.maximum(size / (2**ORDER - 1), np.minimum(size, ROUNDING_DIFFERENCE * self.unit))
            return error, -self.difference / (2**ORDER - 1)
        coarse, fine = (
            np.maximum.accumulate(self.relative(each[self.watched])) for each in (self.difference, self.half)
        )
        q = fine / np.where(coarse > 0, coarse, np.inf)
        factor = np.where(q <= MAX_RATIO, 1 + 2 * q, 3.0)  # also 3 where the run with steps 2h has failed
        last_watched = np.searchsorted(self.counts[self.watched], self.counts, side="right") - 1
        return np.abs(self.half) * factor[last_watched, None, None], self.half * 2**ORDER / (2**ORDER - 1)

    def unresolved_from(self, error: Array) -> int | None:
        """The number of steps after which an error (times, bodies, 3) is above CLAIM; None if it is nowhere.

        It is dated back to the first `watched` time at which the comparison with steps 2h exceeds CLAIM.
        """
        above = np.flatnonzero(~(self.relative(error) <= CLAIM))
        if not len(above):
            return None
        return int(min(self.counts[above[0]], self.counts[self.conclusive[-1]] + 1)) if len(self.conclusive) else 0
