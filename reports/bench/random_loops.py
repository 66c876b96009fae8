"""A scene of random loops of pins, whose motion is integrated in a way that no engine uses."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from reference.checks import Count, Positive
from reference.joints import Joint, Pin, bodies_of
from reference.mechanism import Mechanism
from reference.scene import PlacedScene

Array = NDArray[np.float64]

# Tolerance of the reference motion. Its error is then below 1e-11 rad, as `test_peers` measures by the judge.
LOOPS_TOLERANCE = 1e-12


@dataclass(frozen=True)
class RandomLoops(PlacedScene):
    """`count` bodies fall from rest; each is pinned to an earlier body or the ground, and `loops` further pins close
    loops.

    The reference motion solves M a = f + J^T reaction with J a = bias in dense matrices at each evaluation, and scipy's
    DOP853 integrates all coordinates without a projection.
    """

    name: ClassVar[str] = "random_loops"
    source: ClassVar[str] = "section 18.5, closed kinematic chains"

    count: Count = 20
    loops: Count = 5
    seed: Count = 1
    duration: Positive = 0.5
    horizon: Positive = 0.5

    @cached_property
    def _drawn(self) -> Mechanism:
        """The first mechanism of the seed with independent rows."""
        generator = np.random.Generator(np.random.PCG64(self.seed))
        while True:
            mechanism = self._draw(generator)
            if mechanism.degrees_of_freedom()[0] == 3 * self.count - mechanism.row_count:
                return mechanism

    def _draw(self, generator: np.random.Generator) -> Mechanism:
        centres, joints = np.zeros((self.count + 1, 2)), []  # the ground is the first centre

        def pin(first: int, second: int) -> Joint:
            at = (centres[first] + centres[second]) / 2 + generator.uniform(-0.05, 0.05, 2)
            points = [tuple((at - centres[index]).tolist()) for index in (first, second)]
            ground, body = (None if first == 0 else f"body {first}"), f"body {second}"
            return Pin(f"pin {len(joints) + 1}", ground, body, points[0], points[1])

        for body in range(1, self.count + 1):
            parent = int(generator.integers(0, body))
            centres[body] = centres[parent] + generator.uniform(-0.4, 0.4, 2)
            joints.append(pin(parent, body))
        for _ in range(self.loops):
            first, second = sorted(generator.choice(self.count + 1, 2, replace=False).tolist())
            joints.append(pin(first, second))
        masses = generator.uniform(0.5, 2.0, self.count)
        pose = np.column_stack([centres[1:], np.zeros(self.count)])
        names = [f"body {index}" for index in range(1, self.count + 1)]
        bodies = bodies_of(names, masses, 0.02 * masses, pose, np.zeros_like(pose))
        return Mechanism(bodies, tuple(joints), (0.0, -9.81))

    def mechanism(self) -> Mechanism:
        return self._drawn

    def _acceleration(self, pose: Array, twist: Array) -> Array:
        mechanism = self._mechanism
        free, rows = mechanism.unconstrained(pose, twist), mechanism.rows(pose)
        weighted = rows / mechanism.inertias.ravel()
        missing = mechanism.bias(pose, twist) - rows @ free.ravel()
        return free + (np.linalg.solve(weighted @ rows.T, missing) @ weighted).reshape(pose.shape)

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        mechanism = self._mechanism
        shape = mechanism.pose.shape

        def rates(_: float, state: Array) -> Array:
            pose, twist = state.reshape(2, *shape)
            return np.concatenate([twist.ravel(), self._acceleration(pose, twist).ravel()])

        start = np.concatenate([mechanism.pose.ravel(), mechanism.twist.ravel()])
        if not times.any():
            states = np.tile(start, (len(times), 1))
        else:
            wanted, tolerance = np.unique(times), LOOPS_TOLERANCE
            span = (0.0, float(times.max()))
            solution = solve_ivp(rates, span, start, "DOP853", t_eval=wanted, rtol=tolerance, atol=tolerance)
            states = solution.y.T[np.searchsorted(wanted, times)]
        pose, twist = np.moveaxis(states.reshape(len(times), 2, *shape), 1, 0)
        acceleration = np.array([self._acceleration(p, v) for p, v in zip(pose, twist, strict=True)])
        return pose, twist, acceleration
