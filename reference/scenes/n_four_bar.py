"""The exact motion of N four-bars side by side, a benchmark whose one freedom becomes N + 1 freedoms twice a turn.

The whole chain moves as one pendulum, which is a `Pendulum`. If the cranks are parallel to the couplers, N rows depend
on the remaining rows, and forces grow without limit for N > 1. The derivation is in `reference/scenes/derivations.md`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Count, NonNegative, Positive, require_room, validated
from reference.joints import Joint, Pin, bodies_of
from reference.mechanism import Mechanism
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scene import Scene
from reference.scenes.pendulum.link import Pendulum, direction_of
from reference.trajectory import Trajectory
from reference.validators import Array


@dataclass(frozen=True)
class NFourBar(Scene):
    """`loops` is N. Every bar has `length` [m] and `mass` [kg], and pivots have the distance `length`.

    The motion starts upright; the cranks' tops move at `speed` [m/s] to +x. The bodies are the cranks 0 to N and then
    the couplers 0 to N - 1.
    """

    name: ClassVar[str] = "n_four_bar_2"
    source: ClassVar[str] = (
        "IFToMM library of computational benchmark problems, A02 N-four-bar; section 18.5, closed chains"
    )
    loops: Count = 2
    length: Positive = 1.0
    mass: Positive = 1.0
    gravity: Positive = 9.81
    speed: float = 1.0
    duration: Positive = 10.0
    horizon: Positive = 10.0  # a symmetric motion, which engines may leave at singular positions

    @cached_property
    def pendulum(self) -> Pendulum:
        """The motion of the cranks' common angle. A motion to +x at the top is clockwise."""
        n = self.loops
        frequency = math.sqrt(3 * (3 * n + 1) * self.gravity / (2 * (4 * n + 1) * self.length))
        return Pendulum(frequency, math.pi, -self.speed / self.length)

    @property
    def period(self) -> float:
        """The time of a whole turn of the cranks [s], which is infinite if the cranks stay at the top."""
        return self.pendulum.period if self.speed else math.inf

    @validated
    def singular_times(self, until: NonNegative) -> Array:
        """The times [s] in [0, until] at which the cranks are parallel to the couplers."""
        if not self.speed:
            return np.zeros(0)
        sides = [self.pendulum.passages(side * math.pi / 2, until) for side in (1, -1)]
        return np.sort(np.concatenate(sides))

    def _placement(self, angle: Array, rate: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        down = direction_of(angle)
        velocity, linear = rotation_velocity(rate, down), rotation_acceleration(rate, acceleration, down)
        cranks, couplers = self.loops + 1, self.loops
        size = self.length

        def bodies(point: Array, turn: Array) -> Array:
            out = np.zeros((len(angle), cranks + couplers, 3))
            out[:, :cranks, :2] = 0.5 * size * point[:, None]
            out[:, :cranks, 2] = turn[:, None]
            out[:, cranks:, :2] = size * point[:, None]
            return out

        pose = bodies(down, angle - math.pi / 2)
        pose[:, :cranks, 0] += size * np.arange(cranks)
        pose[:, cranks:, 0] += size * (np.arange(couplers) + 0.5)
        return pose, bodies(velocity, rate), bodies(linear, acceleration)

    def mechanism(self) -> Mechanism:
        state = (value[None] for value in (np.array(math.pi), np.array(self.pendulum.rate), np.array(0.0)))
        pose, twist, _ = self._placement(*state)
        names = [f"crank {i}" for i in range(self.loops + 1)] + [f"coupler {i}" for i in range(self.loops)]
        same = np.full(len(names), self.mass)
        bodies = bodies_of(names, same, same * self.length**2 / 12, pose[0], twist[0])
        half = self.length / 2
        joints: list[Joint] = [
            Pin(f"A{i}", None, f"crank {i}", (i * self.length, 0.0), (-half, 0.0)) for i in range(self.loops + 1)
        ]
        for i in range(self.loops):
            joints.append(Pin(f"B{i} right", f"crank {i}", f"coupler {i}", (half, 0.0), (-half, 0.0)))
            joints.append(Pin(f"B{i + 1} left", f"crank {i + 1}", f"coupler {i}", (half, 0.0), (half, 0.0)))
        return Mechanism(bodies, tuple(joints), (0.0, -self.gravity))

    def _motion(self, times: Array) -> Trajectory:
        require_room(f"scene {self.name!r}: a trajectory", (len(times), 2 * self.loops + 1, 3))
        # A chain at rest stays at the top. `Pendulum` would fall, since no double is exactly pi.
        zero = np.zeros(len(times))
        angle, rate, acceleration = self.pendulum.motion(times) if self.speed else (zero + math.pi, zero, zero)
        pose, twist, _ = self._placement(angle, rate, acceleration)
        return Trajectory(times, pose, twist, self.forces(angle, rate, acceleration))

    @validated
    def forces(self, angle: Array, rate: Array, acceleration: Array) -> Array:
        """The reactions (times, rows) [N] in closed form, accurate also near a singular position.

        A coupler that doesn't rotate has equal vertical forces at its ends. A crank's balance of moments about the
        pivot gives the horizontal force on the crank's top. Each coupler's balance of forces gives the force on the
        next crank.
        """
        n, m, size = self.loops, self.mass, self.length
        _, _, moving = self._placement(angle, rate, acceleration)
        coupler = m * (moving[:, -1, :2] + np.array([0.0, self.gravity]))
        crank = m * (moving[:, 0, :2] + np.array([0.0, self.gravity]))
        down = direction_of(angle)
        top = np.zeros((len(angle), n + 1, 2))  # forces of the couplers on each crank's top
        top[:, :, 1] = -coupler[:, None, 1] * np.where(np.arange(n + 1) % n == 0, 0.5, 1.0)
        # The balance of moments is solved for the horizontal force, whose lever arm is -l down_y.
        moment = m * size**2 / 3 * acceleration + 0.5 * m * self.gravity * size * down[:, 0]
        top[:, :, 0] = (size * down[:, 0, None] * top[:, :, 1] - moment[:, None]) / (size * down[:, 1, None])
        out = np.zeros((len(angle), 2 * (3 * n + 1)))
        out[:, : 2 * (n + 1)] = (crank[:, None] - top).reshape(len(angle), -1)
        of_last_coupler = np.zeros(len(angle))  # force along x of coupler i - 1 on the top of crank i
        for i in range(n):
            first = 2 * (n + 1) + 4 * i
            on_coupler = -(top[:, i, 0] - of_last_coupler)
            out[:, first], out[:, first + 1] = on_coupler, 0.5 * coupler[:, 1]
            out[:, first + 2], out[:, first + 3] = coupler[:, 0] - on_coupler, 0.5 * coupler[:, 1]
            of_last_coupler = -(coupler[:, 0] - on_coupler)
        return out

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        """+1 if every loop is a parallelogram, or -1 if a loop is folded with its coupler along a crank.

        In a folded loop one crank lies along the ground and the other crank along the coupler. The form whose angles
        fit best has the branch. At a singular position all forms fit, and the branch is +1.
        """
        cranks, couplers = pose[..., : self.loops + 1, 2], pose[..., self.loops + 1 :, 2]
        first, second = cranks[..., :-1], cranks[..., 1:]
        parallel = 2 - np.cos(couplers) - np.cos(first - second)
        folded_left = 2 - np.cos(first) - np.cos(couplers - second)  # The first crank's top on the second pivot.
        folded_right = 2 + np.cos(second) + np.cos(couplers - first)  # The second crank's top on the first pivot.
        return np.where(np.all(parallel <= np.minimum(folded_left, folded_right), axis=-1), 1, -1)


@dataclass(frozen=True)
class TenFourBars(NFourBar):
    """Ten loops."""

    name: ClassVar[str] = "n_four_bar_10"
    loops: Count = 10

    @property
    def samples(self) -> int:
        """The benchmark has twenty samples per second."""
        return max(1, round(20 * self.duration))


@dataclass(frozen=True)
class FortyFourBars(NFourBar):
    """The benchmark with its original size and time, N = 40 and 20 s."""

    name: ClassVar[str] = "n_four_bar_40"
    loops: Count = 40
    duration: Positive = 20.0
    horizon: Positive = 20.0

    @property
    def samples(self) -> int:
        """Five samples per second, a quarter of the benchmark's, since 242 reactions cost more than the motion."""
        return max(1, round(5 * self.duration))
