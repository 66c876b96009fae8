"""Properties of a mechanism that do not depend on an engine, such as freedoms and singular positions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reference.joints import Drive, Pin, Slot, Weld
from reference.mechanism import Mechanism
from reference.reactions import undetermined
from reference.trajectory import Trajectory
from reports.check.judging import accelerations

Array = NDArray[np.float64]
NEARLY_SINGULAR = 1e-2  # A position is near-singular if the smallest singular value is below this share of the largest.
RANK_TOLERANCE = 1e-9  # A singular value below this share of the largest one counts as zero.
SVD_NUMBERS = 2e7  # Largest number of matrix elements in all samples together.
DIFFERENCE_STEP = 1e-6  # Step of finite differences, relative to the length and the time scale of the mechanism.
MOST_DIRECTIONS = 60  # Largest number of free directions for which the eigenvalues are computed.


@dataclass(frozen=True)
class Facts:
    bodies: int
    joints: int
    forces: int
    rows: int
    freedoms: tuple[int, int]  # Degrees of freedom of the configuration, and of the velocities.
    redundant: int
    undetermined: tuple[str, ...]  # Rows whose reactions are not unique.
    singular: tuple[tuple[float, float], ...]  # (time [s], ratio of the smallest to the largest singular value).
    dead_centres: tuple[tuple[float, str], ...]  # (time [s], body).
    fastest_rotation: float  # rad/s.
    stiffest_mode: float  # Largest absolute eigenvalue at the start [1/s].
    length: float  # m.
    time: float  # s.
    locked: bool = False  # Whether the joints leave no freedom and prescribe no motion.
    locking_welds: tuple[str, ...] = ()  # Welds of a locked mechanism that would have a freedom with hinges.


def compute_facts(mechanism: Mechanism, motion: Trajectory) -> Facts:
    freedoms = mechanism.degrees_of_freedom()
    independent = 3 * len(mechanism.bodies) - freedoms[1]
    rows = mechanism.rows(mechanism.pose) if mechanism.row_count else np.zeros((0, 3 * len(mechanism.bodies)))
    idle = undetermined(rows, mechanism.length_scale) if len(rows) else np.zeros(0, dtype=bool)
    names = tuple(name for name, which in zip(mechanism.row_names, idle, strict=True) if which)
    locked = freedoms[1] == 0 and not mechanism.rate.any()
    counts = len(mechanism.bodies), len(mechanism.joints), len(mechanism.forces), mechanism.row_count
    singular = _singular_instants(mechanism, motion, independent)
    dead_centres = _dead_centres(mechanism, motion, freedoms[1])
    rates = float(np.abs(motion.twist[..., 2]).max()), _stiffest_mode(mechanism)
    scales = mechanism.length_scale, mechanism.time_scale
    redundant, welds = mechanism.row_count - independent, _locking_welds(mechanism) if locked else ()
    return Facts(*counts, freedoms, redundant, names, singular, dead_centres, *rates, *scales, locked, welds)


def _locking_welds(mechanism: Mechanism) -> tuple[str, ...]:
    hinges = tuple(
        Pin(joint.name, joint.first, joint.second, joint.first_point, joint.second_point)
        if isinstance(joint, Weld)
        else joint
        for joint in mechanism.joints
    )
    free = replace(mechanism, joints=hinges).degrees_of_freedom()[1] > 0
    return tuple(joint.name for joint in mechanism.joints if isinstance(joint, Weld)) if free else ()


def _singular_instants(mechanism: Mechanism, motion: Trajectory, independent: int) -> tuple[tuple[float, float], ...]:
    """(time [s], ratio of singular values) at each local minimum of the ratio below NEARLY_SINGULAR."""
    if independent < 2:
        return ()
    stride = max(1, int(len(motion.t) * mechanism.row_count * 3 * len(mechanism.bodies) / SVD_NUMBERS))
    poses, times = motion.pose[::stride], motion.t[::stride]
    scaled = mechanism.joint_rows.dense(poses) / np.tile([1.0, 1.0, mechanism.length_scale], len(mechanism.bodies))
    norm = np.linalg.norm(scaled, axis=-1, keepdims=True)
    sizes = np.linalg.svd(scaled / np.where(norm > 0, norm, 1.0), compute_uv=False)
    least = sizes[:, independent - 1] / sizes[:, 0]
    around = np.pad(least, 1, constant_values=np.inf)
    lowest = (least < NEARLY_SINGULAR) & (least <= around[:-2]) & (least <= around[2:])
    return tuple(zip(times[lowest].tolist(), least[lowest].tolist(), strict=True))


def _dead_centres(mechanism: Mechanism, motion: Trajectory, freedoms: int) -> tuple[tuple[float, str], ...]:
    """(time [s], body) when a body on the ground reverses its direction while another body moves. The result is empty
    for mechanisms with more than one freedom or without loops."""
    loops = mechanism.row_count > 2 * len(mechanism.bodies)
    if freedoms > 1 or not loops:
        return ()
    grounded = {
        name
        for joint in mechanism.joints
        if isinstance(joint, Pin | Slot | Drive) and None in (joint.first, joint.second)
        for name in (joint.first, joint.second)
        if name is not None
    }
    rates = motion.twist[..., 2]
    busy = np.abs(rates).max(axis=1)
    out = []
    for name in sorted(grounded):
        rate = rates[:, mechanism.body_index(name)]
        turned = np.flatnonzero((rate[:-1] * rate[1:] < 0) & (busy[:-1] > 0.1 * busy.max()))
        for index in turned:
            share = rate[index] / (rate[index] - rate[index + 1])
            out.append((float(motion.t[index] + share * (motion.t[index + 1] - motion.t[index])), name))
    return tuple(sorted(out))


def _stiffest_mode(mechanism: Mechanism) -> float:
    """Largest absolute eigenvalue [1/s] of the equations of motion, linearised at the initial pose at rest. Returns 0
    for no freedom and for more than MOST_DIRECTIONS freedoms, and NaN if an acceleration is not finite."""
    count = mechanism.pose.size
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    rows = mechanism.rows(mechanism.pose) if mechanism.row_count else np.zeros((0, count))
    _, sizes, right = np.linalg.svd(rows * unit, full_matrices=True)
    rank = int(np.sum(sizes > RANK_TOLERANCE * sizes[0])) if len(sizes) else 0
    free = right[rank:].T  # Dimensionless directions that the joints allow.
    if free.shape[1] == 0 or free.shape[1] > MOST_DIRECTIONS:
        return 0.0

    def scaled_acceleration(pose: Array, twist: Array) -> Array:
        return accelerations(mechanism, pose, twist, 0.0).reshape(-1) / unit

    pose, at_rest, slope = mechanism.pose, np.zeros_like(mechanism.pose), DIFFERENCE_STEP / mechanism.time_scale
    by_pose, by_twist = np.zeros((2, count, free.shape[1]))
    for column in range(free.shape[1]):
        direction = (unit * free[:, column]).reshape(-1, 3)
        ahead, behind = (pose + sign * DIFFERENCE_STEP * direction for sign in (1, -1))
        by_pose[:, column] = scaled_acceleration(ahead, at_rest) - scaled_acceleration(behind, at_rest)
        by_twist[:, column] = scaled_acceleration(pose, slope * direction) - scaled_acceleration(
            pose, -slope * direction
        )
    stiffness, damping = free.T @ by_pose / (2 * DIFFERENCE_STEP), free.T @ by_twist / (2 * slope)
    values = np.linalg.eigvals(np.block([[np.zeros_like(stiffness), np.eye(len(stiffness))], [stiffness, damping]]))
    return float(np.abs(values).max()) if np.isfinite(values).all() else float("nan")
