"""Convergence of pymunk's Gauss-Seidel iterations for a mechanism, and the stability of one of its steps.

One iteration solves A x = b, A = J M^-1 J^T, joint by joint. It multiplies the residual of the slowest mode by rho, the
spectral radius of S = 1 - L^-1 A, where L is the lower block triangle of A. rho is near 1 for long chains (N equal
links: 1 - rho = pi^2/(4 N^2)) and for heavy bodies on light ones (mass ratio 100: 1 - rho = 1/100).

A step starts from the impulses of the step before, including those that corrected a gap. With R = S^k after k
iterations, and B the diagonal matrix with 1 for each row that corrects the fraction gamma of its gap, a step of length
1 maps the rows' velocities u, impulses l and gaps g to

    g' = g + u,   l' = R l - (1 - R) A^-1 (u + gamma B g'),   u' = u + A l'

`step_spectral_radius` is the spectral radius of this map. If B = 1, the modes decouple: a mode with the residual
r = rho^k is stable up to gamma = (1 - r)/r, so the whole gap may be corrected if r < 1/2. Three or more joints have
complex modes, with r = mu^3 / (3 mu^2 - 3 mu + 1) for an eigenvalue mu of the map. The limit of stability is
mu = exp(i phi), phi from pi/3 to pi: there |r| falls from 1/2 (argument 0) to 1/7 (argument pi). A complex mode is
replaced by the real one that needs as many iterations. If B is not 1 (a motor has no angle, a blade no gap), k is
raised until the map with 2 R in place of R is stable, which is half of the stable residual.
"""

from __future__ import annotations

from math import ceil, log
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.remembered import by_identity
from reference.checks import Count, Numbers, Positive, validated
from reference.joints import Drive, Joint, Roll, Skate, Weld
from reference.mechanism import Mechanism
from reference.rows import RANK_TOLERANCE, ranks
from reference.validators import Rule

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]  # eigenvalues of S

# Residual of the slowest mode after the iterations of a step: half of the stable one, since rho changes with the pose.
RESIDUAL = 0.25
MIN_ITERATIONS = 5
# Up to this number of rows, and for dependent rows, all eigenvalues are computed; else only the smallest.
DENSE = 100
# Largest product of iterations and joints in one of the few start-up steps.
STARTUP_WORK = 1_000_000
# The largest rho that is returned.
LARGEST_FACTOR = 1 - 1e-12
# A spectral radius above 1 by more than this is no rounding of a mode.
UNSTABLE = 1e-6
# Complex residuals at the limit of stability; the exponent by which the iterations must reduce a mode to reach half of
# the stable residual; the mode's argument per unit of this exponent.
_LIMIT = 1 / np.polyval([1, -3, 3, 0], np.exp(-1j * np.linspace(np.pi / 3, np.pi, 64)))
_EXPONENT = -np.log(np.abs(_LIMIT) * RESIDUAL / 0.5)
_ARGUMENT = np.abs(np.angle(_LIMIT)) / _EXPONENT

Factor = Annotated[float, Rule(lambda value: 0 <= value < 1, "from 0 to below 1")]


class _System(NamedTuple):
    """The matrix A of the rows that impulses enforce, without prescribed motions, at one or more poses."""

    matrix: Array  # (..., rows, rows)
    starts: list[int]  # first row of the block of each pymunk constraint
    jacobian: Array  # (..., rows, 3 bodies), zero in prescribed coordinates
    indices: list[int]  # of these rows among the mechanism's


@by_identity()
@validated
def convergence_factor(mechanism: Mechanism) -> float:
    """rho of the mechanism at its start; 0 if no joint acts on another. Dependent rows are left out."""
    return convergence_factor_at(mechanism, mechanism.pose)


@validated
def convergence_factor_at(mechanism: Mechanism, pose: Numbers) -> float:
    """rho at a pose (bodies, 3) [m, m, rad]."""
    try:
        rho = _spectral_radius(_system(mechanism, pose), mechanism.length_scale)
    except np.linalg.LinAlgError:  # mass ratios beyond floating point
        rho = 0.0
    return min(max(rho, 0.0), LARGEST_FACTOR)


@validated
def convergence_factors(mechanism: Mechanism, poses: Numbers) -> Array:
    """rho (poses,) at poses (poses, bodies, 3), vectorised, for at most DENSE rows.

    Raises LinAlgError if a block is singular.
    """
    system = _system(mechanism, poses)
    if not system.starts:
        return np.zeros(len(poses))
    change = np.linalg.solve(_lower(system), system.matrix)
    factors = equivalent_real(_mode_factors(change, system.jacobian, mechanism.length_scale))
    return np.clip(factors.max(axis=-1), 0.0, LARGEST_FACTOR)


def equivalent_real(modes: Modes) -> Array:
    """The real factors that need as many iterations as these, which may be complex; see the module."""
    with np.errstate(divide="ignore", invalid="ignore"):
        decay = -np.log(np.abs(modes))
        needed = np.interp(np.abs(np.angle(modes)) / decay, _ARGUMENT, _EXPONENT)
    return np.where((decay > 0) & np.isfinite(decay), np.abs(modes) ** (-log(RESIDUAL) / needed), np.abs(modes))


@validated
def corrects_gap(mechanism: Mechanism, rolls_are_contacts: bool = False) -> Array:
    """1 for the rows (rows,) that correct their gap, else 0. A contact corrects none of its gap here."""
    uncorrected = (Drive, Skate, Roll) if rolls_are_contacts else (Drive, Skate)
    joints = [joint for joint in mechanism.joints for _ in range(joint.size)]
    return np.array([float(not isinstance(joint, uncorrected)) for joint in joints])


@validated
def step_spectral_radius(
    mechanism: Mechanism, pose: Numbers, iterations: Count, corrected: Numbers, safety: Positive = 1.0
) -> float:
    """The spectral radius of a step's map, see the module; at least 1, since an uncorrected gap stays.

    `corrected` (rows,): the fraction of its gap that each row corrects in a step. `safety`: factor on the residual R.
    Infinite for mass ratios beyond floating point.
    """
    system = _system(mechanism, pose)
    matrix = system.matrix
    count = int(ranks(system.jacobian, np.asarray(mechanism.length_scale)))
    if not count:
        return 1.0
    size = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))  # makes rows of different units comparable
    system = system._replace(matrix=matrix / np.outer(size, size))
    eigenvalues, vectors = (part[..., -count:] for part in np.linalg.eigh(system.matrix))
    iteration = np.eye(len(matrix)) - np.linalg.pinv(_lower(system)) @ system.matrix
    correction = vectors.T @ (np.asarray(corrected)[system.indices, None] * vectors)
    identity, zero = np.eye(count), np.zeros((count, count))
    with np.errstate(all="ignore"):
        residual = safety * np.linalg.matrix_power(vectors.T @ iteration @ vectors, iterations)
        inverse = (identity - residual) / eigenvalues
        impulses = np.hstack([-inverse @ (identity + correction), residual, -inverse @ correction])
        velocities = np.hstack([identity, zero, zero]) + eigenvalues[:, None] * impulses
        step = np.vstack([velocities, impulses, np.hstack([identity, zero, identity])])
        try:
            return float(np.abs(np.linalg.eigvals(step)).max())
        except np.linalg.LinAlgError:
            return np.inf


@validated
def stable_factor(mechanism: Mechanism, poses: Numbers, rho: Factor, rolls_are_contacts: bool = False) -> float:
    """The rho whose number of iterations makes the step stable at all `poses`, where not all rows correct gaps.

    LARGEST_FACTOR if that number exceeds STARTUP_WORK.
    """
    corrected, needed = corrects_gap(mechanism, rolls_are_contacts), iterations_for(rho)
    if corrected.all() or needed > STARTUP_WORK:
        return rho
    iterations = needed
    while any(
        step_spectral_radius(mechanism, pose, iterations, corrected, 0.5 / RESIDUAL) > 1 + UNSTABLE for pose in poses
    ):
        iterations = ceil(1.05 * iterations)
        if iterations > STARTUP_WORK:
            return LARGEST_FACTOR
    return rho if iterations == needed else RESIDUAL ** (1 / (iterations - 0.5))  # `iterations_for` rounds this up


def iterations_for(rho: float, fewest: int = MIN_ITERATIONS) -> int:
    """Iterations that reduce the slowest mode to RESIDUAL, at least `fewest`."""
    return max(fewest, ceil(log(RESIDUAL) / log(rho))) if rho > 0 else fewest


def _spectral_radius(system: _System, length: float) -> float:
    if not system.starts:
        return 0.0
    lower = _lower(system)
    if len(system.matrix) > DENSE:
        try:
            return 1 - _smallest_eigenvalue(system.matrix, lower)
        except RuntimeError:  # exactly singular
            pass
    change = np.linalg.pinv(lower) @ system.matrix
    return float(equivalent_real(_mode_factors(change, system.jacobian, length)).max())


def _mode_factors(change: NDArray[np.floating[Any]], jacobian: Array, length: float) -> Modes:
    """The eigenvalues of S (..., rows) from L^-1 A (..., rows, rows), with 0 for the modes of dependent rows.

    Their eigenvalue of A is zero. Extreme mass ratios have nearly zero eigenvalues too, so the rank of the Jacobian
    decides how many are dependent.
    """
    eigenvalues = np.linalg.eigvals(change).astype(np.complex128)
    size = np.abs(eigenvalues)
    if np.all(size > RANK_TOLERANCE):
        return 1 - eigenvalues
    rank_of_each = np.argsort(np.argsort(-size, axis=-1), axis=-1)
    return np.where(rank_of_each < ranks(jacobian, np.asarray(length))[..., None], 1 - eigenvalues, 0.0)


def _lower(system: _System) -> Array:
    """The lower block triangles L (..., rows, rows)."""
    matrix, starts = system.matrix, system.starts
    lower = np.zeros_like(matrix)
    for start, end in zip(starts, [*starts[1:], matrix.shape[-1]], strict=True):
        lower[..., start:end, :end] = matrix[..., start:end, :end]
    return lower


def _system(mechanism: Mechanism, pose: Array) -> _System:
    """The system at poses (..., bodies, 3)."""
    weights = 1 / mechanism.inertias
    for name in find_turned(mechanism):
        weights[mechanism.body_index(name), 2] = 0
    for name in find_cranks(mechanism):
        weights[mechanism.body_index(name)] = 0
    rows = mechanism.rows(pose)
    matrix = (rows * weights.reshape(-1)) @ np.swapaxes(rows, -1, -2)
    indices, starts, row = [], [], 0
    for size in (size for joint in mechanism.joints for size in _block_sizes(joint)):
        block = list(range(row, row + size))
        row += size
        if np.any(matrix[..., block, block] > 0):
            starts.append(len(indices))
            indices += block
    jacobian = np.where(weights.reshape(-1) > 0, rows, 0.0)[..., indices, :]
    return _System(matrix[..., np.array(indices, dtype=int)[:, None], indices], starts, jacobian, indices)


def _block_sizes(joint: Joint) -> tuple[int, ...]:
    """Numbers of rows that pymunk solves at once: a weld is a pivot and a gear."""
    return (2, 1) if isinstance(joint, Weld) else (joint.size,)


def _smallest_eigenvalue(matrix: Array, lower: Array) -> float:
    """The smallest eigenvalue of A x = mu L x by inverse iteration with sparse factors."""
    factors, right = splu(csc_matrix(matrix)), csc_matrix(lower)
    vector, value = np.ones(len(matrix)), 0.0
    for _ in range(200):
        image = factors.solve(right @ vector)
        previous, value = value, float(1 / np.linalg.norm(image))
        vector = image / np.linalg.norm(image)
        if abs(value - previous) < 1e-6 * value:
            break
    return value
