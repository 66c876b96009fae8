"""Rolling the two curves of a motion on each other, held against the motion they came from."""

from __future__ import annotations

import numpy as np

from reference.chapter.centrodes import Centrodes
from reference.checks import InvalidMechanism
from reference.rolling.curves import Array

CHECKED = 101  # places looked at: enough to meet the largest error of smooth curves, few enough to wait for


def returned(curves: Centrodes) -> tuple[float, float]:
    """(largest distance [m] between the poses and those of the curves' rolling, rotation [rad] looked at).

    Raises InvalidMechanism where the curves can't roll on each other.
    """
    rolling = curves.rolling()
    low, high = rolling.limits
    inside = np.flatnonzero((curves.theta >= low) & (curves.theta <= high))
    if not inside.size:
        raise InvalidMechanism("round trip: no pose lies within the rotations at which the curves touch")
    inside = inside[:: max(1, len(inside) // CHECKED)]
    pose: Array = curves.pose[inside]
    distance = np.linalg.norm(rolling.pose(pose[:, 2])[:, :2] - pose[:, :2], axis=-1)
    return float(distance.max()), float(np.ptp(pose[:, 2]))
