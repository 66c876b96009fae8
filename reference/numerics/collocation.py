"""Gauss-Legendre collocation for small smooth autonomous systems, in extended precision where the machine has it.

A step of s stages is exact to order 2 s and its stages are solved to rounding, so that what is left of the error is the
rounding of numpy.longdouble: 1e-19 a step on x86, 1e-16 where longdouble is the ordinary double.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Extended = NDArray[np.longdouble]

STAGES = 12
EPSILON = float(np.finfo(np.longdouble).eps)
# The last Legendre coefficient of the slope falls like rho^-s with s stages while the step's error falls like rho^-2s:
# the square root of rounding is small enough; a hundredth of that is kept in hand.
LAST_COEFFICIENT = 1e-2 * EPSILON**0.5
MOST_STEPS = 1_000_000
MOST_ITERATIONS = 60


class Rule(NamedTuple):
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
def rule_of(stages: int) -> Rule:
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
    return Rule(weights / 2, integrals.T @ to_coefficients / 2, to_coefficients)


def integrate(
    slope: Callable[[Extended], Extended], start: Any, times: NDArray[np.float64], longest: float, stages: int = STAGES
) -> Extended:
    """States (times, n) at increasing times >= 0 [s] from `start` (n,) at t = 0; slope maps (stages, n) to (stages, n).

    Every sample is the end of a step: nothing is interpolated. Steps are at most `longest` [s], and are halved where
    the slope's polynomial shows that they are too long. Raises ArithmeticError where that does not end.
    """
    rule = rule_of(stages)
    state = np.asarray(start, dtype=np.longdouble)
    lost = np.zeros_like(state)  # what the additions to the state have rounded away
    now, length = np.longdouble(0), np.longdouble(longest)
    out = np.empty((len(times), state.size), dtype=np.longdouble)
    steps = 0
    for index, end in enumerate(np.asarray(times, dtype=np.longdouble)):
        while now < end:
            pieces = np.ceil((end - now) / length)
            step = (end - now) / pieces
            increment = _increment(slope, rule, state, step)
            steps += 1
            if steps > MOST_STEPS or step < 1e-12 * longest:
                raise ArithmeticError(
                    f"collocation: no convergence at t = {float(now):.9g} s with steps of {float(step):.3g} s"
                )
            if increment is None:
                length = step / 2
                continue
            increment = increment + lost
            total = state + increment
            lost = increment - (total - state)
            state = total
            now = end if pieces == 1 else now + step
            length = min(np.longdouble(longest), max(length, step) * np.longdouble(1.25))
        out[index] = state
    return out


def _increment(slope: Callable[[Extended], Extended], rule: Rule, state: Extended, step: Any) -> Extended | None:
    """The step's increment, or None if the stages don't converge or don't resolve the slope."""
    slopes = slope(np.broadcast_to(state, (rule.weights.size, state.size)))
    scale = 1 + np.abs(state)
    before = np.inf
    for _ in range(MOST_ITERATIONS):
        renewed = slope(state + step * (rule.matrix @ slopes))
        change = float(np.max(np.abs(step * (renewed - slopes)) / scale))
        slopes = renewed
        # Contraction ends in rounding: once there, the change no longer falls.
        if change <= 4 * EPSILON or (change >= before and change <= 64 * EPSILON):
            if float(np.max(np.abs(step * (rule.coefficients[-1] @ slopes)) / scale)) > LAST_COEFFICIENT:
                return None
            return step * (rule.weights @ slopes)
        if not change < 1e3:
            return None
        before = change
    return None
