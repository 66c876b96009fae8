"""Runs of a user's MuJoCo model with the user's or other settings, and limits and contacts in a motion."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.elements import EQUALITY, TENDON
from engines.mujoco.reading.forces import ACTUATOR, limited_servos
from engines.mujoco.reading.frame import JOINT, PlanarModel, angles_of, name_of
from engines.mujoco.reading.settings import TIED_STEPS, changes, declared, switch_off
from engines.mujoco.releases import release_warnings, spelled
from engines.mujoco.running import logged_warnings
from engines.mujoco.stiffness import STIFFEST
from engines.reading import Change, Note, Obstacle, RowRegularisation, left_out
from engines.sampling import reactions, sampled
from reference.joints import Rod
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
STATE = ("qpos", "qvel", "ctrl", "act", "qfrc_applied", "xfrc_applied", "eq_active", "mocap_pos", "mocap_quat")
LIMIT_ROWS = {
    int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT): JOINT,
    int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON): TENDON,
}


def in_state(model: Any, state: Any) -> Any:
    data = mujoco.MjData(model)
    for name in STATE:
        getattr(data, name)[:] = getattr(state, name)
    return data


def centres(planar: PlanarModel, data: Any) -> Array:
    roots = list(planar.groups.roots)
    return data.xpos[roots] + np.einsum("bij,bj->bi", data.xmat[roots].reshape(-1, 3, 3), planar.groups.centres)


def directions(planar: PlanarModel, data: Any) -> Array:
    """Twists (bodies, 3, nv) due to unit velocities of MuJoCo's coordinates."""
    jac, out = np.zeros((2, 3, planar.model.nv)), np.zeros((len(planar.bodies), 3, planar.model.nv))
    for index, (root, centre) in enumerate(zip(planar.groups.roots, centres(planar, data), strict=True)):
        mujoco.mj_jac(planar.model, data, jac[0], jac[1], centre, root)
        out[index, :2], out[index, 2] = planar.frame.both @ jac[0], planar.frame.normal @ jac[1]
    return out


def positions(planar: PlanarModel, pose: Array) -> Array:
    """qpos (times, nq) for poses (times, bodies, 3)."""
    model, data = planar.model, in_state(planar.model, planar.data)
    out = np.empty((len(pose), model.nq))
    for sample, wanted in enumerate(pose):
        data.qpos[:] = planar.data.qpos
        # Angles are linear in the coordinates that turn bodies. For given angles, positions are linear in the
        # coordinates that shift bodies.
        for part in (slice(2, 3), slice(0, 2)):
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            angle = angles_of(model, planar.frame, planar.groups, data.qpos[None])[0]
            error = wanted - np.column_stack([centres(planar, data) @ planar.frame.both.T, angle])
            columns = directions(planar, data)
            turns = np.any(columns[:, 2], axis=0)
            used = ~turns if part.start == 0 else turns
            step, right = np.zeros(model.nv), error[:, part].reshape(-1)
            step[used] = np.linalg.lstsq(columns[:, part][..., used].reshape(len(right), -1), right, rcond=None)[0]
            mujoco.mj_integratePos(model, data.qpos, step, 1.0)
        out[sample] = data.qpos
    return out


def limited_forces(model: Any) -> list[str]:
    tables = ((ACTUATOR, limited_servos(model)), (JOINT, model.jnt_actfrclimited), (TENDON, model.tendon_actfrclimited))
    return [name_of(model, kind, index) for kind, limited in tables for index in np.flatnonzero(limited)]


def _has_limits_or_contacts(model: Any) -> bool:
    """Whether a position of the model may have rows of limits of joints and tendons, or rows of contacts."""
    touching = model.npair or model.nflex or (model.geom_contype.any() and model.geom_conaffinity.any())
    return bool(touching or model.jnt_limited.any() or model.tendon_limited.any())


def _at_limits(model: Any, data: Any) -> list[str]:
    """The elements whose force is at a limit in the state of `data`, after mj_fwdPosition."""
    unlimited = copy.copy(model)
    unlimited.actuator_forcelimited[limited_servos(model)] = 0
    unlimited.jnt_actfrclimited[:] = unlimited.tendon_actfrclimited[:] = 0
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(unlimited, data)
    actuator_force, joint_force = data.actuator_force.copy(), data.qfrc_actuator.copy()
    mujoco.mj_fwdActuation(model, data)
    actuators = np.flatnonzero(actuator_force != data.actuator_force)
    joints = [] if len(actuators) else model.dof_jntid[joint_force != data.qfrc_actuator]
    return [name_of(model, ACTUATOR, index) for index in actuators] + [name_of(model, JOINT, index) for index in joints]


@dataclass(frozen=True, eq=False)
class OwnMuJoCo:
    planar: PlanarModel  # model whose joints move exactly in the plane
    mechanism: Mechanism
    users: Any  # The user's model, which is run.
    tilt: float = 0.0  # Largest angle [rad] between axes of the planar and of the user's model.
    urdf: bool = False  # Whether the file is URDF without an element for MuJoCo.
    suspects: Mapping[str, str] = field(default_factory=dict)
    classes: bool = False  # whether the file may have classes of defaults

    engine = "MuJoCo"
    assumed = ""
    elements = ("contact", "limit", "frictionloss", "actuation", "spring", "damper", "armature")

    @property
    def dt(self) -> float:
        return float(self.planar.model.opt.timestep)

    @property
    def declares(self) -> bool:
        """False with a rod, since an equality of a tendon lacks the velocity term."""
        return not any(isinstance(joint, Rod) for joint in self.mechanism.joints)

    @property
    def has_soft_joints(self) -> bool:
        return any(self.planar.held.values())

    @property
    def start_twist(self) -> Array:
        return np.array([body.twist for body in self.planar.bodies])

    @property
    def settings(self) -> Mapping[str, str]:
        model, option = self.planar.model, self.planar.model.opt
        out = {
            "timestep": f"{option.timestep:g} s",
            "integrator": spelled(mujoco.mjtIntegrator(option.integrator)),
            "solver": spelled(mujoco.mjtSolver(option.solver)),
            "iterations": f"{option.iterations}",
            "tolerance": f"{option.tolerance:g}",
            "cone": spelled(mujoco.mjtCone(option.cone)),
        }
        for index, joints in self.planar.held.items():
            for name in ("solref", "solimp") if joints else ():
                values = getattr(model, f"eq_{name}")[index]
                out[f"{name} of {name_of(model, EQUALITY, index)}"] = " ".join(f"{value:g}" for value in values)
        return out

    def start(self) -> Array:
        return self.without(None)

    def without(self, element: str | None) -> Array:
        model = copy.copy(self.planar.model)
        if element is not None:
            switch_off(model, element)
        # With tolerance zero the solver's error is rounding.
        model.opt.tolerance, model.opt.iterations = 0.0, max(100, model.opt.iterations)
        data = self._consistent_start(model)
        with logged_warnings(data):
            mujoco.mj_forward(model, data)
        return self._motion(model, data)[1]

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        return self._regularisation(gap, pose)

    @cached_property
    def _regularisation(self) -> Any:
        data = self._own_start(self.planar.model)

        def moved(pose: Array) -> Any:
            data.qpos[:] = positions(self.planar, pose[None])[0]
            mujoco.mj_fwdPosition(self.planar.model, data)
            return data

        columns = directions(self.planar, self.planar.data).reshape(-1, self.planar.model.nv)
        return declared(self.planar, self.mechanism, columns, self._drift(), moved)

    def _drift(self) -> Array:
        data = self._consistent_start(self.planar.model)
        mujoco.mj_forward(self.planar.model, data)
        data.qacc[:] = 0.0
        return self._motion(self.planar.model, data)[1].reshape(-1)

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        model, data, first = self.planar.model, self._own_start(self.planar.model), dict[str, Obstacle]()
        kinds = mujoco.mjtConstraint
        touching = range(int(kinds.mjCNSTR_CONTACT_FRICTIONLESS), int(kinds.mjCNSTR_CONTACT_ELLIPTIC) + 1)
        has_limits = bool(limited_forces(model))
        if not (has_limits or _has_limits_or_contacts(model)):
            return []
        for at, qpos, rates in zip(t, positions(self.planar, pose), twist, strict=True):
            data.qpos[:] = qpos
            mujoco.mj_fwdPosition(model, data)
            events: list[tuple[str, str]] = []  # descriptions, and kinds of elements to switch off
            for kind, index in zip(data.efc_type, data.efc_id, strict=True):
                if kind in LIMIT_ROWS:
                    events.append((f"{name_of(model, LIMIT_ROWS[kind], index)} reaches its limit", "limit"))
                elif kind in touching:
                    pair = [name_of(model, mujoco.mjtObj.mjOBJ_GEOM, geom) for geom in data.contact[index].geom]
                    events.append((f"{pair[0]} touches {pair[1]}", "contact"))
            if has_limits:
                self._set_rates(data, rates)
                at_limits = _at_limits(model, data)
                events += [(f"{element} reaches the limit of its force", "forcelimit") for element in at_limits]
            for words, without in events:
                first.setdefault(words, Obstacle(float(at), words, left_out(without)))
        return sorted(first.values(), key=lambda obstacle: obstacle.t)

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        return changes(self.planar.model, self.has_soft_joints, smallest, self.urdf, self.classes, further)

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        if not self.tilt:
            return ()
        samples, every = len(run.t) - 1, max(1, round(float(run.t[1]) / self.dt))
        flat = replace(self, users=self.planar.model)

        def difference(run: Trajectory, change: Change | None) -> str:
            largest = np.abs(flat.run(samples, every, change).pose - run.pose).max(axis=(0, 1))
            return f"{max(largest[0], largest[1]):.2g} m and {largest[2]:.2g} rad"

        words = (
            f"they differ by up to {self.tilt:.2g} rad from exact ones, as after rounding, and are read as exact; with "
            f"exact ones your model moves differently by {difference(run, None)} in {run.t[-1]:.3g} s"
        )
        if self.has_soft_joints:
            stiff = self.changes(self.dt)[-1]
            words += f", with stiff loops by {difference(self.run(samples, every, stiff), stiff)}"
        return (Note("the directions of joints", words),)

    def run(self, samples: int, every: int, change: Change | None = None) -> Trajectory:
        model, spacing = copy.copy(self.users), every * self.dt
        if change is not None:
            options = dict(change.options)
            model.opt.timestep = change.dt
            model.opt.integrator = getattr(mujoco.mjtIntegrator, f"mjINT_{options['integrator'].upper()}")
            if options["tied"]:
                model.eq_solref[:] = (TIED_STEPS * change.dt, 1.0)
                model.eq_solimp[:] = STIFFEST
        steps = max(1, round(spacing / model.opt.timestep))
        t = np.arange(samples + 1, dtype=np.float64) * spacing
        data = self._own_start(model)
        qpos, qvel = np.full((samples + 1, model.nq), np.nan), np.full((samples + 1, model.nv), np.nan)
        now_qpos, now_qvel = data.qpos, data.qvel

        def record(sample: int) -> bool:
            is_reset = data.time < t[sample] - spacing / 2
            if not is_reset:
                qpos[sample], qvel[sample] = now_qpos, now_qvel
            return is_reset

        with logged_warnings(data) as log:
            stepping = sampled([steps] * samples, lambda count: mujoco.mj_step(model, data, nstep=count), record)
            reset_at = log.reset_at
            is_valid = np.isfinite(qpos).all(axis=1) & np.isfinite(qvel).all(axis=1)
            if reset_at is not None:
                is_valid &= t < reset_at - model.opt.timestep / 2  # MuJoCo's clock is rounded
            is_valid = np.logical_and.accumulate(is_valid)
            pose, twist, acceleration = self._read(model, qpos[is_valid], qvel[is_valid], len(t))
            warnings = (*log.messages, *release_warnings())
        own = self.mechanism
        reaction = reactions(own, pose, twist, acceleration, own.inertias, own.gravity)
        return Trajectory(t, pose, twist, reaction, stepping, warnings, reset_at)

    def _read(self, model: Any, qpos: Array, qvel: Array, count: int) -> tuple[Array, Array, Array]:
        pose, twist, acceleration = np.full((3, count, len(self.mechanism.bodies), 3), np.nan)
        data = self._own_start(model)
        if len(qpos):
            pose[: len(qpos), :, 2] = angles_of(model, self.planar.frame, self.planar.groups, qpos)
        for sample in range(len(qpos)):
            data.qpos[:], data.qvel[:] = qpos[sample], qvel[sample]
            mujoco.mj_forward(model, data)
            data.qacc_warmstart[:] = data.qacc
            twist[sample], acceleration[sample] = self._motion(model, data)
            pose[sample, :, :2] = centres(self.planar, data) @ self.planar.frame.both.T
        return pose, twist, acceleration

    def _own_start(self, model: Any) -> Any:
        return in_state(model, self.planar.data)

    def _consistent_start(self, model: Any) -> Any:
        """A new mujoco.MjData at t = 0 with the velocities of the mechanism, which satisfy all joints."""
        data = self._own_start(model)
        mujoco.mj_fwdPosition(model, data)
        if np.any(self.start_twist != self.mechanism.twist):
            self._set_rates(data, self.mechanism.twist)
        return data

    def _set_rates(self, data: Any, twist: Array) -> None:
        columns = directions(self.planar, data).reshape(-1, self.planar.model.nv)
        data.qvel[:] = np.linalg.lstsq(columns, twist.reshape(-1), rcond=None)[0]

    def _motion(self, model: Any, data: Any) -> tuple[Array, Array]:
        frame, out = self.planar.frame, np.zeros((2, len(self.mechanism.bodies), 3))
        jac, rate = np.zeros((2, 2, 3, model.nv))
        for index, (root, centre) in enumerate(zip(self.planar.groups.roots, centres(self.planar, data), strict=True)):
            mujoco.mj_jac(model, data, jac[0], jac[1], centre, root)
            mujoco.mj_jacDot(model, data, rate[0], rate[1], centre, root)
            for which, (along, turning) in enumerate((jac @ data.qvel, jac @ data.qacc + rate @ data.qvel)):
                out[which, index, :2], out[which, index, 2] = frame.both @ along, frame.normal @ turning
        return out[0], out[1]
