"""Motions q'' = f(q, q') of a few angles by Gauss-Legendre collocation, all nodes of a step at once.

A step, here a window, has so many stages that their polynomial holds the acceleration to rounding: it gives the motion
at every time within, and no error of a method is left that would have to be estimated. The accelerations are found by
repetition: from them follow rates, from these angles, from both new accelerations. A repetition is one call of f with
all nodes, which for a few angles costs hardly more than a call with one state. That is why it pays: seven times as fast
as an explicit method of order 8 at the same tolerance, measured with a fast oscillation beside a slow one.

States are carried in extended precision (where numpy.longdouble is more than a double): next to a fast oscillation the
rounding of an angle, times the square of its frequency, would otherwise be taken for a change of the acceleration, and
windows would become as short as the steps of an explicit method.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.numerics import integration
from reference.numerics.integration import COARSER, IntegrationFailed, Rates, hopeless

Array = NDArray[np.float64]
Extended = NDArray[np.longdouble]
Accelerations = Callable[[Extended, Extended], Extended]  # angles and rates (..., n) to (..., n)

STAGES = 24
# Ten times the rounding of a double, for what the polynomial leaves: the order at a window's end is twice as high, so
# that its error there is far below rounding.
TOLERANCE = 3e-15
# The first window is short for any motion; the others grow until this many repetitions are needed: longer ones need
# more, and save nothing.
FIRST_WINDOW = 0.3
FEW_REPETITIONS, MANY_REPETITIONS, MOST_REPETITIONS = 9, 12, 30
LONGER, SHORTER, HALVED = 1.2, 1 / 1.15, 0.5
GUESSED = 8  # Legendre coefficients of a window from which the accelerations of the next are guessed
MOST_WINDOWS = 20_000  # a motion that needs more is creeping up to a singularity
# Accelerations in double are too rough for windows next to a fast oscillation: from so many on an explicit method is
# cheaper, a tenth of a second lost.
FEW_WINDOWS = 200
COARSE_STAGES = 16  # of the rule that shows the error of the other


class CollocationRule(NamedTuple):
    """Gauss's rule on a step of length 1."""

    weights: Extended  # (stages,)
    matrix: Extended  # (stages, stages) from slopes to increments at the stages
    coefficients: Extended  # (stages, stages) from slopes to their Legendre coefficients


def legendre(degree: int, x: Extended) -> Extended:
    """Legendre polynomials of degrees 0 to `degree` at x, (degree + 1, points)."""
    values: list[Any] = [np.ones_like(x), x]
    for n in range(1, degree):
        values.append(((2 * n + 1) * x * values[n] - n * values[n - 1]) / (n + 1))
    return np.array(values)


@lru_cache
def rule_of(stages: int) -> CollocationRule:
    """The rule with so many stages, to the rounding of numpy.longdouble."""
    nodes = np.polynomial.legendre.leggauss(stages)[0].astype(np.longdouble)
    for _ in range(3):  # Newton: the table is in double
        values = legendre(stages, nodes)
        slope = stages * (nodes * values[stages] - values[stages - 1]) / (nodes**2 - 1)
        nodes = nodes - values[stages] / slope
    values = legendre(stages, nodes)
    slope = stages * (nodes * values[stages] - values[stages - 1]) / (nodes**2 - 1)
    weights = 2 / ((1 - nodes**2) * slope**2)
    degrees = np.arange(stages, dtype=np.longdouble)[:, None]
    to_coefficients = (2 * degrees + 1) / 2 * weights * values[:stages]
    # The integral of P_n from -1 is (P_{n+1} - P_{n-1}) / (2 n + 1), and x + 1 for n = 0.
    integrals = np.concatenate([(nodes + 1)[None], (values[2:] - values[:-2]) / (2 * degrees[1:] + 1)])
    return CollocationRule(weights / 2, integrals.T @ to_coefficients / 2, to_coefficients)


@dataclass(frozen=True)
class Windows:
    """A motion: call it with times (times,) [s] for its angles and rates (times, 2 n), rounded to double."""

    stages: int
    times: Array  # (windows + 1,)
    states: Extended  # (windows + 1, 2 n)
    slopes: list[Extended]  # of each window, the Legendre coefficients of the accelerations (stages, n)

    def __call__(self, t: ArrayLike) -> Array:
        return self.extended(t).astype(float)

    def extended(self, t: ArrayLike) -> Extended:
        """Angles and rates (times, 2 n) with all digits that were carried."""
        t = np.atleast_1d(np.asarray(t, dtype=float))
        if t.size and not (t.min() >= 0 and t.max() <= self.times[-1]):
            raise ValueError(f"times must lie in [0, {self.times[-1]}] s: the motion integrated")
        out = np.empty((len(t), self.states.shape[1]), dtype=np.longdouble)
        window = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.slopes) - 1)
        for one in np.unique(window):
            own = window == one
            begin, end = self.times[one], self.times[one + 1]
            angle, rate = np.split(self.states[one], 2)
            since: Extended = (t[own].astype(np.longdouble) - begin)[:, None]
            length = np.longdouble(end) - begin
            part: Extended = since[:, 0] / length
            once, twice = _integrals(self.stages, part)
            rates = rate + length * (once @ self.slopes[one])
            out[own] = np.concatenate([angle + since * rate + length**2 * (twice @ self.slopes[one]), rates], axis=1)
        return out


def integrate(
    accelerations: Accelerations,
    angle: ArrayLike,
    rate: ArrayLike,
    until: float,
    rate_unit: float,
    stages: int = STAGES,
    tolerance: float = TOLERANCE,
    most: int = MOST_WINDOWS,
) -> Windows:
    """Integrate from angles and rates (n,) at t = 0 to `until` [s]; `rate_unit` [rad/s] is the motion's own rate.

    A window is as short as it takes for its last Legendre coefficient, and for the last repetition, to change rates by
    less than `tolerance`, in parts of the largest rate. Raises IntegrationFailed if windows vanish or exceed `most`.
    """
    rule = rule_of(stages)
    place, speed = (np.asarray(state, dtype=np.longdouble) for state in (angle, rate))
    lost = np.zeros((2, len(place)), dtype=np.longdouble)  # what the additions to the state have rounded away
    start = accelerations(place[None], speed[None])
    pace = max(float(np.abs(speed).max()), math.sqrt(float(np.abs(start).max())))  # rad/s
    now, length = 0.0, min(until, FIRST_WINDOW / pace) if pace > 0 else until
    times, states, slopes = [now], [np.concatenate([place, speed])], []
    guess, tries, longest = np.broadcast_to(start, (stages, len(place))), 0, 0.0
    while now < until:
        tries += 1
        if tries > most or not now + length > now or hopeless(now, until, longest, tries, most):
            raise IntegrationFailed(f"the motion stops at t = {now:.6g} s: its steps become too small or too many")
        length = min(length, until - now)
        then = until if length == until - now else now + length
        exact = np.longdouble(then) - now
        found, repetitions = _found(accelerations, rule, place, speed, exact, guess, rate_unit, tolerance)
        if found is None:
            length *= HALVED
            guess = np.broadcast_to(accelerations(place[None], speed[None]), guess.shape)
            continue
        steps = [
            exact * speed + exact**2 * (rule.weights @ rule.matrix @ found),
            exact * (rule.weights @ found),
        ]
        moved = []
        for part, (old, step) in enumerate(zip((place, speed), steps, strict=True)):
            new = old + (step + lost[part])
            lost[part] = step + lost[part] - (new - old)
            moved.append(new)
        place, speed = moved
        longest = max(longest, then - now)
        now = then
        times.append(now)
        states.append(np.concatenate(moved))
        slopes.append(rule.coefficients @ found)
        factor = LONGER if repetitions <= FEW_REPETITIONS else SHORTER if repetitions > MANY_REPETITIONS else 1.0
        length *= factor
        ahead = legendre(GUESSED - 1, 1 + 2 * (length / float(exact)) * rule.matrix.sum(axis=1))
        guess = ahead.T @ slopes[-1][:GUESSED]
    return Windows(stages, np.array(times), np.array(states), slopes)


Motion = Windows | integration.Integrated


def motion(rates: Rates, start: ArrayLike, until: float, unit: ArrayLike, coarser: float = 1.0) -> Motion:
    """The motion up to `until` [s] of angles and then, as many, their rates (2 n,), whose `rates` are known in double:
    times (times,) to states (times, 2 n). By few windows, else by the explicit method of `integration`.

    unit (2 n,): as for `integration.integrate`. `coarser`: by another rule, and letting so many times as much pass.
    Raises IntegrationFailed.
    """
    state = np.asarray(start, dtype=float)
    half = len(state) // 2

    def accelerations(angle: Extended, rate: Extended) -> Extended:
        found = rates(np.concatenate([angle, rate], axis=-1).astype(float))[..., half:]
        return found.astype(np.longdouble)

    stages, pace = STAGES if coarser == 1 else COARSE_STAGES, float(np.asarray(unit)[-1])
    try:
        with np.errstate(all="ignore"):  # a first guess may lead to where no number is finite
            return integrate(
                accelerations, state[:half], state[half:], until, pace, stages, coarser * TOLERANCE, FEW_WINDOWS
            )
    except IntegrationFailed:
        return integration.integrate(rates, state, until, coarser * integration.TOLERANCE, unit)


def error_of(rates: Rates, start: ArrayLike, t: ArrayLike, unit: ArrayLike) -> Array:
    """A bound on the error of `motion` (times,): COARSER times how far it moves by a coarser rule, and rounding."""
    times = np.atleast_1d(np.asarray(t, dtype=float))
    until = max(float(times.max()), math.ulp(1.0))
    return bound(*(motion(rates, start, until, unit, factor)(times) for factor in (1.0, COARSER)))


def bound(fine: NDArray[Any], coarse: NDArray[Any]) -> Array:
    """A bound (times,) on the error of states (times, n) from those by a coarser rule; not below rounding."""
    return (COARSER * (np.abs(fine - coarse) + np.finfo(float).eps * np.abs(fine))).max(axis=-1).astype(float)


def _found(
    accelerations: Accelerations,
    rule: CollocationRule,
    angle: Extended,
    rate: Extended,
    length: Any,
    guess: Extended,
    unit: float,
    tolerance: float,
) -> tuple[Extended | None, int]:
    """The accelerations at the nodes of a window (stages, n), None if it is too long, and the repetitions it took."""
    straight = angle + length * rule.matrix.sum(axis=1)[:, None] * rate
    found, before = guess, math.inf
    for repetition in range(1, MOST_REPETITIONS + 1):
        gained = length * (rule.matrix @ found)
        try:
            new = accelerations(straight + length * (rule.matrix @ gained), rate + gained)
        except (ArithmeticError, ValueError):  # a first guess may lead to where no number is finite
            return None, repetition
        largest = unit + float(np.abs(rate + gained).max())
        change = float(length * np.abs(new - found).max()) / largest
        found = new
        if change <= tolerance:
            last = float(length * np.abs(rule.coefficients[-1] @ found).max()) / largest
            return (found if last <= tolerance else None), repetition
        if not change < 2 * before:
            return None, repetition
        before = min(before, change)
    return None, MOST_REPETITIONS


def _integrals(stages: int, part: Extended) -> tuple[Extended, Extended]:
    """The Legendre polynomials of a step, integrated once and twice from 0 to `part` (times,): (times, n)."""
    values = legendre(stages + 1, 2 * part - 1)
    once = _integrated(values)
    return once[:stages].T, _integrated(once)[:stages].T


def _integrated(values: Extended) -> Extended:
    """From polynomials (n + 1, times) of degrees 0 to n, or integrals of them, to those of all but the last.

    On a step of length 1 the integral of P_n is (P_(n+1) - P_(n-1)) / (4 n + 2), and that of P_0 is (P_1 + P_0) / 2.
    """
    degrees = np.arange(1, len(values) - 1, dtype=np.longdouble)[:, None]
    return np.concatenate([(values[:1] + values[1:2]) / 2, (values[2:] - values[:-2]) / (4 * degrees + 2)])
