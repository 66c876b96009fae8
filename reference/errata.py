"""The chapter's printed slips as computations: the printed formula taken literally, the right one, and what decides.

Nothing is left to opinion: what decides is the derivative of a position (for a skate, of a velocity), taken
numerically without any of the formulas in question. `derivative` is Cauchy's integral over a circle in complex time,
exact to rounding for analytic positions.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import solve_ivp
from scipy.optimize import bisect

from reference.link_chain import accelerations

Array = NDArray[np.float64]

CIRCLE_POINTS = 64  # errors fall like (radius / distance to the next singularity)^points


def derivative(position: Callable[[Any], Any], t: float, order: int = 1, radius: float = 0.25) -> Array:
    """The derivative (...) of an analytic position at time t [s], from its values on a circle of `radius` [s]."""
    circle = radius * np.exp(2j * math.pi * np.arange(CIRCLE_POINTS) / CIRCLE_POINTS)
    terms = [np.asarray(position(t + z)) / z**order for z in circle]
    return math.factorial(order) * np.mean(terms, axis=0).real


@dataclass(frozen=True)
class Values:
    """Three answers to one question, each (n,): as printed, as it must be, and by the derivative of a position."""

    printed: Array
    right: Array
    decides: Array


@dataclass(frozen=True)
class Erratum:
    """One slip: its number in the list of errata, where it is, what is printed, what is right, and why; `values()`."""

    number: int
    where: str
    printed: str
    right: str
    reason: str
    unit: str
    values: Callable[[], Values]


# A circle rolling on the outside of a fixed circle: radii [m], angle theta(t) = THETA + OMEGA t + ALPHA t^2 / 2
# of the rolling body. The contact stands at the fixed circle's angle psi = theta b / (a + b), having gone s = a psi.
FIXED, ROLLING = 0.8, 0.5
THETA, OMEGA, ALPHA = 0.7, 1.7, -0.6


def _theta(t: Any) -> Any:
    return THETA + OMEGA * t + ALPHA * t * t / 2


def _contact(t: Any) -> Any:
    psi = _theta(t) * ROLLING / (FIXED + ROLLING)
    return FIXED * np.stack([np.cos(psi), np.sin(psi)])


def _velocity_of_contact() -> Values:
    psi = THETA * ROLLING / (FIXED + ROLLING)
    tangent = np.array([-math.sin(psi), math.cos(psi)])
    rate = OMEGA / (1 / FIXED + 1 / ROLLING)
    return Values(FIXED * psi * tangent, rate * tangent, derivative(_contact, 0.0))


def _body_point(t: Any, point: Any) -> Any:
    """A point of the rolling circle, given in its own frame from its centre."""
    psi, theta = _theta(t) * ROLLING / (FIXED + ROLLING), _theta(t)
    centre = (FIXED + ROLLING) * np.stack([np.cos(psi), np.sin(psi)])
    cosine, sine = np.cos(theta), np.sin(theta)
    return centre + np.stack([cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]])


def _pole() -> Values:
    """The velocity of the body's point that each condition finds: a pole is a point without one."""
    zero = np.zeros(2)
    centre = np.asarray(_body_point(0.0, zero))
    velocity = derivative(lambda t: _body_point(t, zero), 0.0)
    turn = np.array([[math.cos(THETA), math.sin(THETA)], [-math.sin(THETA), math.cos(THETA)]])  # world to body

    def speed(relative: Array) -> Array:
        point = turn @ relative
        return derivative(lambda t: _body_point(t, point), 0.0)

    pole = np.array([-velocity[1], velocity[0]]) / OMEGA  # k x v / omega
    return Values(speed(-centre), speed(pole), zero)


# A skate: heading theta(t), speed v(t) along it, and a point G at (p, q) in the body's frame from the skate's point C.
SPEED, PUSH, ARM = 1.3, 0.4, (0.35, -0.2)


def _velocity_of_g(t: Any) -> Any:
    """v_G from the rule of the page before, which is right: v_C i' + thetadot k x r."""
    theta, rate, speed = _theta(t), OMEGA + ALPHA * t, SPEED + PUSH * t
    cosine, sine = np.cos(theta), np.sin(theta)
    arm_x, arm_y = cosine * ARM[0] - sine * ARM[1], sine * ARM[0] + cosine * ARM[1]
    return np.stack([speed * cosine - rate * arm_y, speed * sine + rate * arm_x])


def _acceleration_of_g() -> Values:
    along = np.array([math.cos(THETA), math.sin(THETA)])
    left = np.array([-along[1], along[0]])
    arm = ARM[0] * along + ARM[1] * left
    rest = PUSH * along + ALPHA * np.array([-arm[1], arm[0]]) - OMEGA**2 * arm
    # d(j')/dt = -thetadot i', so the printed term points along the skate; d(i')/dt = thetadot j' across it.
    return Values(rest - SPEED * OMEGA * along, rest + SPEED * OMEGA * left, derivative(_velocity_of_g, 0.0))


# Sample 18.15: l1, l2, l3, l4 [m], at a crank angle more than a turn after the start.
BARS, CRANK_ANGLE = (0.4, 0.4 * math.sqrt(2), 0.8 * math.sqrt(2), 1.2), 2.0 + 2 * math.pi


def _closed_form() -> Values:
    """beta and phi [rad]: as printed, integrated; by formula, the intersection of two circles; deciding, a
    bisection.
    """
    l1, l2, l3, l4 = BARS

    def rates(theta: float, state: Array) -> list[float]:
        beta, phi = state
        common = math.sin(beta - phi)
        return [l1 * math.sin(phi - theta) / (l2 * common), l1 * math.sin(beta - theta) / (l3 * common)]

    start = [math.pi / 4, 3 * math.pi / 4]
    # The tolerance of the usual packages unless told otherwise.
    solution = solve_ivp(rates, (math.pi / 2, CRANK_ANGLE), start, rtol=1e-3, atol=1e-6).y[:, -1]
    bx, by = l1 * math.cos(CRANK_ANGLE), l1 * math.sin(CRANK_ANGLE)
    dx, dy = l4 - bx, -by
    distance = math.hypot(dx, dy)
    beta = math.atan2(dy, dx) + math.acos((distance**2 + l2**2 - l3**2) / (2 * distance * l2))
    phi = math.atan2(by + l2 * math.sin(beta), bx + l2 * math.cos(beta) - l4)

    def miss(angle: float) -> float:
        return math.hypot(bx + l2 * math.cos(angle) - l4, by + l2 * math.sin(angle)) - l3

    low = math.atan2(dy, dx)
    found: Any = bisect(miss, low, low + math.pi, xtol=1e-15)
    other = math.atan2(by + l2 * math.sin(found), bx + l2 * math.cos(found) - l4)
    return Values(solution, np.array([beta, phi]), np.array([found, other]))


# Problem 18.5.2: length [m], angles [rad], rates and second rates of the double pendulum's two bars.
BAR, PHI, PHI_RATE, PHI_TURN = 0.7, (0.4, -1.1), (2.0, 3.0), (-5.0, 0.6)


def _bar_end(t: Any, bar: int) -> Any:
    angle = PHI[bar] + PHI_RATE[bar] * t + PHI_TURN[bar] * t * t / 2
    return BAR * np.stack([np.sin(angle), -np.cos(angle)])


def _turned(factor: float, bar: int) -> Array:
    """factor k x r for one bar."""
    return factor * BAR * np.array([math.cos(PHI[bar]), math.sin(PHI[bar])])


def _pendulum(bar: int, printed: Array) -> Values:
    exact = accelerations(BAR, PHI, PHI_RATE, PHI_TURN)
    right = exact.b_relative_to_a if bar else exact.a
    return Values(printed, right, derivative(lambda t: _bar_end(t, bar), 0.0, order=2))


def _centripetal(bar: int) -> Array:
    return -(PHI_RATE[bar] ** 2) * _bar_end(0.0, bar)


def _first_term(bar: int) -> Values:
    """The angular velocity instead of its derivative in the first term."""
    return _pendulum(bar, _turned(PHI_RATE[bar], bar) + _centripetal(bar))


def _second_note() -> Values:
    """What equals phi1ddot k: omega as printed, or its derivative."""
    turned = lambda t: PHI[0] + PHI_RATE[0] * t + PHI_TURN[0] * t * t / 2  # noqa: E731
    omega, change = (derivative(lambda t: np.stack([turned(t)]), 0.0, order=order) for order in (1, 2))
    return Values(omega, np.array([PHI_TURN[0]]), change)


def _component_i() -> Values:
    """Only the i component is wrong: phi2dot for phi2ddot."""
    right = accelerations(BAR, PHI, PHI_RATE, PHI_TURN).b_relative_to_a
    printed = BAR * (PHI_RATE[1] * math.cos(PHI[1]) - PHI_RATE[1] ** 2 * math.sin(PHI[1]))
    return _pendulum(1, np.array([printed, right[1]]))


def _component_j() -> Values:
    """Only the j component is wrong: sine and cosine exchanged."""
    right = accelerations(BAR, PHI, PHI_RATE, PHI_TURN).b_relative_to_a
    printed = BAR * (PHI_RATE[1] ** 2 * math.sin(PHI[1]) + PHI_TURN[1] * math.cos(PHI[1]))
    return _pendulum(1, np.array([right[0], printed]))


SOLUTION = "problem 18.5.2, solution"

ERRATA: tuple[Erratum, ...] = (
    Erratum(
        1,
        "rolling, velocity of the contact",
        "v_C = s e_t",
        "v_C = sdot e_t",
        "a length is not a velocity; the contact's position, differentiated, decides",
        "m/s",
        _velocity_of_contact,
    ),
    Erratum(
        2,
        "body curve and space curve",
        "a point r_C/O' where r_C = 0",
        "a point r_C/O' where v_C = 0",
        "r_C = 0 finds the origin of the ground, and the body's point there moves",
        "m/s",
        _pole,
    ),
    Erratum(
        11,
        "skates, acceleration of G",
        "vdot_C i' + v_C d(j')/dt + ...",
        "vdot_C i' + v_C d(i')/dt + ... = vdot_C i' + v_C thetadot j' + ...",
        "the dimensions are right and the direction is wrong by a quarter turn: only numbers tell",
        "m/s^2",
        _acceleration_of_g,
    ),
    Erratum(
        19,
        "example, four bar linkage: configuration variables",
        "impractically difficult to write in terms of theta; integrate the rates",
        "beta and phi are the intersection of two circles",
        "the closed form closes the loop to rounding, the integration to its tolerance",
        "rad",
        _closed_form,
    ),
    Erratum(
        23,
        SOLUTION,
        "a_A = omega_O1 x r + omega_O1 x (omega_O1 x r)",
        "a_A = omegadot_O1 x r + omega_O1 x (omega_O1 x r)",
        "the first term is printed as a velocity",
        "m/s^2",
        lambda: _first_term(0),
    ),
    Erratum(
        24,
        SOLUTION,
        "omega_O1 = phi1ddot k",
        "omegadot_O1 = phi1ddot k",
        "the note before it says omega_O1 = phi1dot k; the angle, differentiated twice, decides",
        "rad/s^2",
        _second_note,
    ),
    Erratum(
        25,
        SOLUTION,
        "a_B/A = omega_AB x r + omega_AB x (omega_AB x r)",
        "a_B/A = omegadot_AB x r + omega_AB x (omega_AB x r)",
        "the first term is printed as a velocity",
        "m/s^2",
        lambda: _first_term(1),
    ),
    Erratum(
        26,
        SOLUTION,
        "phi2dot k x (l sin phi2 i - l cos phi2 j) - ...",
        "phi2ddot k x (l sin phi2 i - l cos phi2 j) - ...",
        "a dot is missing in the middle line",
        "m/s^2",
        lambda: _first_term(1),
    ),
    Erratum(
        27,
        SOLUTION,
        "a_B/A . i = l (phi2dot cos phi2 - phi2dot^2 sin phi2)",
        "a_B/A . i = l (phi2ddot cos phi2 - phi2dot^2 sin phi2)",
        "a dot is missing in the i component",
        "m/s^2",
        _component_i,
    ),
    Erratum(
        28,
        SOLUTION,
        "a_B/A . j = l (phi2dot^2 sin phi2 + phi2ddot cos phi2)",
        "a_B/A . j = l (phi2dot^2 cos phi2 + phi2ddot sin phi2)",
        "sine and cosine are exchanged; the dimensions are right: only numbers tell",
        "m/s^2",
        _component_j,
    ),
)
