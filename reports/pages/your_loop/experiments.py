"""What the page measures beyond the rows of scenes: fresh mechanisms of each kind, and linkages of users of pymunk."""

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
from reports.check.judging import IdealMotion, errors, judged
from reports.model.tasks import Task, Values
from reports.pages.common import OfMethod
from reports.pages.your_loop.linkages import LINKAGES

STEP, EVERY = 1e-3, 10  # s, and steps from sample to sample
# The mechanisms are drawn from the hash of the last commit before this draw was written, so that nobody chose them and
# the same are drawn each time.
COMMIT = "007b1fa1"
COUNT = 60
LEAST_SAMPLES = 20  # a motion that can be compared for less than this is drawn again
SPREAD = 1.0  # each number is multiplied by 2 to the power of -SPREAD to SPREAD
ANGLES = ("start", "angle", "start_angle")  # fields that are angles [rad]: any is drawn
FIXED = ("links", "duration", "horizon", "branch", "friction", "density", "gravity")  # not drawn as numbers


def draw(scene: Scene, number: int) -> Mechanism:
    """Mechanism `number` of the scene's kind: its sizes, masses and rates times a random factor, at any angle.

    Drawn again while the numbers make no mechanism, or one whose motion is not known for LEAST_SAMPLES.
    """
    digest = hashlib.sha256(f"{COMMIT} {scene.name} {number}".encode()).hexdigest()
    random = np.random.default_rng(int(digest, 16))
    while True:
        changed: dict[str, Any] = {}
        # Fields alone: a scene that was used keeps what it has worked out among its attributes.
        for name in (each.name for each in fields(cast(Any, scene))):
            match getattr(scene, name):
                case _ if name == "branch":
                    changed[name] = int(random.choice((-1, 1)))
                case _ if name in FIXED:
                    continue
                case float() if name in ANGLES:
                    changed[name] = float(random.uniform(-pi, pi))
                case float(value):
                    changed[name] = value * 2 ** float(random.uniform(-SPREAD, SPREAD))
                case tuple(values):
                    changed[name] = tuple(value * 2 ** float(random.uniform(-SPREAD, SPREAD)) for value in values)
        try:
            changed_scene: Any = replace(cast(Any, scene), **changed)
            mechanism = changed_scene.mechanism()
            if len(_ideal(mechanism, scene.samples, scene.duration).trajectory.t) > LEAST_SAMPLES:
                return mechanism
        except (InvalidMechanism, Unsupported, ValueError):
            continue


@lru_cache(maxsize=COUNT)  # all engines are compared with the same motions
def _ideal(mechanism: Mechanism, samples: int, duration: float) -> IdealMotion:
    return judged(mechanism, samples, duration / samples)


@dataclass(frozen=True)
class Fresh(OfMethod):
    """One method in COUNT fresh mechanisms of a scene's kind, beside the exact solver."""

    scene: Scene
    quantity: str = "angle"
    commit: str = COMMIT
    what: ClassVar[str] = f"{COUNT} fresh mechanisms as {{0.scene.name}}"
    seconds: ClassVar[float] = 20.0

    def run(self) -> Values:
        """`error` (COUNT,): the largest until neighbouring starts part exponentially; inf where the run ends."""
        return {"error": np.array([self.error(number) for number in range(COUNT)])}

    def error(self, number: int) -> float:
        """Of mechanism `number` [rad, or m for positions]."""
        mechanism, samples = draw(self.scene, number), self.scene.samples
        ideal = _ideal(mechanism, samples, self.scene.duration)
        truth = ideal.trajectory
        run = self.method.build(mechanism, STEP)(len(truth.t) - 1, round(float(truth.t[1]) / STEP))
        compared = errors(mechanism, truth, run)
        early = compared.of[self.quantity][truth.t <= ideal.horizon]
        return float(early.max()) if np.isfinite(early).all() else inf


SECONDS, COMPARED = 10.0, 3.0  # s: the gaps are measured for longer than `choose` has seen, angles for less
LINKAGE_STEP = 1 / 240  # s, a usual one of games; shorter steps take several minutes of CPU time for all linkages


def run_lines(space: pymunk.Space, lines: str) -> dict[str, Any]:
    """The names that the lines leave behind, pasted where the space is ready to be stepped."""
    names: dict[str, Any] = {"pymunk": pymunk, "space": space, "print": lambda *words: None}
    exec(lines, names)
    return names


@dataclass(frozen=True)
class BeforeAndAfter(Task):
    """One linkage as shipped, and with the lines of the page."""

    linkage: str
    lines: str

    seconds: ClassVar[float] = 20.0
    words: ClassVar[str] = "with the lines: {0.linkage}"

    def run(self) -> Values:
        """`gap` (2,) [px], as shipped and with the lines, and `angle` (2,) [rad] beside the exact solver, NaN where
        shapes touch or the space is no ideal mechanism; `iterations`, 0 where the lines leave the space as shipped."""
        make = LINKAGES[self.linkage]
        shipped, closed, touched = make(), make(), []
        shipped.on_collision(begin=lambda *arguments: touched.append(True))
        before = closed.iterations, {joint.error_bias for joint in closed.constraints}
        gaps = run_lines(closed, self.lines)["gaps"]
        after = closed.iterations, {joint.error_bias for joint in closed.constraints}
        angles = [[], []]
        worst = [0.0, 0.0]
        for place, space in enumerate((shipped, closed)):
            for step in range(round(SECONDS / LINKAGE_STEP)):
                space.step(LINKAGE_STEP)
                worst[place] = max(worst[place], *gaps(space))
                if (step + 1) % EVERY == 0:
                    angles[place].append([body.angle for body in space.bodies])
        compared = [nan, nan] if touched else self._angle_errors(np.array(angles))
        return {
            "gap": np.array(worst),
            "angle": np.array(compared),
            "iterations": np.array(0 if before == after else closed.iterations),
        }

    def _angle_errors(self, angles: np.ndarray) -> list[float]:
        """Of angles (2, times, bodies) [rad], until neighbouring starts part exponentially or an obstacle is met."""
        space = LINKAGES[self.linkage]()
        try:
            reading = read(space, LINKAGE_STEP)
            spacing = EVERY * LINKAGE_STEP
            ideal = judged(reading.mechanism, round(COMPARED / spacing), spacing)
        except (InvalidMechanism, Unsupported):
            return [nan, nan]
        model: Any = reading.model
        truth = ideal.trajectory
        met = [obstacle.t for obstacle in model.obstacles(truth.t, truth.pose, truth.twist)]
        early = truth.t <= min(ideal.horizon, *met, COMPARED)
        bodies = list(space.bodies)
        order = [bodies.index(body) for body in model.described.moving]
        count = int(early.sum()) - 1
        apart = (
            np.abs(angles[:, :count, order] - truth.pose[1 : count + 1, :, 2]) if count > 0 else np.full((2, 1), nan)
        )
        return apart.reshape(2, -1).max(axis=1).tolist()
