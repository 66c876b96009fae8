"""The convergence of pymunk's Gauss-Seidel iterations, and the stability of its steps.

The iterations solve A x = b with A = J M^-1 J^T, one joint after the other. An iteration multiplies the residual of the
slowest mode by rho, the spectral radius of S = 1 - L^-1 A, where L is the lower block triangle of A. For long chains
rho is near 1 (1 - rho = pi^2/(4 N^2) for N equal links). For heavy bodies that hang on light bodies rho is also near 1
(1 - rho = 1/100 for a mass ratio of 100).

A step starts from the impulses of the previous step, including impulses that corrected a gap. Let R = S^k for k
iterations. The diagonal matrix B has 1 for each row that corrects the fraction gamma of its gap, and otherwise 0. A
step of length 1 maps the velocities u, impulses l and gaps g of the rows to

    g' = g + u,   l' = R l - (1 - R) A^-1 (u + gamma B g'),   u' = u + A l'

`step_spectral_radius` is the spectral radius of this map. If B = 1, the modes decouple, and a mode with the residual r
= rho^k is stable up to gamma = (1 - r)/r. A step may then correct the whole gap if r < 1/2. Three or more joints can
have complex modes, with r = mu^3 / (3 mu^2 - 3 mu + 1) for an eigenvalue mu of the map. The stability limit is mu =
exp(i phi) with phi from pi/3 to pi. From pi/3 to pi, |r| decreases from 1/2 (argument 0) to 1/7 (argument pi). A
complex mode is replaced by a real mode that needs as many iterations. If B is not 1 (a motor keeps no angle, a blade
has no gap), k is increased until the map with 2 R in place of R is stable. The residual is then half of the stability
limit.
"""

from __future__ import annotations

from itertools import chain
from math import ceil, log
from typing import Annotated, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.remembered import by_identity
from reference.checks import Count, Numbers, Positive, validated
from reference.joints import Drive, Roll, Skate, Weld
from reference.mechanism import Mechanism
from reference.reactions import RANK_TOLERANCE, ranks
from reference.validators import Rule

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]  # eigenvalues of S

# Residual of the slowest mode after a step. The value is half of the stability limit, since rho changes with the pose.
RESIDUAL = 0.25
MIN_ITERATIONS = 5
# Largest number of rows for which all eigenvalues are computed. For more rows only the smallest eigenvalue is computed,
# unless A is singular.
DENSE = 100
# Largest product of iterations and joints in one of the few start-up steps.
STARTUP_WORK = 1_000_000
LARGEST_FACTOR = 1 - 1e-12
# A step is unstable if its spectral radius exceeds 1 + UNSTABLE, which is above the rounding of eigenvalues.
UNSTABLE = 1e-6
# Complex residuals at the stability limit.
_LIMIT = 1 / np.polyval([1, -3, 3, 0], np.exp(-1j * np.linspace(np.pi / 3, np.pi, 64)))
# The iterations must multiply a mode by exp(-_EXPONENT), so that its residual is half of the stability limit.
_EXPONENT = -np.log(np.abs(_LIMIT) * RESIDUAL / 0.5)
# Argument of a mode [rad] per unit of the exponent.
_ARGUMENT = np.abs(np.angle(_LIMIT)) / _EXPONENT

Factor = Annotated[float, Rule(lambda value: 0 <= value < 1, "from 0 to below 1")]


class _System(NamedTuple):
    matrix: Array  # A (..., rows, rows).
    starts: list[int]  # First row of the block of each pymunk constraint.
    jacobian: Array  # (..., rows, 3 bodies), zero in prescribed coordinates.
    indices: list[int]  # Indices of these rows in the mechanism.


@by_identity()
@validated
def convergence_factor(mechanism: Mechanism) -> float:
    """rho at t = 0 without modes of dependent rows; 0 if no joint acts on another joint."""
    return convergence_factor_at(mechanism, mechanism.pose)


@validated
def convergence_factor_at(mechanism: Mechanism, pose: Numbers) -> float:
    try:
        rho = _spectral_radius(_system(mechanism, pose), mechanism.length_scale)
    except np.linalg.LinAlgError:  # extreme mass ratios
        rho = 0.0
    return min(max(rho, 0.0), LARGEST_FACTOR)


@validated
def convergence_factors(mechanism: Mechanism, poses: Numbers) -> Array:
    """rho (poses,) at several poses (poses, bodies, 3), for at most DENSE rows.

    Raises LinAlgError if a block is singular.
    """
    system = _system(mechanism, poses)
    if not system.starts:
        return np.zeros(len(poses))
    change = np.linalg.solve(_lower(system), system.matrix)
    factors = equivalent_real(_mode_factors(change, system.jacobian, mechanism.length_scale))
    return np.clip(factors.max(axis=-1), 0.0, LARGEST_FACTOR)


def equivalent_real(modes: Modes) -> Array:
    """Real factors that need as many iterations as `modes`, which may be complex."""
    with np.errstate(divide="ignore", invalid="ignore"):
        decay = -np.log(np.abs(modes))
        needed = np.interp(np.abs(np.angle(modes)) / decay, _ARGUMENT, _EXPONENT)
    return np.where((decay > 0) & np.isfinite(decay), np.abs(modes) ** (-log(RESIDUAL) / needed), np.abs(modes))


@validated
def corrects_gap(mechanism: Mechanism, rolls_are_contacts: bool = False) -> Array:
    """A mask (rows,) with 1 for rows that correct gaps, and otherwise 0. Contacts count as rows that correct no gap."""
    uncorrected = (Drive, Skate, Roll) if rolls_are_contacts else (Drive, Skate)
    joints = [joint for joint in mechanism.joints for _ in range(joint.size)]
    return np.array([float(not isinstance(joint, uncorrected)) for joint in joints])


@validated
def step_spectral_radius(
    mechanism: Mechanism, pose: Numbers, iterations: Count, corrected: Numbers, safety: Positive = 1.0
) -> float:
    """The spectral radius of the map of a step, which is at least 1, since an uncorrected gap remains.

    `corrected` (rows,): fraction of the gap that a row corrects in a step. `safety`: factor on the residual R. The
    radius is infinite if the eigenvalues cannot be computed, for example for extreme mass ratios.
    """
    system = _system(mechanism, pose)
    matrix = system.matrix
    count = int(ranks(system.jacobian, np.asarray(mechanism.length_scale)))
    if not count:
        return 1.0
    size = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))  # rows have different units
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
    """`rho`, or a larger factor for which `iterations_for` gives enough iterations for stability at all `poses`.

    A larger factor is needed only if some rows correct no gap. The result is LARGEST_FACTOR if stability needs more
    than STARTUP_WORK iterations.
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
    """The eigenvalues (..., rows) of S from `change` = L^-1 A (..., rows, rows), with 0 for modes of dependent rows.

    Dependent rows cause zero eigenvalues of A. Extreme mass ratios also cause eigenvalues near zero, so the rank of the
    Jacobian determines the number of dependent rows.
    """
    eigenvalues = np.linalg.eigvals(change).astype(np.complex128)
    size = np.abs(eigenvalues)
    if np.all(size > RANK_TOLERANCE):
        return 1 - eigenvalues
    rank_of_each = np.argsort(np.argsort(-size, axis=-1), axis=-1)
    return np.where(rank_of_each < ranks(jacobian, np.asarray(length))[..., None], 1 - eigenvalues, 0.0)


def _lower(system: _System) -> Array:
    matrix, starts = system.matrix, system.starts
    lower = np.zeros_like(matrix)
    for start, end in zip(starts, [*starts[1:], matrix.shape[-1]], strict=True):
        lower[..., start:end, :end] = matrix[..., start:end, :end]
    return lower


def _system(mechanism: Mechanism, pose: Array) -> _System:
    weights = 1 / mechanism.inertias
    for name in find_turned(mechanism):
        weights[mechanism.body_index(name), 2] = 0
    for name in find_cranks(mechanism):
        weights[mechanism.body_index(name)] = 0
    rows = mechanism.rows(pose)
    matrix = (rows * weights.reshape(-1)) @ np.swapaxes(rows, -1, -2)
    indices, starts, row = [], [], 0
    # The blocks are the constraints of pymunk; a weld is a pivot and a gear.
    for size in chain(*((2, 1) if isinstance(joint, Weld) else (joint.size,) for joint in mechanism.joints)):
        block = list(range(row, row + size))
        row += size
        if np.any(matrix[..., block, block] > 0):
            starts.append(len(indices))
            indices += block
    jacobian = np.where(weights.reshape(-1) > 0, rows, 0.0)[..., indices, :]
    return _System(matrix[..., np.array(indices, dtype=int)[:, None], indices], starts, jacobian, indices)


def _smallest_eigenvalue(matrix: Array, lower: Array) -> float:
    from scipy.sparse import csc_matrix
    from scipy.sparse.linalg import splu

    factors, right = splu(csc_matrix(matrix)), csc_matrix(lower)
    vector, value = np.ones(len(matrix)), 0.0
    for _ in range(200):
        image = factors.solve(right @ vector)
        previous, value = value, float(1 / np.linalg.norm(image))
        vector = image / np.linalg.norm(image)
        if abs(value - previous) < 1e-6 * value:
            break
    return value
