"""Error estimates of poses for a method of order 4, from runs with steps h, 2h and, if needed, h / 2."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM

Array = NDArray[np.float64]
Counts = NDArray[np.int_]  # numbers of steps since t = 0, ascending, or indices

ORDER = 4
# Largest difference between runs that may be rounding, in rad or relative to the mechanism's length.
ROUNDING_DIFFERENCE = 1e-8
MAX_RATIO = 1 / 8  # largest ratio of successive differences that confirms at least order 3


@dataclass(frozen=True)
class StepDoubling:
    """Differences between the poses of runs with other steps and with steps h, or NaN after a run fails."""

    counts: Counts  # The numbers (times,) of steps h before each pose, which contain both neighbours of an odd number.
    watched: Counts  # Indices of even counts at which the order is checked.
    unit: Array  # The units of a pose (3,).
    double: Array  # Differences (even counts, bodies, 3) of the run with steps 2h.
    half: Array | None = None  # Differences (times, bodies, 3) of the run with steps h / 2.

    @cached_property
    def difference(self) -> Array:
        """The differences (times, bodies, 3) of the run with steps 2h.

        After an odd number of steps it is the larger of the two adjacent differences, or NaN if a difference is NaN.
        """
        even, odd = self.counts[self.counts % 2 == 0], self.counts % 2
        before, after = (self.double[np.searchsorted(even, count)] for count in (self.counts - odd, self.counts + odd))
        return np.where(np.abs(before) > np.abs(after), before, after + 0 * before)

    @cached_property
    def conclusive(self) -> Counts:
        """The `watched` indices before the difference from the run with steps 2h first exceeds CLAIM."""
        is_small = self.relative(self.difference[self.watched]) <= CLAIM
        return self.watched[: np.argmin([*is_small, False])]

    @property
    def needs_half(self) -> bool:
        return len(self.conclusive) < len(self.watched)

    def relative(self, difference: Array) -> Array:
        """The largest component (times,) of differences of poses, in rad or relative to the mechanism's length."""
        return np.max(np.abs(difference) / self.unit, axis=(1, 2))

    def estimate(self) -> tuple[Array, Array]:
        """The errors of the poses, and corrections that extrapolate the poses to zero step (times, bodies, 3).

        Rounding in stiff rows does not decrease with h, so differences below ROUNDING_DIFFERENCE are not divided by 15.

        With a run of steps h / 2, q is the ratio of its difference to the difference of the run with steps 2h. For RK4
        q is 1/16, and q <= 1/8 confirms at least order 3. Each difference for further halved steps is then assumed to
        be at most half of the previous difference, so their sum is at most 2 q times the difference of that run. If q >
        1/8, each difference is assumed to be at most 2/3 of the previous difference, so their sum is three times the
        first difference. (Near a change point, one half in place of 2/3 missed a fifth of the error.) Since an error
        may cross zero, q is the ratio of the largest differences so far.
        """
        size = np.abs(self.difference)
        if self.half is None:
            error = np.maximum(size / (2**ORDER - 1), np.minimum(size, ROUNDING_DIFFERENCE * self.unit))
            return error, -self.difference / (2**ORDER - 1)
        coarse, fine = (
            np.maximum.accumulate(self.relative(each[self.watched])) for each in (self.difference, self.half)
        )
        q = fine / np.where(coarse > 0, coarse, np.inf)
        factor = np.where(q <= MAX_RATIO, 1 + 2 * q, 3.0)  # the factor is 3 if the run with 2h failed
        last_watched = np.searchsorted(self.counts[self.watched], self.counts, side="right") - 1
        return np.abs(self.half) * factor[last_watched, None, None], self.half * 2**ORDER / (2**ORDER - 1)

    def unresolved_from(self, error: Array) -> int | None:
        """The number of steps after which the motion is unresolved; None if no error (times, bodies, 3) exceeds CLAIM.

        The result is the count of the first error above CLAIM, or the count after the last `conclusive` index if this
        is smaller. The result is 0 if no index is conclusive.
        """
        above = np.flatnonzero(~(self.relative(error) <= CLAIM))
        if not len(above):
            return None
        return int(min(self.counts[above[0]], self.counts[self.conclusive[-1]] + 1)) if len(self.conclusive) else 0
