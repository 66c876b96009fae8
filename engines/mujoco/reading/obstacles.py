"""What a motion of the judge's would meet in a user's model: limits, contacts, limits of forces."""

from __future__ import annotations

import copy
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.elements import Scene
from engines.mujoco.reading.forces import limited_servos
from engines.mujoco.reading.frame import FREE, HINGE, SLIDE, name_of
from engines.reading import Obstacle, left_out
from reference.plane import rotated

ACTUATOR, JOINT, TENDON = mujoco.mjtObj.mjOBJ_ACTUATOR, mujoco.mjtObj.mjOBJ_JOINT, mujoco.mjtObj.mjOBJ_TENDON


def limited_forces(model: Any) -> list[str]:
    """The elements whose limit of a force no ideal mechanism has."""
    found = ((ACTUATOR, limited_servos(model)), (JOINT, model.jnt_actfrclimited), (TENDON, model.tendon_actfrclimited))
    return [name_of(model, kind, index) for kind, which in found for index in np.flatnonzero(which)]


def unlimited(model: Any) -> Any:
    """A copy in which none of these limits acts."""
    free = copy.copy(model)
    free.actuator_forcelimited[limited_servos(model)] = 0
    free.jnt_actfrclimited[:] = 0
    free.tendon_actfrclimited[:] = 0
    return free


def reached(model: Any, free: Any, data: Any) -> list[str]:
    """What is at a limit of its force in the state of `data`, after mj_fwdPosition; `free`: see `unlimited`."""
    mujoco.mj_fwdVelocity(model, data)
    mujoco.mj_fwdActuation(free, data)
    wanted, asked = data.actuator_force.copy(), data.qfrc_actuator.copy()
    mujoco.mj_fwdActuation(model, data)
    if np.any(wanted != data.actuator_force):
        return [name_of(model, ACTUATOR, index) for index in np.flatnonzero(wanted != data.actuator_force)]
    return [name_of(model, JOINT, model.dof_jntid[dof]) for dof in np.flatnonzero(asked != data.qfrc_actuator)]


Array = NDArray[np.float64]


def positions(scene: Scene, pose: Array) -> Array:
    """qpos (times, nq) of poses (times, bodies, 3); MuJoCo's coordinates have no loops, so any pose has one."""
    model, data = scene.model, scene.data
    out = np.tile(data.qpos, (len(pose), 1))
    for group in range(len(scene.bodies)):
        joints = list(scene.joints_of(group))
        slides = [joint for joint in joints if model.jnt_type[joint] == SLIDE]
        hinges = [joint for joint in joints if model.jnt_type[joint] == HINGE]
        parent = scene.parent(joints[0])
        if model.jnt_type[joints[0]] == FREE:
            out[:, _place(scene, joints[0]) : _place(scene, joints[0]) + 7] = _free(scene, group, pose)
        turned = pose[:, group, 2] - scene.angle(group)
        carried = np.zeros(len(pose)) if parent < 0 else pose[:, parent, 2] - scene.angle(parent)
        for joint in hinges:
            place = _place(scene, joint)
            out[:, place] = data.qpos[place] + scene.sign(joint) * (turned - carried)
        if slides:
            # What the slides carry, seen from where they stand: along their axes it has moved by the coordinates.
            on_body = bool(hinges) and hinges[0] < slides[0]
            at = data.xanchor[hinges[0]] if hinges else scene.frame.both.T @ scene.bodies[group].pose[:2]
            apart = _moved(scene, group, at, pose) - _moved(scene, parent, at, pose)
            turn = turned if on_body else carried
            axes = np.array([scene.frame.in_plane(data.xaxis[joint]) for joint in slides])
            way = rotated(-turn, apart) @ np.linalg.pinv(axes)
            for column, joint in enumerate(slides):
                out[:, _place(scene, joint)] = data.qpos[_place(scene, joint)] + way[:, column]
    return out


def _place(scene: Scene, joint: int) -> int:
    return int(scene.model.jnt_qposadr[joint])


def _moved(scene: Scene, group: int, at: Array, pose: Array) -> Array:
    """Where the material of a body that stood at a place of the world is at these poses (times, 2) [m]."""
    own = np.array(scene.own(group, at))
    if group < 0:
        return np.tile(own, (len(pose), 1))
    return pose[:, group, :2] + rotated(pose[:, group, 2], own)


def _free(scene: Scene, group: int, pose: Array) -> Array:
    """Place and quaternion (times, 7) of a body that nothing holds."""
    model, data, root = scene.model, scene.data, scene.groups.roots[group]
    origin = _moved(scene, group, data.xpos[root], pose) @ scene.frame.both
    origin += (data.xpos[root] @ scene.frame.normal) * scene.frame.normal
    place = _place(scene, int(model.body_jntadr[root])) + 3
    out = np.empty((len(pose), 7))
    out[:, :3] = origin
    for sample, angle in enumerate(pose[:, group, 2] - scene.angle(group)):
        turn = np.zeros(4)
        mujoco.mju_axisAngle2Quat(turn, scene.frame.normal, angle)
        mujoco.mju_mulQuat(out[sample, 3:], turn, data.qpos[place : place + 4])
    return out


def obstacles(
    scene: Scene, data: Any, directions: Callable[[Any], Array], t: Array, pose: Array, twist: Array
) -> list[Obstacle]:
    """What the motion of poses and twists (times, bodies, 3) meets first, in the order of time.

    `data` is a mujoco.MjData at the start, to work in; `directions` of it are the twists of MuJoCo's unit velocities.
    """
    model, found = scene.model, dict[str, Obstacle]()
    free = unlimited(model) if limited_forces(model) else None

    def meets(at: float, words: str, without: str) -> None:
        found.setdefault(words, Obstacle(float(at), words, left_out(without)))

    kinds = mujoco.mjtConstraint
    limits = {int(kinds.mjCNSTR_LIMIT_JOINT): JOINT, int(kinds.mjCNSTR_LIMIT_TENDON): TENDON}
    touching = range(int(kinds.mjCNSTR_CONTACT_FRICTIONLESS), int(kinds.mjCNSTR_CONTACT_ELLIPTIC) + 1)
    for at, qpos, rates in zip(t, positions(scene, pose), twist, strict=True):
        data.qpos[:] = qpos
        mujoco.mj_fwdPosition(model, data)
        for kind, index in zip(data.efc_type, data.efc_id, strict=True):
            if kind in limits:
                meets(at, f"{name_of(model, limits[kind], int(index))} reaches its limit", "limit")
            elif kind in touching:
                pair = [name_of(model, mujoco.mjtObj.mjOBJ_GEOM, int(each)) for each in data.contact[index].geom]
                meets(at, f"{pair[0]} touches {pair[1]}", "contact")
        if free is not None:
            data.qvel[:] = np.linalg.lstsq(directions(data), rates.reshape(-1), rcond=None)[0]
            for element in reached(model, free, data):
                meets(at, f"{element} reaches the limit of its force", "forcelimit")
    return sorted(found.values(), key=lambda each: each.t)
