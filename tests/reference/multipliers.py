"""The motion of a mechanism by exact multipliers, to hold closed forms against."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

# Two tight integrations agree to their tolerance times the steps; the closed forms are better than either.
TIGHT = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


def multipliers(mechanism, until):
    """The pose at a time, by multipliers on the rows alone: knows no scene."""
    count, weights = len(mechanism.bodies), mechanism.inertias.ravel()

    def rate(_, state):
        pose, twist = state.reshape(2, count, 3)
        rows, fall = mechanism.rows(pose), mechanism.free_fall.ravel()
        lagging = mechanism.bias(pose, twist) - rows @ fall
        force = np.linalg.lstsq(rows / weights @ rows.T, lagging, rcond=1e-10)[0]
        return np.concatenate([twist.ravel(), fall + rows.T @ force / weights])

    start = np.concatenate([mechanism.pose.ravel(), mechanism.twist.ravel()])
    return solve_ivp(rate, (0, until), start, **TIGHT).y[: 3 * count, -1].reshape(count, 3)
