"""The check of a user's model from reading to verdict, as numbers. `reports.check.telling` renders them as text."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.loading import Kind, registered_by_key
from engines.reading import AS_IT_IS, Reader, Reading, ReadingTerms
from reference.checks import InvalidMechanism
from reference.trajectory import Trajectory
from reports.check.facts import Facts, compute_facts
from reports.check.first_use import ideal_motion
from reports.check.judging import (
    SOFT_TOLERANCE,
    Errors,
    IdealMotion,
    Opening,
    find_opening,
    measure_errors,
    pose_distance,
    refuse_disagreement,
    soft_motion,
)
from reports.check.settings import (
    HELPFUL_RATIO,
    SMALLER_STEPS,
    SettingRun,
    SweepPlan,
    a_tenth,
    cheapest,
    run_settings_sweep,
    runs_by_step,
)
from reports.run.files import is_stream
from reports.write.tables import number

SWEEP_BUDGET = 5.0  # CPU time for all settings together [s].
SEARCH_BUDGET = 60.0  # CPU time for the search of settings that meet the user's tolerance [s].
READER_MEMBERS = ("words", "elements", "reads", "read")  # Every reader must have these members.
NAMES_LISTED = 6  # Largest number of elements that a sentence names.
COMPARED_SAMPLES = 200  # Approximate number of compared instants.
OBSTACLE_CHECKS = 10  # Largest number of obstacle checks between two samples.
APPLY_MARGIN = 1.1  # If the error exceeds the expected error by this factor, some settings had no effect on the model.
QUICK_TOLERANCE = 1e-9  # Relative tolerance of the declared motion with --quick, enough for errors of two digits.
Array = NDArray[np.float64]


def readers() -> dict[str, Reader]:
    """Name -> reader of users' models, from the entry point group `crosscheck.readers`."""
    lacking = f"it lacks one of {', '.join(READER_MEMBERS)}"
    kind = Kind("reader", lambda value: "" if all(hasattr(value, name) for name in READER_MEMBERS) else lacking)
    return registered_by_key("crosscheck.readers", kind)


def read_user_model(word: str, folder: Path, terms: ReadingTerms = AS_IT_IS) -> Reading:
    """Read a user's model with the first reader that accepts it. Raises ValueError and Unsupported."""
    all_readers = readers().values()
    for reader in all_readers:
        if reader.reads(word):
            return reader.read(word, folder, terms)
    raise ValueError(f"{word or repr(word)} is no model; give {' or '.join(reader.words for reader in all_readers)}")


@dataclass(frozen=True)
class ErrorParts:
    """Contributions to the error, as largest pose distances (`judging.pose_distance`). NaN means unknown."""

    softness: float  # Distance of the motion with the engine's declared soft joints from the ideal motion.
    step: float  # Distance of the user's run from the motion with the declared soft joints.
    rest: float  # Distance of the run at the smallest step from the motion with the declared soft joints.
    smallest: float  # The smallest step of the sweep [s].
    falling: bool  # Whether the error still decreases at the smallest step, so that `rest` is an upper bound.
    divided: bool = True  # Whether the engine declares a law of its joints, so that softness and step are separated.


def split_error(
    reading: Reading,
    truth: Trajectory,
    own: Trajectory,
    smaller: list[SettingRun],
    tolerance: float = SOFT_TOLERANCE,
    horizon: float = np.inf,
) -> ErrorParts:
    """Split the error of the user's run. smaller: runs of the same settings at smaller steps, the largest step first.
    tolerance: relative tolerance of the integration with soft joints. Samples after `horizon` [s] do not count."""
    mechanism, model = reading.mechanism, reading.model
    declared, softness = truth.pose, 0.0 if model.declares else float("nan")
    early = truth.t <= horizon
    if model.declares and model.has_soft_joints:
        declared = soft_motion(mechanism, model.regularisation, truth.t, tolerance, model.start_twist)
        softness = _largest(pose_distance(mechanism, declared, truth.pose)[early])
    distances = [
        _largest(pose_distance(mechanism, run.pose, declared)[early])
        for run in (own, *(setting.run for setting in smaller))
    ]
    rest, smallest, falling = float("nan"), float("nan"), False
    if smaller:
        rest, smallest, falling = distances[-1], smaller[-1].change.dt, distances[-1] < HELPFUL_RATIO * distances[-2]
    return ErrorParts(softness, distances[0], rest, smallest, falling, model.declares)


def _largest(values: Array) -> float:
    return float(values.max()) if np.isfinite(values).all() else float("inf")


@dataclass(frozen=True)
class Applied:
    file: str
    words: str  # Description of the settings.
    error: float  # Largest error of the run.
    cpu: float  # CPU time of stepping [s].
    notes: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class CheckResult:
    """The result of a check. Errors are angles [rad] or distances divided by the length of the mechanism."""

    name: str
    reading: Reading
    duration: float
    tolerance: float
    agreement: float  # Relative difference of the initial accelerations between engine and judge.
    facts: Facts
    judge: IdealMotion
    judge_errors: Errors
    opens: Opening | None
    parts: ErrorParts
    table: list[SettingRun]  # The first run has the user's settings.
    has_tolerance: bool = True  # Whether the user gave the tolerance.
    applied: Applied | None = None

    @property
    def own(self) -> Trajectory:
        return self.table[0].run

    @property
    def own_errors(self) -> Errors:
        return self.table[0].errors

    @property
    def own_cost(self) -> float:
        return self.table[0].cost

    @property
    def met(self) -> bool:
        return self.own_errors.largest <= self.tolerance

    @property
    def verdict(self) -> str:
        assumed, engine = self.reading.model.assumed, self.reading.model.engine
        start = f"With {assumed}, {self.name} in {engine}" if assumed else f"{self.name} in {engine}"
        end = (
            f"; the tolerance of {number(self.tolerance)} is {'met' if self.met else 'missed'}."
            if self.has_tolerance
            else "."
        )
        if self.facts.locked:
            start = f"{start} can't move, since its joints leave no freedom{self._hinges_instead}; it"
        if not self.own_errors.finished:
            return f"{start} gives up before {self.duration:g} s{end}"
        return f"{start} is off by up to {number(self.own_errors.largest)} in {self.duration:g} s{end}"

    @property
    def _hinges_instead(self) -> str:
        if not (welds := self.facts.locking_welds):
            return ""
        hinge = "connect, which holds a point and no angle," if self.reading.model.engine == "MuJoCo" else "a hinge"
        return f" (weld {', '.join(welds[:NAMES_LISTED])} holds the angle too; {hinge} was perhaps meant)"

    @property
    def advised(self) -> SettingRun | None:
        return cheapest(self.table, self.tolerance)

    @property
    def decade(self) -> SettingRun | None:
        """The cheapest setting with at most a tenth of the error of the advised setting."""
        return a_tenth(self.table, self.tolerance)

    @property
    def chaotic(self) -> bool:
        """Whether neighbouring motions diverge exponentially before the end."""
        return self.judge.horizon < self.duration

    def until_horizon(self, each: Errors) -> float:
        """The largest error before neighbouring motions diverge exponentially."""
        return _largest(each.whole[each.t <= self.judge.horizon])

    @property
    def error_until_horizon(self) -> float:
        return self.until_horizon(self.own_errors)

    def rerun(self, reading: Reading) -> tuple[float, float]:
        """Run another model for the same duration and return (largest error, CPU time [s])."""
        spacing = float(self.judge.trajectory.t[1])
        run = reading.model.run(len(self.judge.trajectory.t) - 1, max(1, round(spacing / reading.model.dt)))
        return measure_errors(reading.mechanism, self.judge.trajectory, run).largest, run.stepping


def check(
    reading: Reading,
    name: str,
    duration: float,
    tolerance: float,
    on_progress: Callable[[str], None] = lambda stage: None,
    plan: SweepPlan | None = None,
    has_tolerance: bool = True,
) -> CheckResult:
    """Check a model for a motion of `duration` [s]; `on_progress` is called with the name of each stage. Raises
    Unsupported if the motion reaches an obstacle such as a joint limit, which ideal mechanisms do not have. Raises
    InvalidMechanism if the ideal motion can't be computed."""
    mechanism, model, plan = reading.mechanism, reading.model, plan or SweepPlan(SWEEP_BUDGET)
    if not 0 < model.dt < float("inf"):
        raise InvalidMechanism(f"the model's own step is {model.dt:g} s; it must be a finite time above zero")
    on_progress("comparing the accelerations at t = 0")
    agreement = refuse_disagreement(reading)
    every = max(1, round(duration / COMPARED_SAMPLES / model.dt))
    samples = max(1, round(duration / (every * model.dt)))
    if samples * every * model.dt > 2 * duration:
        raise InvalidMechanism(
            f"--duration is {duration:g} s; the model's own step is {model.dt:g} s; give a longer one"
        )
    judge = ideal_motion(mechanism, samples, every * model.dt, tolerance, on_progress)
    truth = judge.trajectory
    samples = len(truth.t) - 1
    for met in model.obstacles(*resample(truth, min(every, OBSTACLE_CHECKS))):
        shorter = f"give --duration {_below(met.t):g}; " if met.t > every * model.dt else ""
        raise Unsupported(f"{met.words} at {met.t:.3g} s, which an ideal mechanism doesn't know; {shorter}{met.remedy}")
    facts = compute_facts(mechanism, truth)
    on_progress("running your own settings")
    user_run = model.run(samples, every)
    reading = replace(reading, notes=(*model.remarks(user_run), *reading.notes))

    def progress(number: int, count: int) -> None:
        on_progress(f"trying documented settings, {number + 1} of {count}")

    table = run_settings_sweep(reading, truth, samples, every, user_run, progress, plan, tolerance)
    on_progress("separating softness and step")
    smaller = runs_by_step(table, table[0])[1 : 1 + SMALLER_STEPS]
    soft_tolerance = QUICK_TOLERANCE if plan.quick else SOFT_TOLERANCE
    parts = split_error(reading, truth, user_run, smaller, soft_tolerance, judge.horizon)
    judge_errors, opens = measure_errors(mechanism, truth, judge.looser), find_opening(mechanism, user_run)
    duration = float(truth.t[-1])
    return CheckResult(
        name, reading, duration, tolerance, agreement, facts, judge, judge_errors, opens, parts, table, has_tolerance
    )


def _below(at: float) -> float:
    size = 10.0 ** np.floor(np.log10(at) - 1)
    return float(np.floor(at * 0.999 / size) * size)


def apply_advised(result: CheckResult, target: Path) -> Applied:
    """Write the model with the advised settings and run it. A model that meets the tolerance is written unchanged.
    Raises Unsupported if the file can't be written. The target is then unchanged."""
    source, advised = result.reading.source, result.advised
    if source is None:
        raise Unsupported("--apply: this model has no text to be changed; give its MJCF file or its script")
    if is_stream(target):
        raise Unsupported(f"--apply: {target} is no file, and the model is read from it again")
    if target.suffix.lower() != source.path.suffix.lower():
        raise Unsupported(f"--apply is {str(target)!r}; it must end in {source.path.suffix}, as the model does")
    if advised is None:
        raise Unsupported(
            f"--apply: no documented setting that was tried meets {result.tolerance:g}, so nothing was written; give "
            "--fix-to for a longer search, or a larger tolerance"
        )
    user_setting = result.table[0]
    change, applied_words = (
        (user_setting.change, "your settings as they are") if result.met else (advised.change, advised.change.words)
    )
    text = source.path.read_bytes() if result.met else source.changed(change)
    try:
        # The file is in the folder of the target, since the model may contain paths relative to this folder.
        aside = target.with_name(f".{target.stem}.crosscheck{target.suffix}")
        aside.write_bytes(text)
        try:
            reading = source.read(aside)
            error, cpu = result.rerun(reading)
            aside.replace(target)
        finally:
            aside.unlink(missing_ok=True)
    except OSError as reason:
        raise Unsupported(f"--apply: {target} can't be written ({reason.strerror or reason})") from None
    notes = [f"{note.element}: {note.reason}" for note in reading.notes if note not in result.reading.notes]
    promised = user_setting.error if result.met else advised.error
    if not error <= APPLY_MARGIN * promised + 1e-12:
        notes.append(
            f"{promised:.2g} was expected: some elements keep values of their own, such as those of an included file"
        )
    return Applied(str(target), applied_words, error, cpu, tuple(notes))


def resample(motion: Trajectory, parts: int) -> tuple[Array, Array, Array]:
    """Times, poses and twists with `parts` instants per sampling interval, by cubic Hermite interpolation."""
    instant = np.arange(parts * (len(motion.t) - 1) + 1)
    index = np.minimum(instant // parts, len(motion.t) - 2)
    share = (instant / parts - index)[:, None, None]
    span = np.diff(motion.t)[index, None, None]
    t = motion.t[index] + (span * share)[:, 0, 0]
    start, mean = motion.twist[index], np.diff(motion.pose, axis=0)[index] / span
    square, cube = 3 * mean - 2 * start - motion.twist[index + 1], start + motion.twist[index + 1] - 2 * mean
    pose = motion.pose[index] + span * share * (start + share * (square + share * cube))
    return t, pose, start + share * (2 * square + 3 * share * cube)
