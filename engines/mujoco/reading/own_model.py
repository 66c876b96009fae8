"""A user's MuJoCo model as it is: run from its start, with its own settings or with others that MuJoCo documents.

The limits and contacts that a motion meets in it are here as well.
"""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
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
from engines.sampling import sampled
from reference.joints import Rod
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
STATE = ("qpos", "qvel", "ctrl", "act", "qfrc_applied", "xfrc_applied", "eq_active", "mocap_pos", "mocap_quat")
LIMITS = {
    int(mujoco.mjtConstraint.mjCNSTR_LIMIT_JOINT): JOINT,
    int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON): TENDON,
}


def in_state(model: Any, state: Any) -> Any:
    """A fresh mujoco.MjData with positions, velocities and inputs of another one."""
    data = mujoco.MjData(model)
    for name in STATE:
        getattr(data, name)[:] = getattr(state, name)
    return data


def centres(scene: PlanarModel, data: Any) -> Array:
    """The centres of mass (bodies, 3) [m] in the world."""
    roots = list(scene.groups.roots)
    return data.xpos[roots] + np.einsum("bij,bj->bi", data.xmat[roots].reshape(-1, 3, 3), scene.groups.centres)


def directions(scene: PlanarModel, data: Any) -> Array:
    """(bodies, 3, nv): the twists of unit velocities of MuJoCo's coordinates."""
    jac, out = np.zeros((2, 3, scene.model.nv)), np.zeros((len(scene.bodies), 3, scene.model.nv))
    for index, (root, centre) in enumerate(zip(scene.groups.roots, centres(scene, data), strict=True)):
        mujoco.mj_jac(scene.model, data, jac[0], jac[1], centre, root)
        out[index, :2], out[index, 2] = scene.frame.both @ jac[0], scene.frame.normal @ jac[1]
    return out


def positions(scene: PlanarModel, pose: Array) -> Array:
    """qpos (times, nq) of poses (times, bodies, 3); MuJoCo's coordinates have no loops, so any pose has one."""
    model, data = scene.model, in_state(scene.model, scene.data)
    out = np.empty((len(pose), model.nq))
    for sample, wanted in enumerate(pose):
        data.qpos[:] = scene.data.qpos
        # Angles are linear in the coordinates. With these right, places are linear in those that turn nothing.
        for part in (slice(2, 3), slice(0, 2)):
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            angle = angles_of(model, scene.frame, scene.groups, data.qpos[None])[0]
            miss = wanted - np.column_stack([centres(scene, data) @ scene.frame.both.T, angle])
            columns = directions(scene, data)
            still = ~np.any(columns[:, 2], axis=0) if part.start == 0 else np.any(columns[:, 2], axis=0)
            way = np.zeros(model.nv)
            right = miss[:, part].reshape(-1)
            way[still] = np.linalg.lstsq(columns[:, part][..., still].reshape(len(right), -1), right, rcond=None)[0]
            mujoco.mj_integratePos(model, data.qpos, way, 1.0)
        out[sample] = data.qpos
    return out


def limited_forces(model: Any) -> list[str]:
    """The elements with a limit of their force, which no ideal mechanism has."""
    tables = ((ACTUATOR, limited_servos(model)), (JOINT, model.jnt_actfrclimited), (TENDON, model.tendon_actfrclimited))
    return [name_of(model, kind, index) for kind, limited in tables for index in np.flatnonzero(limited)]


def _at_limits(model: Any, data: Any) -> list[str]:
    """The elements that are at a limit of their force in the state of `data`, after mj_fwdPosition."""
    free = copy.copy(model)
    free.actuator_forcelimited[limited_servos(model)] = 0
    free.jnt_actfrclimited[:] = free.tendon_actfrclimited[:] = 0
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(free, data)
    wanted, unlimited = data.actuator_force.copy(), data.qfrc_actuator.copy()
    mujoco.mj_fwdActuation(model, data)
    actuators = np.flatnonzero(wanted != data.actuator_force)
    joints = [] if len(actuators) else model.dof_jntid[unlimited != data.qfrc_actuator]
    return [name_of(model, ACTUATOR, index) for index in actuators] + [name_of(model, JOINT, index) for index in joints]


@dataclass(frozen=True, eq=False)
class OwnMuJoCo:
    """The compiled model and its start; see `engines.reading.OwnModel`.

    `users`: the user's model, which is run; the scene's is the same, except that its joints move exactly in the plane;
    `tilt` [rad]: by how much the user's do not.
    """

    scene: PlanarModel
    mechanism: Mechanism
    users: Any
    tilt: float = 0.0
    urdf: bool = False  # read from a URDF file without an element of MuJoCo's own: the lines to copy bring one
    classes: bool = False  # the file may have classes of its own, which a default that is copied does not reach

    engine = "MuJoCo"
    assumed = ""
    elements = ("contact", "limit", "frictionloss", "actuation", "spring", "damper", "armature")

    @property
    def dt(self) -> float:
        return float(self.scene.model.opt.timestep)

    @property
    def declares(self) -> bool:
        """Not with a rod: the equality of a tendon leaves out the term of the velocities, which no ideal row does."""
        return not any(isinstance(joint, Rod) for joint in self.mechanism.joints)

    @property
    def has_soft_joints(self) -> bool:
        return any(self.scene.held.values())

    @property
    def start_twist(self) -> Array:
        return np.array([body.twist for body in self.scene.bodies])

    @property
    def suspects(self) -> Mapping[str, str]:
        return {}

    @property
    def settings(self) -> Mapping[str, str]:
        model, option = self.scene.model, self.scene.model.opt
        out = {
            "timestep": f"{option.timestep:g} s",
            "integrator": spelled(mujoco.mjtIntegrator(option.integrator)),
            "solver": spelled(mujoco.mjtSolver(option.solver)),
            "iterations": f"{option.iterations}",
            "tolerance": f"{option.tolerance:g}",
            "cone": spelled(mujoco.mjtCone(option.cone)),
        }
        for index, joints in self.scene.held.items():
            for name in ("solref", "solimp") if joints else ():
                values = getattr(model, f"eq_{name}")[index]
                out[f"{name} of {name_of(model, EQUALITY, index)}"] = " ".join(f"{value:g}" for value in values)
        return out

    def start(self) -> Array:
        return self._start(self.scene.model)

    def without(self, element: str) -> Array:
        model = copy.copy(self.scene.model)
        switch_off(model, element)
        return self._start(model)

    def _start(self, model: Any) -> Array:
        """With the solver's tolerance at zero: the equations are to be compared, not where a solver stops."""
        model = copy.copy(model)
        model.opt.tolerance, model.opt.iterations = 0.0, max(100, model.opt.iterations)
        data = self._started(model)
        with logged_warnings(data):
            mujoco.mj_forward(model, data)
        return self._motion(model, data)[1]

    def regularisation(self, gap: Array, pose: Array) -> RowRegularisation:
        return self._give(gap, pose)

    @cached_property
    def _give(self) -> Any:
        data = self._fresh(self.scene.model)

        def moved(pose: Array) -> Any:
            data.qpos[:] = positions(self.scene, pose[None])[0]
            mujoco.mj_fwdPosition(self.scene.model, data)
            return data

        columns = directions(self.scene, self.scene.data).reshape(-1, self.scene.model.nv)
        return declared(self.scene, self.mechanism, columns, self._drift(), moved)

    def _drift(self) -> Array:
        """Accelerations (3 bodies,) at the start with MuJoCo's coordinates at a steady rate."""
        data = self._started(self.scene.model)
        mujoco.mj_forward(self.scene.model, data)
        data.qacc[:] = 0.0
        return self._motion(self.scene.model, data)[1].reshape(-1)

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        """What the motion of poses and twists (times, bodies, 3) meets first, in the order of time."""
        model, data, first = self.scene.model, self._fresh(self.scene.model), dict[str, Obstacle]()
        kinds = mujoco.mjtConstraint
        touching = range(int(kinds.mjCNSTR_CONTACT_FRICTIONLESS), int(kinds.mjCNSTR_CONTACT_ELLIPTIC) + 1)
        has_limits = bool(limited_forces(model))
        for at, qpos, rates in zip(t, positions(self.scene, pose), twist, strict=True):
            data.qpos[:] = qpos
            mujoco.mj_fwdPosition(model, data)
            met: list[tuple[str, str]] = []
            for kind, index in zip(data.efc_type, data.efc_id, strict=True):
                if kind in LIMITS:
                    met.append((f"{name_of(model, LIMITS[kind], index)} reaches its limit", "limit"))
                elif kind in touching:
                    pair = [name_of(model, mujoco.mjtObj.mjOBJ_GEOM, geom) for geom in data.contact[index].geom]
                    met.append((f"{pair[0]} touches {pair[1]}", "contact"))
            if has_limits:
                self._set_rates(data, rates)
                met += [
                    (f"{element} reaches the limit of its force", "forcelimit") for element in _at_limits(model, data)
                ]
            for words, without in met:
                first.setdefault(words, Obstacle(float(at), words, left_out(without)))
        return sorted(first.values(), key=lambda obstacle: obstacle.t)

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        return changes(self.scene.model, self.has_soft_joints, smallest, self.urdf, self.classes, further)

    def remarks(self, run: Trajectory) -> Sequence[Note]:
        if not self.tilt:
            return ()
        samples, every = len(run.t) - 1, max(1, round(float(run.t[1]) / self.dt))
        flat = replace(self, users=self.scene.model)

        def moved(of: Trajectory, change: Change | None) -> str:
            off = np.abs(flat.run(samples, every, change).pose - of.pose).max(axis=(0, 1))
            return f"{max(off[0], off[1]):.2g} m and {off[2]:.2g} rad"

        words = (
            f"they are up to {self.tilt:.2g} rad off, as rounding of a file makes them, and taken as exact; with exact "
            f"ones your model moves differently by {moved(run, None)} in {run.t[-1]:.3g} s"
        )
        if self.has_soft_joints:
            stiff = self.changes(self.dt)[-1]
            words += f", with stiff loops by {moved(self.run(samples, every, stiff), stiff)}"
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
        data = self._fresh(model)
        qpos, qvel = np.full((samples + 1, model.nq), np.nan), np.full((samples + 1, model.nv), np.nan)
        now_qpos, now_qvel = data.qpos, data.qvel

        def record(sample: int) -> bool:
            has_restarted = data.time < t[sample] - spacing / 2
            if not has_restarted:
                qpos[sample], qvel[sample] = now_qpos, now_qvel
            return has_restarted

        with logged_warnings(data) as log:
            stepping = sampled([steps] * samples, lambda count: mujoco.mj_step(model, data, nstep=count), record)
            reset = log.reset_at
            sound = np.isfinite(qpos).all(axis=1) & np.isfinite(qvel).all(axis=1)
            if reset is not None:
                sound &= t < reset - model.opt.timestep / 2  # a sum of steps is rounded
            sound = np.logical_and.accumulate(sound)
            pose, twist, acceleration = self._read(model, qpos[sound], qvel[sound], len(t))
            warnings = (*log.messages, *release_warnings())
        reaction = np.full((samples + 1, self.mechanism.row_count), np.nan)
        if self.mechanism.row_count and sound.any():
            reaction[sound] = self.mechanism.reaction(pose[sound], acceleration[sound], twist=twist[sound])
        return Trajectory(t, pose, twist, reaction, stepping, warnings, reset)

    def _read(self, model: Any, qpos: Array, qvel: Array, count: int) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (count, bodies, 3) of the first states, NaN after them."""
        pose, twist, acceleration = np.full((3, count, len(self.mechanism.bodies), 3), np.nan)
        data = self._fresh(model)
        if len(qpos):
            pose[: len(qpos), :, 2] = angles_of(model, self.scene.frame, self.scene.groups, qpos)
        for sample in range(len(qpos)):
            data.qpos[:], data.qvel[:] = qpos[sample], qvel[sample]
            mujoco.mj_forward(model, data)
            data.qacc_warmstart[:] = data.qacc
            twist[sample], acceleration[sample] = self._motion(model, data)
            pose[sample, :, :2] = centres(self.scene, data) @ self.scene.frame.both.T
        return pose, twist, acceleration

    def _fresh(self, model: Any) -> Any:
        """A mujoco.MjData at the user's start."""
        return in_state(model, self.scene.data)

    def _started(self, model: Any) -> Any:
        """The same at the velocities of the mechanism, which satisfy all joints."""
        data = self._fresh(model)
        mujoco.mj_fwdPosition(model, data)
        if np.any(self.start_twist != self.mechanism.twist):
            self._set_rates(data, self.mechanism.twist)
        return data

    def _set_rates(self, data: Any, twist: Array) -> None:
        columns = directions(self.scene, data).reshape(-1, self.scene.model.nv)
        data.qvel[:] = np.linalg.lstsq(columns, twist.reshape(-1), rcond=None)[0]

    def _motion(self, model: Any, data: Any) -> tuple[Array, Array]:
        """Twists and accelerations (bodies, 3) in the state of `data`, after mj_forward."""
        frame, out = self.scene.frame, np.zeros((2, len(self.mechanism.bodies), 3))
        jac, rate = np.zeros((2, 2, 3, model.nv))
        for index, (root, centre) in enumerate(zip(self.scene.groups.roots, centres(self.scene, data), strict=True)):
            mujoco.mj_jac(model, data, jac[0], jac[1], centre, root)
            mujoco.mj_jacDot(model, data, rate[0], rate[1], centre, root)
            for which, (along, turning) in enumerate((jac @ data.qvel, jac @ data.qacc + rate @ data.qvel)):
                out[which, index, :2], out[which, index, 2] = frame.both @ along, frame.normal @ turning
        return out[0], out[1]
