"""Slips of sample 18.15 and of the solution to problem 18.5.2, and the two problems' right answers.

Positions are called impossible to write, and two circles intersect nevertheless; in the solution five dots are missing,
and a sine stands in the place of a cosine.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import bisect

from reference.chapter.errata.erratum import Array, Erratum, Values
from reference.checks import Positive, validated
from reference.numerics.calculus import derivative
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scenes.pendulum.link import direction_of

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
    """beta and phi (2,) [rad] by integration of the printed rates; the chapter states no tolerance, and 1e-3 is that of
    the usual packages.
    """
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


TOLERANCES = (1e-3, 1e-12)


def _by_tolerance() -> dict[float, float]:
    """The integration's largest miss [rad] at each of TOLERANCES."""
    decides = _closed_form().decides
    return {each: float(np.abs(integrated(CRANK_ANGLE, each) - decides).max()) for each in TOLERANCES}


FOUR_BAR_ERRATA = (
    Erratum(
        19,
        "example, four bar linkage: configuration variables",
        "impractically difficult to write in terms of theta; integrate the rates",
        "beta and phi are the intersection of two circles",
        "the claim is wrong, not a formula: a closed form exists, and the printed rates are right",
        "rad",
        r"\text{It is impractically difficult to write the positions ... in terms of } \theta",
        r"\beta = \arg(D - B) + \arccos\frac{|D - B|^2 + \ell_2^2 - \ell_3^2}{2\, \ell_2 |D - B|}",
        "the loop itself: the angle at which the bars BC and CD meet, by bisection",
        False,
        _closed_form,
        _by_tolerance,
    ),
)


# Length of a bar [m]; angles, rates and accelerations [rad, rad/s, rad/s^2] of the two.
BAR, PHI, PHI_RATE, PHI_ACCELERATION = 0.7, (0.4, -1.1), (2.0, 3.0), (-5.0, 0.6)


@dataclass(frozen=True)
class BarState:
    """One bar of `length` [m]: its angle [rad] from the downward vertical, rate [rad/s], acceleration [rad/s^2]."""

    length: float
    angle: float
    rate: float
    angular_acceleration: float


Formula = Callable[[BarState], Array]


def right(bar: BarState) -> Array:
    """l (phi'' cos phi - phi'^2 sin phi, phi'' sin phi + phi'^2 cos phi) (2,) [m/s^2]."""
    return accelerations(bar.length, (bar.angle, 0.0), (bar.rate, 0.0), (bar.angular_acceleration, 0.0)).a


def omega_in_the_first_term(bar: BarState) -> Array:
    """omega x r + omega x (omega x r), as printed: a velocity added to an acceleration."""
    return right(BarState(bar.length, bar.angle, bar.rate, bar.rate))


def dot_missing_in_i(bar: BarState) -> Array:
    """Only the i component is wrong: phi2dot for phi2ddot."""
    return np.array([omega_in_the_first_term(bar)[0], right(bar)[1]])


def exchanged_in_j(bar: BarState) -> Array:
    """Only the j component is wrong: sine and cosine exchanged."""
    second = bar.rate**2 * math.sin(bar.angle) + bar.angular_acceleration * math.cos(bar.angle)
    return np.array([right(bar)[0], bar.length * second])


# Which bar (0: OA, 1: AB) each slip is about, and what it makes of that bar's acceleration.
PENDULUM_SLIPS: dict[int, tuple[int, Formula]] = {
    23: (0, omega_in_the_first_term),
    25: (1, omega_in_the_first_term),
    26: (1, omega_in_the_first_term),
    27: (1, dot_missing_in_i),
    28: (1, exchanged_in_j),
}


def bar_end(t: Any, bar: int) -> Any:
    """The end of a bar from its beginning (2, ...) [m] at times t (...) [s] about 0; analytic."""
    angle = PHI[bar] + PHI_RATE[bar] * t + PHI_ACCELERATION[bar] * t * t / 2
    return BAR * np.stack([np.sin(angle), -np.cos(angle)])


def _pendulum(number: int) -> Values:
    bar, printed = PENDULUM_SLIPS[number]
    state = BarState(BAR, PHI[bar], PHI_RATE[bar], PHI_ACCELERATION[bar])
    return Values(printed(state), right(state), derivative(lambda t: bar_end(t, bar), 0.0, order=2))


def _second_note() -> Values:
    """What equals phi1ddot k: omega as printed, or its derivative."""
    angle = lambda t: PHI[0] + PHI_RATE[0] * t + PHI_ACCELERATION[0] * t * t / 2  # noqa: E731
    omega, alpha = (derivative(lambda t: np.stack([angle(t)]), 0.0, order=order) for order in (1, 2))
    return Values(omega, np.array([PHI_ACCELERATION[0]]), alpha)


SOLUTION = "problem 18.5.2, solution"
BAR_END = "the position of the bar's end, differentiated twice"


def _of_r(bar: str, omega: str) -> str:
    """The first line of parts a and b with `omega` in its first term."""
    point, which = {"A": ("A/O", "O1"), "B": ("B/A", "AB")}[bar]
    left = "A" if bar == "A" else "B/A"
    turning, arm = rf"\underline{{\omega}}_{{{which}}}", rf"\underline{{r}}_{{{point}}}"
    return rf"\underline{{a}}_{{{left}}} = {omega}_{{{which}}} \times {arm} + {turning} \times ({turning} \times {arm})"


OMEGA, OMEGA_DOT = r"\underline{\omega}", r"\dot{\underline{\omega}}"

PENDULUM_ERRATA = (
    Erratum(
        23,
        SOLUTION,
        "a_A = omega_O1 x r + omega_O1 x (omega_O1 x r)",
        "a_A = omegadot_O1 x r + omega_O1 x (omega_O1 x r)",
        "the first term is printed as a velocity",
        "m/s^2",
        _of_r("A", OMEGA),
        _of_r("A", OMEGA_DOT),
        BAR_END,
        True,
        lambda: _pendulum(23),
    ),
    Erratum(
        24,
        SOLUTION,
        "omega_O1 = phi1ddot k",
        "omegadot_O1 = phi1ddot k",
        "the note before it says omega_O1 = phi1dot k; the angle, differentiated twice, decides",
        "rad/s^2",
        r"\underline{\omega}_{O1} = \ddot{\phi}_1 \hat{k}",
        r"\dot{\underline{\omega}}_{O1} = \ddot{\phi}_1 \hat{k}",
        "the angle of the bar, differentiated twice",
        True,
        _second_note,
    ),
    Erratum(
        25,
        SOLUTION,
        "a_B/A = omega_AB x r + omega_AB x (omega_AB x r)",
        "a_B/A = omegadot_AB x r + omega_AB x (omega_AB x r)",
        "the first term is printed as a velocity",
        "m/s^2",
        _of_r("B", OMEGA),
        _of_r("B", OMEGA_DOT),
        BAR_END,
        True,
        lambda: _pendulum(25),
    ),
    Erratum(
        26,
        SOLUTION,
        "phi2dot k x (l sin phi2 i - l cos phi2 j) - ...",
        "phi2ddot k x (l sin phi2 i - l cos phi2 j) - ...",
        "a dot is missing in the middle line",
        "m/s^2",
        r"\dot{\phi}_2 \hat{k} \times (\ell \sin \phi_2 \hat{i} - \ell \cos \phi_2 \hat{j}) - \ldots",
        r"\ddot{\phi}_2 \hat{k} \times (\ell \sin \phi_2 \hat{i} - \ell \cos \phi_2 \hat{j}) - \ldots",
        BAR_END,
        True,
        lambda: _pendulum(26),
    ),
    Erratum(
        27,
        SOLUTION,
        "a_B/A . i = l (phi2dot cos phi2 - phi2dot^2 sin phi2)",
        "a_B/A . i = l (phi2ddot cos phi2 - phi2dot^2 sin phi2)",
        "a dot is missing in the i component",
        "m/s^2",
        r"\ell (\dot{\phi}_2 \cos \phi_2 - \dot{\phi}_2^2 \sin \phi_2) \hat{i}",
        r"\ell (\ddot{\phi}_2 \cos \phi_2 - \dot{\phi}_2^2 \sin \phi_2) \hat{i}",
        BAR_END,
        True,
        lambda: _pendulum(27),
    ),
    Erratum(
        28,
        SOLUTION,
        "a_B/A . j = l (phi2dot^2 sin phi2 + phi2ddot cos phi2)",
        "a_B/A . j = l (phi2dot^2 cos phi2 + phi2ddot sin phi2)",
        "sine and cosine are exchanged; the dimensions are right: only numbers tell",
        "m/s^2",
        r"\ell (\dot{\phi}_2^2 \sin \phi_2 + \ddot{\phi}_2 \cos \phi_2) \hat{j}",
        r"\ell (\dot{\phi}_2^2 \cos \phi_2 + \ddot{\phi}_2 \sin \phi_2) \hat{j}",
        BAR_END,
        False,
        lambda: _pendulum(28),
    ),
)


@dataclass(frozen=True)
class TwoPoints:
    """What problems 18.5.1 and 18.5.2 ask for, each (2,) in m/s or m/s^2: of A, of B relative to A, and of B."""

    a: Array
    b_relative_to_a: Array
    b: Array


@validated
def velocities(length: Positive, angles: tuple[float, float], rates: tuple[float, float]) -> TwoPoints:
    """Problem 18.5.1: A and B are the lower ends of the two bars of a double pendulum, each of `length` [m].

    The angles phi are from the downward vertical, counter-clockwise: r_A = l (sin phi1, -cos phi1).
    """
    first, second = (
        rotation_velocity(length * rate, direction_of(np.asarray(phi))) for phi, rate in zip(angles, rates, strict=True)
    )
    return TwoPoints(first, second, first + second)


@validated
def accelerations(
    length: Positive,
    angles: tuple[float, float],
    rates: tuple[float, float],
    angular_accelerations: tuple[float, float],
) -> TwoPoints:
    """Problem 18.5.2: a_A = l (phi1'' cos phi1 - phi1'^2 sin phi1, phi1'' sin phi1 + phi1'^2 cos phi1), B/A
    likewise.
    """
    first, second = (
        length * rotation_acceleration(rate, alpha, direction_of(np.asarray(phi)))
        for phi, rate, alpha in zip(angles, rates, angular_accelerations, strict=True)
    )
    return TwoPoints(first, second, first + second)
