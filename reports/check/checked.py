"""The whole check of a user's model, from its reading to its verdict: numbers alone, told by `telling`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.entry_points import registered_by_key
from engines.loading import Kind
from engines.reading import Change, Reader, Reading
from reference.checks import InvalidMechanism
from reference.trajectory import Trajectory
from reports.check.facts import Facts, facts_of
from reports.check.judging import (
    Errors,
    IdealMotion,
    Opening,
    apart,
    errors,
    judged,
    often,
    opening,
    refuse_disagreement,
    soft_motion,
)

PATIENCE = 5.0  # s of CPU time for all settings together
LONGEST = 1.0  # s of it for one run: smaller steps than that allows are left out


MEMBERS = ("words", "reads", "read")


def readers() -> dict[str, Reader]:
    """Who reads a user's models, by the keys of the entry point group `crosscheck.readers`."""
    lacking = "it lacks words, reads or read"
    kind = Kind("reader", lambda value: "" if all(hasattr(value, name) for name in MEMBERS) else lacking)
    return registered_by_key("crosscheck.readers", kind)


def read(word: str, folder: Path, without: Sequence[str] = (), key: str = "", step: float | None = None) -> Reading:
    """A user's model by the first reader that knows its kind. Raises ValueError and Unsupported."""
    known = readers().values()
    for reader in known:
        if reader.reads(word):
            return reader.read(word, folder, without, key, step)
    raise ValueError(f"{word or repr(word)} is no model; give {' or '.join(reader.words for reader in known)}")


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


Array = NDArray[np.float64]
FALLS = 0.75  # of the error before: a smaller step is taken to help


@dataclass(frozen=True)
class Parts:
    """Largest errors in the measure of a tolerance; NaN where a part can't be told.

    `softness`: by how much the motion that the engine declares is off the ideal one; `step`: by how much the user's run
    is off the declared motion; `rest`: what of that stays at the smallest step that was tried, `smallest` [s], and
    whether it was still falling there: then it is a bound, and no sign of a third part.
    """

    softness: float
    step: float
    rest: float
    smallest: float
    falling: bool
    divided: bool = True  # False: the engine declares no law whose motion can be worked out


def parts_of(reading: Reading, truth: Trajectory, own: Trajectory, smaller: list[Tried]) -> Parts:
    """From the user's run, and those of the same settings at `smaller` steps, the largest step first."""
    mechanism, model = reading.mechanism, reading.model
    declared = truth.pose
    if not model.declares:
        rests = [each.error for each in smaller]
        last = rests[-1] if rests else float("nan")
        falling = len(rests) > 1 and rests[-1] < FALLS * rests[-2]
        step = smaller[-1].change.dt if smaller else float("nan")
        return Parts(float("nan"), _largest(apart(mechanism, own.pose, declared)), last, step, falling, False)
    if model.softly_held:
        declared, _ = soft_motion(mechanism, model.give, truth.t)
    softness = _largest(apart(mechanism, declared, truth.pose)) if model.softly_held else 0.0
    step = _largest(apart(mechanism, own.pose, declared))
    rests = [_largest(apart(mechanism, each.run.pose, declared)) for each in smaller]
    if not rests:
        return Parts(softness, step, float("nan"), float("nan"), False)
    falling = len(rests) > 1 and rests[-1] < FALLS * rests[-2]
    return Parts(softness, step, rests[-1], smaller[-1].change.dt, falling)


def _largest(values: Array) -> float:
    return float(values.max()) if np.isfinite(values).all() else float("inf")


SAMPLES = 200  # about so many instants are compared
LOOKS = 10  # times a sample at most: how often a motion is asked what it meets; an engine looks once a step
SMALLER = 4  # runs of the user's own settings at smaller steps that the parts are told from


@dataclass(frozen=True, eq=False)
class Checked:
    """All that was found; errors in the measure of a tolerance: angles [rad] and places in lengths of the mechanism."""

    name: str
    reading: Reading
    duration: float
    tolerance: float
    agreement: float  # of the accelerations at t = 0
    facts: Facts
    judge: IdealMotion
    own: Trajectory
    own_errors: Errors
    judge_errors: Errors
    cost: float
    opens: Opening | None
    parts: Parts
    table: list[Tried]

    @property
    def met(self) -> bool:
        """Whether the user's own settings are within the tolerance."""
        return self.own_errors.largest <= self.tolerance

    @property
    def advised(self) -> Tried | None:
        """The cheapest setting within the tolerance."""
        return cheapest(self.table, self.tolerance)

    @property
    def decade(self) -> Tried | None:
        """The cheapest setting with a tenth of the error of the one that is advised."""
        return None if self.advised is None else cheapest(self.table, self.advised.error / 10)

    @property
    def fronts(self) -> list[Tried]:
        return best(self.table)


def check(
    reading: Reading,
    name: str,
    duration: float,
    tolerance: float,
    told: Callable[[str], None] = lambda words: None,
    patience: float | None = None,
) -> Checked:
    """Check a model for a motion of `duration` [s]. `told` is given a few words before each part of the work;
    `patience` [s]: see `settings.tried`.

    Raises Unsupported where the motion meets what ideal joints lack, and InvalidMechanism where it can't be followed.
    """
    mechanism, model = reading.mechanism, reading.model
    told("comparing the accelerations at t = 0")
    agreement = refuse_disagreement(reading)
    every = max(1, round(duration / SAMPLES / model.dt))
    samples = max(1, round(duration / (every * model.dt)))
    if samples * every * model.dt > 2 * duration:
        raise InvalidMechanism(
            f"--duration is {duration:g} s; the model's own step is {model.dt:g} s; give a longer one"
        )
    told("following the ideal motion")
    judge = judged(mechanism, samples, every * model.dt, tolerance)
    truth = judge.trajectory
    samples = len(truth.t) - 1
    for met in model.obstacles(*often(truth, min(every, LOOKS))):
        shorter = f"--duration {_below(met.t):g}, or " if met.t > every * model.dt else ""
        raise Unsupported(
            f"{met.words} at {met.t:.3g} s, which an ideal mechanism doesn't know: give {shorter}{met.remedy}"
        )
    facts = facts_of(mechanism, truth)
    told("running your own settings")
    own = model.run(samples, every)
    own_errors, judge_errors = errors(mechanism, truth, own), errors(mechanism, truth, judge.looser)

    def progress(number: int, count: int) -> None:
        told(f"trying documented settings, {number + 1} of {count}")

    table = tried(reading, truth, samples, every, own, progress, patience)
    told("telling softness from the step")
    smaller = same_step(table, table[0])[1 : 1 + SMALLER]
    parts = parts_of(reading, truth, own, smaller)
    return Checked(
        name,
        reading,
        float(truth.t[-1]),
        tolerance,
        agreement,
        facts,
        judge,
        own,
        own_errors,
        judge_errors,
        own.stepping,
        opening(mechanism, own),
        parts,
        table,
    )


def _below(at: float) -> float:
    """A round time below this one [s]."""
    size = 10.0 ** np.floor(np.log10(at) - 1)
    return float(np.floor(at * 0.999 / size) * size)
