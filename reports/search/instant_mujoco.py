"""MuJoCo's accelerations and forces at one instant against the law that its own model declares.

The judge has the mechanism's own rows J and their change, and of MuJoCo only what it says of its constraints: how stiff
a row is (`efc_KBIP`), how far it gives way (`efc_R`), and the armature of driven coordinates
(`reports.search.declared_mujoco`). MuJoCo's own Jacobian is held against ours on the way.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Softness
from engines.mujoco import MuJoCo
from engines.mujoco.joints.skate import STEPWISE
from engines.mujoco.model import Model
from reference.joints import Skate
from reference.mechanism import Mechanism
from reports.search.declared_mujoco import declared, directions
from reports.search.law import Answer, Fault, NotAsked, constrained, difference, driving_force, force_difference

Array = NDArray[np.float64]

STEP = 0.01  # of the mechanism's own time scale
STEPS = 5  # after which the second instant lies: at the first one every coordinate of the tree is zero
# Rounding, and what it becomes where a model is hardened: the primal solver adds J^T J / R to the inertia.
LAW, ROUNDED = 1e-9, 1e-14


def bound(engine: MuJoCo) -> float:
    """The error, relative to the largest acceleration or force, above which something is wrong."""
    return max(LAW, ROUNDED / engine.stiffness.softening)


def errors(engine: MuJoCo, mechanism: Mechanism) -> dict[str, float]:
    """By what accelerations and reactions miss the law, relative to the largest of each, at the start and a bit later.

    Raises NotAsked where the engine declares no law at an instant, Fault for a row that is lacking, and Unsupported.
    """
    dt = STEP * mechanism.time_scale
    refuse_without_a_law(engine, mechanism, dt)
    run = replace(engine, estimates=False).build(mechanism, dt)  # an estimate takes a second run, and says nothing here
    softness = engine.softness(mechanism, dt)
    model = run.model
    if model.halves:
        raise NotAsked("a body that is cut into halves is another mechanism at one instant")
    start = model.start()
    told = run(1, STEPS)
    if told.reset_at is not None or not np.isfinite(told.pose).all():
        raise Fault(f"it was lost within {STEPS} steps: {'; '.join(told.warnings)}")
    if any("the solver missed" in warning for warning in told.warnings):
        raise NotAsked("it says itself that its solver ended too early")
    out = {"acceleration": 0.0, "reaction": 0.0}
    with model.hooked():
        for sample, data in enumerate((start, run.data)):
            mujoco.mj_forward(model.compiled, data)
            _refine(model, data, engine.tolerance)
            here = Instant.of(mechanism, model, data, softness)
            found = {
                "acceleration": here.missed(data.qacc),
                "reaction": here.missed_force(told.reaction[sample]),
            }
            out = {name: max(out[name], value) for name, value in found.items()}
    return out


def refuse_without_a_law(engine: MuJoCo, mechanism: Mechanism, dt: float) -> None:
    """Raises NotAsked for constructions that obey no law of an instant."""
    if engine.drive != "inertia" and any(joint.labels == ("torque",) for joint in mechanism.joints):
        raise NotAsked(f"a drive by {engine.drive!r} obeys no law of an instant")
    if engine.skates in STEPWISE and any(isinstance(joint, Skate) for joint in mechanism.joints):
        raise NotAsked("a blade whose row is that of another pose obeys no law of an instant")
    softness = engine.softness(mechanism, dt)
    if softness is not None and not softness.complete:
        raise NotAsked("contacts, and rows that are held over a step, obey no law of an instant")


def _refine(model: Model, data: Any, tolerance: float) -> None:
    """Let the solver go on, where what it left is within the tolerance that the engine declares: that is no fault.

    The tolerance is told of the inertia without what only keeps a drive's rate.
    """
    compiled = model.compiled
    left = np.empty(compiled.nv)
    mujoco.mj_mulM(compiled, data, left, data.qacc)
    left -= data.qfrc_smooth + data.qfrc_constraint
    inertia = float((compiled.dof_M0 - compiled.dof_armature)[model.address].sum())
    if np.linalg.norm(left) <= tolerance * inertia:
        kept, compiled.opt.tolerance = compiled.opt.tolerance, min(compiled.opt.tolerance, ROUNDED**2)
        mujoco.mj_forward(compiled, data)
        compiled.opt.tolerance = kept


@dataclass(frozen=True, eq=False)
class Instant:
    """A state of a model, and the law there: what it asks for, what it is compared with, and the rows it came from."""

    mechanism: Mechanism
    model: Model
    data: Any
    pose: Array  # (bodies, 3)
    twist: Array
    free: Array
    aimed: Array  # (rows,): what J a is to be, beside the velocity term
    give: Array
    solved: Array  # (rows,): which rows are the solver's, the others being held by the tree
    floor: float  # m/s^2: what rounded gaps make of stiff rows, beyond the law

    @classmethod
    def of(cls, mechanism: Mechanism, model: Model, data: Any, softness: Softness | None) -> Instant:
        """What `data` holds after mj_forward. Raises Fault where rows are lacking."""
        pose, twist, _ = _motion(model, data, data.qacc)
        give, aimed, solved, stiffest = declared(mechanism, model, data, mechanism.rows(pose), softness, pose, twist)
        # A gap is rounded, and what a stiff row makes of that is no fault: beyond the law, where this is the largest.
        floor = stiffest * np.finfo(float).eps * mechanism.length_scale / LAW
        free = mechanism.unconstrained(pose, twist)
        return cls(mechanism, model, data, pose, twist, free, aimed, give, solved, floor)

    def law(self, velocity_term: bool = True) -> Answer:
        """Accelerations (bodies, 3) and forces (rows,); without it, the solver's rows lack their `velocity_term`.

        A row of the tree's coordinates is J D with D their directions, and its velocity term (J D)' is what then lacks.
        So J a is what it is where no coordinate accelerates.
        """
        rows, right = self.mechanism.rows(self.pose), self.mechanism.bias(self.pose, self.twist)
        if not velocity_term:
            _, _, coasting = _motion(self.model, self.data, np.zeros(self.model.compiled.nv))
            right = np.where(self.solved, rows @ coasting.reshape(-1), right)
        return constrained(rows, right + self.aimed, self.mechanism.inertias, self.free, self.give)

    def accelerations(self) -> Array:
        """The accelerations (tree coordinates,) of the law."""
        _, _, coasting = _motion(self.model, self.data, np.zeros(self.model.compiled.nv))
        own = directions(self.model, self.data)[:, self.model.address]
        told = np.linalg.lstsq(own, (self.law().motion - coasting).reshape(-1), rcond=None)[0]
        return np.asarray(told, dtype=np.float64)

    def missed(self, accelerations: Array, law: Answer | None = None) -> float:
        """By what accelerations (nv,) miss the law, relative to the largest."""
        _, _, change = _motion(self.model, self.data, accelerations)
        # What a motion needs is compared with what acts, and with what the motion itself asks for.
        others = (self.free, self.twist / self.mechanism.time_scale, np.array([[self.floor, 0.0, 0.0]]))
        return difference(self.mechanism, change, (law or self.law()).motion, others)

    def missed_force(self, reaction: Array) -> float:
        """By what reactions (rows,) miss the law, relative to the largest force."""
        force = driving_force(self.mechanism, self.twist)
        others = (force, self.floor * float(self.mechanism.inertias[:, 0].max()))
        return force_difference(self.mechanism, reaction, self.law().force, others)


def _motion(model: Model, data: Any, accelerations: Array) -> tuple[Array, Array, Array]:
    """Poses, twists and accelerations (bodies, 3) of a state with these accelerations (nv,)."""
    own = (values[model.address][None] for values in (data.qpos, data.qvel, accelerations))
    (pose,), (twist,), (change,) = model.tree.motion(*own)
    return pose, twist, change
