"""Two published benchmarks: the energy of Gymnasium's Acrobot, and the bounds in tests of the engine Newton.

Acrobot: issue 1714 of github.com/Farama-Foundation/Gymnasium publishes the drift of the energy at three steps. The data
of the links are from `gymnasium/envs/classic_control/acrobot.py`. The issue does not state the initial state, which
changes the drift by a factor of hundreds. Here both links are initially in line and at rest. The initial angle is
chosen so that RK4 has the published drift at the largest step.

Newton: the problems and bounds are copied from the tests 2, 3 and 10 in `newton/tests/test_physics_validation.py` of
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
from reports.pages.common import MethodTask

Array = NDArray[np.float64]
ACROBOT_GRAVITY, HORIZON = 9.8, 100.0  # m/s^2, s.
ACROBOT_STEPS = (0.2, 0.05, 0.01)  # s; Gymnasium's step is 0.2 s.
PUBLISHED = (3.554e-3, 4.189e-6, 1.519e-8)  # Relative drift of the energy at ACROBOT_STEPS.
ACROBOT_START = 0.30488863  # rad; with this angle, RK4 has the drift PUBLISHED[0] at ACROBOT_STEPS[0].


def acrobot() -> Mechanism:
    """Two links of 1 m, 1 kg and 1 kg m^2 in line and at rest. Their angle [rad] is 0 in the hanging pose."""
    angle = ACROBOT_START
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
    """The time derivative of a state (first angle, relative second angle, both rates)."""
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


@lru_cache(maxsize=len(ACROBOT_STEPS))
def _path(angle: float, step: float) -> Array:
    state = np.array([angle, 0.0, 0.0, 0.0])
    states = [state]
    for _ in range(round(HORIZON / step)):
        k1 = _rates(state)
        k2 = _rates(state + step / 2 * k1)
        k3 = _rates(state + step / 2 * k2)
        state = state + step / 6 * (k1 + 2 * k2 + 2 * k3 + _rates(state + step * k3))
        states.append(state)
    return np.array(states)


def rk4_drift(angle: float, step: float, rounded: bool = False) -> float:
    """The relative drift of the energy by RK4. With `rounded`, energies are computed from states in 32 bits."""
    states = _path(angle, step)
    if rounded:
        angles = [
            np.arctan2(*(f(states[:, i]).astype(np.float32).astype(float) for f in (np.sin, np.cos))) for i in (0, 1)
        ]
        states = np.column_stack([*angles, states[:, 2:].astype(np.float32).astype(float)])
    total = np.array([_energy(state) for state in states])
    return float(np.abs(total / total[0] - 1).max())


@dataclass(frozen=True)
class DirectRK4(Task):
    """A task with the drift of Acrobot's energy by RK4 in the two angles."""

    seconds: ClassVar[float] = 1.0
    words: ClassVar[str] = "Acrobot's energy: RK4"

    def run(self) -> Values:
        """`drift` and `rounded` (steps,): see `rk4_drift`."""
        names = {"drift": False, "rounded": True}
        return {
            name: np.array([rk4_drift(ACROBOT_START, step, rounded) for step in ACROBOT_STEPS])
            for name, rounded in names.items()
        }


@dataclass(frozen=True)
class Acrobot(MethodTask):
    """A task with the drift of Acrobot's energy in an engine."""

    description: ClassVar[str] = "Acrobot's energy"

    @property
    def cost(self) -> float:
        return sum(HORIZON / step for step in ACROBOT_STEPS) * 2 * self.method.step_cost(acrobot())

    def run(self) -> Values:
        """`drift` (steps,): the largest change of the energy, relative to the initial energy."""
        mechanism, drift = acrobot(), []
        for step in ACROBOT_STEPS:
            total = energy(mechanism, self.method.build(mechanism, step)(round(HORIZON / 0.2), round(0.2 / step)))
            drift.append(float(np.abs(total / total[0] - 1).max()) if np.isfinite(total).all() else float("inf"))
        return {"drift": np.array(drift)}


NEWTON_GRAVITY = 10.0  # m/s^2.
ROD_LENGTH, BALL_RADIUS = 1.0, 0.01  # m; the rod is massless.
SMALL_SWING, LARGE_SWING = 0.05, 1.0  # rad; initial angles.
PERIODS = 3.5  # Duration of the small swing in periods.
LARGE_SWING_DURATION = 2.0  # s.
NEWTON_STEPS = (1e-2, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)  # s; Newton's tests use 1e-3 s, and 2e-4 s for the four-bar.
SAMPLE_INTERVAL = 1e-2  # s.
# "angle": error of the rocker [degrees]. "gap": largest gap [m]. "period": mean error of the small swing relative to
# its amplitude. "energy": relative drift of the energy.
NEWTON_BOUNDS = {"angle": 0.1, "gap": 1e-3, "period": 1e-2, "energy": 5e-3}
# A crank-rocker of bars with equal cross-sections, without gravity. The crank makes one turn per second.
CRANK_ROCKER = {"crank": 0.2, "coupler": 0.5, "rocker": 0.4, "ground": (0.5, 0.0), "density": 1.6}
NEWTON_FOUR_BAR = DrivenFourBar(**CRANK_ROCKER, start=0.0, rate=2 * math.pi, gravity=(0.0, 0.0), revolutions=2.0)


def pendulum(angle: float) -> Mechanism:
    """A ball on a rod at rest. The `angle` [rad] is 0 in the hanging pose."""
    pose = (ROD_LENGTH * math.sin(angle), -ROD_LENGTH * math.cos(angle), angle)
    ball = Body("ball", 1.0, 0.4 * BALL_RADIUS**2, pose, (0.0, 0.0, 0.0))
    return Mechanism((ball,), (Pin("pivot", None, "ball", (0.0, 0.0), (0.0, ROD_LENGTH)),), (0.0, -NEWTON_GRAVITY))


def freudenstein(crank: Array) -> Array:
    """The angles of the rocker [rad] by Freudenstein's equation, from angles of the crank [rad]."""
    a, b, c, d = NEWTON_FOUR_BAR.crank, NEWTON_FOUR_BAR.coupler, NEWTON_FOUR_BAR.rocker, NEWTON_FOUR_BAR.ground[0]
    x, y = d / a - np.cos(crank), -np.sin(crank)
    right = d / c * np.cos(crank) - (a * a - b * b + c * c + d * d) / (2 * a * c)
    return np.arctan2(y, x) + np.arccos(np.clip(right / np.hypot(x, y), -1, 1))


@dataclass(frozen=True)
class NewtonBounds(MethodTask):
    """A task with the measured quantities of Newton's tests for an engine."""

    description: ClassVar[str] = "Newton's bounds"

    @property
    def cost(self) -> float:
        total = NEWTON_FOUR_BAR.duration + PERIODS * 2 + LARGE_SWING_DURATION
        return sum(total / step * self.method.step_cost(NEWTON_FOUR_BAR.mechanism()) for step in NEWTON_STEPS)

    def run(self) -> Values:
        """The values (steps,) of each quantity in NEWTON_BOUNDS; infinite for a run that diverged."""
        measured = [self._measures(step) for step in NEWTON_STEPS]
        return {name: np.array([values[name] for values in measured]) for name in NEWTON_BOUNDS}

    def _measures(self, step: float) -> dict[str, float]:
        linkage = self._motion(NEWTON_FOUR_BAR.mechanism(), NEWTON_FOUR_BAR.duration, step)
        crank, rocker = linkage.pose[:, 0, 2], linkage.pose[:, 2, 2]
        error = (rocker - freudenstein(crank) + math.pi) % (2 * math.pi) - math.pi
        gap = _largest(joint_gap(NEWTON_FOUR_BAR.mechanism(), linkage)[:, :8])
        return {
            "angle": _largest(np.degrees(error)),
            "gap": gap,
            "period": self._period(step),
            "energy": self._energy(step),
        }

    def _period(self, step: float) -> float:
        frequency = math.sqrt(NEWTON_GRAVITY * ROD_LENGTH / (ROD_LENGTH**2 + 0.4 * BALL_RADIUS**2))
        swing = self._motion(pendulum(SMALL_SWING), PERIODS * 2 * math.pi / frequency, step)
        error = np.abs(swing.pose[:, 0, 2] - SMALL_SWING * np.cos(frequency * swing.t))
        return float(np.mean(error[1:]) / SMALL_SWING) if np.isfinite(error).all() else float("inf")

    def _energy(self, step: float) -> float:
        mechanism = pendulum(LARGE_SWING)
        total = energy(mechanism, self._motion(mechanism, LARGE_SWING_DURATION, step))
        return _largest((total - total[0]) / total[0])

    def _motion(self, mechanism: Mechanism, duration: float, step: float) -> Trajectory:
        return self.method.build(mechanism, step)(int(duration / SAMPLE_INTERVAL), round(SAMPLE_INTERVAL / step))


def _largest(values: Array) -> float:
    return float(np.abs(values).max()) if np.isfinite(values).all() else float("inf")
