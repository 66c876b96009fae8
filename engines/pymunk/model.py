"""The pymunk model of a mechanism, with one construction for each kind of joint and force element.

A spring acts at the pose after the drift, as gravity does, and does not lower the order of convergence. A damper has
order 1. A damper multiplies the relative velocity by exp(-damping dt / effective mass) after the kick, and not by the
square root of this factor before and after the kick. Chipmunk applies the force and torque of a body after the drift,
and resets them in every step. Our code therefore sets forces and torques before each step, for the exact pose after the
drift.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import constraints
from pymunk._chipmunk_cffi import lib

from engines import Size, Unsupported
from engines.capability import Capability
from engines.pymunk.joints.drive import crank_body, find_cranks, find_turned, motor, turned_body
from engines.pymunk.joints.roll import (
    SHIPPED_CONTACT,
    ContactSettings,
    MovedPivot,
    RollConstruction,
    contact_shapes,
    extent_of,
)
from engines.pymunk.joints.slide import (
    AfterStep,
    BeforeStep,
    SkateConstruction,
    build_skate,
    build_slot,
)
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Vector, Weld
from reference.mechanism import Body, Mechanism
from reference.rolling.roll import Roll

Pair = tuple[pymunk.Body, pymunk.Body]
Constraints = list[constraints.Constraint]
# Numbers of scalar rows of pymunk constraints that represent joints. Springs have no rows.
CONSTRAINT_ROWS: Mapping[type[constraints.Constraint], int] = {
    constraints.PivotJoint: 2,
    constraints.SimpleMotor: 1,
    constraints.GrooveJoint: 1,
    constraints.PinJoint: 1,
    constraints.GearJoint: 1,
}


@dataclass(frozen=True)
class Settings:
    iterations: int
    error_bias: float  # Error bias per unit of time.
    unit: float  # Unit of time of the model [s].
    skate: SkateConstruction
    roll: RollConstruction
    contact: ContactSettings = SHIPPED_CONTACT


@dataclass(frozen=True)
class Model:
    """A space and its bodies in the order of the mechanism; `unit` is the unit of time [s].

    `origins` (bodies, 2) [m] are the origins of the pymunk bodies in the mechanism's body frames. The origin of a crank
    is its pin. The origin of any other body is its centre of mass.
    """

    space: pymunk.Space
    bodies: tuple[pymunk.Body, ...]
    origins: NDArray[np.float64]
    size: Size
    unit: float
    before_step: tuple[BeforeStep, ...] = ()
    after_step: tuple[AfterStep, ...] = ()

    def stepper(self, raw: bool) -> tuple[Callable[[Any, float], None], Any]:
        """A function and a space for calls `step(space, dt)`, which include the updates before and after a step.

        The function calls `Space.step`, or Chipmunk's cpSpaceStep if `raw`.
        """
        step, space = (lib.cpSpaceStep, self.space._space) if raw else (pymunk.Space.step, self.space)
        before_step, after_step = self.before_step, self.after_step
        if not (before_step or after_step):
            return step, space

        def step_with_updates(space: Any, dt: float) -> None:
            for update in before_step:
                update(dt)
            step(space, dt)
            for update in after_step:
                update()

        return step_with_updates, space

    def kick(self, dt: float) -> None:
        """Change the velocities by a step of dt [units] without its drift."""
        for update in self.before_step:
            update(0.0)
        for body in self.bodies:
            body.position_func = _no_drift  # pyright: ignore[reportAttributeAccessIssue]
        self.space.step(dt)
        for body in self.bodies:
            body.position_func = pymunk.Body.update_position  # pymunk restores the C function
        for update in self.after_step:
            update()


def _no_drift(body: pymunk.Body, dt: float) -> None:
    pass


def build_model(mechanism: Mechanism, settings: Settings) -> Model:
    PYMUNK_CAPABILITY.require(mechanism)
    return _Builder(mechanism, settings).model()


class _Builder:
    def __init__(self, mechanism: Mechanism, settings: Settings) -> None:
        self.mechanism, self.settings = mechanism, settings
        self.space = pymunk.Space()
        x, y = mechanism.gravity
        self.space.gravity = (x * settings.unit * settings.unit, y * settings.unit * settings.unit)
        self.space.iterations = settings.iterations
        self.cranks, self.turned = find_cranks(mechanism), find_turned(mechanism)
        self.bodies = {description.name: self._body(description) for description in mechanism.bodies}
        self.space.add(*self.bodies.values())
        self.before_step: list[BeforeStep] = []
        self.after_step: list[AfterStep] = []
        self.pushed_points: dict[str, list[tuple[Vector, Vector]]] = {}  # (point, force) by name of the body
        self.torques: dict[str, float] = {}
        self.rows = self.solver_rows = self.rolls = 0

    def _body(self, description: Body) -> pymunk.Body:
        name, unit = description.name, self.settings.unit
        if name in self.cranks:
            return crank_body(self.cranks[name], description, unit)
        vx, vy, rate = (value * unit for value in description.twist)
        if name in self.turned:
            body = turned_body(self.turned[name], description, unit)
        else:
            body = pymunk.Body(description.mass, description.inertia)
            body.angular_velocity = rate
        body.position, body.angle = description.pose[:2], description.pose[2]
        body.velocity = (vx, vy)
        return body

    def model(self) -> Model:
        for joint in self.mechanism.joints:
            for constraint in self._constraints(joint):
                # The gap of a groove that is placed before every step is rounding, whose correction would add noise.
                placed = isinstance(joint, Skate) and self.settings.skate == "groove"
                constraint.error_bias = 1.0 if placed else self.settings.error_bias
                self.space.add(constraint)
                self.rows += CONSTRAINT_ROWS[type(constraint)]
                self.solver_rows += CONSTRAINT_ROWS[type(constraint)]
        for element in self.mechanism.forces:
            MUNK_FORCES[type(element)](self, element, self._pair(element))
        self._add_pushes()
        count = len(self.bodies)
        size = Size(bodies=count, coordinates=3 * count, rows=self.rows, solver_rows=self.solver_rows)
        origins = np.array([self.origin(name) for name in self.bodies])
        updates = tuple(self.before_step), tuple(self.after_step)
        return Model(self.space, tuple(self.bodies.values()), origins, size, self.settings.unit, *updates)

    def _pair(self, element: Any) -> Pair:
        ground = self.space.static_body
        first, second = (ground if name is None else self.bodies[name] for name in (element.first, element.second))
        return first, second

    def origin(self, name: str | None) -> Vector:
        return self.cranks[name].own_point if name in self.cranks else (0.0, 0.0)

    def from_origin(self, name: str | None, point: Vector) -> Vector:
        x, y = self.origin(name)
        return (point[0] - x, point[1] - y)

    def anchors(self, element: Any) -> tuple[Vector, Vector]:
        first, second = (element.first, element.first_point), (element.second, element.second_point)
        return self.from_origin(*first), self.from_origin(*second)

    def _constraints(self, joint: Joint) -> Constraints:
        if any(joint in (crank.pin, crank.drive) for crank in self.cranks.values()) or joint in self.turned.values():
            return []
        pair = self._pair(joint)
        self._require_movable(joint, pair)
        return CONSTRUCTIONS[type(joint)](self, joint, pair)

    def _require_movable(self, joint: Joint, pair: Pair) -> None:
        turns = any(name is not None and name not in self.turned for name in (joint.first, joint.second))
        free = (can_move(pair) or isinstance(joint, Drive | Gear)) and (
            turns or not isinstance(joint, Drive | Gear | Weld)
        )
        if not free:
            raise Unsupported(
                f"joint {joint.name!r} joins two bodies whose motion is already prescribed; "
                "a pymunk constraint needs one that forces can move"
            )

    def pin(self, joint: Pin, pair: Pair) -> Constraints:
        return [constraints.PivotJoint(*pair, *self.anchors(joint))]

    def drive(self, joint: Drive, pair: Pair) -> Constraints:
        return [motor(joint, *pair, self.settings.unit)]

    def rod(self, joint: Rod, pair: Pair) -> Constraints:
        constraint = constraints.PinJoint(*pair, *self.anchors(joint))
        constraint.distance = joint.length  # pymunk's default is the distance at t = 0
        return [constraint]

    def gear(self, joint: Gear, pair: Pair) -> Constraints:
        # Chipmunk keeps ratio angle_b - angle_a = phase (preStep in cpGearJoint.c), so ratio and phase are inverted.
        return [constraints.GearJoint(*pair, joint.phase / joint.ratio, 1 / joint.ratio)]

    def weld(self, joint: Weld, pair: Pair) -> Constraints:
        return [constraints.PivotJoint(*pair, *self.anchors(joint)), constraints.GearJoint(*pair, joint.angle, 1.0)]

    def slot(self, joint: Slot, pair: Pair) -> Constraints:
        scale = self.mechanism.length_scale
        rows, updates = build_slot(joint, *pair, *self.anchors(joint), scale)
        self.before_step += updates
        return rows

    def skate(self, joint: Skate, pair: Pair) -> Constraints:
        point, scale = self.from_origin(joint.second, joint.second_point), self.mechanism.length_scale
        rows, before_step, after_step = build_skate(joint, self.settings.skate, *pair, point, scale)
        self.before_step += before_step
        self.after_step += after_step
        self.rows += 0 if rows else 1  # our code enforces this row
        return rows

    def roll(self, joint: Roll, pair: Pair) -> Constraints:
        if self.settings.roll != "contact":
            pivot = MovedPivot(joint, *pair, (self.origin(joint.first), self.origin(joint.second)))
            self.before_step.append(pivot)
            return [pivot.constraint]
        contact = self.settings.contact
        self.space.collision_slop, self.space.collision_bias = contact.slop, contact.bias**self.settings.unit
        sides = (
            (pair[0], lambda point: self.from_origin(joint.first, point)),
            (pair[1], lambda point: self.from_origin(joint.second, point)),
        )
        shapes = contact_shapes(joint, contact, extent_of(self.mechanism), self.rolls, sides)
        self.space.add(*shapes)
        self.rolls += 1
        self.rows += 2
        # A contact point has a normal row and a tangential row. A flat side has two points.
        self.solver_rows += 2 if any(isinstance(shape, pymunk.Circle) for shape in shapes) else 4
        return []

    # There is no spring between two bodies with prescribed motions, since pymunk would divide by zero.

    def spring(self, element: Spring, pair: Pair) -> None:
        if can_move(pair):
            stiffness = element.stiffness * self.settings.unit * self.settings.unit
            self.space.add(constraints.DampedSpring(*pair, *self.anchors(element), element.rest_length, stiffness, 0.0))

    def damper(self, element: Damper, pair: Pair) -> None:
        if can_move(pair):
            damping = element.damping * self.settings.unit
            self.space.add(constraints.DampedSpring(*pair, *self.anchors(element), 0.0, 0.0, damping))

    def torsion_spring(self, element: TorsionSpring, pair: Pair) -> None:
        if can_turn(pair[0]) or can_turn(pair[1]):
            # In Chipmunk the relative angle is first angle - second angle (cpDampedRotarySpring.c).
            stiffness = element.stiffness * self.settings.unit * self.settings.unit
            self.space.add(constraints.DampedRotarySpring(*pair, -element.rest_angle, stiffness, 0.0))

    def torsion_damper(self, element: TorsionDamper, pair: Pair) -> None:
        if can_turn(pair[0]) or can_turn(pair[1]):
            self.space.add(constraints.DampedRotarySpring(*pair, 0.0, 0.0, element.damping * self.settings.unit))

    def force(self, element: Force, pair: Pair) -> None:
        (x, y), unit = element.force, self.settings.unit
        point = self.from_origin(element.second, element.second_point)
        self.pushed_points.setdefault(element.second, []).append((point, (x * unit * unit, y * unit * unit)))

    def torque(self, element: Torque, pair: Pair) -> None:
        for name, sign in ((element.first, -1.0), (element.second, 1.0)):
            if name is not None:
                torque = sign * element.torque * self.settings.unit * self.settings.unit
                self.torques[name] = self.torques.get(name, 0.0) + torque

    def _add_pushes(self) -> None:
        for name in dict.fromkeys((*self.pushed_points, *self.torques)):
            if self.bodies[name].body_type == pymunk.Body.DYNAMIC:
                push = _push(self.bodies[name], self.pushed_points.get(name, []), self.torques.get(name, 0.0))
                self.before_step.append(push)


def can_move(pair: Pair) -> bool:
    return pymunk.Body.DYNAMIC in (pair[0].body_type, pair[1].body_type)


def can_turn(body: pymunk.Body) -> bool:
    return body.body_type == pymunk.Body.DYNAMIC and body.moment < float("inf")


def _push(body: pymunk.Body, points: list[tuple[Vector, Vector]], torque: float) -> BeforeStep:
    """The update that sets a torque and constant forces (point, force) on a body for the pose after the drift."""
    pointer = body._body
    x, y = sum(force[0] for _, force in points), sum(force[1] for _, force in points)
    # Moments of the forces at the angles 0 and pi/2.
    across = sum(point[0] * force[1] - point[1] * force[0] for point, force in points)
    along = -sum(point[0] * force[0] + point[1] * force[1] for point, force in points)

    def push(ahead: float) -> None:
        angle = lib.cpBodyGetAngle(pointer) + lib.cpBodyGetAngularVelocity(pointer) * ahead
        lib.cpBodySetForce(pointer, (x, y))
        lib.cpBodySetTorque(pointer, torque + cos(angle) * across + sin(angle) * along)

    return push


# Constructions of joints. Other kinds of joints are refused.
CONSTRUCTIONS: Mapping[type, Callable[[_Builder, Any, Pair], Constraints]] = {
    Pin: _Builder.pin,
    Weld: _Builder.weld,
    Gear: _Builder.gear,
    Rod: _Builder.rod,
    Slot: _Builder.slot,
    Drive: _Builder.drive,
    Skate: _Builder.skate,
    Roll: _Builder.roll,
}
MUNK_FORCES: Mapping[type, Callable[[_Builder, Any, Pair], None]] = {
    Spring: _Builder.spring,
    Damper: _Builder.damper,
    TorsionSpring: _Builder.torsion_spring,
    TorsionDamper: _Builder.torsion_damper,
    Torque: _Builder.torque,
    Force: _Builder.force,
}
PYMUNK_CAPABILITY = Capability("pymunk", frozenset(CONSTRUCTIONS), frozenset(MUNK_FORCES))
