"""Accelerations, or velocities after an impulse, that rows of a mechanism allow: Gauss's principle, in numpy.

Of all motions that satisfy the rows it is the nearest to the free motion, in the metric of the masses. Rows may be
soft: they give way to their forces.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
REFINEMENTS = 3


@dataclass(frozen=True, eq=False)
class Constrained:
    """Accelerations or velocities, shaped as the free ones, and the forces or impulses of the rows (rows,)."""

    motion: Array
    force: Array


def constrained(rows: Array, right: Array, inertias: Array, free: Array, give: Array | None = None) -> Constrained:
    """J a = right - give give^T f with M (a - free) = J^T f, for rows (rows, 3 bodies) and `give` (rows, any number).

    By the SVD of J M^(-1/2), never through its square. That is right to rounding of the largest part of M^(1/2) a, in
    which a light body's is small: so what both equations leave is solved for again (iterative refinement; Skeel 1980).
    """
    if not len(rows):
        return Constrained(free, np.zeros(0))
    root = np.sqrt(inertias.reshape(-1))
    matrix = rows / root
    norm = np.linalg.norm(matrix, axis=1)
    if give is not None:  # further coordinates of unit mass, which the forces move
        matrix = np.hstack([matrix, give])
    left, sizes, right_vectors = np.linalg.svd(matrix / norm[:, None], full_matrices=False)
    start, motion, force = free.reshape(-1), np.zeros(len(root)), np.zeros(len(rows))
    for _ in range(1 + REFINEMENTS):
        pushed = start - motion + (rows.T @ force) / root**2
        short = right - rows @ motion - (0.0 if give is None else give @ (give.T @ force))
        residual = left.T @ ((short - rows @ pushed) / norm)
        motion = motion + pushed + (right_vectors.T @ (residual / sizes))[: len(root)] / root
        force = force + left @ (residual / sizes**2) / norm
    return Constrained(motion.reshape(free.shape), force)
