"""Errors of a trajectory relative to the exact motion at the same instants. An unknown error is NaN."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory, energy, joint_gap, slip

Array = NDArray[np.float64]
NAN = float("nan")


def largest(values: Array) -> float:
    """The largest absolute value. NaN values are ignored unless all values are NaN."""
    values = np.abs(np.asarray(values, dtype=float))
    values = values[~np.isnan(values)]
    return float(values.max()) if values.size else NAN


def root_mean_square(values: Array) -> float:
    """The root mean square. NaN values are ignored unless all values are NaN."""
    values = np.asarray(values, dtype=float)
    values = values[~np.isnan(values)]
    return float(np.sqrt(np.mean(values**2))) if values.size else NAN


def usable_samples(trajectory: Trajectory) -> int:
    """The number of samples before the first sample that is not finite."""
    finite = np.isfinite(trajectory.pose).all(axis=(1, 2)) & np.isfinite(trajectory.twist).all(axis=(1, 2))
    return len(trajectory.t) if np.all(finite) else int(np.argmin(finite))


def constraint_errors(mechanism: Mechanism, trajectory: Trajectory) -> dict[str, float]:
    """Constraint violations: the largest `gap` [m], `drive_gap` [rad] and `slip` [m/s or rad/s]."""
    turning = mechanism.is_angular
    gap, speed = joint_gap(mechanism, trajectory), slip(mechanism, trajectory)
    return {"gap": largest(gap[:, ~turning]), "drive_gap": largest(gap[:, turning]), "slip": largest(speed)}


def motion_errors(scene: Scene, mechanism: Mechanism, truth: Trajectory, trajectory: Trajectory) -> dict[str, float]:
    """Errors within the scene's horizon, and `angle_duration` over the whole duration. The errors of position [m],
    angle [rad], velocity [m/s] and rate [rad/s] are maxima over samples and bodies. Names with `_rms` are root mean
    squares. The energy error is relative to the largest exact kinetic energy. So the energy error is also defined for a
    driven motion and does not depend on the reference height."""
    within = trajectory.t <= scene.horizon * (1 + 1e-12)
    pose, twist = trajectory.pose - truth.pose, trajectory.twist - truth.twist
    distance, speed = np.hypot(pose[..., 0], pose[..., 1]), np.hypot(twist[..., 0], twist[..., 1])
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1))
    span = largest(kinetic)
    drift = largest((energy(mechanism, trajectory) - energy(mechanism, truth))[within])
    return {
        "position": largest(distance[within]),
        "position_rms": root_mean_square(distance[within]),
        "angle": largest(pose[within][..., 2]),
        "angle_rms": root_mean_square(pose[within][..., 2]),
        "angle_duration": largest(pose[..., 2]),
        "velocity": largest(speed[within]),
        "rate": largest(twist[within][..., 2]),
        "energy": drift / span if span > 0 else NAN,
        "reaction": reaction_error(mechanism, truth.reaction[within], trajectory.reaction[within]),
    }


def reaction_error(mechanism: Mechanism, truth: Array, reaction: Array) -> float:
    """Largest error of the reactions (times, rows), relative to the largest exact force or moment."""
    turning = mechanism.is_angular
    worst = [NAN]
    for rows in (turning, ~turning):
        scale = largest(truth[:, rows])
        if scale > 0:
            worst.append(largest(reaction[:, rows] - truth[:, rows]) / scale)
    return largest(np.array(worst))


def branch_flips(scene: Scene, truth: Trajectory, trajectory: Trajectory) -> int:
    """The number of changes between agreement and disagreement with the assembly mode of the exact motion."""
    agreement = scene.branch_of(trajectory.pose) * scene.branch_of(truth.pose)
    agreement = np.concatenate([[1], agreement[agreement != 0]])
    return int(np.sum(agreement[1:] != agreement[:-1]))
