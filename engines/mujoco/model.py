"""MuJoCo's model of a mechanism: a tree of planar joints, and for every other joint what its own file makes of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import TYPE_CHECKING, Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.capability import Capability
from engines.mujoco.construction import Building, Hooks
from engines.mujoco.forces import add_forces
from engines.mujoco.joints.links import (
    DriveBy,
    DrivenCoordinate,
    add_geared_drives,
    add_gears,
    add_pins,
    add_rods,
    add_welds,
    driven_coordinates,
    inertia_scale,
)
from engines.mujoco.joints.roll import add_rolls
from engines.mujoco.joints.skate import add_skates
from engines.mujoco.joints.slot import add_slots
from engines.mujoco.releases import NO_ISLANDS
from engines.tree import Tree, spanning_tree
from engines.units import counted_in, power_of_two
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

Coordinates = Literal["tree", "free"]
CAPABILITY = Capability(
    "mujoco",
    frozenset({Pin, Weld, Gear, Rod, Slot, Drive, Skate, Roll}),
    frozenset({Spring, Damper, TorsionSpring, TorsionDamper, Torque, Force}),
)
LIGHTEST = 1e13  # units of mass in which a body's own mass and inertia are still far above mjMINVAL


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
    start_rates: Mapping[int, float] = field(default_factory=dict)  # of coordinates of no body of the mechanism
    unit: float = 1.0  # kg: masses, forces and torques in the compiled model are in this
    halves: tuple[tuple[str, int], ...] = ()  # bodies of the model alone, and the one that each is a part of
    spec: Any = None  # mujoco.MjSpec
    softening: float | None = None  # of its rows, where that is not what was asked for

    @contextmanager
    def hooked(self) -> Iterator[None]:
        """The callback in place while this is entered: every step and every reading needs it.

        MuJoCo's, which is global, is as it was afterwards, whatever happens.
        """
        before = mujoco.get_mjcb_control()
        mujoco.set_mjcb_control(self.hooks.control)
        try:
            yield
        finally:
            mujoco.set_mjcb_control(before)

    def loads(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses and inertias (bodies, 3) [kg, kg, kg m^2] and gravity (2,) [m/s^2], as the compiled model has them."""
        compiled = self.compiled
        places = [compiled.body(f"body {index}").id for index in range(len(self.mechanism.bodies))]
        mass, inertia = compiled.body_mass[places].copy(), compiled.body_inertia[places, 2].copy()
        for name, body in self.halves:
            half = compiled.body(name).id
            mass[body] += compiled.body_mass[half]
            inertia[body] += compiled.body_inertia[half, 2]
        return self.unit * np.stack([mass, mass, inertia], axis=-1), compiled.opt.gravity[:2].copy()

    def start(self) -> Any:
        """A fresh mujoco.MjData at the mechanism's start, its derived quantities computed."""
        data = mujoco.MjData(self.compiled)
        data.qvel[self.address] = self.tree.start_rates()
        for driven in self.driven:
            data.qvel[self.address[driven.column]] = driven.rate
        for place, rate in self.start_rates.items():
            data.qvel[place] = rate
        with self.hooked():
            if self.hooks.before:
                self.hooks.before(self.compiled, data)
            mujoco.mj_forward(self.compiled, data)
        return data


def build_model(
    mechanism: Mechanism, dt: float, settings: MuJoCo, options: Mapping[str, Any], unit: float | None = None
) -> Model:
    """Compile a mechanism for steps of dt [s].

    `options`: fields of MuJoCo's own options, by name; `unit`: that of mass [kg], if not `unit_of_mass`. Raises
    Unsupported for a joint with no counterpart here.
    """
    CAPABILITY.require(mechanism)
    whole, unit = mechanism, unit or unit_of_mass(mechanism)
    mechanism = counted_in(mechanism, unit)
    tree = spanning_tree(mechanism, hanging=settings.coordinates == "tree")

    def of(kind: type[Any], joints: Sequence[Any] = mechanism.joints) -> list[Any]:
        return [joint for joint in joints if isinstance(joint, kind)]

    single = [joint for joint in of(Drive) if joint not in (*tree.kept, *tree.geared)]
    driven = driven_coordinates(tree, single)
    spec = _spec(tree, dt, settings.islands, options)
    if settings.drive == "inertia":
        for coordinate in driven:
            spec.joint(f"coordinate {coordinate.column}").armature = settings.armature * inertia_scale(mechanism)
    building = Building(spec, mechanism, tree, dt, settings.stiffness)
    add_pins(building, of(Pin, tree.loops))
    add_slots(building, of(Slot, tree.loops), settings.slots)
    add_welds(building, of(Weld, tree.loops))
    add_rods(building, of(Rod), settings.rods)
    add_gears(building, of(Gear))
    add_forces(building)
    clocks = add_geared_drives(building, tree.geared, settings.drive, settings.armature)
    add_skates(building, of(Skate), settings.skates)
    add_rolls(building, of(Roll), settings.rolls)
    written = building.written
    if written:
        # The placeholders come last: what stands before them in the solver is then known.
        user_rows().add_placeholders(building)
    compiled = _compiled(building)
    places = [int(compiled.joint(f"coordinate {column}").qposadr[0]) for column in range(tree.coordinates)]
    rates = {int(compiled.joint(name).dofadr[0]): rate for name, rate in building.start_rates.items()}
    steady = [*(places[one.column] for one in driven), *(int(compiled.joint(clock).dofadr[0]) for clock in clocks)]
    _scale_tolerance_by_free_inertia(compiled, steady)
    multiply_compliances(compiled, settings.stiffness.softening)
    hooks = sum((bind(compiled, places) for bind in building.binders), Hooks())
    if written:
        hooks += Hooks(user_rows().row_callback(compiled, tree, places, written, settings.stiffness.softening))
    return Model(
        whole,
        tree,
        compiled,
        places,
        driven,
        settings.drive,
        hooks,
        rows=building.size + sum(joint.size for joint in written),
        written=bool(written),
        start_rates=rates,
        unit=unit,
        halves=tuple(building.halves),
        spec=spec,
    )


def multiply_compliances(compiled: Any, factor: float) -> None:
    """Multiply the compliances of the rows of connects, joints and tendons."""
    for scale in (compiled.body_invweight0, compiled.dof_invweight0, compiled.tendon_invweight0):
        scale[:] *= factor


def _spec(tree: Tree, dt: float, islands: bool, options: Mapping[str, Any]) -> Any:
    """A mujoco.MjSpec with the options and the bodies of the tree, and nothing else."""
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = dt
    spec.option.gravity = [*tree.mechanism.gravity, 0.0]
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | (0 if islands else NO_ISLANDS)
    for name, value in options.items():
        setattr(spec.option, name, value)
    _add_bodies(spec, tree)
    return spec


def _compiled(building: Building) -> Any:
    """The mujoco.MjModel. Raises Unsupported where MuJoCo refuses it, or would not read what callbacks write."""
    option = building.spec.option
    if building.contact:
        option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    dense = option.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    whole = option.disableflags & NO_ISLANDS == NO_ISLANDS
    if building.written and not (dense and whole):
        raise Unsupported(
            "rows written in a callback need jacobian='dense' and islands=False: others are read elsewhere"
        )
    try:
        compiled = building.spec.compile()
    except ValueError as error:
        raise Unsupported(f"MuJoCo refuses this mechanism: {' '.join(str(error).split())}") from error
    _keep_small_offsets(compiled)
    return compiled


def _keep_small_offsets(compiled: Any) -> None:
    """Let MuJoCo read where sites and shapes are: it puts those within 1e-6 m of their body's origin there.

    It marks them as in their body's frame when it compiles, and never reads `site_pos`: a spring at an arm of a tenth
    of a micrometre then turns nothing (4.0.1, asked by a test in `tests/engines/test_mujoco_joints.py`).
    """
    kinds = mujoco.mjtSameFrame
    tables = (compiled.site_pos, compiled.site_sameframe), (compiled.geom_pos, compiled.geom_sameframe)
    for place, same in tables:
        whole = np.isin(same, (int(kinds.mjSAMEFRAME_BODY), int(kinds.mjSAMEFRAME_INERTIA)))
        same[whole & place.any(axis=1)] = int(kinds.mjSAMEFRAME_NONE)


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


def _scale_tolerance_by_free_inertia(compiled: Any, steady: list[int]) -> None:
    """Ask of the solver what its tolerance asks where nothing is driven; `steady`: what nothing can accelerate.

    MuJoCo measures its tolerance by the sum of the inertias on the diagonal of M: that of the start up to 3.12, that of
    the step in 4.0.1 (`mj_solPrimal` in MuJoCo's engine_solver.c), which heeds no `stat.meaninertia`. An armature of
    1e8 in it would let a solver that is wrong by all of an acceleration end at once.
    """
    free = np.delete(compiled.dof_M0, steady)
    if steady and len(free):
        compiled.opt.tolerance *= float(free.sum() / compiled.dof_M0.sum())


def user_rows() -> Any:
    """The module that writes rows, imported where one is written: it imports numba."""
    return import_module("engines.mujoco.user_rows")


def unit_of_mass(mechanism: Mechanism) -> float:
    """About the mechanism's mass [kg], or its inertia [kg m^2] where that is the larger number.

    A regularisation below mjMINVAL (1e-15) is not taken, and it has a unit: that of an inverse mass, or inertia. Nor is
    a body lighter than that.
    """
    mass, least = sum(body.mass for body in mechanism.bodies), min(min(b.mass, b.inertia) for b in mechanism.bodies)
    return power_of_two(max(mass, min(mass * mechanism.length_scale**2, least * LIGHTEST)))
