"""A skate in MuJoCo, which has no such joint. `SkateBy` names what holds it:

- "blade": a capsule that touches a plane with friction across it, MuJoCo's own parts alone, as its maintainers suggest.
- "predicted tendon": a fixed tendon, a sum of joint velocities. Its coefficients are rewritten before every step as the
  skate's row at the pose that the velocity leads to.
- "rows": the skate's own row, written by a callback in every stage.

Bodies here can't move out of the plane, so nothing weighs on a contact: a blade stands that deep in the ground that the
softness of the contact carries the mechanism's weight.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, Literal

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco.construction import Building, Hooks, WrittenJoint
from engines.mujoco.stiffness import STIFFEST, Shipped
from engines.tree import world_offset
from reference.joints import Skate
from reference.mechanism import Mechanism

SkateBy = Literal["rows", "predicted tendon", "blade"]
# These change once a step, so an integrator of several stages gains nothing and costs four times as much.
STEPWISE: tuple[SkateBy, ...] = ("predicted tendon",)

# Along and across the blade. A capsule on a plane, because there the frame of the contact lies along the capsule: so
# the answer of one of MuJoCo's maintainers to how one skates on ice, github.com/google-deepmind/mujoco/issues/67.
BLADE_FRICTION = (1e-5, 10.0)
TILT = 0.5  # rad: only the blade's lower end touches
GRAVITY = 9.81  # m/s^2, what presses the mechanism on the ground that it stands on
PRESSED = 40  # bisections of the depth that carries the weight
DOUBLED = 60  # times that a blade may be
# A stiffness must not be zero in solref's direct form; this one pulls at a metre with a picometre per second squared.
NO_STIFFNESS = -1e-12


def slip_damping(mechanism: Mechanism) -> float:
    """How fast a written row lets slip die out [1/s].

    There is no gap to close, only slip that rounding leaves: it may take the motion's own time to die out, and a faster
    damping would cost accuracy. What turns sets that time; speed over a short arm would be far too fast.
    """
    return max(abs(body.twist[2]) for body in mechanism.bodies) or 1 / mechanism.time_scale


def add_skates(building: Building, skates: Sequence[Skate], by: SkateBy) -> None:
    """Add the skates to the model by this construction. Raises Unsupported in a sentence where it can't hold them."""
    if not skates:
        return
    if by == "blade":
        _add_blades(building, skates)
        return
    damping = slip_damping(building.mechanism)
    joints = [
        WrittenJoint("skate", skate.first, skate.second, (*skate.second_point, skate.angle, damping))
        for skate in skates
    ]
    if by == "rows":
        building.written += joints
    else:
        _add_tendons(building, joints)


def _add_tendons(building: Building, joints: Sequence[WrittenJoint]) -> None:
    """Rows that stop the slip within a step: J v = 0 after it, at a pose that is known before.

    MuJoCo holds a tendon's length. Here the stiffness is next to none and only the damping acts, so the length that the
    changing coefficients pretend does nothing, and need not be reset.
    """
    from engines.mujoco.user_rows import RowWriter

    tree, spec, width = building.tree, building.spec, building.tree.coordinates
    # The coefficients at the start set the scale of the compliance when the model is compiled.
    start, _ = RowWriter(tree, range(width), joints).rows(np.zeros(width), np.zeros(width))
    chains = [building.chain(joint) for joint in joints]
    for number, columns in enumerate(chains):
        name = f"skate {number}"
        building.add_sum(name, {column: float(start[number, column]) for column in columns})
        spec.add_equality(
            type=mujoco.mjtEq.mjEQ_TENDON,
            objtype=mujoco.mjtObj.mjOBJ_TENDON,
            name1=name,
            solref=[NO_STIFFNESS, -STIFFEST[1] / building.dt],
            solimp=list(STIFFEST),
        )
    building.size += len(joints)

    def bind(compiled: Any, address: Sequence[int]) -> Hooks:
        writer = RowWriter(tree, address, joints, ahead=building.dt)
        places = np.array([row * compiled.nv + address[column] for row, chain in enumerate(chains) for column in chain])
        first = int(compiled.tendon_adr[compiled.tendon("skate 0").id])
        coefficients = compiled.wrap_prm[first : first + len(places)]
        # Where every coordinate moves every skate, the coefficients are the rows as they are written.
        alike = np.array_equal(places, np.arange(len(joints) * compiled.nv))
        jacobian, unused = coefficients if alike else np.zeros(len(joints) * compiled.nv), np.zeros(len(joints))

        def rewrite(_model: Any, data: Any) -> None:
            writer.write(data.qpos, data.qvel, jacobian, unused)
            if not alike:
                coefficients[:] = jacobian[places]

        return Hooks(before=rewrite)

    building.binders.append(bind)


def _add_blades(building: Building, skates: Sequence[Skate]) -> None:
    """A tilted capsule: where one touches a plane, the contact's first direction of friction is the capsule's own."""
    mechanism, spec = building.mechanism, building.spec
    for skate in skates:
        if skate.first is not None:
            raise Unsupported(f"skate {skate.name!r} runs on the body {skate.first!r}; a blade stands on the ground")
    spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    building.contact = True
    building.binders.append(_press)
    apart: dict[str, Any] = {"contype": 0, "conaffinity": 0}
    # At zero the plane would be compiled as a geom in its body's own frame (geom_sameframe), and `geom_pos` never read.
    height = 1e-3 * mechanism.length_scale
    plane = mujoco.mjtGeom.mjGEOM_PLANE
    spec.worldbody.add_geom(name="ice", type=plane, size=[0.0, 0.0, 1.0], pos=[0.0, 0.0, height], **apart)
    pair: dict[str, Any] = {"solref": list(building.stiffness.reference(mechanism, building.dt))}
    if not isinstance(building.stiffness, Shipped):
        # Friction alone as fast as the step allows; the contact itself stays as soft as it comes, and so strong.
        pair = {"solreffriction": [-1e-9, -1 / building.dt]}
    radius, long = 0.05 * mechanism.length_scale, 0.2 * mechanism.length_scale
    for skate in skates:
        # The blade's direction at t = 0 in the world, which is also its direction in MuJoCo's frame of the body.
        heading = float(mechanism.pose[mechanism.body_index(skate.second or ""), 2] + skate.angle)
        low = np.array([*world_offset(mechanism, skate.second, skate.second_point), radius])
        ahead = np.array([math.cos(heading) * math.cos(TILT), math.sin(heading) * math.cos(TILT), math.sin(TILT)])
        building.carrier(skate.second).add_geom(
            name=f"blade {skate.name}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*low, *(low + long * ahead)],
            size=[radius, 0.0, 0.0],
            mass=0.0,
            **apart,
        )
        friction = [*BLADE_FRICTION, 0.005, 1e-4, 1e-4]
        spec.add_pair(geomname1="ice", geomname2=f"blade {skate.name}", condim=3, friction=friction, **pair)
        building.size += 2


def _press(compiled: Any, _address: Sequence[int]) -> Hooks:
    """Raise the ground until it carries the weight: the depth can't be told beforehand, the stiffness depends on it.

    Blades become longer until they stand in it with their lower ends alone; the other would hold another point too.
    """
    weight = float(compiled.body_mass.sum()) * GRAVITY
    ground, data = compiled.geom("ice").id, mujoco.MjData(compiled)
    blades = [geom for geom in range(compiled.ngeom) if compiled.geom(geom).name.startswith("blade ")]

    def carried(depth: float) -> float:
        compiled.geom_pos[ground, 2] = depth
        mujoco.mj_forward(compiled, data)
        standing = [each.efc_address for each in data.contact if each.efc_address >= 0 and ground in each.geom]
        return float(data.efc_force[standing].sum())

    lifted = 2 * float(compiled.geom_size[blades[0], 1]) * math.sin(TILT)
    for _ in range(DOUBLED):
        if carried(lifted) >= weight:
            break
        for blade in blades:  # its z-axis points down, to the end that stays
            half = compiled.geom_size[blade, 1]
            compiled.geom_pos[blade] -= half * data.geom_xmat[blade].reshape(3, 3)[:, 2]
            compiled.geom_size[blade, 1], compiled.geom_rbound[blade] = 2 * half, compiled.geom_rbound[blade] + half
        lifted *= 2
    low, high = 0.0, lifted
    for _ in range(PRESSED):
        depth = (low + high) / 2
        low, high = (depth, high) if carried(depth) < weight else (low, depth)
    return Hooks()
