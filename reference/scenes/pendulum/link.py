"""Exact motion of one link under gravity (swinging, whirling or on the separatrix) and of the point pendulum.

The angle from the downward vertical, counter-clockwise, satisfies angle'' = -f^2 sin(angle). With s = sin(angle/2) and
p = rate/(2f), the energy is s^2 + p^2 = k^2. The solutions are (Whittaker, Analytical Dynamics, 44)

    k < 1, swinging:  sin(angle/2) = k sn(f t + c, k),  rate = 2 f k cn,
    k > 1, whirling:  angle/2 = am(k f t + c, 1/k),     rate = 2 f k dn,
    k = 1, separatrix: both, with sn = tanh.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import LARGEST_ARRAY, NonNegative, Positive, Valid, require_room, validated
from reference.joints import Pin, bodies_of
from reference.mechanism import Mechanism
from reference.plane import swung
from reference.scene import Poses, Scene
from reference.trajectory import Trajectory
from reference.validators import Array

# Jacobi's elliptic functions are computed from the complementary parameter n = 1 - m with the parameter m = k^2. Near
# the separatrix, m = 1, the motion depends on the logarithm of n, which can't be computed from a rounded m. The method
# is the arithmetic-geometric mean (R. Bulirsch, "Numerical calculation of elliptic integrals and elliptic functions",
# Numerische Mathematik 7 (1965) 78-90).

# Relative difference of two iterates at which the arithmetic-geometric mean is accurate. The convergence is quadratic,
# so that the relative error is then the square of this number.
HALF_PRECISION = 1e-9


def quarter_period(complement: float) -> float:
    """K [1], the complete integral of the first kind, for 0 <= n <= 1; infinite for n = 0."""
    from scipy.special import elliprf

    # `incomplete` uses the same function, so that the start rate of a body released from rest is exactly zero.
    return float(elliprf(0.0, complement, 1.0))


def incomplete(sine: ArrayLike, cosine: ArrayLike, complement: float) -> Array:
    """F [1], the incomplete integral of the first kind, of the amplitude atan2(sine, cosine) in (-pi, pi].

    The arguments are the amplitude's sine and cosine, times any common factor, since an amplitude near pi/2 has too few
    digits if n is near 0. At n = 0 the cosine must be positive.
    """
    from scipy.special import elliprf

    sine, cosine = np.asarray(sine, dtype=float), np.asarray(cosine, dtype=float)
    size = np.hypot(sine, cosine)
    sine, cosine = sine / size, cosine / size
    # cos^2 + n sin^2 equals 1 - m sin^2 and has no cancellation.
    within = sine * elliprf(cosine**2, cosine**2 + complement * sine**2, 1.0)
    if complement == 0:
        return within
    return np.where(cosine >= 0, within, np.copysign(2 * quarter_period(complement), sine) - within)


def jacobi(argument: ArrayLike, complement: float) -> tuple[Array, Array, Array, Array]:
    """(sn, cn, dn, am) at the arguments, for 0 <= n <= 1; am, the amplitude [rad], is continuous (not wrapped)."""
    argument = np.asarray(argument, dtype=float)
    if complement == 0:
        sine, cosine = np.tanh(argument), 1 / np.cosh(argument)
        return sine, cosine, cosine, np.arctan(np.sinh(argument))
    quarter = quarter_period(complement)
    half_turns = np.round(argument / (2 * quarter))
    rest = argument - 2 * quarter * half_turns
    sign = np.where(half_turns % 2 == 0, 1.0, -1.0)
    # For arguments beyond K/2, K - argument is used, so that cn and dn have a small relative error near K.
    far = np.abs(rest) > quarter / 2
    sine, cosine, delta = _first_quarter(np.where(far, quarter - np.abs(rest), np.abs(rest)), complement)
    root = math.sqrt(complement)
    sine, cosine, delta = (
        np.where(far, cosine / delta, sine),
        np.where(far, root * sine / delta, cosine),
        np.where(far, root / delta, delta),
    )
    amplitude = np.copysign(np.arctan2(sine, cosine), rest) + math.pi * half_turns
    return sign * np.copysign(sine, rest), sign * cosine, delta, amplitude


def _first_quarter(argument: Array, complement: float) -> tuple[Array, Array, Array]:
    means, roots = [], []
    mean, root = 1.0, math.sqrt(complement)
    while True:
        means.append(mean)
        roots.append(root)
        if abs(mean - root) <= HALF_PRECISION * mean:
            break
        mean, root = (mean + root) / 2, math.sqrt(mean * root)
    angle = argument * (means[-1] + roots[-1]) / 2
    sine, cosine = np.sin(angle), np.cos(angle)
    nonzero = sine != 0
    cotangent = cosine / np.where(nonzero, sine, 1.0)
    scaled = cotangent * (means[-1] + roots[-1]) / 2
    delta = np.ones_like(argument)
    for mean, root in zip(reversed(means), reversed(roots), strict=True):
        product = cotangent * scaled
        scaled = scaled * delta
        delta = (root + product) / (mean + product)
        cotangent = scaled / mean
    size = 1 / np.sqrt(scaled**2 + 1)
    return np.where(nonzero, size, 0.0), np.where(nonzero, scaled * size, 1.0), np.where(nonzero, delta, 1.0)


@dataclass(frozen=True)
class Pendulum(Valid):
    """The exact motion of a pendulum from any start.

    `frequency` f [rad/s] of small swings, `angle` [rad] and `rate` [rad/s] at t = 0. The error of the angle is a few
    1e-16 (1 + f t), except near the separatrix. Near the separatrix the motion depends on 1 - k^2, which a rounded
    start determines only to about 1e-16. So the time of each passage of the top is uncertain by about 1e-16 / |1 - k^2|
    / f for any method. A start at rest has no such error, since 1 - k^2 is then cos(angle/2)^2.
    """

    frequency: Positive
    angle: float
    rate: float = 0.0

    @cached_property
    def _start(self) -> tuple[float, float, float, float, float]:
        """(direction, whole turns, s, c, p) of the start, mirrored to a positive rate and without whole turns."""
        direction = -1.0 if self.rate < 0 else 1.0
        rest = math.remainder(self.angle, 2 * math.pi)
        turns = round((self.angle - rest) / (2 * math.pi))
        sine, cosine = math.sin(rest / 2), math.cos(rest / 2)
        return direction, float(turns), direction * sine, cosine, abs(self.rate) / (2 * self.frequency)

    @cached_property
    def excess(self) -> float:
        """k^2 - 1 = (p - c)(p + c) [1], negative for swinging, positive for whirling, zero on the separatrix."""
        _, _, _, cosine, p = self._start
        return (p - cosine) * (p + cosine)

    @cached_property
    def modulus(self) -> float:
        """k [1]."""
        _, _, sine, _, p = self._start
        return math.hypot(sine, p)

    @property
    def kind(self) -> str:
        """The kind of motion: 'swinging', 'whirling' or 'separatrix'."""
        return "swinging" if self.excess < 0 else "whirling" if self.excess > 0 else "separatrix"

    @cached_property
    def _elliptic(self) -> tuple[float, float, float]:
        """(rate of the elliptic functions' argument [1/s], argument at t = 0, complementary parameter n)."""
        _, _, sine, cosine, p = self._start
        if self.excess > 0:
            complement = self.excess / self.modulus**2
            return self.modulus * self.frequency, float(incomplete(sine, cosine, complement)), complement
        complement = -self.excess
        start = float(incomplete(sine, p, complement)) if self.modulus > 0 else 0.0
        return self.frequency, start, complement

    @cached_property
    def period(self) -> float:
        """The period of a swing or the time of a whole turn [s], which is infinite on the separatrix."""
        speed, _, complement = self._elliptic
        return (2 if self.excess > 0 else 4) * quarter_period(complement) / speed

    @validated
    def motion(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        """Angle [rad] (not wrapped), rate [rad/s] and acceleration [rad/s^2] at times t [s] of any sign."""
        direction, turns, *_ = self._start
        speed, start, complement = self._elliptic
        t, cycles = np.asarray(t, dtype=float), np.zeros(np.shape(t))
        if math.isfinite(self.period):
            within = np.remainder(t, self.period)
            t, cycles = within, np.round((t - within) / self.period)
        sn, cn, dn, amplitude = jacobi(speed * t + start, complement)
        if self.excess > 0:
            half, rate, sine = amplitude + math.pi * cycles, dn, 2 * sn * cn
        else:
            half, rate, sine = np.arctan2(self.modulus * sn, dn), cn, 2 * self.modulus * sn * dn
        factor = 2 * self.frequency * self.modulus
        angle = direction * 2 * half + 2 * math.pi * turns
        return angle, direction * factor * rate, -direction * self.frequency**2 * sine

    @validated
    def passages(self, angle: float, until: NonNegative) -> Array:
        """The times [s] in [0, until] at which the pendulum's angle is `angle` [rad] plus any number of whole turns."""
        direction, *_ = self._start
        speed, start, complement = self._elliptic
        rest = direction * math.remainder(angle, 2 * math.pi)
        sine, cosine = math.sin(rest / 2), math.cos(rest / 2)
        if self.excess < 0:
            if abs(sine) >= self.modulus:
                return np.zeros(0)
            cosine = math.sqrt((self.modulus - sine) * (self.modulus + sine))
        first = float(incomplete(sine, cosine, complement))
        arguments = np.array([first])
        if math.isfinite(self.period):
            cycle = speed * self.period
            bases = [first] if self.excess > 0 else [first, cycle / 2 - first]
            turns = until / self.period + 4
            require_room("Pendulum.passages: the times", (len(bases), math.ceil(min(turns, LARGEST_ARRAY))))
            arguments = np.add.outer(bases, cycle * np.arange(-2, math.ceil(turns) - 2)).ravel()
        times = np.sort((arguments - start) / speed)
        return times[(times >= 0) & (times <= until)]


def direction_of(angle: NDArray[Any]) -> Any:
    """Unit vector (..., 2) from the pin down a link, for angles from the downward vertical, counter-clockwise [rad]."""
    return np.stack([np.sin(angle), -np.cos(angle)], axis=-1)


@dataclass(frozen=True)
class BarPendulum(Scene):
    """A uniform bar on a fixed pin at the origin.

    length [m], mass [kg], gravity [m/s^2], angle [rad] and rate [rad/s] at the start.
    """

    name: ClassVar[str] = "pendulum_1"
    source: ClassVar[str] = "section 18.5, closed kinematic chains: a pendulum (1 link)"
    length: Positive = 1.0
    mass: Positive = 1.0
    gravity: Positive = 9.81
    angle: float = 2.0
    rate: float = 0.0
    duration: Positive = 10.0
    horizon: Positive = 10.0  # an error of the energy causes a phase error that is linear in time

    @cached_property
    def pendulum(self) -> Pendulum:
        """The pendulum of the bar's angle with f^2 = m g (l/2) / (m l^2/3)."""
        return Pendulum(math.sqrt(1.5 * self.gravity / self.length), self.angle, self.rate)

    def mechanism(self) -> Mechanism:
        pose, twist, _ = self._bar(np.zeros(1))
        inertia = self.mass * self.length**2 / 12
        bar = bodies_of(("link 1",), (self.mass,), (inertia,), pose, twist)
        joint = Pin("joint 1", None, "link 1", (0.0, 0.0), (-self.length / 2, 0.0))
        return Mechanism(bar, (joint,), (0.0, -self.gravity))

    def _bar(self, t: Array) -> tuple[Array, Array, Array]:
        angle, rate, acceleration = self.pendulum.motion(t)
        return swung(self.length / 2 * direction_of(angle), angle - math.pi / 2, rate, acceleration)

    def _motion(self, times: Array) -> Trajectory:
        pose, twist, acceleration = self._bar(times)
        reaction = self.mass * (acceleration[:, :2] + np.array([0.0, self.gravity]))
        return Trajectory(times, pose[:, None], twist[:, None], reaction)


@dataclass(frozen=True)
class PointPendulum(BarPendulum):
    """The classical point pendulum from horizontal, a test of phase: 845 periods in 2000 s (IFToMM benchmark A01).

    A rigid body can't be a point. A uniform bar with 3/2 of the length has its centre of oscillation (Huygens) at the
    point mass, and moves exactly like the point pendulum. The benchmark's output is that point of the bar, `bob`.
    """

    name: ClassVar[str] = "point_pendulum"
    source: ClassVar[str] = "IFToMM library of computational benchmark problems, A01 simple pendulum; section 18.5"
    length: Positive = 1.5
    angle: float = math.pi / 2
    duration: Positive = 2000.0
    horizon: Positive = 2000.0

    @property
    def samples(self) -> int:
        """The benchmark has two samples per second."""
        return max(1, round(2 * self.duration))

    @validated
    def bob(self, pose: Poses) -> Array:
        """Position (..., 2) [m] of the bar's point at 2/3 of its length for poses (..., 1, 3)."""
        angle = pose[..., 0, 2] + math.pi / 2
        return pose[..., 0, :2] + (2 / 3 - 1 / 2) * self.length * direction_of(angle)
