"""The plane in which the joints of a MuJoCo model move its bodies, and the bodies of the model in this plane.

A body without joints is merged with its parent. Positions normal to the plane and products of inertia do not affect the
motion, since joints keep the bodies in the plane.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines.reading import MOST_BODIES, Names, Note, refuse
from reference.joints import Body, Joint, Vector

Array = NDArray[np.float64]
PLANAR = 1e-9  # Largest rounding of a component, relative to a unit vector or an inertia.
# Largest tilt [rad] of an axis that counts as normal to the plane. Rounding to six digits tilts an axis by 2e-6. An
# angle of 1.57 tilts it by 8e-4 and is refused.
MAX_TILT = 1e-4
MAX_ROUNDED_TILT = 1e-2  # largest tilt [rad] for which a message mentions rounding in the file

BODY, JOINT = mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_JOINT
FREE, BALL, SLIDE, HINGE = (
    int(getattr(mujoco.mjtJoint, f"mjJNT_{kind}")) for kind in ("FREE", "BALL", "SLIDE", "HINGE")
)


@dataclass(frozen=True, eq=False)
class Frame:
    across: Array  # Along x.
    up: Array  # Along y.
    normal: Array  # Angles are positive about the normal.

    @cached_property
    def both(self) -> Array:
        """The matrix (2, 3) from a vector of the world to x and y of the plane."""
        return np.array([self.across, self.up])

    def in_plane(self, vector: Any) -> tuple[float, float]:
        x, y = self.both @ np.asarray(vector)
        return float(x), float(y)


def name_of(model: Any, kind: Any, index: Any) -> str:
    """The kind of an element and its name, or its number if it has no name."""
    word = str(kind).rsplit("_", 1)[-1].lower()
    name = mujoco.mj_id2name(model, kind, int(index))
    return f"{word} {name!r}" if name else f"{word} {index}"


def plain_name(model: Any, kind: Any, index: int) -> str:
    return mujoco.mj_id2name(model, kind, index) or name_of(model, kind, index)


def find_frame(model: Any, data: Any) -> Frame:
    """The plane in which every joint moves its body. Raises Unsupported if the bodies do not move in one plane."""
    kinds = model.jnt_type
    for index in np.flatnonzero(kinds == BALL):
        raise refuse(name_of(model, JOINT, index), "a ball joint turns its body out of any plane")
    hinges, slides = np.flatnonzero(kinds == HINGE), np.flatnonzero(kinds == SLIDE)
    normal = data.xaxis[hinges[0]].copy() if len(hinges) else _normal_to_slides(model, data, slides)
    normal = _nearest_axis(normal / np.linalg.norm(normal))
    largest = int(np.argmax(np.abs(normal)))
    # The largest component of the normal is along +x, -y or +z, so that x of the plane is to the right.
    if normal[largest] * (-1 if largest == 1 else 1) < 0:
        normal = -normal
    _refuse_tilted_joints(model, data, normal)
    upward = np.array([0.0, 1.0, 0.0]) if abs(normal[2]) > 1 - PLANAR else np.array([0.0, 0.0, 1.0])
    up = upward - (upward @ normal) * normal
    up /= np.linalg.norm(up)
    return Frame(np.cross(up, normal), up, normal)


def _refuse_tilted_joints(model: Any, data: Any, normal: Array) -> None:
    hinges = np.flatnonzero(model.jnt_type == HINGE)
    for index in np.flatnonzero((model.jnt_type == HINGE) | (model.jnt_type == SLIDE)):
        is_hinge = model.jnt_type[index] == HINGE
        axis = data.xaxis[index]
        tilt = float(np.linalg.norm(np.cross(normal, axis))) if is_hinge else abs(float(normal @ axis))
        if tilt <= MAX_TILT:
            continue
        if is_hinge:
            first = name_of(model, JOINT, int(hinges[0]))
            reason = f"it is not parallel to {first}, but {tilt:.2g} rad off: this model moves in no plane"
        else:
            reason = f"it slides out of the plane in which the others move, by {tilt:.2g} rad"
        if tilt < MAX_ROUNDED_TILT:
            reason += "; if rounding in the file makes that, give its angles and quaternions with six digits or more"
        raise refuse(name_of(model, JOINT, index), reason)


def _nearest_axis(normal: Array) -> Array:
    """The axis of the world within MAX_TILT of a unit vector, or the vector if no axis is so near."""
    axis = np.round(normal)
    return axis if np.linalg.norm(normal - axis) <= MAX_TILT else normal


def flattened(model: Any, frame: Frame) -> tuple[Any, float]:
    """A copy of the model whose joints move exactly in the plane, and the largest tilt [rad] of the original joints.

    The axes are corrected at qpos0, so that the bodies keep their heights above the plane.
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


def _normal_to_slides(model: Any, data: Any, slides: Any) -> Array:
    """A vector perpendicular to all slides, and also to gravity unless two slides span the plane."""
    axes = data.xaxis[slides].reshape(-1, 3)
    is_spanned = np.linalg.matrix_rank(axes, tol=PLANAR) == 2
    vectors = axes if is_spanned else np.vstack([axes, model.opt.gravity])
    _, sizes, directions = np.linalg.svd(vectors)
    if np.sum(sizes > PLANAR * max(1.0, *sizes)) == 3:
        raise refuse("its slides and gravity", "they lie in no common plane")
    for axis in np.array([(0.0, 0.0, 1.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0)]):
        if np.all(np.abs(vectors @ axis) <= PLANAR * np.linalg.norm(vectors, axis=1)):
            return axis
    return np.asarray(directions[-1])


@dataclass(frozen=True, eq=False)
class Groups:
    of: Array  # The group of each MuJoCo body (nbody,), -1 for the ground.
    roots: tuple[int, ...]  # MuJoCo body with the group's joints, by group.
    centres: Array  # Centres of mass (groups, 3) [m] in the frames of `roots`.
    signs: Array  # 1 if the axis of a joint (njnt,) is along the normal, and -1 for the opposite direction.


def find_bodies(model: Any, data: Any, frame: Frame) -> tuple[Groups, tuple[Body, ...]]:
    """The groups of MuJoCo's bodies, and the mechanism's bodies in the state of `data`; raises Unsupported."""
    roots = [int(body) for body in np.flatnonzero(model.body_jntnum)]
    if not roots:
        raise refuse("the model", "nothing in it can move")
    if len(roots) > MOST_BODIES:
        raise refuse("the model", f"it has {len(roots)} moving bodies; the judge takes up to {MOST_BODIES}")
    of = np.full(model.nbody, -1)
    for body in range(1, model.nbody):
        of[body] = roots.index(body) if model.body_jntnum[body] else of[model.body_parentid[body]]
    groups = Groups(of, tuple(roots), np.zeros((len(roots), 3)), np.sign(data.xaxis @ frame.normal))
    angles = angles_of(model, frame, groups, data.qpos[None])[0]
    return groups, tuple(_body(model, data, frame, groups, index, float(angle)) for index, angle in enumerate(angles))


def _body(model: Any, data: Any, frame: Frame, groups: Groups, index: int, angle: float) -> Body:
    root, parts = groups.roots[index], np.flatnonzero(groups.of == index)
    element, masses = name_of(model, BODY, root), model.body_mass[parts]
    if not masses.sum() > 0:
        raise refuse(element, "it has no mass")
    centre = masses @ data.xipos[parts] / masses.sum()
    tensor = np.zeros((3, 3))
    for body in parts:
        turn, arm = data.ximat[body].reshape(3, 3), data.xipos[body] - centre
        tensor += turn @ np.diag(model.body_inertia[body]) @ turn.T
        tensor += model.body_mass[body] * (arm @ arm * np.eye(3) - np.outer(arm, arm))
    inertia = frame.normal @ tensor @ frame.normal
    if not inertia > 0:
        raise refuse(element, "its inertia about the normal of the plane is zero")
    tilted = np.linalg.norm(tensor @ frame.normal - inertia * frame.normal)
    if model.jnt_type[model.body_jntadr[root]] == FREE and tilted > PLANAR * inertia:
        raise refuse(element, "it is free, and the normal of the plane is no principal axis of its inertia")
    rotation = data.xmat[root].reshape(3, 3)
    groups.centres[index] = rotation.T @ (centre - data.xpos[root])
    centre = data.xpos[root] + rotation @ groups.centres[index]  # the same rounding as in later states
    moving, turning = np.zeros((2, 3, model.nv))
    mujoco.mj_jac(model, data, moving, turning, centre, root)
    speed, rate = moving @ data.qvel, turning @ data.qvel
    span = np.linalg.norm(speed) + np.linalg.norm(rate)
    if abs(speed @ frame.normal) > PLANAR * span or np.linalg.norm(frame.both @ rate) > PLANAR * span:
        raise refuse(element, "it moves out of the plane at the start")
    twist = (*frame.in_plane(speed), float(rate @ frame.normal))
    name = plain_name(model, BODY, root)
    return Body(name, float(masses.sum()), float(inertia), (*frame.in_plane(centre), angle), twist)


def angles_of(model: Any, frame: Frame, groups: Groups, qpos: Array) -> Array:
    """Unwrapped angles (times, groups) [rad] for `qpos` (times, nq)."""
    angles = np.zeros((len(qpos), len(groups.roots)))
    for index, root in enumerate(groups.roots):
        parent, first = int(groups.of[model.body_parentid[root]]), int(model.body_jntadr[root])
        if parent >= 0:
            angles[:, index] = angles[:, parent]
        for joint in range(first, first + int(model.body_jntnum[root])):
            address = int(model.jnt_qposadr[joint])
            if model.jnt_type[joint] == HINGE:
                angles[:, index] += groups.signs[joint] * qpos[:, address]
            elif model.jnt_type[joint] == FREE:
                angles[:, index] += np.unwrap(2 * np.arctan2(*_half_angle(model, frame, address + 3, qpos)))
    return angles


def _half_angle(model: Any, frame: Frame, address: int, qpos: Array) -> tuple[Array, Array]:
    """Sine and cosine (times,) of half the rotation from qpos0 to the quaternion at an address.

    Raises Unsupported for a rotation out of the plane.
    """
    quaternion, start = qpos[:, address : address + 4], model.qpos0[address : address + 4]
    vector = quaternion[:, 1:] * start[0] - quaternion[:, :1] * start[1:] - np.cross(quaternion[:, 1:], start[1:])
    if np.abs(vector @ frame.both.T).max() > PLANAR:
        raise refuse("a free joint", "its body is turned out of the plane in what MuJoCo makes of the motion")
    return vector @ frame.normal, quaternion @ start


@dataclass(eq=False)
class PlanarModel:
    model: Any
    data: Any
    frame: Frame
    groups: Groups
    bodies: tuple[Body, ...]
    names: Names = field(default_factory=Names)
    notes: list[Note] = field(default_factory=list)
    held: dict[int, tuple[Joint, ...]] = field(default_factory=dict)  # ideal joints by index of the equality

    def group(self, body: int) -> int:
        return int(self.groups.of[body])

    def group_of(self, joint: int) -> int:
        return self.group(self.model.jnt_bodyid[joint])

    def parent(self, joint: int) -> int:
        return self.group(self.model.body_parentid[self.model.jnt_bodyid[joint]])

    def name(self, group: int) -> str | None:
        return None if group < 0 else self.bodies[group].name

    def angle(self, group: int) -> float:
        return 0.0 if group < 0 else self.bodies[group].pose[2]

    def turned(self, first: int, second: int) -> float:
        return self.angle(second) - self.angle(first)

    def in_body(self, group: int, point: Any) -> Vector:
        """The coordinates [m] of a point (3,) of the world in the frame of a group or the ground."""
        x, y = self.frame.in_plane(point)
        if group < 0:
            return x, y
        at_x, at_y, angle = self.bodies[group].pose
        cosine, sine = np.cos(angle), np.sin(angle)
        x, y = x - at_x, y - at_y
        return float(cosine * x + sine * y), float(cosine * y - sine * x)

    def between(self, first: int, second: int, at: Any, other: Any) -> tuple[str | None, str | None, Vector, Vector]:
        return self.name(first), self.name(second), self.in_body(first, at), self.in_body(second, other)

    def direction(self, group: int, axis: Any) -> float:
        x, y = self.frame.in_plane(axis)
        return float(np.arctan2(y, x)) - self.angle(group)

    def centre(self, group: int) -> Array:
        """The initial centre of mass (3,) [m] of a group, projected on the plane through the origin."""
        return self.frame.both.T @ self.bodies[group].pose[:2]

    def joints_of(self, group: int, *kinds: int) -> list[int]:
        """The joints of some `kinds` between a group and its parent, by default of all kinds."""
        root = self.groups.roots[group]
        first = int(self.model.body_jntadr[root])
        joints = range(first, first + int(self.model.body_jntnum[root]))
        return [joint for joint in joints if not kinds or self.model.jnt_type[joint] in kinds]

    def qpos_of(self, joint: int) -> int:
        return int(self.model.jnt_qposadr[joint])

    def new_name(self, kind: Any, index: int) -> str:
        return self.names.new(plain_name(self.model, kind, index))

    def note(self, element: str, reason: str) -> None:
        self.notes.append(Note(element, reason))
