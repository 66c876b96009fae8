"""The plane in which a MuJoCo model moves, found from its joints, and its bodies seen in that plane.

Bodies without joints are one with their parents: their masses are merged. What lies across the plane has no part in
the motion: joints hold it, and products of inertia only load them.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.reading import MOST_BODIES, refuse
from reference.joints import Body

Array = NDArray[np.float64]
PLANAR = 1e-9  # of a unit vector, or of an inertia: what counts as rounding
# rad. Files with six digits tilt an axis by 2e-6, 1.5708 for a right angle by 4e-6, and chains add the tilts of their
# bodies up. What is tilted on purpose is tilted by more; 1.57, 8e-4 off, is far above usual tolerances.
PRINTED = 1e-4
ROUGH = 1e-2  # rad: what a few digits less may make

FREE, BALL, SLIDE, HINGE = (
    int(getattr(mujoco.mjtJoint, f"mjJNT_{kind}")) for kind in ("FREE", "BALL", "SLIDE", "HINGE")
)


@dataclass(frozen=True, eq=False)
class Frame:
    """The plane: unit vectors (3,) of its x, its y, and the normal about which angles are counted."""

    across: Array
    up: Array
    normal: Array

    @cached_property
    def both(self) -> Array:
        """(2, 3): what takes a vector of the world to the plane."""
        return np.array([self.across, self.up])

    def in_plane(self, vector: Any) -> tuple[float, float]:
        x, y = self.both @ np.asarray(vector)
        return float(x), float(y)


def name_of(model: Any, kind: Any, index: Any) -> str:
    """An element's name as a user knows it, or its number."""
    word = str(kind).rsplit("_", 1)[-1].lower()
    name = mujoco.mj_id2name(model, kind, int(index))
    return f"{word} {name!r}" if name else f"{word} {index}"


def plain_name(model: Any, kind: Any, index: int) -> str:
    """The name alone, or the kind and the number."""
    return mujoco.mj_id2name(model, kind, index) or f"{str(kind).rsplit('_', 1)[-1].lower()} {index}"


def find_frame(model: Any, data: Any) -> Frame:
    """The plane in which every joint moves its body. Raises Unsupported where there is none."""
    joint = mujoco.mjtObj.mjOBJ_JOINT
    kinds = model.jnt_type
    for index in np.flatnonzero(kinds == BALL):
        raise refuse(name_of(model, joint, index), "a ball joint turns its body out of any plane")
    hinges, slides = np.flatnonzero(kinds == HINGE), np.flatnonzero(kinds == SLIDE)
    normal = data.xaxis[hinges[0]].copy() if len(hinges) else _without_hinges(model, data, slides)
    normal = _nearest_axis(normal / np.linalg.norm(normal))
    largest = int(np.argmax(np.abs(normal)))
    # Seen from the side that leaves x to the right: z out of the plane, or y into it.
    if normal[largest] * (-1 if largest == 1 else 1) < 0:
        normal = -normal
    more = "; if rounding in the file makes that, give its angles and quaternions with six digits or more"
    for index in hinges:
        if (off := float(np.linalg.norm(np.cross(normal, data.xaxis[index])))) > PRINTED:
            first = name_of(model, joint, int(hinges[0]))
            words = f"it is not parallel to {first}, but {off:.2g} rad off: this model moves in no plane"
            raise refuse(name_of(model, joint, index), words + more * (off < ROUGH))
    for index in slides:
        if (off := abs(float(normal @ data.xaxis[index]))) > PRINTED:
            words = f"it slides out of the plane in which the others move, by {off:.2g} rad"
            raise refuse(name_of(model, joint, index), words + more * (off < ROUGH))
    upward = np.array([0.0, 1.0, 0.0]) if abs(normal[2]) > 1 - PLANAR else np.array([0.0, 0.0, 1.0])
    up = upward - (upward @ normal) * normal
    up /= np.linalg.norm(up)
    return Frame(np.cross(up, normal), up, normal)


def _nearest_axis(normal: Array) -> Array:
    """A unit vector, or the axis of the world that it is but for the rounding of a file."""
    axis = np.round(normal)
    return axis if np.linalg.norm(normal - axis) <= PRINTED else normal


def flattened(model: Any, frame: Frame) -> tuple[Any, float]:
    """A copy whose joints move exactly in the plane, and by how much those of the model are tilted [rad].

    Only the joints' axes are turned, where qpos0 places them: the bodies then stay at their heights above the plane.
    """
    flat, data = copy.copy(model), mujoco.MjData(model)
    data.qpos[:] = model.qpos0
    mujoco.mj_kinematics(model, data)
    tilt = 0.0
    for joint in np.flatnonzero((model.jnt_type == HINGE) | (model.jnt_type == SLIDE)):
        axis, along = data.xaxis[joint], float(data.xaxis[joint] @ frame.normal)
        wanted = np.sign(along) * frame.normal if model.jnt_type[joint] == HINGE else axis - along * frame.normal
        wanted /= np.linalg.norm(wanted)
        tilt = max(tilt, float(np.linalg.norm(np.cross(wanted, axis))))
        flat.jnt_axis[joint] = data.xmat[model.jnt_bodyid[joint]].reshape(3, 3).T @ wanted
    return flat, tilt


def _without_hinges(model: Any, data: Any, slides: Any) -> Array:
    """A normal across all slides and gravity."""
    axes = np.array([data.xaxis[index] for index in slides]).reshape(-1, 3)
    if np.linalg.matrix_rank(axes, tol=PLANAR) == 2:  # they are a plane, whatever pulls across it
        return np.asarray(np.linalg.svd(axes)[2][-1])
    vectors = [data.xaxis[index] for index in slides] + ([model.opt.gravity] if np.any(model.opt.gravity) else [])
    spanned = np.linalg.svd(np.array(vectors).reshape(-1, 3))
    rank = int(np.sum(spanned[1] > PLANAR * max(1.0, *spanned[1]))) if len(vectors) else 0
    if rank == 3:
        raise refuse("its slides and gravity", "they lie in no common plane")
    candidates = [np.array(axis) for axis in ((0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0))]
    for axis in candidates:
        if all(abs(axis @ vector) <= PLANAR * np.linalg.norm(vector) for vector in vectors):
            return axis
    return np.array(spanned[2][-1])


@dataclass(frozen=True, eq=False)
class Groups:
    """What moves as one: `of` (nbody,) is the index among the mechanism's bodies, -1 for the ground.

    `roots`: MuJoCo's own body of each, that which has the joints. `centres` (bodies, 3) [m] in the frames of the roots.
    `angles` (bodies,) [rad] at t = 0: the sum of the hinges up to the ground.
    """

    of: Array
    roots: tuple[int, ...]
    centres: Array
    names: tuple[str, ...]
    masses: Array
    inertias: Array
    angles: Array

    def name(self, body: int) -> str | None:
        """Of the group of MuJoCo's body."""
        index = int(self.of[body])
        return None if index < 0 else self.names[index]


def find_groups(model: Any, data: Any, frame: Frame) -> Groups:
    """Bodies merged with those that are fixed to them."""
    roots = [body for body in range(1, model.nbody) if model.body_jntnum[body] > 0]
    if not roots:
        raise refuse("the model", "nothing in it can move")
    if len(roots) > MOST_BODIES:
        raise refuse("the model", f"it has {len(roots)} moving bodies; the judge takes up to {MOST_BODIES}")
    of = np.full(model.nbody, -1)
    for body in range(1, model.nbody):
        of[body] = roots.index(body) if model.body_jntnum[body] else of[model.body_parentid[body]]
    masses, inertias, centres = np.zeros(len(roots)), np.zeros(len(roots)), np.zeros((len(roots), 3))
    for index, root in enumerate(roots):
        own = np.flatnonzero(of == index)
        mass = model.body_mass[own]
        masses[index] = mass.sum()
        name = name_of(model, mujoco.mjtObj.mjOBJ_BODY, root)
        if not masses[index] > 0:
            raise refuse(name, "it has no mass")
        centre = mass @ data.xipos[own] / masses[index]
        tensor = np.zeros((3, 3))
        for body in own:
            turn = data.ximat[body].reshape(3, 3)
            arm = data.xipos[body] - centre
            tensor += turn @ np.diag(model.body_inertia[body]) @ turn.T
            tensor += model.body_mass[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
        inertias[index] = frame.normal @ tensor @ frame.normal
        if not inertias[index] > 0:
            raise refuse(name, "its inertia about the normal of the plane is zero")
        centres[index] = data.xmat[root].reshape(3, 3).T @ (centre - data.xpos[root])
        if FREE in _kinds(model, root):
            _refuse_free_body_out_of_plane(frame, tensor, inertias[index], name)
    names = tuple(plain_name(model, mujoco.mjtObj.mjOBJ_BODY, root) for root in roots)
    groups = Groups(of, tuple(roots), centres, names, masses, inertias, np.zeros(len(roots)))
    groups.angles[:] = angles_of(model, frame, groups, data.qpos[None])[0]
    return groups


def _kinds(model: Any, body: int) -> list[int]:
    begin = int(model.body_jntadr[body])
    return [int(model.jnt_type[index]) for index in range(begin, begin + int(model.body_jntnum[body]))]


def _refuse_free_body_out_of_plane(frame: Frame, tensor: Array, inertia: float, name: str) -> None:
    tilted = tensor @ frame.normal - inertia * frame.normal
    if np.linalg.norm(tilted) > PLANAR * inertia:
        raise refuse(name, "it is free, and the normal of the plane is no principal axis of its inertia")


def angles_of(model: Any, frame: Frame, groups: Groups, qpos: Array) -> Array:
    """Angles (times, bodies) [rad], not wrapped, of positions (times, nq)."""
    angles = np.zeros((len(qpos), len(groups.roots)))
    for index, root in enumerate(groups.roots):
        parent = int(groups.of[model.body_parentid[root]])
        if parent >= 0:
            angles[:, index] = angles[:, parent]
        begin = int(model.body_jntadr[root])
        for joint in range(begin, begin + int(model.body_jntnum[root])):
            place = int(model.jnt_qposadr[joint])
            if model.jnt_type[joint] == HINGE:
                angles[:, index] += _hinge_sign(model, frame, groups, joint) * qpos[:, place]
            elif model.jnt_type[joint] == FREE:
                angles[:, index] += np.unwrap(2 * np.arctan2(*_turn(model, frame, place + 3, qpos)))
    return angles


def _turn(model: Any, frame: Frame, place: int, qpos: Array) -> tuple[Array, Array]:
    """Sine and cosine (times,) of half the angle by which a quaternion has turned about the normal since qpos0."""
    now, begin = qpos[:, place : place + 4], model.qpos0[place : place + 4]
    vector = now[:, 1:] * begin[0] - now[:, :1] * begin[1:] - np.cross(now[:, 1:], begin[1:])
    if np.abs(vector @ frame.both.T).max() > PLANAR:
        raise refuse("a free joint", "its body is turned out of the plane in what MuJoCo makes of the motion")
    return vector @ frame.normal, now @ begin


def _hinge_sign(model: Any, frame: Frame, groups: Groups, joint: int) -> float:
    """From the model alone: every turn before this joint is about the normal and leaves its axis as it is."""
    body = int(model.jnt_bodyid[joint])
    axis = model.jnt_axis[joint].copy()
    while body > 0:
        turned = np.zeros(3)
        mujoco.mju_rotVecQuat(turned, axis, model.body_quat[body])
        begin = int(model.body_jntadr[body])
        if begin >= 0 and FREE in _kinds(model, body):
            turned = axis  # the quaternion of a free joint replaces that of the body; its turns leave the normal
            mujoco.mju_rotVecQuat(turned := np.zeros(3), axis, model.qpos0[int(model.jnt_qposadr[begin]) + 3 :][:4])
        axis, body = turned, int(model.body_parentid[body])
    return float(np.sign(axis @ frame.normal))


def bodies_of(model: Any, data: Any, frame: Frame, groups: Groups) -> tuple[Body, ...]:
    """The mechanism's bodies in the state of `data`."""
    out = []
    for index, root in enumerate(groups.roots):
        place = data.xpos[root] + data.xmat[root].reshape(3, 3) @ groups.centres[index]
        moving, turning = np.zeros((3, model.nv)), np.zeros((3, model.nv))
        mujoco.mj_jac(model, data, moving, turning, place, root)
        speed, rate = moving @ data.qvel, turning @ data.qvel
        span = np.linalg.norm(speed) + np.linalg.norm(rate)
        if abs(speed @ frame.normal) > PLANAR * span or np.linalg.norm(frame.both @ rate) > PLANAR * span:
            raise refuse(name_of(model, mujoco.mjtObj.mjOBJ_BODY, root), "it moves out of the plane at the start")
        pose = (*frame.in_plane(place), float(groups.angles[index]))
        twist = (*frame.in_plane(speed), float(rate @ frame.normal))
        out.append(Body(groups.names[index], float(groups.masses[index]), float(groups.inertias[index]), pose, twist))
    return tuple(out)
