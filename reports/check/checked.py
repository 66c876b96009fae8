"""The whole check of a user's model, from its reading to its verdict: numbers alone, told by `telling`."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
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
    TOLERANCE,
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
SEARCH = 60.0  # s of CPU time to look for settings that reach a goal


@dataclass(frozen=True)
class Plan:
    """Which documented settings are tried: all that `patience` [s of CPU time] allows; if it is infinite, all.

    `goal`: an error; then ever smaller steps, until a setting is within it. `quick`: four settings, and rougher parts.
    """

    patience: float
    goal: float | None = None
    quick: bool = False

    @classmethod
    def usual(cls, quick: bool = False) -> Plan:
        return cls(PATIENCE, quick=quick)

    @classmethod
    def search(cls, goal: float) -> Plan:
        return cls(SEARCH, goal)


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
    plan: Plan,
) -> list[Tried]:
    """Runs at the documented settings, coarse steps first. `own`: at the user's own, which come first in the answer.

    Left out is what takes too long: by how often the engine would step, from what it took so far.
    """
    model, mechanism = reading.model, reading.mechanism
    unpruned = plan.goal is not None or plan.quick or plan.patience == float("inf")
    smallest = 0.0 if unpruned else model.dt * max(own.stepping, 1e-4) / LONGEST
    changes = model.changes(min(smallest, model.dt), plan.goal is not None)
    order = sorted(_few(changes) if plan.quick else range(1, len(changes)), key=lambda index: -changes[index].dt)
    begin, rate = time.process_time(), max(own.stepping, 1e-5) / (samples * every)
    wrong = errors(mechanism, truth, own)
    found = [(0, Tried(changes[0], wrong.largest, own.stepping, wrong, own))]
    for number, index in enumerate(order):
        if plan.goal is not None and found[-1][1].error <= plan.goal:
            break
        change = changes[index]
        if plan.goal is not None and _stays([each for _, each in found if each.change.options == change.options]):
            continue
        told(number, len(order))
        steps = samples * every * model.dt / change.dt
        if time.process_time() - begin + steps * rate > plan.patience:
            continue
        run = model.run(samples, every, change)
        rate = max(rate, run.stepping / steps)
        wrong = errors(mechanism, truth, run)
        found.append((index, Tried(change, wrong.largest, run.stepping, wrong, run)))
    return [each for _, each in sorted(found, key=lambda pair: pair[0])]


def _few(changes: list[Change]) -> list[int]:
    """The user's own settings at a quarter of the step, and the last kind at that step, a quarter and a sixteenth."""
    own, last = changes[0], changes[-1].options
    wanted = [(own.options, 4), (last, 1), (last, 4), (last, 16)]
    places = {(each.options, round(own.dt / each.dt)): index for index, each in enumerate(changes)}
    return sorted({places[each] for each in wanted if each in places} - {0})


def _stays(found: list[Tried]) -> bool:
    """Whether smaller steps have stopped to help: the last two of them took less than a quarter of the error away."""
    last = [each.error for each in sorted(found, key=lambda each: -each.change.dt)][-3:]
    return len(last) == 3 and np.isfinite(last[0]) and all(b >= FALLS * a for a, b in pairwise(last))


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
QUICK = 1e-9  # of the declared motion, where little time is to be spent: it is compared with errors of two digits


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


def parts_of(
    reading: Reading,
    truth: Trajectory,
    own: Trajectory,
    smaller: list[Tried],
    tolerance: float = TOLERANCE,
    horizon: float = np.inf,
) -> Parts:
    """From the user's run, and those of the same settings at `smaller` steps, the largest step first.

    `tolerance`: of the motion that the engine declares; `horizon` [s]: from there on errors tell no causes.
    """
    mechanism, model = reading.mechanism, reading.model
    declared, softness = truth.pose, 0.0 if model.declares else float("nan")
    early = truth.t <= horizon
    if model.declares and model.softly_held:
        declared, _ = soft_motion(mechanism, model.give, truth.t, tolerance)
        softness = _largest(apart(mechanism, declared, truth.pose)[early])
    left = [_largest(apart(mechanism, run.pose, declared)[early]) for run in (own, *(each.run for each in smaller))]
    if not smaller:
        return Parts(softness, left[0], float("nan"), float("nan"), False, model.declares)
    return Parts(softness, left[0], left[-1], smaller[-1].change.dt, left[-1] < FALLS * left[-2], model.declares)


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

    @property
    def chaotic(self) -> bool:
        """Whether neighbouring starts part exponentially within the motion."""
        return self.judge.horizon < self.duration

    def until_horizon(self, each: Errors) -> float:
        """The largest error before neighbouring starts part exponentially."""
        early = each.whole[each.t <= self.judge.horizon]
        return float(early.max()) if np.isfinite(early).all() else float("inf")

    def rerun(self, reading: Reading) -> tuple[float, float]:
        """(error, CPU time [s]) of the same model with other settings, read anew, in the same motion."""
        spacing = float(self.judge.trajectory.t[1])
        run = reading.model.run(len(self.judge.trajectory.t) - 1, max(1, round(spacing / reading.model.dt)))
        return errors(reading.mechanism, self.judge.trajectory, run).largest, run.stepping


def check(
    reading: Reading,
    name: str,
    duration: float,
    tolerance: float,
    told: Callable[[str], None] = lambda words: None,
    plan: Plan | None = None,
) -> Checked:
    """Check a model for a motion of `duration` [s]. `told` is given a few words before each part of the work.

    Raises Unsupported where the motion meets what ideal joints lack, and InvalidMechanism where it can't be followed.
    """
    mechanism, model, plan = reading.mechanism, reading.model, plan or Plan.usual()
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

    table = tried(reading, truth, samples, every, own, progress, plan)
    told("telling softness from the step")
    smaller = same_step(table, table[0])[1 : 1 + SMALLER]
    parts = parts_of(reading, truth, own, smaller, QUICK if plan.quick else TOLERANCE, judge.horizon)
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
