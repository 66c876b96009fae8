"""The law of motion in plain equations, with joints that hold exactly or give way as an engine declares.

It is a second way to the same accelerations as the judge's, and the only one with a compliance that grows and falls
with the gap. J a = bias - damping slip - stiffness gap - compliance F, and M a = f + J^T F.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from engines.reading import Give
from reference.mechanism import Mechanism
from reference.rows import solve_symmetric

Array = NDArray[np.float64]
TOLERANCE = 1e-10  # far below what an engine's own step leaves, far above rounding


def accelerations(mechanism: Mechanism, pose: Array, twist: Array, t: float, give: Give | None = None) -> Array:
    """(bodies, 3) [m/s^2, rad/s^2] at pose and twist (bodies, 3)."""
    inverse = 1 / mechanism.inertias.reshape(-1)
    free = np.broadcast_to(mechanism.unconstrained(pose, twist), pose.shape).reshape(-1)
    if not mechanism.row_count:
        return free.reshape(-1, 3)
    rows = mechanism.joint_rows.dense(pose)
    step = 1e-100
    bias = -np.imag(mechanism.joint_rows.velocities(pose + 1j * step * twist, twist)) / step
    right = bias - rows @ free
    matrix = (rows * inverse) @ rows.T
    if give is not None:
        slip = rows @ twist.reshape(-1) - mechanism.rate
        gap = np.nan_to_num(mechanism.joint_rows.gap(pose, np.asarray(t)))
        right = right - give.damping * slip - give.stiffness * gap
        right = right + np.nan_to_num(give.instead - bias)
        matrix = matrix + np.diag(give.compliance)
    return (free + inverse * (rows.T @ solve_symmetric(matrix, right))).reshape(-1, 3)


def soft_motion(mechanism: Mechanism, give: Callable[[Array], Give], t: Array) -> tuple[Array, Array]:
    """Poses and twists (times, bodies, 3) of joints that give way; NaN from where the equations are not solved."""
    count = mechanism.pose.size
    lengths = np.tile([mechanism.length_scale, mechanism.length_scale, 1.0], len(mechanism.bodies))
    allowed = TOLERANCE * np.concatenate([lengths, lengths / mechanism.time_scale])

    def rates(at: float, state: Array) -> Array:
        pose, twist = state[:count].reshape(-1, 3), state[count:].reshape(-1, 3)
        gap = np.nan_to_num(mechanism.joint_rows.gap(pose, np.asarray(at)))
        change = accelerations(mechanism, pose, twist, at, give(gap))
        return np.concatenate([state[count:], change.reshape(-1)])

    start = np.concatenate([mechanism.pose.reshape(-1), mechanism.twist.reshape(-1)])
    found: Any = solve_ivp(rates, (0.0, float(t[-1])), start, "DOP853", t_eval=t, rtol=TOLERANCE, atol=allowed)
    out = np.full((len(t), 2, *mechanism.pose.shape), np.nan)
    done = found.y.shape[1]
    out[:done] = found.y.T.reshape(done, 2, -1, 3)
    return out[:, 0], out[:, 1]
