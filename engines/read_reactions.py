"""Reactions from what an engine did: the accelerations at its samples, with its own masses and gravity."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism

Array = NDArray[np.float64]


def reactions(
    mechanism: Mechanism,
    pose: Array,
    twist: Array,
    acceleration: Array,
    inertias: Array,
    gravity: Array | tuple[float, float],
) -> Array:
    """`Mechanism.reaction` where the motion is finite, NaN elsewhere."""
    out = np.full((len(pose), mechanism.row_count), np.nan)
    # Squares of the numbers must be finite as well, or the factorisation raises instead of giving NaN.
    sane = np.all((np.abs(pose) < 1e100) & (np.abs(acceleration) < 1e100), axis=(1, 2))
    if mechanism.row_count and np.any(sane):
        with np.errstate(all="ignore"):
            out[sane] = mechanism.reaction(pose[sane], acceleration[sane], inertias, np.array(gravity), twist[sane])
    return out
