"""A car with its steering held, and a trailer on a hitch, coasting: the whole motion but its timing in closed form.

One freedom of velocity is left, the rear axle's speed v along a circle, so the energy M(s) v^2/2 gives the speed at
every way s: the trailer's direction is a towed drawbar's (`trailers.Tow`), its hitch on a circle of its own, and
t(s) = int sqrt(M(s)/M(0)) ds / v(0) is inverted. No multiplier and no equation of motion is solved.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, Positive, validated
from reference.joints import Joint, Pin, Skate, Triple, bodies_of
from reference.mechanism import Mechanism
from reference.numerics.calculus import Antiderivative
from reference.numerics.roots import solve_increasing
from reference.plane import COMPLEX_STEP
from reference.scene import Scene
from reference.scenes.wheels.trailers import Tow, towed
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class CarAndTrailer(Scene):
    """masses [kg], inertias [kg m^2] and centres of mass [m] ahead of the own axle, for the car and for the trailer.

    wheelbase [m]; steering [rad] of the front wheel, held; hitch [m] behind the car's rear axle; length [m] from hitch
    to the trailer's axle; speed [m/s] of the rear axle (negative: backwards, unstable) and bend [rad], the trailer's
    direction less the car's, at t = 0; pose of the rear axle. The two wheels of an axle stop the same motion: one row
    is modelled, and with `redundant` both, `track` [m] apart. Raises InvalidMechanism for numbers not finite, masses or
    lengths not positive, or steering of a right angle and more.
    """

    name: ClassVar[str] = "car_and_trailer"
    source: ClassVar[str] = "section 18.5, contact with ideal wheels and skates; box 18.3"

    masses: tuple[Positive, Positive] = (2.0, 1.0)
    inertias: tuple[Positive, Positive] = (0.5, 0.2)
    centres: tuple[float, float] = (0.4, 0.15)
    wheelbase: Positive = 1.0
    steering: float = 0.4
    hitch: float = 0.2
    length: Positive = 0.8
    speed: float = 1.0
    bend: float = 1.2
    pose: Triple = (0.0, 0.0, 0.0)
    track: Positive = 0.4
    redundant: bool = False
    duration: Positive = 5.0
    horizon: Positive = 5.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if not abs(self.steering) < math.pi / 2:
            raise InvalidMechanism(f"{self._owner()}: steering is {self.steering!r} rad; a right angle is too much")

    @property
    def curvature(self) -> float:
        """Of the rear axle's circle [1/m]: tan(steering)/wheelbase."""
        return math.tan(self.steering) / self.wheelbase

    @cached_property
    def _tow(self) -> tuple[Tow, float, float]:
        """The drawbar's tow, the hitch's way for 1 m of the car's, and what to add to the tow's heading [rad]."""
        pace = math.hypot(1.0, self.hitch * self.curvature)
        direction = self.pose[2] - math.atan(self.hitch * self.curvature)
        heading = self.pose[2] + self.bend
        angle = math.remainder(heading - direction, 2 * math.pi)
        radius = pace / self.curvature if self.curvature else math.inf
        return Tow(self.length, angle, radius, (0.0, 0.0, direction)), pace, heading - direction - angle

    def _headings(self, way: Array) -> Array:
        """Of car and trailer (..., 2) [rad] after the way s [m] of the rear axle."""
        tow, pace, turns = self._tow
        return np.stack([self.pose[2] + self.curvature * way, tow.heading(pace * way) + turns], axis=-1)

    def _per_way(self, headings: NDArray[Any]) -> NDArray[Any]:
        """Twists for a speed of 1 (..., 2 bodies, 3), analytic in the headings."""
        (car, trailer), (ahead, before) = np.moveaxis(headings, -1, 0), self.centres
        speed, turning = towed(1.0, self.curvature, car - trailer, self.hitch, self.length)
        out = []
        for heading, v, w, centre in (
            (car, 1.0, self.curvature + 0 * car, ahead),
            (trailer, speed, turning, before),
        ):
            cosine, sine = np.cos(heading), np.sin(heading)
            out.append(np.stack([v * cosine - centre * w * sine, v * sine + centre * w * cosine, w], axis=-1))
        return np.stack(out, axis=-2)

    @property
    def _weights(self) -> Array:
        return np.array([(mass, mass, own) for mass, own in zip(self.masses, self.inertias, strict=True)])

    @validated
    def apparent_mass(self, way: ArrayLike) -> Array:
        """M(s) [kg]: twice the kinetic energy for a speed of 1 m/s of the rear axle."""
        per_way = self._per_way(self._headings(np.asarray(way, dtype=float)))
        return np.sum(self._weights * per_way**2, axis=(-2, -1))

    @cached_property
    def _stretch(self) -> Antiderivative:
        """int sqrt(M/M(0)) over the distance gone [m]."""
        sign, first = math.copysign(1.0, self.speed), float(self.apparent_mass(0.0))
        shortest = min(self.length, 1 / (abs(self.curvature) + 1e-9))
        return Antiderivative(lambda r: np.sqrt(self.apparent_mass(sign * r) / first), shortest)

    def _way(self, times: Array) -> Array:
        """The rear axle's way s (times,) [m], backwards negative."""
        sign, first = math.copysign(1.0, self.speed), float(self.apparent_mass(0.0))
        goal = abs(self.speed) * times

        def stretch(way: Array) -> tuple[Array, Array]:
            return self._stretch(way), np.sqrt(self.apparent_mass(sign * way) / first)

        return sign * solve_increasing(stretch, goal, goal, self.wheelbase, (0.0, math.inf))

    def mechanism(self) -> Mechanism:
        start = self._moving(np.zeros(1), np.array([self.speed]))
        names = ("car", "trailer")
        bodies = bodies_of(names, self.masses, self.inertias, start[0][0], start[1][0])
        (ahead, before), half = self.centres, self.track / 2
        joints: list[Joint] = [
            Skate("front wheel", None, "car", (self.wheelbase - ahead, 0.0), self.steering),
            Pin("hitch", "car", "trailer", (-ahead - self.hitch, 0.0), (self.length - before, 0.0)),
        ]
        for name, centre in zip(names, self.centres, strict=True):
            if self.redundant:
                joints.append(Skate(f"{name}'s left wheel", None, name, (-centre, half)))
                joints.append(Skate(f"{name}'s right wheel", None, name, (-centre, -half)))
            else:
                joints.append(Skate(f"{name}'s axle", None, name, (-centre, 0.0)))
        return Mechanism(bodies, tuple(joints))

    def _moving(self, way: Array, speed: Array) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations (times, 2, 3)."""
        headings = self._headings(way)
        per_way = self._per_way(headings)
        turning = headings + 1j * COMPLEX_STEP * per_way[..., 2]  # the headings' own rates along the way
        bending = np.imag(self._per_way(turning)) / COMPLEX_STEP
        mass = np.sum(self._weights * per_way**2, axis=(-2, -1))
        speed_rate = -np.sum(self._weights * per_way * bending, axis=(-2, -1)) / mass * speed**2
        speeds = speed[:, None, None]
        acceleration = bending * speeds**2 + per_way * speed_rate[:, None, None]
        half = 0.5 * self.curvature * way
        chord, middle = way * np.sinc(half / np.pi), self.pose[2] + half
        axle = np.array(self.pose[:2]) + np.stack([chord * np.cos(middle), chord * np.sin(middle)], axis=-1)
        ahead = np.stack([np.cos(headings), np.sin(headings)], axis=-1)  # (times, vehicles, 2)
        car = axle + self.centres[0] * ahead[:, 0]
        trailer = axle - self.hitch * ahead[:, 0] - (self.length - self.centres[1]) * ahead[:, 1]
        pose = np.concatenate([np.stack([car, trailer], axis=1), headings[..., None]], axis=-1)
        return pose, per_way * speeds, acceleration

    def _motion(self, times: Array) -> Trajectory:
        way = self._way(times)
        speed = self.speed * np.sqrt(self.apparent_mass(0.0) / self.apparent_mass(way))
        pose, twist, acceleration = self._moving(way, speed)
        return Trajectory(times, pose, twist, self.mechanism().reaction(pose, acceleration))
