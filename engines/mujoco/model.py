"""MuJoCo's model of a mechanism: a tree of planar joints, loops closed by `connect`, a driven joint; shapes for contact
alone.

`connect` has three rows; out of the plane nothing can move, so the third row is empty and harmless.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.mujoco.construction import Building, Hooks, in_turn
from engines.mujoco.joints.roll import RollBy
from engines.mujoco.joints.skate import SkateBy, add_skates
from engines.mujoco.joints.slot import SlotBy, add_slots
from engines.mujoco.stiffness import Stiffness
from engines.mujoco.tree import Tree, spanning_tree, world_offset
from engines.mujoco.written_rows import add_placeholders, installed, row_writer, writing
from reference.joints import Drive, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

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
    hooks: Hooks = field(default_factory=Hooks)
    rows: int = 0  # scalar constraints held by forces, drives not counted
    written: bool = False  # some of them by callback: the dual solver can't serve them
    start_rates: tuple[tuple[int, float], ...] = ()  # of coordinates that stand for no body of the mechanism

    def hooked(self) -> AbstractContextManager[None]:
        """The callbacks in place while this is entered: every step and every reading needs them."""
        return installed(in_turn(self.hooks.control), in_turn(self.hooks.passive))

    def loads(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses and inertias (bodies, 3) [kg, kg, kg m^2] and gravity (2,) [m/s^2], as the compiled model has them."""
        compiled = self.compiled
        places = [compiled.body(f"body {index}").id for index in range(len(self.mechanism.bodies))]
        mass, inertia = compiled.body_mass[places], compiled.body_inertia[places, 2]
        return np.stack([mass, mass, inertia], axis=-1), compiled.opt.gravity[:2].copy()

    def start(self) -> Any:
        """A fresh mujoco.MjData at the mechanism's start, its derived quantities computed."""
        data = mujoco.MjData(self.compiled)
        data.qvel[self.address] = self.tree.start_rates()
        for driven in self.driven:
            data.qvel[self.address[driven.column]] = driven.rate
        if self.drive == "servo":
            data.ctrl[: len(self.driven)] = [driven.rate for driven in self.driven]
        for place, rate in self.start_rates:
            data.qvel[place] = rate
        with self.hooked():
            for prepare in (*self.hooks.before, *self.hooks.start, *self.hooks.before):
                prepare(self.compiled, data)
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
    slots: SlotBy,
    skates: SkateBy,
    rolls: RollBy,
) -> Model:
    """Compile a mechanism for steps of dt [s]. Raises Unsupported for a joint with no counterpart here."""
    hanging: list[Pin | Slot] = []
    drives: list[Drive] = []
    skating: list[Skate] = []
    rolling: list[Roll] = []
    for joint in mechanism.joints:
        match joint:
            case Pin() | Slot():
                hanging.append(joint)
            case Drive():
                drives.append(joint)
            case Skate():
                skating.append(joint)
            case Roll():
                rolling.append(joint)
            case _:
                raise Unsupported(f"joint {joint.name!r} is a {type(joint).__name__}; MuJoCo has no such joint")
    tree = spanning_tree(mechanism, hanging if coordinates == "tree" else ())
    drives = [joint for joint in drives if joint not in tree.kept]
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
    pins = [joint for joint in tree.loops if isinstance(joint, Pin)]
    for pin in pins:
        _add_loop(spec, mechanism, pin, stiffness.reference(mechanism, dt), stiffness.impedance)
    building = Building(spec, mechanism, tree, dt, stiffness, tuple(one.column for one in driven))
    add_slots(building, [joint for joint in tree.loops if isinstance(joint, Slot)], slots)
    add_skates(building, skating, skates)
    if rolling:
        rolls.add(building, rolling)
    # The placeholders come last: what stands before them in the solver is then known.
    add_placeholders(spec, tree, building.written, stiffness.impedance, building.driven)
    if building.contact:
        spec.option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    written = bool(building.written) or building.rewritten
    dense = spec.option.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    if written and not (dense and spec.option.disableflags & int(mujoco.mjtDisableBit.mjDSBL_ISLAND)):
        raise Unsupported(
            "rows written in a callback need jacobian='dense' and islands=False: others are read elsewhere"
        )
    try:
        compiled = spec.compile()
    except ValueError as error:
        raise Unsupported(f"MuJoCo refuses this mechanism: {' '.join(str(error).split())}") from error
    address = [compiled.joint(f"coordinate {column}").qposadr[0] for column in range(tree.coordinates)]
    _scale_tolerance_by_true_inertia(compiled, [int(address[one.column]) for one in driven])
    for scale in (compiled.body_invweight0, compiled.dof_invweight0, compiled.tendon_invweight0):
        scale[:] *= stiffness.softening  # connects, joints, tendons
    places = [int(a) for a in address]
    hooks = sum((bind(compiled, places) for bind in building.binders), Hooks())
    if building.written:
        rows = row_writer(tree, places, building.written)
        before = 3 * len(pins) + sum(int(kind != mujoco.mjtEq.mjEQ_CONNECT) for kind in compiled.eq_type)
        before -= sum(joint.size for joint in building.written)
        hooks += Hooks(control=(writing(rows, before, compiled.nv),))
    held = 2 * len(pins) + building.size + sum(joint.size for joint in building.written)
    rates = tuple((int(compiled.joint(name).dofadr[0]), rate) for name, rate in building.start_rates.items())
    return Model(mechanism, tree, compiled, places, driven, drive, hooks, held, written, rates)


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
        axes = {"free": [(1.0, 0.0), (0.0, 1.0)], "slot": [link.direction], "hinge": []}[link.kind]
        for column, axis in zip(link.columns, axes, strict=False):
            slide = mujoco.mjtJoint.mjJNT_SLIDE
            added.add_joint(name=f"coordinate {column}", type=slide, axis=[*axis, 0.0])
        if link.rotation is not None:
            hinge, anchor = mujoco.mjtJoint.mjJNT_HINGE, [*link.anchor, 0.0]
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
