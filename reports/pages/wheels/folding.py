"""The reference on a trailer that is pushed back: driven at an even speed, and coasting."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.trailers import CarWithTrailers
from reports.grid.tasks import Task, Values


@dataclass(frozen=True)
class Folding(Task):
    """A car with a trailer that starts backwards; driven it is looked at for `driven` [s]."""

    scene: CarAndTrailer
    driven: float

    @property
    def cost(self) -> float:
        return 0.1  # measured

    @property
    def label(self) -> str:
        return "the reference on a reversing trailer"

    def run(self) -> Values:
        """`jackknifed` [s]: when the trailer is square to the driven car; `t`, `pose`: of the truth, coasting."""
        scene = self.scene
        car = CarWithTrailers(scene.wheelbase, (scene.length,), (scene.hitch,))
        convoy = car.drive(scene.speed, scene.steering, scene.pose, (scene.bend,), [self.driven])
        when = np.nan if convoy.jackknifed_at is None else convoy.jackknifed_at
        t = np.linspace(0, scene.duration, scene.samples + 1)
        return {"jackknifed": np.asarray(when), "t": t, "pose": scene.motion(t).pose}
