"""The ideal motion of a mechanism with one freedom along its configuration curve, also through singular positions.

The arc length s of the curve is measured in the metric of the mass matrix M. The equations are q' = tau(q) v and v' =
tau^T f with the speed v = s' and the applied forces f. Ideal joints do no work along tau. The vector tau spans the null
space of the rows, and tau^T M tau = 1. The equations contain no multipliers, so there is no division by a small
singular value. If two rows become dependent, as at a dead centre of a parallelogram, the null space has further
directions. The velocity is continuous for finite forces, so tau is then the direction closest to the previous tau.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
# The rows allow a direction if its singular value is below this share of the largest singular value. Where two curves
# cross, a drift d can lead to the wrong curve unless this share is far above sqrt(d). The drift is at most 1e-12 of the
# length. Near a crossing the direction of motion may turn by about this share, which causes an error of about 1e-8.
# On parallelograms the errors were below 1e-9 with the shares 1e-5, 1e-4 and 1e-3.
NULL_SPACE_TOLERANCE = 1e-4
CURVE_BODY_LIMIT = 40  # For more bodies the decomposition of all rows at each evaluation would take too long.


def has_one_freedom(mechanism: Mechanism) -> bool:
    """Whether the mechanism has one freedom, only holonomic joints, and no prescribed rate."""
    return (
        0 < len(mechanism.bodies) <= CURVE_BODY_LIMIT
        and mechanism.degrees_of_freedom() == (1, 1)
        and bool(mechanism.holonomic.all())
        and not mechanism.rate.any()
    )


def motion_along_curve(mechanism: Mechanism, t: Array, tolerance: float) -> Trajectory:
    """The motion of a mechanism with one freedom at times t (times,) [s], or NaN after the integration has failed.
    tolerance: relative error of a step."""
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
    """The direction tau (3 bodies,) at a pose (3 bodies,), with the same sign in successive evaluations."""

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
        """Orthonormal basis (directions, 3 bodies) of the null space, in coordinates scaled by sqrt(inertia)."""
        rows = self.mechanism.joint_rows.dense(pose) / self.root
        sizes = np.linalg.norm(rows, axis=1, keepdims=True)
        _, values, right = np.linalg.svd(rows / np.where(sizes > 0, sizes, 1.0), full_matrices=True)
        rank = int(np.sum(values > NULL_SPACE_TOLERANCE * values[0]))
        return right[min(rank, rows.shape[1] - 1) :]


def _states(mechanism: Mechanism, t: Array, tolerance: float) -> Array:
    from scipy.integrate import solve_ivp

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
    """Acceleration (bodies, 3). Forces determine the component along the curve, and the rows' bias the rest."""
    rows = mechanism.joint_rows.dense(pose)
    bias = mechanism.bias(pose, twist)
    root = np.sqrt(mechanism.inertias.reshape(-1))
    across = np.linalg.lstsq(rows / root, bias, rcond=NULL_SPACE_TOLERANCE)[0] / root
    force = (mechanism.inertias * mechanism.unconstrained(pose, twist)).reshape(-1)
    return (across + along * (along @ force)).reshape(-1, 3)
