"""Skates as users build them from MuJoCo's own parts: a blade or a wheel on a plane, or a velocity servo at a site.

Bodies here can't move out of the plane, so nothing weighs on the contact: shapes stand that deep in the ground that the
softness of the contact carries the mechanism's weight.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import mujoco
import numpy as np

from engines import Unsupported
from engines.mujoco.construction import Building, Hooks, read_by_step
from engines.mujoco.stiffness import Shipped
from engines.tree import world_offset
from reference.joints import Skate

# Along and across the blade. A capsule on a plane, because there the frame of the contact lies along the capsule: so
# the answer of one of MuJoCo's maintainers to how one skates on ice, github.com/google-deepmind/mujoco/issues/67.
BLADE_FRICTION = (1e-5, 10.0)
TILT = 0.5  # rad: only the blade's lower end touches
GRAVITY = 9.81  # m/s^2, what presses the mechanism on the ground that it stands on
PRESSED = 40  # bisections of the depth that carries the weight
WHEEL_MASS = 1e-3  # of the body that it carries
WHEEL_FRICTION = 10.0
SERVO_GAIN = 1e8  # N s/m per kg


def _refuse_moving_ground(skates: Sequence[Skate], what: str) -> None:
    for skate in skates:
        if skate.first is not None:
            raise Unsupported(f"skate {skate.name!r} runs on the body {skate.first!r}; {what} stands on the ground")


def _heading(building: Building, skate: Skate) -> float:
    """The blade's direction at t = 0 in the world, which is also its direction in MuJoCo's frame of the body."""
    return float(building.mechanism.pose[building.mechanism.body_index(skate.second or ""), 2] + skate.angle)


def add_servos(building: Building, skates: Sequence[Skate]) -> None:
    """A servo at the blade's point that wants no velocity across it; only implicit integration stands its gain."""
    _refuse_moving_ground(skates, "a servo at a site")
    mass = sum(body.mass for body in building.mechanism.bodies)
    for skate in skates:
        body, heading = building.index(skate.second), _heading(building, skate)
        x, y = world_offset(building.mechanism, skate.second, skate.second_point)
        name = f"skate {skate.name}"
        turned = [math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)]
        building.spec.body(f"body {body}").add_site(name=name, pos=[x, y, 0.0], quat=turned)
        servo = building.spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_SITE)
        servo.gear = [0.0, 1.0, 0.0, 0.0, 0.0, 0.0]
        servo.set_to_velocity(SERVO_GAIN * mass)
    building.size += len(skates)
    # An implicit integrator's acceleration is not the one that the forces at the start of the step would give.
    building.binders.append(lambda _compiled, _address: Hooks(read=read_by_step))


def _add_ground(building: Building) -> None:
    building.spec.option.cone = mujoco.mjtCone.mjCONE_ELLIPTIC
    building.contact = True
    building.binders.append(_press)
    building.spec.worldbody.add_geom(
        name="ice",
        type=mujoco.mjtGeom.mjGEOM_PLANE,
        size=[0.0, 0.0, 1.0],
        # At zero it would be compiled as a geom in its body's own frame (geom_sameframe), and `geom_pos` never read.
        pos=[0.0, 0.0, 1e-3 * building.mechanism.length_scale],
        contype=0,
        conaffinity=0,
    )


def _press(compiled: Any, _address: Sequence[int]) -> Hooks:
    """Raise the ground until it carries the weight: the depth can't be told beforehand, the stiffness depends on it."""
    weight = float(compiled.body_mass.sum()) * GRAVITY
    ground, low, high = compiled.geom("ice").id, 0.0, float(compiled.geom_rbound.max())
    data = mujoco.MjData(compiled)
    for _ in range(PRESSED):
        depth = (low + high) / 2
        compiled.geom_pos[ground, 2] = depth
        mujoco.mj_forward(compiled, data)
        carried = sum(data.efc_force[contact.efc_address] for contact in data.contact if contact.efc_address >= 0)
        low, high = (depth, high) if carried < weight else (low, depth)
    return Hooks()


def _touch(building: Building, name: str, friction: Sequence[float]) -> None:
    """A contact of this shape with the ground, and of nothing else."""
    pair: dict[str, Any] = {"solref": list(building.stiffness.reference(building.mechanism, building.dt))}
    if not isinstance(building.stiffness, Shipped):
        # Friction alone as fast as the step allows; the contact itself stays as soft as it comes, and so strong.
        pair = {"solreffriction": [-1e-9, -1 / building.dt]}
    building.spec.add_pair(geomname1="ice", geomname2=name, condim=3, friction=[*friction, 0.005, 1e-4, 1e-4], **pair)
    building.size += 2


def add_blades(building: Building, skates: Sequence[Skate]) -> None:
    """A tilted capsule: where one touches a plane, the contact's first direction of friction is the capsule's own."""
    _refuse_moving_ground(skates, "a blade")
    _add_ground(building)
    length = building.mechanism.length_scale
    radius, long = 0.05 * length, 0.2 * length
    for skate in skates:
        heading = _heading(building, skate)
        x, y = world_offset(building.mechanism, skate.second, skate.second_point)
        low = np.array([x, y, radius])
        ahead = np.array([math.cos(heading) * math.cos(TILT), math.sin(heading) * math.cos(TILT), math.sin(TILT)])
        building.spec.body(f"body {building.index(skate.second)}").add_geom(
            name=f"blade {skate.name}",
            type=mujoco.mjtGeom.mjGEOM_CAPSULE,
            fromto=[*low, *(low + long * ahead)],
            size=[radius, 0.0, 0.0],
            contype=0,
            conaffinity=0,
            mass=0.0,
        )
        _touch(building, f"blade {skate.name}", BLADE_FRICTION)


def add_wheels(building: Building, skates: Sequence[Skate]) -> None:
    """A thin wheel of a thousandth of the mass, on an axle across the blade, that starts rolling."""
    _refuse_moving_ground(skates, "a wheel")
    _add_ground(building)
    mechanism = building.mechanism
    radius = 0.1 * mechanism.length_scale
    for skate in skates:
        number = mechanism.body_index(skate.second or "")
        heading = _heading(building, skate)
        x, y = world_offset(mechanism, skate.second, skate.second_point)
        mass = WHEEL_MASS * mechanism.bodies[number].mass
        name = f"wheel {skate.name}"
        wheel = building.spec.body(f"body {number}").add_body(
            name=name,
            pos=[x, y, radius],
            quat=[math.cos(heading / 2), 0.0, 0.0, math.sin(heading / 2)],
            ipos=[0.0, 0.0, 0.0],
            mass=mass,
            inertia=[mass * radius**2 / 4, mass * radius**2 / 2, mass * radius**2 / 4],
            explicitinertial=True,
        )
        wheel.add_joint(name=name, type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0.0, 1.0, 0.0])
        wheel.add_geom(
            name=name,
            type=mujoco.mjtGeom.mjGEOM_ELLIPSOID,
            size=[radius, 0.05 * radius, radius],
            contype=0,
            conaffinity=0,
            mass=0.0,
        )
        _touch(building, name, (WHEEL_FRICTION, WHEEL_FRICTION))
        vx, vy, omega = mechanism.twist[number]
        speed = (vx - omega * y) * math.cos(heading) + (vy + omega * x) * math.sin(heading)
        building.start_rates[name] = float(speed / radius)
