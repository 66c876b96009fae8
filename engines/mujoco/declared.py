"""The law of one instant that MuJoCo's own model declares, beside the accelerations and reactions that it gives.

The law has the mechanism's own rows J and their change, and of MuJoCo only what it says of its constraints: how stiff
a row is (`efc_KBIP`), how far it gives way (`efc_R`), and the armature of driven coordinates. Each of MuJoCo's rows has
to be one of the mechanism's, seen in the coordinates of its tree.

MJX runs the same compiled model, so how far a row gives way is what MuJoCo says of it. MJX leaves out the velocity
terms of loops and rods, so the law of these is that without them.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Instant, NotDeclared, Regularisation
from engines.constrained import Constrained, constrained
from engines.mujoco.joints.skate import STEPWISE, slip_damping
from engines.mujoco.model import Model
from reference.joints import Drive, Skate
from reference.mechanism import Mechanism

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

Array = NDArray[np.float64]

SAME_ROW = 1e-9  # of a row's length: what the sums of a chain of ten bodies leave
SOLVED = 1e-28  # the square of a rounding: with this tolerance the solver leaves nothing else
WITHOUT = "without velocity terms"  # the law that MJX obeys for loops and rods


def instants(
    engine: MuJoCo,
    mechanism: Mechanism,
    dt: float,
    steps: int,
    built: Mechanism,
    accelerations: Callable[[Model, Any], Array] | None = None,
    check: str = "acceleration",
) -> tuple[Instant, ...] | NotDeclared:
    """Accelerations and reactions at the start and, with `steps`, after so many steps; see `engines.Engine.instants`.

    `accelerations(model, data)` replaces those of MuJoCo, without reactions; `check` may be WITHOUT.
    """
    if reason := why_no_law(engine, mechanism, dt):
        return NotDeclared(reason)
    engine = replace(engine, tolerance=min(engine.tolerance, SOLVED), estimates=False)
    run = engine.build(built, dt)
    model = run.model
    if model.halves:
        return NotDeclared("a body that is cut into halves is another mechanism at one instant")
    start, told = model.start(), run(1, max(steps, 1))
    if any("the solver missed" in warning for warning in told.warnings):
        return NotDeclared("it says itself that its solver ended too early")
    softness, model = engine.regularisation(mechanism, dt), replace(model, mechanism=mechanism)
    later = steps and told.reset_at is None and np.isfinite(told.pose).all()
    out: list[Instant] = []
    with model.hooked():
        for sample, data in enumerate((start, run.data) if later else (start,)):
            mujoco.mj_forward(model.compiled, data)
            here = State.of(mechanism, model, data, softness)
            law = here.law(velocity_term=check != WITHOUT)
            found = here.motion(data.qacc if accelerations is None else accelerations(model, data))
            state = here.pose, here.twist
            out.append(Instant(check, state, found, law.motion, (here.free, here.twist / mechanism.time_scale)))
            if accelerations is None:
                out.append(Instant("reaction", state, told.reaction[sample], law.force))
    return tuple(out)


def why_no_law(engine: MuJoCo, mechanism: Mechanism, dt: float) -> str:
    """The reason why constructions of a mechanism obey no law of an instant; empty if they do."""
    if engine.drive != "inertia" and any(all(joint.is_angular) for joint in mechanism.joints):
        return f"a drive by {engine.drive!r} obeys no law of an instant"
    if engine.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints):
        return "a blade whose row is that of another pose obeys no law of an instant"
    softness = engine.regularisation(mechanism, dt)
    if softness is not None and not softness.complete:
        return "contacts, and rows that are held over a step, obey no law of an instant"
    return ""


@dataclass(frozen=True, eq=False)
class State:
    """A state of a model and the rows of its law there."""

    mechanism: Mechanism
    model: Model
    data: Any
    pose: Array  # (bodies, 3)
    twist: Array
    free: Array
    aimed: Array  # (rows,): what J a is to be, beside the velocity term
    give: Array  # (rows, rows)
    solved: Array  # (rows,): which rows are the solver's, the others being held by the tree

    @classmethod
    def of(cls, mechanism: Mechanism, model: Model, data: Any, softness: Regularisation | None) -> State:
        """What `data` holds after mj_forward. Raises RuntimeError where rows are lacking."""
        pose, twist, _ = _motion(model, data, data.qacc)
        give, aimed, solved = _declared(mechanism, model, data, softness, pose, twist)
        return cls(mechanism, model, data, pose, twist, mechanism.unconstrained(pose, twist), aimed, give, solved)

    def motion(self, accelerations: Array) -> Array:
        """Accelerations (bodies, 3) of the bodies for those (nv,) of the coordinates."""
        return _motion(self.model, self.data, accelerations)[2]

    def law(self, velocity_term: bool = True) -> Constrained:
        """Accelerations (bodies, 3) and forces (rows,); without it, the solver's rows lack their `velocity_term`.

        A row of the tree's coordinates is J D with D their directions, and its velocity term (J D)' is what then lacks.
        So J a is what it is where no coordinate accelerates.
        """
        rows, right = self.mechanism.rows(self.pose), self.mechanism.bias(self.pose, self.twist)
        if not velocity_term:
            coasting = self.motion(np.zeros(self.model.compiled.nv))
            right = np.where(self.solved, rows @ coasting.reshape(-1), right)
        return constrained(rows, right + self.aimed, self.mechanism.inertias, self.free, self.give)

    def coordinates(self, velocity_term: bool = True) -> Array:
        """The accelerations (tree coordinates,) of the law."""
        coasting = self.motion(np.zeros(self.model.compiled.nv))
        columns = _directions(self.model, self.data)[:, self.model.address]
        change = (self.law(velocity_term).motion - coasting).reshape(-1)
        return np.asarray(np.linalg.lstsq(columns, change, rcond=None)[0], dtype=np.float64)


def jacobian(compiled: Any, data: Any) -> Array:
    """MuJoCo's rows (rows, nv), whichever way it stores them."""
    if not mujoco.mj_isSparse(compiled):
        return data.efc_J[: data.nefc * compiled.nv].reshape(data.nefc, compiled.nv)
    dense = np.zeros((data.nefc, compiled.nv))
    mujoco.mju_sparse2dense(dense, data.efc_J.reshape(-1), data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    return dense


def _declared(
    mechanism: Mechanism, model: Model, data: Any, softness: Regularisation | None, pose: Array, twist: Array
) -> tuple[Array, Array, Array]:
    """How the rows give way (rows, rows), what they aim at beside their velocity term, and which the solver has."""
    rows, compiled = mechanism.rows(pose), model.compiled
    give, aimed, solved = np.zeros((len(rows), len(rows))), np.zeros(len(rows)), np.zeros(len(rows), dtype=bool)
    in_tree = rows @ _directions(model, data)
    gap, slip = np.nan_to_num(mechanism.gap(pose, data.time)), mechanism.slip(pose, twist)
    # What the coordinates of the tree can't move, but by rounding of arms, is held by them.
    rounding = 10 * np.finfo(float).eps * float(np.abs(pose[:, :2]).max())
    length = np.where(mechanism.is_angular, 1.0, mechanism.length_scale)
    loose = np.abs(in_tree).max(axis=1, initial=0.0) > SAME_ROW * length + rounding
    lines = jacobian(compiled, data)
    seen, beside = model.address, [column for column in range(compiled.nv) if column not in model.address]
    waiting = [number for number, line in enumerate(lines) if np.linalg.norm(line) > SAME_ROW]  # one lies across
    begin = 0
    for joint in mechanism.joints:
        part = slice(begin, begin + joint.size)
        begin = part.stop
        if not loose[part].any():
            continue
        turned = np.flatnonzero(in_tree[part.start])
        if isinstance(joint, Drive) and len(turned) == 1 and compiled.dof_armature[turned[0]] > 0:
            # Its armature is a further inertia of this rotation alone: as a row, it gives way by the inverse.
            give[part, part] = 1 / np.sqrt(compiled.dof_armature[turned[0]] * model.unit)
            continue
        matching = _within(lines, waiting, in_tree[part], seen)[: joint.size]
        if len(matching) < joint.size:
            raise RuntimeError(f"MuJoCo has {len(matching)} constraints for {joint.name!r}, not {joint.size}")
        waiting, solved[part] = [number for number in waiting if number not in matching], True
        # MuJoCo's rows are these times ours.
        factors = np.linalg.lstsq(in_tree[part][:, seen].T, lines[matching][:, seen].T, rcond=None)[0].T
        # A clock beside the tree, by which a drive is geared, gives way by the inverse of its own inertia.
        clock = np.sum(lines[matching][:, beside] ** 2 / compiled.dof_M0[beside], axis=1)
        give[part, part] = np.linalg.solve(factors, np.diag(np.sqrt((data.efc_R[matching] + clock) / model.unit)))
        if softness is not None and _is_written(compiled, data.efc_id[matching[0]]):
            # A row that callbacks write; a skate's brings a damping of its own.
            damping = slip_damping(mechanism) if isinstance(joint, Skate) else softness.damping
            aimed[part] = -softness.stiffness * gap[part] - damping * slip[part]
            continue
        # Each of MuJoCo's rows has a stiffness of its own. A clock begins at zero, and is not quite where the rate
        # would have it: forces accelerate even so large an inertia a little.
        rate = joint.turning_rate if isinstance(joint, Drive) else 0.0
        clocks = data.qpos[beside] - rate * data.time, data.qvel[beside] - rate
        ahead, faster = (lines[matching][:, beside] @ late for late in clocks)
        stiffness, damping, impedance, _ = data.efc_KBIP[matching].T
        pull = -stiffness * impedance * (factors @ gap[part] + ahead) - damping * (factors @ slip[part] + faster)
        aimed[part] = np.linalg.solve(factors, pull)
    if waiting:
        raise RuntimeError(f"constraint {waiting[0]} of MuJoCo's is none of the mechanism's rows")
    return give, aimed, solved


def _is_written(compiled: Any, equality: int) -> bool:
    """Whether callbacks write the row of an equality, and not MuJoCo."""
    tendon = compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_TENDON
    return bool(tendon and compiled.tendon(compiled.eq_obj1id[equality]).name.startswith("written row"))


def _within(lines: Array, waiting: list[int], rows: Array, columns: list[int]) -> list[int]:
    """Which of the waiting lines are sums of the rows."""
    these, span = lines[waiting][:, columns], rows[:, columns].T
    left = these.T - span @ np.linalg.lstsq(span, these.T, rcond=None)[0]
    inside = np.linalg.norm(left, axis=0) <= SAME_ROW * np.linalg.norm(these, axis=1)
    return [number for number, ok in zip(waiting, inside, strict=True) if ok]


def _directions(model: Model, data: Any) -> Array:
    """The twists (3 bodies, nv) that the coordinates' unit velocities are, in the pose of `data`."""
    count = model.tree.coordinates
    where = np.broadcast_to(data.qpos[model.address], (count, count))
    _, twists, _ = model.tree.motion(where, np.eye(count), np.zeros((count, count)))
    out = np.zeros((3 * len(model.mechanism.bodies), model.compiled.nv))
    out[:, model.address] = twists.reshape(count, -1).T
    return out


def _motion(model: Model, data: Any, accelerations: Array) -> tuple[Array, Array, Array]:
    """Poses, twists and accelerations (bodies, 3) of a state with these accelerations (nv,)."""
    columns = (values[model.address][None] for values in (data.qpos, data.qvel, accelerations))
    (pose,), (twist,), (change,) = model.tree.motion(*columns)
    return pose, twist, change
