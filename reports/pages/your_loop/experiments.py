"""Errors in random mechanisms of each kind, and in linkages that users of pymunk build.

`linkages.json` has a list of elements for each linkage; the bodies come first. Lengths are in pixels, and y points
upwards. `["bars", density, group, corners]` is a body of thin bars between corners, which form a closed polygon if
there are more than two corners. `["pin", a, b, point]` is a pivot between two bodies. Bodies are numbered from 0, and
-1 is the ground. Points of bars, balls, boxes and pins are in the frame of the space. Points of grooves, springs and
rods are in the frames of the bodies.
"""

from __future__ import annotations

import hashlib
import itertools
import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from functools import lru_cache, partial
from math import inf, nan, pi
from pathlib import Path
from typing import Any, ClassVar, cast

import numpy as np
import pymunk
from pymunk import constraints as joints

from engines import Unsupported
from engines.pymunk.reading import read
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.check.judging import IdealMotion, reference_motion
from reports.check.judging import measure_errors as errors_of_run
from reports.model.tasks import Task, Values
from reports.pages.common import MethodTask

PAGE_STEP = 1e-3  # s
MILLISECONDS_PER_SAMPLE = 10
# The seed is the hash of the commit before this code was written, so it was not chosen for its results.
COMMIT = "007b1fa1"
COUNT = 60  # number of random mechanisms of each kind
LEAST_SAMPLES = 20
SCALE_EXPONENT = 1.0  # each number is multiplied by 2**x with x between -SCALE_EXPONENT and SCALE_EXPONENT
ANGLE_FIELDS = ("start", "angle", "start_angle")
UNCHANGED_FIELDS = ("links", "duration", "horizon", "branch", "friction", "density", "gravity")


def draw(scene: Scene, number: int) -> Mechanism:
    """Random mechanism `number` of the scene's kind. Lengths, masses and rates are scaled, and angles are random. The
    draw is repeated until the reference motion has more than LEAST_SAMPLES samples."""
    digest = hashlib.sha256(f"{COMMIT} {scene.name} {number}".encode()).hexdigest()
    random = np.random.default_rng(int(digest, 16))
    while True:
        changed: dict[str, Any] = {}
        for name in (field.name for field in fields(cast(Any, scene))):
            match getattr(scene, name):
                case _ if name == "branch":
                    changed[name] = int(random.choice((-1, 1)))
                case _ if name in UNCHANGED_FIELDS:
                    continue
                case float() if name in ANGLE_FIELDS:
                    changed[name] = float(random.uniform(-pi, pi))
                case float(value):
                    changed[name] = value * 2 ** float(random.uniform(-SCALE_EXPONENT, SCALE_EXPONENT))
                case tuple(values):
                    changed[name] = tuple(
                        value * 2 ** float(random.uniform(-SCALE_EXPONENT, SCALE_EXPONENT)) for value in values
                    )
                case _:
                    continue  # counts, names and choices are unchanged
        try:
            changed_scene: Any = replace(cast(Any, scene), **changed)
            mechanism = changed_scene.mechanism()
            if len(_ideal(mechanism, scene.samples, scene.duration).trajectory.t) > LEAST_SAMPLES:
                return mechanism
        except (InvalidMechanism, Unsupported, ValueError):
            continue


@lru_cache(maxsize=COUNT)  # all engines are compared with the same motions
def _ideal(mechanism: Mechanism, samples: int, duration: float) -> IdealMotion:
    return reference_motion(mechanism, samples, duration / samples)


@dataclass(frozen=True)
class Fresh(MethodTask):
    """A task with the errors of one method in COUNT random mechanisms of a scene's kind."""

    scene: Scene
    quantity: str = "angle"
    commit: str = COMMIT
    description: ClassVar[str] = f"{COUNT} random mechanisms like {{0.scene.name}}"
    seconds: ClassVar[float] = 20.0

    def run(self) -> Values:
        """`error` (mechanisms,): the largest error within the horizon of the ideal motion; inf for a failed run."""
        return {"error": np.array([self.error(number) for number in range(COUNT)])}

    def error(self, number: int) -> float:
        mechanism, samples = draw(self.scene, number), self.scene.samples
        ideal = _ideal(mechanism, samples, self.scene.duration)
        truth = ideal.trajectory
        run = self.method.build(mechanism, PAGE_STEP)(len(truth.t) - 1, round(float(truth.t[1]) / PAGE_STEP))
        compared = errors_of_run(mechanism, truth, run)
        early = compared.of[self.quantity][truth.t <= ideal.horizon]
        return float(early.max()) if np.isfinite(early).all() else inf


PLANS: Mapping[str, list[list[Any]]] = json.loads(Path(__file__).with_name("linkages.json").read_text(encoding="utf-8"))
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

GAP_DURATION = 10.0  # s; longer than the trial run of `choose`.
ANGLE_DURATION = 3.0  # s.
LINKAGE_STEP = 1 / 240  # s.


def run_lines(space: pymunk.Space, lines: str) -> dict[str, Any]:
    """Execute lines of Python in which `space` is defined, and return the global names after them."""
    names: dict[str, Any] = {"pymunk": pymunk, "space": space, "print": lambda *words: None}
    exec(lines, names)
    return names


@dataclass(frozen=True)
class BeforeAndAfter(Task):
    """A task with the errors of one linkage without and with the lines of the page."""

    linkage: str
    lines: str

    seconds: ClassVar[float] = 20.0
    words: ClassVar[str] = "with the lines: {0.linkage}"

    def run(self) -> Values:
        """`gap` (2,) [px] and `angle` (2,) [rad]: the largest errors without and with the lines. Angles are NaN if
        shapes touch or if the space is not an ideal mechanism. `iterations` is 0 if the lines do not change the
        space."""
        make = LINKAGES[self.linkage]
        shipped, closed, touched = make(), make(), []
        shipped.on_collision(begin=lambda *arguments: touched.append(True))
        shipped_settings = closed.iterations, {joint.error_bias for joint in closed.constraints}
        gaps = run_lines(closed, self.lines)["gaps"]
        changed_settings = closed.iterations, {joint.error_bias for joint in closed.constraints}
        angles = [[], []]
        worst = [0.0, 0.0]
        for index, space in enumerate((shipped, closed)):
            for step in range(round(GAP_DURATION / LINKAGE_STEP)):
                space.step(LINKAGE_STEP)
                worst[index] = max(worst[index], *gaps(space))
                if (step + 1) % MILLISECONDS_PER_SAMPLE == 0:
                    angles[index].append([body.angle for body in space.bodies])
        compared = [nan, nan] if touched else self._angle_errors(np.array(angles))
        return {
            "gap": np.array(worst),
            "angle": np.array(compared),
            "iterations": np.array(0 if shipped_settings == changed_settings else closed.iterations),
        }

    def _angle_errors(self, angles: np.ndarray) -> list[float]:
        """The largest errors (2,) of two sets of angles (2, times, bodies) [rad] until the horizon or the first
        obstacle."""
        space = LINKAGES[self.linkage]()
        try:
            reading = read(space, LINKAGE_STEP)
            spacing = MILLISECONDS_PER_SAMPLE * LINKAGE_STEP
            ideal = reference_motion(reading.mechanism, round(ANGLE_DURATION / spacing), spacing)
        except (InvalidMechanism, Unsupported):
            return [nan, nan]
        model: Any = reading.model
        truth = ideal.trajectory
        met = [obstacle.t for obstacle in model.obstacles(truth.t, truth.pose, truth.twist)]
        early = truth.t <= min(ideal.horizon, *met, ANGLE_DURATION)
        bodies = list(space.bodies)
        order = [bodies.index(body) for body in model.imported.moving]
        count = int(early.sum()) - 1
        errors = (
            np.abs(angles[:, :count, order] - truth.pose[1 : count + 1, :, 2]) if count > 0 else np.full((2, 1), nan)
        )
        return errors.reshape(2, -1).max(axis=1).tolist()
