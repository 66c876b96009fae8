"""The chapter's double pendulum and its 100-link pendulum, and one of 10 links between, released from horizontal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Count, Positive, require_room
from reference.joints import Pin, bodies_of
from reference.mechanism import Mechanism
from reference.scene import Scene, shared
from reference.scenes.pendulum.chain import Chain
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LinkPendulum(Scene):
    """`links` uniform bars, each of `length` [m] and `mass` [kg]; the last is `tip` times heavier.

    All start at the same `angle` [rad] from the downward vertical and `rate` [rad/s]. The horizon is measured
    (`Chain.horizon`): until then a small difference grows less than tenfold.
    """

    name: ClassVar[str] = "pendulum_2"
    source: ClassVar[str] = "problems 18.5.1 and 18.5.2; section 18.5, closed kinematic chains: a double pendulum"
    reach: ClassVar[float] = 2.0  # a chaotic truth: by then a pendulum of two links has lost half of its digits
    links: Count = 2
    length: Positive = 1.0
    mass: Positive = 1.0
    tip: Positive = 1.0
    gravity: float = 9.81
    angle: float = math.pi / 2
    rate: float = 0.0
    duration: Positive = 5.0
    horizon: Positive = 3.0

    @cached_property
    def chain(self) -> Chain:
        masses = (self.mass,) * (self.links - 1) + (self.mass * self.tip,)
        return Chain((self.length,) * self.links, masses, self.gravity)

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """Angles and rates (times, links) at times t >= 0 [s]."""
        return self._states(self.times(t))

    def _states(self, times: Array) -> tuple[Array, Array]:
        require_room(f"scene {self.name!r}: a trajectory", (len(times), self.links, 3))
        until = max(self.duration, float(times.max(initial=0.0)))
        start = (self.angle,) * self.links, (self.rate,) * self.links
        state = shared(Chain.solved, self.chain, *start, until)(times)
        return state[:, : self.links], state[:, self.links :]

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound on the truth's own error (times,) [rad, rad/s]."""
        return self.chain.truth_error(np.full(self.links, self.angle), np.full(self.links, self.rate), self.times(t))

    def mechanism(self) -> Mechanism:
        angle, rate = np.full(self.links, self.angle), np.full(self.links, self.rate)
        pose, twist, _ = self.chain.placement(angle, rate, np.zeros(self.links))
        names = [f"link {i + 1}" for i in range(self.links)]
        bodies = bodies_of(names, self.chain.masses, self.chain.inertia, pose, twist)
        half = self.length / 2
        joints = tuple(
            Pin(
                f"joint {i + 1}",
                bodies[i - 1].name if i else None,
                bodies[i].name,
                (half, 0.0) if i else (0.0, 0.0),
                (-half, 0.0),
            )
            for i in range(self.links)
        )
        return Mechanism(bodies, joints, (0.0, -self.gravity))

    def _motion(self, times: Array) -> Trajectory:
        angle, rate = self._states(times)
        pose, twist, _ = self.chain.placement(angle, rate, np.zeros_like(angle))
        return Trajectory(times, pose, twist, self.chain.forces(angle, rate).reshape(len(times), -1))


@dataclass(frozen=True)
class TenLinks(LinkPendulum):
    """Ten links."""

    name: ClassVar[str] = "pendulum_10"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: between the double and the 100 link pendulum"
    links: Count = 10
    duration: Positive = 3.0
    horizon: Positive = 3.0


@dataclass(frozen=True)
class HundredLinks(LinkPendulum):
    """The chapter's hundred."""

    name: ClassVar[str] = "pendulum_100"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a 100 link pendulum"
    links: Count = 100
    duration: Positive = 2.0
    horizon: Positive = 2.0
