"""The free four-bar with one coordinate along its configuration curve, which is regular also at crank limits.

The configuration curve in the space of (theta, beta, phi) has the tangent t, and (theta, beta, phi)' = u t. The root w
of twice the kinetic energy is integrated with the angles. The derivation is in `reference/scenes/derivations.md`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from reference.checks import InvalidMechanism, Positive, Sign, Valid, validated
from reference.numerics import gauss_collocation as gauss
from reference.numerics.integration import IntegrationFailed
from reference.scenes.four_bar.linkage import FourBar
from reference.validators import Array

States = Callable[[Array], Any]
# Tolerance of a thousand roundings of numpy.longdouble, or of one rounding if numpy.longdouble is a double.
CURVE_TOLERANCE = gauss.WINDOW_TOLERANCE / 10
# If the largest component of t is below this fraction of the squared length of the longest bar, the bars are in line to
# rounding.
CHANGE_POINT = 1e-7


class BarAngles(NamedTuple):
    """Angles [rad], rates [rad/s] and accelerations [rad/s^2] (times, 3) of crank, coupler and rocker."""

    angle: Array
    rate: Array
    acceleration: Array


@dataclass(frozen=True)
class CurveMotion(Valid):
    """Uniform bars with masses [kg] under gravity [m/s^2] that move along the four-bar's configuration curve."""

    four_bar: FourBar
    masses: tuple[Positive, Positive, Positive]
    gravity: tuple[float, float]

    @validated
    def start(self, theta: float, theta_dot: float, branch: Sign) -> Any:
        """The state (theta, beta, phi, u) at an angle [rad] and rate [rad/s] of the crank."""
        beta, phi = self.four_bar.angles(theta, branch)
        angle = self._closed(np.array([theta, beta, phi], dtype=np.longdouble))
        along = self._direction(angle)[0]
        if np.all(np.abs(self._direction(angle)) <= 1e-9 * max(self.four_bar.lengths) ** 2):
            raise InvalidMechanism(
                f"four-bar: crank angle {theta!r} is a change point; the motion from it is not unique"
            )
        if theta_dot == 0:
            return np.append(angle, np.longdouble(0))
        if abs(float(along)) <= 1e-7 * max(self.four_bar.lengths) ** 2:
            raise InvalidMechanism(
                f"four-bar: at crank angle {theta!r} the crank is at its limit and can't have the rate "
                f"{theta_dot!r}; use 0"
            )
        return np.append(angle, np.longdouble(theta_dot) / along)

    def motion(self, start: Any, until: float, stages: int = gauss.STAGES) -> States:
        """A function from times (times,) [s], up to `until` [s], to states (times, 4) in extended precision.

        Raises IntegrationFailed at a change point.
        """
        rate = start[3] * self._direction(start[:3])
        shortest = min(self.four_bar.lengths)
        unit = np.longdouble(max(float(np.abs(rate).max()), math.sqrt(math.hypot(*self.gravity) / shortest)) or 1.0)
        # Angles times `unit`, and w divided by the root of the largest inertia, both have the unit of rates [rad/s].
        largest, nearest = np.sqrt(self._bar_inertias.max()), CHANGE_POINT * max(self.four_bar.lengths) ** 2

        def slopes(_: Any, state: Any) -> Any:
            angle = state[..., :3] / unit
            direction = self._direction(angle)
            if np.abs(direction).max(axis=-1).min() < nearest:
                raise IntegrationFailed("four-bar: the motion comes to a change point")
            root = np.sqrt(self._inertia(angle, direction)) / largest
            turning = unit * (state[..., 3:] / root[..., None]) * direction
            return np.concatenate([turning, (self._pull(angle, direction) / root)[..., None] / largest**2], axis=-1)

        root = np.sqrt(self._inertia(start[:3], self._direction(start[:3]))) / largest
        state = np.append(unit * start[:3], start[3] * root)
        # The integrator is for second-order equations. The state is passed as velocities; the integrator's positions
        # are not used.
        solution = gauss.integrate(slopes, np.zeros(4), state, until, float(unit), stages, CURVE_TOLERANCE)

        def states(times: Array) -> Any:
            velocities = solution.extended(times)[:, 4:]
            angle = velocities[:, :3] / unit
            root = np.sqrt(self._inertia(angle, self._direction(angle))) / largest
            return np.column_stack([angle, velocities[:, 3] / root])

        return states

    def bar_angles(self, states: Any) -> BarAngles:
        angle, u = states[:, :3], states[:, 3:]
        direction, bend = self._direction_and_bend(angle)
        change = self._change(angle, states[:, 3], direction, bend)[:, None]
        values = (angle, u * direction, change * direction + u**2 * bend)
        return BarAngles(*(np.asarray(value, dtype=float) for value in values))

    def _closed(self, angle: Any) -> Any:
        l1, l2, l3 = (np.longdouble(length) for length in self.four_bar.lengths)
        x, y = (np.longdouble(value) for value in self.four_bar.ground)
        theta, beta, phi = angle
        for _ in range(3):
            gap_x = l1 * np.cos(theta) + l2 * np.cos(beta) - l3 * np.cos(phi) - x
            gap_y = l1 * np.sin(theta) + l2 * np.sin(beta) - l3 * np.sin(phi) - y
            between = np.sin(phi - beta)
            if abs(float(between)) < 1e-6:
                break  # Newton's matrix is singular at a crank limit, so the start in double precision is used
            beta, phi = (
                beta - (gap_x * np.cos(phi) + gap_y * np.sin(phi)) / (l2 * between),
                phi - (gap_x * np.cos(beta) + gap_y * np.sin(beta)) / (l3 * between),
            )
        return np.array([theta, beta, phi])

    def _direction(self, angle: Any) -> Any:
        return self._direction_and_bend(angle)[0]

    def _direction_and_bend(self, angle: Any) -> tuple[Any, Any]:
        """The tangent t and the derivative (dt/dq) t along the tangent, each (..., 3)."""
        l1, l2, l3 = (np.longdouble(length) for length in self.four_bar.lengths)
        factor = np.array([l2 * l3, l1 * l3, -l1 * l2])
        difference = np.roll(angle, 1, axis=-1) - np.roll(angle, -1, axis=-1)
        direction = factor * np.sin(difference)
        turning = np.roll(direction, 1, axis=-1) - np.roll(direction, -1, axis=-1)
        return direction, factor * np.cos(difference) * turning

    @property
    def _bar_inertias(self) -> Any:
        """Inertias (3,) [kg m^2] of the bars about their fixed ends; the crank carries the coupler's mass."""
        m1, m2, m3 = (np.longdouble(mass) for mass in self.masses)
        lengths = np.array(self.four_bar.lengths, dtype=np.longdouble)
        return lengths**2 * np.array([m1 / 3 + m2, m2 / 3, m3 / 3])

    @property
    def _cross(self) -> Any:
        """The inertia that couples crank and coupler if they are in line [kg m^2]."""
        return np.longdouble(self.masses[1]) * np.longdouble(self.four_bar.crank) * np.longdouble(self.four_bar.coupler)

    def _inertia(self, angle: Any, t: Any) -> Any:
        coupling = self._cross * np.cos(angle[..., 1] - angle[..., 0])
        return np.sum(self._bar_inertias * t * t, axis=-1) + coupling * t[..., 0] * t[..., 1]

    def _pull(self, angle: Any, t: Any) -> Any:
        m1, m2, m3 = (np.longdouble(mass) for mass in self.masses)
        carried = np.array(self.four_bar.lengths, dtype=np.longdouble) * np.array([m1 / 2 + m2, m2 / 2, m3 / 2])
        force = np.longdouble(self.gravity[1]) * np.cos(angle) - np.longdouble(self.gravity[0]) * np.sin(angle)
        return np.sum(carried * force * t, axis=-1)

    def _change(self, angle: Any, u: Any, t: Any, bend: Any) -> Any:
        between = angle[..., 1] - angle[..., 0]
        coupling, fading = self._cross * np.cos(between), -self._cross * np.sin(between)
        inertia_slope = (
            2 * np.sum(self._bar_inertias * t * bend, axis=-1)
            + coupling * (bend[..., 0] * t[..., 1] + t[..., 0] * bend[..., 1])
            + fading * (t[..., 1] - t[..., 0]) * t[..., 0] * t[..., 1]
        )
        return (self._pull(angle, t) - u**2 * inertia_slope / 2) / self._inertia(angle, t)
