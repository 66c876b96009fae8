"""The MuJoCo model of a mechanism: a kinematic tree, and constructions for the joints that close loops."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import mujoco
import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.capability import Capability
from engines.mujoco.builder import DrivenCoordinate, Hooks, ModelBuilder, add_body, add_hinge, add_slide
from engines.mujoco.forces import FORCE_CONSTRUCTIONS
from engines.mujoco.joints.links import add_drives, add_gears, add_pins, add_rods, add_slots, add_welds
from engines.mujoco.joints.roll import add_rolls
from engines.mujoco.joints.skate import add_skates
from engines.mujoco.releases import NO_ISLANDS
from engines.tree import Tree, spanning_tree
from engines.units import counted_in, power_of_two
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

if TYPE_CHECKING:
    from engines.mujoco.engine import MuJoCo

Coordinates = Literal["tree", "free"]
# Constructions of joints that the tree does not enforce. The rows in MuJoCo's solver have the order of this table.
JOINT_CONSTRUCTIONS: Mapping[type, Callable[[ModelBuilder, Sequence[Any]], None]] = {
    Pin: add_pins,
    Slot: add_slots,
    Weld: add_welds,
    Rod: add_rods,
    Gear: add_gears,
    Drive: add_drives,
    Skate: add_skates,
    Roll: add_rolls,
}
MUJOCO_CAPABILITY = Capability("mujoco", frozenset(JOINT_CONSTRUCTIONS), frozenset(FORCE_CONSTRUCTIONS))
# Largest unit of mass relative to the smallest mass or inertia. With this unit, the smallest mass or inertia is far
# above mjMINVAL.
MAX_MASS_RATIO = 1e13


@dataclass(frozen=True)
class MuJoCoModel:
    mechanism: Mechanism
    tree: Tree
    compiled: Any  # mujoco.MjModel.
    address: list[int]  # Index in qpos and qvel by tree coordinate.
    driven: tuple[DrivenCoordinate, ...]
    hooks: Hooks = field(default_factory=Hooks)
    rows: int = 0  # number of scalar constraints that forces enforce, without drives
    has_user_rows: bool = False
    start_rates: Mapping[int, float] = field(
        default_factory=dict
    )  # Rates of coordinates outside the tree, by index in qvel.
    unit: float = 1.0  # Unit of mass [kg] of the compiled model, which also scales forces and torques.
    split_bodies: tuple[tuple[str, int], ...] = ()  # As in ModelBuilder.
    spec: Any = None  # mujoco.MjSpec.
    softening: float = 1.0  # Factor on MuJoCo's compliances.

    @contextmanager
    def callback_installed(self) -> Iterator[None]:
        """Install the model's callback, which every step and every evaluation needs; it is global in MuJoCo."""
        previous = mujoco.get_mjcb_control()
        mujoco.set_mjcb_control(self.hooks.control)
        try:
            yield
        finally:
            mujoco.set_mjcb_control(previous)

    def inertias_and_gravity(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Masses and inertias (bodies, 3) [kg, kg, kg m^2] and gravity (2,) [m/s^2] of the compiled model."""
        compiled = self.compiled
        ids = [compiled.body(f"body {index}").id for index in range(len(self.mechanism.bodies))]
        mass, inertia = compiled.body_mass[ids].copy(), compiled.body_inertia[ids, 2].copy()
        for name, body in self.split_bodies:
            half = compiled.body(name).id
            mass[body] += compiled.body_mass[half]
            inertia[body] += compiled.body_inertia[half, 2]
        return self.unit * np.stack([mass, mass, inertia], axis=-1), compiled.opt.gravity[:2].copy()

    def start(self) -> Any:
        data = mujoco.MjData(self.compiled)
        data.qvel[self.address] = self.tree.start_rates()
        for driven in self.driven:
            data.qvel[self.address[driven.column]] = driven.rate
        for index, rate in self.start_rates.items():
            data.qvel[index] = rate
        with self.callback_installed():
            if self.hooks.before_step:
                self.hooks.before_step(self.compiled, data)
            mujoco.mj_forward(self.compiled, data)
        return data


def build_model(
    mechanism: Mechanism, dt: float, settings: MuJoCo, options: Mapping[str, Any], unit: float | None = None
) -> MuJoCoModel:
    """Compile a mechanism for steps of dt [s]; raises Unsupported.

    `options` are MuJoCo's options by name. `unit` [kg] is the unit of mass, by default `unit_of_mass`.
    """
    MUJOCO_CAPABILITY.require(mechanism)
    unit = unit or unit_of_mass(mechanism)
    scaled = counted_in(mechanism, unit)
    tree = spanning_tree(scaled, hanging=settings.coordinates == "tree")
    builder = ModelBuilder(_spec(tree, dt, settings.islands, options), scaled, tree, dt, settings)
    for kind, add_joints in JOINT_CONSTRUCTIONS.items():
        joints = [joint for joint in scaled.joints if type(joint) is kind and not tree.holds(joint)]
        if joints:
            add_joints(builder, joints)
    for force in scaled.forces:
        FORCE_CONSTRUCTIONS[type(force)](builder, force)
    builder.reserve_user_rows()
    compiled = _compiled(builder)
    address = [int(compiled.joint(f"coordinate {column}").qposadr[0]) for column in range(tree.coordinates)]
    steady = [address[driven.column] for driven in builder.driven]
    steady += [int(compiled.joint(clock).dofadr[0]) for clock in builder.clocks]
    _scale_tolerance_by_free_inertia(compiled, steady)
    multiply_compliances(compiled, settings.stiffness.softening)
    hooks = sum((make_hooks(compiled, address) for make_hooks in builder.hook_makers), Hooks())
    if builder.user_rows:
        from engines.mujoco.user_rows import row_callback  # it imports numba

        hooks += Hooks(row_callback(compiled, tree, address, builder.user_rows, settings.stiffness.softening))
    return MuJoCoModel(
        mechanism,
        tree,
        compiled,
        address,
        tuple(builder.driven),
        hooks,
        rows=builder.row_count + sum(joint.size for joint in builder.user_rows),
        has_user_rows=bool(builder.user_rows),
        start_rates={int(compiled.joint(name).dofadr[0]): rate for name, rate in builder.start_rates.items()},
        unit=unit,
        split_bodies=tuple(builder.split_bodies),
        spec=builder.spec,
        softening=settings.stiffness.softening,
    )


def multiply_compliances(compiled: Any, factor: float) -> None:
    for scale in (compiled.body_invweight0, compiled.dof_invweight0, compiled.tendon_invweight0):
        scale[:] *= factor


def _spec(tree: Tree, dt: float, islands: bool, options: Mapping[str, Any]) -> Any:
    spec = mujoco.MjSpec()
    spec.compiler.degree = False
    spec.option.timestep = dt
    spec.option.gravity = [*tree.mechanism.gravity, 0.0]
    spec.option.disableflags = int(mujoco.mjtDisableBit.mjDSBL_CONTACT) | (0 if islands else NO_ISLANDS)
    for name, value in options.items():
        setattr(spec.option, name, value)
    _add_bodies(spec, tree)
    return spec


def _compiled(builder: ModelBuilder) -> Any:
    """The mujoco.MjModel; raises Unsupported if MuJoCo refuses the model or would ignore rows from a callback."""
    option = builder.spec.option
    if builder.needs_contacts:
        option.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    is_dense = option.jacobian == mujoco.mjtJacobian.mjJAC_DENSE
    has_no_islands = option.disableflags & NO_ISLANDS == NO_ISLANDS
    if builder.user_rows and not (is_dense and has_no_islands):
        raise Unsupported(
            "rows from a callback need jacobian='dense' and islands=False, since MuJoCo stores other rows elsewhere"
        )
    try:
        compiled = builder.spec.compile()
    except ValueError as error:
        raise Unsupported(f"MuJoCo refuses this mechanism: {' '.join(str(error).split())}") from error
    _keep_small_offsets(compiled)
    return compiled


def _keep_small_offsets(compiled: Any) -> None:
    """Make MuJoCo use the positions of sites and shapes that are less than 1e-6 m from the origin of their body.

    The compiler marks such a site as being at the origin, and MuJoCo then ignores `site_pos`. A spring with an arm of
    1e-7 m then has no torque (4.0.1, checked in `tests/engines/test_mujoco_joints.py`).
    """
    kinds = mujoco.mjtSameFrame
    tables = (compiled.site_pos, compiled.site_sameframe), (compiled.geom_pos, compiled.geom_sameframe)
    for positions, frames in tables:
        is_at_origin = np.isin(frames, (int(kinds.mjSAMEFRAME_BODY), int(kinds.mjSAMEFRAME_INERTIA)))
        frames[is_at_origin & positions.any(axis=1)] = int(kinds.mjSAMEFRAME_NONE)


def _add_bodies(spec: Any, tree: Tree) -> None:
    mechanism, added = tree.mechanism, {}
    for link in tree.links:
        body = mechanism.bodies[link.body]
        base = (0.0, 0.0) if link.parent is None else mechanism.bodies[link.parent].pose[:2]
        parent = spec.worldbody if link.parent is None else added[link.parent]
        position = [body.pose[0] - base[0], body.pose[1] - base[1]]
        added[link.body] = add_body(parent, f"body {link.body}", body.mass, body.inertia, position)
        axes = {"free": [(1.0, 0.0), (0.0, 1.0)], "slot": [link.direction], "hinge": []}[link.kind]
        for column, axis in zip(link.columns, axes, strict=False):
            add_slide(added[link.body], f"coordinate {column}", axis)
        if link.rotation is not None:
            add_hinge(added[link.body], f"coordinate {link.rotation}", link.anchor)


def _scale_tolerance_by_free_inertia(compiled: Any, steady: list[int]) -> None:
    """Make the solver's tolerance relative to the inertia without the coordinates `steady`.

    MuJoCo's tolerance is relative to the sum of the diagonal of the mass matrix. With an armature of 1e8 in the sum,
    the solver would end at once although its accelerations have an error of 100 %.
    """
    free = np.delete(compiled.dof_M0, steady)
    if steady and len(free):
        compiled.opt.tolerance *= float(free.sum() / compiled.dof_M0.sum())


def unit_of_mass(mechanism: Mechanism) -> float:
    """A power of two near the mechanism's mass [kg], or near its inertia [kg m^2] if this number is larger.

    MuJoCo refuses a mass below mjMINVAL, 1e-15. It also refuses a regularisation, an inverse mass, below that.
    """
    mass = sum(body.mass for body in mechanism.bodies)
    smallest = min(min(body.mass, body.inertia) for body in mechanism.bodies)
    return power_of_two(max(mass, min(mass * mechanism.length_scale**2, smallest * MAX_MASS_RATIO)))
