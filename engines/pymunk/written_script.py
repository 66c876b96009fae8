"""Write a Python script that makes a pymunk space and does not need this package."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np
import pymunk
from pymunk import constraints

from engines import Unsupported
from engines.pymunk.engine import Pymunk
from reference.forces import Force, Torque
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll


def _point(vector: Any) -> str:
    return repr(tuple(vector))


# Arguments of constraints after the two bodies. Other kinds of constraints are refused.
ARGUMENTS: Mapping[type[constraints.Constraint], Callable[[Any], tuple[str, ...]]] = {
    constraints.PivotJoint: lambda joint: (_point(joint.anchor_a), _point(joint.anchor_b)),
    constraints.PinJoint: lambda joint: (_point(joint.anchor_a), _point(joint.anchor_b)),
    constraints.GrooveJoint: lambda joint: (_point(joint.groove_a), _point(joint.groove_b), _point(joint.anchor_b)),
    constraints.SimpleMotor: lambda joint: (repr(joint.rate),),
    constraints.GearJoint: lambda joint: (repr(joint.phase), repr(joint.ratio)),
    constraints.DampedSpring: lambda joint: (
        *(_point(joint.anchor_a), _point(joint.anchor_b)),
        *(repr(joint.rest_length), repr(joint.stiffness), repr(joint.damping)),
    ),
    constraints.DampedRotarySpring: lambda joint: (repr(joint.rest_angle), repr(joint.stiffness), repr(joint.damping)),
}


def object_lines(space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> list[str]:
    """Lines that make bodies (b0, b1 and so on) and constraints (j0, j1 and so on) in `space`; raises Unsupported."""
    lines = []
    for number, body in enumerate(bodies):
        kind = {0: "", 1: "body_type=pymunk.Body.KINEMATIC", 2: "body_type=pymunk.Body.STATIC"}[body.body_type]
        moment = repr(body.moment) if isfinite(body.moment) else 'float("inf")'
        lines.append(f"b{number} = pymunk.Body({kind or f'{body.mass!r}, {moment}'})")
        lines.append(f"b{number}.position, b{number}.angle = {_point(body.position)}, {body.angle!r}")
        lines.append(
            f"b{number}.velocity, b{number}.angular_velocity = {_point(body.velocity)}, {body.angular_velocity!r}"
        )
        lines.append(f"space.add(b{number})")
    names = {space.static_body: "space.static_body", **{body: f"b{i}" for i, body in enumerate(bodies)}}
    for number, joint in enumerate(space.constraints):
        kind = type(joint).__name__
        if type(joint) not in ARGUMENTS:
            raise Unsupported(f"a {kind} is not written")
        arguments = ", ".join((names[joint.a], names[joint.b], *ARGUMENTS[type(joint)](joint)))
        lines.append(f"j{number} = pymunk.{kind}({arguments})")
        lines.append(f"j{number}.error_bias = {joint.error_bias!r}")
        if isinstance(joint, constraints.PinJoint):
            lines.append(f"j{number}.distance = {joint.distance!r}")
        lines.append(f"space.add(j{number})")
    return lines


def script(engine: Any, mechanism: Mechanism, dt: float) -> str:
    """A script with a function `make` that returns the space, and a loop that steps the space.

    Raises Unsupported for a method that needs our code between steps.
    """
    if not isinstance(engine, Pymunk):
        raise Unsupported("this variant consists of several runs, but a script makes one; choose default or tuned")
    for joint in mechanism.joints:
        if isinstance(joint, Roll | Skate):
            reason = "and a contact of shapes is no roll" if isinstance(joint, Roll) else "and no joint is a skate"
            raise Unsupported(
                f"joint {joint.name!r}: pymunk has no such joint, {reason}; a script would be another mechanism"
            )
    constant = tuple(force for force in mechanism.forces if type(force) is Force or type(force) is Torque)
    others = tuple(force for force in mechanism.forces if force not in constant)
    model = engine.model(replace(mechanism, forces=others), dt)
    if model.before_step or model.after_step or engine.leapfrog:
        raise Unsupported("this variant needs our code before or after every step, which a script does not contain")
    if model.unit != 1:
        raise Unsupported(
            "this variant uses its step as the unit of time, since its error_bias would underflow in seconds"
        )
    body = "\n    ".join(object_lines(model.space, model.bodies))
    push_function = _push_function(mechanism, constant, model.bodies)
    again, push = ("\n        push(space)", "\n    push(space)") if push_function else ("", "")
    named = "\n    ".join(f"b{number}.name = {body.name!r}" for number, body in enumerate(mechanism.bodies))
    return f"""import pymunk

STEP = {dt!r}  # s


def make():
    space = pymunk.Space()
    space.gravity, space.iterations = {_point(model.space.gravity)}, {model.space.iterations}
    {body}
    {named}{push}
    return space
{push_function}

if __name__ == "__main__":
    space = make()
    for number in range(round(1 / STEP) + 1):
        if number % max(1, round(0.1 / STEP)) == 0:
            poses = [(round(b.position.x, 6), round(b.position.y, 6), round(b.angle, 6)) for b in space.bodies]
            print(f"{{number * STEP:.4f}} s", poses){again}
        space.step(STEP)
"""


def _push_function(mechanism: Mechanism, forces: Sequence[Force | Torque], bodies: Sequence[pymunk.Body]) -> str:
    """The text of a function that sets the constant forces and torques, or "" if there are no such loads."""
    pushed = np.zeros((len(bodies), 3))
    for force in forces:
        if isinstance(force, Force):
            if force.second_point != (0.0, 0.0):
                raise Unsupported(
                    f"force {force.name!r} acts off the centre of mass, where its moment turns with the body; that "
                    "needs code before every step, which a reader of the space could not see"
                )
            pushed[mechanism.body_index(force.second), :2] += force.force
        else:
            for name, sign in ((force.first, -1.0), (force.second, 1.0)):
                if name is not None:
                    pushed[mechanism.body_index(name), 2] += sign * force.torque
    lines = [
        f"    {description.name!r}: ({_point(values[:2].tolist())}, {float(values[2])!r}),"
        for description, values, body in zip(mechanism.bodies, pushed, bodies, strict=True)
        if values.any() and body.body_type == pymunk.Body.DYNAMIC
    ]
    if not lines:
        return ""
    entries = "\n".join(lines)
    return f"""

# Forces [N] and torques [N m] by the name of the body. pymunk resets them in every step.
PUSHED = {{
{entries}
}}


def push(space):
    for body in space.bodies:
        body.force, body.torque = PUSHED.get(body.name, ((0, 0), 0))
"""


class ScriptWriter:
    suffix = ".py"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        from engines.pymunk.methods import METHODS

        methods = {engine.variant: engine for engine in METHODS}
        if variant not in methods:
            raise ValueError(f"--variant is {variant!r}; it must be one of {', '.join(methods)}")
        return script(methods[variant], mechanism, dt)

    def commented(self, text: str, lines: Sequence[str]) -> str:
        return "\n".join(f"# {line}".rstrip() for line in lines) + "\n" + text


SCRIPT = ScriptWriter()
