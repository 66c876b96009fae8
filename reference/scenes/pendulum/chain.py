"""N links hanging from one another: their accelerations from the joint forces, an evaluation costs O(N); their motion.

Angles are absolute, from the downward vertical, counter-clockwise; see `reference.scenes.pendulum.joint_forces`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.linalg import eigh

from reference.checks import (
    Count,
    InvalidMechanism,
    Positive,
    Times,
    Valid,
    kept,
    require_room,
    sample_times,
    validated,
)
from reference.numerics import windows
from reference.numerics.integration import error_of, integrate, units_of_motion
from reference.plane import perpendicular, rotation_acceleration, rotation_velocity
from reference.scenes.pendulum.joint_forces import JointForces
from reference.scenes.pendulum.link import direction_of

Array = NDArray[np.float64]
Motion = Callable[[ArrayLike], Array]

# Up to so many links a call of numpy costs more than its numbers, and windows are fastest; beyond, an explicit method.
FEW_LINKS = 20
NUDGE = 1e-6  # rad, the difference of starts whose growth is measured: small against a swing, large against rounding
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

    @kept
    def _length(self) -> Array:
        return np.array(self.lengths, dtype=float)

    @kept
    def _mass(self) -> Array:
        return np.array(self.masses, dtype=float)

    @kept
    def inertia(self) -> Array:
        """About the centres of mass (links,) [kg m^2]."""
        return self._mass * self._length**2 / 12

    @validated
    def forces(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        """The force of every joint on the link below it (..., links, 2) [N], for angles and rates (..., links)."""
        angle, rate = self._alike(angle, rate)
        return self._joints.forces(angle, rate).astype(float)

    @cached_property
    def _joints(self) -> JointForces:
        return JointForces(self._length, self._mass, self.inertia, self.gravity)

    def _alike(self, *given: ArrayLike) -> list[Array]:
        """Angles, rates and accelerations as arrays; raises InvalidMechanism unless they have a number a link."""
        states = [np.asarray(state, dtype=float) for state in given]
        shapes = [state.shape for state in states]
        if any(shape != shapes[0] or shape[-1:] != (self.links,) for shape in shapes):
            raise InvalidMechanism(
                f"chain: angles and rates have the shapes {', '.join(map(str, shapes))}; "
                f"all must be of one shape (..., {self.links}), a number a link"
            )
        return states

    @validated
    def accelerations(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        """angle'' (..., links) [rad/s^2] from the joint forces."""
        angle, rate = self._alike(angle, rate)
        return self._accelerations(angle, rate).astype(float)

    def _accelerations(self, angle: Any, rate: Any) -> Any:
        """As precise as the forces are, of states as precise as they are given."""
        forces = self._joints.forces(angle, rate)
        forces[..., :-1, :] += forces[..., 1:, :]
        normal = perpendicular(0.5 * self._length[:, None] * direction_of(np.asarray(angle, dtype=forces.dtype)))
        return -np.sum(normal * forces, axis=-1) / self.inertia

    def rates(self, state: Array) -> Array:
        """d/dt of (angles, rates) (..., 2 links): what is integrated, so nothing is checked here."""
        angle, rate = state[..., : self.links], state[..., self.links :]
        return np.concatenate([rate, self._accelerations(angle, rate).astype(float)], axis=-1)

    def solved(self, angle: ArrayLike, rate: ArrayLike, until: float) -> Motion:
        """The motion up to `until` [s] from angles and rates (links,): times (times,) to states (times, 2 links)."""
        start = self._start(angle, rate)
        if self.links > FEW_LINKS:
            return integrate(self.rates, start, until, unit=units_of_motion(self.rates, start))
        by = self._by_windows(start, until)
        return lambda t: by(t).astype(float)

    def _by_windows(self, start: Array, until: float, coarse: bool = False) -> windows.Windows:
        """The same for a few links; `coarse`: by another rule that lets ten times as much pass."""
        angle, rate = np.split(start, 2)
        unit = float(units_of_motion(self.rates, start)[-1])
        stages, tolerance = (windows.COARSE_STAGES, windows.COARSER) if coarse else (windows.STAGES, 1.0)
        return windows.integrate(self._accelerations, angle, rate, until, unit, stages, tolerance * windows.TOLERANCE)

    @validated
    def motion(self, angle: ArrayLike, rate: ArrayLike, t: Times) -> tuple[Array, Array, Array]:
        """Angles, rates and accelerations (times, links) [rad, rad/s, rad/s^2] at times t (times,) [s].

        From any start, an angle [rad] and a rate [rad/s] a link (links,); integrated, see `truth_error`.
        """
        times = sample_times("chain", t)
        state = self.solved(angle, rate, max(float(times.max(initial=0.0)), math.ulp(1.0)))(times)
        angles, rates = state[:, : self.links], state[:, self.links :]
        return angles, rates, self._accelerations(angles, rates).astype(float)

    @kept
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

    @kept
    def stiffness(self) -> Array:
        """The weights K_i of the potential energy -sum K_i cos(angle_i) (links,) [N m]."""
        below = np.concatenate([np.cumsum(self._mass[::-1])[::-1][1:], [0.0]])
        return self.gravity * self._length * (self._mass / 2 + below)

    def modes(self) -> tuple[Array, Array]:
        """Small oscillations about hanging: frequencies (links,) [rad/s] ascending, and shapes (links, modes) of
        angles.
        """
        squares, shapes = eigh(np.diag(self.stiffness), self.inertia_matrix)
        return np.sqrt(squares), shapes

    @validated
    def energy(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        """Kinetic and potential energy (...) [J] by Lagrange's constants; zero potential at the pin."""
        angle, rate = self._alike(angle, rate)
        sine, cosine = np.sin(angle) * rate, np.cos(angle) * rate
        kinetic = 0.5 * (
            np.einsum("...i,ij,...j", cosine, self.inertia_matrix, cosine)
            + np.einsum("...i,ij,...j", sine, self.inertia_matrix, sine)
        )
        return kinetic - np.sum(self.stiffness * np.cos(angle), axis=-1)

    @validated
    def placement(self, angle: ArrayLike, rate: ArrayLike, acceleration: ArrayLike) -> tuple[Array, Array, Array]:
        """Poses, twists and accelerations of the centres of mass (..., links, 3), the body's x axis down the link."""
        angle, rate, acceleration = self._alike(angle, rate, acceleration)
        half = 0.5 * self._length[:, None] * direction_of(angle)

        def centres(steps: Array) -> Array:
            return 2 * np.cumsum(steps, axis=-2) - steps

        return (
            np.concatenate([centres(half), (angle - math.pi / 2)[..., None]], axis=-1),
            np.concatenate([centres(rotation_velocity(rate, half)), rate[..., None]], axis=-1),
            np.concatenate(
                [centres(rotation_acceleration(rate, acceleration, half)), acceleration[..., None]], axis=-1
            ),
        )

    @validated
    def divergence(self, angle: ArrayLike, rate: ArrayLike, t: Times, starts: Count = 3) -> Array:
        """How many times larger a small difference of starts has become at times t (times,) [s]: the worst of some.

        Measured, not guessed: `starts` neighbours are integrated beside the motion, their angles moved by NUDGE in
        fixed pseudo-random directions. The norm is the largest difference of an angle.
        """
        t, start = sample_times("chain", t), self._start(angle, rate)
        until = max(float(t.max(initial=0.0)), math.ulp(1.0))
        tolerance = NUDGE * 1e-4  # its error stays far below the difference that is measured
        generator = np.random.default_rng(0)
        together = np.tile(start, (starts + 1, 1))
        for neighbour in together[1:]:
            move = generator.uniform(-1, 1, self.links)
            neighbour[: self.links] += move * (NUDGE / np.abs(move).max())

        def rates(state: Array) -> Array:
            """Of all at once: a call costs hardly more than that of one."""
            return self.rates(state.reshape(*state.shape[:-1], *together.shape)).reshape(state.shape)

        unit = np.tile(units_of_motion(self.rates, start), starts + 1)
        motions = integrate(rates, together.reshape(-1), until, tolerance, unit)(t).reshape(len(t), *together.shape)
        apart = np.abs(motions[:, 1:] - motions[:, :1])[..., : self.links].max(axis=-1) / NUDGE
        return np.asarray(apart.max(axis=-1, initial=0.0))

    @validated
    def horizon(self, angle: ArrayLike, rate: ArrayLike, until: Positive) -> tuple[float, float]:
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

    @validated
    def truth_error(self, angle: ArrayLike, rate: ArrayLike, t: Times) -> Array:
        """A bound on the integrated motion's own error (times,) [rad, rad/s], from a tolerance 10 times coarser.

        Windows are at rounding with both tolerances: there it is ten times the difference, and not below rounding.
        """
        times, start = sample_times("chain", t), self._start(angle, rate)
        if self.links > FEW_LINKS:
            return error_of(self.rates, start, times, unit=units_of_motion(self.rates, start))
        until = max(float(times.max(initial=0.0)), math.ulp(1.0))
        return windows.bound(*(self._by_windows(start, until, coarse)(times) for coarse in (False, True)))

    def _start(self, angle: ArrayLike, rate: ArrayLike) -> Array:
        return np.concatenate(self._alike(angle, rate))
