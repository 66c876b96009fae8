"""Motions q'' = f(q, q') of a few angles by Gauss-Legendre collocation.

A step, here called a window, has 24 stages; the polynomial through them represents the acceleration to rounding. This
polynomial gives the motion at every time within the window without a discretisation error. The collocation equations
are solved by fixed-point (Picard) iteration. An iteration calls f once with all nodes, at little more cost than a call
with one state. For a fast and a slow oscillation, the method is seven times as fast as an explicit method of order 8 at
the same tolerance.

States are in extended precision if numpy.longdouble has more digits than a double. In a fast oscillation the
acceleration has an error of the angle's rounding times the square of the frequency. In double precision this would
limit the windows to the length of an explicit method's steps.
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
from reference.validators import Array

Extended = NDArray[np.longdouble]
Accelerations = Callable[[Extended, Extended], Extended]  # from angles and rates (..., n) to accelerations (..., n)

# Number of stages of a window.
STAGES = 24
# Number of stages of the coarser rule for the error estimate.
COARSE_STAGES = 16
# Allowed error of the polynomial within a window, ten times the rounding of a double. At the window's end the order is
# twice as high and the error far below rounding.
WINDOW_TOLERANCE = 3e-15
# Length of the first window times the rate at the start [rad]. This window is short for any motion.
FIRST_WINDOW = 0.3
# The next window is longer after at most FEW_ITERATIONS and shorter after more than MANY_ITERATIONS. After
# MOST_ITERATIONS the window is repeated with half its length.
FEW_ITERATIONS, MANY_ITERATIONS, MOST_ITERATIONS = 9, 12, 30
# Factors on the length of a window: longer, shorter, and repeated.
LONGER, SHORTER, HALVED = 1.2, 1 / 1.15, 0.5
# Number of Legendre coefficients that are extrapolated to the next window as its first guess.
GUESS_COEFFICIENTS = 8
# Maximum number of windows; a motion that needs more approaches a singularity.
MOST_WINDOWS = 20_000
# Number of windows after which `motion` changes to the explicit method. Accelerations in double precision allow only
# short windows for a fast oscillation.
FEW_WINDOWS = 200


class CollocationRule(NamedTuple):
    """Gauss's rule on a step of length 1.

    weights (stages,); matrix (stages, stages) converts slopes to increments at the stages; coefficients (stages,
    stages) converts slopes to Legendre coefficients.
    """

    weights: Extended
    matrix: Extended
    coefficients: Extended


def legendre(degree: int, x: Extended) -> Extended:
    """Legendre polynomials of degrees 0 to `degree` at x, (degree + 1, points)."""
    values: list[Any] = [np.ones_like(x), x]
    for n in range(1, degree):
        values.append(((2 * n + 1) * x * values[n] - n * values[n - 1]) / (n + 1))
    return np.array(values)


@lru_cache
def rule_of(stages: int) -> CollocationRule:
    """Gauss's rule with this number of stages, accurate to the rounding of numpy.longdouble."""
    nodes = np.polynomial.legendre.leggauss(stages)[0].astype(np.longdouble)
    for _ in range(3):  # Newton iterations improve numpy's nodes, which are doubles
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
class CollocationMotion:
    """A function from times (times,) [s] to angles and rates (times, 2 n), rounded to double.

    times (windows + 1,); states (windows + 1, 2 n); slopes: the Legendre coefficients of the accelerations (stages, n)
    of each window.
    """

    stages: int
    times: Array
    states: Extended
    slopes: list[Extended]

    def __call__(self, t: ArrayLike) -> Array:
        return self.extended(t).astype(float)

    def extended(self, t: ArrayLike) -> Extended:
        """Angles and rates (times, 2 n) in extended precision."""
        t = np.atleast_1d(np.asarray(t, dtype=float))
        if t.size and not (t.min() >= 0 and t.max() <= self.times[-1]):
            raise ValueError(f"times must lie in [0, {self.times[-1]}] s: the motion integrated")
        out = np.empty((len(t), self.states.shape[1]), dtype=np.longdouble)
        window = np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.slopes) - 1)
        for index in np.unique(window):
            inside = window == index
            begin, end = self.times[index], self.times[index + 1]
            angle, rate = np.split(self.states[index], 2)
            since: Extended = (t[inside].astype(np.longdouble) - begin)[:, None]
            length = np.longdouble(end) - begin
            part: Extended = since[:, 0] / length
            once, twice = _integrals(self.stages, part)
            rates = rate + length * (once @ self.slopes[index])
            angles = angle + since * rate + length**2 * (twice @ self.slopes[index])
            out[inside] = np.concatenate([angles, rates], axis=1)
        return out


def integrate(
    accelerations: Accelerations,
    angle: ArrayLike,
    rate: ArrayLike,
    until: float,
    rate_unit: float,
    stages: int = STAGES,
    tolerance: float = WINDOW_TOLERANCE,
    most: int = MOST_WINDOWS,
) -> CollocationMotion:
    """Integrate from angles and rates (n,) at t = 0 to `until` [s]; `rate_unit` [rad/s] is the unit of rates.

    A window is accepted if its last Legendre coefficient and its last iteration change the rates by at most `tolerance`
    times the sum of `rate_unit` and the largest rate. Raises IntegrationFailed if windows vanish or exceed `most`.
    """
    rule = rule_of(stages)
    position, speed = (np.asarray(state, dtype=np.longdouble) for state in (angle, rate))
    compensation = np.zeros((2, len(position)), dtype=np.longdouble)  # Kahan's summation
    start = accelerations(position[None], speed[None])
    pace = max(float(np.abs(speed).max()), math.sqrt(float(np.abs(start).max())))  # rad/s
    now, length = 0.0, min(until, FIRST_WINDOW / pace) if pace > 0 else until
    times, states, slopes = [now], [np.concatenate([position, speed])], []
    guess, tries, longest = np.broadcast_to(start, (stages, len(position))), 0, 0.0
    while now < until:
        tries += 1
        if tries > most or not now + length > now or hopeless(now, until, longest, tries, most):
            raise IntegrationFailed(f"the motion stops at t = {now:.6g} s: its steps become too small or too many")
        length = min(length, until - now)
        then = until if length == until - now else now + length
        exact = np.longdouble(then) - now
        nodal, iterations = _solve_window(accelerations, rule, position, speed, exact, guess, rate_unit, tolerance)
        if nodal is None:
            length *= HALVED
            guess = np.broadcast_to(accelerations(position[None], speed[None]), guess.shape)
            continue
        steps = [exact * speed + exact**2 * (rule.weights @ rule.matrix @ nodal), exact * (rule.weights @ nodal)]
        moved = []
        for part, (old, step) in enumerate(zip((position, speed), steps, strict=True)):
            new = old + (step + compensation[part])
            compensation[part] = step + compensation[part] - (new - old)
            moved.append(new)
        position, speed = moved
        longest = max(longest, then - now)
        now = then
        times.append(now)
        states.append(np.concatenate(moved))
        slopes.append(rule.coefficients @ nodal)
        factor = LONGER if iterations <= FEW_ITERATIONS else SHORTER if iterations > MANY_ITERATIONS else 1.0
        length *= factor
        ahead = legendre(GUESS_COEFFICIENTS - 1, 1 + 2 * (length / float(exact)) * rule.matrix.sum(axis=1))
        guess = ahead.T @ slopes[-1][:GUESS_COEFFICIENTS]
    return CollocationMotion(stages, np.array(times), np.array(states), slopes)


Motion = CollocationMotion | integration.Integrated


def motion(rates: Rates, start: ArrayLike, until: float, unit: ArrayLike, coarser: float = 1.0) -> Motion:
    """The motion up to `until` [s] from a start of n angles and n rates, with `rates` in double precision.

    Returns a function from times (times,) to states (times, 2 n). The method is collocation, or the explicit method of
    `integration` if collocation needs many windows. The argument `unit` (2 n,) is that of `integration.integrate`.
    `coarser` is a factor on the tolerance; a value other than 1 also selects the rule with COARSE_STAGES. Raises
    IntegrationFailed.
    """
    state = np.asarray(start, dtype=float)
    half = len(state) // 2

    def accelerations(angle: Extended, rate: Extended) -> Extended:
        return rates(np.concatenate([angle, rate], axis=-1).astype(float))[..., half:].astype(np.longdouble)

    stages, pace = STAGES if coarser == 1 else COARSE_STAGES, float(np.asarray(unit)[-1])
    try:
        with np.errstate(all="ignore"):  # numbers may be not finite for a first guess
            return integrate(
                accelerations, state[:half], state[half:], until, pace, stages, coarser * WINDOW_TOLERANCE, FEW_WINDOWS
            )
    except IntegrationFailed:
        return integration.integrate(rates, state, until, coarser * integration.STEP_TOLERANCE, unit)


def error_of(rates: Rates, start: ArrayLike, t: ArrayLike, unit: ArrayLike) -> Array:
    """A bound (times,) on the error of `motion`, from the difference to a coarser rule, plus rounding."""
    times = np.atleast_1d(np.asarray(t, dtype=float))
    until = max(float(times.max()), math.ulp(1.0))
    return bound(*(motion(rates, start, until, unit, factor)(times) for factor in (1.0, COARSER)))


def bound(fine: NDArray[Any], coarse: NDArray[Any]) -> Array:
    """A bound (times,) on the error of states (times, n) from the difference to a coarser rule, plus rounding."""
    return (COARSER * (np.abs(fine - coarse) + np.finfo(float).eps * np.abs(fine))).max(axis=-1).astype(float)


def _solve_window(
    accelerations: Accelerations,
    rule: CollocationRule,
    angle: Extended,
    rate: Extended,
    length: Any,
    guess: Extended,
    unit: float,
    tolerance: float,
) -> tuple[Extended | None, int]:
    """The accelerations at the nodes (stages, n), or None if the window is too long, and the number of iterations."""
    straight = angle + length * rule.matrix.sum(axis=1)[:, None] * rate
    nodal, smallest = guess, math.inf
    for iteration in range(1, MOST_ITERATIONS + 1):
        gained = length * (rule.matrix @ nodal)
        try:
            new = accelerations(straight + length * (rule.matrix @ gained), rate + gained)
        except (ArithmeticError, ValueError):  # numbers may be not finite for a first guess
            return None, iteration
        largest = unit + float(np.abs(rate + gained).max())
        change = float(length * np.abs(new - nodal).max()) / largest
        nodal = new
        if change <= tolerance:
            last = float(length * np.abs(rule.coefficients[-1] @ nodal).max()) / largest
            return (nodal if last <= tolerance else None), iteration
        if not change < 2 * smallest:
            return None, iteration
        smallest = min(smallest, change)
    return None, MOST_ITERATIONS


def _integrals(stages: int, part: Extended) -> tuple[Extended, Extended]:
    """The Legendre polynomials of a step, integrated once and twice from 0 to `part` (times,), each (times, n)."""
    values = legendre(stages + 1, 2 * part - 1)
    once = _integrated(values)
    return once[:stages].T, _integrated(once)[:stages].T


def _integrated(values: Extended) -> Extended:
    """The integrals (n, times) of Legendre polynomials (n + 1, times) or of their integrals, without the last degree.

    On a step of length 1, P_n has the integral (P_(n+1) - P_(n-1)) / (4 n + 2), and P_0 the integral (P_1 + P_0) / 2.
    """
    degrees = np.arange(1, len(values) - 1, dtype=np.longdouble)[:, None]
    return np.concatenate([(values[:1] + values[1:2]) / 2, (values[2:] - values[:-2]) / (4 * degrees + 2)])
