"""Dynamics with exact multipliers in numpy, for use without numba and as a reference for the compiled code."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Regularisation
from engines.lagrange.methods import Tableau
from engines.lagrange.records import CLOSED, LEAST_INVERSE_INERTIA
from reference.mechanism import Mechanism
from reference.reactions import RANK_TOLERANCE, rank, solve_symmetric

Array = NDArray[np.float64]

PROJECTION_ITERATIONS = 8
# Largest number of steps of an adaptive run in numpy, and additional number per sample. The steps take a few seconds
# for a few bodies.
MOST_NUMPY_STEPS, NUMPY_STEPS_PER_SAMPLE = 2_000, 100


def solve_rows(matrix: Array, right: Array, dependent: bool = False, least_pivot: float = 0.0) -> Array:
    """Solve matrix x = right for a symmetric, positive semidefinite matrix (rows, rows).

    right: (rows,) or (rows, n).
    The solution uses the Cholesky factorisation. If rows are known to be `dependent`, or if a pivot is below
    `least_pivot` times the diagonal, it is the minimum-norm solution. The solution is NaN if the matrix is not finite.
    """
    if not dependent:
        # Imported here, as DOP853 below, since the import is slow and compiled runs don't need it.
        from scipy.linalg.lapack import dposv  # pyright: ignore[reportAttributeAccessIssue] (missing in the stubs)

        factor, solution, failed = dposv(matrix, right, lower=True)
        if not failed and np.all(np.diag(factor) ** 2 >= least_pivot * np.diag(matrix)):
            return solution
    if not np.all(np.isfinite(matrix)):
        return np.full_like(right, np.nan)
    return solve_symmetric(matrix, right)


def constrained_acceleration(
    mechanism: Mechanism,
    pose: Array,
    twist: Array,
    target: Array | None = None,
    compliance: Array | float = 0.0,
    rows: Array | None = None,
) -> tuple[Array, Array]:
    """Accelerations a (bodies, 3) and reactions r (rows,) with M a = f + J^T r and J a + compliance r = target.

    pose, twist (bodies, 3).
    target (rows,): by default the bias -(dJ/dt) v of ideal rows.
    compliance: 0, or a symmetric matrix (rows, rows) [1/kg, or 1/(kg m^2) in rows of torque].
    rows: J (rows, 3 bodies) at this pose, if it is known.
    """
    free = np.broadcast_to(mechanism.unconstrained(pose, twist), pose.shape)
    if not mechanism.row_count:
        return free, np.zeros(0)
    rows = mechanism.rows(pose) if rows is None else rows
    weighted = rows / mechanism.inertias.reshape(-1)
    target = mechanism.bias(pose, twist) if target is None else target
    reaction = solve_rows(weighted @ rows.T + compliance, target - rows @ free.reshape(-1), least_pivot=RANK_TOLERANCE)
    return free + (weighted.T @ reaction).reshape(-1, 3), reaction


def inverse_inertia(matrix: Array, soft: NDArray[np.bool_], least: float = LEAST_INVERSE_INERTIA) -> Array:
    """The inverse inertias (rows,) of soft rows under the constraints of the rigid rows, from J M^-1 J^T.

    These inverse inertias are the diagonal of the Schur complement, but at least `least` times the diagonal of J M^-1
    J^T. The values of rigid rows are the diagonal of J M^-1 J^T.
    """
    out = np.diag(matrix).copy()
    if not soft.all():
        coupled = matrix[np.ix_(~soft, soft)]
        reactions = solve_rows(matrix[np.ix_(~soft, ~soft)], coupled, least_pivot=RANK_TOLERANCE)
        out[soft] -= np.einsum("ij,ij->j", coupled, reactions)
    return np.maximum(out, least * np.diag(matrix))


def regularised_bias(
    regularisation: Regularisation, soft: NDArray[np.bool_], bias: Array, slip: Array, gap: Array
) -> Array:
    """The bias (..., rows) with spring and damper terms for the rows in the mask `soft` (rows,)."""
    ideal = bias if regularisation.complete else np.where(soft, 0.0, bias)
    return ideal - soft * (regularisation.damping * slip + regularisation.stiffness * gap)


class Dynamics:
    """Accelerations and projections of one mechanism.

    soft (rows,): mask of the regularised rows, by default all rows.
    least_inverse_inertia: see `inverse_inertia`, which gives the unit of a soft row's compliance.
    least_pivot: see `solve_rows`.
    """

    def __init__(
        self,
        mechanism: Mechanism,
        regularisation: Regularisation | None = None,
        soft: NDArray[np.bool_] | None = None,
        least_inverse_inertia: float = LEAST_INVERSE_INERTIA,
        least_pivot: float = 0.0,
    ) -> None:
        self.mechanism, self.regularisation = mechanism, regularisation
        self.least_inverse_inertia, self.least_pivot = least_inverse_inertia, least_pivot
        self.soft = np.ones(mechanism.row_count, dtype=bool) if soft is None else soft
        self.open_from = float("nan")  # the first time at which a projection did not converge [s]
        self.weight = 1 / mechanism.inertias.reshape(-1)
        self.holonomic = mechanism.holonomic
        self.unit = np.tile(mechanism.pose_unit, len(mechanism.bodies))
        rows = mechanism.rows(mechanism.pose)
        self.has_dependent_rows = rows.size > 0 and rank(rows, mechanism.length_scale) < rows.shape[0]

    def _solve(self, rows: Array, right: Array) -> Array:
        return solve_rows((rows * self.weight) @ rows.T, right, self.has_dependent_rows, self.least_pivot)

    def acceleration(self, pose: Array, twist: Array, t: float) -> Array:
        """Accelerations (bodies, 3) due to gravity, forces and reactions."""
        if not self.mechanism.row_count:
            return self.mechanism.unconstrained(pose, twist)
        if not (np.isfinite(pose).all() and np.isfinite(twist).all()):  # rolling curves do not accept NaN
            return np.full_like(pose, np.nan)
        return self.acceleration_under(*self.reaction(pose, twist, t), pose, twist)

    def acceleration_under(self, rows: Array, reaction: Array, pose: Array, twist: Array) -> Array:
        free = self.mechanism.unconstrained(pose, twist).reshape(-1)
        return (free + self.weight * (rows.T @ reaction)).reshape(-1, 3)

    def reaction(self, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
        """The rows J (rows, 3 bodies) and the reactions (rows,) [N, N m], which are the rows' multipliers."""
        mechanism, regularisation = self.mechanism, self.regularisation
        rows, bias = mechanism.rows(pose), mechanism.bias(pose, twist)
        if regularisation is not None:
            slip = rows @ twist.reshape(-1) - mechanism.rate
            gap = np.where(self.holonomic, mechanism.gap(pose, t), 0.0)
            bias = regularised_bias(regularisation, self.soft, bias, slip, gap)
        right = bias - rows @ mechanism.unconstrained(pose, twist).reshape(-1)
        if regularisation is None or not regularisation.compliance:
            return rows, self._solve(rows, right)
        matrix = (rows * self.weight) @ rows.T
        unit = inverse_inertia(matrix, self.soft, self.least_inverse_inertia)
        matrix += regularisation.compliance * np.diag(self.soft * unit)
        return rows, solve_rows(matrix, right, least_pivot=RANK_TOLERANCE)

    def project(self, pose: Array, twist: Array, t: float) -> tuple[Array, Array]:
        """The nearest pose and twist that satisfy the joints, in the norm of the mass matrix.

        Newton's method closes the gaps. If the method does not converge, `open_from` is set.
        """
        mechanism = self.mechanism
        if not mechanism.row_count or not np.all(np.isfinite(pose)):
            return pose, twist
        if np.any(self.holonomic):
            for _ in range(PROJECTION_ITERATIONS):
                gap = mechanism.gap(pose, t)[self.holonomic]
                rows = mechanism.rows(pose)[self.holonomic]
                correction = self.weight * (rows.T @ self._solve(rows, gap))
                pose = pose - correction.reshape(-1, 3)
                if not np.max(np.abs(correction) / self.unit) > CLOSED:
                    break
            else:
                self.open_from = t if np.isnan(self.open_from) else self.open_from
            if not np.all(np.isfinite(pose)):
                return pose, twist
        rows = mechanism.rows(pose)
        slip = rows @ twist.reshape(-1) - mechanism.rate
        return pose, twist - (self.weight * (rows.T @ self._solve(rows, slip))).reshape(-1, 3)


Step = Callable[[Array, Array, float, float], tuple[Array, Array]]


def semi_implicit_euler(dynamics: Dynamics) -> Step:
    """Make steps of the semi-implicit Euler method, which moves the pose by the new velocity."""

    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        twist = twist + dt * dynamics.acceleration(pose, twist, t)
        return pose + dt * twist, twist

    return step


def runge_kutta(dynamics: Dynamics, tableau: Tableau) -> Step:
    stages, weights, nodes = tableau[:3]

    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        velocity = np.empty((len(weights), *pose.shape))
        acceleration = np.empty_like(velocity)
        for i, node in enumerate(nodes):
            velocity[i] = twist + dt * np.tensordot(stages[i, :i], acceleration[:i], 1)
            stage_pose = pose + dt * np.tensordot(stages[i, :i], velocity[:i], 1)
            acceleration[i] = dynamics.acceleration(stage_pose, velocity[i], t + node * dt)
        return pose + dt * np.tensordot(weights, velocity, 1), twist + dt * np.tensordot(weights, acceleration, 1)

    return step


def adaptive(dynamics: Dynamics, tolerance: float) -> Step:
    """Make adaptive steps of DOP853 from sample to sample; the state is NaN if steps become too small or too many."""
    from scipy.integrate import DOP853

    tolerance = max(tolerance, 100 * float(np.finfo(float).eps))  # the smallest tolerance of scipy's DOP853
    steps_left = MOST_NUMPY_STEPS
    allowed: Any = tolerance * np.append(dynamics.unit, dynamics.unit / dynamics.mechanism.time_scale)

    def step(pose: Array, twist: Array, t: float, dt: float) -> tuple[Array, Array]:
        def rates(at: float, state: Array) -> Array:
            velocity = state[state.size // 2 :]
            own_pose, own_twist = state.reshape(2, -1, 3)
            return np.concatenate([velocity, dynamics.acceleration(own_pose, own_twist, at).reshape(-1)])

        start = np.concatenate([pose.reshape(-1), twist.reshape(-1)])
        solver: Any = DOP853(rates, t, start, t + dt, rtol=tolerance, atol=allowed)
        nonlocal steps_left
        while solver.status == "running" and steps_left > 0:
            solver.step()
            steps_left -= 1
        steps_left += NUMPY_STEPS_PER_SAMPLE
        state = solver.y if solver.status == "finished" else np.full_like(start, np.nan)
        return state.reshape(2, -1, 3)[0], state.reshape(2, -1, 3)[1]

    return step
