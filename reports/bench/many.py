"""Measurements of the judge for many mechanisms in one loop, and for trees and chains of many bodies."""

from __future__ import annotations

import cmath
import time
from collections.abc import Iterator, Sequence

import numpy as np

from engines import Engine, mujoco
from engines.lagrange import Lagrange, ParameterSweep, run_batch
from reference.joints import Body, Pin
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.bench.times import Row

STEP, SAMPLES, STEPS_PER_SAMPLE = 0.02, 10, 5  # a second in steps whose error is 1e-8 rad
RK4 = {engine.variant: engine for engine in mujoco.METHODS}["RK4 alone"]
TREE_STEP = 1e-4  # [s]


def measure_batch(count: int = 20_000) -> list[Row]:
    """CPU times of four-bars with random bars for a second, in one loop and alone, and the largest difference."""
    mechanism, engine = FreeFourBar(duration=1.0).mechanism(), Lagrange()
    lengths = 0.4 * np.random.default_rng(0).uniform(0.95, 1.05, count)
    ends = np.stack([lengths / 2, 0 * lengths], axis=1)
    numbers = {"A.second_point": -ends, "B.first_point": ends, "crank.mass": lengths, "crank.inertia": lengths**3 / 12}
    begin = time.process_time()
    found = run_batch(engine, ParameterSweep(mechanism, numbers), STEP, SAMPLES, STEPS_PER_SAMPLE, workers=1)
    spent = time.process_time() - begin
    sweep, difference, alone = ParameterSweep(mechanism, numbers), 0.0, []
    for number in range(0, count, max(1, count // 20)):
        single = sweep.alone(number, found.pose[number, 0], found.twist[number, 0])
        run = engine.build(single, STEP)(SAMPLES, STEPS_PER_SAMPLE)
        alone.append(run.stepping)
        difference = max(difference, float(np.abs(run.pose - found.pose[number]).max()))
    name = "four-bar: a second by dop853 projection, step 0.02 s"
    return [
        (f"{name}, one of {count} with building and compilation", 1e6 * spent / count, "us"),
        (f"{name}, stepping alone", 1e6 * min(alone), "us"),
        ("four-bar: largest difference between the two", difference, "rad"),
    ]


def measure_trees(
    sizes: Sequence[int] = (10, 100, 1000, 10_000), branches: Sequence[int] = (2, 1), turns: int = 3
) -> Iterator[Row]:
    """CPU times of a step by RK4 with projection, and their ratio to MuJoCo's RK4.

    In a tree of n branches, n bars hang at the end of each bar. MuJoCo is left out for chains above 100 bars, since its
    step then costs the square of their number.
    """
    for branch in branches:
        for size in sizes:
            name = f"{'chain' if branch == 1 else f'tree of {branch} branches'} of {size} bars"
            mechanism, steps = make_tree(size, branch), max(3, 2000 // size)
            own = _step_seconds(Lagrange("rk4"), mechanism, steps, turns)
            yield f"{name}: a step by rk4 projection", 1e6 * own, "us"
            if branch > 1 or size <= 100:
                yield f"{name}: MuJoCo's RK4 over the judge", _step_seconds(RK4, mechanism, steps, turns) / own, "1"


def make_tree(size: int, branches: int) -> Mechanism:
    """Bars of 1 m and 1 kg; `branches` bars hang at the end of each bar, and the first one on the ground."""
    angles = [-1.57 + 0.1 * (bar % 7 - 3) for bar in range(size)]
    starts, bodies, pins = [0j], list[Body](), list[Pin]()
    for bar, angle in enumerate(angles):
        above = (bar - 1) // branches
        if bar:
            starts.append(starts[above] + cmath.rect(1.0, angles[above]))
        centre = starts[bar] + cmath.rect(0.5, angle)
        bodies.append(Body(f"bar {bar}", 1.0, 1 / 12, (centre.real, centre.imag, angle)))
        name, end = (f"bar {above}", (0.5, 0.0)) if bar else (None, (0.0, 0.0))
        pins.append(Pin(f"pin {bar}", name, f"bar {bar}", end, (-0.5, 0.0)))
    return Mechanism((*bodies,), (*pins,), (0.0, -9.81))


def _step_seconds(engine: Engine, mechanism: Mechanism, steps: int, turns: int) -> float:
    return min(engine.build(mechanism, TREE_STEP)(1, steps).stepping for _ in range(turns)) / steps
