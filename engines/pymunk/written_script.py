"""A pymunk space as lines of Python that make it anew: for a script that runs without us."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import isfinite
from typing import Any

import numpy as np
import pymunk
from pymunk.constraints import PinJoint

from engines import Unsupported
from engines.pymunk.engine import Pymunk
from reference.forces import Force, Torque
from reference.joints import Skate
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll


def object_lines(space: pymunk.Space, bodies: Sequence[pymunk.Body]) -> list[str]:
    """Bodies b0, b1, ... and constraints j0, j1, ... of a space called `space`. Raises Unsupported for others."""
    lines = []
    for number, body in enumerate(bodies):
        kind = {0: "", 1: "body_type=pymunk.Body.KINEMATIC", 2: "body_type=pymunk.Body.STATIC"}[body.body_type]
        kind = kind or f"{body.mass!r}, {_number(body.moment)}"
        lines.append(f"b{number} = pymunk.Body({kind})")
        lines.append(f"b{number}.position, b{number}.angle = {tuple(body.position)!r}, {body.angle!r}")
        lines.append(
            f"b{number}.velocity, b{number}.angular_velocity = {tuple(body.velocity)!r}, {body.angular_velocity!r}"
        )
        lines.append(f"space.add(b{number})")
    names = {space.static_body: "space.static_body", **{body: f"b{i}" for i, body in enumerate(bodies)}}
    for number, joint in enumerate(space.constraints):
        lines.append(f"j{number} = pymunk.{_made(joint, f'{names[joint.a]}, {names[joint.b]}')}")
        lines.append(f"j{number}.error_bias = {joint.error_bias!r}")
        if isinstance(joint, PinJoint):
            lines.append(f"j{number}.distance = {joint.distance!r}")
        lines.append(f"space.add(j{number})")
    return lines


def _made(joint: Any, own: str) -> str:
    kind = type(joint).__name__
    match kind:
        case "PivotJoint" | "PinJoint":
            return f"{kind}({own}, {tuple(joint.anchor_a)!r}, {tuple(joint.anchor_b)!r})"
        case "GrooveJoint":
            ends = f"{tuple(joint.groove_a)!r}, {tuple(joint.groove_b)!r}"
            return f"GrooveJoint({own}, {ends}, {tuple(joint.anchor_b)!r})"
        case "SimpleMotor":
            return f"SimpleMotor({own}, {joint.rate!r})"
        case "GearJoint":
            return f"GearJoint({own}, {joint.phase!r}, {joint.ratio!r})"
        case "DampedSpring":
            anchors = f"{tuple(joint.anchor_a)!r}, {tuple(joint.anchor_b)!r}"
            return f"DampedSpring({own}, {anchors}, {joint.rest_length!r}, {joint.stiffness!r}, {joint.damping!r})"
        case "DampedRotarySpring":
            return f"DampedRotarySpring({own}, {joint.rest_angle!r}, {joint.stiffness!r}, {joint.damping!r})"
    raise Unsupported(f"a {kind} is not written")


def script(engine: Any, mechanism: Mechanism, dt: float) -> str:
    """A script with a function `make` that gives the space, and a loop that steps it.

    Raises Unsupported for a method that our code helps between its steps.
    """
    if not isinstance(engine, Pymunk):
        raise Unsupported("this variant is made of several runs; a script has one: take default or tuned")
    for joint in mechanism.joints:
        if isinstance(joint, Roll | Skate):
            what = "a roll is a contact of shapes there" if isinstance(joint, Roll) else "nothing holds a skate there"
            raise Unsupported(f"joint {joint.name!r}: pymunk has no such joint, {what}; a script would be no mechanism")
    steady = tuple(force for force in mechanism.forces if type(force) is Force or type(force) is Torque)
    model = engine.model(replace(mechanism, forces=tuple(each for each in mechanism.forces if each not in steady)), dt)
    if model.aims or model.repairs or engine.leapfrog:
        raise Unsupported("this variant needs code of ours before or after every step; its script would not be its own")
    if model.unit != 1:
        raise Unsupported("this variant counts time in steps, since a power of its error_bias would underflow")
    body = "\n    ".join(object_lines(model.space, model.bodies))
    pushed = _push_lines(mechanism, steady, model.bodies)
    again, push = ("\n        push(space)", "\n    push(space)") if pushed else ("", "")
    known = [f"b{number}.name = {name.name!r}" for number, name in enumerate(mechanism.bodies)]
    named = "\n    ".join(known)
    return f"""import pymunk

STEP = {dt!r}  # s


def make():
    space = pymunk.Space()
    space.gravity, space.iterations = {tuple(model.space.gravity)!r}, {model.space.iterations}
    {body}
    {named}{push}
    return space
{pushed}

if __name__ == "__main__":
    space = make()
    for number in range(round(1 / STEP) + 1):
        if number % max(1, round(0.1 / STEP)) == 0:
            poses = [(round(b.position.x, 6), round(b.position.y, 6), round(b.angle, 6)) for b in space.bodies]
            print(f"{{number * STEP:.4f}} s", poses){again}
        space.step(STEP)
"""


def _push_lines(mechanism: Mechanism, forces: Sequence[Force | Torque], bodies: Sequence[pymunk.Body]) -> str:
    """A function that sets the constant forces and torques, which pymunk takes off after every step; or nothing."""
    pushed = np.zeros((len(bodies), 3))
    for force in forces:
        if isinstance(force, Force):
            if force.second_point != (0.0, 0.0):
                raise Unsupported(
                    f"force {force.name!r} acts off the centre of mass, where its moment turns with the body; that "
                    "needs code before every step that no reader of a space could see"
                )
            pushed[mechanism.body_index(force.second), :2] += force.force
        else:
            for name, sign in ((force.first, -1.0), (force.second, 1.0)):
                if name is not None:
                    pushed[mechanism.body_index(name), 2] += sign * force.torque
    lines = [
        f"    {name.name!r}: ({tuple(each[:2].tolist())!r}, {float(each[2])!r}),"
        for name, each, body in zip(mechanism.bodies, pushed, bodies, strict=True)
        if each.any() and body.body_type == pymunk.Body.DYNAMIC
    ]
    if not lines:
        return ""
    told = "\n".join(lines)
    return f"""

# Forces [N] and torques [N m] by the body's name; pymunk takes them off after every step.
PUSHED = {{
{told}
}}


def push(space):
    for body in space.bodies:
        body.force, body.torque = PUSHED.get(body.name, ((0, 0), 0))
"""


def _number(value: float) -> str:
    return repr(value) if isfinite(value) else 'float("inf")'


class Script:
    """What `crosscheck export` asks of pymunk: a script."""

    suffix = ".py"

    def write(self, mechanism: Mechanism, dt: float, variant: str) -> str:
        """The script. Raises Unsupported where none can be written, ValueError for an unknown variant."""
        from engines.pymunk.methods import METHODS

        known = {engine.variant: engine for engine in METHODS}
        if variant not in known:
            raise ValueError(f"--variant is {variant!r}; it must be one of {', '.join(known)}")
        return script(known[variant], mechanism, dt)

    def commented(self, text: str, lines: Sequence[str]) -> str:
        """The text with a comment before it."""
        return "\n".join(f"# {line}".rstrip() for line in lines) + "\n" + text


SCRIPT = Script()
