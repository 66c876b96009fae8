"""Gymnasium's Acrobot left to itself: how much of its energy is lost, beside the numbers that a user published.

Numbers of the links: `gymnasium/envs/classic_control/acrobot.py`. The drift: github.com/Farama-Foundation/Gymnasium,
issue 1714. It names no start, and the drift depends on it by a factor of hundreds, so one number of three is used to
find a start: both links in line, at rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from engines import Engine
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.trajectory import energy
from reports.model.tasks import Task, Values

Array = NDArray[np.float64]
GRAVITY, HORIZON = 9.8, 100.0  # m/s^2, s
STEPS = (0.2, 0.05, 0.01)  # s; the first is Gymnasium's own
PUBLISHED = (3.554e-3, 4.189e-6, 1.519e-8)  # of the first energy, at STEPS
START = 0.30488863  # rad: found so that RK4 loses PUBLISHED[0] at STEPS[0]; a test holds the two together


def acrobot(angle: float = START) -> Mechanism:
    """Two links of 1 m, 1 kg and 1 kg m^2, in line at an angle [rad] from hanging, at rest."""
    along = np.array([math.sin(angle), -math.cos(angle)])
    bodies = tuple(
        Body(name, 1.0, 1.0, (*(distance * along).tolist(), angle), (0.0, 0.0, 0.0))
        for name, distance in (("upper", 0.5), ("lower", 1.5))
    )
    joints = (
        Pin("shoulder", None, "upper", (0.0, 0.0), (0.0, 0.5)),
        Pin("elbow", "upper", "lower", (0.0, -0.5), (0.0, 0.5)),
    )
    return Mechanism(bodies, joints, (0.0, -GRAVITY))


def _rates(state: Array) -> Array:
    """Of the two angles, the second against the first, and their rates: Lagrange's equations of the two links."""
    first, second, rate, relative = state
    coupling = 0.5 * math.cos(second)
    inertia = np.array([[3.5 + 2 * coupling, 1.25 + coupling], [1.25 + coupling, 1.25]])
    swirl = 0.5 * math.sin(second)
    low = 0.5 * GRAVITY * math.sin(first + second)
    push = np.array(
        [swirl * relative * (relative + 2 * rate) - 1.5 * GRAVITY * math.sin(first) - low, -swirl * rate**2 - low]
    )
    return np.array([rate, relative, *np.linalg.solve(inertia, push)])


def _energy(state: Array) -> float:
    first, second, rate, relative = state
    coupling = 0.5 * math.cos(second)
    kinetic = (1.75 + coupling) * rate**2 + (1.25 + coupling) * rate * relative + 0.625 * relative**2
    return kinetic - GRAVITY * (1.5 * math.cos(first) + 0.5 * math.cos(first + second))


@lru_cache(maxsize=len(STEPS))  # the same states are seen in 64 bits and in 32
def _path(angle: float, step: float) -> Array:
    """Angles and rates (steps + 1, 4) by RK4."""
    state = np.array([angle, 0.0, 0.0, 0.0])
    seen = [state]
    for _ in range(round(HORIZON / step)):
        one = _rates(state)
        two = _rates(state + step / 2 * one)
        three = _rates(state + step / 2 * two)
        state = state + step / 6 * (one + 2 * two + 2 * three + _rates(state + step * three))
        seen.append(state)
    return np.array(seen)


def by_hand(angle: float, step: float, rounded: bool = False) -> float:
    """The drift of RK4 in the two angles; `rounded`: of states seen in numbers of 32 bits, as Gymnasium shows them."""
    states = _path(angle, step)
    if rounded:
        shown = [
            np.arctan2(*(f(states[:, i]).astype(np.float32).astype(float) for f in (np.sin, np.cos))) for i in (0, 1)
        ]
        states = np.column_stack([*shown, states[:, 2:].astype(np.float32).astype(float)])
    total = np.array([_energy(state) for state in states])
    return float(np.abs(total / total[0] - 1).max())


@dataclass(frozen=True)
class Acrobot(Task):
    """The drift of one method, or of RK4 by hand without one."""

    method: Engine | None = None

    @property
    def cost(self) -> float:
        steps = sum(HORIZON / step for step in STEPS)
        return 2 * steps * (1e-4 if self.method is None else self.method.step_cost(acrobot()))

    @property
    def label(self) -> str:
        return f"Acrobot's energy: {'RK4' if self.method is None else f'{self.method.name} {self.method.variant}'}"

    @property
    def engine(self) -> Engine | None:
        return self.method

    def run(self) -> Values:
        """`drift` (STEPS,), the largest change of the energy beside the first; of RK4 also `rounded`."""
        if self.method is None:
            told = [[by_hand(START, step, rounded) for step in STEPS] for rounded in (False, True)]
            return {"drift": np.array(told[0]), "rounded": np.array(told[1])}
        mechanism, drift = acrobot(), []
        for step in STEPS:
            total = energy(mechanism, self.method.build(mechanism, step)(round(HORIZON / 0.2), round(0.2 / step)))
            drift.append(float(np.abs(total / total[0] - 1).max()) if np.isfinite(total).all() else float("inf"))
        return {"drift": np.array(drift)}
