"""Slips of the pages on rolling and on skates.

A circle rolls on the outside of a fixed one, and its contact and pole are followed. The rolling body has turned by
theta(t) = THETA + OMEGA t + ALPHA t^2 / 2. The contact then stands at the fixed circle's angle psi = theta b / (a + b),
having gone s = a psi. For the skate the heading is the same theta(t), the speed along it SPEED + PUSH t; G is a point
at ARM in the body's frame from the skate's point C. Its acceleration has the right dimensions as printed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from reference.chapter.errata.erratum import Array, Erratum, Values
from reference.numerics.calculus import derivative

FIXED, ROLLING = 0.8, 0.5  # m, radii a and b
THETA, OMEGA, ALPHA = 0.7, 1.7, -0.6  # rad, rad/s, rad/s^2


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


def rolling_acceleration() -> Values:
    """Not a slip: the printed acceleration of O' under the convention of the list, beside the same with -e_n."""
    psi = THETA * ROLLING / (FIXED + ROLLING)
    normal = np.array([math.cos(psi), math.sin(psi)])  # into the rolling body
    arm = ROLLING * normal  # from the contact to the centre
    pinned = ALPHA * np.array([-arm[1], arm[0]]) - OMEGA**2 * arm
    rolling = OMEGA**2 / (1 / FIXED + 1 / ROLLING) * normal
    return Values(pinned - rolling, pinned + rolling, derivative(lambda t: _body_point(t, np.zeros(2)), 0.0, order=2))


ROLLING_ERRATA = (
    Erratum(
        1,
        "rolling, velocity of the contact",
        "v_C = s e_t",
        "v_C = sdot e_t",
        "a length is not a velocity; the contact's position, differentiated, decides",
        "m/s",
        r"\vec{v}_C = s \hat{e}_t",
        r"\vec{v}_C = \dot{s} \hat{e}_t",
        "the contact's position, differentiated",
        True,
        _velocity_of_contact,
    ),
    Erratum(
        2,
        "body curve and space curve",
        "a point r_C/O' where r_C = 0",
        "a point r_C/O' where v_C = 0",
        "r_C = 0 finds the origin of the ground, and the body's point there moves",
        "m/s",
        r"\vec{r}_{C/O'} \text{ where } \vec{r}_C = \vec{0}",
        r"\vec{r}_{C/O'} \text{ where } \vec{v}_C = \vec{0}",
        "what a pole is: a point without velocity",
        False,
        _pole,
    ),
)


SPEED, PUSH = 1.3, 0.4  # m/s, m/s^2
ARM = (0.35, -0.2)  # m


def _velocity_of_g(t: Any) -> Any:
    """v_G from the rule of the page before, which is right: v_C i' + thetadot k x r."""
    theta, rate, speed = THETA + OMEGA * t + ALPHA * t * t / 2, OMEGA + ALPHA * t, SPEED + PUSH * t
    cosine, sine = np.cos(theta), np.sin(theta)
    arm_x, arm_y = cosine * ARM[0] - sine * ARM[1], sine * ARM[0] + cosine * ARM[1]
    return np.stack([speed * cosine - rate * arm_y, speed * sine + rate * arm_x])


def acceleration_of_g(
    heading: float, speed: float, push: float, rate: float, angular_acceleration: float, arm: tuple[float, float]
) -> tuple[Array, Array]:
    """a_G (2,) [m/s^2] as printed and as it must be, for a heading [rad], v_C, vdot_C, thetadot, thetaddot and C -> G.

    The arm [m] is in the body's frame. d(j')/dt = -thetadot i', so the printed term points along the skate; the right
    one, d(i')/dt = thetadot j', across it.
    """
    along = np.array([math.cos(heading), math.sin(heading)])
    left = np.array([-along[1], along[0]])
    span = arm[0] * along + arm[1] * left
    rest = push * along + angular_acceleration * np.array([-span[1], span[0]]) - rate**2 * span
    return rest - speed * rate * along, rest + speed * rate * left


def _acceleration_of_g() -> Values:
    printed, right = acceleration_of_g(THETA, SPEED, PUSH, OMEGA, ALPHA, ARM)
    return Values(printed, right, derivative(_velocity_of_g, 0.0))


SKATE_ERRATA = (
    Erratum(
        11,
        "skates, acceleration of G",
        "vdot_C i' + v_C d(j')/dt + ...",
        "vdot_C i' + v_C d(i')/dt + ... = vdot_C i' + v_C thetadot j' + ...",
        "the dimensions are right and the direction is wrong by a quarter turn: only numbers tell",
        "m/s^2",
        r"\dot{v}_C \hat{i}' + v_C \dot{\hat{j}}'",
        r"\dot{v}_C \hat{i}' + v_C \dot{\hat{i}}' = \dot{v}_C \hat{i}' + v_C \dot{\theta} \hat{j}'",
        "the velocity of G, differentiated",
        False,
        _acceleration_of_g,
    ),
)
