"""The motion of a chain of N links; one banded system gives the joint forces at the cost O(N).

Angles are from the downward vertical, counter-clockwise. Link i has its upper end at joint i; the half-vector h =
(l/2)(sin, -cos) leads from the upper end to the centre of mass, and from the centre of mass to the lower end. F_i is
the force of joint i on link i. The laws of Newton and Euler are m a = F_i - F_(i+1) + m g and I angle'' = -h x (F_i +
F_(i+1)). Two links have equal accelerations at their joint. So the forces have a block-tridiagonal, symmetric, positive
definite system with the matrix J M^-1 J^T of the chain.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import (
    Count,
    InvalidMechanism,
    Positive,
    Times,
    Valid,
    cached_readonly,
    require_room,
    sample_times,
    validated,
)
from reference.numerics import gauss_collocation as gauss
from reference.numerics.integration import error_of, integrate, units_of_motion
from reference.plane import perpendicular, placed, rotation_acceleration, rotation_velocity
from reference.scenes.pendulum.link import direction_of
from reference.validators import Array

# Ratio of masses above which the forces are refined. The acceleration of a light link between heavy links is a small
# difference of large forces.
UNEVEN = 10.0
# Number of steps of iterative refinement. Each step multiplies the error by about the relative error of the first
# solution, so three steps suffice up to a ratio of 1e9.
MAX_REFINEMENTS = 3
# Relative correction below which the refinement ends; its square is below the rounding of extended precision.
CORRECTED = 3e-10


Motion = Callable[[ArrayLike], Array]

# Number of links up to which collocation is faster than the explicit method, since numpy calls cost more than their
# arithmetic.
FEW_LINKS = 20
# Difference of starts [rad] whose growth is measured, small against a swing and large against rounding.
PERTURBATION = 1e-6
# Factor by which a difference grows until the horizon.
TENFOLD = 10.0


@dataclass(frozen=True)
class Chain(Valid):
    """Uniform bars from a fixed pin at the origin: `lengths` [m] and `masses` [kg] (links,), gravity [m/s^2]
    downwards.
    """

    lengths: tuple[Positive, ...]
    masses: tuple[Positive, ...]
    gravity: float = 9.81

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.lengths:
            raise InvalidMechanism("chain: it has 0 links; give at least one")
        if len(self.lengths) != len(self.masses):
            raise InvalidMechanism(f"chain: {len(self.lengths)} lengths and {len(self.masses)} masses; give as many")

    @property
    def links(self) -> int:
        return len(self.lengths)

    @cached_readonly
    def _length(self) -> Array:
        return np.array(self.lengths, dtype=float)

    @cached_readonly
    def _mass(self) -> Array:
        return np.array(self.masses, dtype=float)

    @cached_readonly
    def inertia(self) -> Array:
        """Inertias (links,) about the centres of mass [kg m^2]."""
        return self._mass * self._length**2 / 12

    @validated
    def forces(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        """The force of every joint on the link below it (..., links, 2) [N], for angles and rates (..., links)."""
        angle, rate = self._checked(angle, rate)
        return self._forces(angle, rate).astype(float)

    def _forces(self, angle: Array, rate: Array) -> Any:
        """`forces` without checks of arguments, in extended precision if the masses differ by more than UNEVEN.

        All states of a batch are one banded system with a block for each state, at the cost O(states x links). For a
        ratio r of masses the error is about r roundings. If r is larger than UNEVEN, the solution is refined with
        residuals in extended precision. The error is then r / 2000 roundings, or r roundings if numpy.longdouble is a
        double.
        """
        from scipy.linalg import cho_solve_banded, cholesky_banded, solveh_banded

        leading = angle.shape[:-1]
        links, uneven = len(self._mass), self._mass.max() > UNEVEN * self._mass.min()
        doubles, rate = angle.astype(float, copy=False), rate if uneven else rate.astype(float, copy=False)
        half = 0.5 * self._length[:, None] * direction_of(doubles)
        normal = perpendicular(half)
        outer = normal[..., :, None] * normal[..., None, :] / self.inertia[:, None, None]
        light = np.eye(2) / self._mass[:, None, None]
        # Acceleration of one end of a link by a unit force on this end (near) or on the opposite end (far).
        near, far = light + outer, outer - light
        diagonal = near.copy()
        diagonal[..., 1:, :, :] += near[..., :-1, :, :]
        banded = np.zeros((4, *leading, links, 2))  # upper form, with the diagonal in row 3
        banded[3, ..., 0], banded[3, ..., 1] = diagonal[..., 0, 0], diagonal[..., 1, 1]
        banded[2, ..., 1] = diagonal[..., 0, 1]
        banded[2, ..., 1:, 0] = far[..., :-1, 1, 0]
        banded[1, ..., 1:, 0], banded[1, ..., 1:, 1] = far[..., :-1, 0, 0], far[..., :-1, 1, 1]
        banded[0, ..., 1:, 1] = far[..., :-1, 0, 1]
        if not uneven:
            centripetal = rate[..., None] ** 2 * half
            right = -centripetal
            right[..., 1:, :] -= centripetal[..., :-1, :]
            right[..., 0, 1] += self.gravity  # gravity cancels elsewhere
            solution = solveh_banded(
                banded.reshape(4, -1), right.reshape(-1), overwrite_ab=True, overwrite_b=True, check_finite=False
            )
            return solution.reshape(*leading, links, 2)
        factor = cholesky_banded(banded.reshape(4, -1), overwrite_ab=True, check_finite=False)
        forces = np.zeros((*leading, links, 2), dtype=np.longdouble)
        residual = self._residual(angle, rate)
        for _ in range(1 + MAX_REFINEMENTS):
            right = residual(forces).astype(float)
            correction = cho_solve_banded((factor, False), right.reshape(-1), check_finite=False)
            forces -= correction.reshape(forces.shape)
            by_state = (-1, 2 * links)
            small = CORRECTED * np.abs(forces.reshape(by_state)).max(axis=1)
            if np.all(np.abs(correction.reshape(by_state)).max(axis=1) <= small):
                break
        return forces

    def _residual(self, angle: Array, rate: Array) -> Callable[[Any], Any]:
        """A function from forces (..., links, 2) to relative accelerations at the joints [m/s^2]."""
        half = self._length[:, None] / np.longdouble(2) * direction_of(np.asarray(angle, dtype=np.longdouble))
        normal = perpendicular(half)
        centripetal = rotation_acceleration(np.asarray(rate, dtype=np.longdouble), np.zeros_like(half[..., 0]), half)
        turned, light = normal / self.inertia[:, None], 1 / self._mass.astype(np.longdouble)[:, None]

        def residual(forces: Any) -> Any:
            below = np.zeros_like(forces)
            below[..., :-1, :] = forces[..., 1:, :]
            centre = (forces - below) * light
            alpha = -(turned * (forces + below)).sum(axis=-1)
            lever = centripetal + alpha[..., None] * normal
            out = centre - lever  # the upper end's acceleration without gravity, which is the same for all links
            out[..., 1:, :] -= (centre + lever)[..., :-1, :]
            out[..., 0, 1] -= self.gravity
            return out

        return residual

    def _checked(self, *arguments: ArrayLike) -> list[Array]:
        states = [np.asarray(argument, dtype=float) for argument in arguments]
        shapes = [state.shape for state in states]
        if any(shape != shapes[0] or shape[-1:] != (self.links,) for shape in shapes):
            raise InvalidMechanism(
                f"chain: angles and rates have the shapes {', '.join(map(str, shapes))}; "
                f"all must be of one shape (..., {self.links}), a number for each link"
            )
        return states

    @validated
    def accelerations(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        """angle'' (..., links) [rad/s^2] from the joint forces."""
        angle, rate = self._checked(angle, rate)
        return self._accelerations(angle, rate).astype(float)

    def _accelerations(self, angle: Any, rate: Any) -> Any:
        forces = self._forces(angle, rate)
        forces[..., :-1, :] += forces[..., 1:, :]
        normal = perpendicular(0.5 * self._length[:, None] * direction_of(np.asarray(angle, dtype=forces.dtype)))
        return -np.sum(normal * forces, axis=-1) / self.inertia

    def rates(self, state: Array) -> Array:
        angle, rate = state[..., : self.links], state[..., self.links :]
        return np.concatenate([rate, self._accelerations(angle, rate).astype(float)], axis=-1)

    def solved(self, angle: ArrayLike, rate: ArrayLike, until: float) -> Motion:
        """The motion up to `until` [s] from angles and rates (links,): a function from times to states (times, 2 n)."""
        start = self._start(angle, rate)
        if self.links > FEW_LINKS:
            return integrate(self.rates, start, until, unit=units_of_motion(self.rates, start))
        return self._by_collocation(start, until)

    def _by_collocation(self, start: Array, until: float, coarse: bool = False) -> gauss.CollocationMotion:
        """The motion of the links by collocation. If `coarse`, the rule has fewer stages and ten times the
        tolerance."""
        angle, rate = np.split(start, 2)
        unit = float(units_of_motion(self.rates, start)[-1])
        stages, tolerance = (gauss.COARSE_STAGES, gauss.COARSER) if coarse else (gauss.STAGES, 1.0)
        return gauss.integrate(
            self._accelerations, angle, rate, until, unit, stages, tolerance * gauss.WINDOW_TOLERANCE
        )

    @validated
    def motion(self, angle: ArrayLike, rate: ArrayLike, t: Times) -> tuple[Array, Array, Array]:
        """Angles, rates and accelerations (times, links) [rad, rad/s, rad/s^2] at times t (times,) [s].

        The start is an angle [rad] and a rate [rad/s] for each link (links,). `truth_error` bounds the error.
        """
        times = sample_times("chain", t)
        state = self.solved(angle, rate, max(float(times.max(initial=0.0)), math.ulp(1.0)))(times)
        angles, rates = state[:, : self.links], state[:, self.links :]
        return angles, rates, self._accelerations(angles, rates).astype(float)

    @cached_readonly
    def inertia_matrix(self) -> Array:
        """M_ij (links, links) in the kinetic energy, which is the sum of M_ij cos(angle_i - angle_j) rate_i rate_j / 2.

        Raises InvalidMechanism if the matrix takes more than checks.LARGEST_ARRAY.
        """
        require_room("chain: the dense inertia matrix", (self.links, self.links))
        lever, index = self._length * (self._mass / 2 + self._below), np.arange(self.links)
        matrix = np.where(index[:, None] < index, np.outer(self._length, lever), np.outer(lever, self._length))
        np.fill_diagonal(matrix, self._length**2 * (self._mass / 3 + self._below))
        return matrix

    @property
    def _below(self) -> Array:
        """The mass below each link (links,) [kg]."""
        return np.concatenate([np.cumsum(self._mass[::-1])[::-1][1:], [0.0]])

    @cached_readonly
    def stiffness(self) -> Array:
        """K_i (links,) [N m] in the potential energy, which is the sum of -K_i cos(angle_i)."""
        return self.gravity * self._length * (self._mass / 2 + self._below)

    def modes(self) -> tuple[Array, Array]:
        """Frequencies (links,) [rad/s], ascending, and shapes (links, modes) of angles of small oscillations about
        hanging.
        """
        from scipy.linalg import eigh

        squares, shapes = eigh(np.diag(self.stiffness), self.inertia_matrix)
        return np.sqrt(squares), shapes

    @validated
    def placement(self, angle: ArrayLike, rate: ArrayLike, acceleration: ArrayLike) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations of the centres of mass (..., links, 3); the x axis is down the link."""
        angle, rate, acceleration = self._checked(angle, rate, acceleration)
        half = 0.5 * self._length[:, None] * direction_of(angle)

        def centres(steps: Array) -> Array:
            return 2 * np.cumsum(steps, axis=-2) - steps

        return (
            placed(centres(half), angle - math.pi / 2),
            placed(centres(rotation_velocity(rate, half)), rate),
            placed(centres(rotation_acceleration(rate, acceleration, half)), acceleration),
        )

    @validated
    def divergence(self, angle: ArrayLike, rate: ArrayLike, t: Times, starts: Count = 3) -> Array:
        """The largest growth factor of a small difference of starts at times t (times,) [s].

        `starts` neighbouring motions are integrated. The start angles of these motions differ by PERTURBATION in
        pseudo-random directions with a fixed seed. The size of a difference is its largest angle.
        """
        t, start = sample_times("chain", t), self._start(angle, rate)
        until = max(float(t.max(initial=0.0)), math.ulp(1.0))
        tolerance = PERTURBATION * 1e-4
        generator = np.random.default_rng(0)
        together = np.tile(start, (starts + 1, 1))
        for neighbour in together[1:]:
            move = generator.uniform(-1, 1, self.links)
            neighbour[: self.links] += move * (PERTURBATION / np.abs(move).max())

        def rates(state: Array) -> Array:
            return self.rates(state.reshape(*state.shape[:-1], *together.shape)).reshape(state.shape)

        unit = np.tile(units_of_motion(self.rates, start), starts + 1)
        motions = integrate(rates, together.reshape(-1), until, tolerance, unit)(t).reshape(len(t), *together.shape)
        growth = np.abs(motions[:, 1:] - motions[:, :1])[..., : self.links].max(axis=-1) / PERTURBATION
        return np.asarray(growth.max(axis=-1, initial=0.0))

    @validated
    def horizon(self, angle: ArrayLike, rate: ArrayLike, until: Positive) -> tuple[float, float]:
        """(time [s] at which a difference has grown tenfold, rate [1/s] of the exponential growth from that time to
        `until`).

        If the difference does not grow tenfold, the time is `until` and the rate is NaN. The rate is fitted to the
        logarithm of `divergence` up to `until`; for large `until` the rate tends to a Lyapunov exponent.
        """
        t = np.linspace(0, until, 201)
        growth = self.divergence(angle, rate, t)
        if growth.max() <= TENFOLD:
            return until, math.nan
        first = int(np.argmax(growth > TENFOLD))
        if len(t) - first < 2:
            return float(t[first]), math.nan
        return float(t[first]), float(np.polyfit(t[first:], np.log(growth[first:]), 1)[0])

    @validated
    def truth_error(self, angle: ArrayLike, rate: ArrayLike, t: Times) -> Array:
        """A bound (times,) on the error of the motion [rad, rad/s], from the difference to a tenfold tolerance.

        For collocation the bound is ten times the difference plus rounding, since both tolerances are near rounding.
        """
        times, start = sample_times("chain", t), self._start(angle, rate)
        if self.links > FEW_LINKS:
            return error_of(self.rates, start, times, unit=units_of_motion(self.rates, start))
        until = max(float(times.max(initial=0.0)), math.ulp(1.0))
        return gauss.bound(*(self._by_collocation(start, until, coarse).extended(times) for coarse in (False, True)))

    def _start(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        return np.concatenate(self._checked(angle, rate))
