"""The rank of a mechanism's velocity rows J, and the reactions along the rows.

The magnitude of a row depends on the unit of length, so ranks are computed for rows without units. The product J M^-1
J^T squares the condition number of M^(-1/2) J^T, so the reactions of few rows are a least-squares solution without the
product. For many rows J M^-1 J^T is used, since its band is narrow, and one step of refinement follows.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.rows import JointRows
from reference.validators import Array

# Singular values below this fraction of the largest singular value count as zero. The value is far above rounding and
# far below the singular values of regular mechanisms.
RANK_TOLERANCE = 1e-9
# The sum of the squared singular values of rows of length 1 is the number of rows. A squared singular value above this
# share of the sum is far above the rounding of the product, 1e-15, and above RANK_TOLERANCE squared.
REGULAR = 1e-9


def rank(rows: Array, length: float) -> int:
    """The number of independent rows (rows, 3 bodies), with angles counted as arcs of `length` [m].

    If the squares of the singular values exceed REGULAR times the number of rows, a Cholesky factorisation exists. It
    takes a thirtieth of the time of a singular value decomposition for a long chain.
    """
    scaled = _unitless(rows, length)
    if np.isfinite(scaled).all():  # a factorisation of NaN would exist
        try:
            np.linalg.cholesky(scaled @ scaled.T - REGULAR * len(rows) * np.eye(len(rows)))
            return len(rows)
        except np.linalg.LinAlgError:
            pass
    return int(ranks(rows, np.asarray(length)))


def ranks(rows: Array, length: Array) -> NDArray[np.int_]:
    """The ranks (...) of rows (..., rows, 3 bodies), with angles counted as arcs of `length` (...) [m]."""
    if rows.size == 0:
        return np.zeros(rows.shape[:-2], dtype=int)
    singular = np.linalg.svd(_unitless(rows, length), compute_uv=False)
    return np.sum(singular > RANK_TOLERANCE * np.maximum(singular[..., :1], np.finfo(float).tiny), axis=-1)


def undetermined(rows: Array, length: float) -> NDArray[np.bool_]:
    """Mask (..., rows) of the rows (..., rows, 3 bodies) whose reactions rigid bodies do not determine.

    These rows have a non-zero component in the null space of rows^T, so the motion does not depend on their reactions.
    """
    idle, right = _idle(np.swapaxes(_unitless(rows, length), -1, -2))
    return np.sqrt(np.sum(np.where(idle[..., None], right**2, 0.0), axis=-2)) > RANK_TOLERANCE


def _unitless(rows: Array, length: float | Array) -> Array:
    arc = np.asarray(length)[..., None, None]
    scaled = rows / np.where(np.arange(rows.shape[-1]) % 3 == 2, arc, 1.0)
    norm = np.linalg.norm(scaled, axis=-1, keepdims=True)
    return scaled / np.where(norm > 0, norm, 1.0)


def solve_symmetric(matrix: Array, right: Array) -> Array:
    """The shortest x (rows,) with matrix x = right, for a symmetric, positive semidefinite matrix (rows, rows).

    The matrix is scaled to a unit diagonal first, so that the threshold of singularity has no unit.
    """
    diagonal = np.diag(matrix)
    scale = 1 / np.sqrt(np.where(diagonal > 0, diagonal, 1.0))
    scaled = matrix * scale[:, None] * scale
    return scale * (np.linalg.pinv(scaled, rcond=RANK_TOLERANCE, hermitian=True) @ (scale * right))


def reactions(rows: Array, inertias: Array, excess: Array, size: Array, length: float) -> Array:
    """Forces (..., rows) with M excess = rows^T forces: least squares with the weights M^(-1/2).

    rows (..., rows, 3 bodies) are J at a pose; inertias (3 bodies,) are the diagonal of M; excess (..., 3 bodies) is
    the acceleration minus free fall. If rows are dependent, the minimum-norm forces are returned, where `size` (rows,)
    [N or N m] is the unit of each row. The result is NaN if a number is not finite.

    The columns of M^(-1/2) rows^T are scaled to equal length, so that rows of light and heavy bodies have the same
    weight. Whether rows are dependent is decided by `rank` without the masses, since a large ratio of masses can make
    independent rows look dependent. Angles are counted as arcs of `length` [m].
    """
    root = np.sqrt(inertias)
    matrix = np.swapaxes(rows / root, -1, -2)
    norm = np.linalg.norm(matrix, axis=-2)
    finite = np.isfinite(norm).all(axis=-1) & np.isfinite(excess).all(axis=-1)
    scale = np.where((norm > 0) & np.isfinite(norm), 1 / np.where(norm > 0, norm, 1.0), 1.0)
    matrix = np.where(finite[..., None, None], matrix * scale[..., None, :], 0.0)
    left, singular, right = np.linalg.svd(matrix, full_matrices=False)
    small = singular <= RANK_TOLERANCE * singular[..., :1]
    if np.any(small) and singular.shape[-1] == rows.shape[-2]:
        independent = ranks(np.where(finite[..., None, None], rows, 0.0), np.asarray(length)) == rows.shape[-2]
        small &= ~independent[..., None] | (singular <= np.finfo(float).eps * singular[..., :1])
    inverse = np.where(small, 0.0, 1 / np.where(small, 1.0, singular))
    target = np.where(finite[..., None], excess, 0.0) * root
    solution = scale * _times(np.swapaxes(right, -1, -2), inverse * _times(np.swapaxes(left, -1, -2), target))
    missing = rows.shape[-2] - singular.shape[-1]  # dependent if positive
    if missing > 0 or np.any(small & finite[..., None]):
        solution = _smallest(solution, scale, matrix, size)
    return np.where(finite[..., None], solution, np.nan)


def _idle(matrix: Array) -> tuple[NDArray[np.bool_], Array]:
    """A mask of the right singular vectors in the matrix's null space, and all right singular vectors as rows."""
    _, singular, right = np.linalg.svd(matrix, full_matrices=True)
    missing = np.zeros((*singular.shape[:-1], matrix.shape[-1] - singular.shape[-1]))
    return np.concatenate([singular, missing], axis=-1) <= RANK_TOLERANCE * singular[..., :1], right


def _smallest(solution: Array, scale: Array, matrix: Array, size: Array) -> Array:
    idle, right = _idle(matrix)
    # Columns that span the null space of rows^T in units of `size`, and columns of zeros.
    basis = (scale / size)[..., :, None] * np.swapaxes(right, -1, -2) * idle[..., None, :]
    measured = solution / size
    weights = _times(np.linalg.pinv(basis, rcond=RANK_TOLERANCE), measured)
    return size * (measured - _times(basis, weights))


def _times(matrix: Any, vector: Any) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0], dtype=np.float64)


# Number of rows from which the band solver is used; for fewer rows the dense solver is as fast.
MANY_ROWS = 24
# Rows are dependent if a squared pivot is below this fraction of the largest squared pivot.
SMALLEST_PIVOT = 1e-9


def banded_reaction(joint_rows: JointRows, pose: Array, excess: Array, inertias: Array) -> Array:
    """Reactions (times, rows) [N, N m] at poses (times, bodies, 3), or NaN at times with dependent rows.

    `excess` (times, bodies, 3) is the acceleration minus free fall. `inertias` (bodies, 3) is the diagonal of the mass
    matrix M. The equation is J M^-1 J^T reactions = J excess. The sparse matrix is reordered to a narrow band (reverse
    Cuthill-McKee) and factorised by Cholesky. The cost for a chain is O(bodies), compared with O(bodies^3) for the
    dense system.
    """
    # Imported here, since these imports are slow and systems with few rows don't need them.
    from scipy.linalg.lapack import dpbsv, dpbtrs  # pyright: ignore[reportAttributeAccessIssue] (missing in the stubs)
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import reverse_cuthill_mckee

    everything, count = joint_rows.with_ground(pose), joint_rows.count
    blocks = [group.blocks(everything) for group in joint_rows.groups]
    places = [group.places() for group in joint_rows.groups]
    row, column = (np.concatenate([pair[k].ravel() for pair in places]) for k in (0, 1))
    values = np.concatenate([block.reshape(len(pose), -1) for block in blocks], axis=1)
    moving = column < 3 * joint_rows.bodies  # not the ground's
    row, column, values = row[moving], column[moving], values[:, moving]
    shape, mobility = (count, 3 * joint_rows.bodies), 1 / inertias.reshape(-1)
    pattern = csr_array((np.ones(len(row)), (row, column)), shape=shape)
    order = reverse_cuthill_mckee((pattern @ pattern.T).tocsr(), symmetric_mode=True).astype(np.intp)
    rank_of = np.argsort(order)
    out = np.full((len(pose), count), np.nan)
    for time, target in enumerate(excess.reshape(len(pose), -1)):
        rows = csr_array((values[time], (rank_of[row], column)), shape=shape)
        product = ((rows * mobility) @ rows.T).tocoo()
        lower = product.row >= product.col
        below, at = (product.row - product.col)[lower], product.col[lower]
        band = np.zeros((int(below.max()) + 1, count))
        band[below, at] = product.data[lower]  # for LAPACK
        factor, solution, failed = dpbsv(band, rows @ target, lower=1)
        if failed or not factor[0].min() ** 2 > SMALLEST_PIVOT * factor[0].max() ** 2:
            continue
        # One step of iterative refinement restores the digits that the product J M^-1 J^T loses (Bjorck 1987, corrected
        # seminormal equations).
        missing = rows @ (target - mobility * (rows.T @ solution))
        out[time, order] = solution + dpbtrs(factor, missing, lower=1)[0]
    return out
