"""Gauss's principle in numpy: accelerations, or velocities after an impulse, that satisfy constraint rows."""

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
    """Solve J a = right - give give^T f and M (a - free) = J^T f for accelerations a and forces f.

    rows (rows, 3 bodies): the Jacobian J.
    give (rows, any number): factor of the compliance matrix give give^T, or None for rigid rows.
    The solution uses the SVD of J M^(-1/2). The rounding error of the SVD is relative to the largest component of
    M^(1/2) a, so it is too large for a light body. Iterative refinement of both equations reduces the error (Skeel
    1980).
    """
    if not len(rows):
        return Constrained(free, np.zeros(0))
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:  # a compliant row acts on additional coordinates of unit mass
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
