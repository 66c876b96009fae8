"""Methods that claim an accuracy, held against the judge on mechanisms that nobody chose: who is wrong, who says so.

cases, _ = judged(seed=31, numbers=range(40))
found = rows(EXTENDED, cases, steps=(1e-3, 1e-2), everies=(1, 10))
print([one for one in found if one.silent])
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from engines import CLAIM, Engine, Unsupported, method_name
from engines.lagrange import TRUTH
from reference.mechanism import Mechanism
from reference.trajectory import Trajectory
from reports.search.mechanisms import mechanism
from reports.search.parts import EVERY

STEPS, EVERIES = (1e-3, 3e-3, 1e-2), (1, 2, 3, 10)
TICK = 1e-3  # s: every step is a whole number of them, and so is every time that is judged
STRIDE = 30  # steps: a motion is a whole number of these, so that every sampling of EVERIES ends with it
DURATION = 0.3  # s, of STRIDE steps at the longest; shorter steps take as many strides as fit in
REACTION = 1e-3  # of the largest reaction: what a method that says nothing of reactions may miss


@dataclass(frozen=True)
class Case:
    """A mechanism, by its place in a list, and its motion as the judge has it, once every TICK."""

    number: int
    mechanism: Mechanism
    truth: Trajectory


@dataclass(frozen=True)
class Row:
    """One run. Errors are the largest of the motion: of poses in radians or mechanism's lengths, of reactions in the
    largest reaction. A quantity is told of by a warning that names it; of poses `unresolved_at` tells from then on.
    """

    number: int
    method: str
    step: float
    every: int
    outcome: str  # "finished", "unresolved", or "lost" where it was reset or holds no numbers
    error: float
    estimate: float  # NaN for none
    told: bool
    silent: bool  # off by more than the claim at a time at which nothing was told
    reaction: float
    reaction_told: bool
    reaction_silent: bool  # the same of reactions; where poses are unresolved, nobody believes these
    warnings: tuple[str, ...]


def judged(seed: int, numbers: Iterable[int], kinds: tuple[str, ...] = EVERY) -> tuple[list[Case], list[int]]:
    """Cases, and the numbers of those whose motion the judge itself does not know to a tenth of the claim.

    It says so itself: where another tolerance makes another motion, or it stops at a singular position.
    """
    cases, unknown = [], []
    for number in numbers:
        own = mechanism(seed, number, kinds)
        truth = TRUTH.build(own, TICK)(round(DURATION / TICK), 1)
        # Not below, where one is no number.
        if np.max(np.asarray(truth.estimate) / sizes(own)) < CLAIM / 10:
            cases.append(Case(number, own, truth))
        else:
            unknown.append(number)
    return cases, unknown


def rows(
    engine: Engine, cases: Sequence[Case], steps: Sequence[float] = STEPS, everies: Sequence[int] = EVERIES
) -> list[Row]:
    """A row for each case, step [s] and number of steps a sample; none where the engine can't build it."""
    found: list[Row] = []
    for case in cases:
        try:
            found += [row(engine, case, step, every) for step in steps for every in everies]
        except Unsupported:
            continue
    return found


def row(engine: Engine, case: Case, step: float, every: int) -> Row:
    """One run against the judge. Raises Unsupported where the engine can't build it."""
    samples = round(DURATION / step) // STRIDE * STRIDE // every
    with np.errstate(all="ignore"):
        run = engine.build(case.mechanism, step)(samples, every)
    at = np.round(run.t / TICK).astype(int)
    size = sizes(case.mechanism)
    # A pose that is no number counts as wrong; a reaction that is not read, as a change of velocity at the start, not.
    pose = np.nan_to_num((np.abs(run.pose - case.truth.pose[at]) / size).max(axis=(1, 2)), nan=inf)
    reaction = np.nan_to_num(_reaction_errors(case, run, at), nan=0.0)
    claimed = run.t < min(inf if when is None else when for when in (run.unresolved_at, run.reset_at))
    lost = run.reset_at is not None or not np.isfinite(pose).all()
    of_reactions = ["reactions" in words or "accelerations" in words for words in run.warnings]
    of_poses = ["unresolved" in words for words, other in zip(run.warnings, of_reactions, strict=True) if not other]
    return Row(
        case.number,
        method_name(engine),
        step,
        every,
        "lost" if lost else "finished" if run.unresolved_at is None else "unresolved",
        float(pose.max()),
        np.nan if run.estimate is None else float(np.max(run.estimate / size)),
        lost or run.unresolved_at is not None or bool(of_poses),
        # "Unresolved from t on" says nothing of the time before.
        bool(np.any(claimed & (pose > CLAIM))) and not lost and all(of_poses),
        float(reaction.max()),
        lost or any(of_reactions),
        bool(np.any(claimed & (reaction > REACTION))) and not lost and not any(of_reactions),
        run.warnings,
    )


def sizes(own: Mechanism) -> NDArray[np.float64]:
    """What a pose [m, m, rad] is measured by."""
    return np.array([own.length_scale, own.length_scale, 1.0])


def _reaction_errors(case: Case, run: Trajectory, at: NDArray[np.int_]) -> NDArray[np.float64]:
    """(times,) in the largest reaction of the motion, a torque as the force that it is at the mechanism's length.

    Where nothing is held with force, what the heaviest body needs at the mechanism's own time is the measure.
    """
    own, truth = case.mechanism, case.truth.reaction
    if not own.row_count:
        return np.zeros(len(run.t))
    arm = np.where(own.turning, own.length_scale, 1.0)
    usual = max(body.mass for body in own.bodies) * own.length_scale / own.time_scale**2
    largest = max(float(np.abs(truth / arm).max()), usual)
    return np.abs((run.reaction - truth[at]) / arm).max(axis=1) / largest
