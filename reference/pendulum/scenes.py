"""The chapter's double pendulum and its 100-link pendulum, and one of 10 links between, released from horizontal."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, require_finite, require_positive
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.memory import require_room
from reference.numerics.integration import Integrated, integrate
from reference.pendulum.chain import Chain
from reference.scene import Scene
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@lru_cache(maxsize=8)
def _integrated(chain: Chain, angle: float, rate: float, until: float) -> Integrated:
    start = np.concatenate([np.full(chain.links, angle), np.full(chain.links, rate)])
    return integrate(chain.rates, start, until)


@dataclass(frozen=True)
class LinkPendulum(Scene):
    """`links` uniform bars, each of `length` [m] and `mass` [kg]; the last is `tip` times heavier.

    All start at the same `angle` [rad] from the downward vertical and `rate` [rad/s]. The horizon is measured
    (`Chain.horizon`): until then a small difference grows less than tenfold.
    """

    name: ClassVar[str] = "pendulum_2"
    page: ClassVar[str] = "pendulum"
    source: ClassVar[str] = "problems 18.5.1 and 18.5.2; section 18.5, closed kinematic chains: a double pendulum"
    links: int = 2
    length: float = 1.0
    mass: float = 1.0
    tip: float = 1.0
    gravity: float = 9.81
    angle: float = math.pi / 2
    rate: float = 0.0
    duration: float = 5.0
    horizon: float = 3.0

    def __post_init__(self) -> None:
        owner = f"scene {self.name!r}"
        if not (isinstance(self.links, int) and self.links >= 1):
            raise InvalidMechanism(f"{owner}: links is {self.links!r}; it must be a whole number of at least 1")
        require_positive(owner, length=self.length, mass=self.mass, tip=self.tip)
        require_finite(owner, gravity=self.gravity, angle=self.angle, rate=self.rate)

    @cached_property
    def chain(self) -> Chain:
        masses = (self.mass,) * (self.links - 1) + (self.mass * self.tip,)
        return Chain((self.length,) * self.links, masses, self.gravity)

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """Angles and rates (times, links) at times t >= 0 [s]."""
        t = np.atleast_1d(np.asarray(t, dtype=float))
        require_room(f"scene {self.name!r}: a trajectory", (len(t), self.links, 3))
        state = _integrated(self.chain, self.angle, self.rate, max(self.duration, float(t.max())))(t)
        return state[:, : self.links], state[:, self.links :]

    def error(self, t: ArrayLike) -> Array:
        """A bound on the truth's own error (times,) [rad, rad/s]."""
        return self.chain.error(np.full(self.links, self.angle), np.full(self.links, self.rate), t)

    def mechanism(self) -> Mechanism:
        angle, rate = np.full(self.links, self.angle), np.full(self.links, self.rate)
        pose, twist, _ = self.chain.placement(angle, rate, np.zeros(self.links))
        bodies = tuple(
            Body(f"link {i + 1}", self.chain.masses[i], float(self.chain.inertia[i]), tuple(pose[i]), tuple(twist[i]))
            for i in range(self.links)
        )
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

    def motion(self, t: ArrayLike) -> Trajectory:
        t = np.atleast_1d(np.asarray(t, dtype=float))
        angle, rate = self.states(t)
        pose, twist, _ = self.chain.placement(angle, rate, np.zeros_like(angle))
        return Trajectory(t, pose, twist, self.chain.forces(angle, rate).reshape(len(t), -1))


@dataclass(frozen=True)
class TenLinks(LinkPendulum):
    """Ten links."""

    name: ClassVar[str] = "pendulum_10"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: between the double and the 100 link pendulum"
    links: int = 10
    duration: float = 3.0
    horizon: float = 3.0


@dataclass(frozen=True)
class HundredLinks(LinkPendulum):
    """The chapter's hundred."""

    name: ClassVar[str] = "pendulum_100"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a 100 link pendulum"
    links: int = 100
    duration: float = 2.0
    horizon: float = 2.0
