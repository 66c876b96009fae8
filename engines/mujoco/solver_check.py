"""Whether MuJoCo's iterative solver has solved what it was given, and which of its solvers does."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np
from scipy.linalg import get_lapack_funcs

from engines import Unsupported
from engines.mujoco.model import Model, multiply_compliances
from engines.mujoco.releases import full_inertia

# At the start a solver must find the accelerations to this part of them. Measured: a solver that suits a mechanism
# leaves 1e-7 or less, one that doesn't leaves 1e-2 or more, and nothing stands between.
SOLVED = 1e-6
# The part of an error that an iteration of Newton's may leave: three of them then refine a solution to rounding. Of 850
# scenes and random mechanisms all but three leave 0.08 or less; those, with 0.13, 0.48 and 2, are softened.
LOST = 0.1

_factorise, _inverse_condition = get_lapack_funcs(("potrf", "pocon"), dtype=np.float64)


def unsolved(compiled: Any, data: Any) -> float:
    """How far the solver's answer is from the equations that it should solve, relative to the accelerations in them.

    Newton's law M a = f + J^T F holds exactly in the dual solver, and the constraint law J a + R F = a_ref in the
    primal ones; what is left of the other is the error. A contact row that opens or slides has another law: only rows
    that hold are asked. Where R is so small that forces are mostly rounding, the accelerations are held against an
    exact solution instead.
    """
    if not data.nefc:
        return 0.0
    momentum, rows = np.empty(compiled.nv), np.empty(data.nefc)
    mujoco.mj_mulM(compiled, data, momentum, data.qacc)
    left = (momentum - data.qfrc_smooth - data.qfrc_constraint)[None]
    mujoco.mj_solveM(compiled, data, left, left.copy())
    mujoco.mj_mulJacVec(compiled, data, rows, data.qacc)
    holding = data.efc_state == mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC
    law = (rows - data.efc_aref + data.efc_R * data.efc_force)[holding]
    scale = max(np.abs(data.qacc).max(), np.abs(data.qacc_smooth).max(), np.abs(data.efc_aref).max(), 1e-300)
    error = max(np.abs(left).max(), np.abs(law).max(initial=0.0)) / scale
    if not error < SOLVED and not mujoco.mj_isSparse(compiled):
        exact = _exact_accelerations(compiled, data, holding)
        if exact is not None:
            error = np.abs(data.qacc - exact).max() / scale
    return float(error) if math.isfinite(error) else math.inf


def _exact_accelerations(compiled: Any, data: Any, holding: Any) -> Any:
    """The accelerations with these rows holding and the others idle, by elimination; None if some row slides."""
    idle = data.efc_state == mujoco.mjtConstraintState.mjCNSTRSTATE_SATISFIED
    if not np.all(holding | idle):
        return None
    inertia = full_inertia(compiled, data)
    rows = data.efc_J.reshape(data.nefc, compiled.nv)[holding]
    matrix = np.block([[inertia, -rows.T], [rows, np.diag(data.efc_R[holding])]])
    try:
        return np.linalg.solve(matrix, np.concatenate([data.qfrc_smooth, data.efc_aref[holding]]))[: compiled.nv]
    except np.linalg.LinAlgError:
        return None


def _lost(compiled: Any, data: Any) -> float:
    """What rounding leaves of an error after one iteration of Newton's: the condition of its Hessian, times that.

    M + J^T R^-1 J, scaled to a unit diagonal as its Cholesky factor is by nature.
    """
    if not data.nefc:
        return 0.0
    hessian = full_inertia(compiled, data)
    rows = data.efc_J.reshape(data.nefc, compiled.nv)
    hessian += (rows.T / data.efc_R) @ rows
    scale = 1 / np.sqrt(np.diag(hessian))
    hessian *= scale * scale[:, None]
    size = float(np.abs(hessian).sum(axis=0).max())
    factor, failed = _factorise(hessian)
    inverse, _ = _inverse_condition(factor, size)
    return np.inf if failed or not inverse > 0 else float(np.finfo(float).eps / inverse)


def ease(model: Model, softening: float, start: Any) -> float:
    """Multiply compliances by 10, at most to MuJoCo's default, until Newton's iterations lose at most LOST in rounding.

    Returns the softening that this leads to. `start`: a mujoco.MjData at the start, solved by the model's solver;
    `softening`: the compliances as a part of MuJoCo's default. 1e-12 is too little where a light body carries a heavy
    one. Other solvers than Newton's build no such matrix, and keep the compliances.
    """
    compiled = model.compiled
    if compiled.opt.solver != mujoco.mjtSolver.mjSOL_NEWTON or not unsolved(compiled, start) < SOLVED:
        return softening
    while softening < 1 and not mujoco.mj_isSparse(compiled) and _lost(compiled, start) > LOST:
        softening *= 10
        multiply_compliances(compiled, 10)
        start = model.start()
    return softening


def choose_solver(model: Model, solvers: Sequence[str]) -> Any:
    """Set the first of the solvers that solves the start; the one that comes nearest if none does.

    Returns the mujoco.MjData of the start as that solver solves it. Newton is the fastest and as exact as any on a few
    loops and on many short ones, and loses the compliance in rounding on long chains; there the dual solver (PGS) is
    better, which fails for bodies of very different mass and takes hundreds of sweeps for many loops. CG is slower than
    either, and stands in for both.
    Raises Unsupported if none of the solvers can serve.
    """
    missed = {}
    for solver in solvers:
        if solver == "PGS" and model.written:
            continue  # it has built its matrix before the rows are written
        model.compiled.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{solver.upper()}")
        start = model.start()
        missed[solver] = unsolved(model.compiled, start)
        if missed[solver] < SOLVED:
            return start
    if not missed:
        raise Unsupported("rows are written in a callback, and PGS has built its matrix by then; add Newton or CG")
    model.compiled.opt.solver = getattr(mujoco.mjtSolver, f"mjSOL_{min(missed, key=missed.__getitem__).upper()}")
    return model.start()
