"""N links hanging from one another: joint forces by one banded solve, so that an evaluation costs O(N), and their
motion.

Angles are absolute, from the downward vertical, counter-clockwise. Link i has its upper end at joint i, half-vector
h = (l/2)(sin, -cos) down to its centre of mass and on to its lower end; F_i is the force of joint i on link i. Newton
and Euler, m a = F_i - F_(i+1) + m g and I angle'' = -h x (F_i + F_(i+1)), and equal accelerations where two links meet
give a block-tridiagonal, symmetric, positive definite system for the forces: J M^-1 J^T of the chain, without forming
J.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eigh, solveh_banded

from reference.checks import InvalidMechanism, require_finite, require_positive
from reference.memory import require_room
from reference.numerics.integration import error_of, integrate
from reference.pendulum.link import across, direction_of

Array = NDArray[np.float64]

NUDGE = 1e-6  # rad, the difference of starts whose growth is measured: small against a swing, large against rounding
TENFOLD = 10.0


@dataclass(frozen=True)
class Chain:
    """Uniform bars from a fixed pin at the origin: `lengths` [m] and `masses` [kg] (links,), gravity [m/s^2]
    downwards.
    """

    lengths: tuple[float, ...]
    masses: tuple[float, ...]
    gravity: float = 9.81

    def __post_init__(self) -> None:
        if not self.lengths:
            raise InvalidMechanism("chain: it has 0 links; give at least one")
        if len(self.lengths) != len(self.masses):
            raise InvalidMechanism(f"chain: {len(self.lengths)} lengths and {len(self.masses)} masses; give as many")
        for index, (length, mass) in enumerate(zip(self.lengths, self.masses, strict=True)):
            require_positive(f"chain, link {index + 1}", length=length, mass=mass)
        require_finite("chain", gravity=self.gravity)

    @property
    def links(self) -> int:
        return len(self.lengths)

    @cached_property
    def _length(self) -> Array:
        return np.array(self.lengths, dtype=float)

    @cached_property
    def _mass(self) -> Array:
        return np.array(self.masses, dtype=float)

    @cached_property
    def inertia(self) -> Array:
        """About the centres of mass (links,) [kg m^2]."""
        return self._mass * self._length**2 / 12

    def forces(self, angle: Array, rate: Array) -> Array:
        """The force of every joint on the link below it (..., links, 2) [N], for angles and rates (..., links).

        All states of a batch are one banded system, their blocks side by side: O(states x links).
        """
        leading = angle.shape[:-1]
        half = 0.5 * self._length[:, None] * direction_of(angle)
        normal = across(half)
        outer = normal[..., :, None] * normal[..., None, :] / self.inertia[:, None, None]
        light = np.eye(2) / self._mass[:, None, None]
        near, far = light + outer, outer - light  # acceleration of one end from a force on the same, on the other end
        diagonal = near.copy()
        diagonal[..., 1:, :, :] += near[..., :-1, :, :]
        banded = np.zeros((4, *leading, self.links, 2))  # upper form: row 3 is the diagonal
        banded[3, ..., 0], banded[3, ..., 1] = diagonal[..., 0, 0], diagonal[..., 1, 1]
        banded[2, ..., 1] = diagonal[..., 0, 1]
        banded[2, ..., 1:, 0] = far[..., :-1, 1, 0]
        banded[1, ..., 1:, 0], banded[1, ..., 1:, 1] = far[..., :-1, 0, 0], far[..., :-1, 1, 1]
        banded[0, ..., 1:, 1] = far[..., :-1, 0, 1]
        swing = rate[..., None] ** 2 * half
        right = -swing
        right[..., 1:, :] -= swing[..., :-1, :]
        right[..., 0, 1] += self.gravity  # gravity is the same on both sides of every other joint
        solution = solveh_banded(
            banded.reshape(4, -1), right.reshape(-1), overwrite_ab=True, overwrite_b=True, check_finite=False
        )
        return solution.reshape(*leading, self.links, 2)

    def accelerations(self, angle: Array, rate: Array) -> Array:
        """angle'' (..., links) [rad/s^2] from the joint forces."""
        forces = self.forces(angle, rate)
        forces[..., :-1, :] += forces[..., 1:, :]
        normal = across(0.5 * self._length[:, None] * direction_of(angle))
        return -np.sum(normal * forces, axis=-1) / self.inertia

    def rates(self, state: Array) -> Array:
        """d/dt of (angles, rates) (..., 2 links): what is integrated."""
        angle, rate = state[..., : self.links], state[..., self.links :]
        return np.concatenate([rate, self.accelerations(angle, rate)], axis=-1)

    @cached_property
    def inertia_matrix(self) -> Array:
        """The constants M_ij of the kinetic energy sum M_ij cos(angle_i - angle_j) rate_i rate_j / 2 (links, links).

        Raises InvalidMechanism where that would take more than memory.LARGEST.
        """
        require_room("chain: the dense inertia matrix", (self.links, self.links))
        below = np.concatenate([np.cumsum(self._mass[::-1])[::-1][1:], [0.0]])  # mass hanging from each link
        lever = self._length * (self._mass / 2 + below)
        index = np.arange(self.links)
        matrix = np.where(index[:, None] < index, np.outer(self._length, lever), np.outer(lever, self._length))
        np.fill_diagonal(matrix, self._length**2 * (self._mass / 3 + below))
        return matrix

    @cached_property
    def stiffness(self) -> Array:
        """The weights K_i of the potential energy -sum K_i cos(angle_i) (links,) [N m]."""
        below = np.concatenate([np.cumsum(self._mass[::-1])[::-1][1:], [0.0]])
        return self.gravity * self._length * (self._mass / 2 + below)

    def lagrangian_accelerations(self, angle: Array, rate: Array) -> Array:
        """angle'' (links,) [rad/s^2] by Lagrange's equations, dense: O(links^3), no joint force in it; the second
        opinion.
        """
        difference = angle[:, None] - angle
        right = -(self.inertia_matrix * np.sin(difference)) @ rate**2 - self.stiffness * np.sin(angle)
        solution: Any = np.linalg.solve(self.inertia_matrix * np.cos(difference), right)
        return solution

    def modes(self) -> tuple[Array, Array]:
        """Small oscillations about hanging: frequencies (links,) [rad/s] ascending, and shapes (links, modes) of
        angles.
        """
        squares, shapes = eigh(np.diag(self.stiffness), self.inertia_matrix)
        return np.sqrt(squares), shapes

    def energy(self, angle: Array, rate: Array) -> Array:
        """Kinetic and potential energy (...) [J] by Lagrange's constants; zero potential at the pin."""
        sine, cosine = np.sin(angle) * rate, np.cos(angle) * rate
        kinetic = 0.5 * (
            np.einsum("...i,ij,...j", cosine, self.inertia_matrix, cosine)
            + np.einsum("...i,ij,...j", sine, self.inertia_matrix, sine)
        )
        return kinetic - np.sum(self.stiffness * np.cos(angle), axis=-1)

    def placement(self, angle: Array, rate: Array, acceleration: Array) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations of the centres of mass (..., links, 3), the body's x axis down the link."""
        half = 0.5 * self._length[:, None] * direction_of(angle)
        speed = rate[..., None] * across(half)
        change = acceleration[..., None] * across(half) - rate[..., None] ** 2 * half

        def centres(steps: Array) -> Array:
            return 2 * np.cumsum(steps, axis=-2) - steps

        return (
            np.concatenate([centres(half), (angle - math.pi / 2)[..., None]], axis=-1),
            np.concatenate([centres(speed), rate[..., None]], axis=-1),
            np.concatenate([centres(change), acceleration[..., None]], axis=-1),
        )

    def divergence(self, angle: ArrayLike, rate: ArrayLike, t: ArrayLike, starts: int = 3) -> Array:
        """How many times larger a small difference of starts has become at times t (times,) [s]: the worst of some.

        Measured, not guessed: `starts` neighbours are integrated beside the motion, their angles moved by NUDGE in
        fixed pseudo-random directions. The norm is the largest difference of an angle.
        """
        t = np.atleast_1d(np.asarray(t, dtype=float))
        start = np.concatenate([np.asarray(angle, dtype=float), np.asarray(rate, dtype=float)])
        until = max(float(t.max()), math.ulp(1.0))
        tolerance = NUDGE * 1e-4  # its error stays far below the difference that is measured
        motion = integrate(self.rates, start, until, tolerance)(t)
        growth = np.zeros(len(t))
        generator = np.random.default_rng(0)
        for _ in range(starts):
            move = np.concatenate([generator.uniform(-1, 1, self.links), np.zeros(self.links)])
            move *= NUDGE / np.abs(move).max()
            neighbour = integrate(self.rates, start + move, until, tolerance)(t)
            growth = np.maximum(growth, np.abs(neighbour - motion)[:, : self.links].max(axis=-1) / NUDGE)
        return growth

    def horizon(self, angle: ArrayLike, rate: ArrayLike, until: float) -> tuple[float, float]:
        """(time [s] at which a difference has grown tenfold, rate [1/s] of its exponential growth from there to
        `until`).

        The first is `until` when that doesn't happen; the second is then NaN. It is a slope over a finite time, fitted
        to the logarithm of `divergence`, so it depends on `until`: a Lyapunov exponent is its limit.
        """
        t = np.linspace(0, until, 201)
        growth = self.divergence(angle, rate, t)
        if growth.max() <= TENFOLD:
            return until, math.nan
        first = int(np.argmax(growth > TENFOLD))
        if len(t) - first < 2:
            return float(t[first]), math.nan
        return float(t[first]), float(np.polyfit(t[first:], np.log(growth[first:]), 1)[0])

    def error(self, angle: ArrayLike, rate: ArrayLike, t: ArrayLike) -> Array:
        """A bound on the integrated motion's own error (times,) [rad, rad/s], from a tolerance 10 times coarser."""
        return error_of(self.rates, np.concatenate([np.asarray(angle, float), np.asarray(rate, float)]), t)


@dataclass(frozen=True)
class TwoPoints:
    """What problems 18.5.1 and 18.5.2 ask for, each (2,) in m/s or m/s^2: of A, of B relative to A, and of B."""

    a: Array
    b_relative_to_a: Array
    b: Array


def velocities(length: float, angles: tuple[float, float], rates: tuple[float, float]) -> TwoPoints:
    """Problem 18.5.1: A and B are the lower ends of the two bars of a double pendulum, each of `length` [m].

    The angles phi are from the downward vertical, counter-clockwise: r_A = l (sin phi1, -cos phi1).
    """
    first, second = (
        length * rate * across(direction_of(np.asarray(phi))) for phi, rate in zip(angles, rates, strict=True)
    )
    return TwoPoints(first, second, first + second)


def accelerations(
    length: float, angles: tuple[float, float], rates: tuple[float, float], second_rates: tuple[float, float]
) -> TwoPoints:
    """Problem 18.5.2: a_A = l (phi1'' cos phi1 - phi1'^2 sin phi1, phi1'' sin phi1 + phi1'^2 cos phi1), B/A
    likewise.
    """
    first, second = (
        length * (turning * across(direction_of(np.asarray(phi))) - rate**2 * direction_of(np.asarray(phi)))
        for phi, rate, turning in zip(angles, rates, second_rates, strict=True)
    )
    return TwoPoints(first, second, first + second)
