"""A car or tricycle and the trailers behind it, as kinematics: ideal wheels, a given speed and steering, any hitch.

A vehicle's axle has the speed v along its heading and the turning rate w. Its hitch stands `h` behind the axle (0: on
it, negative: ahead), the trailer's axle `L` behind the hitch; with b = theta_vehicle - theta_trailer the hitch's
velocity (v along, -h w across) gives, along and across the trailer,

    v_trailer = v cos b + h w sin b,     w_trailer = (v sin b - h w cos b)/L.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Times, Valid, sample_times, validated
from reference.joints import Triple
from reference.kinds import of_shape
from reference.numerics.integration import Integrated, error_of, integrate
from reference.numerics.roots import first_below

Array = NDArray[np.float64]
Input = float | Callable[[Array], Array]


@validated
def towed(v: Complexes, w: Complexes, bend: Complexes, hitch: float, length: Positive) -> tuple[Any, Any]:
    """Speed [m/s] and turning rate [rad/s] of a trailer's axle from those of the axle before it; bend b in [rad]."""
    cosine, sine = np.cos(bend), np.sin(bend)
    return v * cosine + hitch * w * sine, (v * sine - hitch * w * cosine) / length


@dataclass(frozen=True)
class Convoy:
    """The poses of a car and its trailers at times t, and when it jack-knifed."""

    t: Array  # (times,) s
    pose: Array  # (times, vehicles, 3) of the axles' middles and headings: m, m, rad
    speed: Array  # (times, vehicles) m/s along the headings; a trailer's sign differs from the car's once it is folded
    error: Array  # (times,) m or rad, a bound on the integration's own error
    jackknifed_at: float | None  # s, the first time that a joint is bent beyond the limit
    jackknifed: int | None  # which trailer, counted from 1

    @property
    def bends(self) -> Array:
        """Joint angles theta_trailer - theta_before (times, trailers) [rad]."""
        return np.diff(self.pose[:, :, 2], axis=1)


@dataclass(frozen=True)
class CarWithTrailers(Valid):
    """A car, `wheelbase` [m] from rear axle to steered wheel, and trailers with drawbars `lengths` [m] from hitch to
    axle, hitched `hitches` [m] behind the axle before (0: on it, negative: ahead of it). Raises InvalidMechanism for a
    length that is not positive, or unequal numbers of lengths and hitches.
    """

    wheelbase: Positive
    lengths: tuple[Positive, ...]
    hitches: tuple[float, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.lengths) != len(self.hitches):
            raise InvalidMechanism(
                f"car: {len(self.lengths)} lengths and {len(self.hitches)} hitches; every trailer has one of each"
            )

    @validated
    def axle_rates(
        self, headings: Annotated[Complexes, of_shape("...", "vehicles")], speed: Complexes, turning_rate: Complexes
    ) -> tuple[Any, Any]:
        """Speeds and turning rates (..., vehicles) of all axles at headings (..., vehicles), from the car's."""
        headings = np.asarray(headings)
        speeds, rates = [speed], [turning_rate]
        for index, (length, hitch) in enumerate(zip(self.lengths, self.hitches, strict=True)):
            bend = headings[..., index] - headings[..., index + 1]
            v, w = towed(speeds[-1], rates[-1], bend, hitch, length)
            speeds.append(v)
            rates.append(w)
        return np.stack(np.broadcast_arrays(*speeds), axis=-1), np.stack(np.broadcast_arrays(*rates), axis=-1)

    @validated
    def turning_rate(self, speed: Complexes, steering: Complexes) -> Any:
        """Of the car, from its rear axle's speed and its steered wheel's angle [rad/s]: v tan(steering)/wheelbase."""
        return speed * np.tan(steering) / self.wheelbase

    @validated
    def drive(
        self,
        speed: Input,
        steering: Input,
        start: Triple,
        bends: tuple[float, ...],
        t: Times,
        limit: Positive = math.pi / 2,
    ) -> Convoy:
        """Follow the car from the pose `start` of its rear axle and joint angles `bends` [rad], at times t [s].

        speed [m/s] of the rear axle and steering [rad] are numbers or functions of time. A joint bent beyond `limit`
        [rad] is a jack-knife: it is dated, and the motion goes on, as ideal wheels would (bodies that touch would not).
        """
        times = sample_times("car", t)
        if len(bends) != len(self.lengths):
            raise InvalidMechanism(
                f"car: {len(bends)} joint angles for {len(self.lengths)} trailers; give one for each"
            )

        def inputs(time: Array) -> tuple[Array, Array]:
            v = speed(time) if callable(speed) else np.full(np.shape(time), speed)
            angle = steering(time) if callable(steering) else np.full(np.shape(time), steering)
            return np.asarray(v), self.turning_rate(v, np.asarray(angle))

        def rates(state: Array) -> Array:
            v, w = inputs(state[..., 0])
            headings = state[..., 3:]
            _, turning = self.axle_rates(headings, v, w)
            moved = np.stack([np.ones_like(v), v * np.cos(headings[..., 0]), v * np.sin(headings[..., 0])], axis=-1)
            return np.concatenate([moved, turning], axis=-1)

        first = np.array([0.0, *start, *(start[2] + np.cumsum(bends))])
        last = float(times.max(initial=0.0))
        motion = integrate(rates, first, last) if last > 0 else None
        states = motion(times) if motion else np.broadcast_to(first, (len(times), len(first))).copy()
        error = error_of(rates, first, times) if motion else np.zeros(len(times))
        headings = states[:, 3:]
        poses = [np.concatenate([states[:, 1:3], headings[:, :1]], axis=-1)]
        for index, (length, hitch) in enumerate(zip(self.lengths, self.hitches, strict=True)):
            before, heading = poses[-1], headings[:, index + 1]
            x = before[:, 0] - hitch * np.cos(before[:, 2]) - length * np.cos(heading)
            y = before[:, 1] - hitch * np.sin(before[:, 2]) - length * np.sin(heading)
            poses.append(np.stack([x, y, heading], axis=-1))
        speeds, _ = self.axle_rates(headings, *inputs(times))
        when, which = self._jackknife(motion, first, limit)
        return Convoy(times, np.stack(poses, axis=1), speeds, error, when, which)

    def _jackknife(self, motion: Integrated | None, first: Array, limit: float) -> tuple[float | None, int | None]:
        """The first instant that a joint passes the limit, and which trailer's, counted from 1."""

        def spare(states: Array) -> Array:
            bends = np.diff(states[..., 3:], axis=-1)
            return np.concatenate([limit - bends, limit + bends], axis=-1)

        count = len(self.lengths)
        if motion is None or not count:
            folded = np.flatnonzero(spare(first) < 0)
            return (0.0, int(folded[0]) % count + 1) if folded.size else (None, None)

        def values(t: Array) -> tuple[Array, Array]:
            states = motion(t)
            return spare(states).T, limit + np.abs(states[:, 3:]).max(axis=-1)

        when, which = first_below(values, motion.times) or (None, None)
        return when, None if which is None else which % count + 1
