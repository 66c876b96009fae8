"""The whole check of a user's model, from its reading to its verdict: numbers alone; `telling` renders them."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.lagrange.loading import is_cold
from engines.loading import Kind, registered_by_key
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
from reports.write.tables import number

PATIENCE = 5.0  # s of CPU time for all settings together
LONGEST = 1.0  # s of it for one run: smaller steps than that allows are left out
COMPILING = "compiling the judge's machine code, once for this installation: up to two minutes"
SEARCH = 60.0  # s of CPU time to look for settings that reach a goal


@dataclass(frozen=True)
class Plan:
    """Which documented settings are tried: those that may be advised, within `patience` [s of CPU time].

    goal: an error; ever smaller steps are tried until a setting is within it. quick: four settings, and rougher parts.
    everything: also settings that cost more than one with a tenth of the error that is asked for.
    """

    patience: float
    goal: float | None = None
    quick: bool = False
    everything: bool = False


MEMBERS = ("words", "elements", "reads", "read")


def readers() -> dict[str, Reader]:
    """The readers of users' models, by the keys of the entry point group `crosscheck.readers`."""
    lacking = f"it lacks one of {', '.join(MEMBERS)}"
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
    errors: Errors
    run: Trajectory
    front: bool = False  # no other that was tried is both cheaper and better

    @property
    def error(self) -> float:
        return self.errors.largest

    @property
    def cost(self) -> float:
        return self.run.stepping

    @property
    def reaction(self) -> float:
        """Of the largest true one of its kind."""
        return self.errors.worst["reaction"]


def tried(
    reading: Reading,
    truth: Trajectory,
    samples: int,
    every: int,
    user_run: Trajectory,
    progress: Callable[[int, int], None],
    plan: Plan,
    tolerance: float,
) -> list[Tried]:
    """Runs at the documented settings, coarse steps first; the user's own settings come first in the result.

    A setting is left out where it would take too long, by the number of its steps and the CPU time of a step so far.
    """
    model = reading.model

    def result(change: Change, run: Trajectory) -> Tried:
        return Tried(change, errors(reading.mechanism, truth, run, reading.jumps), run)

    all_wanted = plan.quick or plan.everything or plan.patience == float("inf")
    unlimited = plan.goal is not None or plan.quick or plan.patience == float("inf")
    smallest = 0.0 if unlimited else model.dt * max(user_run.stepping, 1e-4) / LONGEST
    changes = model.changes(min(smallest, model.dt), plan.goal is not None)
    order = sorted(_few(changes) if plan.quick else range(1, len(changes)), key=lambda index: -changes[index].dt)
    begin, rates = time.process_time(), {changes[0].options: max(user_run.stepping, 1e-5) / (samples * every)}
    done = {0: result(changes[0], user_run)}
    for place, index in enumerate(order):
        change, settings = changes[index], list(done.values())
        alike = [setting for setting in settings if setting.change.options == change.options]
        if plan.goal is not None and settings[-1].error <= plan.goal:
            break
        progress(place, len(order))
        steps = samples * every * model.dt / change.dt
        cost = steps * rates.get(change.options, max(rates.values()))
        if time.process_time() - begin + cost > plan.patience:
            continue
        for_parts = plan.goal is None and alike[:1] == settings[:1] and len(alike) <= SMALLER
        dear = plan.goal is None and cost > _enough(settings, tolerance)
        if (dear or _stays(alike)) and not (all_wanted or for_parts):
            continue
        run = model.run(samples, every, change)
        rates[change.options] = max(run.stepping / steps, rates.get(change.options, 0.0))
        done[index] = result(change, run)
    table = [done[index] for index in sorted(done)]
    front = best(table)
    return [replace(setting, front=setting in front) for setting in table]


def _enough(table: list[Tried], tolerance: float) -> float:
    """CPU time [s] of a setting with a tenth of the advised one's error: a setting that takes longer is not advised."""
    advised = cheapest(table, tolerance)
    decade = None if advised is None else cheapest(table, advised.error / 10)
    return float("inf") if decade is None else decade.cost


def _few(changes: list[Change]) -> list[int]:
    """The user's own settings at a quarter of the step, and the last kind at that step, a quarter and a sixteenth."""
    user, last = changes[0], changes[-1].options
    wanted = [(user.options, 4), (last, 1), (last, 4), (last, 16)]
    places = {(change.options, round(user.dt / change.dt)): index for index, change in enumerate(changes)}
    return sorted({places[key] for key in wanted if key in places} - {0})


def _stays(table: list[Tried]) -> bool:
    """Whether smaller steps have stopped to help: the last two of them took less than a quarter of the error away, or
    hardly changed an error that is SATURATED.
    """

    def stays(before: float, after: float) -> bool:
        return after >= FALLS * before if before < SATURATED else abs(after - before) <= ALIKE * before

    last = [setting.error for setting in sorted(table, key=lambda setting: -setting.change.dt)][-3:]
    return len(last) == 3 and bool(np.isfinite(last).all()) and all(stays(a, b) for a, b in pairwise(last))


def cheapest(table: list[Tried], tolerance: float) -> Tried | None:
    """The setting of the least cost whose error is within a tolerance, if there is one."""
    return min((each for each in table if each.error <= tolerance), key=lambda setting: setting.cost, default=None)


def best(table: list[Tried]) -> list[Tried]:
    """The settings that no other beats in both error and cost, the cheapest first."""
    out: list[Tried] = []
    for setting in sorted(table, key=lambda setting: (setting.cost, setting.error)):
        if np.isfinite(setting.error) and (not out or setting.error < out[-1].error):
            out.append(setting)
    return out


def same_step(table: list[Tried], user: Tried) -> list[Tried]:
    """The user's own settings at ever smaller steps, the largest step first."""
    alike = [setting for setting in table if setting.change.options == user.change.options]
    return sorted(alike, key=lambda setting: -setting.change.dt)


Array = NDArray[np.float64]
FALLS = 0.75  # of the error before: a smaller step is taken to help
SATURATED = 1.0  # rad, or lengths of the mechanism: above, an error no longer tells its causes
ALIKE = 0.01  # of such an error: two coarse steps are seldom so near by chance, and twice one after the other
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
        declared = soft_motion(mechanism, model.give, truth.t, tolerance, model.own_twist)
        softness = _largest(apart(mechanism, declared, truth.pose)[early])
    left = [_largest(apart(mechanism, run.pose, declared)[early]) for run in (own, *(each.run for each in smaller))]
    if not smaller:
        return Parts(softness, left[0], float("nan"), float("nan"), False, model.declares)
    return Parts(softness, left[0], left[-1], smaller[-1].change.dt, left[-1] < FALLS * left[-2], model.declares)


def _largest(values: Array) -> float:
    return float(values.max()) if np.isfinite(values).all() else float("inf")


MOST_NAMED = 6  # elements in a sentence
SAMPLES = 200  # about so many instants are compared
LOOKS = 10  # times a sample at most: how often a motion is asked what it meets; an engine looks once a step
SMALLER = 4  # runs of the user's own settings at smaller steps that the parts are told from


@dataclass(frozen=True)
class Applied:
    """The file that --apply has written: its largest error, and the CPU time of stepping [s]; `notes`: what stands in
    it.
    """

    file: str
    words: str
    error: float
    cpu: float
    notes: tuple[str, ...]


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
    judge_errors: Errors
    opens: Opening | None
    parts: Parts
    table: list[Tried]  # the user's own settings first
    asked: bool = True  # whether somebody named the tolerance
    applied: Applied | None = None

    @property
    def own(self) -> Trajectory:
        return self.table[0].run

    @property
    def own_errors(self) -> Errors:
        return self.table[0].errors

    @property
    def met(self) -> bool:
        """Whether the user's own settings are within the tolerance."""
        return self.own_errors.largest <= self.tolerance

    @property
    def verdict(self) -> str:
        """The answer in one sentence."""
        assumed, engine = self.reading.model.assumed, self.reading.model.engine
        start = f"With {assumed}, {self.name} in {engine}" if assumed else f"{self.name} in {engine}"
        end = (
            f"; the tolerance of {number(self.tolerance)} is {'met' if self.met else 'missed'}." if self.asked else "."
        )
        if self.facts.locked:
            start = f"{start} can't move, since its joints leave no freedom{self._hinges_instead}; it"
        if not self.own_errors.finished:
            return f"{start} gives up before {self.duration:g} s{end}"
        return f"{start} is off by up to {number(self.own_errors.largest)} in {self.duration:g} s{end}"

    @property
    def _hinges_instead(self) -> str:
        """For a mechanism that is locked by welds: the joint that was perhaps meant."""
        if not (welds := self.facts.locking_welds):
            return ""
        hinge = "connect, which holds a point and no angle," if self.reading.model.engine == "MuJoCo" else "a hinge"
        return f" (weld {', '.join(welds[:MOST_NAMED])} holds the angle too; {hinge} was perhaps meant)"

    @property
    def advised(self) -> Tried | None:
        """The cheapest setting within the tolerance."""
        return cheapest(self.table, self.tolerance)

    @property
    def decade(self) -> Tried | None:
        """The cheapest setting with a tenth of the error of the one that is advised."""
        return None if self.advised is None else cheapest(self.table, self.advised.error / 10)

    @property
    def chaotic(self) -> bool:
        """Whether neighbouring starts part exponentially within the motion."""
        return self.judge.horizon < self.duration

    def until_horizon(self, each: Errors) -> float:
        """The largest error before neighbouring starts part exponentially."""
        early = each.whole[each.t <= self.judge.horizon]
        return _largest(early)

    @property
    def error_until_horizon(self) -> float:
        return self.until_horizon(self.own_errors)

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
    asked: bool = True,
) -> Checked:
    """Check a model for a motion of `duration` [s]. `told` is given a few words before each part of the work.

    Raises Unsupported where the motion meets what ideal joints lack, and InvalidMechanism where it can't be followed.
    """
    mechanism, model, plan = reading.mechanism, reading.model, plan or Plan(PATIENCE)
    if not 0 < model.dt < float("inf"):
        raise InvalidMechanism(f"the model's own step is {model.dt:g} s; it must be a finite time above zero")
    told("comparing the accelerations at t = 0")
    agreement = refuse_disagreement(reading)
    every = max(1, round(duration / SAMPLES / model.dt))
    samples = max(1, round(duration / (every * model.dt)))
    if samples * every * model.dt > 2 * duration:
        raise InvalidMechanism(
            f"--duration is {duration:g} s; the model's own step is {model.dt:g} s; give a longer one"
        )
    told(f"{COMPILING}, before the ideal motion is followed" if is_cold() else "following the ideal motion")
    judge = judged(mechanism, samples, every * model.dt, tolerance)
    truth = judge.trajectory
    samples = len(truth.t) - 1
    for met in model.obstacles(*often(truth, min(every, LOOKS))):
        shorter = f"give --duration {_below(met.t):g}; " if met.t > every * model.dt else ""
        raise Unsupported(f"{met.words} at {met.t:.3g} s, which an ideal mechanism doesn't know; {shorter}{met.remedy}")
    facts = facts_of(mechanism, truth)
    told("running your own settings")
    own = model.run(samples, every)
    reading = replace(reading, notes=(*model.remarks(own), *reading.notes))

    def progress(number: int, count: int) -> None:
        told(f"trying documented settings, {number + 1} of {count}")

    table = tried(reading, truth, samples, every, own, progress, plan, tolerance)
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
        errors(mechanism, truth, judge.looser),
        opening(mechanism, own),
        parts,
        table,
        asked,
    )


def _below(at: float) -> float:
    """A round time below this one [s]."""
    size = 10.0 ** np.floor(np.log10(at) - 1)
    return float(np.floor(at * 0.999 / size) * size)
