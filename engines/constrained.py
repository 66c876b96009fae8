"""Accelerations, or velocities after an impulse, that satisfy constraint rows, by Gauss's principle in numpy.

The result is nearest to the free motion in the norm of the masses. Rows may be compliant.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
REFINEMENTS = 3


@dataclass(frozen=True, eq=False)
class Constrained:
    """Accelerations or velocities (bodies, 3), and the forces or impulses of the rows (rows,)."""

    motion: Array
    force: Array


def constrained(rows: Array, right: Array, inertias: Array, free: Array, give: Array | None = None) -> Constrained:
    """The solution of J a = right - give give^T f and M (a - free) = J^T f for accelerations a and forces f.

    rows (rows, 3 bodies): the Jacobian J
    give (rows, any number): a factor of the compliance
    The SVD of J M^(-1/2) is used, not its square. Its rounding error is relative to the largest component of M^(1/2) a,
    which is too large for a light body. Iterative refinement of both equations reduces it (Skeel 1980).
    """
    if not len(rows):
        return Constrained(free, np.zeros(0))
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:  # additional coordinates of unit mass on which the forces act
        matrix = np.hstack([matrix, give])
    left, sizes, right_vectors = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    start, motion, force = free.reshape(-1), np.zeros(len(root)), np.zeros(len(rows))
    for _ in range(1 + REFINEMENTS):
        motion_residual = start - motion + (rows.T @ force) / root**2
        row_residual = right - rows @ motion - (0.0 if give is None else give @ (give.T @ force))
        residual = left.T @ ((row_residual - rows @ motion_residual) / norm)
        motion = motion + motion_residual + (right_vectors.T @ (residual / sizes))[: len(root)] / root
        force = force + left @ (residual / sizes**2) / norm
    return Constrained(motion.reshape(free.shape), force)
