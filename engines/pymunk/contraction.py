"""Convergence of Gauss-Seidel sweeps: how many a mechanism needs, and how much of a gap may be closed in a step.

A sweep over the joints solves A x = b, A = J M^-1 J^T, joint by joint. The residual of the slowest mode falls by
rho, the spectral radius of S = 1 - L^-1 A, with L the lower block triangle of A. rho is near 1 for long chains (N
equal links: 1 - rho = pi^2/(4 N^2)) and for heavy bodies on light ones (1 - rho = 1/100 for a hundredfold mass).

Impulses are kept for the next step, with those that closed a gap. With R = S^k after k sweeps and B a 1 for each row
that closes gamma of its gap, a step of length 1 makes of velocities u, impulses l and gaps g of rows

    g' = g + u,   l' = R l - (1 - R) A^-1 (u + gamma B g'),   u' = u + A l',

whose spectral radius is `growth`. Where B is 1 the modes decouple: one of which k sweeps leave r = rho^k is stable up
to gamma = (1 - r)/r, so the whole gap may be closed if r is below 1/2; beyond it a chain explodes. Sweeps over three
joints or more have complex modes, with r = mu^3 / (3 mu^2 - 3 mu + 1) for an eigenvalue mu of the map; mu = exp(i phi),
phi from pi/3 to pi, is the rim of stability: from 1/2 at the angle 0 of r down to 1/7 at pi. A complex mode counts as
the real one that needs as many sweeps. Where B is not 1 (a motor knows no angle, a blade has no gap), k rises until
the map is stable with 2 R in place of R, which is half of the stable residual.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import splu

from engines.pymunk.joints.drive import find_cranks, find_turned
from engines.remembered import by_identity
from reference.checks import LARGEST_COUNT, Count, Numbers, Positive, validated
from reference.joints import Drive, Joint, Roll, Skate, Weld
from reference.mechanism import Mechanism
from reference.rows import RANK_TOLERANCE, ranks
from reference.validators import Rule, from_to

Array = NDArray[np.float64]
Modes = NDArray[np.complex128]  # what a sweep leaves of each

# Residual of the slowest mode after a step's sweeps: half of what is stable, because rho changes with the pose.
LEFT = 0.25
# Share of the stable gain that is taken where the sweeps do not reach LEFT.
MARGIN = 0.8
# Beyond MOST sweeps a step of a hundred links costs more than a smaller step gains.
FEWEST, MOST = 5, 300
# Rows up to which all eigenvalues are computed, and beyond if rows are dependent.
DENSE = 100
# Sweeps times joints that one of the few start-up steps may take.
CONVERGED_WORK = 1_000_000
ROUNDING = 1e-16
# The largest rho.
LARGEST = 1 - 1e-12
# Growth per step, less 1, that is above the rounding of a mode.
GROWING = 1e-6
# Stages of the start-up; the sixth ends at the tenth step, which is often the first sample.
STAGES = 6
# The rim of stability of a complex mode, at angles from 0 to a half turn: the power of e by which sweeps must shrink a
# mode until half of the stable residual is left, and the angle over this power.
_RIM = 1 / np.polyval([1, -3, 3, 0], np.exp(-1j * np.linspace(np.pi / 3, np.pi, 64)))
_NEEDED = -np.log(np.abs(_RIM) * LEFT / 0.5)
_TURNED = np.abs(np.angle(_RIM)) / _NEEDED
# Sweeps at the start for a contact, whose points pass impulses to each other, which is no part of rho: five sweeps miss
# half of a disc's force.
CONTACT_CONVERGED = 1000

Whole = Annotated[int, from_to(0, LARGEST_COUNT)]
Contraction = Annotated[float, Rule(lambda value: 0 <= value < 1, "from 0 to below 1")]


@by_identity()
@validated
def contraction(mechanism: Mechanism) -> float:
    """rho of the mechanism at its start, 0 if no joint feels another; dependent rows are left out."""
    return contraction_at(mechanism, mechanism.pose)


@validated
def contraction_at(mechanism: Mechanism, pose: Numbers) -> float:
    """The same at a pose (bodies, 3) [m, m, rad]."""
    try:
        rho = _spectral_radius(*_joint_matrix(mechanism, pose)[:3], mechanism.length_scale)
    except np.linalg.LinAlgError:  # masses so far apart that no number is left
        rho = 0.0
    return min(max(rho, 0.0), LARGEST)


@validated
def contractions(mechanism: Mechanism, poses: Numbers) -> Array:
    """The same (poses,) at poses (poses, bodies, 3), of at most DENSE rows. Raises LinAlgError if a block is singular.

    All in one go: for few rows a fifth of the time.
    """
    matrix, starts, rows, _ = _joint_matrix(mechanism, poses)
    if not starts:
        return np.zeros(len(poses))
    modes = _left(np.linalg.solve(_lower(matrix, starts), matrix), rows, mechanism.length_scale)
    return np.clip(as_real(modes).max(axis=-1), 0.0, LARGEST)


def as_real(modes: Modes) -> Array:
    """The real factors of a sweep that need as many sweeps as these, which may be complex; see the module."""
    with np.errstate(divide="ignore", invalid="ignore"):
        falls = -np.log(np.abs(modes))
        needed = np.interp(np.abs(np.angle(modes)) / falls, _TURNED, _NEEDED)
    return np.where((falls > 0) & np.isfinite(falls), np.abs(modes) ** (-log(LEFT) / needed), np.abs(modes))


@validated
def closing(mechanism: Mechanism, touching: bool = False) -> Array:
    """1 for rows (rows,) that close a gap, else 0; `touching`: a Roll is a contact, of which nothing is closed."""
    still = (Drive, Skate, Roll) if touching else (Drive, Skate)
    return np.array([float(not isinstance(joint, still)) for joint in mechanism.joints for _ in range(joint.size)])


@validated
def growth(mechanism: Mechanism, pose: Numbers, iterations: Count, closes: Numbers, spare: Positive = 1.0) -> float:
    """The spectral radius of a step's map, see the module; at least 1, since a gap may stay.

    `closes` (rows,): the part of its gap that each row closes in a step. `spare`: factor on the residual of the sweeps.
    Infinite where masses are too far apart for numbers.
    """
    matrix, starts, rows, kept = _joint_matrix(mechanism, pose)
    count = int(ranks(rows, np.asarray(mechanism.length_scale)))
    if not count:
        return 1.0
    size = np.sqrt(np.where(np.diag(matrix) > 0, np.diag(matrix), 1.0))  # rows of any unit are alike
    matrix = matrix / np.outer(size, size)
    sizes, axes = (part[..., -count:] for part in np.linalg.eigh(matrix))
    sweep = np.eye(len(matrix)) - np.linalg.pinv(_lower(matrix, starts)) @ matrix
    closed = axes.T @ (np.asarray(closes)[kept, None] * axes)
    one, none = np.eye(count), np.zeros((count, count))
    with np.errstate(all="ignore"):
        left = spare * np.linalg.matrix_power(axes.T @ sweep @ axes, iterations)
        solved = (one - left) / sizes
        impulses = np.hstack([-solved @ (one + closed), left, -solved @ closed])
        velocities = np.hstack([one, none, none]) + sizes[:, None] * impulses
        step = np.vstack([velocities, impulses, np.hstack([one, none, one])])
        try:
            return float(np.abs(np.linalg.eigvals(step)).max())
        except np.linalg.LinAlgError:
            return np.inf


@validated
def steady(mechanism: Mechanism, poses: Numbers, rho: Contraction, touching: bool = False) -> float:
    """The rho whose number of sweeps makes the step's map stable at all `poses`, where not all rows close gaps.

    LARGEST where that number exceeds any work.
    """
    closes, enough = closing(mechanism, touching), _enough(rho)
    if closes.all() or enough > CONVERGED_WORK:
        return rho
    iterations = enough
    while any(growth(mechanism, pose, iterations, closes, 0.5 / LEFT) > 1 + GROWING for pose in poses):
        iterations = ceil(1.05 * iterations)
        if iterations > CONVERGED_WORK:
            return LARGEST
    return rho if iterations == enough else LEFT ** (1 / (iterations - 0.5))  # `sweeps` rounds this up again


def _spectral_radius(matrix: Array, starts: list[int], rows: Array, length: float) -> float:
    if not starts:
        return 0.0
    lower = _lower(matrix, starts)
    if len(matrix) > DENSE:
        try:
            return 1 - _smallest(matrix, lower)
        except RuntimeError:  # exactly singular
            pass
    return float(as_real(_left(np.linalg.pinv(lower) @ matrix, rows, length)).max())


def _left(change: NDArray[np.floating[Any]], rows: Array, length: float) -> Modes:
    """The factor of a sweep (..., rows) on each mode of L^-1 A (..., rows, rows), 0 for those of dependent rows.

    There A is zero, and a sweep changes nothing. Where masses are far apart, a sweep changes as little of a mode of the
    motion; so the rank of the rows decides.
    """
    changed = np.linalg.eigvals(change).astype(np.complex128)
    small = np.abs(changed)
    if np.all(small > RANK_TOLERANCE):
        return 1 - changed
    place = np.argsort(np.argsort(-small, axis=-1), axis=-1)
    return np.where(place < ranks(rows, np.asarray(length))[..., None], 1 - changed, 0.0)


def _lower(matrix: Array, starts: list[int]) -> Array:
    """The lower block triangles (..., rows, rows) of matrices of that shape."""
    lower = np.zeros_like(matrix)
    for start, end in zip(starts, [*starts[1:], matrix.shape[-1]], strict=True):
        lower[..., start:end, :end] = matrix[..., start:end, :end]
    return lower


def _joint_matrix(mechanism: Mechanism, pose: Array) -> tuple[Array, list[int], Array, list[int]]:
    """A at poses (..., bodies, 3), without the rows that are prescribed motions; where each constraint's block begins.

    (..., rows, rows), the beginnings, the rows (..., rows, 3 bodies) of what is not prescribed, and which they are.
    """
    weights = 1 / mechanism.inertias
    for name in find_turned(mechanism):
        weights[mechanism.body_index(name), 2] = 0
    for name in find_cranks(mechanism):
        weights[mechanism.body_index(name)] = 0
    rows = mechanism.rows(pose)
    matrix = (rows * weights.reshape(-1)) @ np.swapaxes(rows, -1, -2)
    kept, starts, row = [], [], 0
    for size in (part for joint in mechanism.joints for part in _parts(joint)):
        block = list(range(row, row + size))
        row += size
        if np.any(matrix[..., block, block] > 0):
            starts.append(len(kept))
            kept += block
    held = np.where(weights.reshape(-1) > 0, rows, 0.0)[..., kept, :]
    return matrix[..., np.array(kept, dtype=int)[:, None], kept], starts, held, kept


def _parts(joint: Joint) -> tuple[int, ...]:
    """How many rows pymunk solves at once: a weld is a pivot, and then a gear."""
    return (2, 1) if isinstance(joint, Weld) else (joint.size,)


def _smallest(matrix: Array, lower: Array) -> float:
    """The smallest eigenvalue of A x = mu L x by inverse iteration; sparse, as chains are."""
    factor, right = splu(csc_matrix(matrix)), csc_matrix(lower)
    vector, value = np.ones(len(matrix)), 0.0
    for _ in range(200):
        grown = factor.solve(right @ vector)
        before, value = value, float(1 / np.linalg.norm(grown))
        vector = grown / np.linalg.norm(grown)
        if abs(value - before) < 1e-6 * value:
            break
    return value


@dataclass(frozen=True)
class Sweeping:
    """`iterations` in a step, the `gain` that they allow, and the residual of the slowest mode that is `left`.

    `converged` iterations leave rounding, as far as CONVERGED_WORK allows; `unsettled` is their residual.
    """

    iterations: int
    gain: float = 1.0
    left: float = 0.0
    converged: int = 1000
    unsettled: float = 0.0

    def settling(self, steps: int) -> list[int]:
        """Iterations of the start-up steps: converged, then in STAGES of so many steps each ever fewer.

        The residual of the sweeps has an expansion in the step only after a number of steps, which is no fixed time. In
        small stages this hardly shows, and each stage ends at the same time in all runs of an extrapolation.
        """
        first = [self.converged, *[ceil(self.converged / 2)] * (steps - 1)][:steps]
        if not 0 < self.left <= LEFT:
            return first
        more = [ceil(self.iterations * (1 + log(STAGES / stage) / -log(self.left))) for stage in range(1, STAGES)]
        return first + [min(count, self.converged) for count in more for _ in range(steps)]


@validated
def sweeping(rho: Contraction, joints: Count = 1, fewest: Count = FEWEST, work: Whole = 0) -> Sweeping:
    """The rule for a mechanism of so many joints; see `sweeps`. All of a gap is closed, or what the sweeps allow."""
    iterations = sweeps(rho, joints, fewest, work)
    needed = ceil(log(ROUNDING) / log(rho)) if rho > 0 else 1
    return swept_by(rho, iterations, max(iterations, min(needed, CONVERGED_WORK // joints)))


@validated
def swept_by(rho: Contraction, iterations: Count, converged: Count = 1000) -> Sweeping:
    """So many iterations, whatever they leave."""
    return Sweeping(iterations, gain(rho, iterations), rho**iterations, converged, rho**converged)


@validated
def sweeps(rho: Contraction, joints: Count = 1, fewest: Count = FEWEST, work: Whole = 0) -> int:
    """Iterations in a step after which LEFT of the slowest mode is left, and at least `fewest`.

    More than MOST only as far as a step may take so much `work`, sweeps times joints; where that is not enough, MOST.
    """
    enough = _enough(rho, fewest)
    return enough if enough * joints <= work else min(enough, max(MOST, fewest))


def _enough(rho: float, fewest: int = FEWEST) -> int:
    return max(fewest, ceil(log(LEFT) / log(rho))) if rho > 0 else fewest


@validated
def gain(rho: Contraction, iterations: Count) -> float:
    """The fraction of a gap that may be closed in a step."""
    left = rho**iterations
    return 1.0 if left <= LEFT else min(1.0, MARGIN * (1 - left) / left)
