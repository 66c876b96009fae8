"""Bodies whose points slide on lines, of the ground or of a rod that turns."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

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
from reference.joints import Drive, Pin, Slot


def _sliding_block() -> World:
    """A block whose centre of mass slides down an incline, turning at a rate that nothing changes."""
    slope, speed, spin = -0.5, 0.8, 0.7
    pull = G * math.sin(-slope)
    x, y = math.cos(slope), math.sin(slope)

    def states(t: Array) -> Any:
        way, now = speed * t + pull * t**2 / 2, speed + pull * t
        return [[way * x, way * y, 0.3 + spin * t]], [[now * x, now * y, spin]], [[pull * x, pull * y, 0.0]]

    slot = Slot("guide", None, "body", (0.0, 0.0), slope, (0.0, 0.0))
    return world("sliding block", (body("body"),), (slot,), (0.0, -G), states, lambda t: [MASS * G * math.cos(slope)])


def _bead() -> World:
    """A bead in a slot of a rod that turns at a constant rate: r'' = rate^2 r - g sin(turned).

    r = near cosh(rate t) + far sinh(rate t) + g sin(turned) / (2 rate^2), and across the rod the bead feels
    2 m r' rate + m g cos(turned).
    """
    rate, begin, near, far = 3.0, 0.5, 0.2, 0.1
    own = G / (2 * rate**2)

    def along(t: Array) -> tuple[Array, Array, Array]:
        grown = near * np.cosh(rate * t) + far * np.sinh(rate * t)
        growing = near * np.sinh(rate * t) + far * np.cosh(rate * t)
        sine, cosine = np.sin(begin + rate * t), np.cos(begin + rate * t)
        return grown + own * sine, rate * (growing + own * cosine), rate**2 * (grown - own * sine)

    def states(t: Array) -> Any:
        way, speed, change = along(t)
        turned = begin + rate * t
        cosine, sine = np.cos(turned), np.sin(turned)
        ahead, across = change - rate**2 * way, 2 * speed * rate
        return (
            [[0.0, 0.0, turned], [way * cosine, way * sine, 0.0]],
            [[0.0, 0.0, rate], [speed * cosine - way * rate * sine, speed * sine + way * rate * cosine, 0.0]],
            [[0.0, 0.0, 0.0], [ahead * cosine - across * sine, ahead * sine + across * cosine, 0.0]],
        )

    def reaction(t: Array) -> Any:
        way, speed, _ = along(t)
        cosine, sine = np.cos(begin + rate * t), np.sin(begin + rate * t)
        pressed = MASS * (2 * speed * rate + G * cosine)
        # The hinge and the motor hold the rod against its weight and against what it presses on the bead.
        return [-pressed * sine, pressed * cosine + MASS * G, pressed * way, pressed]

    joints = (
        Pin("hinge", None, "rod", (0.0, 0.0), (0.0, 0.0)),
        Drive("motor", None, "rod", rate, begin),
        Slot("groove", "rod", "bead", (0.0, 0.0), 0.0, (0.0, 0.0)),
    )
    return world("bead on a turning rod", (body("rod"), body("bead")), joints, (0.0, -G), states, reaction)


def _trammel() -> World:
    """A bar whose ends slide on two lines at a right angle: its middle swings on a circle, its angle the other way."""
    half = 0.5
    frequency = math.sqrt(MASS * G * half / (MASS * half**2 + INERTIA))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.7, 1.5, frequency)
        parts = round_about(half, angle - math.pi / 2, rate, change)
        # The end (half, 0) of the bar is on the x axis, the other on the y axis: the bar's angle is minus the middle's.
        own = (math.pi / 2 - angle, -rate, -change)
        return [[[*part, turned]] for part, turned in zip(parts, own, strict=True)]

    joints = (
        Slot("level", None, "body", (0.0, 0.0), 0.0, (half, 0.0)),
        Slot("upright", None, "body", (0.0, 0.0), math.pi / 2, (-half, 0.0)),
    )
    return world("trammel", (body("body"),), joints, (0.0, -G), states)


RESTING = (
    resting("resting block", (Slot("guide", None, "body", (0.0, 0.2), 0.0, (0.0, 0.0)),), [WEIGHT], (0.4, 0.2, 0.1)),
)
MOVING = (
    _sliding_block(),
    _bead(),
    _trammel(),
)
