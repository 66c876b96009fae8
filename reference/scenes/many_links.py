"""A pendulum of any number of links, made for counting costs: what is known of a chain is not found by linear algebra.

Freedoms by the rank of 2000 rows, or reactions by solving for them, would cost far more than what is to be measured.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from reference.checks import Positive, validated
from reference.mechanism import Mechanism
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
