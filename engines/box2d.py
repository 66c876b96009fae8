"""Box2D v3 under test, by its binding pyb2d3: soft joints in single precision, solved by impulses in sub-steps.

The adapter sets the mass, centre and inertia of a dynamic body directly. Bodies have no shape, so there are no
contacts. A Pin is a revolute joint, a Weld is a weld joint, and a Rod is a distance joint. A Slot is a wheel joint
without its spring, or a prismatic joint if a Drive of rate zero keeps the angle. A Drive is the motor of the Pin or
Slot between the same two bodies, with a torque limit that is never reached. The stiffness of the engine's springs
depends on the effective mass, which depends on the pose. Therefore our code evaluates all force elements before each
step and applies the forces to the bodies.

One step (its solver.c) has `substeps` sub-steps of h = dt / substeps. A sub-step applies forces, corrects the
velocities with a soft term against the gaps, integrates the poses (p += v h), and corrects the velocities again without
the soft term. The motion is that of the semi-implicit Euler method with the step h.

A joint is a spring with a damping ratio of 2, which the engine solves implicitly (b2MakeSoft in solver.h). The
frequency of a joint is 60 Hz, or a quarter of the rate of sub-steps if this is less. For a spring of angular frequency
w and damping ratio z, the soft term is the velocity w / (2 z + h w) * gap * s / (1 + s) with s = h w (2 z + h w). The
second correction removes this velocity, so a gap closes at the rate w^2 h with w^2 = 1.4e5 / s^2. A shorter sub-step h
closes a gap more slowly, but it also opens a smaller gap. Therefore no order is declared.

pyb2d3 0.11.1 has no function for the frequency of joints (`b2World_SetJointTuning`). But a user can set the frequencies
of a weld joint. With `closing`, a Pin without a drive is a weld joint with almost no angular stiffness (SLACK), and the
points of Pins, Rods and Welds have the frequency closing / h. For contacts the engine permits at most closing = 1/4.
With closing = 1/2 a chain of ten pins diverges. A stiff pin turns the rounding of positions into forces, so shorter
steps have noisier reactions.

The engine reduces a rate above an eighth of a turn per step, and the run then has a warning.

The engine uses single precision. The adapter computes angles and rotations itself, since the engine's functions have
errors of 1.6e-3 and 3e-5 rad. The adapter also counts whole turns, which a rotation does not contain.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from engines.capability import Capability, Lack
from engines.contract import SINGLE_PRECISION, ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported
from engines.motions import FORCES_COST, motors_of, over_three
from engines.sampling import sampled_with_differences, unwrapped
from engines.single_run import ExtraEngine, Recorded
from reference.checks import Count, Name, NonNegative, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

# CPU times [s] of a step of three bodies without its sub-steps, and of a sub-step.
BOX2D_STEP_COST = 3e-6
SUBSTEP_COST = 0.8e-6
# The shortest length that the engine permits for a distance joint [m].
SLOP = 0.005
# The torque limit of a motor [N m]. The limit is below the largest number in single precision, 3e38.
MOTOR_TORQUE = 1e30
# The engine's limit on speeds [m/s], 400 as shipped. The square of the limit must be finite in single precision.
SPEED_LIMIT = 1e18
# The largest rotation of a body in a step [rad]. The engine reduces a larger rate, and the binding has no setting for
# it.
TURN_LIMIT = math.pi / 4
# Angular frequency of a weld joint that replaces a pin, relative to the frequency of its points. The angular spring has
# an effect below rounding. The value 0 would mean the largest stiffness.
SLACK = 4e-9
RATE_CUT = RunWarning("upstream: a rate was cut to an eighth of a turn in a step", "rate limit", "upstream")
JOINT_LIST = "https://box2d.org/documentation/group__joint.html"


class Box2DWorld:
    """A mechanism in a world of Box2D; `hertz` is the frequency of joints [Hz], or 0 for the frequency as shipped."""

    def __init__(self, mechanism: Mechanism, dt: float, substeps: int, hertz: float) -> None:
        import pyb2d3

        self.mechanism, self.box2d, self.dt, self.substeps, self.hertz = mechanism, pyb2d3, dt, substeps, hertz
        self.motors = motors_of(mechanism, "box2d")
        self.world = pyb2d3.World(gravity=mechanism.gravity, maximum_linear_speed=SPEED_LIMIT)
        self.world.continuous_enabled = False
        self.ground = self.world.create_static_body(position=(0.0, 0.0))
        self.bodies = [self._body(body) for body in mechanism.bodies]
        joints = [joint for joint in mechanism.joints if not isinstance(joint, Drive)]
        self.joints = [BOX2D_JOINTS[type(joint)](self, joint) for joint in joints]
        self.angles = mechanism.pose[:, 2].copy()  # unwrapped angles of the last step [rad]
        count, rows = len(self.bodies), mechanism.row_count
        self.size = Size(count, 3 * count, rows, rows)

    def _body(self, body: Any) -> Any:
        x, y, angle = body.pose
        vx, vy, rate = body.twist
        rotation, masses = self.box2d.Rot(), self.box2d.MassData()
        rotation.c, rotation.s = math.cos(angle), math.sin(angle)
        start = {"position": (x, y), "rotation": rotation, "linear_velocity": (vx, vy), "angular_velocity": rate}
        dynamic = self.world.create_dynamic_body(**start, enable_sleep=False)
        masses.mass, masses.center, masses.rotational_inertia = body.mass, (0.0, 0.0), body.inertia
        dynamic.mass_data = masses
        return dynamic

    def _named(self, name: str | None) -> Any:
        return self.ground if name is None else self.bodies[self.mechanism.body_index(name)]

    def _ends(self, joint: Pin | Slot | Rod | Weld) -> dict[str, Any]:
        bodies = {"body_a": self._named(joint.first), "body_b": self._named(joint.second)}
        return {**bodies, "local_anchor_a": joint.first_point, "local_anchor_b": joint.second_point}

    def add_rod(self, joint: Rod) -> Any:
        if joint.length < SLOP:
            raise Unsupported(
                f"joint {joint.name!r}: box2d takes a rod of {joint.length:g} m for one of {SLOP:g} m, its slop"
            )
        spring = {"enable_spring": True, "hertz": self.hertz, "damping_ratio": 1.0} if self.hertz else {}
        return self.world.create_distance_joint(**self._ends(joint), length=joint.length, **spring)

    def add_weld(self, joint: Weld) -> Any:
        angle = math.remainder(joint.angle, 2 * math.pi)
        return self._weld(self._ends(joint), self.hertz, reference_angle=angle)

    def add_pin(self, joint: Pin) -> Any:
        drive, _, motor = self._take_motor(joint)
        if drive is None and self.hertz:
            return self._weld(self._ends(joint), SLACK * self.hertz, angular_damping_ratio=0.0)
        return self.world.create_revolute_joint(**self._ends(joint), **motor)

    def add_slot(self, joint: Slot) -> Any:
        drive, sign, motor = self._take_motor(joint)
        line = (math.cos(joint.line_angle), math.sin(joint.line_angle))
        if drive is not None and drive.turning_rate == 0:
            angle = math.remainder(sign * drive.offset, 2 * math.pi)
            return self.world.create_prismatic_joint(**self._ends(joint), local_axis_a=line, reference_angle=angle)
        return self.world.create_wheel_joint(**self._ends(joint), **motor, local_axis_a=line, enable_spring=False)

    def _take_motor(self, joint: Pin | Slot) -> tuple[Drive | None, float, dict[str, Any]]:
        drive, sign = self.motors.get(joint.name, (None, 1.0))
        if drive is None:
            return None, sign, {}
        speed = sign * drive.turning_rate
        return drive, sign, {"enable_motor": True, "motor_speed": speed, "max_motor_torque": MOTOR_TORQUE}

    def _weld(self, ends: dict[str, Any], turning: float, **further: float) -> Any:
        frequencies = {"linear_hertz": self.hertz, "linear_damping_ratio": 1.0, "angular_hertz": turning}
        return self.world.create_weld_joint(**ends, **{**frequencies, "angular_damping_ratio": 1.0, **further})

    def _poses(self) -> list[tuple[float, float, float]]:
        states = ((body.position, body.rotation) for body in self.bodies)
        return [(at.x, at.y, math.atan2(turned.s, turned.c)) for at, turned in states]

    def _twists(self) -> list[tuple[float, float, float]]:
        velocities = ((body.linear_velocity, body.angular_velocity) for body in self.bodies)
        return [(velocity.x, velocity.y, rate) for velocity, rate in velocities]

    def _push(self) -> None:
        pose, twist = np.array(self._poses()), np.array(self._twists())
        for index, angle in enumerate(pose[:, 2].tolist()):
            self.angles[index] += math.remainder(angle - self.angles[index], 2 * math.pi)
        pose[:, 2] = self.angles
        for body, (x, y, torque) in zip(self.bodies, self.mechanism.applied.on(pose, twist).tolist(), strict=True):
            body.apply_force_to_center((x, y))
            body.apply_torque(torque)

    def _advance(self, count: int) -> None:
        for _ in range(count):
            if self.mechanism.forces:
                self._push()
            self.world.step(self.dt, self.substeps)

    def record(self, samples: int, every: int) -> Recorded:
        pose, twist, acceleration, stepping = sampled_with_differences(
            (samples, every), self.dt, self._advance, lambda: (self._poses(), self._twists()), self._twists
        )
        pose[..., 2] = unwrapped(pose[..., 2], twist[..., 2], self.mechanism.pose[:, 2], self.dt * every)
        masses = [body.mass_data for body in self.bodies]
        inertias = np.array([(mass.mass, mass.mass, mass.rotational_inertia) for mass in masses])
        gravity = np.array([self.world.gravity.x, self.world.gravity.y])
        with np.errstate(all="ignore"):
            previous = twist[..., 2] - acceleration[..., 2] * self.dt
            turn = np.fmax.reduce(np.abs([twist[..., 2], previous]), axis=None) * self.dt
        warnings = (RATE_CUT,) if turn > 0.999 * TURN_LIMIT else ()
        return Recorded(pose, twist, acceleration, stepping, inertias, gravity, warnings)


BOX2D_JOINTS: Mapping[type, Callable[[Box2DWorld, Any], Any]] = {
    Pin: Box2DWorld.add_pin,
    Slot: Box2DWorld.add_slot,
    Rod: Box2DWorld.add_rod,
    Weld: Box2DWorld.add_weld,
    Drive: lambda world, drive: None,  # a pin or slot has the motor
}


@dataclass(frozen=True)
class Box2D(ExtraEngine):
    """substeps: number of sub-steps in a step; the engine's manual recommends 4.
    closing: frequency of pins, welds and rods times the sub-step h; 0 for the frequency as shipped.
    """

    name = "box2d"
    packages = ("pyb2d3",)
    modules: ClassVar[tuple[str, ...]] = ("pyb2d3",)
    forces_by: ClassVar[Enforcement] = "ours"
    precision: ClassVar[float] = SINGLE_PRECISION
    angle_error: ClassVar[float] = 2.8e-5  # error of b2Atan2 (math_functions.h) in the angle of a weld
    capability: ClassVar[Capability] = Capability(
        "box2d",
        BOX2D_JOINTS,
        lacks={
            Gear: Lack("box2d has no gears since version 3", JOINT_LIST),
            Skate: Lack(
                "box2d has no joint for a velocity across a blade alone: those for lines hold a place on them",
                JOINT_LIST,
            ),
            Roll: Lack("in box2d a disc rolls by contact and friction, and our adapter builds no contact"),
        },
    )

    variant: Name
    substeps: Count = 4
    closing: NonNegative = 0.0

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        return NotDeclared("a joint of box2d closes its gap the more slowly the shorter the sub-step is")

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        forces = FORCES_COST if mechanism.forces else 0.0
        return (BOX2D_STEP_COST + SUBSTEP_COST * self.substeps) * over_three(mechanism) + forces

    def model(self, mechanism: Mechanism, dt: float) -> Box2DWorld:
        return Box2DWorld(mechanism, dt, self.substeps, self.closing * self.substeps / dt)


DEFAULT = Box2D("default")
TUNED = Box2D("tuned", substeps=16, closing=0.25)
VARIANTS = (DEFAULT, TUNED)
