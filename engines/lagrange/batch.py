"""Many mechanisms of one shape stepped at once: for sweeps over parameters and maps of them; `varied` makes them.

The random search steps each of its mechanisms alone, since no two are of one shape; and its judge takes 1 to 7 % of the
time of a case (60 motions of each of four methods). The atlas compares engines with closed forms and steps no judge.

One set of flat arrays a thread, into which each mechanism's numbers are laid: compiled code holds no lock of Python's,
so as many threads as there are processors run at the same time.
"""

from __future__ import annotations

import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.lagrange.compiled_run import Machine
from engines.lagrange.dynamics import PROJECTION_ITERATIONS
from engines.lagrange.engine import Tolerance
from engines.lagrange.flat import START_POSE, START_TWIST, Flat, flat
from engines.lagrange.loading import compiled, installed
from engines.lagrange.rolls import ON_LINE, ON_ROUND, Windows
from engines.lagrange.tableaus import RK4
from reference.checks import Count, InvalidMechanism, Positive, Valid, validated
from reference.joints import Roll
from reference.kinds import Floats, of_shape
from reference.mechanism import Mechanism

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Batch:
    """What became of every mechanism: poses and twists (mechanisms, samples + 1, bodies, 3) at times t (samples + 1,).

    NaN after the last sample that could be held.
    """

    t: Array
    pose: Array
    twist: Array


@dataclass(frozen=True)
class Stack(Valid):
    """Mechanisms of one shape: the first one and its arrays, and the numbers (mechanisms, n) of all, as there."""

    mechanism: Mechanism
    arrays: Flat
    numbers: Annotated[Floats, of_shape("mechanisms", "n")]


@validated
def stacked(mechanisms: tuple[Mechanism, ...]) -> Stack:
    """Mechanisms with the same joints between the same bodies, in one order. Raises InvalidMechanism for others.

    Raises Unsupported for rolls that are not round: their tables are each mechanism's own.
    """
    if not mechanisms:
        raise InvalidMechanism("batch: there are no mechanisms; give at least one")
    first = flat(mechanisms[0])
    if not np.all(np.isin(first.rolls[:, 0], (ON_LINE, ON_ROUND))):
        raise Unsupported("batch: only discs and rings roll here; other curves have tables of their own")
    numbers = np.empty((len(mechanisms), first.numbers.stop))
    for number, mechanism in enumerate(mechanisms):
        one = flat(mechanism)
        if not np.array_equal(one.whole, first.whole):
            raise InvalidMechanism(
                f"batch: mechanism {number} has other bodies or joints than the first; a batch is of one shape"
            )
        numbers[number] = one.real[one.numbers]
    return Stack(mechanisms[0], first, numbers)


@validated
def batch(
    stack: Stack,
    spacing: Positive,
    samples: Count,
    tolerance: Tolerance | None = 1e-9,
    every: Count = 10,
    workers: Count | None = None,
) -> Batch:
    """Step all of a stack to `samples` samples, `spacing` [s] apart, with projection.

    By DOP853 that holds `tolerance`, in parts of each mechanism's own length and speed, or, if that is None, by RK4
    with `every` steps between samples. `workers`: threads, one for every processor if None. Raises Unsupported without
    numba: a loop over `Lagrange` does the same, slowly.
    """
    if not installed():
        raise Unsupported("batch: it needs numba; install the extra 'fast'")
    compiled()
    if workers is None:
        workers = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    count, bodies = len(stack.numbers), len(stack.mechanism.bodies)
    poses, twists = np.full((2, count, samples + 1, 3 * bodies + 3), np.nan)
    rolls = [joint.rolling for joint in stack.mechanism.joints if isinstance(joint, Roll)]

    def step(part: NDArray[np.int_]) -> None:
        arrays = stack.arrays.copy()
        machine = Machine(stack.mechanism, arrays, Windows(rolls, arrays.rolls))
        for number in part:
            _step(machine, stack.numbers[number], spacing, tolerance, every, poses[number], twists[number])

    with ThreadPoolExecutor(workers) as pool:
        for _ in pool.map(step, np.array_split(np.arange(count), min(count, 8 * workers))):
            pass
    shape = (count, samples + 1, bodies, 3)
    t = np.arange(samples + 1, dtype=np.float64) * spacing
    return Batch(t, poses[..., :-3].reshape(shape), twists[..., :-3].reshape(shape))


def _step(
    machine: Machine,
    numbers: Array,
    spacing: float,
    tolerance: float | None,
    every: int,
    poses: Array,
    twists: Array,
) -> None:
    whole, real = machine.arrays.whole, machine.arrays.real
    real[machine.arrays.numbers] = numbers
    columns = poses.shape[1]
    poses[0] = real[whole[START_POSE] : whole[START_POSE] + columns]
    twists[0] = real[whole[START_TWIST] : whole[START_TWIST] + columns]
    if tolerance is None:
        machine.march(RK4, PROJECTION_ITERATIONS, spacing / every, every, 0, poses, twists)
    else:
        machine.control(tolerance, spacing, 0, poses, twists)
