"""Chaplygin's sleigh: a body on one ideal skate, with its centre of mass ahead of or behind it, coasting; exact.

With u the skate's speed along i', w the turning rate, a the offset of the centre of mass ahead of the skate:
u' = a w^2, (I + m a^2) w' = -m a u w (Neimark and Fufaev, Dynamics of Nonholonomic Systems). With k^2 = (I + m a^2)/m
the energy m (u^2 + k^2 w^2)/2 = m V^2/2 is constant, and u = V tanh p, w = (V/k) sech p with p = c + a V t/k^2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, NonNegative, Positive, validated
from reference.joints import Skate, Triple
from reference.mechanism import Body, Mechanism
from reference.numerics.calculus import Antiderivative
from reference.scene import Scene
from reference.trajectory import Trajectory

Array = NDArray[np.float64]


@dataclass(frozen=True)
class ChaplyginSleigh(Scene):
    """mass [kg], inertia [kg m^2] about the centre of mass, which is `offset` [m] ahead of the skate (< 0: behind).

    speed [m/s] of the skate along its heading and turning_rate [rad/s] at t = 0, of either sign or zero; start is the
    skate's pose. Zero inertia is a point mass: its motion is known, but no mechanism of bodies can have it. Raises
    InvalidMechanism for numbers not finite, mass not positive, or an inertia of zero with an offset of zero.
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
        """k, the radius of gyration about the skate [m]."""
        return math.hypot(math.sqrt(self.inertia / self.mass), self.offset)

    @cached_property
    def _top_speed(self) -> float:
        """V, the speed when all the energy is in sliding [m/s]."""
        return math.hypot(self.speed, self._arm * self.turning_rate)

    @cached_property
    def _phase(self) -> float:
        """c; only used when the sleigh turns."""
        return math.asinh(self.speed / (self._arm * abs(self.turning_rate)))

    def growth_rate(self) -> float:
        """The rate of exp(rate t) at which a small turning grows on the straight run at this speed [1/s].

        w' = -(m a u / (I + m a^2)) w: with the centre of mass behind the skate in the sense of travel it grows, and the
        sleigh turns round.
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
        """theta at times t [rad, not wrapped]: a difference of Gudermannians, k/a (gd p - gd c), free of cancellation.

        gd(c + 2 s) - gd c = 2 atan(sinh s / cosh(c + s)).
        """
        t = np.asarray(t, dtype=float)
        if self.turning_rate == 0 or self.offset == 0:
            return self.start[2] + self.turning_rate * t
        half = 0.5 * self.offset * self._top_speed / self._arm**2 * t
        middle = np.abs(self._phase + half)
        # |half| - |phase + half|, without the cancellation of a late time.
        same = half * (self._phase + half) >= 0
        lead = np.sign(half) * np.where(same, -self._phase, self._phase + 2 * half)
        ratio = np.exp(lead) * -np.expm1(-2 * np.abs(half)) / (1 + np.exp(-2 * middle))
        turned = 2 * self._arm / abs(self.offset) * np.arctan(ratio)
        return self.start[2] + math.copysign(1.0, self.turning_rate) * turned

    @cached_property
    def _settled(self) -> float:
        """When it slides straight to far below rounding [s]: a stiff sleigh would else need panels without end."""
        phase = math.copysign(45 + 2 * math.log1p(self._arm / abs(self.offset)), self.offset)
        return max(0.0, (phase - self._phase) * self._arm**2 / (self.offset * self._top_speed))

    @cached_property
    def _moved(self) -> Antiderivative:
        def velocity(t: Array) -> NDArray[Any]:
            return self.rates(t)[0] * np.exp(1j * (self.heading(t) - self.start[2]))

        fastest = self._top_speed / self._arm * max(1.0, abs(self.offset) / self._arm)
        return Antiderivative(velocity, 1 / fastest if fastest > 0 else 1.0)

    def skate_pose(self, t: ArrayLike) -> Array:
        """Pose of the skate (times, 3); heading in closed form, position by quadrature to rounding of the distance."""
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
        """The skate's force on the body, to the left of its heading [N]: I u w / k^2."""
        return self._lateral_force(*self.rates(self.times(t)))

    def _lateral_force(self, speed: Array, turning_rate: Array) -> Array:
        return self.inertia * speed * turning_rate / self._arm**2

    def mechanism(self) -> Mechanism:
        motion = self.motion(0.0)
        pose, twist = motion.pose[0, 0].tolist(), motion.twist[0, 0].tolist()
        body = Body("sleigh", self.mass, self.inertia, tuple(pose), tuple(twist))
        return Mechanism((body,), (Skate("skate", None, "sleigh", (-self.offset, 0.0)),))

    def _motion(self, times: Array) -> Trajectory:
        t = times
        pose = self._skate_pose(t)
        speed, turning = self.rates(t)
        cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
        across = self.offset * turning
        centre = pose + np.stack([self.offset * cosine, self.offset * sine, np.zeros_like(t)], axis=-1)
        twist = np.stack([speed * cosine - across * sine, speed * sine + across * cosine, turning], axis=-1)
        return Trajectory(t, centre[:, None, :], twist[:, None, :], self._lateral_force(speed, turning)[:, None])


@dataclass(frozen=True)
class SleighBackwards(ChaplyginSleigh):
    """The sleigh sliding with its centre of mass behind the skate: a small turning grows, until it has turned round."""

    name: ClassVar[str] = "sleigh_backwards"

    speed: float = -1.0
    turning_rate: float = 1e-3
    duration: Positive = 10.0
    horizon: Positive = 0.8  # 1 / growth rate: later, errors grow exponentially until the sleigh has turned round
