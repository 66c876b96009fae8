"""What MuJoCo declares of the rows in its solver, at one instant, in the order of the mechanism's own rows.

Each of its rows has to be one of the mechanism's, seen in the coordinates of its tree.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Softness
from engines.mujoco.joints.skate import slip_damping
from engines.mujoco.model import Model
from reference.joints import Drive, Joint, Skate
from reference.mechanism import Mechanism
from reports.search.law import Fault

Array = NDArray[np.float64]

# Of a row's length: what the sums of a chain of ten bodies leave.
SAME_ROW = 1e-9


def declared(
    mechanism: Mechanism, model: Model, data: Any, rows: Array, softness: Softness | None, pose: Array, twist: Array
) -> tuple[Array, Array, Array, float]:
    """How the rows give way (rows, rows), what they aim at beside their velocity term, which of them the solver has,
    and the stiffest of them [1/s^2], all as MuJoCo declares. Raises Fault where rows are lacking.
    """
    compiled = model.compiled
    give, aimed, stiffest = np.zeros((len(rows), len(rows))), np.zeros(len(rows)), 0.0
    solved = np.zeros(len(rows), dtype=bool)
    in_tree = rows @ directions(model, data)
    gap, slip = np.nan_to_num(mechanism.gap(pose, data.time)), mechanism.slip(pose, twist)
    length = np.where(mechanism.turning, 1.0, mechanism.length_scale)
    # What the coordinates of the tree can't move at all is held by them.
    loose = np.abs(in_tree).max(axis=1, initial=0.0) > SAME_ROW * length
    lines = _jacobian(compiled, data)
    seen, beside = model.address, [column for column in range(compiled.nv) if column not in model.address]
    waiting = [number for number, line in enumerate(lines) if np.linalg.norm(line) > SAME_ROW]  # one lies across
    begin = 0
    for joint in mechanism.joints:
        own = slice(begin, begin + joint.size)
        begin = own.stop
        if not loose[own].any():
            continue
        turned = np.flatnonzero(in_tree[own.start])
        if isinstance(joint, Drive) and len(turned) == 1 and compiled.dof_armature[turned[0]] > 0:
            # Its armature is a further inertia of this rotation alone: as a row, it gives way by the inverse.
            give[own, own] = 1 / np.sqrt(compiled.dof_armature[turned[0]] * model.unit)
            continue
        within = _within(lines[waiting][:, seen], in_tree[own][:, seen])
        found = [number for number, inside in zip(waiting, within, strict=True) if inside][: joint.size]
        if len(found) < joint.size:
            raise Fault(f"MuJoCo has {len(found)} constraints for {joint.name!r}, not {joint.size}")
        waiting, solved[own] = [number for number in waiting if number not in found], True
        # MuJoCo's rows are these times ours.
        factors = np.linalg.lstsq(in_tree[own][:, seen].T, lines[found][:, seen].T, rcond=None)[0].T
        # A clock beside the tree, by which a drive is geared, gives way by the inverse of its own inertia.
        clock = np.sum(lines[found][:, beside] ** 2 / compiled.dof_M0[beside], axis=1)
        give[own, own] = np.linalg.solve(factors, np.diag(np.sqrt((data.efc_R[found] + clock) / model.unit)))
        if softness is not None and _is_written(compiled, data.efc_id[found[0]]):
            # A row that callbacks write; a skate's brings a damping of its own.
            damping = slip_damping(mechanism) if isinstance(joint, Skate) else softness.damping
            aimed[own] = -softness.stiffness * gap[own] - damping * slip[own]
            stiffest = max(stiffest, softness.stiffness)
        else:  # each of MuJoCo's rows has a stiffness of its own
            stiffness, damping, impedance, _ = data.efc_KBIP[found].T
            # A clock is not quite where the rate would have it: forces accelerate even so large an inertia a little.
            ahead, faster = (lines[found][:, beside] @ late for late in _clocks_ahead(joint, data, beside))
            asked = -stiffness * impedance * (factors @ gap[own] + ahead) - damping * (factors @ slip[own] + faster)
            aimed[own] = np.linalg.solve(factors, asked)
            stiffest = max(stiffest, float(np.max(stiffness * impedance)))
    if waiting:
        raise Fault(f"constraint {waiting[0]} of MuJoCo's is none of the mechanism's rows")
    return give, aimed, solved, stiffest


def _clocks_ahead(joint: Joint, data: Any, beside: list[int]) -> tuple[Array, Array]:
    """By what angles [rad] and rates [rad/s] clocks are ahead of a drive; they begin at zero."""
    rate = joint.turning_rate if isinstance(joint, Drive) else 0.0
    return data.qpos[beside] - rate * data.time, data.qvel[beside] - rate


def _is_written(compiled: Any, equality: int) -> bool:
    """Whether callbacks write the row of an equality, and not MuJoCo."""
    tendon = compiled.eq_type[equality] == mujoco.mjtEq.mjEQ_TENDON
    return bool(tendon and compiled.tendon(compiled.eq_obj1id[equality]).name.startswith("written row"))


def _within(lines: Array, rows: Array) -> NDArray[np.bool_]:
    """Which of these lines (lines,) are sums of the rows."""
    left = lines.T - rows.T @ np.linalg.lstsq(rows.T, lines.T, rcond=None)[0]
    return np.linalg.norm(left, axis=0) <= SAME_ROW * np.linalg.norm(lines, axis=1)


def directions(model: Model, data: Any) -> Array:
    """The twists (3 bodies, nv) that the coordinates' unit velocities are, in the pose of `data`."""
    count = model.tree.coordinates
    where = np.broadcast_to(data.qpos[model.address], (count, count))
    _, twists, _ = model.tree.motion(where, np.eye(count), np.zeros((count, count)))
    out = np.zeros((3 * len(model.mechanism.bodies), model.compiled.nv))
    out[:, model.address] = twists.reshape(count, -1).T
    return out


def _jacobian(compiled: Any, data: Any) -> Array:
    """MuJoCo's rows (rows, nv)."""
    if not mujoco.mj_isSparse(compiled):
        return data.efc_J.reshape(data.nefc, compiled.nv)
    dense = np.zeros((data.nefc, compiled.nv))
    mujoco.mju_sparse2dense(dense, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    return dense
