"""Pendulums with any number of links, and a rotating ring of links."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import LARGEST_COUNT, Count, Positive, require_room, validated
from reference.joints import Pin, bodies_of
from reference.mechanism import Mechanism
from reference.plane import perpendicular, placed
from reference.scene import PlacedScene, Scene, shared
from reference.scenes.pendulum.chain import Chain
from reference.trajectory import Trajectory
from reference.validators import Array, from_to


@dataclass(frozen=True)
class LinkPendulum(Scene):
    """A chain of `links` uniform bars of `length` [m] and `mass` [kg]; the last bar is `tip` times heavier.

    All bars start at one `angle` [rad] from the downward vertical and one `rate` [rad/s]. A small difference grows less
    than tenfold up to the horizon, which `Chain.horizon` measures.
    """

    name: ClassVar[str] = "pendulum_2"
    source: ClassVar[str] = "problems 18.5.1 and 18.5.2; section 18.5, closed kinematic chains: a double pendulum"
    # After this time the chaotic reference motion of two links has lost half of its digits.
    max_durations: ClassVar[float] = 2.0
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
        """A bound (times,) on the error of the reference motion [rad, rad/s]."""
        return self.chain.truth_error(np.full(self.links, self.angle), np.full(self.links, self.rate), self.times(t))

    def mechanism(self) -> Mechanism:
        angle, rate = np.full(self.links, self.angle), np.full(self.links, self.rate)
        pose, twist, _ = self.chain.placement(angle, rate, np.zeros(self.links))
        names = [f"link {i + 1}" for i in range(self.links)]
        bodies = bodies_of(names, self.chain.masses, self.chain.inertia, pose, twist)
        half = self.length / 2
        uppers = [(None, (0.0, 0.0)), *((name, (half, 0.0)) for name in names)]
        joints = tuple(
            Pin(f"joint {i + 1}", upper, name, point, (-half, 0.0))
            for i, ((upper, point), name) in enumerate(zip(uppers, names, strict=False))
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


@dataclass(frozen=True)
class OpenChain(Mechanism):
    """An open chain of pinned bodies, which is never singular; body i is the `second` body of pin i."""

    @validated
    def degrees_of_freedom(self, pose: Array | None = None) -> tuple[int, int]:
        """Every pose has one freedom for each body."""
        return len(self.bodies), len(self.bodies)

    def reactions_of(self, pose: Array, excess: Array, inertias: Array) -> Array:
        """Reactions (..., rows) [N]: a pin carries the sum of mass times acceleration of all bodies below."""
        momentum_rates = inertias[:, :2] * excess[..., :2]
        sums = np.flip(np.cumsum(np.flip(momentum_rates, axis=-2), axis=-2), axis=-2)
        return sums.reshape((*sums.shape[:-2], self.row_count))


@dataclass(frozen=True)
class LongPendulum(LinkPendulum):
    """`links` bars of 1 m and 1 kg in line are released from horizontal. The duration is too short for chaos."""

    name: ClassVar[str] = "pendulum_n"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a pendulum of 1, 2 and 100 links, and more"
    duration: Positive = 0.5
    horizon: Positive = 0.5

    def mechanism(self) -> Mechanism:
        chain = super().mechanism()
        return OpenChain(chain.bodies, chain.joints, chain.gravity)


@dataclass(frozen=True)
class SpinningRing(PlacedScene):
    """A ring of `links` uniform bars, each of `length` [m] and `mass` [kg], turns at `rate` [rad/s] without gravity.

    Raises InvalidMechanism for fewer than three links. A ring under tension is stable, so the horizon is the duration.
    """

    name: ClassVar[str] = "spinning_ring"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: the simplest with many links"
    links: Annotated[int, from_to(3, LARGEST_COUNT)] = 100
    length: Positive = 0.1
    mass: Positive = 0.1
    rate: float = 2.0
    duration: Positive = 1.0
    horizon: Positive = 1.0

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        inner = self.length / (2 * math.tan(math.pi / self.links))  # from the ring's centre to the middle of a chord
        where = 2 * math.pi * np.arange(self.links) / self.links + self.rate * times[:, None]
        outwards, zero = np.stack([np.cos(where), np.sin(where)], axis=-1), np.zeros_like(where)
        onwards = perpendicular(outwards)
        return (
            placed(inner * outwards, where + math.pi / 2),
            placed(inner * self.rate * onwards, zero + self.rate),
            placed(-inner * self.rate**2 * outwards, zero),
        )

    def mechanism(self) -> Mechanism:
        pose, twist, _ = self.placement(np.zeros(1))
        same = np.full(self.links, self.mass)
        names = [f"link {i + 1}" for i in range(self.links)]
        bodies = bodies_of(names, same, same * self.length**2 / 12, pose[0], twist[0])
        half = self.length / 2
        joints = tuple(
            Pin(f"joint {i + 1}", bodies[i - 1].name, bodies[i].name, (half, 0.0), (-half, 0.0))
            for i in [*range(1, self.links), 0]
        )
        return Mechanism(bodies, joints)
