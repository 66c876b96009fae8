"""Discs that roll, on a slope and in a hole."""

from __future__ import annotations

import math
from typing import Any

from engines.conformance.worlds.world import (
    INERTIA,
    MASS,
    WEIGHT,
    Array,
    G,
    World,
    body,
    resting,
    round_about,
    swing,
    world,
)
from reference.rolling.curves import Circle, Line, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll


def rolling(ground: Any, radius: float, angle: float, ground_arc: float) -> Rolling:
    """A disc of `radius` about its centre of mass, at `angle`, on a ground at `ground_arc`."""
    below = float(ground.angle(ground_arc)) + math.pi - angle  # the tangent's angle on the disc at the contact
    return Rolling(Circle(radius), ground, angle, ground_arc, radius * (below - math.pi / 2))


def _disc() -> World:
    """A disc rolls down a slope: r angle'' = -g sin(slope) / (1 + I / (m r^2)), and friction is -I angle'' / r."""
    radius, slope, spin, begin = 0.3, 0.4, -2.0, 0.2
    pull = G * math.sin(slope) / (1 + INERTIA / (MASS * radius**2))
    x, y = math.cos(slope), -math.sin(slope)  # downhill

    def states(t: Array) -> Any:
        way, speed = -radius * spin * t + pull * t**2 / 2, -radius * spin + pull * t
        return (
            [[way * x - radius * y, way * y + radius * x, begin - way / radius]],
            [[speed * x, speed * y, -speed / radius]],
            [[pull * x, pull * y, -pull / radius]],
        )

    # The ground's material is on its left, so it is traversed uphill: there friction, which slows the disc, points.
    ground = Line(math.pi - slope)
    joint = Roll("rim", None, "body", rolling(ground, radius, begin, 0.0))
    forces = [INERTIA * pull / radius**2, MASS * G * math.cos(slope)]
    return world("disc on a slope", (body("body"),), (joint,), (0.0, -G), states, lambda t: forces)


def _disc_in_a_hole() -> World:
    """A disc rolls to and fro at the bottom of a round hole: a pendulum of frequency^2 = g / (q (1 + I / (m r^2)))."""
    hole, radius, begin = 1.2, 0.3, 0.5
    between = hole - radius
    frequency = math.sqrt(G / (between * (1 + INERTIA / (MASS * radius**2))))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, begin, 1.0, frequency)
        parts = round_about(between, angle - math.pi / 2, rate, change)
        # Without slip r own' = -q angle'.
        owns = (-between / radius * (angle - begin), -between / radius * rate, -between / radius * change)
        return [[[*part, own]] for part, own in zip(parts, owns, strict=True)]

    ring = Ring(hole)  # arc 0 at +x, clockwise
    joint = Roll("rim", None, "body", rolling(ring, radius, 0.0, hole * (math.pi / 2 - begin)))
    return world("disc in a hole", (body("body"),), (joint,), (0.0, -G), states)


RESTING = (
    resting(
        "resting disc", (Roll("rim", None, "body", rolling(Line(), 0.3, 0.2, 0.0)),), [0.0, WEIGHT], (0.0, 0.3, 0.2)
    ),
)
MOVING = (
    _disc(),
    _disc_in_a_hole(),
)
