"""Bodies on one blade, under the centre of mass or behind it."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from engines.conformance.worlds.world import INERTIA, MASS, WEIGHT, Array, G, World, body, resting, world
from reference.joints import Skate


def _skate() -> World:
    """A skate under its centre of mass on a slope: it turns steadily, and only the pull along the blade changes v.

    heading' = w and v' = -g sin(heading), so v = c + (g / w) cos(heading).
    """
    spin, speed, begin, blade = 2.0, 1.2, 0.5, 0.3
    pull = G / spin
    steady = speed - pull * math.cos(begin)

    def states(t: Array) -> Any:
        heading = begin + spin * t
        cosine, sine = np.cos(heading), np.sin(heading)
        now, change = steady + pull * cosine, -G * sine
        x = steady * (sine - math.sin(begin)) + pull * (spin * t + (np.sin(2 * heading) - math.sin(2 * begin)) / 2) / 2
        y = -steady * (cosine - math.cos(begin)) + pull * (sine**2 - math.sin(begin) ** 2) / 2
        aside = now * spin
        return (
            [[x / spin, y / spin, heading - blade]],
            [[now * cosine, now * sine, spin]],
            [[change * cosine - aside * sine, change * sine + aside * cosine, 0.0]],
        )

    def reaction(t: Array) -> Any:
        cosine = np.cos(begin + spin * t)
        return [MASS * ((steady + pull * cosine) * spin + G * cosine)]

    joint = Skate("blade", None, "body", (0.0, 0.0), blade)
    return world("skate on a slope", (body("body"),), (joint,), (0.0, -G), states, reaction)


def _sleigh() -> World:
    """Chaplygin's sleigh, its blade behind the centre of mass, on level ice: in the end it runs straight ahead.

    With v along the blade and w the rate: v' = arm w^2, (I + m arm^2) w' = -m arm v w. So v = V tanh(s) and
    w = W / cosh(s), where V^2 m = W^2 (I + m arm^2) and s = s0 + p t with p = m arm V / (I + m arm^2). The heading has
    turned by W / p (gd(s) - gd(s0)), gd the Gudermannian function.
    """
    arm, largest, begin, turned = 0.4, 2.0, 0.5, 0.3
    whole = INERTIA + MASS * arm**2
    fastest = largest * math.sqrt(whole / MASS)
    pace = MASS * arm * fastest / whole
    nodes, weights = np.polynomial.legendre.leggauss(24)

    def heading(t: Array) -> Array:
        def turned_by(s: Any) -> Any:
            return 2 * np.arctan(np.tanh(s / 2))

        return turned + largest / pace * (turned_by(begin + pace * t) - turned_by(begin))

    def speed(t: Array) -> Array:
        return fastest * np.tanh(begin + pace * t)

    def states(t: Array) -> Any:
        angle, now, rate = heading(t), speed(t), largest / np.cosh(begin + pace * t)
        within = t[:, None] * (nodes + 1) / 2  # the path's integral by Gauss's rule, to rounding below a second
        way = t / 2 * ((speed(within) * np.exp(1j * heading(within))) @ weights)
        faster, slower = arm * rate**2, -MASS * arm * now * rate / whole
        ahead = np.exp(1j * angle)
        place = way + arm * ahead
        velocity = (now + 1j * arm * rate) * ahead
        change = (faster - arm * rate**2 + 1j * (arm * slower + now * rate)) * ahead
        return (
            [[place.real, place.imag, angle]],
            [[velocity.real, velocity.imag, rate]],
            [[change.real, change.imag, slower]],
        )

    def reaction(t: Array) -> Any:
        rate = largest / np.cosh(begin + pace * t)
        return [INERTIA * MASS * speed(t) * rate / whole]

    joint = Skate("blade", None, "body", (-arm, 0.0))
    return world("sleigh", (body("body"),), (joint,), (0.0, 0.0), states, reaction)


RESTING = (resting("resting skate", (Skate("blade", None, "body", (0.0, 0.0)),), [WEIGHT], (0.4, 0.2, 0.0)),)
MOVING = (
    _skate(),
    _sleigh(),
)
