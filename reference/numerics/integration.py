"""Integration of motions at a tight tolerance, with dense output of full order and a known error.

The method is the explicit Runge-Kutta pair of order 8 by Dormand and Prince (Hairer, Norsett, Wanner, Solving Ordinary
Differential Equations I, II.10). The usual interpolant of this pair has order 7 only. Here an additional step of order
8 gives the state at a time between two steps, for all times at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism
from reference.validators import Array

Rates = Callable[[Array], Array]  # states to rates

# Relative error of a step, about the smallest one that double precision allows.
STEP_TOLERANCE = 3e-14
# Factor on the tolerance of a second integration; the error estimate is the difference of the two motions.
COARSER = 10.0
# Maximum number of steps; a motion that needs more approaches a singularity.
MAX_STEPS = 20_000
# The first step as a fraction of the time in which the state would change by its value plus its unit. The value is
# small for any motion, since a step may grow tenfold.
FIRST_STEP = 1e-3
# Number of steps after which the integration checks whether it can end. The integration stops if even steps LENGTHENED
# times as long would exceed the maximum number of steps.
ENOUGH_STEPS = 200
LENGTHENED = 100.0


class IntegrationFailed(ArithmeticError, InvalidMechanism):
    """The motion could not be continued because of a singularity or an overflow."""


def hopeless(now: float, until: float, longest: float, taken: int, most: int) -> bool:
    """Whether an integration at `now` can't reach `until` [s] in `most` steps, by its `longest` step [s]."""
    return taken > ENOUGH_STEPS and until - now > LENGTHENED * longest * (most - taken)


@dataclass(frozen=True)
class Integrated:
    rates: Rates
    times: Array  # (knots,).
    states: Array  # (knots, states).

    def __call__(self, t: ArrayLike) -> Array:
        from scipy.integrate import DOP853

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
    rates: Rates, start: ArrayLike, until: float, tolerance: float = STEP_TOLERANCE, unit: ArrayLike = 1.0
) -> Integrated:
    """Integrate from `start` (states,) at t = 0 to `until` [s].

    The allowed error of a step is `tolerance` times |y| + `unit`. For angles `unit` (states,) is 1; `units_of_motion`
    returns the units of rates. Raises IntegrationFailed if the step vanishes or a number is not finite.
    """
    from scipy.integrate import DOP853

    state = np.asarray(start, dtype=float)
    units = np.broadcast_to(np.asarray(unit, dtype=float), state.shape)
    with np.errstate(invalid="ignore", over="ignore"):
        pace = float(np.max(np.abs(rates(state)) / (np.abs(state) + units), initial=0.0))  # 1/s
    first = min(until, FIRST_STEP / pace) if math.isfinite(pace) and pace > 0 else until
    absolute: Any = tolerance * units  # scipy's types allow only a number here
    solver = DOP853(lambda _, y: rates(y), 0.0, state, until, first_step=first, rtol=tolerance, atol=absolute)
    times, states, longest = [0.0], [state], 0.0
    while solver.status == "running":
        longest = max(longest, times[-1] - times[-2]) if len(times) > 1 else 0.0
        too_many = hopeless(times[-1], until, longest, len(times), MAX_STEPS)
        message = f"it takes more than {MAX_STEPS} steps" if too_many else solver.step()
        if message or not np.all(np.isfinite(solver.y)):
            raise IntegrationFailed(f"the motion stops at t = {solver.t:.6g} s: {message or 'a number is not finite'}")
        times.append(float(solver.t))
        states.append(solver.y.copy())
    return Integrated(rates, np.array(times), np.array(states))


def units_of_motion(rates: Rates, start: ArrayLike, coordinate: float = 1.0) -> Array:
    """The units (states,) of the coordinates and then of their rates.

    The unit of coordinates is an argument: 1 rad, or the start value of a coordinate near an equilibrium. The unit of
    rates is the larger of two rates, divided by 2 pi: the largest rate at the start, and the rate of an oscillation
    with the start's largest acceleration and an amplitude of one unit. So the allowed error does not depend on the unit
    of time.
    """
    state = np.asarray(start, dtype=float)
    half = len(state) // 2
    fastest, hardest = np.abs(state[half:]).max(), np.abs(rates(state)[half:]).max()
    turning = float(max(fastest, math.sqrt(hardest * coordinate))) / (2 * math.pi)
    return np.repeat([coordinate, turning or 1.0], half)  # 1 if at rest


def error_of(
    rates: Rates, start: ArrayLike, t: ArrayLike, tolerance: float = STEP_TOLERANCE, unit: ArrayLike = 1.0
) -> Array:
    """A bound (times,) on the error of the motion, from the difference to a tolerance 10 times larger."""
    t = np.atleast_1d(np.asarray(t, dtype=float))
    until = max(float(t.max()), math.ulp(1.0))
    fine, coarse = (integrate(rates, start, until, factor * tolerance, unit)(t) for factor in (1.0, COARSER))
    return np.abs(fine - coarse).max(axis=-1)
