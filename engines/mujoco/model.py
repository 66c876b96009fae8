"""MuJoCo's model of a mechanism: a tree of planar joints, loops closed by `connect`, a driven joint; no shapes.

`connect` has three rows; out of the plane nothing can move, so the third row is empty and harmless.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

import mujoco

from engines import Unsupported
from engines.mujoco.stiffness import Stiffness
from engines.mujoco.tree import Tree, spanning_tree, world_offset
from reference.joints import Drive, Pin
from reference.mechanism import Mechanism

Coordinates = Literal["tree", "free"]
DriveBy = Literal["inertia", "servo", "overwrite"]


@dataclass(frozen=True)
class DrivenCoordinate:
    """A tree coordinate that turns at a prescribed rate [rad/s]."""

    column: int
    rate: float


@dataclass(frozen=True)
class Model:
    """A compiled model and what our columns are in it."""

    mechanism: Mechanism
    tree: Tree
    compiled: Any  # mujoco.MjModel
    address: list[int]  # where each tree coordinate stands in qpos, and in qvel
    driven: tuple[DrivenCoordinate, ...]
    drive: DriveBy

    def start(self) -> Any:
        """A fresh mujoco.MjData at the mechanism's start, its derived quantities computed."""
        data = mujoco.MjData(self.compiled)
        data.qvel[self.address] = self.tree.start_rates()
        for driven in self.driven:
            data.qvel[self.address[driven.column]] = driven.rate
        if self.drive == "servo":
            data.ctrl[:] = [driven.rate for driven in self.driven]
        mujoco.mj_forward(self.compiled, data)
        return data


def build_model(
    mechanism: Mechanism,
    dt: float,
    *,
    options: dict[str, Any],
    disable: int,
    stiffness: Stiffness,
    coordinates: Coordinates,
    drive: DriveBy,
    armature: float,
    servo_gain: float,
) -> Model:
    """Compile a mechanism for steps of dt [s]. Raises Unsupported for a joint with no counterpart here."""
    pins: list[Pin] = []
    drives: list[Drive] = []
    for joint in mechanism.joints:
        match joint:
            case Pin():
                pins.append(joint)
            case Drive():
                drives.append(joint)
            case _:
                raise Unsupported(f"joint {joint.name!r} is a {type(joint).__name__}; MuJoCo has no such joint")
    tree = spanning_tree(mechanism, pins if coordinates == "tree" else ())
    driven = tuple(_driven_coordinate(tree, joint) for joint in drives)
    for index, one in enumerate(driven):
        if one.column in [other.column for other in driven[:index]]:
            raise Unsupported(f"drive {drives[index].name!r} turns a joint that another drive turns already")

    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = dt
    spec.option.gravity = [*mechanism.gravity, 0.0]
    spec.option.disableflags = disable
    for name, value in options.items():
        setattr(spec.option, name, value)
    _add_bodies(spec, tree)
    if drive == "inertia":
        for one in driven:
            spec.joint(f"coordinate {one.column}").armature = armature * _inertia_scale(mechanism)
    if drive == "servo":
        for one in driven:
            actuator = spec.add_actuator(target=f"coordinate {one.column}", trntype=mujoco.mjtTrn.mjTRN_JOINT)
            actuator.set_to_velocity(servo_gain)
    for pin in tree.loops:
        _add_loop(spec, mechanism, pin, stiffness.reference(mechanism, dt), stiffness.impedance)
    try:
        compiled = spec.compile()
    except ValueError as error:
        raise Unsupported(f"MuJoCo refuses this mechanism: {' '.join(str(error).split())}") from error
    address = [compiled.joint(f"coordinate {column}").qposadr[0] for column in range(tree.coordinates)]
    _scale_tolerance_by_true_inertia(compiled, [int(address[one.column]) for one in driven])
    compiled.body_invweight0[:] *= stiffness.softening
    return Model(mechanism, tree, compiled, [int(a) for a in address], driven, drive)


def _driven_coordinate(tree: Tree, joint: Drive) -> DrivenCoordinate:
    found = tree.rotation_of(joint.first, joint.second)
    if found is None:
        first, second = (repr(name) if name else "the ground" for name in (joint.first, joint.second))
        raise Unsupported(
            f"drive {joint.name!r}: the rotation of {second} against {first} is no coordinate of MuJoCo's tree here, "
            "and only a coordinate can be driven"
        )
    column, sign = found
    return DrivenCoordinate(column, sign * joint.turning_rate)


def _inertia_scale(mechanism: Mechanism) -> float:
    """About the largest inertia that a joint of the mechanism can feel [kg m^2]."""
    return sum(body.inertia + body.mass * mechanism.length_scale**2 for body in mechanism.bodies)


def _add_bodies(spec: Any, tree: Tree) -> None:
    mechanism, placed = tree.mechanism, {}
    for link in tree.links:
        body = mechanism.bodies[link.body]
        base = (0.0, 0.0) if link.parent is None else mechanism.bodies[link.parent].pose[:2]
        parent = spec.worldbody if link.parent is None else placed[link.parent]
        added = parent.add_body(
            name=f"body {link.body}",
            pos=[body.pose[0] - base[0], body.pose[1] - base[1], 0.0],
            ipos=[0.0, 0.0, 0.0],  # left alone, MuJoCo puts the centre of mass at `pos` once more
            mass=body.mass,
            inertia=[body.inertia] * 3,  # only the last is felt in the plane; equal ones satisfy MuJoCo's checks
            explicitinertial=True,
        )
        placed[link.body] = added
        if not link.hinged:
            for column, axis in ((link.column, [1.0, 0.0, 0.0]), (link.column + 1, [0.0, 1.0, 0.0])):
                added.add_joint(name=f"coordinate {column}", type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis)
        hinge = mujoco.mjtJoint.mjJNT_HINGE
        anchor = [*link.anchor, 0.0]
        added.add_joint(name=f"coordinate {link.rotation}", type=hinge, axis=[0.0, 0.0, 1.0], pos=anchor)


def _add_loop(
    spec: Any, mechanism: Mechanism, pin: Pin, reference: tuple[float, ...], impedance: tuple[float, ...]
) -> None:
    """A `connect`, bound by MuJoCo in the assembled start pose. Its force acts on `name1`: here the second body."""
    names = ["world" if name is None else f"body {mechanism.body_index(name)}" for name in (pin.first, pin.second)]
    name, point = (pin.second, pin.second_point) if pin.second is not None else (pin.first, pin.first_point)
    if pin.second is None:
        names.reverse()  # the anchor is given in the frame of name1; on a body it stays as exact as the body's frame
    x, y = world_offset(mechanism, name, point)
    loop = spec.add_equality(
        type=mujoco.mjtEq.mjEQ_CONNECT,
        objtype=mujoco.mjtObj.mjOBJ_BODY,
        name1=names[1],
        name2=names[0],
        solref=list(reference),
        solimp=list(impedance),
    )
    loop.data[:3] = [x, y, 0.0]


def _scale_tolerance_by_true_inertia(compiled: Any, driven: list[int]) -> None:
    """MuJoCo measures its solver's tolerance by the mean inertia, which a driven armature would make useless."""
    if not driven:
        return
    free = [index for index in range(compiled.nv) if index not in driven]
    compiled.stat.meaninertia = float(compiled.dof_M0[free].mean()) if free else 1.0
