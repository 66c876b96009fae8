"""How many steps stand for one, in a motion that becomes much faster than its start lets expect.

Near a singular position rates rise tenfold within a few steps, and no order of a method helps where its step is longer
than what happens. A method that estimates its own error can know that before it runs: it makes a rough run, with steps
of a fixed share of the mechanism's time scale, and asks it for its estimate. The answer is a number of the mechanism
and the duration, not of the step that was asked for: so the method keeps its order, with a smaller factor. A run that
is there already may tell as much by its own estimate and its order; then there is no rough run.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from math import ceil, isfinite

import numpy as np

from engines.contract import Engine
from reference.checks import Count, Positive, validated
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory

# All of these numbers are fitted: chosen by what random mechanisms of the seeds 1 and 22 needed (pins, slots, skates,
# drives), MOST and DEAREST by what rough runs cost. They have not been changed since they were tried on 372 others of
# all kinds (seed 501), in MuJoCo at 1, 3, 10 ms with 1, 2, 3, 10 steps a sample: of 4464 runs 3460 finished, wrong by
# 8.6e-8 at most, and 1004 were unresolved, 57 of them although they were right. There one run in ten asked for a rough
# one, and four mechanisms had their steps divided, by 3 to 21.
SAMPLES = 16  # a motion that is fast for a while is met by some of them, and an error stays
SHARE, FEWEST, MOST = 100, 64, 1024  # rough steps in the mechanism's time scale; at least; at most, or it is too long
DEAREST = 1.0  # s, by the method's own formula: a rough run of long chains would cost more than smaller steps bring
# Of a radian or of the mechanism's length, lost in its time scale by a rough run. Usual motions lose 1e-6 at most by
# Runge and Kutta's fourth order and less by higher ones. Beyond FAST, smaller steps must bring it back to USUAL. In
# between, and above RESOLVED, the rough steps may be too long for the order to be seen: more of them are asked.
USUAL, FAST, RESOLVED = 1e-6, 1e-5, 1e-3
ROUGHER = 4  # times as many rough steps, until they are short enough

Rough = Callable[[Count, Count], Trajectory]  # (samples, every) of an `engines.Run`, with an estimate


@dataclass(frozen=True)
class Division:
    """Into how many a step is to be divided, and the CPU time of the rough runs that told it [s]."""

    steps: int
    seconds: float


@validated
def tells_itself(run: Trajectory, mechanism: Mechanism, dt: Positive, order: Positive) -> bool:
    """Whether a run with steps of dt [s] shows that its steps need no division, so that no rough run has to.

    Its estimate, raised by the order to the rough steps where these are longer, is as small as that of usual motions.
    """
    duration = float(run.t[-1])
    rough = duration / _rough_steps(mechanism, duration)
    lost = _lost_in(run, mechanism) * mechanism.time_scale / duration
    return lost * max(1.0, rough / dt) ** order <= USUAL


@validated
def division(
    method: Engine,
    build: Callable[[float], Rough],
    mechanism: Mechanism,
    duration: Positive,
    order: Positive,
    finest: Count = 16,
) -> Division:
    """Into how many a step has to be divided in a motion of `duration` [s]; 1 for nearly all mechanisms.

    `build(dt)` makes a run of the `method` as it is, whose estimate falls with this order of its step. Where even
    `finest` times as many rough steps resolve nothing, or a motion is so long, or a step so dear, that a rough run
    would take as long as a fine one, the answer is 1: the run's own estimate tells the rest. So it is where a motion
    that a rough run seemed to follow is lost by a finer one: then it is no series in the step, at a singular position
    say, and still shorter steps are not tried.
    """
    duration = float(f"{duration:.12g}")  # which runs at different steps round differently
    begin = time.process_time()
    cost = method.step_cost_within(mechanism, duration)
    steps = _found(build, mechanism, duration, order, finest, cost)
    return Division(steps, time.process_time() - begin)


def _found(
    build: Callable[[float], Rough], mechanism: Mechanism, duration: float, order: float, finest: int, cost: float
) -> int:
    steps = _rough_steps(mechanism, duration)
    if steps > MOST:
        return 1
    every, finer, before = ceil(steps / SAMPLES), 1, np.inf
    while finer <= finest and finer * steps * cost <= DEAREST:
        lost = _lost(build, mechanism, duration, every * finer) * mechanism.time_scale / duration
        if finer == 1 and lost <= USUAL:
            return 1
        if finer > 1 and lost <= RESOLVED:
            return ceil(finer * (lost / USUAL) ** (1 / order)) if lost * finer**order > FAST else 1
        if before < 1 < lost:
            return 1
        finer, before = ROUGHER * finer, lost
    return 1


def _rough_steps(mechanism: Mechanism, duration: float) -> int:
    return max(FEWEST, ceil(SHARE * duration / mechanism.time_scale))


def _lost(build: Callable[[float], Rough], mechanism: Mechanism, duration: float, every: Count) -> float:
    """The largest estimate of a run with so many steps between samples, in radians or lengths; infinite if lost."""
    with np.errstate(all="ignore"):
        return _lost_in(build(duration / SAMPLES / every)(SAMPLES, every), mechanism)


def _lost_in(run: Trajectory, mechanism: Mechanism) -> float:
    if run.estimate is None or run.reset_at is not None:
        return np.inf
    size = np.array([mechanism.length_scale, mechanism.length_scale, 1.0])
    with np.errstate(all="ignore"):
        lost = float((run.estimate / size).max())
    return lost if isfinite(lost) else np.inf
