"""Errors in random mechanisms of each kind, and in linkages that users of pymunk build."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, fields, replace
from functools import lru_cache
from math import inf, nan, pi
from typing import Any, ClassVar, cast

import numpy as np
import pymunk

from engines import Unsupported
from engines.pymunk.reading import read
from reference.checks import InvalidMechanism
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.check.judging import IdealMotion, reference_motion
from reports.check.judging import measure_errors as errors_of_run
from reports.model.tasks import Task, Values
from reports.pages.common import MethodTask
from reports.pages.your_loop.linkages import LINKAGES

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
