"""The sweep over documented settings within a CPU time limit, and the choice of the advised setting."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from engines.reading import Change, Reading
from reference.trajectory import Trajectory
from reports.check.judging import Errors, measure_errors
from reports.model.spending import EQUAL_COST_FACTOR

MAX_RUN_TIME = 1.0  # Longest CPU time of one run [s]. Steps that need more time are left out.
HELPFUL_RATIO = 0.75  # A smaller step is helpful if it reduces the error below this share of the previous error.
SATURATED_ERROR = 1.0  # The causes of a larger error [rad, or lengths of the mechanism] can't be separated.
# A saturated error counts as constant if its relative change is smaller. Errors of coarse steps seldom agree by chance.
SATURATED_CHANGE = 0.01
# A smaller step reduces an error as the last halving of the step did. The error may be smaller by this factor, since
# errors of coarse steps are irregular.
IRREGULARITY = 4.0
SMALLER_STEPS = 4  # Number of smaller steps with the user's settings, which separate the causes of the error.


@dataclass(frozen=True)
class SweepPlan:
    """Options that determine which documented settings are tried."""

    patience: float  # CPU time for all settings [s].
    goal: float | None = None  # Try smaller steps until the error of a setting is at most this value.
    quick: bool = False  # Try four settings, and integrate the declared motion with a larger tolerance.
    everything: bool = False  # Also try settings that are too expensive to be advised.


@dataclass(frozen=True, eq=False)
class SettingRun:
    change: Change
    errors: Errors
    run: Trajectory
    cost: float = np.nan  # CPU time of stepping [s], by `with_costs`.
    front: bool = False  # Whether no other setting in the table is both cheaper and more accurate.

    @property
    def error(self) -> float:
        return self.errors.largest

    @property
    def reaction(self) -> float:
        return self.errors.worst["reaction"]


def run_settings_sweep(
    reading: Reading,
    truth: Trajectory,
    samples: int,
    every: int,
    user_run: Trajectory,
    on_progress: Callable[[int, int], None],
    plan: SweepPlan,
    tolerance: float,
) -> list[SettingRun]:
    """Run the documented settings, beginning with large steps. In the result the user's settings come first. Before a
    run its CPU time is estimated as the number of steps times the largest measured time of a step. A setting is left
    out if this time is too long."""
    model = reading.model

    def result(change: Change, run: Trajectory) -> SettingRun:
        return SettingRun(change, measure_errors(reading.mechanism, truth, run, reading.jumps), run)

    all_wanted = plan.quick or plan.everything or plan.patience == float("inf")
    unlimited = plan.goal is not None or plan.quick or plan.patience == float("inf")
    smallest = 0.0 if unlimited else model.dt * max(user_run.stepping, 1e-4) / MAX_RUN_TIME
    changes = model.changes(min(smallest, model.dt), plan.goal is not None)
    order = sorted(
        _quick_choice(changes) if plan.quick else range(1, len(changes)), key=lambda index: -changes[index].dt
    )
    begin, rates = time.process_time(), {changes[0].options: max(user_run.stepping, 1e-5) / (samples * every)}
    done = {0: result(changes[0], user_run)}
    for number, index in enumerate(order):
        change, settings = changes[index], with_costs(list(done.values()))
        same_options = [setting for setting in settings if setting.change.options == change.options]
        if plan.goal is not None and settings[-1].error <= plan.goal:
            break
        on_progress(number, len(order))
        steps = samples * every * model.dt / change.dt
        cost = steps * rates.get(change.options, max(rates.values()))
        if time.process_time() - begin + cost > plan.patience:
            continue
        for_parts = plan.goal is None and same_options[:1] == settings[:1] and len(same_options) <= SMALLER_STEPS
        if same_options:  # As in `with_costs`, whose costs are compared below.
            cost = same_options[0].cost * same_options[0].change.dt / change.dt
        tenth = a_tenth(settings, tolerance) if plan.goal is None else None
        dear = tenth is not None and cost > EQUAL_COST_FACTOR * tenth.cost
        dominated = plan.goal is None and _is_dominated(settings, same_options, change.dt, cost, tolerance)
        if (dear or dominated or _has_plateaued(same_options)) and not (all_wanted or for_parts):
            continue
        run = model.run(samples, every, change)
        rates[change.options] = max(run.stepping / steps, rates.get(change.options, 0.0))
        done[index] = result(change, run)
    table = with_costs([done[index] for index in sorted(done)])
    front = pareto_front(table)
    return [replace(setting, front=setting in front) for setting in table]


def with_costs(table: list[SettingRun]) -> list[SettingRun]:
    """The settings with their costs. A cost is the number of steps times the least measured time of a step with the
    same options, since the times of short runs scatter, and recording takes most of the time of a run with few steps.
    A run that gave up is not timed, unless all runs with these options gave up."""
    out = []
    for setting in table:
        same_options = [other for other in table if other.change.options == setting.change.options]
        timed = [other for other in same_options if other.errors.finished] or same_options
        # All runs have the same duration, so the time of a step is proportional to this product.
        least = min(other.run.stepping * other.change.dt for other in timed)
        out.append(replace(setting, cost=least / setting.change.dt))
    return out


def _is_dominated(
    table: list[SettingRun], same_options: list[SettingRun], dt: float, cost: float, tolerance: float
) -> bool:
    """Whether a setting within the tolerance costs less than `cost` [s], so that a setting of this cost is not advised,
    and has a smaller error than is expected at a step dt. The error at dt is extrapolated from the two smallest steps
    with the same options, unless an error is saturated."""
    last = sorted(same_options, key=lambda setting: setting.change.dt)[:2]
    if len(last) < 2 or not max(setting.error for setting in last) < SATURATED_ERROR:
        return False
    (small, error), (large, coarser) = ((setting.change.dt, setting.error) for setting in last)
    order = np.log(coarser / error) / np.log(large / small) if coarser > error > 0 else 0.0
    expected = error * (dt / small) ** order / IRREGULARITY
    return any(setting.cost < cost and setting.error < min(expected, tolerance) for setting in table)


def _quick_choice(changes: list[Change]) -> list[int]:
    """Indices of four settings: the user's options with dt / 4, and the last options with dt, dt / 4 and dt / 16."""
    user, last = changes[0], changes[-1].options
    wanted = [(user.options, 4), (last, 1), (last, 4), (last, 16)]
    places = {(change.options, round(user.dt / change.dt)): index for index, change in enumerate(changes)}
    return sorted({places[key] for key in wanted if key in places} - {0})


def _has_plateaued(table: list[SettingRun]) -> bool:

    def stays(before: float, after: float) -> bool:
        return (
            after >= HELPFUL_RATIO * before
            if before < SATURATED_ERROR
            else abs(after - before) <= SATURATED_CHANGE * before
        )

    last = [setting.error for setting in sorted(table, key=lambda setting: -setting.change.dt)][-3:]
    return len(last) == 3 and bool(np.isfinite(last).all()) and all(stays(a, b) for a, b in pairwise(last))


def cheapest(table: list[SettingRun], tolerance: float) -> SettingRun | None:
    """The cheapest setting whose error is within the tolerance, or None if there is none.

    Of settings with equal costs, within `EQUAL_COST_FACTOR`, this is the most accurate one. Otherwise the noise of the
    CPU times would choose, and the next check of the same model could advise another setting.
    """
    sufficient = [setting for setting in table if setting.error <= tolerance]
    least = min((setting.cost for setting in sufficient), default=0.0)
    equal = [setting for setting in sufficient if setting.cost <= EQUAL_COST_FACTOR * least]
    return min(equal, key=lambda setting: setting.error, default=None)


def a_tenth(settings: list[SettingRun], tolerance: float) -> SettingRun | None:
    """The cheapest setting with at most a tenth of the error of the cheapest setting within the tolerance."""
    advised = cheapest(settings, tolerance)
    return None if advised is None else cheapest(settings, advised.error / 10)


def pareto_front(table: list[SettingRun]) -> list[SettingRun]:
    """The settings, cheapest first, for which no other setting is both cheaper and more accurate."""
    out: list[SettingRun] = []
    for setting in sorted(table, key=lambda setting: (setting.cost, setting.error)):
        if np.isfinite(setting.error) and (not out or setting.error < out[-1].error):
            out.append(setting)
    return out


def runs_by_step(table: list[SettingRun], user: SettingRun) -> list[SettingRun]:
    """Runs with the user's settings at different steps, the largest step first."""
    same_options = [setting for setting in table if setting.change.options == user.change.options]
    return sorted(same_options, key=lambda setting: -setting.change.dt)
