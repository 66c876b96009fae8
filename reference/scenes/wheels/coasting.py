"""Bodies on ideal wheels that coast freely, without any multiplier: Newton's law along the allowed motions only.

With the allowed velocities v = N(c) nu, nu the quasi-velocities and c a few coordinates that move as c' = C(c) nu, the
wheels do no work in the columns of N, so (Kane and Levinson, Dynamics; Neimark and Fufaev)

    (N^T M N) nu' = -N^T M N' nu,

where N is derived by hand for each vehicle. The joints' rows are not used, so a motion from here checks them.
"""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.numerics.integration import Integrated, error_of, integrate
from reference.scene import Scene
from reference.trajectory import Trajectory

Array = NDArray[np.float64]

COMPLEX_STEP = 1e-100


class CoastingScene(Scene):
    """A scene whose truth is integrated in quasi-velocities. The state is (c, nu)."""

    @property
    @abstractmethod
    def start(self) -> Array:
        """c and nu at t = 0 (states,)."""

    @property
    @abstractmethod
    def inertias(self) -> Array:
        """The diagonal of the mass matrix (3 bodies,)."""

    @abstractmethod
    def coordinate_rates(self, coordinates: NDArray[Any], quasi: NDArray[Any]) -> NDArray[Any]:
        """c' (..., coordinates)."""

    @abstractmethod
    def allowed(self, coordinates: NDArray[Any]) -> NDArray[Any]:
        """N (..., 3 bodies, quasi-velocities), analytic in c."""

    @abstractmethod
    def poses(self, coordinates: Array) -> Array:
        """(..., bodies, 3)."""

    @property
    @abstractmethod
    def coordinates(self) -> int:
        """How many of the state's numbers are c."""

    def rates(self, state: Array) -> Array:
        """The state's rate (..., states)."""
        c, nu = state[..., : self.coordinates], state[..., self.coordinates :]
        return np.concatenate([self.coordinate_rates(c, nu), self._accelerations(c, nu)[0]], axis=-1)

    def _accelerations(self, c: Array, nu: Array) -> tuple[Array, Array, Array]:
        """nu' (..., quasi), v and v' (..., 3 bodies)."""
        stepped = self.allowed(c + 1j * COMPLEX_STEP * self.coordinate_rates(c, nu))
        allowed, changing = np.real(stepped), np.imag(stepped) / COMPLEX_STEP
        weighted = np.swapaxes(allowed * self.inertias[:, None], -1, -2)
        centripetal = changing @ nu[..., None]
        nu_rate: Array = np.asarray(np.linalg.solve(weighted @ allowed, -(weighted @ centripetal)), dtype=np.float64)
        return nu_rate[..., 0], (allowed @ nu[..., None])[..., 0], (allowed @ nu_rate + centripetal)[..., 0]

    @cached_property
    def _integrated(self) -> Integrated:
        return integrate(self.rates, self.start, self.duration)

    def states(self, t: ArrayLike) -> Array:
        """(times, states) at times t >= 0."""
        return self._states(self.times(t))

    def _states(self, times: Array) -> Array:
        last = float(times.max(initial=0.0))
        motion = self._integrated if last <= self.duration else integrate(self.rates, self.start, last)
        return motion(times)

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound on this truth's own error (times,) [m, rad]: what a coarser tolerance changes."""
        return error_of(self.rates, self.start, self.times(t))

    def _motion(self, times: Array) -> Trajectory:
        state = self._states(times)
        c, nu = state[:, : self.coordinates], state[:, self.coordinates :]
        _, velocity, acceleration = self._accelerations(c, nu)
        pose = self.poses(c)
        twist, acceleration = velocity.reshape(pose.shape), acceleration.reshape(pose.shape)
        reaction = self.mechanism().reaction(pose, acceleration)
        return Trajectory(times, pose, twist, reaction)

    def motion_with_error(self, t: ArrayLike) -> Trajectory:
        """The motion, with its own error as the trajectory's estimate."""
        motion = self.motion(t)
        error = self.truth_error(t)[:, None, None]
        return replace(motion, estimate=np.broadcast_to(error, motion.pose.shape).copy())
