"""Mechanisms of any number of links, made for counting costs: a hanging chain, and a ring that turns like a wheel.

What is known of a chain is not found by linear algebra: freedoms by the rank of 2000 rows, or reactions by solving for
them, would cost far more than what is to be measured. In the ring every link is a chord of a circle; its centre of mass
goes round at a constant rate, and what its two pins give together is m w^2 times the distance to the middle, inwards.
In a tree of joints one pin of the ring is left over, and closes it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import LARGEST_COUNT, Positive, validated
from reference.joints import Pin, bodies_of
from reference.kinds import from_to
from reference.mechanism import Mechanism
from reference.scene import PlacedScene
from reference.scenes.pendulum.scenes import LinkPendulum


@dataclass(frozen=True)
class OpenChain(Mechanism):
    """Bodies hung on one another by pins, body i by pin i, which is its `second`: an open chain, so never singular."""

    @validated
    def degrees_of_freedom(self, pose: NDArray[np.float64] | None = None) -> tuple[int, int]:
        """One angle a body, whatever the pose."""
        return len(self.bodies), len(self.bodies)

    def reactions_of(
        self, pose: NDArray[np.float64], excess: NDArray[np.float64], inertias: NDArray[np.float64]
    ) -> NDArray[np.float64]:
        """Newton's law from the free end upwards: pin i carries what all bodies below it need (..., rows) [N]."""
        needed = inertias[:, :2] * excess[..., :2]
        carried = np.flip(np.cumsum(np.flip(needed, axis=-2), axis=-2), axis=-2)
        return carried.reshape((*carried.shape[:-2], self.row_count))


@dataclass(frozen=True)
class LongPendulum(LinkPendulum):
    """`links` bars of a metre and a kilogram, released in line from horizontal; short, so that none is chaotic yet."""

    name: ClassVar[str] = "pendulum_n"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a pendulum of 1, 2 and 100 links, and more"
    duration: Positive = 0.5
    horizon: Positive = 0.5

    def mechanism(self) -> Mechanism:
        chain = super().mechanism()
        return OpenChain(chain.bodies, chain.joints, chain.gravity)


Array = NDArray[np.float64]


@dataclass(frozen=True)
class SpinningRing(PlacedScene):
    """`links` uniform bars of `length` [m] and `mass` [kg] in a ring, turning at `rate` [rad/s]; no gravity.

    Raises InvalidMechanism for fewer than three links. The horizon is the duration: a ring under tension is stable.
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
        inner = self.length / (2 * math.tan(math.pi / self.links))  # from the middle to the middle of a chord
        where = 2 * math.pi * np.arange(self.links) / self.links + self.rate * times[:, None]
        outwards = np.stack([np.cos(where), np.sin(where)], axis=-1)
        onwards = np.stack([-np.sin(where), np.cos(where)], axis=-1)
        zero = np.zeros_like(where)[..., None]
        return (
            np.concatenate([inner * outwards, where[..., None] + math.pi / 2], axis=-1),
            np.concatenate([inner * self.rate * onwards, zero + self.rate], axis=-1),
            np.concatenate([-inner * self.rate**2 * outwards, zero], axis=-1),
        )

    def mechanism(self) -> Mechanism:
        pose, twist, _ = self.placement(np.zeros(1))
        same = np.full(self.links, self.mass)
        names = [f"link {i + 1}" for i in range(self.links)]
        bodies = bodies_of(names, same, same * self.length**2 / 12, pose[0], twist[0])
        half = self.length / 2
        joints = tuple(
            Pin(f"joint {i + 1}", bodies[i - 1].name, bodies[i].name, (half, 0.0), (-half, 0.0))
            for i in [*range(1, self.links), 0]  # the one that closes the ring comes last
        )
        return Mechanism(bodies, joints)
