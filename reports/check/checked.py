"""The whole check of a user's model, from its reading to its verdict: numbers alone, told by `telling`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from engines import Unsupported
from engines.reading import Reading
from reference.checks import InvalidMechanism
from reference.trajectory import Trajectory
from reports.check.comparing import Errors, Opening, errors, opening, refuse_disagreement
from reports.check.facts import Facts, facts_of
from reports.check.judging import Judged, judged, often
from reports.check.parts import Parts, parts_of
from reports.check.settings import Tried, best, cheapest, same_step, tried

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
    judge: Judged
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
    judge = judged(mechanism, samples, every * model.dt)
    truth = judge.trajectory
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
