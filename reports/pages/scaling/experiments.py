"""Chains of many links: how costs and errors grow with their size, by exponents fitted to the large end of a series;
the reference's own equations as a method among others, and how exact the truth of long chains is.

The method is a banded solve for the joint forces, under RK4. It is no engine: it takes the mechanism of a LongPendulum
and no other. It stands beside the engines to say what an evaluation needs to cost.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from engines import EXACT, Engine, Holder, Promise, Size, Unpromised, Unsupported
from engines.sampling import sampled
from reference.checks import Count, Positive, validated
from reference.joints import Joint, Pin
from reference.mechanism import Mechanism
from reference.scenes.pendulum.chain import Array, Chain
from reference.scenes.pendulum.scenes import LongPendulum, OpenChain
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.tasks import Task, Values


@dataclass(frozen=True)
class TruthError(Task):
    """The truth of a long chain at the end of its run."""

    scene: LongPendulum

    seconds: ClassVar[float] = 0.5  # measured, with 200 links
    words: ClassVar[str] = "error of the truth of {0.scene.links} links"

    def run(self) -> Values:
        """`error`: the largest of an angle [rad]."""
        return {"error": self.scene.truth_error([self.scene.duration])[0]}


@dataclass(frozen=True)
class BandedChain(Engine):
    """An engine in the sense of `engines.Engine`, for a pendulum of uniform bars alone."""

    name = "reference"
    variant = "banded rk4"
    packages = ("numpy",)

    @validated
    def order(self, mechanism: Mechanism) -> Promise | Unpromised:
        """Runge-Kutta's, of angles between which no pin can part."""
        return Promise(4, gap=EXACT, slip=EXACT)

    @validated
    def step_cost(self, mechanism: Mechanism) -> float:
        """About what a step takes [s]: most of it is numpy's calls, as many for any chain."""
        return 50e-6 * max(1.0, len(mechanism.bodies) / 3)

    @validated
    def holder(self, joint: Joint, mechanism: Mechanism) -> Holder:
        return "engine"

    @validated
    def build(self, mechanism: Mechanism, dt: Positive) -> BandedRun:
        return BandedRun(mechanism, chain_of(mechanism), dt)


def chain_of(mechanism: Mechanism) -> Chain:
    """The chain that a mechanism is; raises Unsupported for any but that of a LongPendulum."""
    if not isinstance(mechanism, OpenChain):
        raise Unsupported("the reference's chain is that of a LongPendulum alone")
    lengths = tuple(-2 * joint.second_point[0] for joint in mechanism.joints if isinstance(joint, Pin))
    return Chain(lengths, tuple(body.mass for body in mechanism.bodies), -mechanism.gravity[1])


class BandedRun:
    """A chain at its start; see `engines.Run`."""

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
        """The classical Runge-Kutta step."""
        rates, dt = self._chain.rates, self._dt
        first = rates(state)
        second = rates(state + dt / 2 * first)
        third = rates(state + dt / 2 * second)
        fourth = rates(state + dt * third)
        return state + dt / 6 * (first + 2 * second + 2 * third + fourth)


NAN = float("nan")
LAST = 3  # points of a fit: a growth law is seen at the large end, where what is paid in any case no longer counts


@dataclass(frozen=True)
class Point:
    """One method at one size: CPU seconds of a step, and the largest angle error [rad] (NaN where only timed)."""

    size: int
    step: float
    error: float
    outcome: str


@dataclass(frozen=True)
class Series:
    """One method over all sizes, small to large."""

    engine: str
    variant: str
    points: tuple[Point, ...]

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    def at(self, size: int) -> Point | None:
        return next((point for point in self.points if point.size == size), None)


def series_of(rows: Mapping[Cell, Measurement], timed: float) -> tuple[Series, ...]:
    """The rows of pendulums by method; cells that ran for less than `timed` seconds count for their cost alone."""
    found: dict[tuple[str, str], list[Point]] = {}
    for cell, row in rows.items():
        size = int(getattr(cell.scene, "links", 0))
        comparable = Outcome(row.outcome).comparable
        whole = cell.scene.duration >= timed * (1 - 1e-9)
        cost = row.cpu * cell.step if comparable or not whole else NAN
        error = row.angle if whole and comparable else NAN
        found.setdefault((row.engine, row.variant), []).append(Point(size, cost, error, str(row.outcome)))
    return tuple(
        Series(engine, variant, tuple(sorted(points, key=lambda point: point.size)))
        for (engine, variant), points in found.items()
    )


def exponent(sizes: Iterable[float], values: Iterable[float], last: int = LAST) -> tuple[float, int, int]:
    """(slope of log value over log size at the `last` finite points, first and last size of the fit).

    NaN and zeros with fewer than two points.
    """
    pairs = [(n, v) for n, v in zip(sizes, values, strict=True) if math.isfinite(v) and v > 0][-last:]
    if len(pairs) < 2:
        return NAN, 0, 0
    n, v = np.log(np.array(pairs, dtype=float)).T
    return float(np.polyfit(n, v, 1)[0]), int(pairs[0][0]), int(pairs[-1][0])


def cost_exponent(series: Series, least: float = 0, most: float = math.inf) -> tuple[float, int, int]:
    """Of the CPU time of a step, at sizes from `least` to `most`: those at which the method is one and the same."""
    points = [point for point in series.points if least <= point.size <= most]
    return exponent([p.size for p in points], [p.step for p in points])
