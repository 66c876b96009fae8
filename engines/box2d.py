"""Box2D v3 under test, by its binding pyb2d3: soft joints in single precision, solved by sub-steps of impulses.

A body is a dynamic body whose mass, centre and inertia are set directly; it may not sleep, and no shape is made, since
no contact is the subject. A Pin is a revolute joint, a Weld a weld joint, a Rod a distance joint, a Slot a wheel joint
without its spring (a point on a line that is free to turn), or a prismatic joint where a Drive of rate zero keeps the
angle. A Drive is the motor of the Pin or Slot between the same two bodies, with more torque than it can need. The
stiffness of its springs is that of the mass which they feel, pose by pose; so our code works out what springs, dampers,
forces and torques do to bodies before a step and applies forces, as users do.

What one step does (its solver.c): `substeps` times with h = dt / substeps it kicks, lets every joint correct the
velocities once with a push against its gap (soft, below), drifts by p += v h, and corrects once more without the push.
So a state is read at its instant, and the motion is that of a semi-implicit Euler method of step h.

Joints are springs of 60 Hz, or of a quarter of the rate of sub-steps where that is less, with a damping ratio of 2,
solved implicitly (b2MakeSoft in its solver.h; `crosscheck search` holds single joints to it): frequency w and ratio z
give a push of a share h w (2 z + h w) / (1 + h w (2 z + h w)) of w / (2 z + h w) times the gap. Since the push is taken
back after the drift, a gap closes at about w^2 h = 1.4e5 / s^2 times h: the shorter the sub-step, the slower, while
what opens it falls with h too. So no order can be promised. pyb2d3 0.11.1 has no function for the frequency of joints
(`b2World_SetJointTuning`). But a weld joint has frequencies of its own, which stay in the correction after the drift.
With `closing`, a Pin without a drive is a weld joint that nearly nothing (SLACK) keeps from turning, whose points are
held at the frequency closing / h; Rods and Welds are held at it too. A quarter is the engine's maximum for contacts; at
a half a chain of ten pins blows up. So stiff a pin turns the rounding of places into forces: the shorter the step, the
noisier are reactions. The page of engines shows the effect of frequency and of sub-steps.

No body turns by more than an eighth of a turn in a step: a faster one is slowed down, with a warning.

Numbers are of single precision: an error below about 1e-6 of the motion, and an acceleration below 1e-7 of the speed
over the step, can't be seen. The engine's functions between angles and rotations are approximations, off by 1.6e-3 and
3e-5 rad, so both are computed here; whole turns, which a rotation does not keep, are restored.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from engines.capability import Capability
from engines.contract import ConvergenceOrder, Enforcement, NotDeclared, Size, Unsupported
from engines.motions import over_three
from engines.sampling import sampled_with_differences, unwrapped
from engines.single_run import ExtraEngine, Recorded
from reference.checks import Count, Name, NonNegative, validated
from reference.joints import Drive, Gear, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reference.trajectory import RunWarning

STEP_COST = 3e-6  # s of a step of three bodies, without its sub-steps
SUBSTEP_COST = 0.8e-6  # s
SLOP = 0.005  # m: the shortest distance of a joint
ENOUGH = 1e30  # N m, of a motor: single precision ends at 3e38
FASTEST = 1e18  # m/s, which the engine would cut to 400; single precision holds no larger square
TURNED = math.pi / 4  # in a step: a faster body is slowed to it, and the binding has no switch for that
FORCES_COST = 150e-6  # s, of force elements, which are worked out by numpy
# Of its points' frequency: a weld joint's spring that keeps it from turning in no number of steps; 0 is the stiffest.
SLACK = 4e-9
RATE_CUT = RunWarning("upstream: a rate was cut to an eighth of a turn in a step", "rate limit", "upstream")
JOINTS = "https://box2d.org/documentation/group__joint.html"  # all that there are


@dataclass(frozen=True)
class Box2D(ExtraEngine):
    """An engine in the sense of `engines.Engine`.

    `substeps` in a step, 4 as in the engine's manual; `closing`: the frequency of pins, welds and rods times the length
    of a sub-step, 0 for joints as shipped.
    """

    name = "box2d"
    packages = ("pyb2d3",)
    modules: ClassVar[tuple[str, ...]] = ("pyb2d3",)
    forces_by: ClassVar[Enforcement] = "ours"
    precision: ClassVar[float] = 2.0**-23  # of its numbers
    angle_error: ClassVar[float] = 2.8e-5  # b2Atan2 of its math_functions.h is a polynomial, by which it reads a weld
    capability: ClassVar[Capability] = Capability(
        "box2d",
        frozenset({Pin, Slot, Drive, Rod, Weld}),
        lacks={
            Gear: f"box2d has no gears since version 3 ({JOINTS})",
            Skate: "box2d has no joint for a velocity across a blade alone: those for lines hold a place on them "
            f"({JOINTS})",
            Roll: "in box2d a disc rolls by contact and friction, and our adapter builds no contact",
        },
    )

    variant: Name
    substeps: Count = 4
    closing: NonNegative = 0.0

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """None: see the module."""
        return NotDeclared("a joint of box2d closes its gap the more slowly the shorter the sub-step is")

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]."""
        forces = FORCES_COST if mechanism.forces else 0.0
        return (STEP_COST + SUBSTEP_COST * self.substeps) * over_three(mechanism) + forces

    def model(self, mechanism: Mechanism, dt: float) -> Box2DWorld:
        return Box2DWorld(mechanism, dt, self.substeps, self.closing * self.substeps / dt)


class Box2DWorld:
    """The engine's objects for one mechanism; `hertz`: the frequency of stiffened joints, 0 for those as shipped."""

    def __init__(self, mechanism: Mechanism, dt: float, substeps: int, hertz: float) -> None:
        import pyb2d3

        self.mechanism, self.box2d, self.dt, self.substeps, self.hertz = mechanism, pyb2d3, dt, substeps, hertz
        self.drives = self._motors()
        self.world = pyb2d3.World(gravity=mechanism.gravity, maximum_linear_speed=FASTEST)
        self.world.continuous_enabled = False
        self.ground = self.world.create_static_body(position=(0.0, 0.0))
        self.bodies = [self._body(body) for body in mechanism.bodies]
        self.joints = [self._join(joint) for joint in mechanism.joints if not isinstance(joint, Drive)]
        self.angles = mechanism.pose[:, 2].copy()  # of the last step, not wrapped
        count, rows = len(self.bodies), mechanism.row_count
        self.size = Size(count, 3 * count, rows, rows)

    def _motors(self) -> dict[frozenset[str | None], Drive]:
        """The drive of each pair of bodies; raises Unsupported for what the engine has no joint for."""
        joints = self.mechanism.joints
        held = {frozenset((joint.first, joint.second)) for joint in joints if isinstance(joint, Pin | Slot)}
        drives = [joint for joint in joints if isinstance(joint, Drive)]
        for drive in drives:
            if frozenset((drive.first, drive.second)) not in held:
                raise Unsupported(
                    f"drive {drive.name!r}: a motor of box2d belongs to a joint between the same two bodies"
                )
        motors = {frozenset((drive.first, drive.second)): drive for drive in drives}
        if len(motors) < len(drives):
            raise Unsupported("two drives between the same two bodies: a joint of box2d has one motor")
        return motors

    def _body(self, body: Any) -> Any:
        x, y, angle = body.pose
        vx, vy, rate = body.twist
        rotation, masses = self.box2d.Rot(), self.box2d.MassData()
        rotation.c, rotation.s = math.cos(angle), math.sin(angle)
        start = {"position": (x, y), "rotation": rotation, "linear_velocity": (vx, vy), "angular_velocity": rate}
        made = self.world.create_dynamic_body(**start, enable_sleep=False)
        masses.mass, masses.center, masses.rotational_inertia = body.mass, (0.0, 0.0), body.inertia
        made.mass_data = masses
        return made

    def _named(self, name: str | None) -> Any:
        return self.ground if name is None else self.bodies[self.mechanism.body_index(name)]

    def _join(self, joint: Any) -> Any:
        bodies = {"body_a": self._named(joint.first), "body_b": self._named(joint.second)}
        ends = {**bodies, "local_anchor_a": joint.first_point, "local_anchor_b": joint.second_point}
        if isinstance(joint, Rod):
            if joint.length < SLOP:
                raise Unsupported(
                    f"joint {joint.name!r}: box2d takes a rod of {joint.length:g} m for one of {SLOP:g} m, its slop"
                )
            spring = {"enable_spring": True, "hertz": self.hertz, "damping_ratio": 1.0} if self.hertz else {}
            return self.world.create_distance_joint(**ends, length=joint.length, **spring)
        if isinstance(joint, Weld):
            return self._weld(ends, self.hertz, reference_angle=math.remainder(joint.angle, 2 * math.pi))
        # Of two joints between two bodies the first has the motor.
        drive = self.drives.pop(frozenset((joint.first, joint.second)), None)
        sign = 1.0 if drive is None or drive.second == joint.second else -1.0
        motor: dict[str, Any] = {}
        if drive is not None:
            motor = {"enable_motor": True, "motor_speed": sign * drive.turning_rate, "max_motor_torque": ENOUGH}
        if isinstance(joint, Pin):
            if drive is None and self.hertz:
                return self._weld(ends, SLACK * self.hertz, angular_damping_ratio=0.0)
            return self.world.create_revolute_joint(**ends, **motor)
        line = (math.cos(joint.line_angle), math.sin(joint.line_angle))
        if drive is not None and drive.turning_rate == 0:
            angle = math.remainder(sign * drive.offset, 2 * math.pi)
            return self.world.create_prismatic_joint(**ends, local_axis_a=line, reference_angle=angle)
        return self.world.create_wheel_joint(**ends, **motor, local_axis_a=line, enable_spring=False)

    def _weld(self, ends: dict[str, Any], turning: float, **further: float) -> Any:
        """A weld joint whose points are held at our frequency, and whose angle at this one [Hz]; 0 is the stiffest."""
        held = {"linear_hertz": self.hertz, "linear_damping_ratio": 1.0, "angular_hertz": turning}
        return self.world.create_weld_joint(**ends, **{**held, "angular_damping_ratio": 1.0, **further})

    def _poses(self) -> list[tuple[float, float, float]]:
        """x, y and the angle within a turn."""
        states = ((body.position, body.rotation) for body in self.bodies)
        return [(at.x, at.y, math.atan2(turned.s, turned.c)) for at, turned in states]

    def _twists(self) -> list[tuple[float, float, float]]:
        velocities = ((body.linear_velocity, body.angular_velocity) for body in self.bodies)
        return [(velocity.x, velocity.y, rate) for velocity, rate in velocities]

    def _push(self) -> None:
        """Give bodies what force elements do now: the engine forgets it after a step."""
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
        inertias = np.array([(each.mass, each.mass, each.rotational_inertia) for each in masses])
        gravity = np.array([self.world.gravity.x, self.world.gravity.y])
        with np.errstate(all="ignore"):
            before = twist[..., 2] - acceleration[..., 2] * self.dt
            turned = np.fmax.reduce(np.abs([twist[..., 2], before]), axis=None) * self.dt
        warnings = (RATE_CUT,) if turned > 0.999 * TURNED else ()
        return Recorded(pose, twist, acceleration, stepping, inertias, gravity, warnings)


DEFAULT = Box2D("default")
TUNED = Box2D("tuned", substeps=16, closing=0.25)
VARIANTS = (DEFAULT, TUNED)
