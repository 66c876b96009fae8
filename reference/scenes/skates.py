"""Exact motions of a body on a pin, on a skate, on a skate on a slope, and at rest on several skates.

The skate's speed u along i' and the turning rate w satisfy u' = a w^2 and (I + m a^2) w' = -m a u w, where the centre
of mass is at a ahead of the skate (Neimark and Fufaev, Dynamics of Nonholonomic Systems). With k^2 = (I + m a^2)/m the
energy m (u^2 + k^2 w^2)/2 = m V^2/2 is constant. The solution is u = V tanh p and w = (V/k) sech p, p = c + a V t/k^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, NonNegative, Positive, validated
from reference.joints import Pin, Skate, Triple, Vector, bodies_of
from reference.mechanism import Body, Mechanism
from reference.numerics.calculus import Antiderivative
from reference.plane import components, rotated, swung
from reference.scene import PlacedScene, Scene
from reference.scenes.pendulum.link import Pendulum
from reference.trajectory import Trajectory
from reference.validators import Array


def one_body(scene: Scene, mass: float, inertia: float, joint: Pin | Skate, gravity: Vector = (0.0, 0.0)) -> Mechanism:
    """The mechanism of one body with a joint to the ground, at the start of the scene's motion."""
    start, name = scene.motion(0.0), joint.second or ""
    return Mechanism(bodies_of((name,), (mass,), (inertia,), start.pose[0], start.twist[0]), (joint,), gravity)


@dataclass(frozen=True)
class PinnedBody(Scene):
    """A body on a pin, which is a pendulum with frequency^2 = m g r / (I + m r^2).

    mass [kg], inertia [kg m^2] about the centre of mass; `point` [m] of the body, from the centre of mass, is pinned at
    `pin` [m]; angle [rad] of the body and turning_rate [rad/s] at t = 0; gravity [m/s^2] in any direction, or zero.
    """

    name: ClassVar[str] = "pinned_body"
    source: ClassVar[str] = "box 18.3, eqs. 18.62-18.63"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    point: Vector = (-0.5, 0.0)
    pin: Vector = (0.0, 0.0)
    angle: float = 0.5
    turning_rate: float = 2.0
    gravity: Vector = (0.0, -9.81)
    duration: Positive = 3.0
    horizon: Positive = 3.0  # an error of the energy causes a phase error that is linear in time

    @cached_property
    def _lag(self) -> float:
        """The pendulum's angle from the direction of gravity minus the body's angle [rad]."""
        return math.atan2(-self.point[1], -self.point[0]) - math.atan2(self.gravity[1], self.gravity[0])

    @cached_property
    def frequency(self) -> float:
        """The rate of small swings [rad/s], which is zero without gravity or for a pin at the centre of mass."""
        arm, pull = math.hypot(*self.point), math.hypot(*self.gravity)
        return math.sqrt(self.mass * pull * arm / (self.inertia + self.mass * arm**2))

    def _turning(self, t: Array) -> tuple[Array, Array, Array]:
        if self.frequency == 0:
            return self.angle + self.turning_rate * t, np.full(t.shape, self.turning_rate), np.zeros(t.shape)
        pendulum = Pendulum(self.frequency, self.angle + self._lag, self.turning_rate)
        angle, rate, acceleration = pendulum.motion(t)
        return angle - self._lag, rate, acceleration

    def mechanism(self) -> Mechanism:
        return one_body(self, self.mass, self.inertia, Pin("pin", None, "body", self.pin, self.point), self.gravity)

    def _motion(self, times: Array) -> Trajectory:
        angle, rate, acceleration = self._turning(times)
        # The arm from the pin to the centre of mass is by (18.63).
        pose, twist, linear = swung(-rotated(angle, np.array(self.point)), angle, rate, acceleration)
        pose[:, :2] += self.pin
        return Trajectory(times, pose[:, None], twist[:, None], self.mass * (linear[:, :2] - self.gravity))


@dataclass(frozen=True)
class FreelyPinnedBody(PinnedBody):
    """The pinned body without gravity, whose rate is constant."""

    name: ClassVar[str] = "pinned_body_free"

    gravity: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class ChaplyginSleigh(Scene):
    """Chaplygin's sleigh: a body that slides on one skate.

    mass [kg]; inertia [kg m^2] about the centre of mass. The centre of mass is `offset` [m] ahead of the skate, or
    behind the skate if negative. speed [m/s] along the skate and turning_rate [rad/s] at t = 0 have any sign. start:
    the skate's pose. A point mass, with zero inertia, has a motion but no mechanism. Raises InvalidMechanism if inertia
    and offset are zero.
    """

    name: ClassVar[str] = "sleigh"
    source: ClassVar[str] = "box 18.3, eqs. 18.64-18.65; ideal wheels and skates, looking down"

    mass: Positive = 2.0
    inertia: NonNegative = 0.3
    offset: float = 0.5
    speed: float = 1.0
    turning_rate: float = 2.0
    start: Triple = (0.0, 0.0, 0.0)
    duration: Positive = 3.0
    horizon: Positive = 3.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.inertia == 0 and self.offset == 0:
            raise InvalidMechanism(
                f"{self._owner()}: inertia and offset are both 0, so nothing resists turning; "
                "one of them must differ from zero"
            )

    @cached_property
    def _arm(self) -> float:
        """The radius of gyration k about the skate [m]."""
        return math.hypot(math.sqrt(self.inertia / self.mass), self.offset)

    @cached_property
    def _top_speed(self) -> float:
        """The speed V of a straight motion with the same energy [m/s]."""
        return math.hypot(self.speed, self._arm * self.turning_rate)

    @cached_property
    def _phase(self) -> float:
        return math.asinh(self.speed / (self._arm * abs(self.turning_rate)))

    def growth_rate(self) -> float:
        """The rate [1/s] at which a small turning rate grows exponentially in straight motion at this speed.

        By w' = -(m a u / (I + m a^2)) w, the rate is positive if the centre of mass is behind the skate in the
        direction of travel.
        """
        return -self.offset * self.speed / self._arm**2

    @validated
    def rates(self, t: ArrayLike) -> tuple[Array, Array]:
        """The skate's speed u [m/s] and the turning rate w [rad/s] at times t."""
        t = np.asarray(t, dtype=float)
        if self.turning_rate == 0 or self.offset == 0:
            return np.full(t.shape, self.speed), np.full(t.shape, self.turning_rate)
        phase = self._phase + self.offset * self._top_speed / self._arm**2 * t
        decayed = np.exp(-np.abs(phase))
        sech = 2 * decayed / (1 + decayed**2)
        return self._top_speed * np.tanh(phase), math.copysign(self._top_speed / self._arm, self.turning_rate) * sech

    @validated
    def heading(self, t: ArrayLike) -> Array:
        """theta [rad] at times t, not wrapped, from the difference of Gudermannians k/a (gd p - gd c).

        The identity gd(c + 2 s) - gd c = 2 atan(sinh s / cosh(c + s)) has no cancellation.
        """
        t = np.asarray(t, dtype=float)
        if self.turning_rate == 0 or self.offset == 0:
            return self.start[2] + self.turning_rate * t
        half = 0.5 * self.offset * self._top_speed / self._arm**2 * t
        middle = np.abs(self._phase + half)
        # This is |half| - |phase + half| without cancellation at late times.
        same = half * (self._phase + half) >= 0
        lead = np.sign(half) * np.where(same, -self._phase, self._phase + 2 * half)
        ratio = np.exp(lead) * -np.expm1(-2 * np.abs(half)) / (1 + np.exp(-2 * middle))
        turned = 2 * self._arm / abs(self.offset) * np.arctan(ratio)
        return self.start[2] + math.copysign(1.0, self.turning_rate) * turned

    @cached_property
    def _settled(self) -> float:
        """The time [s] after which the motion is straight to rounding and needs no quadrature."""
        phase = math.copysign(45 + 2 * math.log1p(self._arm / abs(self.offset)), self.offset)
        return max(0.0, (phase - self._phase) * self._arm**2 / (self.offset * self._top_speed))

    @cached_property
    def _moved(self) -> Antiderivative:
        def velocity(t: Array) -> NDArray[Any]:
            return self.rates(t)[0] * np.exp(1j * (self.heading(t) - self.start[2]))

        fastest = self._top_speed / self._arm * max(1.0, abs(self.offset) / self._arm)
        return Antiderivative(velocity, 1 / fastest if fastest > 0 else 1.0)

    def skate_pose(self, t: ArrayLike) -> Array:
        """Poses of the skate (times, 3), with the position by quadrature to rounding."""
        return self._skate_pose(self.times(t))

    def _skate_pose(self, t: Array) -> Array:
        heading, (x, y, angle) = self.heading(t), self.start
        if self.turning_rate == 0 or self.offset == 0:
            half = 0.5 * self.turning_rate * t
            moved = self.speed * t * np.sinc(half / np.pi) * np.exp(1j * (half + angle))
        else:
            early = np.minimum(t, self._settled)
            straight = math.copysign(self._top_speed, self.offset) * (t - early) * np.exp(1j * (heading - angle))
            moved = (self._moved(early) + straight) * np.exp(1j * angle)
        return np.stack([x + np.real(moved), y + np.imag(moved), heading], axis=-1)

    def lateral_force(self, t: ArrayLike) -> Array:
        """The skate's force I u w / k^2 [N] on the body, to the left of the heading."""
        return self._lateral_force(*self.rates(self.times(t)))

    def _lateral_force(self, speed: Array, turning_rate: Array) -> Array:
        return self.inertia * speed * turning_rate / self._arm**2

    def mechanism(self) -> Mechanism:
        return one_body(self, self.mass, self.inertia, Skate("skate", None, "sleigh", (-self.offset, 0.0)))

    def _motion(self, times: Array) -> Trajectory:
        pose, (speed, turning) = self._skate_pose(times), self.rates(times)
        twist = np.stack([*components(pose[:, 2], speed, self.offset * turning), turning], axis=-1)
        pose[:, :2] += rotated(pose[:, 2], np.array([self.offset, 0.0]))
        return Trajectory(times, pose[:, None], twist[:, None], self._lateral_force(speed, turning)[:, None])


@dataclass(frozen=True)
class SleighBackwards(ChaplyginSleigh):
    """A sleigh with the centre of mass behind the skate: a small turning rate grows until the sleigh turns."""

    name: ClassVar[str] = "sleigh_backwards"

    speed: float = -1.0
    turning_rate: float = 1e-3
    duration: Positive = 10.0
    horizon: Positive = 0.8  # 1 / growth rate


@dataclass(frozen=True)
class SkateOnSlope(Scene):
    """A body with its skate under the centre of mass on an incline.

    No moment acts, so theta = heading + turning_rate t. The acceleration along the blade is u' = -gravity sin theta.
    The path is a cycloid and does not descend in the mean (Neimark and Fufaev). With turning_rate 0 and the blade
    across the slope (heading 0) the body is at rest, and the blade's force is m g. mass [kg], inertia [kg m^2]; gravity
    [m/s^2] along the incline, to -y; speed [m/s] along the blade at t = 0.
    """

    name: ClassVar[str] = "skate_on_slope"
    source: ClassVar[str] = "box 18.3, eq. 18.64, under gravity"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    gravity: float = 1.0
    heading: float = 0.0
    speed: float = 0.0
    turning_rate: float = 0.0
    duration: Positive = 5.0
    horizon: Positive = 5.0

    def mechanism(self) -> Mechanism:
        blade = Skate("blade", None, "skate", (0.0, 0.0))
        return one_body(self, self.mass, self.inertia, blade, (0.0, -self.gravity))

    def _motion(self, times: Array) -> Trajectory:
        t, first, rate = times, self.heading, self.turning_rate
        angle, half = first + rate * t, 0.5 * rate * t
        # (cos theta - cos first)/rate = -t sin(first + half) sinc(half) has no cancellation at a small rate.
        chord = t * np.sinc(half / math.pi)
        speed = self.speed - self.gravity * chord * np.sin(first + half)
        pose = np.stack([*self._path(t), angle], axis=-1)
        twist = np.stack([speed * np.cos(angle), speed * np.sin(angle), np.full_like(t, rate)], axis=-1)
        force = self.mass * (speed * rate + self.gravity * np.cos(angle))
        return Trajectory(t, pose[:, None], twist[:, None], force[:, None])

    def _path(self, t: Array) -> tuple[Array, Array]:
        first, rate, pull = self.heading, self.turning_rate, self.gravity
        if abs(rate) * float(t.max(initial=0.0)) < 1:
            # The closed form divides by the rate's square. Within a radian, Gauss quadrature is exact.
            nodes, weights = np.polynomial.legendre.leggauss(12)
            when = 0.5 * t[..., None] * (1 + nodes)
            angle, half = first + rate * when, 0.5 * rate * when
            speed = self.speed - pull * when * np.sinc(half / math.pi) * np.sin(first + half)
            share = 0.5 * t[..., None] * weights * speed
            return np.sum(share * np.cos(angle), axis=-1), np.sum(share * np.sin(angle), axis=-1)
        angle = first + rate * t
        chord = 2 * np.sin(0.5 * rate * t) / rate  # chord of a circle at unit speed
        middle = first + 0.5 * rate * t
        # u = free + (pull/rate) cos theta with free = speed - (pull/rate) cos first.
        free = self.speed - pull / rate * math.cos(first)
        twice = (np.sin(2 * angle) - math.sin(2 * first)) / (4 * rate)
        x = free * chord * np.cos(middle) + pull / rate * (0.5 * t + twice)
        y = free * chord * np.sin(middle) + pull / rate * (np.sin(angle) ** 2 - math.sin(first) ** 2) / (2 * rate)
        return x, y


@dataclass(frozen=True)
class HeldBySkates(PlacedScene):
    """A body at rest on a slope, whose skates remove all freedoms of velocity.

    Two skates always leave one freedom, since their axles intersect in the centre of rotation or are parallel. A third
    skate removes this freedom. points [m] from the centre of mass; angles [rad] of the blades relative to the body;
    gravity [m/s^2] along the incline, to -y. Raises InvalidMechanism if a freedom remains.
    """

    name: ClassVar[str] = "held_by_skates"
    source: ClassVar[str] = "box 18.3, degrees of freedom by rank"

    mass: Positive = 2.0
    inertia: Positive = 0.3
    points: tuple[Vector, ...] = ((0.5, 0.0), (-0.5, 0.0), (0.0, 0.4))
    angles: tuple[float, ...] = (0.5, -0.5, 1.5)
    gravity: float = 1.0
    pose: Triple = (0.0, 0.0, 0.3)
    duration: Positive = 3.0
    horizon: Positive = 3.0

    def __post_init__(self) -> None:
        super().__post_init__()
        if len(self.points) != len(self.angles):
            counts = f"{len(self.points)} points and {len(self.angles)} angles"
            raise InvalidMechanism(f"{self._owner()}: {counts}; each skate has one")
        _, freedoms = self.mechanism().degrees_of_freedom()
        if freedoms:
            raise InvalidMechanism(
                f"{self._owner()}: these {len(self.points)} skates leave {freedoms} freedom of velocity, so the body "
                "moves; their axles must not all be parallel or meet in one point"
            )

    def mechanism(self) -> Mechanism:
        joints = tuple(
            Skate(f"skate {index + 1}", None, "body", point, angle)
            for index, (point, angle) in enumerate(zip(self.points, self.angles, strict=True))
        )
        return Mechanism((Body("body", self.mass, self.inertia, self.pose),), joints, (0.0, -self.gravity))

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        zero = np.zeros((len(times), 1, 3))
        return zero + self.pose, zero, zero
