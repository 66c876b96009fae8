"""Towed wheels: the closed form of one drawbar, and the kinematics of a car or tricycle with trailers.

Formulas and letters: `reference/scenes/derivations.md` has the derivation.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import Complexes, InvalidMechanism, Positive, Times, Valid, sample_times, validated
from reference.joints import Triple
from reference.numerics.integration import Integrated, error_of, integrate
from reference.numerics.roots import first_below
from reference.validators import NOT_FINITE, Array, Rule, from_to, of_shape

Input = float | Callable[[Array], Array]  # a constant, or a function of times

# Argument m s up to which the direct formulas with hyperbolic functions have no cancellation.
SMALL_ARGUMENT = 0.5


@dataclass(frozen=True)
class Tow(Valid):
    """A drawbar of `length` L [m] whose hitch moves on a circle.

    start: x, y [m] and direction of travel [rad] of the hitch. radius: radius R [m] of the circle, which is positive to
    the left, negative to the right and infinite for a straight line. angle: psi [rad] at the start, which is 0 behind
    the hitch and +-pi ahead of the hitch. The values +-math.pi are exactly the unstable equilibrium. Raises
    InvalidMechanism for a length that is not positive, a radius of 0 or NaN, or an angle beyond +-pi.
    """

    length: Positive
    angle: Annotated[float, from_to(-math.pi, math.pi)]
    radius: Annotated[float, NOT_FINITE, Rule(lambda value: abs(value) > 0, "other than 0, or infinite")] = math.inf
    start: Triple = (0.0, 0.0, 0.0)

    @cached_property
    def curvature(self) -> float:
        """The curvature of the hitch's path [1/m], positive to the left."""
        return 1 / self.radius

    @cached_property
    def _discriminant(self) -> float:
        """1 - (L/R)^2, without cancellation near R = L."""
        if math.isinf(self.radius):
            return 1.0
        ratio = self.length / abs(self.radius)
        return (abs(self.radius) - self.length) / abs(self.radius) * (1 + ratio)

    @cached_property
    def _start(self) -> tuple[float, float, float]:
        sine = 0.0 if abs(self.angle) == math.pi else math.sin(self.angle)
        return sine, math.cos(self.angle), sine + self.length * self.curvature

    @validated
    def relative_angle(self, distance: ArrayLike) -> Array:
        """psi [rad, not wrapped] after the hitch has moved by the distance s (...) [m]; backwards s is negative."""
        distance = np.asarray(distance, dtype=float)
        across, along = self._half_angle_vector(distance)
        # The angle psi / 2 of (q, p) is monotonic, and below pi if the discriminant is not negative.
        half_turns = np.round(self._rate * distance / math.pi) if self._discriminant < 0 else 0.0
        return self.angle + 2 * (np.arctan2(across, along) - math.copysign(math.pi, self.radius) * half_turns)

    @cached_property
    def _rate(self) -> float:
        """The mean rate of the angle of (q, p) [rad/m], if the discriminant is negative and the wheel turns on."""
        return math.sqrt(-self._discriminant) / (2 * self.length)

    def _remainder(self, distance: Array) -> Array:
        return self._rate * distance - np.round(self._rate * distance / math.pi) * math.pi

    def _half_angle_vector(self, distance: Array) -> tuple[Array, Array]:
        """(q, p) times a common factor, in components across and along the vector at the start."""
        sine, cosine, swing = self._start
        if self._discriminant < 0:
            remainder = self._remainder(distance)
            root = 2 * self.length * self._rate
            across, along = -np.sin(remainder) * swing, np.cos(remainder) * root + np.sin(remainder) * cosine
            return across, along
        root = math.sqrt(self._discriminant)  # 2 L m
        argument_size = root * np.abs(distance) / (2 * self.length)
        is_small = argument_size < SMALL_ARGUMENT
        # tanh(m s)/(2 L m), or its limit if m = 0.
        argument = np.where(is_small & (argument_size > 0), argument_size, 1.0)
        tangent = distance / (2 * self.length) * np.where(argument_size > 0, np.tanh(argument) / argument, 1.0)
        # For large arguments the exponentials are separate, since tanh = 1 would lose the digits of a start near the
        # unstable equilibrium. The smaller of root + cosine and root - cosine is the product of both divided by the
        # larger number.
        product = swing * (sine - self.length * self.curvature)
        growing = root + cosine if cosine >= 0 else product / (root - cosine)
        decaying = root - cosine if cosine <= 0 else product / (root + cosine)
        ratio = np.exp(-2 * argument_size)
        forward = np.where(distance >= 0, growing + ratio * decaying, ratio * growing + decaying)
        across = np.where(is_small, -tangent * swing, np.sign(distance) * swing * np.expm1(-2 * argument_size))
        along = np.where(is_small, 1 + tangent * cosine, forward)
        return across, along

    @validated
    def heading(self, distance: ArrayLike) -> Array:
        """The drawbar's direction in the world, from the wheel to the hitch [rad]."""
        distance = np.asarray(distance, dtype=float)
        if self._discriminant >= 0:
            return self.start[2] + self.curvature * distance + self.relative_angle(distance)
        # On a small circle the hitch's angle and psi nearly cancel. Both contain 2 rate s, which is left out.
        across, along = self._half_angle_vector(distance)
        slower = 1 / (self.length**2 * (abs(self.curvature) + 2 * self._rate))  # |c| - 2 rate
        slow_part = math.copysign(1.0, self.radius) * (slower * distance + 2 * self._remainder(distance))
        return self.start[2] + self.angle + slow_part + 2 * np.arctan2(across, along)

    @validated
    def hitch(self, distance: ArrayLike) -> Array:
        """Position of the hitch (..., 2) [m]."""
        distance = np.asarray(distance, dtype=float)
        half = 0.5 * self.curvature * distance
        chord = distance * np.sinc(half / np.pi)
        angle = self.start[2] + half
        return np.stack([self.start[0] + chord * np.cos(angle), self.start[1] + chord * np.sin(angle)], axis=-1)

    @validated
    def wheel(self, distance: ArrayLike) -> Array:
        """Position of the towed wheel (..., 2) [m]."""
        heading = self.heading(distance)
        return self.hitch(distance) - self.length * np.stack([np.cos(heading), np.sin(heading)], axis=-1)


def input_at(value: Input, times: Array) -> Array:
    return np.asarray(value(times) if callable(value) else np.full(np.shape(times), value))


@validated
def towed(v: Complexes, w: Complexes, bend: Complexes, hitch: float, length: Positive) -> tuple[Any, Any]:
    """Speed [m/s] and turning rate [rad/s] of a trailer's axle from the axle ahead and the joint angle `bend` [rad]."""
    cosine, sine = np.cos(bend), np.sin(bend)
    return v * cosine + hitch * w * sine, (v * sine - hitch * w * cosine) / length


@dataclass(frozen=True)
class Convoy:
    """The motion of a car and its trailers, with the first jack-knife.

    pose (times, vehicles, 3) [m, m, rad] has the middles of the axles and the headings at t (times,) [s]. speed (times,
    vehicles) [m/s] is along the headings and changes sign for a folded trailer. error (times,) [m or rad] is a bound on
    the integration error. jackknifed_at [s] is the first time at which a joint angle exceeds the limit; jackknifed is
    the number of the trailer, from 1.
    """

    t: Array
    pose: Array
    speed: Array
    error: Array
    jackknifed_at: float | None
    jackknifed: int | None

    @property
    def bends(self) -> Array:
        """Joint angles (times, trailers) [rad]: a trailer's heading minus the heading of the towing vehicle."""
        return np.diff(self.pose[:, :, 2], axis=1)


@dataclass(frozen=True)
class CarWithTrailers(Valid):
    """A car with trailers.

    wheelbase [m] from rear axle to steered wheel; lengths [m] of the drawbars from hitch to axle; hitches [m]: distance
    of each hitch behind the axle of the towing vehicle, negative if the hitch is ahead of that axle. Raises
    InvalidMechanism for a length that is not positive, or if the numbers of lengths and hitches differ.
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
        """Speeds and turning rates (..., vehicles) of all axles at headings (..., vehicles)."""
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
        """The car's turning rate v tan(steering)/wheelbase [rad/s] at the speed v of the rear axle."""
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
        """The motion at times t [s] from the pose `start` of the rear axle and joint angles `bends` [rad].

        speed [m/s] of the rear axle and steering [rad] are numbers or functions of time. A joint angle beyond `limit`
        [rad] is a jack-knife. The result has the time of the jack-knife, and the ideal motion continues.
        """
        times = sample_times("car", t)
        if len(bends) != len(self.lengths):
            raise InvalidMechanism(
                f"car: {len(bends)} joint angles for {len(self.lengths)} trailers; give one for each"
            )

        def inputs(time: Array) -> tuple[Array, Array]:
            v = input_at(speed, time)
            return v, self.turning_rate(v, input_at(steering, time))

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
            leader, heading = poses[-1], headings[:, index + 1]
            x = leader[:, 0] - hitch * np.cos(leader[:, 2]) - length * np.cos(heading)
            y = leader[:, 1] - hitch * np.sin(leader[:, 2]) - length * np.sin(heading)
            poses.append(np.stack([x, y, heading], axis=-1))
        speeds, _ = self.axle_rates(headings, *inputs(times))
        when, which = self._jackknife(motion, first, limit)
        return Convoy(times, np.stack(poses, axis=1), speeds, error, when, which)

    def _jackknife(self, motion: Integrated | None, first: Array, limit: float) -> tuple[float | None, int | None]:
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
