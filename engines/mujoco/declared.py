"""Accelerations and reactions at an instant, by MuJoCo and by the law that the model declares.

The law uses the constraint rows J of the mechanism and their rates of change. MuJoCo provides the stiffness
(`efc_KBIP`) and the compliance (`efc_R`) of each row, and the armature of driven coordinates. In tree coordinates, each
row of MuJoCo must be a linear combination of a joint's rows in the mechanism.

MJX runs the same compiled model without the velocity terms of loops and rods, so its law has no such terms.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's compiled bindings have no types.).

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Instant, NotDeclared, Regularisation
from engines.constrained import Constrained, constrained
from engines.mujoco.builder import PLACEHOLDER
from engines.mujoco.joints.skate import STEPWISE, slip_damping
from engines.mujoco.model import MuJoCoModel
from reference.joints import Drive, Joint, Skate
from reference.mechanism import Mechanism

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

Array = NDArray[np.float64]

SAME_ROW = 1e-9  # Tolerance relative to the norm of a row, for the rounding along a chain of ten bodies.
ROUNDING_TOLERANCE = 1e-28  # A tolerance near the square of rounding, so that the solver's error is rounding.
NO_VELOCITY_TERMS = "without velocity terms"  # Name of MJX's law for loops and rods.


def instants(
    engine: MuJoCo,
    mechanism: Mechanism,
    dt: float,
    steps: int,
    built: Mechanism,
    accelerations: Callable[[MuJoCoModel, Any], Array] | None = None,
    check: str = "acceleration",
) -> tuple[Instant, ...] | NotDeclared:
    """Accelerations and reactions at t = 0 and, if `steps` is not 0, after `steps` steps; see `Engine.instants`.

    `accelerations(model, data)` returns accelerations to be checked instead of MuJoCo's; reactions are then not
    checked. `check` names the law, "acceleration" or NO_VELOCITY_TERMS.
    """
    if reason := why_no_law(engine, mechanism, dt):
        return NotDeclared(reason)
    engine = replace(engine, tolerance=min(engine.tolerance, ROUNDING_TOLERANCE), estimates=False)
    run = engine.build(built, dt)
    model = run.model
    if model.split_bodies:
        return NotDeclared("a body that is split into halves has other accelerations at an instant")
    start, motion = model.start(), run(1, max(steps, 1))
    if motion.warnings_of("residual"):
        return NotDeclared("a warning of the run says that its solver ended too early")
    regularisation, model = engine.regularisation(mechanism, dt), replace(model, mechanism=mechanism)
    has_end = steps and motion.reset_at is None and np.isfinite(motion.pose).all()
    out: list[Instant] = []
    with model.callback_installed():
        for sample, data in enumerate((start, run.data) if has_end else (start,)):
            mujoco.mj_forward(model.compiled, data)
            try:
                state = DeclaredState.of(mechanism, model, data, regularisation)
            except DependentRows as reason:
                return NotDeclared(str(reason))
            law = state.law(velocity_term=check != NO_VELOCITY_TERMS)
            computed = state.motion(data.qacc if accelerations is None else accelerations(model, data))
            at, scales = (state.pose, state.twist), (state.free, state.twist / mechanism.time_scale)
            out.append(Instant(check, at, computed, law.motion, scales))
            if accelerations is None:
                out.append(Instant("reaction", at, motion.reaction[sample], law.force))
    return tuple(out)


class DependentRows(RuntimeError):
    """The rows of a joint are dependent in tree coordinates, so the forces are not determined."""


def why_no_law(engine: MuJoCo, mechanism: Mechanism, dt: float) -> str:
    """The reason why a construction of a joint has no law at an instant, or "" if there is no such construction."""
    if engine.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints):
        return "a blade whose row is that of another pose obeys no law of an instant"
    regularisation = engine.regularisation(mechanism, dt)
    if regularisation is not None and not regularisation.complete:
        return "contacts, and rows that are held over a step, obey no law of an instant"
    return ""


@dataclass(frozen=True, eq=False)
class DeclaredState:
    mechanism: Mechanism
    model: MuJoCoModel
    data: Any
    pose: Array  # (bodies, 3).
    twist: Array  # (bodies, 3).
    free: Array  # Accelerations without joints (bodies, 3).
    aimed: Array  # J a (rows,) without the velocity term.
    compliance: Array  # A matrix C (rows, rows); the compliance of the rows is C C^T.
    by_solver: Array  # Whether MuJoCo's solver enforces a row (rows,); otherwise the tree does.

    @classmethod
    def of(
        cls, mechanism: Mechanism, model: MuJoCoModel, data: Any, regularisation: Regularisation | None
    ) -> DeclaredState:
        """The state of `data` after mj_forward.

        Raises DependentRows, and RuntimeError if MuJoCo's rows do not correspond to the mechanism's rows.
        """
        pose, twist, _ = _motion(model, data, data.qacc)
        rows = _declared_rows(mechanism, model, data, regularisation, pose, twist)
        return cls(mechanism, model, data, pose, twist, mechanism.unconstrained(pose, twist), *rows)

    def motion(self, accelerations: Array) -> Array:
        return _motion(self.model, self.data, accelerations)[2]

    def law(self, velocity_term: bool = True) -> Constrained:
        """The accelerations (bodies, 3) and forces (rows,) by the law.

        If `velocity_term` is False, rows of the solver have no velocity term. In tree coordinates with the directions
        D, such a row is J D, and its missing term contains d(J D)/dt. J a then has the value for zero accelerations of
        the coordinates.
        """
        rows, right = self.mechanism.rows(self.pose), self.mechanism.bias(self.pose, self.twist)
        if not velocity_term:
            coasting = self.motion(np.zeros(self.model.compiled.nv))
            right = np.where(self.by_solver, rows @ coasting.reshape(-1), right)
        return constrained(rows, right + self.aimed, self.mechanism.inertias, self.free, self.compliance)

    def coordinates(self, velocity_term: bool = True) -> Array:
        coasting = self.motion(np.zeros(self.model.compiled.nv))
        columns = _directions(self.model, self.data)[:, self.model.address]
        change = (self.law(velocity_term).motion - coasting).reshape(-1)
        return np.asarray(np.linalg.lstsq(columns, change, rcond=None)[0], dtype=np.float64)


def jacobian(compiled: Any, data: Any) -> Array:
    """MuJoCo's constraint rows (rows, nv) from dense or sparse storage."""
    if not mujoco.mj_isSparse(compiled):
        return data.efc_J[: data.nefc * compiled.nv].reshape(data.nefc, compiled.nv)
    dense = np.zeros((data.nefc, compiled.nv))
    mujoco.mju_sparse2dense(dense, data.efc_J.reshape(-1), data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    return dense


def _declared_rows(
    mechanism: Mechanism,
    model: MuJoCoModel,
    data: Any,
    regularisation: Regularisation | None,
    pose: Array,
    twist: Array,
) -> tuple[Array, Array, Array]:
    """The fields `aimed`, `compliance` and `by_solver` of a DeclaredState.

    Raises DependentRows, and RuntimeError if MuJoCo's rows do not correspond to the mechanism's rows.
    """
    rows, compiled = mechanism.rows(pose), model.compiled
    compliance, aimed, by_solver = np.zeros((len(rows), len(rows))), np.zeros(len(rows)), np.zeros(len(rows), bool)
    in_tree = rows @ _directions(model, data)
    gap, slip = np.nan_to_num(mechanism.gap(pose, data.time)), mechanism.slip(pose, twist)
    # The tree enforces a row if tree coordinates cannot change the row's gap, except by the rounding of arms.
    rounding = 10 * np.finfo(float).eps * float(np.abs(pose[:, :2]).max())
    length = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    is_loose = np.abs(in_tree).max(axis=1, initial=0.0) > SAME_ROW * length + rounding
    solver_rows = jacobian(compiled, data)
    unused = [number for number, row in enumerate(solver_rows) if np.linalg.norm(row) > SAME_ROW]  # some are empty
    begin = 0
    for joint in mechanism.joints:
        part = slice(begin, begin + joint.size)
        begin = part.stop
        if not is_loose[part].any():
            continue
        columns = np.flatnonzero(in_tree[part.start])
        if isinstance(joint, Drive) and len(columns) == 1 and compiled.dof_armature[columns[0]] > 0:
            # The armature is an inertia of this rotation alone, and its inverse is the compliance of the row.
            compliance[part, part] = 1 / np.sqrt(compiled.dof_armature[columns[0]] * model.unit)
            continue
        numbers = _rows_in_span(solver_rows, unused, in_tree[part], model.address)[: joint.size]
        if len(numbers) < joint.size and np.linalg.matrix_rank(in_tree[part]) < joint.size:
            raise DependentRows(
                f"the rows of joint {joint.name!r} depend on one another in the coordinates of the tree"
            )
        if len(numbers) < joint.size:
            raise RuntimeError(f"MuJoCo has {len(numbers)} constraints for {joint.name!r}, not {joint.size}")
        unused, by_solver[part] = [number for number in unused if number not in numbers], True
        joint_rows = _JointRows(model, data, joint, numbers, solver_rows[numbers], in_tree[part])
        compliance[part, part] = joint_rows.compliance
        if regularisation is not None and _is_user_row(compiled, data.efc_id[numbers[0]]):
            # The row of a skate has another damping than other user rows.
            damping = slip_damping(mechanism) if isinstance(joint, Skate) else regularisation.damping
            aimed[part] = -regularisation.stiffness * gap[part] - damping * slip[part]
        else:
            aimed[part] = joint_rows.aimed(gap[part], slip[part])
    if unused:
        raise RuntimeError(f"constraint {unused[0]} of MuJoCo's does not correspond to the mechanism's rows")
    return aimed, compliance, by_solver


@dataclass(frozen=True, eq=False)
class _JointRows:
    model: MuJoCoModel
    data: Any
    joint: Joint
    numbers: list[int]  # Indices of MuJoCo's rows.
    rows: Array  # MuJoCo's rows (size, nv).
    in_tree: Array  # The joint's rows in the mechanism (size, nv).

    @property
    def beside(self) -> list[int]:
        return [column for column in range(self.model.compiled.nv) if column not in self.model.address]

    @property
    def factors(self) -> Array:
        """The matrix (size, size) whose product with the joint's rows in the mechanism is MuJoCo's rows."""
        seen = self.model.address
        factors = np.linalg.lstsq(self.in_tree[:, seen].T, self.rows[:, seen].T, rcond=None)[0].T
        return np.asarray(factors, dtype=np.float64)

    @property
    def compliance(self) -> Array:
        """A matrix C (size, size) with the compliance C C^T, to which a clock adds its inverse inertia."""
        clock = np.sum(self.rows[:, self.beside] ** 2 / self.model.compiled.dof_M0[self.beside], axis=1)
        roots = np.sqrt((self.data.efc_R[self.numbers] + clock) / self.model.unit)
        return np.asarray(np.linalg.solve(self.factors, np.diag(roots)), dtype=np.float64)

    def aimed(self, gap: Array, slip: Array) -> Array:
        """J a (size,) without the velocity term, from the stiffness and damping of MuJoCo's rows.

        A clock starts at the angle zero. Later its angle differs slightly from the prescribed angle, since its inertia
        is finite.
        """
        data, beside, factors = self.data, self.beside, self.factors
        rate = self.joint.turning_rate if isinstance(self.joint, Drive) else 0.0
        clocks = data.qpos[beside] - rate * data.time, data.qvel[beside] - rate
        ahead, faster = (self.rows[:, beside] @ late for late in clocks)
        stiffness, damping, impedance, _ = data.efc_KBIP[self.numbers].T
        pull = -stiffness * impedance * (factors @ gap + ahead) - damping * (factors @ slip + faster)
        return np.asarray(np.linalg.solve(factors, pull), dtype=np.float64)


def _is_user_row(compiled: Any, equality: int) -> bool:
    is_tendon = compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_TENDON
    return bool(is_tendon and compiled.tendon(compiled.eq_obj1id[equality]).name.startswith(PLACEHOLDER))


def _rows_in_span(solver_rows: Array, candidates: list[int], rows: Array, columns: list[int]) -> list[int]:
    """The `candidates` whose solver rows are linear combinations of `rows` in these columns."""
    tested, span = solver_rows[candidates][:, columns], rows[:, columns].T
    residual = tested.T - span @ np.linalg.lstsq(span, tested.T, rcond=None)[0]
    is_inside = np.linalg.norm(residual, axis=0) <= SAME_ROW * np.linalg.norm(tested, axis=1)
    return [number for number, inside in zip(candidates, is_inside, strict=True) if inside]


def _directions(model: MuJoCoModel, data: Any) -> Array:
    count = model.tree.coordinates
    position = np.broadcast_to(data.qpos[model.address], (count, count))
    _, twists, _ = model.tree.motion(position, np.eye(count), np.zeros((count, count)))
    out = np.zeros((3 * len(model.mechanism.bodies), model.compiled.nv))
    out[:, model.address] = twists.reshape(count, -1).T
    return out


def _motion(model: MuJoCoModel, data: Any, accelerations: Array) -> tuple[Array, Array, Array]:
    columns = (values[model.address][None] for values in (data.qpos, data.qvel, accelerations))
    (pose,), (twist,), (change,) = model.tree.motion(*columns)
    return pose, twist, change
