"""A motion that no formula gives: integrated at tight tolerance, evaluated between the steps without loss, error shown.

The method is the explicit Runge-Kutta pair of order 8 by Dormand and Prince (Hairer, Norsett, Wanner, Solving Ordinary
Differential Equations I, II.10). Between its steps the usual interpolant has order 7 only; here every time asked for is
reached by one more step of order 8 from the knot before it, shorter than a step that was accepted, all times at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import DOP853

from reference.checks import InvalidMechanism

Array = NDArray[np.float64]
Rates = Callable[[Array], Array]  # (..., states) -> (..., states), autonomous

# Near the smallest that double precision can tell apart over a step; the coarser one shows the error.
TOLERANCE = 3e-14
COARSER = 10.0
MOST_STEPS = 20_000  # a motion that needs more is creeping up to a singularity
# Of the time in which the start changes by itself and its unit: short for any motion, and a step may grow tenfold in
# one. What scipy would choose has seconds in it.
FIRST_STEP = 1e-3


# After so many steps, a motion that would take too many even if all others were so much longer is given up.
ENOUGH, LENGTHENED = 200, 100.0


class IntegrationFailed(ArithmeticError, InvalidMechanism):
    """The motion could not be carried on: it meets a singularity, or the numbers overflow."""


def hopeless(now: float, until: float, longest: float, taken: int, most: int) -> bool:
    """Whether a motion can't come from `now` to `until` [s] in `most` steps, `longest` [s] of those `taken`."""
    return taken > ENOUGH and until - now > LENGTHENED * longest * (most - taken)


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


def integrate(
    rates: Rates, start: ArrayLike, until: float, tolerance: float = TOLERANCE, unit: ArrayLike = 1.0
) -> Integrated:
    """Integrate from `start` (states,) at t = 0 to `until` [s]. The error let pass in a step is `tolerance` of
    |y| + `unit` (states,), in which each state is counted: 1 for radians, `units_of_motion` for rates too.

    Raises IntegrationFailed when the step vanishes or a number is no longer finite.
    """
    state = np.asarray(start, dtype=float)
    units = np.broadcast_to(np.asarray(unit, dtype=float), state.shape)
    with np.errstate(invalid="ignore", over="ignore"):
        pace = float(np.max(np.abs(rates(state)) / (np.abs(state) + units), initial=0.0))  # 1/s
    first = min(until, FIRST_STEP / pace) if math.isfinite(pace) and pace > 0 else until
    passed: Any = tolerance * units  # scipy's types have a number only
    solver = DOP853(lambda _, y: rates(y), 0.0, state, until, first_step=first, rtol=tolerance, atol=passed)
    times, states, longest = [0.0], [state], 0.0
    while solver.status == "running":
        longest = max(longest, times[-1] - times[-2]) if len(times) > 1 else 0.0
        many = hopeless(times[-1], until, longest, len(times), MOST_STEPS)
        message = f"it takes more than {MOST_STEPS} steps" if many else solver.step()
        if message or not np.all(np.isfinite(solver.y)):
            raise IntegrationFailed(f"the motion stops at t = {solver.t:.6g} s: {message or 'a number is not finite'}")
        times.append(float(solver.t))
        states.append(solver.y.copy())
    return Integrated(rates, np.array(times), np.array(states))


def units_of_motion(rates: Rates, start: ArrayLike, coordinate: float = 1.0) -> Array:
    """The unit of each state (states,) of a motion whose states are coordinates and then, as many, their rates.

    A coordinate's is given: 1 rad, or its start where that is near a rest that it will leave. The rates' is the fastest
    of the start, or of an oscillation of one unit that has the start's largest acceleration, once round in a period. It
    scales with the second: an error let pass in rad/s would be none in nanoseconds, and all of them in years.
    """
    state = np.asarray(start, dtype=float)
    half = len(state) // 2
    fastest, hardest = np.abs(state[half:]).max(), np.abs(rates(state)[half:]).max()
    turning = float(max(fastest, math.sqrt(hardest * coordinate))) / (2 * math.pi)
    return np.repeat([coordinate, turning or 1.0], half)  # at rest for ever, any unit will do


def error_of(
    rates: Rates, start: ArrayLike, t: ArrayLike, tolerance: float = TOLERANCE, unit: ArrayLike = 1.0
) -> Array:
    """How far the motion moves (times,) when its tolerance is made 10 times coarser: a bound on its own error."""
    t = np.atleast_1d(np.asarray(t, dtype=float))
    until = max(float(t.max()), math.ulp(1.0))
    fine, coarse = (integrate(rates, start, until, factor * tolerance, unit)(t) for factor in (1.0, COARSER))
    return np.abs(fine - coarse).max(axis=-1)
