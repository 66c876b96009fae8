"""Facts of a mechanism that no engine changes: freedoms, redundant rows, singular positions, time scales."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from reference.joints import Drive, Pin, Slot, Weld
from reference.mechanism import Mechanism
from reference.rows import undetermined
from reference.trajectory import Trajectory
from reports.check.judging import accelerations

Array = NDArray[np.float64]
# The least singular value beside the largest below which rows nearly depend on one another.
NEARLY_SINGULAR = 1e-2
RANK_TOLERANCE = 1e-9
SVD_NUMBERS = 2e7  # numbers in the rows of all samples whose singular values are computed
DIFFERENCE_STEP = 1e-6  # step of finite differences, in units of length and time


@dataclass(frozen=True)
class Facts:
    """Counts and instants [s]; rates in rad/s and 1/s."""

    bodies: int
    joints: int
    forces: int
    rows: int
    freedoms: tuple[int, int]  # of configuration, of velocity
    redundant: int
    undetermined: tuple[str, ...]  # rows whose reactions are not unique
    singular: tuple[tuple[float, float], ...]  # (time, least singular value beside the largest)
    dead_centres: tuple[tuple[float, str], ...]
    fastest_rotation: float
    stiffest_mode: float  # rad/s or 1/s, at the start
    length: float
    time: float
    locked: bool = False  # the joints leave no freedom, and none prescribes a motion
    locking_welds: tuple[str, ...] = ()  # of a locked mechanism: welds that as hinges would leave a freedom


def compute_facts(mechanism: Mechanism, motion: Trajectory) -> Facts:
    """From the mechanism and the judge's motion of it."""
    freedoms = mechanism.degrees_of_freedom()
    independent = 3 * len(mechanism.bodies) - freedoms[1]
    rows = mechanism.rows(mechanism.pose) if mechanism.row_count else np.zeros((0, 3 * len(mechanism.bodies)))
    idle = undetermined(rows, mechanism.length_scale) if len(rows) else np.zeros(0, dtype=bool)
    names = tuple(name for name, which in zip(mechanism.row_names, idle, strict=True) if which)
    locked = freedoms[1] == 0 and not mechanism.rate.any()
    return Facts(
        len(mechanism.bodies),
        len(mechanism.joints),
        len(mechanism.forces),
        mechanism.row_count,
        freedoms,
        mechanism.row_count - independent,
        names,
        _singular_instants(mechanism, motion, independent),
        _dead_centres(mechanism, motion, freedoms[1]),
        float(np.abs(motion.twist[..., 2]).max()),
        _stiffest_mode(mechanism),
        mechanism.length_scale,
        mechanism.time_scale,
        locked,
        _locking_welds(mechanism) if locked else (),
    )


def _locking_welds(mechanism: Mechanism) -> tuple[str, ...]:
    """The welds of a locked mechanism, if hinges in their places would leave a freedom."""
    hinges = tuple(
        Pin(joint.name, joint.first, joint.second, joint.first_point, joint.second_point)
        if isinstance(joint, Weld)
        else joint
        for joint in mechanism.joints
    )
    free = replace(mechanism, joints=hinges).degrees_of_freedom()[1] > 0
    return tuple(joint.name for joint in mechanism.joints if isinstance(joint, Weld)) if free else ()


def _singular_instants(mechanism: Mechanism, motion: Trajectory, independent: int) -> tuple[tuple[float, float], ...]:
    """The instants at which the independent rows come near to depending on one another."""
    if independent < 2:
        return ()
    stride = max(1, int(len(motion.t) * mechanism.row_count * 3 * len(mechanism.bodies) / SVD_NUMBERS))
    poses, times = motion.pose[::stride], motion.t[::stride]
    scaled = mechanism.joint_rows.dense(poses) / np.tile([1.0, 1.0, mechanism.length_scale], len(mechanism.bodies))
    norm = np.linalg.norm(scaled, axis=-1, keepdims=True)
    sizes = np.linalg.svd(scaled / np.where(norm > 0, norm, 1.0), compute_uv=False)
    least = sizes[:, independent - 1] / sizes[:, 0]
    instants = []
    for index in range(len(times)):
        around = least[max(0, index - 1) : index + 2]
        if least[index] < NEARLY_SINGULAR and least[index] == around.min():
            instants.append((float(times[index]), float(least[index])))
    return tuple(instants)


def _dead_centres(mechanism: Mechanism, motion: Trajectory, freedoms: int) -> tuple[tuple[float, str], ...]:
    """Instants at which a body on the ground reverses while the mechanism moves on; for one freedom only."""
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
    """The largest eigenvalue of small motions about the start, at rest [1/s]; 0 where nothing can move."""
    count = mechanism.pose.size
    unit = np.tile(mechanism.pose_unit, len(mechanism.bodies))
    rows = mechanism.rows(mechanism.pose) if mechanism.row_count else np.zeros((0, count))
    _, sizes, right = np.linalg.svd(rows * unit, full_matrices=True)
    rank = int(np.sum(sizes > RANK_TOLERANCE * sizes[0])) if len(sizes) else 0
    free = right[rank:].T  # directions without units that the joints allow
    if free.shape[1] == 0 or free.shape[1] > 60:
        return 0.0

    def of(pose: Array, twist: Array) -> Array:
        return accelerations(mechanism, pose, twist, 0.0).reshape(-1) / unit

    rest, slope = np.zeros_like(mechanism.pose), DIFFERENCE_STEP / mechanism.time_scale
    by_place, by_speed = np.zeros((2, count, free.shape[1]))
    for column in range(free.shape[1]):
        way = (unit * free[:, column]).reshape(-1, 3)
        by_place[:, column] = of(mechanism.pose + DIFFERENCE_STEP * way, rest) - of(
            mechanism.pose - DIFFERENCE_STEP * way, rest
        )
        by_speed[:, column] = of(mechanism.pose, slope * way) - of(mechanism.pose, -slope * way)
    stiffness, damping = free.T @ by_place / (2 * DIFFERENCE_STEP), free.T @ by_speed / (2 * slope)
    values = np.linalg.eigvals(np.block([[np.zeros_like(stiffness), np.eye(len(stiffness))], [stiffness, damping]]))
    return float(np.abs(values).max()) if np.isfinite(values).all() else float("nan")
