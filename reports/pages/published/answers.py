"""What others published, and what is asked of a method there: numbers to be held against, copied digit by digit.

Andrews' mechanism: F. Mazzia, C. Magherini, Test set for initial value problem solvers, release 2.4, II-17.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.scenes.andrews import Andrews

# Angles of one body against another, as the test set has them, by the names of the bodies.
ANGLES = ("K1", "K2 - K1", "K3", "K4 - K5", "K5", "K6 - K7", "K7")
INSTANT = 0.03  # s
END = (15.81077119629904, -15.75637105984298, 0.04082224013073101, -0.5347301163226948)
END += (0.5244099658805304, 0.5347301163226948, 1.048080741042263)  # rad, at that instant
ACCELERATIONS = (14222.4439199541138705911625887, -10666.8329399655854029433719415)  # rad/s^2, at the start
MULTIPLIERS = (98.5668703962410896057654982170, -6.12268834425566265503114393122)  # N, at the start


@dataclass(frozen=True)
class Compared:
    """One published number beside ours."""

    what: str
    published: float
    found: float

    @property
    def difference(self) -> float:
        return self.found - self.published


def relative(angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """The test set's coordinates (..., 7) of the bodies' angles (..., 7) [rad], or of their derivatives."""
    k1, k2, k3, k4, k5, k6, k7 = np.moveaxis(angles, -1, 0)
    return np.stack([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7], axis=-1)


def compared(scene: Andrews) -> list[Compared]:
    """The end, and the accelerations and multipliers at the start that are not zero.

    The test set has M q'' = f - G^T lambda, with rows that are the rod's end less that of body 3. Ours have the rod
    second too, and M a = f + J^T reaction: so a multiplier is minus the force on the rod.
    """
    motion, mechanism = scene.motion([0.0, INSTANT]), scene.mechanism()
    free = mechanism.unconstrained(motion.pose[0], motion.twist[0])
    pushed = mechanism.rows(motion.pose[0]).T @ motion.reaction[0]
    first = relative((free + pushed.reshape(free.shape) / mechanism.inertias)[:, 2])
    names = mechanism.row_names
    rows = [
        Compared(f"angle of {name} at {INSTANT:g} s [rad]", published, float(found))
        for name, published, found in zip(ANGLES, END, relative(motion.pose[1, :, 2]), strict=True)
    ]
    rows += [
        Compared(f"acceleration of {name} at 0 [rad/s²]", published, float(found))
        for name, published, found in zip(ANGLES, ACCELERATIONS, first, strict=False)
    ]
    rows += [
        Compared(f"multiplier of P, {axis}, at 0 [N]", published, -float(motion.reaction[0, names.index(f"P3 {axis}")]))
        for axis, published in zip("xy", MULTIPLIERS, strict=True)
    ]
    return rows
