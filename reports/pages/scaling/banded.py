"""An engine for LongPendulums, RK4 with the reference's banded solver for the joint forces of a chain."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from engines import EXACT, ConvergenceOrder, Enforcement, Engine, NotDeclared, Size, Unsupported
from engines.sampling import sampled
from reference.checks import Count, Positive, validated
from reference.joints import Joint, Pin
from reference.mechanism import Mechanism
from reference.scenes.pendulum.chain import Array, Chain
from reference.scenes.pendulum.scenes import OpenChain
from reference.trajectory import Trajectory


@dataclass(frozen=True)
class BandedChain(Engine):
    name = "reference"
    variant = "banded rk4"
    packages = ("numpy",)

    @validated
    def order(self, mechanism: Mechanism) -> ConvergenceOrder | NotDeclared:
        """The order of RK4 is 4. Pins are exact, because angles are the coordinates."""
        return ConvergenceOrder(4, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """An estimate [s]. With up to three links, calls of numpy take most of the time."""
        return 50e-6 * max(1.0, len(mechanism.bodies) / 3)

    @validated
    def enforcement(self, joint: Joint, mechanism: Mechanism) -> Enforcement:
        return "engine"

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> BandedRun:
        return BandedRun(mechanism, chain_of(mechanism), dt)


def chain_of(mechanism: Mechanism) -> Chain:
    """The chain of a LongPendulum's mechanism. Raises Unsupported for other mechanisms."""
    if not isinstance(mechanism, OpenChain):
        raise Unsupported("the reference's banded solver builds only the mechanism of a LongPendulum")
    lengths = tuple(-2 * joint.second_point[0] for joint in mechanism.joints if isinstance(joint, Pin))
    return Chain(lengths, tuple(body.mass for body in mechanism.bodies), -mechanism.gravity[1])


class BandedRun:
    def __init__(self, mechanism: Mechanism, chain: Chain, dt: float) -> None:
        self._mechanism, self._chain, self._dt = mechanism, chain, dt
        self._start = np.concatenate([mechanism.pose[:, 2] + math.pi / 2, mechanism.twist[:, 2]])
        self.size = Size(chain.links, chain.links, 0, 0)

    @validated
    def __call__(self, samples: Count, every: Count) -> Trajectory:
        self._mechanism.require_room(samples)
        chain, states = self._chain, np.empty((samples + 1, len(self._start)))
        state = self._start

        def advance(count: int) -> None:
            nonlocal state
            for _ in range(count):
                state = self._step(state)

        def record(sample: int) -> None:
            states[sample] = state

        stepping = sampled([every] * samples, advance, record)
        angle, rate = states[:, : chain.links], states[:, chain.links :]
        pose, twist, _ = chain.placement(angle, rate, np.zeros_like(angle))
        reaction = chain.forces(angle, rate).reshape(samples + 1, -1)
        t: Array = np.arange(samples + 1, dtype=float) * (every * self._dt)
        return Trajectory(t, pose, twist, reaction, stepping)

    def _step(self, state: Array) -> Array:
        rates, dt = self._chain.rates, self._dt
        first = rates(state)
        second = rates(state + dt / 2 * first)
        third = rates(state + dt / 2 * second)
        fourth = rates(state + dt * third)
        return state + dt / 6 * (first + 2 * second + 2 * third + fourth)
