"""Poses of a mechanism as MuJoCo's positions: to ask MuJoCo what a motion of the judge's would touch."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.mujoco.reading.frame import FREE, HINGE, SLIDE
from engines.mujoco.reading.joints import Scene
from reference.plane import rotated

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
