"""Two benchmarks of others, asked of any method: Gymnasium's Acrobot left to itself, and the engine Newton's bounds.

Acrobot: how much of its energy is lost, beside the numbers that a user published. Numbers of the links:
`gymnasium/envs/classic_control/acrobot.py`. The drift: github.com/Farama-Foundation/Gymnasium, issue 1714. It names no
start, and the drift depends on it by a factor of hundreds, so one number of three is used to find a start: both links
in line, at rest.

Newton: three small problems and their measures, tests 2, 3 and 10 of `newton/tests/test_physics_validation.py` of
github.com/newton-physics/newton.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory, energy, joint_gap
from reports.model.tasks import Task, Values
from reports.pages.common import OfMethod

Array = NDArray[np.float64]
ACROBOT_GRAVITY, HORIZON = 9.8, 100.0  # m/s^2, s
ACROBOT_STEPS = (0.2, 0.05, 0.01)  # s; the first is Gymnasium's own
PUBLISHED = (3.554e-3, 4.189e-6, 1.519e-8)  # of the first energy, at ACROBOT_STEPS
START = 0.30488863  # rad: found so that RK4 loses PUBLISHED[0] at ACROBOT_STEPS[0]; a test holds the two together


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
    return Mechanism(bodies, joints, (0.0, -ACROBOT_GRAVITY))


def _rates(state: Array) -> Array:
    """Of the two angles, the second against the first, and their rates: Lagrange's equations of the two links."""
    first, second, rate, relative = state
    coupling = 0.5 * math.cos(second)
    inertia = np.array([[3.5 + 2 * coupling, 1.25 + coupling], [1.25 + coupling, 1.25]])
    swirl = 0.5 * math.sin(second)
    low = 0.5 * ACROBOT_GRAVITY * math.sin(first + second)
    push = np.array(
        [
            swirl * relative * (relative + 2 * rate) - 1.5 * ACROBOT_GRAVITY * math.sin(first) - low,
            -swirl * rate**2 - low,
        ]
    )
    return np.array([rate, relative, *np.linalg.solve(inertia, push)])


def _energy(state: Array) -> float:
    first, second, rate, relative = state
    coupling = 0.5 * math.cos(second)
    kinetic = (1.75 + coupling) * rate**2 + (1.25 + coupling) * rate * relative + 0.625 * relative**2
    return kinetic - ACROBOT_GRAVITY * (1.5 * math.cos(first) + 0.5 * math.cos(first + second))


@lru_cache(maxsize=len(ACROBOT_STEPS))  # the same states are seen in 64 bits and in 32
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
class ByHand(Task):
    """The drift of RK4 in the two angles."""

    seconds: ClassVar[float] = 1.0
    words: ClassVar[str] = "Acrobot's energy: RK4"

    def run(self) -> Values:
        """`drift` (ACROBOT_STEPS,), and `rounded`, the same of states in 32 bits."""
        names = {"drift": False, "rounded": True}
        return {
            name: np.array([by_hand(START, step, rounded) for step in ACROBOT_STEPS]) for name, rounded in names.items()
        }


@dataclass(frozen=True)
class Acrobot(OfMethod):
    """The drift of one method."""

    what: ClassVar[str] = "Acrobot's energy"

    @property
    def cost(self) -> float:
        return sum(HORIZON / step for step in ACROBOT_STEPS) * 2 * self.method.step_cost(acrobot())

    def run(self) -> Values:
        """`drift` (ACROBOT_STEPS,), the largest change of the energy beside the first."""
        mechanism, drift = acrobot(), []
        for step in ACROBOT_STEPS:
            total = energy(mechanism, self.method.build(mechanism, step)(round(HORIZON / 0.2), round(0.2 / step)))
            drift.append(float(np.abs(total / total[0] - 1).max()) if np.isfinite(total).all() else float("inf"))
        return {"drift": np.array(drift)}


Array = NDArray[np.float64]
NEWTON_GRAVITY = 10.0  # m/s^2
LENGTH, RADIUS = 1.0, 0.01  # m: a ball on a rod without mass
SMALL, LARGE = 0.05, 1.0  # rad, at rest
PERIODS, FALLING = 3.5, 2.0  # s: of the small and of the large swing
NEWTON_STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)  # s; Newton's own are 1e-3 s, and 2e-4 s for the four-bar
EVERY = 1e-2  # s between samples: a multiple of all steps
# A degree of the rocker, metres of gap, parts of the amplitude and of the first energy.
BOUNDS = {"angle": 0.1, "gap": 1e-3, "period": 1e-2, "energy": 5e-3}
# A crank-rocker of bars with equal sections, one turn a second, no gravity.
BARS = {"crank": 0.2, "coupler": 0.5, "rocker": 0.4, "ground": (0.5, 0.0), "density": 1.6}
FOUR_BAR = DrivenFourBar(**BARS, start=0.0, rate=2 * math.pi, gravity=(0.0, 0.0), revolutions=2.0)


def pendulum(angle: float) -> Mechanism:
    """The ball at rest at this angle [rad] from hanging."""
    place = (LENGTH * math.sin(angle), -LENGTH * math.cos(angle), angle)
    ball = Body("ball", 1.0, 0.4 * RADIUS**2, place, (0.0, 0.0, 0.0))
    return Mechanism((ball,), (Pin("pivot", None, "ball", (0.0, 0.0), (0.0, LENGTH)),), (0.0, -NEWTON_GRAVITY))


def freudenstein(crank: Array) -> Array:
    """The rocker's angle [rad] at angles of the crank, by Freudenstein's equation; another way than the scene's."""
    a, b, c, d = FOUR_BAR.crank, FOUR_BAR.coupler, FOUR_BAR.rocker, FOUR_BAR.ground[0]
    size = d / a - np.cos(crank), -np.sin(crank)
    right = d / c * np.cos(crank) - (a * a - b * b + c * c + d * d) / (2 * a * c)
    return np.arctan2(size[1], size[0]) + np.arccos(np.clip(right / np.hypot(*size), -1, 1))


@dataclass(frozen=True)
class Newton(OfMethod):
    """One method in the three problems at NEWTON_STEPS."""

    what: ClassVar[str] = "Newton's bounds"

    @property
    def cost(self) -> float:
        total = FOUR_BAR.duration + PERIODS * 2 + FALLING
        return sum(total / step * self.method.step_cost(FOUR_BAR.mechanism()) for step in NEWTON_STEPS)

    def run(self) -> Values:
        """By the names of BOUNDS the measure (NEWTON_STEPS,) at every step; infinite for a run that gave up."""
        measured = [self._measures(step) for step in NEWTON_STEPS]
        return {name: np.array([values[name] for values in measured]) for name in BOUNDS}

    def _measures(self, step: float) -> dict[str, float]:
        linkage = self._motion(FOUR_BAR.mechanism(), FOUR_BAR.duration, step)
        crank, rocker = linkage.pose[:, 0, 2], linkage.pose[:, 2, 2]
        off = (rocker - freudenstein(crank) + math.pi) % (2 * math.pi) - math.pi
        gap = _largest(joint_gap(FOUR_BAR.mechanism(), linkage)[:, :8])
        return {
            "angle": _largest(np.degrees(off)),
            "gap": gap,
            "period": self._period(step),
            "energy": self._energy(step),
        }

    def _period(self, step: float) -> float:
        frequency = math.sqrt(NEWTON_GRAVITY * LENGTH / (LENGTH**2 + 0.4 * RADIUS**2))
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
