"""A user's MuJoCo model as it is: run from its start, with its own settings or with others that MuJoCo documents."""

from __future__ import annotations

import copy
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.elements import Scene
from engines.mujoco.reading.frame import angles_of, name_of
from engines.mujoco.reading.obstacles import obstacles, positions
from engines.mujoco.reading.settings import TIED_STEPS, changes, declared, switch_off
from engines.mujoco.releases import marks, spelled
from engines.mujoco.running import listening
from engines.mujoco.stiffness import STIFFEST
from engines.reading import Change, Give, Note, Obstacle
from engines.sampling import sampled
from reference.joints import Rod
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


STATE = ("qpos", "qvel", "ctrl", "act", "qfrc_applied", "xfrc_applied", "eq_active", "mocap_pos", "mocap_quat")


def in_state(model: Any, state: Any) -> Any:
    """A fresh mujoco.MjData with positions, velocities and inputs of another one."""
    data = mujoco.MjData(model)
    for name in STATE:
        getattr(data, name)[:] = getattr(state, name)
    return data


@dataclass(frozen=True, eq=False)
class OwnMuJoCo:
    """The compiled model and its start; see `engines.reading.OwnModel`.

    `users`: the user's model, which is run; the scene's is the same, but that its joints move exactly in the plane;
    `tilt` [rad]: by how much the user's do not.
    """

    scene: Scene
    mechanism: Mechanism
    users: Any
    tilt: float = 0.0
    urdf: bool = False  # read from a URDF file without an element of MuJoCo's own: the lines to copy bring one
    classes: bool = False  # the file may have classes of its own, which a default that is copied does not reach

    @property
    def engine(self) -> str:
        return "MuJoCo"

    @property
    def dt(self) -> float:
        return float(self.scene.model.opt.timestep)

    @property
    def assumed(self) -> str:
        return ""

    @property
    def declares(self) -> bool:
        """Not with a rod: the equality of a tendon leaves out the term of the velocities, which no ideal row does."""
        return not any(isinstance(joint, Rod) for joint in self.mechanism.joints)

    @property
    def softly_held(self) -> bool:
        return any(self.scene.held.values())

    @property
    def elements(self) -> Sequence[str]:
        return ("contact", "limit", "frictionloss", "actuation", "spring", "damper", "armature")

    @property
    def own_twist(self) -> Array:
        return np.array([body.twist for body in self.scene.bodies])

    @property
    def suspects(self) -> Mapping[str, str]:
        return {}

    @property
    def settings(self) -> Mapping[str, str]:
        model = self.scene.model
        option = model.opt
        out = {
            "timestep": f"{option.timestep:g} s",
            "integrator": spelled(mujoco.mjtIntegrator(option.integrator)),
            "solver": spelled(mujoco.mjtSolver(option.solver)),
            "iterations": f"{option.iterations}",
            "tolerance": f"{option.tolerance:g}",
            "cone": spelled(mujoco.mjtCone(option.cone)),
        }
        for index, joints in self.scene.held.items():
            if joints:
                element = name_of(model, mujoco.mjtObj.mjOBJ_EQUALITY, index)
                out[f"solref of {element}"] = " ".join(f"{value:g}" for value in model.eq_solref[index])
                out[f"solimp of {element}"] = " ".join(f"{value:g}" for value in model.eq_solimp[index])
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
        with listening(data):
            mujoco.mj_forward(model, data)
        return self._motion(model, data)[1]

    @cached_property
    def _give(self) -> Any:
        data = self._fresh(self.scene.model)

        def moved(pose: Array) -> Any:
            data.qpos[:] = positions(self.scene, pose[None])[0]
            mujoco.mj_fwdPosition(self.scene.model, data)
            return data

        return declared(self.scene, self.mechanism, self._directions(self.scene.data), self._drift(), moved)

    def _drift(self) -> Array:
        """Accelerations (3 bodies,) at the start with MuJoCo's coordinates at a steady rate."""
        model = self.scene.model
        data = self._started(model)
        mujoco.mj_forward(model, data)
        data.qacc[:] = 0.0
        return self._motion(model, data)[1].reshape(-1)

    def give(self, gap: Array, pose: Array) -> Give:
        return self._give(gap, pose)

    def obstacles(self, t: Array, pose: Array, twist: Array) -> list[Obstacle]:
        return obstacles(self.scene, self._fresh(self.scene.model), self._directions, t, pose, twist)

    def changes(self, smallest: float, further: bool = False) -> list[Change]:
        return changes(self.scene.model, self.softly_held, smallest, self.urdf, self.classes, further)

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
        )
        words += f"ones your model moves differently by {moved(run, None)} in {run.t[-1]:.3g} s"
        if self.softly_held:
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

        with listening(data) as complaints:
            stepping = sampled([steps] * samples, lambda count: mujoco.mj_step(model, data, nstep=count), record)
            reset = complaints.reset_at
            sound = np.isfinite(qpos).all(axis=1) & np.isfinite(qvel).all(axis=1)
            if reset is not None:
                sound &= t < reset - model.opt.timestep / 2  # a sum of steps is rounded
            pose, twist, acceleration = self._read(model, data, qpos, qvel, sound)
            warnings = (*complaints.said, *marks())
        reaction = np.full((samples + 1, self.mechanism.row_count), np.nan)
        if self.mechanism.row_count:
            own = (each[sound] for each in (pose, acceleration, twist))
            reaction[sound] = self._reactions(*own) if sound.any() else np.nan
        return Trajectory(t, pose, twist, reaction, stepping, warnings, reset)

    def _reactions(self, pose: Array, acceleration: Array, twist: Array) -> Array:
        return self.mechanism.reaction(pose, acceleration, twist=twist)

    def _read(self, model: Any, data: Any, qpos: Array, qvel: Array, sound: Any) -> tuple[Array, Array, Array]:
        shape = (len(qpos), len(self.mechanism.bodies), 3)
        pose, twist, acceleration = (np.full(shape, np.nan) for _ in range(3))
        data = self._fresh(model)
        last = int(np.argmin(sound)) if not sound.all() else len(sound)
        sound[last:] = False
        angles = angles_of(model, self.scene.frame, self.scene.groups, qpos[:last]) if last else np.zeros((0, 1))
        for sample in range(last):
            data.qpos[:], data.qvel[:] = qpos[sample], qvel[sample]
            mujoco.mj_forward(model, data)
            data.qacc_warmstart[:] = data.qacc
            twist[sample], acceleration[sample] = self._motion(model, data)
            pose[sample, :, :2] = self._centres(data) @ self.scene.frame.both.T
            pose[sample, :, 2] = angles[sample]
        return pose, twist, acceleration

    def _fresh(self, model: Any) -> Any:
        """A mujoco.MjData at the user's start."""
        return in_state(model, self.scene.data)

    def _started(self, model: Any) -> Any:
        """The same at the velocities of the mechanism, which satisfy all joints."""
        data = self._fresh(model)
        mujoco.mj_fwdPosition(model, data)
        if np.any(self.own_twist != self.mechanism.twist):
            data.qvel[:] = np.linalg.lstsq(self._directions(data), self.mechanism.twist.reshape(-1), rcond=None)[0]
        return data

    def _centres(self, data: Any) -> Array:
        groups = self.scene.groups
        roots = list(groups.roots)
        turns = data.xmat[roots].reshape(-1, 3, 3)
        return data.xpos[roots] + np.einsum("bij,bj->bi", turns, groups.centres)

    def _motion(self, model: Any, data: Any) -> tuple[Array, Array]:
        """Twists and accelerations (bodies, 3) in the state of `data`, after mj_forward."""
        frame, count = self.scene.frame, len(self.mechanism.bodies)
        out = np.zeros((2, count, 3))
        jac, rate = np.zeros((2, 3, model.nv)), np.zeros((2, 3, model.nv))
        # What holds a tree: the derivative of the Jacobian along the motion.
        for index, (root, centre) in enumerate(zip(self.scene.groups.roots, self._centres(data), strict=True)):
            mujoco.mj_jac(model, data, jac[0], jac[1], centre, root)
            mujoco.mj_jacDot(model, data, rate[0], rate[1], centre, root)
            for which, vectors in enumerate((jac @ data.qvel, jac @ data.qacc + rate @ data.qvel)):
                out[which, index, :2] = frame.both @ vectors[0]
                out[which, index, 2] = frame.normal @ vectors[1]
        return out[0], out[1]

    def _directions(self, data: Any) -> Array:
        """(3 bodies, nv): twists of unit velocities of MuJoCo's coordinates."""
        model, frame = self.scene.model, self.scene.frame
        jac = np.zeros((2, 3, model.nv))
        out = np.zeros((len(self.mechanism.bodies), 3, model.nv))
        for index, (root, centre) in enumerate(zip(self.scene.groups.roots, self._centres(data), strict=True)):
            mujoco.mj_jac(model, data, jac[0], jac[1], centre, root)
            out[index, :2], out[index, 2] = frame.both @ jac[0], frame.normal @ jac[1]
        return out.reshape(-1, model.nv)
