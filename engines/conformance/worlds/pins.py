"""Bodies on pins, swinging or driven."""

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
from reference.joints import Drive, Pin


def _swinging_bar() -> World:
    """A bar whose centre of mass is `arm` below the pin: frequency^2 = m g arm / (I + m arm^2)."""
    arm = 0.5
    frequency = math.sqrt(MASS * G * arm / (INERTIA + MASS * arm**2))

    def states(t: Array) -> Any:
        angle, rate, change = swing(t, 0.6, 1.5, frequency)
        place, velocity, acceleration = round_about(arm, angle - math.pi / 2, rate, change)
        return [[*place, angle]], [[*velocity, rate]], [[*acceleration, change]]

    pin = Pin("hinge", None, "body", (0.0, 0.0), (0.0, arm))
    return world("swinging bar", (body("body"),), (pin,), (0.0, -G), states)


def _swinging_parallelogram() -> World:
    """Two equal cranks and a coupler that stays parallel to the ground: one freedom, and the pins close a loop."""
    crank, base, arm = 0.5, 0.8, 0.2  # arm: of a crank's centre of mass from the ground
    heavy, light = 1.5, 1.0  # kg, the coupler and a crank
    own = 2 * (0.05 + light * arm**2) + heavy * crank**2
    frequency = math.sqrt((2 * light * arm + heavy * crank) * G / own)

    def states(t: Array) -> Any:
        angles = swing(t, 0.5, 1.5, frequency)
        angle, rate, change = angles
        inner, outer = (round_about(radius, angle - math.pi / 2, rate, change) for radius in (arm, crank))
        still = np.zeros_like(t)
        return [
            [[x, y, own], [x + apart, y, own], [along + apart / 2, across, still]]
            for (x, y), (along, across), own, apart in zip(inner, outer, angles, (base, 0.0, 0.0), strict=True)
        ]

    bodies = (body("left", light, 0.05), body("right", light, 0.05), body("coupler", heavy, 0.1))
    top, end = (0.0, arm), (0.0, arm - crank)
    joints = (
        Pin("A", None, "left", (0.0, 0.0), top),
        Pin("B", "left", "coupler", end, (-base / 2, 0.0)),
        Pin("C", "coupler", "right", (base / 2, 0.0), end),
        Pin("D", None, "right", (base, 0.0), top),
    )
    return world("swinging parallelogram", bodies, joints, (0.0, -G), states)


def _driven_crank() -> World:
    """A crank at a constant rate: the drive carries the weight's moment, the pin the weight and m a."""
    arm, rate = 0.5, 3.0

    def states(t: Array) -> Any:
        angle = 0.4 + rate * t
        place, velocity, acceleration = round_about(arm, angle, np.full_like(t, rate), np.zeros_like(t))
        return [[*place, angle]], [[*velocity, rate]], [[*acceleration, 0.0]]

    def reaction(t: Array) -> Any:
        x, y = arm * np.cos(0.4 + rate * t), arm * np.sin(0.4 + rate * t)
        return [-MASS * rate**2 * x, MASS * (G - rate**2 * y), MASS * G * x]

    joints = (
        Pin("hinge", None, "body", (0.0, 0.0), (-arm, 0.0)),
        Drive("motor", None, "body", rate, 0.4),
    )
    return world("driven crank", (body("body"),), joints, (0.0, -G), states, reaction)


def _spinning_bar() -> World:
    """A bar on a pin through its centre of mass turns at a constant rate, from an angle of more than one turn."""
    rate, begin = -60.0, 20.0
    pin = Pin("hinge", None, "body", (0.0, 0.0), (0.0, 0.0))
    return world(
        "spinning bar",
        (body("body"),),
        (pin,),
        (0.0, 0.0),
        lambda t: ([[0.0, 0.0, begin + rate * t]], [[0.0, 0.0, rate]], [[0.0, 0.0, 0.0]]),
    )


RESTING = (
    resting("hanging bar", (Pin("hinge", None, "body", (0.3, 1.0), (0.0, 0.5)),), [0.0, WEIGHT], (0.3, 0.5, 0.0)),
    resting(
        "held arm",
        (Pin("hinge", None, "body", (0.0, 0.0), (-0.5, 0.0)), Drive("motor", None, "body", 0.0, 0.0)),
        [0.0, WEIGHT, WEIGHT * 0.5],
        (0.5, 0.0, 0.0),
    ),
)
MOVING = (
    _swinging_bar(),
    _swinging_parallelogram(),
    _driven_crank(),
)
SPINNING = _spinning_bar()
