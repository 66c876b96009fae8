"""What accelerations, or velocities after an impulse, a mechanism's own rows allow: the judge at one instant.

Gauss's principle: of all that satisfy the rows it is the nearest to the free motion, in the metric of the masses. Rows
may give way to their forces, as an engine says that its own do.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism

Array = NDArray[np.float64]
ROUNDINGS = 10.0  # of a place or a velocity


class NotAsked(Exception):
    """A law that can't be asked of an engine here; the message is one sentence that says why."""


class Fault(Exception):
    """Something is not there that has to be; the message is one sentence that says what."""


@dataclass(frozen=True, eq=False)
class Constrained:
    """Accelerations or velocities (bodies, 3), and the forces or impulses of the rows (rows,)."""

    motion: Array
    force: Array


def constrained(rows: Array, right: Array, inertias: Array, free: Array, give: Array | None = None) -> Constrained:
    """J a = right - give give^T f with M (a - free) = J^T f, for rows (rows, 3 bodies) and `give` (rows, any number).

    By the SVD of J M^(-1/2), never through its square.
    """
    if not len(rows):
        return Constrained(free, np.zeros(0))
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:  # further coordinates of unit mass, which the forces move
        matrix = np.hstack([matrix, give])
    left, sizes, turned = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    lacking = left.T @ ((right - rows @ free.reshape(-1)) / norm)
    change = (turned.T @ (lacking / sizes))[: len(root)]
    return Constrained(free + (change / root).reshape(-1, 3), left @ (lacking / sizes**2) / norm)


def carried(mechanism: Mechanism, pose: Array, speed: float | Array, give: Array | None = None) -> Constrained:
    """What rounding of a `speed` [m/s] in every number leaves in velocities (bodies, 3), and in impulses (rows,).

    Of rounding that is not alike in all rows (rows,). Where these give way, A has give give^T beside it, as in
    `constrained`; of accelerations and forces the same is true.

    Each row's rate is then wrong by about e = speed times the row's size, and joints change velocities by
    M^-1 J^T A^-1 e with impulses A^-1 e, A = J M^-1 J^T: the more the more nearly rows depend on each other, and the
    heavier what they hold. Rounding has no sign, so that squares are added. Velocities, themselves rounded, are wrong
    by the speed at least.
    """
    size = np.tile([1.0, 1.0, mechanism.length_scale], len(mechanism.bodies))
    least = (np.max(speed, initial=0.0) / size).reshape(-1, 3)
    rows, root = mechanism.rows(pose), np.sqrt(mechanism.inertias.reshape(-1))
    if not len(rows):
        return Constrained(least, np.zeros(0))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:
        matrix = np.hstack([matrix, give])
    left, sizes, turned = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    wrong = np.linalg.norm(rows / size, axis=1) * speed / norm
    change = np.linalg.norm(((turned.T / sizes) @ left.T)[: len(root)] * wrong, axis=1) / root
    impulse = np.linalg.norm(((left / sizes**2) @ left.T) * wrong, axis=1) / norm
    return Constrained(np.maximum(least, change.reshape(-1, 3)), impulse)


def place(mechanism: Mechanism, pose: Array) -> float:
    """How large the numbers [m] are in which places are written."""
    return max(mechanism.length_scale, float(np.abs(pose[..., :2]).max()))


def difference(mechanism: Mechanism, found: Array, expected: Array, others: tuple[Array, ...] = ()) -> float:
    """The largest difference of two motions (bodies, 3), beside the largest of them and of `others`; NaN is infinite.

    Rotations count as the arcs that they make at the mechanism's own length.
    """
    size = np.array([1.0, 1.0, mechanism.length_scale])
    largest = max(float(np.abs(each * size).max()) for each in (expected, *others))
    error = float(np.abs((found - expected) * size).max())
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def force_difference(mechanism: Mechanism, found: Array, expected: Array, others: tuple[float, ...] = ()) -> float:
    """The same of forces (rows,): torques count as the forces that they need at the mechanism's own length.

    Rows whose force is NaN, since the engine can't tell it, are left out. `others` [N] are sizes to compare with.
    """
    size = np.where(mechanism.turning, 1 / mechanism.length_scale, 1.0)
    told = ~np.isnan(found)
    if not told.any():
        return 0.0
    largest = max(float(np.abs(expected * size).max()), *others, 0.0)
    error = float(np.abs((found - expected) * size)[told].max())
    if not np.isfinite(error):
        return np.inf
    return error / largest if largest > 0 else (np.inf if error > 0 else 0.0)


def driving_force(mechanism: Mechanism, twist: Array) -> float:
    """A force [N] that acts in the mechanism: of gravity, of its motion, or of its force elements at the start."""
    rate = np.abs(twist[:, 2]).max()
    speed = np.hypot(twist[:, 0], twist[:, 1]).max()
    pull = np.hypot(*mechanism.gravity) + rate * rate * mechanism.length_scale + speed / mechanism.time_scale
    acting = mechanism.inertias * mechanism.unconstrained(mechanism.pose, mechanism.twist)
    acting = np.abs(acting / np.array([1.0, 1.0, mechanism.length_scale])).max()
    return float(max(mechanism.inertias[:, 0].max() * pull, acting))
