"""A grocery cart's free casters as kinematics: each is a drawbar towed by its kingpin, and swings round in reverse.

A caster's wheel stands `trail` c behind its kingpin; with beta its direction (wheel to kingpin) less the cart's, and
the kingpin at (x, y) from the middle of the rear axle, which has the speed u and the turning rate w,

    w + beta' = (x w cos beta - (u - y w) sin beta)/c.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import Complexes, Positive, Times, Valid, index_of, sample_times, validated
from reference.joints import Vector
from reference.numerics.integration import error_of, integrate
from reference.scenes.wheels.tractrix import Tow

Array = NDArray[np.float64]
Input = float | Callable[[Array], Array]


@dataclass(frozen=True)
class Casters(Valid):
    """Kingpins at `places` [m] from the middle of the fixed axle, x ahead, y to the left; all with one trail [m]."""

    places: tuple[Vector, ...]
    trail: Positive

    @validated
    def turning_rates(self, angles: Complexes, speed: Complexes, turning_rate: Complexes) -> Any:
        """The casters' own rates in the world w + beta' (..., casters) [rad/s] at angles beta (..., casters) [rad]."""
        x, y = np.array(self.places, dtype=float).T
        speed, turning_rate = np.asarray(speed)[..., None], np.asarray(turning_rate)[..., None]
        return (x * turning_rate * np.cos(angles) - (speed - y * turning_rate) * np.sin(angles)) / self.trail

    @validated
    def tow(self, caster: int, angle: float, speed: float, turning_rate: float) -> tuple[Tow, float]:
        """For a constant speed and turning rate: the caster as a tow in closed form, and its kingpin's speed [m/s].

        The caster's angle beta at time t is then tow.relative_angle(kingpin speed * t) + (angle - tow.angle).
        """
        x, y = self.places[index_of("Casters.tow", "caster", caster, len(self.places))]
        along, across = speed - y * turning_rate, x * turning_rate
        size = math.hypot(along, across)
        radius = math.inf if turning_rate == 0 or size == 0 else size / turning_rate
        direction = math.atan2(across, along)
        return Tow(self.trail, math.remainder(angle - direction, 2 * math.pi), radius), size

    @validated
    def swing(self, angles: tuple[float, ...], speed: Input, turning_rate: Input, t: Times) -> tuple[Array, Array]:
        """Angles beta (times, casters) [rad, not wrapped] from `angles` at t = 0, and the integration's error (times,).

        speed [m/s] and turning_rate [rad/s] of the cart are numbers or functions of time. Straight back from a small
        angle the caster swings round to pi; from exactly zero it stays, which no real one does.
        """
        times = sample_times("casters", t)

        def rates(state: Array) -> Array:
            time = state[..., 0]
            u = speed(time) if callable(speed) else np.full(np.shape(time), speed)
            w = turning_rate(time) if callable(turning_rate) else np.full(np.shape(time), turning_rate)
            own = self.turning_rates(state[..., 1:], u, w) - np.asarray(w)[..., None]
            return np.concatenate([np.ones((*time.shape, 1)), own], axis=-1)

        first = np.array([0.0, *angles])
        last = float(times.max(initial=0.0))
        if last == 0:
            return np.broadcast_to(first[1:], (len(times), len(angles))).copy(), np.zeros(len(times))
        return integrate(rates, first, last)(times)[:, 1:], error_of(rates, first, times)
