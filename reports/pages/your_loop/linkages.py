"""Planar linkages as users of pymunk build them. Lengths are in pixels, and y points upwards.

`linkages.json` has a list of elements for each linkage; the bodies come first. `["bars", density, group, corners]` is a
body of thin bars between corners, which form a closed polygon if there are more than two corners. `["pin", a, b,
point]` is a pivot between two bodies. Bodies are numbered from 0, and -1 is the ground. Points of bars, balls, boxes
and pins are in the frame of the space. Points of grooves, springs and rods are in the frames of the bodies.
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
from pymunk import constraints as joints

PLANS: Mapping[str, list[list[Any]]] = json.loads(Path(__file__).with_suffix(".json").read_text(encoding="utf-8"))
PIXEL_GRAVITY = (0, -900)  # px/s^2.
# First word of an element -> its class. Further words are the arguments of the class.
PYMUNK_JOINTS: Mapping[str, Callable[..., joints.Constraint]] = {
    "pin": joints.PivotJoint,
    "motor": joints.SimpleMotor,
    "gear": joints.GearJoint,
    "groove": joints.GrooveJoint,
    "spring": joints.DampedSpring,
    "rod": joints.PinJoint,
    "limit": joints.RotaryLimitJoint,
}


def bars(density: float, corners: list[list[float]]) -> tuple[pymunk.Body, list[pymunk.Shape]]:
    """A body of thin bars between the corners [px], and its shapes. `density` is the mass per pixel."""
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


def body_of(kind: str, mass: float, *arguments: Any) -> tuple[pymunk.Body, list[pymunk.Shape]]:
    """The body of an element, and its shapes. For bars, `mass` is the mass per pixel."""
    match kind, arguments:
        case "bars", (_, corners):
            return bars(mass, corners)
        case "ball", (_, at, radius):
            body = pymunk.Body(mass, pymunk.moment_for_circle(mass, 0, radius))
            shapes: list[pymunk.Shape] = [pymunk.Circle(body, radius)]
        case "box", (_, at, sides):
            body = pymunk.Body(mass, pymunk.moment_for_box(mass, sides))
            shapes = [pymunk.Poly.create_box(body, sides)]
        case _:  # this is a slider, which can't rotate and has no shape
            (at,) = arguments
            body, shapes = pymunk.Body(mass, inf), []
    body.position = tuple(at)
    return body, shapes


def make(name: str) -> pymunk.Space:
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
            joined = [space.static_body if index < 0 else bodies[index] for index in arguments[:2]]
            further = [tuple(value) if isinstance(value, list) else value for value in arguments[2:]]
            space.add(PYMUNK_JOINTS[kind](*joined, *further))
        else:
            body, shapes = body_of(kind, *arguments)
            for shape in shapes:
                shape.filter, shape.friction = pymunk.ShapeFilter(group=arguments[1]), 1.0
            space.add(body, *shapes)
            bodies.append(body)
    return space


LINKAGES: Mapping[str, Callable[[], pymunk.Space]] = {name: partial(make, name) for name in PLANS}
