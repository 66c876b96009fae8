"""Planar linkages as users of pymunk build them: in pixels, y up, mostly from rest. LINKAGES makes a new space of each.

`linkages.json` has the elements of each linkage by its name, bodies first: `["bars", density, group, corners]` is one
body of thin bars between its corners (closed if there are three or more); `["pin", a, b, point]` is a pivot of two
bodies, numbered from 0, with -1 for the ground. Points of bars, balls, boxes and pins are points of the space; points
of grooves, springs and rods are in the frames of the bodies. A new linkage is an entry of that file.
"""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Mapping
from functools import partial
from math import inf
from pathlib import Path
from typing import Any

import pymunk
from pymunk.constraints import (
    Constraint,
    DampedSpring,
    GearJoint,
    GrooveJoint,
    PinJoint,
    PivotJoint,
    RotaryLimitJoint,
    SimpleMotor,
)

PLANS: Mapping[str, list[list[Any]]] = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
PIXEL_GRAVITY = (0, -900)  # px/s^2
# The first word of an element between two bodies -> its class; the rest of the element are the arguments.
PYMUNK_JOINTS: Mapping[str, Callable[..., Constraint]] = {
    "pin": PivotJoint,
    "motor": SimpleMotor,
    "gear": GearJoint,
    "groove": GrooveJoint,
    "spring": DampedSpring,
    "rod": PinJoint,
    "limit": RotaryLimitJoint,
}


def bars(density: float, corners: list[list[float]]) -> tuple[pymunk.Body, list[pymunk.Shape]]:
    """A body of thin bars between the corners [px] with this mass per pixel, and its shapes."""
    points = [pymunk.Vec2d(*corner) for corner in corners]
    sides = list(itertools.pairwise(points)) + ([(points[-1], points[0])] if len(points) > 2 else [])
    masses = [density * (q - p).length for p, q in sides]
    weighted = [(p + q) / 2 * mass for (p, q), mass in zip(sides, masses, strict=True)]
    centre = sum(weighted, pymunk.Vec2d(0, 0)) / sum(masses)
    moment = sum(
        mass * ((q - p).length ** 2 / 12 + ((p + q) / 2 - centre).length ** 2)
        for (p, q), mass in zip(sides, masses, strict=True)
    )
    body = pymunk.Body(sum(masses), moment)
    body.position = centre
    return body, [pymunk.Segment(body, p - centre, q - centre, 3) for p, q in sides]


def body_of(kind: str, size: float, *rest: Any) -> tuple[pymunk.Body, list[pymunk.Shape]]:
    """The body of an element and its shapes; `size`: the mass, or the density of bars."""
    match kind, rest:
        case "bars", (_, corners):
            return bars(size, corners)
        case "ball", (_, at, radius):
            body = pymunk.Body(size, pymunk.moment_for_circle(size, 0, radius))
            shapes: list[pymunk.Shape] = [pymunk.Circle(body, radius)]
        case "box", (_, at, sides):
            body = pymunk.Body(size, pymunk.moment_for_box(size, sides))
            shapes = [pymunk.Poly.create_box(body, sides)]
        case _:  # a slider, which can't rotate and has no shape
            (at,) = rest
            body, shapes = pymunk.Body(size, inf), []
    body.position = tuple(at)
    return body, shapes


def make(name: str) -> pymunk.Space:
    """A new space with the linkage of this name."""
    space = pymunk.Space()
    space.gravity = PIXEL_GRAVITY
    bodies: list[pymunk.Body] = []
    for kind, *arguments in PLANS[name]:
        if kind == "gravity":
            space.gravity = tuple(arguments[0])
        elif kind == "ground":
            (x, y), (end_x, end_y) = arguments
            shape = pymunk.Segment(space.static_body, (x, y), (end_x, end_y), 5)
            shape.friction = 1.0
            space.add(shape)
        elif kind in PYMUNK_JOINTS:
            a, b, *rest = arguments
            joined = [space.static_body if index < 0 else bodies[index] for index in (a, b)]
            joint = PYMUNK_JOINTS[kind](*joined, *(tuple(each) if isinstance(each, list) else each for each in rest))
            space.add(joint)
        else:
            body, shapes = body_of(kind, *arguments)
            for shape in shapes:
                shape.filter, shape.friction = pymunk.ShapeFilter(group=arguments[1]), 1.0
            space.add(body, *shapes)
            bodies.append(body)
    return space


LINKAGES: Mapping[str, Callable[[], pymunk.Space]] = {name: partial(make, name) for name in PLANS}
