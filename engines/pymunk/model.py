"""A mechanism as pymunk objects: one body for a body, no shapes, and for every joint what its own file makes of it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk._chipmunk_cffi import lib
from pymunk.constraints import Constraint, PivotJoint, SimpleMotor

from engines import Size, Unsupported
from engines.pymunk.drives import Crank, crank_body, find_cranks, motor
from engines.pymunk.pins import pin
from reference.joints import Drive, Joint, Pin
from reference.mechanism import Mechanism

# Scalar constraints of each kind of pymunk constraint; its solver has no others.
ROWS = {PivotJoint: 2, SimpleMotor: 1}


@dataclass(frozen=True)
class Model:
    """A space and its bodies in the mechanism's order.

    The origin of an engine's body is `origins` (bodies, 2) [m] in the mechanism's body frame: zero, the centre of mass,
    but for a crank, whose origin is its pin.
    """

    space: pymunk.Space
    bodies: tuple[pymunk.Body, ...]
    origins: NDArray[np.float64]
    size: Size

    def stepper(self, raw: bool) -> tuple[Callable[[Any, float], None], Any]:
        """(step, space) for `step(space, dt)`: the public `Space.step`, or the C function under it."""
        if raw:
            return lib.cpSpaceStep, self.space._space
        return pymunk.Space.step, self.space

    def kick(self, dt: float) -> None:
        """Forces and joints of one step of dt [s] act on the velocities, and no body moves."""
        for body in self.bodies:
            body.position_func = _stay  # pyright: ignore[reportAttributeAccessIssue]
        self.space.step(dt)
        for body in self.bodies:
            body.position_func = pymunk.Body.update_position  # pymunk restores the C pointer: no cost afterwards


def _stay(body: pymunk.Body, dt: float) -> None:
    """A position function without a drift."""


def build_model(mechanism: Mechanism, iterations: int, error_bias: float) -> Model:
    """The mechanism at t = 0; raises Unsupported."""
    space = pymunk.Space()
    space.gravity = mechanism.gravity
    space.iterations = iterations
    cranks = find_cranks(mechanism)
    bodies, origins = {}, []
    for description in mechanism.bodies:
        if description.name in cranks:
            bodies[description.name] = crank_body(cranks[description.name], description)
            origins.append(cranks[description.name].own_point)
        else:
            body = pymunk.Body(description.mass, description.inertia)
            body.position, body.angle = description.pose[:2], description.pose[2]
            body.velocity, body.angular_velocity = description.twist[:2], description.twist[2]
            bodies[description.name] = body
            origins.append((0.0, 0.0))
    space.add(*bodies.values())
    for joint in mechanism.joints:
        for constraint in _constraints(joint, space.static_body, bodies, cranks):
            constraint.error_bias = error_bias
            space.add(constraint)
    rows = sum(ROWS[type(constraint)] for constraint in space.constraints)
    size = Size(bodies=len(space.bodies), coordinates=3 * len(space.bodies), rows=rows, solver_rows=rows)
    return Model(space, tuple(bodies.values()), np.array(origins), size)


def _constraints(
    joint: Joint, ground: pymunk.Body, bodies: dict[str, pymunk.Body], cranks: dict[str, Crank]
) -> list[Constraint]:
    """What stands for one joint: nothing, where the motion of a crank already contains it."""
    if any(joint in (crank.pin, crank.drive) for crank in cranks.values()):
        return []
    first = ground if joint.first is None else bodies[joint.first]
    second = ground if joint.second is None else bodies[joint.second]
    if pymunk.Body.DYNAMIC not in (first.body_type, second.body_type):
        raise Unsupported(
            f"joint {joint.name!r} joins two bodies whose motion is already prescribed; "
            "a pymunk constraint needs one that forces can move"
        )
    match joint:
        case Pin():
            return [pin(joint, first, second, cranks)]
        case Drive():
            return [motor(joint, first, second)]
        case _:
            raise Unsupported(f"joint {joint.name!r}: pymunk has no construction for a {type(joint).__name__} here")
