"""Constructions of a skate, for which MuJoCo has no joint. `SkateBy` is one of three constructions.

- "blade": a capsule that touches a plane, with friction across the capsule.
- "predicted tendon": a fixed tendon whose coefficients are the row of the skate. Our code computes the coefficients
  before every step, for the pose that the velocity predicts at the end of the step.
- "rows": a row for the skate that a callback writes in every stage.

Bodies cannot move out of the plane, so weight does not press a blade on the ground. Our code therefore raises the
ground until the contact force is equal to the weight of the mechanism.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any, Literal

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco.builder import Hooks, ModelBuilder, UserRowJoint
from engines.mujoco.stiffness import STIFFEST, Shipped
from engines.tree import world_offset
from reference.joints import Skate
from reference.mechanism import Mechanism

SkateBy = Literal["rows", "predicted tendon", "blade"]
# Constructions whose rows change once per step. Such constructions use the integrator Euler, since four stages with the
# same row would not reduce the error.
STEPWISE: tuple[SkateBy, ...] = ("predicted tendon",)

# Coefficients of friction along and across the blade. The first direction is along the capsule, as a maintainer of
# MuJoCo explains in github.com/google-deepmind/mujoco/issues/67.
BLADE_FRICTION = (1e-5, 10.0)
TILT = 0.5  # Tilt of a blade [rad], so that only the lower end touches the ground.
STANDARD_GRAVITY = 9.81  # Acceleration [m/s^2] that defines the weight.
BISECTIONS = 40  # Number of bisections for the depth at which the contact force is the weight.
MAX_DOUBLINGS = 60  # Limit on doublings of a blade's length.
# The direct form of solref does not permit zero. This stiffness gives 1e-12 m/s^2 at a gap of 1 m.
NO_STIFFNESS = -1e-12


def slip_damping(mechanism: Mechanism) -> float:
    """The damping [1/s] of slip in a user row, which is the largest initial angular velocity.

    The slip of a user row is rounding, so it may decay as slowly as the bodies move. A larger damping would reduce the
    accuracy.
    """
    return max(abs(body.twist[2]) for body in mechanism.bodies) or 1 / mechanism.time_scale


def add_skates(builder: ModelBuilder, skates: Sequence[Skate]) -> None:
    if builder.settings.skates == "blade":
        _add_blades(builder, skates)
        return
    damping = slip_damping(builder.mechanism)
    joints = [
        UserRowJoint("skate", skate.first, skate.second, (*skate.second_point, skate.angle, damping))
        for skate in skates
    ]
    if builder.settings.skates == "rows":
        builder.user_rows += joints
    else:
        _add_predicted_tendons(builder, joints)


def _add_predicted_tendons(builder: ModelBuilder, joints: Sequence[UserRowJoint]) -> None:
    """Add rows J v = 0 at the end of a step, with J at the predicted pose.

    An equality acts on the length of a tendon, which changes with the coefficients. The stiffness is almost zero, so
    that only the damping acts.
    """
    from engines.mujoco.user_rows import RowWriter  # it imports numba

    tree, spec, width = builder.tree, builder.spec, builder.tree.coordinates
    # The compiler computes the scale of the compliance from the coefficients at t = 0.
    start, _ = RowWriter(tree, range(width), joints).rows(np.zeros(width), np.zeros(width))
    columns_of = [builder.moving_columns(joint) for joint in joints]
    for number, columns in enumerate(columns_of):
        name = f"skate {number}"
        builder.add_fixed_tendon(name, {column: float(start[number, column]) for column in columns})
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_TENDON,
            objtype=mujoco.mjtObj.mjOBJ_TENDON,
            name1=name,
            solref=[NO_STIFFNESS, -STIFFEST[1] / builder.dt],
            solimp=list(STIFFEST),
        )
    builder.row_count += len(joints)

    def make_hooks(compiled: Any, address: Sequence[int]) -> Hooks:
        writer = RowWriter(tree, address, joints, ahead=builder.dt)
        entries = [row * compiled.nv + address[column] for row, columns in enumerate(columns_of) for column in columns]
        first = int(compiled.tendon_adr[compiled.tendon("skate 0").id])
        coefficients = compiled.wrap_prm[first : first + len(entries)]
        # If all coordinates move all skates, the rows can be written directly into the coefficients.
        is_dense = np.array_equal(entries, np.arange(len(joints) * compiled.nv))
        jacobian, unused = coefficients if is_dense else np.zeros(len(joints) * compiled.nv), np.zeros(len(joints))

        def rewrite(_model: Any, data: Any) -> None:
            writer.write(data.qpos, data.qvel, jacobian, unused)
            if not is_dense:
                coefficients[:] = jacobian[entries]

        return Hooks(before_step=rewrite)

    builder.hook_makers.append(make_hooks)


def _add_blades(builder: ModelBuilder, skates: Sequence[Skate]) -> None:
    mechanism, spec = builder.mechanism, builder.spec
    for skate in skates:
        if skate.first is not None:
            raise Unsupported(f"skate {skate.name!r} runs on the body {skate.first!r}; a blade stands on the ground")
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    builder.needs_contacts = True
    builder.hook_makers.append(_raise_ground)
    no_other_contact: dict[str, Any] = {"contype": 0, "conaffinity": 0}
    # For a plane at height zero, geom_sameframe would be set, and MuJoCo would ignore `geom_pos`.
    height = 1e-3 * mechanism.length_scale
    plane = mujoco.mjtGeom.mjGEOM_PLANE
    spec.worldbody.add_geom(name="ice", type=plane, size=[0.0, 0.0, 1.0], pos=[0.0, 0.0, height], **no_other_contact)
    pair: dict[str, Any] = {"solref": list(builder.stiffness.reference(mechanism, builder.dt))}
    if not isinstance(builder.stiffness, Shipped):
        # Friction has the largest damping that the step allows. The default stiffness keeps the contact force large.
        pair = {"solreffriction": [-1e-9, -1 / builder.dt]}
    radius, length = 0.05 * mechanism.length_scale, 0.2 * mechanism.length_scale
    for skate in skates:
        # MuJoCo's frame of the body is parallel to the world at t = 0.
        heading = float(mechanism.pose[mechanism.body_index(skate.second or ""), 2] + skate.angle)
        low = np.array([*world_offset(mechanism, skate.second, skate.second_point), radius])
        along = np.array([math.cos(heading) * math.cos(TILT), math.sin(heading) * math.cos(TILT), math.sin(TILT)])
        builder.spec_body(skate.second).add_geom(
            name=f"blade {skate.name}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*low, *(low + length * along)],
            size=[radius, 0.0, 0.0],
            mass=0.0,
            **no_other_contact,
        )
        friction = [*BLADE_FRICTION, 0.005, 1e-4, 1e-4]
        spec.add_pair(geomname1="ice", geomname2=f"blade {skate.name}", condim=3, friction=friction, **pair)
        builder.row_count += 2


def _raise_ground(compiled: Any, _address: Sequence[int]) -> Hooks:
    weight = float(compiled.body_mass.sum()) * STANDARD_GRAVITY
    ground, data = compiled.geom("ice").id, mujoco.MjData(compiled)

    def contact_force(depth: float) -> float:
        compiled.geom_pos[ground, 2] = depth
        mujoco.mj_forward(compiled, data)
        rows = [each.efc_address for each in data.contact if each.efc_address >= 0 and ground in each.geom]
        return float(data.efc_force[rows].sum())

    low, high = 0.0, _lengthen_blades(compiled, data, lambda depth: contact_force(depth) >= weight)
    for _ in range(BISECTIONS):
        depth = (low + high) / 2
        low, high = (depth, high) if contact_force(depth) < weight else (low, depth)
    return Hooks()


def _lengthen_blades(compiled: Any, data: Any, carries: Callable[[float], bool]) -> float:
    """Double the blades' length until `carries` is true for the height [m] of the upper ends, and return this height.

    `carries(depth)` is whether the ground carries the weight at a depth [m].
    """
    blades = [geom for geom in range(compiled.ngeom) if compiled.geom(geom).name.startswith("blade ")]
    height = 2 * float(compiled.geom_size[blades[0], 1]) * math.sin(TILT)
    for _ in range(MAX_DOUBLINGS):
        if carries(height):
            break
        for blade in blades:  # the z axis of a blade points to its lower end, which does not move
            half = compiled.geom_size[blade, 1]
            compiled.geom_pos[blade] -= half * data.geom_xmat[blade].reshape(3, 3)[:, 2]
            compiled.geom_size[blade, 1], compiled.geom_rbound[blade] = 2 * half, compiled.geom_rbound[blade] + half
        height *= 2
    return height
