"""The user's model at other settings that its engine documents: what each costs, and how wrong it is."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engines.reading import Change, Reading
from reference.trajectory import Trajectory
from reports.check.comparing import Errors, errors

PATIENCE = 5.0  # s of CPU time for all settings together
LONGEST = 1.0  # s of it for one run: smaller steps than that allows are left out


@dataclass(frozen=True, eq=False)
class Tried:
    """One setting: its largest error in the measure of a tolerance, and the CPU time of stepping [s]."""

    change: Change
    error: float
    cost: float
    errors: Errors
    run: Trajectory


def tried(
    reading: Reading,
    truth: Trajectory,
    samples: int,
    every: int,
    own: Trajectory,
    told: Callable[[int, int], None],
    patience: float | None = None,
) -> list[Tried]:
    """Runs at the documented settings, coarse steps first. `own`: at the user's own, which come first in the answer.

    Left out is what takes too long: by how often the engine would step, from what it took so far. `patience` [s] of CPU
    time, PATIENCE unless given; if it is infinite all are run, whatever a machine takes.
    """
    model, mechanism = reading.model, reading.mechanism
    patience = PATIENCE if patience is None else patience
    smallest = 0.0 if patience == float("inf") else model.dt * max(own.stepping, 1e-4) / LONGEST
    changes = model.changes(min(smallest, model.dt))
    order = sorted(range(1, len(changes)), key=lambda index: -changes[index].dt)
    begin, rate = time.process_time(), max(own.stepping, 1e-5) / (samples * every)
    wrong = errors(mechanism, truth, own)
    found = [(0, Tried(changes[0], wrong.largest, own.stepping, wrong, own))]
    for number, index in enumerate(order):
        change = changes[index]
        told(number, len(changes))
        steps = samples * every * model.dt / change.dt
        if time.process_time() - begin + steps * rate > patience:
            continue
        run = model.run(samples, every, change)
        rate = max(rate, run.stepping / steps)
        wrong = errors(mechanism, truth, run)
        found.append((index, Tried(change, wrong.largest, run.stepping, wrong, run)))
    return [each for _, each in sorted(found, key=lambda pair: pair[0])]


def cheapest(found: list[Tried], tolerance: float) -> Tried | None:
    """The setting of the least cost whose error is within a tolerance, if there is one."""
    good = [each for each in found if each.error <= tolerance]
    return min(good, key=lambda each: each.cost, default=None)


def best(found: list[Tried]) -> list[Tried]:
    """The settings that no other beats in both error and cost, the cheapest first."""
    out: list[Tried] = []
    for each in sorted(found, key=lambda one: (one.cost, one.error)):
        if np.isfinite(each.error) and (not out or each.error < out[-1].error):
            out.append(each)
    return out


def same_step(found: list[Tried], own: Tried) -> list[Tried]:
    """The user's own settings at ever smaller steps, the largest step first."""
    like = [each for each in found if each.change.options == own.change.options]
    return sorted(like, key=lambda each: -each.change.dt)
