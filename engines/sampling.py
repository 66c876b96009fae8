"""The sampling loop of the adapters; accelerations, angles and reactions of sampled states."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.mechanism import Mechanism

Array = NDArray[np.float64]


def sampled(
    steps: Iterable[int],
    advance: Callable[[int], object],
    record: Callable[[int], object],
    record_before: Callable[[int], object] | None = None,
) -> float:
    """Step a model, record its states, and return the CPU time [s] of stepping and recording.

    steps: number of steps before each sample after the first. advance(count): takes `count` steps. record(sample):
    stores the state of a sample. record_before(sample): stores values one step before a sample. The loop ends early if
    `advance` or `record` returns True.
    """
    counts = list(steps)
    record(0)
    begin = time.process_time()
    for sample, count in enumerate(counts, 1):
        if record_before is not None:
            if advance(count - 1) is True:
                break
            record_before(sample)
            count = 1
        if advance(count) is True or record(sample) is True:
            break
    return time.process_time() - begin


def sampled_with_differences(
    counts: tuple[int, int],
    dt: float,
    advance: Callable[[int], object],
    state: Callable[[], tuple[Any, Any]],
    velocity: Callable[[], Any],
) -> tuple[Array, Array, Array, float]:
    """Positions, velocities and accelerations (samples + 1, ...), and the CPU time [s] of stepping.

    counts: number of samples, and number of steps between samples.
    state(): the current positions and velocities.
    Accelerations are changes of `velocity()` over the last step, divided by dt [s]; they are NaN at t = 0.
    """
    states: list[tuple[Any, Any]] = []
    before: list[Any] = []
    samples, every = counts
    stepping = sampled(
        [every] * samples, advance, lambda _: states.append(state()), lambda _: before.append(velocity())
    )
    position, speed = (np.array(values, dtype=float) for values in zip(*states, strict=True))
    acceleration = np.full_like(speed, np.nan)
    last = np.array(before[: len(speed) - 1], dtype=float).reshape(speed[1:].shape)  # without that of a lost sample
    with np.errstate(all="ignore"):
        acceleration[1:] = (speed[1:] - last) / dt
    return position, speed, acceleration, stepping


def reactions(
    mechanism: Mechanism,
    pose: Array,
    twist: Array,
    acceleration: Array,
    inertias: Array,
    gravity: Array | tuple[float, float],
) -> Array:
    """Reactions (samples, rows) from accelerations and the engine's inertias and gravity.

    Reactions are NaN at samples whose accelerations are not finite.
    """
    out = np.full((len(pose), mechanism.row_count), np.nan)
    # The factorisation fails for numbers whose squares are infinite.
    valid = np.all((np.abs(pose) < 1e100) & (np.abs(acceleration) < 1e100), axis=(1, 2))
    if mechanism.row_count and np.any(valid):
        with np.errstate(all="ignore"):
            out[valid] = mechanism.reaction(pose[valid], acceleration[valid], inertias, np.array(gravity), twist[valid])
    return out


def unwrapped(angle: Array, rate: Array, start: Array, spacing: float) -> Array:
    """Unwrapped angles (times, bodies) from angles that an engine wraps into one turn.

    The trapezoidal rule between samples predicts whole turns. The prediction is valid if the derivative of the angular
    acceleration times spacing^3 / 12 is below pi.
    """
    out = angle.copy()
    out[0] = start
    with np.errstate(all="ignore"):
        for sample in range(1, len(out)):
            expected = out[sample - 1] + (rate[sample - 1] + rate[sample]) / 2 * spacing
            out[sample] += 2 * np.pi * np.round((expected - out[sample]) / (2 * np.pi))
    return out
