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
ESTIMATED = 10.0  # times its own estimate an error may be


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


def carried(mechanism: Mechanism, pose: Array, wrong: Array) -> Constrained:
    """What numbers that are `wrong` (bodies, 3) by so much leave in motions (bodies, 3), and in impulses (rows,).

    Each row is then wrong by e, the sum of its sizes times these, and joints that set it right move bodies by
    M^-1 J^T A^-1 e with impulses A^-1 e, A = J M^-1 J^T: the more the more nearly rows depend on each other, and the
    farther masses are apart. Rounding has no sign, so squares are added. A motion is wrong by its numbers at least.
    """
    rows, root = mechanism.rows(pose), np.sqrt(mechanism.inertias.reshape(-1))
    if not len(rows):
        return Constrained(wrong, np.zeros(0))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    left, sizes, turned = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    missed = np.linalg.norm(rows * wrong.reshape(-1), axis=1) / norm
    change = np.linalg.norm(((turned.T / sizes) @ left.T) * missed, axis=1) / root
    impulse = np.linalg.norm(((left / sizes**2) @ left.T) * missed, axis=1) / norm
    return Constrained(np.maximum(wrong, change.reshape(-1, 3)), impulse)


def written(mechanism: Mechanism, away: float = 0.0) -> Array:
    """How large the numbers (bodies, 3) are in which it is written [m, m, and 1 for a cosine]; at least `away` [m]."""
    out = np.ones_like(mechanism.pose)
    far = np.abs(mechanism.pose[:, :2]).max(axis=1)
    out[:, :2] = np.maximum(far, max(mechanism.length_scale, away))[:, None]
    return out


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
