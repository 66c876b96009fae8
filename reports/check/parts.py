"""The three parts of an error: what the engine declares of its joints, what the step costs, and what is neither."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from engines.reading import Reading
from reference.trajectory import Trajectory
from reports.check.judging import apart
from reports.check.law import soft_motion
from reports.check.settings import Tried

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
