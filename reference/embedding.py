"""Reference motions in minimal coordinates without joint forces, by the embedding method.

The allowed velocities of all bodies are V = T(c) nu, with coordinates c, quasi-velocities nu, and c' = nu unless a
scene defines other rates. Ideal joints do no work at these velocities. So (Kane and Levinson, Dynamics; Neimark and
Fufaev)

T^T M T nu' = T^T (f - M T' nu).

T is derived by hand for each mechanism. The rate T' is computed by a complex step along the motion, which is exact. The
motion does not use the joints' rows, so it checks the rows independently.
"""

from __future__ import annotations

from abc import abstractmethod
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.numerics import gauss_collocation as gauss
from reference.numerics.integration import units_of_motion
from reference.plane import COMPLEX_STEP
from reference.scene import PlacedScene, shared
from reference.validators import Array


class EmbeddedScene(PlacedScene):
    """A scene whose state is (c, nu), and whose `mechanism` gives the masses M and the forces f."""

    @property
    @abstractmethod
    def start(self) -> Array:
        """The state (states,) at t = 0: c, then nu."""

    @abstractmethod
    def tangent(self, coordinates: Any) -> tuple[Any, Any]:
        """Poses (..., bodies, 3) and T (..., 3 bodies, freedoms) at c (..., coordinates), analytic in c."""

    def coordinate_rates(self, coordinates: NDArray[Any], velocities: NDArray[Any]) -> NDArray[Any]:
        """The rates c' (..., coordinates) at c and nu."""
        return velocities

    @property
    def freedoms(self) -> int:
        """The number of quasi-velocities nu."""
        return len(self.start) // 2

    @property
    def angle_unit(self) -> float:
        """The unit of the coordinates [rad or m], to which the integration's tolerance is relative."""
        return 1.0

    def _split(self, state: Array) -> tuple[Array, Array]:
        return state[..., : -self.freedoms], state[..., -self.freedoms :]

    def embedded(
        self, coordinates: Array, velocities: Array, changes: Array | None = None
    ) -> tuple[Array, Array, Array, Array]:
        """nu' (..., freedoms), and poses, twists and accelerations (..., bodies, 3) at c and nu.

        nu' follows from masses and forces unless `changes` (..., freedoms) prescribes it.
        """
        mechanism = self._mechanism
        rates = self.coordinate_rates(coordinates, velocities)
        pose, stepped = self.tangent(coordinates + 1j * COMPLEX_STEP * rates)
        tangent, changing = stepped.real, stepped.imag / COMPLEX_STEP
        pose = np.real(pose)
        bias = changing @ velocities[..., None]
        twist = (tangent @ velocities[..., None]).reshape(pose.shape)
        if changes is None:
            weighted = np.swapaxes(tangent * mechanism.inertias.reshape(-1, 1), -1, -2)
            free = mechanism.unconstrained(pose, twist)
            missing = free.reshape((*free.shape[:-2], -1, 1)) - bias
            changes = np.asarray(np.linalg.solve(weighted @ tangent, weighted @ missing)[..., 0], dtype=float)
        return changes, pose, twist, (tangent @ changes[..., None] + bias).reshape(pose.shape)

    def accelerations(self, coordinates: Array, velocities: Array) -> Array:
        """nu' (..., freedoms) from masses and forces."""
        return self.embedded(coordinates, velocities)[0]

    def rates(self, state: Array) -> Array:
        """The rates (..., states) of (c, nu)."""
        coordinates, velocities = self._split(state)
        moved = self.coordinate_rates(coordinates, velocities)
        return np.concatenate([moved, self.accelerations(coordinates, velocities)], axis=-1)

    def solved(self, until: float) -> gauss.Motion:
        """The motion up to `until` [s], a function from times to states: see `gauss_collocation.motion`."""
        return gauss.motion(self.rates, self.start, until, units_of_motion(self.rates, self.start, self.angle_unit))

    def states(self, t: ArrayLike) -> tuple[Array, Array]:
        """c and nu (times, ...) at times t >= 0 [s]."""
        return self._states(self.times(t))

    def _states(self, times: Array) -> tuple[Array, Array]:
        if not times.any():  # a mechanism needs only the start
            return self._split(np.tile(self.start, (len(times), 1)))
        return self._split(shared(type(self).solved, self, max(self.duration, float(times.max())))(times))

    def truth_error(self, t: ArrayLike) -> Array:
        """A bound (times,) on the error of c and nu, from integrations by two collocation rules."""
        units = units_of_motion(self.rates, self.start, self.angle_unit)
        return gauss.error_of(self.rates, self.start, self.times(t), units)

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        return self.embedded(*self._states(times))[1:]
