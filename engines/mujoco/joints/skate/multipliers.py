"""The skates' exact reaction, computed beside MuJoCo and applied as a force: no constraint in its solver at all."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.mujoco.construction import Building, Hooks
from engines.mujoco.written_rows import Rows, WrittenJoint, row_writer
from reference.rows import solve_symmetric

Array = NDArray[np.float64]


def refuse_loops(building: Building, what: str) -> None:
    """Raise Unsupported where the rows are not the only ones that share the accelerations."""
    if building.tree.closed or building.driven:
        raise Unsupported(f"{what} takes no loops and no drives: their forces would have to be solved for together")


def reaction(model: Any, data: Any, rows: Rows, without: Array) -> Array:
    """The force (nv,) that makes the rows hold, for the accelerations (nv,) `without` it; the mass is factorised."""
    jacobian, right, solve = _row_system(model, data, rows)
    return jacobian.T @ solve(right - jacobian @ without)


def without_slip(model: Any, data: Any, rows: Rows) -> Array:
    """The nearest velocity (nv,), in the metric of the mass, that the rows allow."""
    jacobian, _, solve = _row_system(model, data, rows)
    push, moved = jacobian.T @ solve(jacobian @ data.qvel), np.empty((1, model.nv))
    mujoco.mj_solveM(model, data, moved, push[None])
    return data.qvel - moved[0]


def _row_system(model: Any, data: Any, rows: Rows) -> tuple[Array, Array, Callable[[Array], Array]]:
    """J, the value of J a that holds the rows, and what solves J M^-1 J^T; of rows that repeat, the smallest forces."""
    flat, right = rows(data.time, data.qpos.tolist(), data.qvel.tolist())
    jacobian = np.array(flat).reshape(len(right), model.nv)
    moved = np.empty_like(jacobian)
    mujoco.mj_solveM(model, data, moved, jacobian)
    matrix = jacobian @ moved.T
    if len(right) == 1:
        return jacobian, np.array(right), lambda value: value / matrix[0, 0]
    return jacobian, np.array(right), lambda value: solve_symmetric(matrix, value)


def add_forces(building: Building, joints: Sequence[WrittenJoint]) -> None:
    """The reaction at the start of every step, held over it as `qfrc_applied`."""
    refuse_loops(building, "a multiplier applied as a force")

    def bind(compiled: Any, address: Sequence[int]) -> Hooks:
        rows = row_writer(building.tree, address, joints, compiled.nv)

        def apply(model: Any, data: Any) -> None:
            data.qfrc_applied[:] = 0
            mujoco.mj_forward(model, data)
            data.qfrc_applied[:] = reaction(model, data, rows, data.qacc_smooth)

        return Hooks(before=(apply,))

    building.binders.append(bind)
    building.size += len(joints)


def add_passive_forces(building: Building, joints: Sequence[WrittenJoint]) -> None:
    """The reaction in every stage, as a passive force."""
    refuse_loops(building, "a multiplier applied as a force")
    if building.mechanism.forces:
        raise Unsupported("a multiplier as a passive force is found before the forces of actuators are known")

    def bind(compiled: Any, address: Sequence[int]) -> Hooks:
        rows = row_writer(building.tree, address, joints, compiled.nv)
        bias, without = np.empty(compiled.nv), np.empty((1, compiled.nv))

        def apply(model: Any, data: Any) -> None:
            # Gravity and velocity terms; MuJoCo computes its own only after the passive forces (mj_fwdVelocity).
            mujoco.mj_rne(model, data, 0, bias)
            mujoco.mj_solveM(model, data, without, (data.qfrc_passive - bias)[None])
            data.qfrc_passive[:] += reaction(model, data, rows, without[0])

        return Hooks(passive=(apply,))

    building.binders.append(bind)
    building.size += len(joints)
