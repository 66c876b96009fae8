"""Formulas with errors in the chapter, as printed and as corrected, and computations that decide between them.

The folder `reports/pages/errata/slips` has a document with a deciding script for each error. This module has the
formulas for which an engine's motion decides.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from reference.checks import Positive, validated
from reference.numerics.calculus import derivative
from reference.plane import rotation_acceleration, rotation_velocity
from reference.scenes.pendulum.link import direction_of
from reference.validators import Array


@dataclass(frozen=True)
class Values:
    """The results (n,) of the printed formula, of the corrected formula, and of the computation that decides."""

    printed: Array
    right: Array
    decides: Array

    @property
    def miss(self) -> float:
        return float(np.abs(self.printed - self.decides).max())

    @property
    def agreement(self) -> float:
        """The largest error of the corrected formula, which is rounding."""
        return float(np.abs(self.right - self.decides).max())


# Sample 18.15: l1, l2, l3, l4 [m], and theta, beta, phi [rad] at the start.
BAR_LENGTHS = (0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), 1.2)
START_ANGLES = (math.pi / 2, math.pi / 4, 3 * math.pi / 4)


@validated
def rates(theta: float, beta: float, phi: float) -> tuple[float, float]:
    """beta' and phi' (18.71), (18.70) for a unit rate of the crank, as printed; these formulas are correct."""
    l1, l2, l3, _ = BAR_LENGTHS
    common = math.sin(beta - phi)
    return l1 * math.sin(phi - theta) / (l2 * common), l1 * math.sin(beta - theta) / (l3 * common)


@validated
def closed_form(theta: float) -> tuple[float, float]:
    """beta and phi [rad], with C at the left intersection of the circles about B and D."""
    l1, l2, l3, l4 = BAR_LENGTHS
    bx, by = l1 * math.cos(theta), l1 * math.sin(theta)
    dx, dy = l4 - bx, -by
    distance = math.hypot(dx, dy)
    beta = math.atan2(dy, dx) + math.acos((distance**2 + l2**2 - l3**2) / (2 * distance * l2))
    return beta, math.atan2(by + l2 * math.sin(beta), bx + l2 * math.cos(beta) - l4)


@validated
def integrated(theta: float) -> Array:
    """beta and phi (2,) [rad] by integration of the printed rates, with the default tolerance of common packages."""
    from scipy.integrate import solve_ivp

    span = START_ANGLES[0], theta
    return solve_ivp(lambda at, state: rates(at, *state), span, START_ANGLES[1:], rtol=1e-3, atol=1e-6).y[:, -1]


def acceleration_of_g(
    heading: float, speed: float, push: float, rate: float, angular_acceleration: float, arm: tuple[float, float]
) -> tuple[Array, Array]:
    """a_G (2,) [m/s^2] of a body on a skate, as printed and corrected, for a heading [rad], v_C, vdot_C, thetadot,
    thetaddot and the arm C -> G [m] in the body's frame.

    The printed term has d(j')/dt = -thetadot i', which is along the skate. The correct term has d(i')/dt = thetadot j',
    which is across the skate.
    """
    along = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-along[1], along[0]])
    span = arm[0] * along + arm[1] * left
    rest = push * along + angular_acceleration * np.array([-span[1], span[0]]) - rate**2 * span
    return rest - speed * rate * along, rest + speed * rate * left


def rolling_acceleration() -> Values:
    """The acceleration of O' with the term in e_n subtracted, with the term added, and as the derivative of the path.

    A circle of radius b rolls on the outside of a fixed circle of radius a. After a rotation theta(t) the contact is at
    the angle psi = theta b / (a + b) of the fixed circle.
    """
    fixed, rolling, theta, omega, alpha = 0.8, 0.5, 0.7, 1.7, -0.6  # radii a, b [m]; rad, rad/s, rad/s^2

    def centre(t: Any) -> Any:
        psi = (theta + omega * t + alpha * t * t / 2) * rolling / (fixed + rolling)
        return (fixed + rolling) * np.stack([np.cos(psi), np.sin(psi)])

    psi = theta * rolling / (fixed + rolling)
    normal = np.array([math.cos(psi), math.sin(psi)])  # Into the circle.
    arm = rolling * normal
    pinned = alpha * np.array([-arm[1], arm[0]]) - omega**2 * arm
    term = omega**2 / (1 / fixed + 1 / rolling) * normal
    return Values(pinned - term, pinned + term, derivative(centre, 0.0, order=2))


# Problem 18.5.2: the length of a bar [m]; angles [rad], rates [rad/s] and accelerations [rad/s^2] of both bars.
BAR, PHI, PHI_RATE, PHI_ACCELERATION = 0.7, (0.4, -1.1), (2.0, 3.0), (-5.0, 0.6)


def bar_end(t: Any, bar: int) -> Any:
    """The vector (2, ...) [m] from the first to the second end of a bar at times t (...) [s] about 0; analytic."""
    angle = PHI[bar] + PHI_RATE[bar] * t + PHI_ACCELERATION[bar] * t * t / 2
    return BAR * np.stack([np.sin(angle), -np.cos(angle)])


class BarState(NamedTuple):
    """One bar with length [m], angle [rad] from the downward vertical, rate [rad/s] and acceleration [rad/s^2]."""

    length: float
    angle: float
    rate: float
    angular_acceleration: float


def right(bar: BarState) -> Array:
    """l (phi'' cos phi - phi'^2 sin phi, phi'' sin phi + phi'^2 cos phi) (2,) [m/s^2]."""
    direction = direction_of(np.asarray(bar.angle))
    return bar.length * rotation_acceleration(bar.rate, bar.angular_acceleration, direction)


def omega_in_the_first_term(bar: BarState) -> Array:
    """omega x r + omega x (omega x r), as printed; the first term is a velocity."""
    return right(bar._replace(angular_acceleration=bar.rate))


def dot_missing_in_i(bar: BarState) -> Array:
    """The i component has phi2dot in place of phi2ddot."""
    return np.array([omega_in_the_first_term(bar)[0], right(bar)[1]])


def exchanged_in_j(bar: BarState) -> Array:
    """In the j component sine and cosine are exchanged."""
    second = bar.rate**2 * math.sin(bar.angle) + bar.angular_acceleration * math.cos(bar.angle)
    return np.array([right(bar)[0], bar.length * second])


# A mapping from errata to the bar (0 is OA, 1 is AB) and the wrong formula of the bar's acceleration.
PENDULUM_SLIPS: dict[int, tuple[int, Callable[[BarState], Array]]] = {
    23: (0, omega_in_the_first_term),
    25: (1, omega_in_the_first_term),
    26: (1, omega_in_the_first_term),
    27: (1, dot_missing_in_i),
    28: (1, exchanged_in_j),
}


@dataclass(frozen=True)
class TwoPoints:
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
    """In problem 18.5.2, a_A = l (phi1'' cos phi1 - phi1'^2 sin phi1, phi1'' sin phi1 + phi1'^2 cos phi1), and a_B/A
    has the same form with phi2.
    """
    bars = zip(angles, rates, angular_accelerations, strict=True)
    first, second = (right(BarState(length, *bar)) for bar in bars)
    return TwoPoints(first, second, first + second)
