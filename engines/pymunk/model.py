"""A mechanism as pymunk objects: a body for each body, for every joint what its own file makes of it, and forces.

A spring is a kick at the pose after the drift, like gravity, and costs no order. A damper takes part in the sweeps: it
shrinks the velocity that they have reached so far by exp(-damping dt / mass felt), after the kicks of the same step and
not half before and half after them. That is of first order. Chipmunk forgets a body's force and torque in every step,
and adds them after the drift, so they are set for the pose that the drift will lead to, which is known exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import cos, sin
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import (
    Constraint,
    DampedRotarySpring,
    DampedSpring,
    GearJoint,
    GrooveJoint,
    PinJoint,
    PivotJoint,
    SimpleMotor,
)

from engines import Size, Unsupported
from engines.capability import Capability
from engines.pymunk.joints.drive import crank_body, find_cranks, find_turned, motor, turned_body
from engines.pymunk.joints.roll import Contact, MovedPivot, RollConstruction, extent_of, touching
from engines.pymunk.joints.slide import SkateConstruction, SlotConstruction, blade, slide
from reference.couplings import Coupling
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Vector, Weld
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll

CAPABILITY = Capability(
    "pymunk",
    frozenset({Pin, Weld, Gear, Rod, Slot, Drive, Skate, Roll}),
    frozenset({Spring, Damper, TorsionSpring, TorsionDamper, Torque, Force}),
)
Locate = Callable[[str | None, Vector], Vector]  # a point of a body [m], from the engine's origin
# Scalar constraints of each kind of pymunk constraint; its solver has no others.
ROWS = {PivotJoint: 2, SimpleMotor: 1, GrooveJoint: 1, PinJoint: 1, GearJoint: 1}


@dataclass(frozen=True)
class Settings:
    """What a model is built with: sweeps, the part of a gap that is left after a unit of time, constructions.

    `unit` [s] is the engine's second: its velocities, gravity and steps are counted in it.
    """

    iterations: int
    error_bias: float
    unit: float
    skate: SkateConstruction
    roll: RollConstruction
    slot: SlotConstruction
    contact: Contact


@dataclass(frozen=True)
class Model:
    """A space and its bodies in the mechanism's order.

    The origin of an engine's body is `origins` (bodies, 2) [m] in the mechanism's body frame: zero, the centre of mass,
    but for a crank, whose origin is its pin. `aims` are called with the length of the coming drift before every step,
    `repairs` after it. Both, and the engine's velocities, are in the `unit` [s] of time.
    """

    space: pymunk.Space
    bodies: tuple[pymunk.Body, ...]
    origins: NDArray[np.float64]
    size: Size
    unit: float = 1.0
    aims: tuple[Callable[[float], None], ...] = ()
    repairs: tuple[Callable[[], None], ...] = ()

    def stepper(self, raw: bool) -> tuple[Callable[[Any, float], None], Any]:
        """(step, space) for `step(space, dt)`: the public `Space.step`, or the C function under it, with aims."""
        step, space = (lib.cpSpaceStep, self.space._space) if raw else (pymunk.Space.step, self.space)
        aims, repairs = self.aims, self.repairs
        if not (aims or repairs):
            return step, space
        if len(aims) == 1 and not repairs:
            aim = aims[0]

            def aimed(space: Any, dt: float) -> None:
                aim(dt)
                step(space, dt)

            return aimed, space

        def handled(space: Any, dt: float) -> None:
            for each in aims:
                each(dt)
            step(space, dt)
            for each in repairs:
                each()

        return handled, space

    def kick(self, dt: float) -> None:
        """Forces and joints of one step of dt [units] act on the velocities, and no body moves."""
        for aim in self.aims:
            aim(0.0)
        for body in self.bodies:
            body.position_func = _stay  # pyright: ignore[reportAttributeAccessIssue]
        self.space.step(dt)
        for body in self.bodies:
            body.position_func = pymunk.Body.update_position  # pymunk restores the C pointer: no cost afterwards
        for repair in self.repairs:
            repair()


def _stay(body: pymunk.Body, dt: float) -> None:
    """A position function without a drift."""


def build_model(mechanism: Mechanism, settings: Settings) -> Model:
    """The mechanism at t = 0; raises Unsupported."""
    CAPABILITY.require(mechanism)
    return _Builder(mechanism, settings).model()


class _Builder:
    """What the joints of one mechanism need of it while they are made."""

    def __init__(self, mechanism: Mechanism, settings: Settings) -> None:
        self.mechanism, self.settings = mechanism, settings
        self.space = pymunk.Space()
        x, y = mechanism.gravity
        self.space.gravity = (x * settings.unit * settings.unit, y * settings.unit * settings.unit)
        self.space.iterations = settings.iterations
        self.cranks, self.turned = find_cranks(mechanism), find_turned(mechanism)
        self.bodies = {description.name: self._body(description) for description in mechanism.bodies}
        self.space.add(*self.bodies.values())
        self.aims: list[Callable[[float], None]] = []
        self.repairs: list[Callable[[], None]] = []
        self.rows = self.solver_rows = 0
        self.rolls = 0

    def _body(self, description: Any) -> pymunk.Body:
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
                # A blade that is aimed has no gap: to close what rounding shows of one would only add noise.
                aimed = isinstance(joint, Skate) and self.settings.skate == "groove"
                constraint.error_bias = 1.0 if aimed else self.settings.error_bias
                self.space.add(constraint)
                self.rows += ROWS[type(constraint)]
                self.solver_rows += ROWS[type(constraint)]
        self._add_forces()
        count = len(self.bodies)
        size = Size(bodies=count, coordinates=3 * count, rows=self.rows, solver_rows=self.solver_rows)
        origins = np.array([self._origin(name) for name in self.bodies])
        unit = self.settings.unit
        return Model(
            self.space, tuple(self.bodies.values()), origins, size, unit, tuple(self.aims), tuple(self.repairs)
        )

    def _add_forces(self) -> None:
        unit, ground = self.settings.unit, self.space.static_body
        for element in self.mechanism.forces:
            first, second = (ground if name is None else self.bodies[name] for name in (element.first, element.second))
            constraint = spring(element, first, second, self._own, unit)
            if constraint is not None:
                self.space.add(constraint)
        self.aims += applied(self.mechanism.forces, self.bodies, self._own, unit)

    def _origin(self, name: str | None) -> Vector:
        return self.cranks[name].own_point if name in self.cranks else (0.0, 0.0)

    def _own(self, name: str | None, point: Vector) -> Vector:
        """A point of the mechanism's body frame [m], from the engine's origin."""
        x, y = self._origin(name)
        return (point[0] - x, point[1] - y)

    def _anchors(self, joint: Pin | Rod | Weld | Slot) -> tuple[Vector, Vector]:
        """Both points of a joint [m] from the engine's origins: two anchors, so that an open joint stays visible."""
        return self._own(joint.first, joint.first_point), self._own(joint.second, joint.second_point)

    def _constraints(self, joint: Joint) -> list[Constraint]:
        """What stands for one joint: nothing, where a prescribed motion already contains it."""
        if any(joint in (crank.pin, crank.drive) for crank in self.cranks.values()) or joint in self.turned.values():
            return []
        ground = self.space.static_body
        first = ground if joint.first is None else self.bodies[joint.first]
        second = ground if joint.second is None else self.bodies[joint.second]
        self._refuse_prescribed(joint, first, second)
        settings = self.settings
        match joint:
            case Pin():
                return [PivotJoint(first, second, *self._anchors(joint))]
            case Drive():
                return [motor(joint, first, second, settings.unit)]
            case Rod():
                constraint = PinJoint(first, second, *self._anchors(joint))
                constraint.distance = joint.length  # pymunk takes the distance at the start
                return [constraint]
            case Gear():
                # Chipmunk holds ratio angle_b - angle_a = phase (preStep in its cpGearJoint.c), so both are inverted.
                return [GearJoint(first, second, joint.phase / joint.ratio, 1 / joint.ratio)]
            case Weld():
                pivot = PivotJoint(first, second, *self._anchors(joint))
                return [pivot, GearJoint(first, second, joint.angle, 1.0)]
            case Slot():
                scale = self.mechanism.length_scale
                constraints, aims = slide(joint, settings.slot, first, second, *self._anchors(joint), scale)
                self.aims += aims
                return constraints
            case Skate():
                point = self._own(joint.second, joint.second_point)
                constraints, aims, repairs = blade(
                    joint, settings.skate, first, second, point, self.mechanism.length_scale
                )
                self.aims += aims
                self.repairs += repairs
                self.rows += 0 if constraints else 1  # held by hand
                return constraints
            case Roll():
                return self._roll(joint, first, second)
            case Coupling():
                raise Unsupported(f"joint {joint.name!r}: our adapter of pymunk builds no coupling")

    def _roll(self, joint: Roll, first: pymunk.Body, second: pymunk.Body) -> list[Constraint]:
        if self.settings.roll != "contact":
            origins = self._origin(joint.first), self._origin(joint.second)
            pivot = MovedPivot(joint, first, second, origins)
            self.aims.append(pivot)
            return [pivot.constraint]
        contact = self.settings.contact
        self.space.collision_slop, self.space.collision_bias = contact.slop, contact.bias**self.settings.unit
        sides = tuple(
            (body, lambda p, n=name: self._own(n, p)) for body, name in ((first, joint.first), (second, joint.second))
        )
        shapes = touching(joint, contact, extent_of(self.mechanism), self.rolls, sides)  # pyright: ignore[reportArgumentType]
        self.space.add(*shapes)
        self.rolls += 1
        self.rows += 2
        # Every contact point has a row along its normal and one along its tangent; a side has two points.
        flat = sum(isinstance(shape, pymunk.Circle) for shape in shapes) == 0
        self.solver_rows += 4 if flat else 2
        return []

    def _refuse_prescribed(self, joint: Joint, first: pymunk.Body, second: pymunk.Body) -> None:
        turns = any(name is not None and name not in self.turned for name in (joint.first, joint.second))
        moves = pymunk.Body.DYNAMIC in (first.body_type, second.body_type)
        free = (moves or isinstance(joint, Drive | Gear)) and (turns or not isinstance(joint, Drive | Gear | Weld))
        if not free:
            raise Unsupported(
                f"joint {joint.name!r} joins two bodies whose motion is already prescribed; "
                "a pymunk constraint needs one that forces can move"
            )


def spring(
    element: ForceElement, first: pymunk.Body, second: pymunk.Body, own: Locate, unit: float
) -> Constraint | None:
    """pymunk's spring for an element, in the `unit` [s] of time; None for one that is applied, or that moves nothing.

    A body whose motion is prescribed feels no force, and a spring between two of those would divide by zero.
    """
    match element:
        case Spring() | Damper() if pymunk.Body.DYNAMIC in (first.body_type, second.body_type):
            anchors = own(element.first, element.first_point), own(element.second, element.second_point)
            if isinstance(element, Spring):
                return DampedSpring(first, second, *anchors, element.rest_length, element.stiffness * unit * unit, 0.0)
            return DampedSpring(first, second, *anchors, 0.0, 0.0, element.damping * unit)
        case TorsionSpring() | TorsionDamper() if _turns(first) or _turns(second):
            # Chipmunk's relative angle is that of the first against the second (cpDampedRotarySpring.c).
            if isinstance(element, TorsionSpring):
                return DampedRotarySpring(first, second, -element.rest_angle, element.stiffness * unit * unit, 0.0)
            return DampedRotarySpring(first, second, 0.0, 0.0, element.damping * unit)
    return None


def _turns(body: pymunk.Body) -> bool:
    """Whether a torque would change a body's rate."""
    return body.body_type == pymunk.Body.DYNAMIC and body.moment < float("inf")


def applied(
    forces: Sequence[ForceElement], bodies: dict[str, pymunk.Body], own: Locate, unit: float
) -> list[Callable[[float], None]]:
    """What sets constant forces and torques before a step: one function a body, none for a body without."""
    points: dict[str, list[tuple[Vector, Vector]]] = {}
    torques: dict[str, float] = {}
    for element in forces:
        match element:
            case Force():
                x, y = element.force
                own_point = own(element.second, element.second_point)
                points.setdefault(element.second, []).append((own_point, (x * unit * unit, y * unit * unit)))
            case Torque():
                for name, sign in ((element.first, -1.0), (element.second, 1.0)):
                    if name is not None:
                        torques[name] = torques.get(name, 0.0) + sign * element.torque * unit * unit
            case _:
                pass
    return [
        _pushing(bodies[name], points.get(name, []), torques.get(name, 0.0))
        for name in dict.fromkeys((*points, *torques))
        if bodies[name].body_type == pymunk.Body.DYNAMIC
    ]


def _pushing(body: pymunk.Body, points: list[tuple[Vector, Vector]], torque: float) -> Callable[[float], None]:
    pointer = body._body
    x, y = sum(force[0] for _, force in points), sum(force[1] for _, force in points)
    # The moment of all forces at the angle 0, and a quarter of a turn later.
    across = sum(point[0] * force[1] - point[1] * force[0] for point, force in points)
    along = -sum(point[0] * force[0] + point[1] * force[1] for point, force in points)

    def push(ahead: float) -> None:
        angle = lib.cpBodyGetAngle(pointer) + lib.cpBodyGetAngularVelocity(pointer) * ahead
        lib.cpBodySetForce(pointer, (x, y))
        lib.cpBodySetTorque(pointer, torque + cos(angle) * across + sin(angle) * along)

    return push
