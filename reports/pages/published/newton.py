"""The bounds by which the engine Newton validates itself, asked of any method: three small problems and their measures.

Numbers and measures: `newton/tests/test_physics_validation.py` of github.com/newton-physics/newton (tests 2, 3 and 10).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines import Engine
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory, energy, joint_gap
from reports.model.tasks import Task, Values

Array = NDArray[np.float64]
GRAVITY = 10.0  # m/s^2
LENGTH, RADIUS = 1.0, 0.01  # m: a ball on a rod without mass
SMALL, LARGE = 0.05, 1.0  # rad, at rest
PERIODS, FALLING = 3.5, 2.0  # s: of the small and of the large swing
STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)  # s; Newton's own are 1e-3 s, and 2e-4 s for the four-bar
EVERY = 1e-2  # s between samples: a multiple of all steps
# A degree of the rocker, metres of gap, parts of the amplitude and of the first energy.
BOUNDS = {"angle": 0.1, "gap": 1e-3, "period": 1e-2, "energy": 5e-3}
# A crank-rocker of bars with equal sections, one turn a second, no gravity.
FOUR_BAR = DrivenFourBar(
    crank=0.2,
    coupler=0.5,
    rocker=0.4,
    ground=(0.5, 0.0),
    start=0.0,
    rate=2 * math.pi,
    density=1.6,
    gravity=(0.0, 0.0),
    revolutions=2.0,
)


def pendulum(angle: float) -> Mechanism:
    """The ball at rest at this angle [rad] from hanging."""
    place = (LENGTH * math.sin(angle), -LENGTH * math.cos(angle), angle)
    ball = Body("ball", 1.0, 0.4 * RADIUS**2, place, (0.0, 0.0, 0.0))
    return Mechanism((ball,), (Pin("pivot", None, "ball", (0.0, 0.0), (0.0, LENGTH)),), (0.0, -GRAVITY))


def freudenstein(crank: Array) -> Array:
    """The rocker's angle [rad] at angles of the crank, by Freudenstein's equation; another way than the scene's."""
    a, b, c, d = FOUR_BAR.crank, FOUR_BAR.coupler, FOUR_BAR.rocker, FOUR_BAR.ground[0]
    size = d / a - np.cos(crank), -np.sin(crank)
    right = d / c * np.cos(crank) - (a * a - b * b + c * c + d * d) / (2 * a * c)
    open_side = np.arctan2(size[1], size[0]) + np.arccos(np.clip(right / np.hypot(*size), -1, 1))
    return open_side


@dataclass(frozen=True)
class Newton(Task):
    """One method in the three problems at STEPS."""

    method: Engine

    @property
    def cost(self) -> float:
        total = FOUR_BAR.duration + PERIODS * 2 + FALLING
        return sum(total / step * self.method.step_cost(FOUR_BAR.mechanism()) for step in STEPS)

    @property
    def label(self) -> str:
        return f"Newton's bounds: {self.method.name} {self.method.variant}"

    @property
    def engine(self) -> Engine:
        return self.method

    def run(self) -> Values:
        """By the names of BOUNDS the measure (STEPS,) at every step; infinite for a run that gave up."""
        told = {name: np.full(len(STEPS), np.inf) for name in BOUNDS}
        for index, step in enumerate(STEPS):
            linkage = self._motion(FOUR_BAR.mechanism(), FOUR_BAR.duration, step)
            crank, rocker = linkage.pose[:, 0, 2], linkage.pose[:, 2, 2]
            off = (rocker - freudenstein(crank) + math.pi) % (2 * math.pi) - math.pi
            told["angle"][index] = _largest(np.degrees(off))
            told["gap"][index] = _largest(joint_gap(FOUR_BAR.mechanism(), linkage)[:, :8])
            told["period"][index] = self._period(step)
            told["energy"][index] = self._energy(step)
        return told

    def _period(self, step: float) -> float:
        frequency = math.sqrt(GRAVITY * LENGTH / (LENGTH**2 + 0.4 * RADIUS**2))
        found = self._motion(pendulum(SMALL), PERIODS * 2 * math.pi / frequency, step)
        off = np.abs(found.pose[:, 0, 2] - SMALL * np.cos(frequency * found.t))
        return float(np.mean(off[1:]) / SMALL) if np.isfinite(off).all() else float("inf")

    def _energy(self, step: float) -> float:
        mechanism = pendulum(LARGE)
        total = energy(mechanism, self._motion(mechanism, FALLING, step))
        return _largest((total - total[0]) / total[0])

    def _motion(self, mechanism: Mechanism, duration: float, step: float) -> Trajectory:
        return self.method.build(mechanism, step)(int(duration / EVERY), round(EVERY / step))


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if np.isfinite(values).all() else float("inf")
