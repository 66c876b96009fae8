"""A motion that no formula gives: integrated at tight tolerance, evaluated between the steps without loss, error shown.

The method is the explicit Runge-Kutta pair of order 8 by Dormand and Prince (Hairer, Norsett, Wanner, Solving Ordinary
Differential Equations I, II.10). Between its steps the usual interpolant has order 7 only; here every time asked for is
reached by one more step of order 8 from the knot before it, shorter than a step that was accepted, all times at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DOP853

Array = NDArray[np.float64]
Rates = Callable[[Array], Array]  # (..., states) -> (..., states), autonomous

# Near the smallest that double precision can tell apart over a step; the coarser one shows the error.
TOLERANCE = 3e-14
COARSER = 10.0
MOST_STEPS = 20_000  # a motion that needs more is creeping up to a singularity


class IntegrationFailed(ArithmeticError):
    """The motion could not be carried on: it meets a singularity, or the numbers overflow."""


@dataclass(frozen=True)
class Integrated:
    """Knots of a motion, and its rates: call it with times (times,) [s] for states (times, states)."""

    rates: Rates
    times: Array  # (knots,)
    states: Array  # (knots, states)

    def __call__(self, t: ArrayLike) -> Array:
        t = np.atleast_1d(np.asarray(t, dtype=float))
        if t.size and not (t.min() >= self.times[0] and t.max() <= self.times[-1]):
            raise ValueError(f"times must lie in [{self.times[0]}, {self.times[-1]}] s: the motion integrated")
        knot = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1)
        state = self.states[knot]
        step = (t - self.times[knot])[:, None]
        slopes = np.empty((len(DOP853.B), *state.shape))
        for stage, weights in enumerate(DOP853.A[: len(DOP853.B)]):
            slopes[stage] = self.rates(state + step * np.tensordot(weights[:stage], slopes[:stage], axes=1))
        return state + step * np.tensordot(DOP853.B, slopes, axes=1)


def integrate(rates: Rates, start: ArrayLike, until: float, tolerance: float = TOLERANCE) -> Integrated:
    """Integrate from `start` (states,) at t = 0 to `until` [s]; the tolerance is relative, and to the largest of 1 or
    |y|.

    Raises IntegrationFailed when the step vanishes or a number is no longer finite.
    """
    state = np.asarray(start, dtype=float)
    solver = DOP853(lambda _, y: rates(y), 0.0, state, until, rtol=tolerance, atol=tolerance)
    times, states = [0.0], [state]
    while solver.status == "running":
        message = solver.step() if len(times) < MOST_STEPS else f"it takes more than {MOST_STEPS} steps"
        if message or not np.all(np.isfinite(solver.y)):
            raise IntegrationFailed(f"the motion stops at t = {solver.t:.6g} s: {message or 'a number is not finite'}")
        times.append(float(solver.t))
        states.append(solver.y.copy())
    return Integrated(rates, np.array(times), np.array(states))


def error_of(rates: Rates, start: ArrayLike, t: ArrayLike, tolerance: float = TOLERANCE) -> Array:
    """How far the motion moves (times,) when its tolerance is made 10 times coarser: a bound on its own error."""
    t = np.atleast_1d(np.asarray(t, dtype=float))
    until = max(float(t.max()), math.ulp(1.0))
    fine, coarse = (integrate(rates, start, until, factor * tolerance)(t) for factor in (1.0, COARSER))
    return np.abs(fine - coarse).max(axis=-1)
