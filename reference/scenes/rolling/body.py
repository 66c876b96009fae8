"""The motion of a body that rolls under gravity, its forces, and the times of hops and slips."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive, Valid, cached_readonly, sample_times, validated
from reference.numerics import gauss_collocation as gauss
from reference.numerics.integration import IntegrationFailed, units_of_motion
from reference.numerics.roots import first_below
from reference.plane import rotation_acceleration
from reference.rolling.contact import Contact
from reference.rolling.curves import Vector
from reference.rolling.kinematics import Rolling
from reference.validators import Array

GRAVITY = 9.81


@dataclass(frozen=True)
class RollingBody(Valid):
    """One body that rolls on fixed ground under gravity, described by the coordinate theta.

    M(theta) theta'' + M'(theta) theta'^2 / 2 = -V'(theta), with M = inertia + mass r^2 and V = mass g height; r is the
    distance from the contact to the centre of mass. The ideal contact can pull (N < 0) and never slips, so a real body
    moves differently after `hop` or `slip`.

    mass [kg]; inertia [kg m^2] about the centre of mass; gravity [m/s^2]; start_rate [rad/s]. The centre of mass is the
    origin of `rolling.body`, and the start angle is `rolling.theta`.
    """

    rolling: Rolling
    mass: Positive
    inertia: Positive
    start_rate: float
    gravity: Vector = (0.0, -GRAVITY)

    @property
    def start(self) -> tuple[float, float]:
        return (self.rolling.theta, self.start_rate)

    @validated
    def angular_acceleration(self, theta: ArrayLike, rate: ArrayLike) -> Array:
        """theta'' (...) [rad/s^2] at rotations [rad] and rates [rad/s] (...)."""
        return self._angular_acceleration(self.rolling.contact(theta), np.asarray(rate))

    def _angular_acceleration(self, contact: Contact, rate: Array) -> Array:
        arm = contact.arm
        inertia = self.inertia + self.mass * np.sum(arm**2, axis=-1)
        # M'/2 = m r r' and r r' = -s' dot(r, e_t), since only the advance of the contact changes r.
        half_slope = -self.mass * contact.rate * np.sum(arm * contact.tangent, axis=-1)
        pull = self.mass * (arm[..., 0] * self.gravity[1] - arm[..., 1] * self.gravity[0])
        return (pull - half_slope * rate**2) / inertia

    def _rates(self, state: Array) -> Array:
        """d/dt of (theta, theta'), or NaN beyond the limits of the rolling, so that the integrator reduces its step."""
        theta, rate = state[..., 0], state[..., 1]
        low, high = self.rolling.limits
        finite = np.isfinite(theta) & np.isfinite(rate)
        rolls = finite & (theta >= low) & (theta <= high)
        outside = theta[finite & ~rolls]
        if outside.size:
            farthest = max((*self._beyond, *outside.flat), key=lambda angle: abs(angle - self.rolling.theta))
            self._beyond[:] = [float(farthest)]
        inside, turning = np.where(rolls, theta, self.rolling.theta), np.where(rolls, rate, 0.0)
        rates = np.stack([turning, self.angular_acceleration(inside, turning)], axis=-1)
        return np.where(rolls[..., None], rates, np.nan)

    @cached_property
    def _beyond(self) -> list[float]:
        return []

    @contextmanager
    def _rolling_on(self) -> Iterator[None]:
        try:
            yield
        except IntegrationFailed:
            if self._beyond:
                self.rolling.contact(self._beyond[0])
            raise

    @cached_readonly
    def _units(self) -> Array:
        """The units of theta and theta'. Near an equilibrium, rounding of the start angle limits the accuracy."""
        uncertain = np.finfo(float).eps * self._pace_of_rest / gauss.WINDOW_TOLERANCE
        return np.maximum(units_of_motion(self._rates, self.start), [0.0, uncertain])

    @cached_property
    def _solutions(self) -> list[tuple[float, gauss.Motion]]:
        return []

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """theta [rad] and theta' [rad/s] (times,) at times t >= 0 [s] in any order."""
        t = sample_times("rolling body", t)
        until = float(t.max(initial=0.0)) or math.ulp(1.0)
        # The motion is cached, since samples and searches use many times.
        if not self._solutions or self._solutions[0][0] < until:
            with self._rolling_on():
                self._solutions[:] = [(until, gauss.motion(self._rates, self.start, until, self._units))]
        states = self._solutions[0][1](t)
        return states[:, 0], states[:, 1]

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound (times,) on the error of theta and theta' [rad, rad/s], from the difference to a coarser rule."""
        times = sample_times("rolling body", t)
        with self._rolling_on():
            return gauss.error_of(self._rates, self.start, times, self._units)

    def forces(self, t: ArrayLike) -> tuple[Array, Array]:
        """The contact's forces T along e_t and N along e_n (times,) [N] on the body."""
        tangent, normal, _ = self._forces(t)
        return tangent, normal

    def _forces(self, t: ArrayLike) -> tuple[Array, Array, Array]:
        theta, rate = self.states(t)
        contact = self.rolling.contact(theta)
        turning = self._angular_acceleration(contact, rate)
        centre = rotation_acceleration(rate, turning, contact.arm) + (rate**2 * contact.rate)[:, None] * contact.normal
        force = self.mass * (centre - np.asarray(self.gravity))
        arm, advance = np.linalg.norm(contact.arm, axis=-1), np.abs(contact.rate)
        size = self.mass * (np.abs(turning) * arm + rate**2 * (arm + advance) + math.hypot(*self.gravity))
        return np.sum(force * contact.tangent, axis=-1), np.sum(force * contact.normal, axis=-1), size

    def required_friction(self, t: ArrayLike) -> Array:
        """The friction coefficient |T| / N (times,) that rolling needs, which is infinite if the contact must pull."""
        tangent, normal = self.forces(t)
        with np.errstate(divide="ignore"):
            return np.where(normal > 0, np.abs(tangent) / np.where(normal > 0, normal, 1.0), np.inf)

    @validated
    def hop(self, until: Positive) -> float | None:
        """The first instant [s] before `until` at which the contact would have to pull (N = 0), or None."""
        return self._first(((0.0, 1.0),), until)

    @validated
    def slip(self, friction: Positive, until: Positive) -> float | None:
        """The first instant [s] before `until` of a slip, with |T| above friction * N, or of a hop, or None."""
        return self._first(((-1.0, friction), (1.0, friction)), until)

    def _first(self, parts: Sequence[tuple[float, float]], until: float) -> float | None:
        """The first instant at which a T + b N is negative for a pair (a, b) of `parts`, or None.

        The motion is integrated in intervals of doubling length, so that an early instant needs only an early part of
        the motion. Forces are functions of the angle by conservation of energy, so the search ends after the body has
        turned back twice or, on level ground, rolled through a whole turn.
        """

        def spare(t: Array) -> tuple[Array, Array]:
            tangent, normal, size = self._forces(t)
            sums = np.stack([along * tangent + across * normal for along, across in parts])
            return sums, size * max(abs(factor) for pair in parts for factor in pair)

        begin, end = 0.0, min(until, self._short)
        while True:
            self.states(end)
            motion = self._solutions[0][1]
            crossing = first_below(spare, np.unique(np.clip(motion.times, begin, end)))
            if crossing is not None:
                return crossing[0]
            angle, rate = motion(np.append(motion.times[motion.times < end], end)).T
            turned_back = int(np.count_nonzero(rate[1:] * rate[:-1] < 0)) + (rate[0] == 0)
            if end >= until or turned_back > 1 or (self._level and np.ptp(angle) >= 2 * math.pi):
                return None
            begin, end = end, min(until, 2 * end)

    @property
    def _level(self) -> bool:
        along = abs(float(np.asarray(self.gravity) @ self.rolling.contact(self.rolling.theta).tangent))
        flat = self.rolling.ground.curvature_range == (0.0, 0.0)
        return flat and along <= 4 * np.finfo(float).eps * math.hypot(*self.gravity)

    @property
    def _short(self) -> float:
        theta, rate = self.start
        pull = math.sqrt(abs(float(self.angular_acceleration(theta, rate))))
        return 1 / (max(abs(rate), pull, self._pace_of_rest) or 1.0)

    @property
    def _pace_of_rest(self) -> float:
        """The rate [1/s] of growth or oscillation of small motions if the start angle were an equilibrium."""
        theta, _ = self.start
        mass = self.inertia + self.mass * float(np.sum(self.rolling.contact(theta).arm ** 2))
        return math.sqrt(abs(float(self.stiffness(theta))) / mass)

    @validated
    def stiffness(self, theta: ArrayLike) -> Array:
        """The second derivative of V by theta (...) [N m/rad]."""
        contact = self.rolling.contact(theta)
        gravity = np.asarray(self.gravity)
        across = gravity[1] * contact.tangent[..., 0] - gravity[0] * contact.tangent[..., 1]
        return self.mass * (contact.arm @ gravity + contact.rate * across)

    @validated
    def small_frequency(self, equilibrium: float) -> float:
        """The rate sqrt(V'' / M) [rad/s] of small oscillations. Raises InvalidMechanism unless the equilibrium is
        stable."""
        stiffness = float(self.stiffness(equilibrium))
        if not stiffness > 0:
            raise InvalidMechanism(
                f"rolling body: at theta = {equilibrium:.9g} rad the equilibrium is unstable (V'' = {stiffness:.6g} "
                "N m), so there is no oscillation; give a stable one"
            )
        arm = self.rolling.contact(equilibrium).arm
        return math.sqrt(stiffness / (self.inertia + self.mass * float(arm @ arm)))
