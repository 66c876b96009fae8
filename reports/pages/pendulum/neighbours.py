"""How fast starts of a chaotic chain part that lie next to each other, by integrating some of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.scenes.pendulum.scenes import LinkPendulum
from reports.grid.tasks import Task, Values


@dataclass(frozen=True)
class Neighbours(Task):
    """A chain that starts at one angle and rate for all links, looked at at times [s]."""

    scene: LinkPendulum
    times: tuple[float, ...]

    @property
    def cost(self) -> float:
        return 0.3 * max(self.times)  # measured on two links: three neighbours and the motion itself, for 12 s

    @property
    def label(self) -> str:
        return f"neighbouring starts of {self.scene.name}"

    def run(self) -> Values:
        """`growth` (times,): how many times larger a small difference of the start has become."""
        scene = self.scene
        start, rate = np.full(scene.links, scene.angle), np.full(scene.links, scene.rate)
        return {"growth": scene.chain.divergence(start, rate, np.array(self.times))}
