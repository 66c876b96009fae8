"""The slip of sample 18.15: positions are called impossible to write, and two circles intersect nevertheless."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import bisect

from reference.chapter.errata.erratum import Array, Erratum, Values
from reference.checks import Positive, validated

# l1, l2, l3, l4 [m], at a crank angle [rad] more than a turn after the start.
BARS, CRANK_ANGLE = (0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), 1.2), 2.0 + 2 * math.pi
START = (math.pi / 2, math.pi / 4, 3 * math.pi / 4)  # theta, beta, phi [rad]


@validated
def rates(theta: float, beta: float, phi: float) -> tuple[float, float]:
    """beta' and phi' (18.71), (18.70) for a unit rate of the crank, literally as printed; they are right."""
    l1, l2, l3, _ = BARS
    common = math.sin(beta - phi)
    return l1 * math.sin(phi - theta) / (l2 * common), l1 * math.sin(beta - theta) / (l3 * common)


@validated
def closed_form(theta: float) -> tuple[float, float]:
    """beta and phi [rad]: C is the intersection of the circle about B with the circle about D that lies left."""
    l1, l2, l3, l4 = BARS
    bx, by = l1 * math.cos(theta), l1 * math.sin(theta)
    dx, dy = l4 - bx, -by
    distance = math.hypot(dx, dy)
    beta = math.atan2(dy, dx) + math.acos((distance**2 + l2**2 - l3**2) / (2 * distance * l2))
    return beta, math.atan2(by + l2 * math.sin(beta), bx + l2 * math.cos(beta) - l4)


@validated
def integrated(theta: float, tolerance: Positive = 1e-3) -> Array:
    """beta and phi (2,) [rad] as printed, by integration; the tolerance is that of the usual packages."""
    span = (START[0], theta)
    return solve_ivp(lambda at, state: rates(at, *state), span, START[1:], rtol=tolerance, atol=1e-3 * tolerance).y[
        :, -1
    ]


def _closed_form() -> Values:
    """beta and phi [rad]: as printed, integrated; by formula; deciding, a bisection on the loop's closure."""
    l1, l2, l3, l4 = BARS
    bx, by = l1 * math.cos(CRANK_ANGLE), l1 * math.sin(CRANK_ANGLE)

    def miss(angle: float) -> float:
        return math.hypot(bx + l2 * math.cos(angle) - l4, by + l2 * math.sin(angle)) - l3

    low = math.atan2(-by, l4 - bx)
    found: Any = bisect(miss, low, low + math.pi, xtol=1e-15)
    other = math.atan2(by + l2 * math.sin(found), bx + l2 * math.cos(found) - l4)
    return Values(integrated(CRANK_ANGLE), np.array(closed_form(CRANK_ANGLE)), np.array([found, other]))


FOUR_BAR_ERRATA = (
    Erratum(
        19,
        "example, four bar linkage: configuration variables",
        "impractically difficult to write in terms of theta; integrate the rates",
        "beta and phi are the intersection of two circles",
        "the closed form closes the loop to rounding, the integration to its tolerance",
        "rad",
        r"\text{It is impractically difficult to write the positions ... in terms of } \theta",
        r"\beta = \arg(D - B) + \arccos\frac{|D - B|^2 + \ell_2^2 - \ell_3^2}{2\, \ell_2 |D - B|}",
        "the loop itself: the angle at which the bars BC and CD meet, by bisection",
        False,
        _closed_form,
    ),
)
