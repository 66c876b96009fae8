"""The ideal motion of a mechanism of one freedom along its configuration curve, also through singular positions.

With the arc length s of the curve in the metric of the mass matrix, q' = tau(q) v and v' = tau . f, where v = s'. tau
spans the null space of the rows, with tau^T M tau = 1. f are the applied forces; ideal joints do no work along tau.
The equations contain no multipliers, so that no small singular value is a divisor. If two rows become dependent, as at
a dead centre of a parallelogram, the null space has further directions. Finite forces leave the velocity continuous, so
tau is then the direction of the null space that is closest to the previous one.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
# Ratio to the largest singular value of the scaled rows below which a direction counts as allowed. Where two curves
# cross, a drift d off the curve leads to the other curve unless this ratio is well above the root of d; d is at most
# 1e-12 of the length. The direction of motion may turn by about this ratio near a crossing, so the error there is about
# its square, 1e-8, and it decreases afterwards. On parallelograms errors were below 1e-9 with 1e-5, 1e-4 and 1e-3.
NULL_SPACE_TOLERANCE = 1e-4
CURVE_BODY_LIMIT = 40  # The limit bounds the time: each evaluation decomposes all rows.


def has_one_freedom(mechanism: Mechanism) -> bool:
    """Whether the mechanism has one freedom, only holonomic joints, and no prescribed rate."""
    return (
        0 < len(mechanism.bodies) <= CURVE_BODY_LIMIT
        and mechanism.degrees_of_freedom() == (1, 1)
        and bool(mechanism.holonomic.all())
        and not mechanism.rate.any()
    )


def motion_along_curve(mechanism: Mechanism, t: Array, tolerance: float) -> Trajectory:
    """The motion at times t (times,) [s] of a mechanism for which `has_one_freedom`; NaN after the integration fails.

    `tolerance` is the relative error of a step.
    """
    states, tangent, count = _states(mechanism, t, tolerance), _Tangent(mechanism), mechanism.pose.size
    pose, twist, acceleration = (np.full((len(t), *mechanism.pose.shape), np.nan) for _ in range(3))
    sound = np.isfinite(states).all(axis=1)
    for sample in np.flatnonzero(sound):
        pose[sample] = states[sample, :count].reshape(-1, 3)
        twist[sample] = (tangent(states[sample, :count]) * states[sample, count]).reshape(-1, 3)
        acceleration[sample] = _acceleration(mechanism, pose[sample], twist[sample], tangent.last)
    reaction = np.full((len(t), mechanism.row_count), np.nan)
    reaction[sound] = mechanism.reaction(pose[sound], acceleration[sound], twist=twist[sound])
    return Trajectory(t, pose, twist, reaction, 0.0)


class _Tangent:
    """tau (3 bodies,) at a pose (3 bodies,), without a change of sign from the previous evaluation."""

    def __init__(self, mechanism: Mechanism) -> None:
        self.mechanism, self.root = mechanism, np.sqrt(mechanism.inertias.reshape(-1))
        self.last = np.zeros(0)
        first = self._allowed(mechanism.pose)[0]
        along = first @ (self.root * mechanism.twist.reshape(-1))
        self.last = (first if along >= 0 else -first) / self.root

    def __call__(self, pose: Array) -> Array:
        allowed = self._allowed(pose.reshape(-1, 3))
        direction = allowed.T @ (allowed @ (self.root * self.last))
        self.last = direction / np.linalg.norm(direction) / self.root
        return self.last

    def _allowed(self, pose: Array) -> Array:
        """Basis (directions, 3 bodies) of the null space, orthonormal after scaling by the roots of the inertias."""
        rows = self.mechanism.joint_rows.dense(pose) / self.root
        sizes = np.linalg.norm(rows, axis=1, keepdims=True)
        _, values, right = np.linalg.svd(rows / np.where(sizes > 0, sizes, 1.0), full_matrices=True)
        rank = int(np.sum(values > NULL_SPACE_TOLERANCE * values[0]))
        return right[min(rank, rows.shape[1] - 1) :]


def _states(mechanism: Mechanism, t: Array, tolerance: float) -> Array:
    """q and v (times, 3 bodies + 1); NaN after the integration fails."""
    tangent, count = _Tangent(mechanism), mechanism.pose.size
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    start = float(tangent.last @ (mechanism.inertias.reshape(-1) * mechanism.twist.reshape(-1)))
    speed = float(np.linalg.norm(tangent.root * unit)) / mechanism.time_scale

    def rates(at: float, state: Array) -> Array:
        if not np.isfinite(state).all():
            return np.full_like(state, np.nan)
        along = tangent(state[:count])
        pose, twist = state[:count].reshape(-1, 3), (along * state[count]).reshape(-1, 3)
        force = mechanism.inertias * mechanism.unconstrained(pose, twist)
        return np.append(along * state[count], along @ force.reshape(-1))

    allowed: Any = tolerance * np.append(unit, speed)
    begin = np.append(mechanism.pose.reshape(-1), start)
    with np.errstate(all="ignore"):
        solution: Any = solve_ivp(rates, (0.0, float(t[-1])), begin, "DOP853", t_eval=t, rtol=tolerance, atol=allowed)
    out = np.full((len(t), count + 1), np.nan)
    out[: solution.y.shape[1]] = solution.y.T
    return out


def _acceleration(mechanism: Mechanism, pose: Array, twist: Array, along: Array) -> Array:
    """Acceleration (bodies, 3): the forces determine the part along the curve, the rows' bias the part across it."""
    rows = mechanism.joint_rows.dense(pose)
    bias = mechanism.bias(pose, twist)
    root = np.sqrt(mechanism.inertias.reshape(-1))
    across = np.linalg.lstsq(rows / root, bias, rcond=NULL_SPACE_TOLERANCE)[0] / root
    force = (mechanism.inertias * mechanism.unconstrained(pose, twist)).reshape(-1)
    return (across + along * (along @ force)).reshape(-1, 3)
