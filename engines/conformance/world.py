"""What a world is: a mechanism and its exact motion; how one is written down, and what several are made of."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.special import ellipj, ellipkinc

from reference.joints import Joint
from reference.mechanism import Body, Mechanism

Array = NDArray[np.float64]
G = 10.0  # m/s^2, downwards
MASS, INERTIA = 2.0, 0.3  # kg and kg m^2 of most bodies
WEIGHT = MASS * G


@dataclass(frozen=True)
class Motion:
    """Poses, twists and accelerations (times, bodies, 3), and reactions (times, rows)."""

    pose: Array
    twist: Array
    acceleration: Array
    reaction: Array


@dataclass(frozen=True)
class World:
    """A mechanism and its exact motion."""

    name: str
    mechanism: Mechanism
    exact: Callable[[Array], Motion]

    @property
    def kinds(self) -> tuple[str, ...]:
        """The kinds of its joints, in the order in which they first stand in it."""
        return tuple(dict.fromkeys(type(joint).__name__.lower() for joint in self.mechanism.joints))


def world(
    name: str,
    bodies: tuple[Body, ...],
    joints: tuple[Joint, ...],
    gravity: tuple[float, float],
    states: Callable[[Array], Any],
    reaction: Callable[[Array], Any] | None = None,
) -> World:
    """A world whose bodies start where `states` says; `states(t)`: pose, twist, acceleration (bodies, 3, times).

    `reaction(t)` (rows, times) is a formula of its own; without one, reactions are what the accelerations need.
    """

    def parts(t: Array) -> tuple[Array, ...]:
        return tuple(np.moveaxis(_filled(part, t), -1, 0) for part in states(t))

    def motion(t: Array) -> Motion:
        pose, twist, change = parts(t)
        if reaction is None:
            return Motion(pose, twist, change, mechanism.reaction(pose, change))
        return Motion(pose, twist, change, np.moveaxis(_filled(reaction(t), t), -1, 0))

    pose, twist, _ = parts(np.zeros(1))
    placed = (
        Body(each.name, each.mass, each.inertia, _triple(pose[0, i]), _triple(twist[0, i]))
        for i, each in enumerate(bodies)
    )
    mechanism = Mechanism(tuple(placed), joints, gravity)
    return World(name, mechanism, motion)


def _filled(values: Any, t: Array) -> Array:
    """Nested lists of numbers and of arrays (times,) as one array (..., times)."""
    if isinstance(values, list | tuple):
        return np.stack([_filled(value, t) for value in values])
    return np.broadcast_to(np.asarray(values, dtype=float), t.shape)


def _triple(values: Array) -> tuple[float, float, float]:
    x, y, angle = values.tolist()
    return x, y, angle


def body(name: str, mass: float = MASS, inertia: float = INERTIA) -> Body:
    return Body(name, mass, inertia, (0.0, 0.0, 0.0))


def resting(name: str, joints: tuple[Joint, ...], reaction: list[float], place: tuple[float, float, float]) -> World:
    """One body that stays where it is."""
    still = [[0.0, 0.0, 0.0]]
    return world(name, (body("body"),), joints, (0.0, -G), lambda t: ([list(place)], still, still), lambda t: reaction)


def swing(t: Array, angle: float, rate: float, frequency: float) -> tuple[Array, Array, Array]:
    """angle'' = -frequency^2 sin(angle) by Jacobi's functions: angle, rate, acceleration; to and fro, never over."""
    modulus = math.hypot(rate / (2 * frequency), math.sin(angle / 2))
    phase = math.asin(math.sin(angle / 2) / modulus)
    start = ellipkinc(phase if rate >= 0 else math.pi - phase, modulus**2)
    sn, cn, _, _ = ellipj(frequency * t + start, modulus**2)
    found = 2 * np.arcsin(modulus * sn)
    return found, 2 * modulus * frequency * cn, -(frequency**2) * np.sin(found)


def round_about(radius: float, angle: Array, rate: Array, change: Array) -> tuple[list[Array], ...]:
    """Place, velocity, acceleration, each [x, y], of a point on a circle about the origin."""
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    return [x, y], [-y * rate, x * rate], [-y * change - x * rate**2, x * change - y * rate**2]
