"""The slip of the page on skates: the acceleration of a body's point, whose dimensions are right as printed.

The heading is theta(t) as for rolling, the speed along it SPEED + PUSH t; G is a point at ARM in the body's frame from
the skate's point C.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from reference.chapter.errata.erratum import Array, Erratum, Values
from reference.chapter.errata.rolling import ALPHA, OMEGA, THETA
from reference.numerics.cauchy import derivative

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
