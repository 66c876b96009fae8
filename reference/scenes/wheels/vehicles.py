"""Coasting vehicles: a car with locked steering and a trailer, and a cart on free casters.

The car has one freedom of velocity, the speed v of its rear axle along a circle. The energy M(s) v^2/2 gives the speed
at the distance s. The trailer is a towed drawbar (`trailers.Tow`) whose hitch moves on a circle. The function t(s) =
int sqrt(M(s)/M(0)) ds / v(0) is inverted, and no equation of motion is solved.

A caster is a drawbar towed by a kingpin, and it swings round in reverse. The wheel is `trail` c behind the kingpin. The
kingpin is at (x, y) from the middle of the rear axle, which has the speed u and the turning rate w; With the caster's
direction beta (wheel to kingpin) relative to the cart, w + beta' = (x w cos beta - (u - y w) sin beta)/c.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Complexes, InvalidMechanism, Positive, Times, Valid, index_of, sample_times, validated
from reference.embedding import EmbeddedScene
from reference.joints import Joint, Pin, Skate, Triple, Vector, bodies_of
from reference.mechanism import Mechanism
from reference.numerics.calculus import Antiderivative
from reference.numerics.integration import Integrated, error_of, integrate
from reference.numerics.roots import solve_increasing
from reference.plane import COMPLEX_STEP, components
from reference.scene import PlacedScene
from reference.scenes.wheels.trailers import Input, Tow, input_at, towed
from reference.validators import Array


@dataclass(frozen=True)
class CarAndTrailer(PlacedScene):
    """A coasting car with locked steering, and its trailer.

    For the car and the trailer: masses [kg], inertias [kg m^2] and centres of mass [m] ahead of the axle. wheelbase
    [m]; steering [rad] of the front wheel; hitch [m] behind the car's rear axle; length [m] from hitch to the trailer's
    axle. At t = 0: speed [m/s] of the rear axle (negative speed is backwards and unstable), bend [rad], which is the
    trailer's heading minus the car's heading, and pose of the rear axle. The two wheels of an axle have dependent rows,
    so one wheel is modelled. With `redundant` both wheels are modelled, `track` [m] apart. Raises InvalidMechanism for
    steering of a right angle or more.
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
            raise InvalidMechanism(
                f"{self._owner()}: steering is {self.steering!r} rad; it must be below a right angle"
            )

    @property
    def curvature(self) -> float:
        """The curvature of the rear axle's circle [1/m]: tan(steering)/wheelbase."""
        return math.tan(self.steering) / self.wheelbase

    @cached_property
    def _tow(self) -> tuple[Tow, float, float]:
        """The drawbar, the hitch's path per metre of the rear axle's path, and the offset of the heading [rad]."""
        pace = math.hypot(1.0, self.hitch * self.curvature)
        direction = self.pose[2] - math.atan(self.hitch * self.curvature)
        heading = self.pose[2] + self.bend
        angle = math.remainder(heading - direction, 2 * math.pi)
        radius = pace / self.curvature if self.curvature else math.inf
        return Tow(self.length, angle, radius, (0.0, 0.0, direction)), pace, heading - direction - angle

    def _headings(self, way: Array) -> Array:
        tow, pace, turns = self._tow
        return np.stack([self.pose[2] + self.curvature * way, tow.heading(pace * way) + turns], axis=-1)

    def _per_way(self, headings: NDArray[Any]) -> NDArray[Any]:
        """Twists (..., 2 bodies, 3) at a speed of 1 m/s, analytic in the headings."""
        (car, trailer), (car_centre, trailer_centre) = np.moveaxis(headings, -1, 0), self.centres
        speed, turning = towed(1.0, self.curvature, car - trailer, self.hitch, self.length)
        out = []
        for heading, v, w, centre in (
            (car, 1.0, self.curvature + 0 * car, car_centre),
            (trailer, speed, turning, trailer_centre),
        ):
            cosine, sine = np.cos(heading), np.sin(heading)
            out.append(np.stack([v * cosine - centre * w * sine, v * sine + centre * w * cosine, w], axis=-1))
        return np.stack(out, axis=-2)

    @property
    def _weights(self) -> Array:
        return np.array([(mass, mass, inertia) for mass, inertia in zip(self.masses, self.inertias, strict=True)])

    @validated
    def apparent_mass(self, way: ArrayLike) -> Array:
        """M(s) [kg], which is twice the kinetic energy at a speed of 1 m/s of the rear axle."""
        per_way = self._per_way(self._headings(np.asarray(way, dtype=float)))
        return np.sum(self._weights * per_way**2, axis=(-2, -1))

    @cached_property
    def _stretch(self) -> Antiderivative:
        sign, first = math.copysign(1.0, self.speed), float(self.apparent_mass(0.0))
        shortest = min(self.length, 1 / (abs(self.curvature) + 1e-9))
        return Antiderivative(lambda r: np.sqrt(self.apparent_mass(sign * r) / first), shortest)

    def _way(self, times: Array) -> Array:
        sign, first = math.copysign(1.0, self.speed), float(self.apparent_mass(0.0))
        goal = abs(self.speed) * times

        def stretch(way: Array) -> tuple[Array, Array]:
            return self._stretch(way), np.sqrt(self.apparent_mass(sign * way) / first)

        return sign * solve_increasing(stretch, goal, goal, self.wheelbase, (0.0, math.inf))

    def mechanism(self) -> Mechanism:
        start = self._moving(np.zeros(1), np.array([self.speed]))
        names = ("car", "trailer")
        bodies = bodies_of(names, self.masses, self.inertias, start[0][0], start[1][0])
        (car_centre, trailer_centre), half = self.centres, self.track / 2
        joints: list[Joint] = [
            Skate("front wheel", None, "car", (self.wheelbase - car_centre, 0.0), self.steering),
            Pin("hitch", "car", "trailer", (-car_centre - self.hitch, 0.0), (self.length - trailer_centre, 0.0)),
        ]
        for name, centre in zip(names, self.centres, strict=True):
            if self.redundant:
                joints.append(Skate(f"{name}'s left wheel", None, name, (-centre, half)))
                joints.append(Skate(f"{name}'s right wheel", None, name, (-centre, -half)))
            else:
                joints.append(Skate(f"{name}'s axle", None, name, (-centre, 0.0)))
        return Mechanism(bodies, tuple(joints))

    def _moving(self, way: Array, speed: Array) -> tuple[Array, Array, Array]:
        headings = self._headings(way)
        per_way = self._per_way(headings)
        turning = headings + 1j * COMPLEX_STEP * per_way[..., 2]  # per metre
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

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        way = self._way(times)
        return self._moving(way, self.speed * np.sqrt(self.apparent_mass(0.0) / self.apparent_mass(way)))


@dataclass(frozen=True)
class Casters(Valid):
    """Casters of equal trail [m]; `places` [m] of the kingpins are ahead and left of the fixed axle's middle."""

    places: tuple[Vector, ...]
    trail: Positive

    @validated
    def turning_rates(self, angles: Complexes, speed: Complexes, turning_rate: Complexes) -> Any:
        """The casters' rates w + beta' (..., casters) [rad/s] in the world, at angles beta (..., casters) [rad]."""
        x, y = np.array(self.places, dtype=float).T
        speed, turning_rate = np.asarray(speed)[..., None], np.asarray(turning_rate)[..., None]
        return (x * turning_rate * np.cos(angles) - (speed - y * turning_rate) * np.sin(angles)) / self.trail

    @validated
    def tow(self, caster: int, angle: float, speed: float, turning_rate: float) -> tuple[Tow, float]:
        """The caster as a `Tow` for a constant speed and turning rate, and the kingpin's speed [m/s].

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
        """Angles beta (times, casters) [rad, not wrapped] from `angles` at t = 0, and a bound (times,) on their error.

        speed [m/s] and turning_rate [rad/s] of the cart are numbers or functions of time. In reverse the caster swings
        round from a small angle to pi; an angle of exactly zero is an unstable equilibrium.
        """
        times = sample_times("casters", t)

        def rates(state: Array) -> Array:
            time = state[..., 0]
            w = input_at(turning_rate, time)
            relative = self.turning_rates(state[..., 1:], input_at(speed, time), w) - w[..., None]
            return np.concatenate([np.ones((*time.shape, 1)), relative], axis=-1)

        first = np.array([0.0, *angles])
        last = float(times.max(initial=0.0))
        if last == 0:
            return np.broadcast_to(first[1:], (len(times), len(angles))).copy(), np.zeros(len(times))
        return integrate(rates, first, last)(times)[:, 1:], error_of(rates, first, times)


@dataclass(frozen=True)
class Cart(EmbeddedScene):
    """A coasting cart on two free casters.

    c is x, y and theta of the axle's middle and the casters' directions in the world; nu is (speed, turning rate). mass
    [kg] and inertia [kg m^2] of the cart; its centre of mass is `centre` [m] ahead of the axle. The kingpins are
    `front` [m] ahead of the axle and `width` [m] apart. A caster's wheel is `trail` [m] and its centre of mass
    `caster_centre` [m] behind the kingpin. At t = 0: speed [m/s] and turning_rate [rad/s] of the axle, and angles [rad]
    of the casters relative to the cart, which are 0 if the wheel is behind the kingpin. The two wheels of the fixed
    axle have dependent rows, so one wheel is modelled. With `redundant` both wheels are modelled.
    """

    name: ClassVar[str] = "cart"
    source: ClassVar[str] = "section 18.5, contact with ideal wheels and skates; box 18.3"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    centre: float = 0.4
    front: float = 0.7
    width: Positive = 0.4
    trail: Positive = 0.1
    caster_mass: Positive = 0.1
    caster_inertia: Positive = 1e-3
    caster_centre: float = 0.05
    speed: float = 1.0
    turning_rate: float = 1.0
    angles: tuple[float, float] = (1.5, -2.5)
    pose: Triple = (0.0, 0.0, 0.0)
    redundant: bool = False
    duration: Positive = 3.0
    horizon: Positive = 3.0

    @property
    def casters(self) -> Casters:
        return Casters(((self.front, self.width / 2), (self.front, -self.width / 2)), self.trail)

    @property
    def start(self) -> Array:
        directions = [self.pose[2] + angle for angle in self.angles]
        return np.array([*self.pose, *directions, self.speed, self.turning_rate])

    @property
    def freedoms(self) -> int:
        return 2

    def coordinate_rates(self, coordinates: NDArray[Any], velocities: NDArray[Any]) -> NDArray[Any]:
        heading, directions = coordinates[..., 2], coordinates[..., 3:]
        speed, turning = velocities[..., 0], velocities[..., 1]
        swinging = self.casters.turning_rates(directions - heading[..., None], speed, turning)
        moved = np.stack([speed * np.cos(heading), speed * np.sin(heading), turning], axis=-1)
        return np.concatenate([moved, swinging], axis=-1)

    def tangent(self, coordinates: Any) -> tuple[Any, Any]:
        heading, directions = coordinates[..., 2], coordinates[..., 3:]
        ahead = components(heading, self.centre, 0.0)
        poses = [np.stack([coordinates[..., 0] + ahead[0], coordinates[..., 1] + ahead[1], heading], axis=-1)]
        for index, (x, y) in enumerate(self.casters.places):
            kingpin = components(heading, x, y)
            behind = components(directions[..., index], self.caster_centre, 0.0)
            centre = [coordinates[..., axis] + kingpin[axis] - behind[axis] for axis in (0, 1)]
            poses.append(np.stack([*centre, directions[..., index]], axis=-1))
        columns = []
        for speed, turning in ((1.0, 0.0), (0.0, 1.0)):
            rates = self.casters.turning_rates(directions - heading[..., None], speed, turning)
            parts = [*components(heading, speed, self.centre * turning), turning + 0 * heading]
            for index, (x, y) in enumerate(self.casters.places):
                kingpin = components(heading, speed - y * turning, x * turning)
                swung = components(directions[..., index], 0.0, -self.caster_centre * rates[..., index])
                parts += [kingpin[0] + swung[0], kingpin[1] + swung[1], rates[..., index]]
            columns.append(np.stack(parts, axis=-1))
        return np.stack(poses, axis=-2), np.stack(columns, axis=-1)

    def solved(self, until: float) -> Integrated:
        return integrate(self.rates, self.start, until)

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound (times,) on the error of the motion [m, rad], from the difference to a larger tolerance."""
        return error_of(self.rates, self.start, self.times(t))

    def mechanism(self) -> Mechanism:
        coordinates, velocities = self._split(self.start)
        poses, tangent = self.tangent(coordinates)
        twists = (tangent @ velocities).reshape(3, 3)
        masses = (self.mass, self.caster_mass, self.caster_mass)
        inertias = (self.inertia, self.caster_inertia, self.caster_inertia)
        names = ("cart", "left caster", "right caster")
        bodies = bodies_of(names, masses, inertias, poses, twists)
        joints: list[Joint] = [Skate("axle", None, "cart", (-self.centre, 0.0))]
        if self.redundant:
            joints = [
                Skate("left wheel", None, "cart", (-self.centre, self.width / 2)),
                Skate("right wheel", None, "cart", (-self.centre, -self.width / 2)),
            ]
        for name, (x, y) in zip(names[1:], self.casters.places, strict=True):
            joints.append(Pin(f"{name}'s kingpin", "cart", name, (x - self.centre, y), (self.caster_centre, 0.0)))
            joints.append(Skate(f"{name}'s wheel", None, name, (self.caster_centre - self.trail, 0.0)))
        return Mechanism(bodies, tuple(joints))
