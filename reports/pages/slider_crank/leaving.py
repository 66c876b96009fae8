"""When the truth leaves a dead centre, by its own motion at many instants."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.scenes.slider_crank.scenes import SliderAtDeadCentre
from reports.grid.tasks import Task, Values

FAR = 1.0  # rad
INSTANTS = 3001  # so that the time is known to a millisecond


@dataclass(frozen=True)
class Leaving(Task):
    """A slider that starts a crank, `angle` [rad] beside its dead centre."""

    angle: float

    @property
    def cost(self) -> float:
        return 0.4  # measured

    @property
    def label(self) -> str:
        return f"leaving a dead centre from {self.angle:g} rad"

    def run(self) -> Values:
        """`when`: the first of INSTANTS over the scene's duration at which the crank is further than FAR [s]."""
        scene = SliderAtDeadCentre(angle=self.angle)
        t = [scene.duration * i / (INSTANTS - 1) for i in range(INSTANTS)]
        far = scene.motion(t).pose[:, 0, 2] > FAR
        return {"when": np.asarray(t[int(np.argmax(far))] if far.any() else np.nan)}
