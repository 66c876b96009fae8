"""The chapter's pseudocode of the four-bar, which integrates rates alone, held against the closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.grid.tasks import Task, Values

SAMPLES = 50  # a revolution
EVALUATION = 10e-6  # s


@dataclass(frozen=True)
class PrintedRates(Task):
    """(18.70) and (18.71) under RK45 at a relative tolerance, the absolute one a thousandth of it."""

    revolutions: int
    tolerance: float

    @property
    def cost(self) -> float:
        # About a hundred evaluations a revolution at 1e-3; a method of order 5 takes steps as the fifth root.
        return self.revolutions * 100 * (1e-3 / self.tolerance) ** 0.2 * EVALUATION

    @property
    def label(self) -> str:
        return f"printed rates over {self.revolutions} revolutions at {self.tolerance:g}"

    def run(self) -> Values:
        """`error`: the largest of beta [rad]; `evaluations` of the rates; `stopped`: why, if before the end."""
        scene = DrivenFourBar()
        t = np.linspace(0, self.revolutions * scene.duration, SAMPLES * self.revolutions + 1)
        beta, _ = scene.four_bar.angles(scene.start + scene.rate * t)
        found = scene.four_bar.integrate_rates(
            t, scene.rate, scene.start, rtol=self.tolerance, atol=self.tolerance * 1e-3
        )
        alive = np.isfinite(found.beta)
        return {
            "error": np.max(np.abs(found.beta - beta)[alive]),
            "evaluations": np.asarray(float(found.evaluations)),
            "stopped": found.stopped or "",
        }
