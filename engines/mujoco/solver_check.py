"""The residual of MuJoCo's iterative solver, and the choice of a solver with a small residual."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco.model import MuJoCoModel, multiply_compliances
from engines.mujoco.releases import full_inertia

# Largest relative residual of a solver that has solved the equations at t = 0. Measured residuals are at most 1e-7 for
# a suitable solver, and at least 1e-2 for an unsuitable solver.
SOLVED_RESIDUAL = 1e-6
# Largest permitted fraction of the error that remains after an iteration of Newton's method. Three iterations then
# reduce the error to rounding. In 850 scenes and random mechanisms the fraction is at most 0.08, with three exceptions.
MAX_REMAINING_ERROR = 0.1


def solver_residual(compiled: Any, data: Any) -> float:
    """The residual of the solver's equations, relative to the accelerations.

    The dual solver satisfies Newton's law M a = f + J^T F exactly. The primal solvers satisfy the constraint law J a +
    R F = a_ref exactly. The error is the residual of the law that is not satisfied exactly. Contact rows that open or
    slide have another law and are not included. If R is so small that forces are mostly rounding, the accelerations are
    compared with an exact solution.
    """
    if not data.nefc:
        return 0.0
    momentum, rows = np.empty(compiled.nv), np.empty(data.nefc)
    mujoco.mj_mulM(compiled, data, momentum, data.qacc)
    newton = (momentum - data.qfrc_smooth - data.qfrc_constraint)[None]
    mujoco.mj_solveM(compiled, data, newton, newton.copy())
    mujoco.mj_mulJacVec(compiled, data, rows, data.qacc)
    holding = data.efc_state == mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC
    law = (rows - data.efc_aref + data.efc_R * data.efc_force)[holding]
    scale = max(np.abs(data.qacc).max(), np.abs(data.qacc_smooth).max(), np.abs(data.efc_aref).max(), 1e-300)
    error = max(np.abs(newton).max(), np.abs(law).max(initial=0.0)) / scale
    if not error < SOLVED_RESIDUAL and not mujoco.mj_isSparse(compiled):
        exact = _exact_accelerations(compiled, data, holding)
        if exact is not None:
            error = np.abs(data.qacc - exact).max() / scale
    return float(error) if math.isfinite(error) else math.inf


def _exact_accelerations(compiled: Any, data: Any, holding: Any) -> Any:
    """The accelerations (nv,) by elimination, for `holding` rows and otherwise inactive rows.

    The result is None if a row slides or the matrix is singular.
    """
    is_inactive = data.efc_state == mujoco.mjtConstraintState.mjCNSTRSTATE_SATISFIED
    if not np.all(holding | is_inactive):
        return None
    inertia = full_inertia(compiled, data)
    rows = data.efc_J.reshape(data.nefc, compiled.nv)[holding]
    matrix = np.block([[inertia, -rows.T], [rows, np.diag(data.efc_R[holding])]])
    try:
        return np.linalg.solve(matrix, np.concatenate([data.qfrc_smooth, data.efc_aref[holding]]))[: compiled.nv]
    except np.linalg.LinAlgError:
        return None


def _remaining_error(compiled: Any, data: Any) -> float:
    """The fraction of the error that remains after an iteration of Newton's method because of rounding.

    The fraction is the condition number of the Hessian M + J^T R^-1 J times the unit of rounding. The Hessian is scaled
    to a unit diagonal, since the scaling does not change the rounding errors of its Cholesky factor.
    """
    if not data.nefc:
        return 0.0
    from scipy.linalg.lapack import dpocon, dpotrf  # pyright: ignore[reportAttributeAccessIssue] (missing in the stubs)

    hessian = full_inertia(compiled, data)
    rows = data.efc_J.reshape(data.nefc, compiled.nv)
    hessian += (rows.T / data.efc_R) @ rows
    scale = 1 / np.sqrt(np.diag(hessian))
    hessian *= scale * scale[:, None]
    size = float(np.abs(hessian).sum(axis=0).max())
    factor, failed = dpotrf(hessian)
    inverse, _ = dpocon(factor, size)
    return np.inf if failed or not inverse > 0 else float(np.finfo(float).eps / inverse)


def soften_until_solvable(model: MuJoCoModel, start: Any) -> float:
    """Multiply the compliances by 10 until the Hessian of the Newton solver is well conditioned.

    Returns the new softening, which is at most 1 (MuJoCo's default). The original compliances are too small if a light
    body carries a heavy body. `start` is a solved mujoco.MjData at t = 0. For another solver than Newton, the
    compliances do not change.
    """
    compiled, softening = model.compiled, model.softening
    if compiled.opt.solver != mujoco.mjtSolver.mjSOL_NEWTON or not solver_residual(compiled, start) < SOLVED_RESIDUAL:
        return softening
    can_check = not mujoco.mj_isSparse(compiled)
    while softening < 1 and can_check and _remaining_error(compiled, start) > MAX_REMAINING_ERROR:
        softening *= 10
        multiply_compliances(compiled, 10)
        start = model.start()
    return softening


def choose_solver(model: MuJoCoModel, solvers: Sequence[str]) -> Any:
    """Choose the first solver that solves the equations at t = 0, or else the solver with the smallest residual.

    Returns the chosen solver's mujoco.MjData at t = 0. Newton is the fastest solver. In long chains Newton's rounding
    exceeds the compliance, and the dual solver PGS is better. PGS fails for very different masses, and needs hundreds
    of iterations for many loops. CG is slower, but suits these two cases. Raises Unsupported if no solver in the list
    can read user rows.
    """
    residuals = {}
    for solver in solvers:
        if solver == "PGS" and model.has_user_rows:
            continue  # PGS builds its matrix before the callback writes the rows
        model.compiled.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver.upper()}")
        start = model.start()
        residuals[solver] = solver_residual(model.compiled, start)
        if residuals[solver] < SOLVED_RESIDUAL:
            return start
    if not residuals:
        raise Unsupported("PGS builds its matrix before a callback writes the rows; add Newton or CG to the solvers")
    best = min(residuals, key=residuals.__getitem__)
    model.compiled.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{best.upper()}")
    return model.start()
