"""Linear algebra of constraint rows that does not depend on units or on how different the masses are: rank, reactions.

A row's size depends on the unit of length, and J M^-1 J^T has the square of the condition of M^(-1/2) J^T. So ranks are
counted on rows without units, and reactions are found by least squares, never through the product.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# A row is counted as dependent below this fraction of the largest singular value: far above rounding, far below what a
# mechanism is built with.
RANK_TOLERANCE = 1e-9


def rank(rows: Array, length: float) -> int:
    """How many rows (rows, 3 bodies) are independent, whatever the unit: angles are counted as arcs of `length` [m]."""
    return int(ranks(rows, np.asarray(length)))


def ranks(rows: Array, length: Array) -> NDArray[np.int_]:
    """`rank` of many (...) at once, of rows (..., rows, 3 bodies) and lengths (...) [m]."""
    if rows.size == 0:
        return np.zeros(rows.shape[:-2], dtype=int)
    singular = np.linalg.svd(_unitless(rows, length), compute_uv=False)
    return np.sum(singular > RANK_TOLERANCE * np.maximum(singular[..., :1], np.finfo(float).tiny), axis=-1)


def undetermined(rows: Array, length: float) -> NDArray[np.bool_]:
    """Which rows (..., rows) of (..., rows, 3 bodies) take part in forces that balance by themselves.

    No motion tells how large these are, so the reactions of such rows are not determined by rigid bodies alone.
    """
    _, singular, right = np.linalg.svd(np.swapaxes(_unitless(rows, length), -1, -2))
    count = rows.shape[-2]
    padded = np.zeros((*singular.shape[:-1], count))
    padded[..., : singular.shape[-1]] = singular
    idle = padded <= RANK_TOLERANCE * padded[..., :1]
    return np.sqrt(np.sum(np.where(idle[..., None], right**2, 0.0), axis=-2)) > RANK_TOLERANCE


def _unitless(rows: Array, length: float | Array) -> Array:
    arc = np.asarray(length)[..., None, None]
    scaled = rows / np.where(np.arange(rows.shape[-1]) % 3 == 2, arc, 1.0)
    norm = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(norm > 0, norm, 1.0)


def solve_symmetric(matrix: Array, right: Array) -> Array:
    """x (rows,) with matrix x = right for a symmetric, positive semidefinite matrix of rows; the shortest if singular.

    Scaled to a unit diagonal first, so that the threshold of dependence has no unit.
    """
    diagonal = np.diag(matrix)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = matrix * scale[:, None] * scale
    return scale * (np.linalg.pinv(scaled, rcond=RANK_TOLERANCE, hermitian=True) @ (scale * right))


def reactions(rows: Array, inertias: Array, excess: Array, size: Array) -> Array:
    """Forces (..., rows) with M excess = rows^T forces, in the least squares of M^(-1/2).

    rows (..., rows, 3 bodies) at a pose; inertias (3 bodies,), the diagonal of M; excess (..., 3 bodies), acceleration
    less that of free fall. Where rows are dependent the forces are not unique, and the smallest are given, counted in
    `size` (rows,) [N or N m], the force of each row that is as large as one of any other. NaN where a number is not
    finite. The columns of M^(-1/2) rows^T are made equally long first: a light body's rows then weigh as much as a
    heavy one's, and what is lost is the square root of what the product J M^-1 J^T loses.
    """
    root = np.sqrt(inertias)
    matrix = np.swapaxes(rows / root, -1, -2)
    norm = np.linalg.norm(matrix, axis=-2)
    finite = np.isfinite(norm).all(axis=-1) & np.isfinite(excess).all(axis=-1)
    scale = np.where((norm > 0) & np.isfinite(norm), 1 / np.where(norm > 0, norm, 1.0), 1.0)
    matrix = np.where(finite[..., None, None], matrix * scale[..., None, :], 0.0)
    left, singular, right = np.linalg.svd(matrix, full_matrices=False)
    small = singular <= RANK_TOLERANCE * singular[..., :1]
    inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, singular))
    target = np.where(finite[..., None], excess, 0.0) * root
    solution = scale * _times(np.swapaxes(right, -1, -2), inverse * _times(np.swapaxes(left, -1, -2), target))
    missing = rows.shape[-2] - singular.shape[-1]  # more rows than coordinates: always dependent
    if missing > 0 or np.any(small & finite[..., None]):
        solution = _smallest(solution, scale, matrix, size)
    return np.where(finite[..., None], solution, np.nan)


def _smallest(solution: Array, scale: Array, matrix: Array, size: Array) -> Array:
    """The solution less its part that does no work on any motion, so that (solution / size) is shortest."""
    _, singular, right = np.linalg.svd(matrix, full_matrices=True)
    count = matrix.shape[-1]
    padded = np.zeros((*singular.shape[:-1], count))
    padded[..., : singular.shape[-1]] = singular
    idle = padded <= RANK_TOLERANCE * singular[..., :1]
    # Columns that span the idle forces, in units of `size`; the others are set to zero.
    basis = (scale / size)[..., :, None] * np.swapaxes(right, -1, -2) * idle[..., None, :]
    measured = solution / size
    weights = _times(np.linalg.pinv(basis, rcond=RANK_TOLERANCE), measured)
    return size * (measured - _times(basis, weights))


def _times(matrix: Any, vector: Any) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0], dtype=np.float64)
