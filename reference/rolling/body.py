"""A body rolling under gravity: its motion from energy in one freedom, the forces it needs, when it hops or slips."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike
from scipy.optimize import brentq

from reference.curves.curve import Array, Vector
from reference.numerics import windows
from reference.numerics.integration import IntegrationFailed, units_of_motion
from reference.rolling.kinematics import Rolling
from reference.validation import InvalidMechanism, Positive, Valid, sample_times, validated

GRAVITY = 9.81
# N and friction are looked at this often for a change of sign, in radians at the start's fastest rate, and the instant
# is then found to rounding. Not in seconds: a clock of another unit must not make it a billion looks, or none.
WATCH = 8e-3


def _root(function: Callable[[float], float], low: float, high: float) -> float:
    return float(brentq(function, low, high, xtol=1e-15, rtol=np.float64(1e-14)))  # type: ignore[arg-type]


@dataclass(frozen=True)
class RollingBody(Valid):
    """One body rolling on fixed ground under gravity, in the one coordinate theta.

    M(theta) theta'' + M'(theta) theta'^2 / 2 = -V'(theta), with M = inertia + mass r^2, r the distance from the contact
    to the centre of mass, V = mass g height. Contact is ideal both ways: it also pulls (N < 0) and never slips, so
    beyond `hop` or `slip` this is no longer what a real body does.

    mass [kg]; inertia [kg m^2] about the centre of mass, the origin of the rolling's body curve; gravity [m/s^2]; start
    rate [rad/s]; the start angle is that of the rolling.
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
        contact = self.rolling.contact(theta)
        arm = contact.arm
        inertia = self.inertia + self.mass * np.sum(arm**2, axis=-1)
        # M'/2 = m r r', and r r' = -s' r . e_t: turning keeps r, only the advance of the contact changes it.
        half_slope = -self.mass * contact.rate * np.sum(arm * contact.tangent, axis=-1)
        pull = self.mass * (arm[..., 0] * self.gravity[1] - arm[..., 1] * self.gravity[0])
        return (pull - half_slope * np.asarray(rate) ** 2) / inertia

    @validated
    def energy(self, theta: ArrayLike, rate: ArrayLike) -> Array:
        """Kinetic plus gravitational energy (...) [J], zero potential at the world's origin."""
        contact = self.rolling.contact(theta)
        inertia = self.inertia + self.mass * np.sum(contact.arm**2, axis=-1)
        place = contact.point + contact.arm
        return 0.5 * inertia * np.asarray(rate) ** 2 - self.mass * (place @ np.asarray(self.gravity))

    def _rates(self, state: Array) -> Array:
        """NaN beyond the rotations at which the body can roll: a step with a stage there is then taken shorter."""
        theta, rate = state[..., 0], state[..., 1]
        low, high = self.rolling.limits
        known = np.isfinite(theta) & np.isfinite(rate)  # a stage after one that was beyond is not
        rolls = known & (theta >= low) & (theta <= high)
        if np.any(known & ~rolls):
            farthest = max(
                (*self._beyond, *theta[known & ~rolls].flat), key=lambda angle: abs(angle - self.rolling.theta)
            )
            self._beyond[:] = [float(farthest)]
        own, turning = np.where(rolls, theta, self.rolling.theta), np.where(rolls, rate, 0.0)
        rates = np.stack([turning, self.angular_acceleration(own, turning)], axis=-1)
        return np.where(rolls[..., None], rates, np.nan)

    @cached_property
    def _beyond(self) -> list[float]:
        """The farthest beyond the limits that a stage of the integrator was [rad], if any."""
        return []

    @contextmanager
    def _rolling_on(self) -> Iterator[None]:
        """A motion that can't be carried on because the rolling ends is refused as the rolling refuses it."""
        try:
            yield
        except IntegrationFailed:
            if self._beyond:
                self.rolling.contact(self._beyond[0])
            raise

    @cached_property
    def _units(self) -> Array:
        return units_of_motion(self._rates, self.start)

    @cached_property
    def _known(self) -> list[tuple[float, windows.Motion]]:
        return []

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """theta [rad] and theta' [rad/s] (times,) at times t >= 0 [s], any order."""
        t = sample_times("rolling body", t)
        until = float(t.max(initial=0.0)) or math.ulp(1.0)
        # Always integrated from zero with its own steps; kept, because samples and searches ask for many times.
        if not self._known or self._known[0][0] < until:
            with self._rolling_on():
                self._known[:] = [(until, windows.motion(self._rates, self.start, until, self._units))]
        states = self._known[0][1](t)
        return states[:, 0], states[:, 1]

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound on the error of theta and theta' (times,) [rad, rad/s], from a coarser rule."""
        times = sample_times("rolling body", t)
        with self._rolling_on():
            return windows.error_of(self._rates, self.start, times, self._units)

    def forces(self, t: ArrayLike) -> tuple[Array, Array]:
        """T along e_t and N along e_n (times,) [N], on the body at the contact."""
        theta, rate = self.states(t)
        contact = self.rolling.contact(theta)
        force = self.mass * (
            self.rolling.acceleration(theta, rate, self.angular_acceleration(theta, rate)) - np.asarray(self.gravity)
        )
        return np.sum(force * contact.tangent, axis=-1), np.sum(force * contact.normal, axis=-1)

    def required_friction(self, t: ArrayLike) -> Array:
        """|T| / N (times,): the friction coefficient that rolling needs; infinite where the contact must pull."""
        tangent, normal = self.forces(t)
        with np.errstate(divide="ignore"):
            return np.where(normal > 0, np.abs(tangent) / np.where(normal > 0, normal, 1.0), np.inf)

    @validated
    def hop(self, until: Positive) -> float | None:
        """The first instant [s] before `until` at which the contact would have to pull (N = 0), or None."""
        return self._first(lambda t: self.forces(t)[1], until)

    @validated
    def slip(self, friction: Positive, until: Positive) -> float | None:
        """The first instant [s] before `until` at which |T| exceeds friction N, or None; at a hop at the latest."""

        def spare(t: ArrayLike) -> Array:
            tangent, normal = self.forces(t)
            return friction * normal - np.abs(tangent)

        return self._first(spare, until)

    def _first(self, spare: Callable[[ArrayLike], Array], until: float) -> float | None:
        pull = abs(float(self.angular_acceleration(*self.start)))
        fastest = max(abs(self.start_rate), math.sqrt(pull))  # rad/s; where it rests there is nothing to look for
        times = np.linspace(0.0, until, max(2, math.ceil(until * fastest / WATCH)) + 1)
        below = np.flatnonzero(spare(times) < 0)
        if below.size == 0:
            return None
        if below[0] == 0:
            return 0.0
        return _root(lambda t: float(spare(t)[0]), float(times[below[0] - 1]), float(times[below[0]]))

    @validated
    def equilibrium(self, near: float, within: Positive = 0.5) -> float:
        """The rotation [rad] within `within` of `near` at which the body can rest; InvalidMechanism without one."""
        low, high = near - within, near + within

        def pull(theta: float) -> float:
            return float(self.angular_acceleration(theta, 0.0))

        if pull(low) * pull(high) > 0:
            raise InvalidMechanism(
                f"rolling body: gravity doesn't change its sense between {low:.6g} and {high:.6g} rad, so it "
                "can't rest there"
            )
        return _root(pull, low, high)

    @validated
    def stiffness(self, theta: ArrayLike) -> Array:
        """d^2V/dtheta^2 (...) [N m/rad]."""
        contact = self.rolling.contact(theta)
        gravity = np.asarray(self.gravity)
        across = gravity[1] * contact.tangent[..., 0] - gravity[0] * contact.tangent[..., 1]
        return self.mass * (contact.arm @ gravity + contact.rate * across)

    @validated
    def small_frequency(self, equilibrium: float) -> float:
        """sqrt(V'' / M) [rad/s] of small oscillations about a rest; InvalidMechanism if the rest is unstable."""
        stiffness = float(self.stiffness(equilibrium))
        if not stiffness > 0:
            raise InvalidMechanism(
                f"rolling body: at theta = {equilibrium:.9g} rad it rests on a top (V'' = {stiffness:.6g} N m), "
                "from which it doesn't oscillate; give the bottom"
            )
        arm = self.rolling.contact(equilibrium).arm
        return math.sqrt(stiffness / (self.inertia + self.mass * float(arm @ arm)))
