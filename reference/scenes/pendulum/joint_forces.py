"""The joint forces of N links hanging from one another, by one banded solve.

Angles are absolute, from the downward vertical, counter-clockwise. Link i has its upper end at joint i, half-vector
h = (l/2)(sin, -cos) down to its centre of mass and on to its lower end; F_i is the force of joint i on link i. Newton
and Euler, m a = F_i - F_(i+1) + m g and I angle'' = -h x (F_i + F_(i+1)), and equal accelerations where two links meet
give a block-tridiagonal, symmetric, positive definite system for the forces: J M^-1 J^T of the chain, without forming
J.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_solve_banded, cholesky_banded, solveh_banded

from reference.plane import perpendicular, rotation_acceleration
from reference.scenes.pendulum.link import direction_of

Array = NDArray[np.float64]

# Beyond this ratio of masses the forces are refined: a light link passes a heavy one's force on as a small difference.
UNEVEN = 10.0
REFINEMENTS = 3  # each removes about as many digits as the first solution has: enough up to a ratio of 1e9
# A correction this small, in parts of the forces, is the last: the next would be its square, below extended rounding.
CORRECTED = 3e-10


@dataclass(frozen=True, eq=False)
class JointForces:
    """Of uniform bars of `length` [m], `mass` [kg] and `inertia` [kg m^2] (links,); gravity [m/s^2] downwards."""

    length: Array
    mass: Array
    inertia: Array
    gravity: float

    def forces(self, angle: Array, rate: Array) -> Any:
        """Of every joint on the link below it (..., links, 2) [N], for angles and rates (..., links), not yet rounded.

        A light link's acceleration is a small difference of these, so where masses are far apart they have more digits
        than a double.

        All states of a batch are one banded system, their blocks side by side: O(states x links). A mass ratio r loses
        about r roundings in it; with masses more than UNEVEN apart the solution is refined with the error of the
        joints' accelerations in extended precision, which leaves r / 2000 roundings (r where numpy.longdouble is the
        ordinary double).
        """
        leading = angle.shape[:-1]
        links, uneven = len(self.mass), self.mass.max() > UNEVEN * self.mass.min()
        doubles, rate = angle.astype(float, copy=False), rate if uneven else rate.astype(float, copy=False)
        half = 0.5 * self.length[:, None] * direction_of(doubles)
        normal = perpendicular(half)
        outer = normal[..., :, None] * normal[..., None, :] / self.inertia[:, None, None]
        light = np.eye(2) / self.mass[:, None, None]
        near, far = light + outer, outer - light  # acceleration of one end from a force on the same, on the other end
        diagonal = near.copy()
        diagonal[..., 1:, :, :] += near[..., :-1, :, :]
        banded = np.zeros((4, *leading, links, 2))  # upper form: row 3 is the diagonal
        banded[3, ..., 0], banded[3, ..., 1] = diagonal[..., 0, 0], diagonal[..., 1, 1]
        banded[2, ..., 1] = diagonal[..., 0, 1]
        banded[2, ..., 1:, 0] = far[..., :-1, 1, 0]
        banded[1, ..., 1:, 0], banded[1, ..., 1:, 1] = far[..., :-1, 0, 0], far[..., :-1, 1, 1]
        banded[0, ..., 1:, 1] = far[..., :-1, 0, 1]
        if not uneven:
            centripetal = rate[..., None] ** 2 * half
            right = -centripetal
            right[..., 1:, :] -= centripetal[..., :-1, :]
            right[..., 0, 1] += self.gravity  # gravity is the same on both sides of every other joint
            solution = solveh_banded(
                banded.reshape(4, -1), right.reshape(-1), overwrite_ab=True, overwrite_b=True, check_finite=False
            )
            return solution.reshape(*leading, links, 2)
        factor = cholesky_banded(banded.reshape(4, -1), overwrite_ab=True, check_finite=False)
        forces = np.zeros((*leading, links, 2), dtype=np.longdouble)
        parting = self._parting(angle, rate)
        for _ in range(1 + REFINEMENTS):
            missing = parting(forces).astype(float)
            correction = cho_solve_banded((factor, False), missing.reshape(-1), check_finite=False)
            forces -= correction.reshape(forces.shape)
            each = (-1, 2 * links)
            small = CORRECTED * np.abs(forces.reshape(each)).max(axis=1)
            if np.all(np.abs(correction.reshape(each)).max(axis=1) <= small):
                break
        return forces

    def _parting(self, angle: Array, rate: Array) -> Callable[[Any], Any]:
        """How fast the joints would part under forces (..., links, 2) [m/s^2], in extended precision: a function."""
        half = self.length[:, None] / np.longdouble(2) * direction_of(np.asarray(angle, dtype=np.longdouble))
        normal = perpendicular(half)
        centripetal = rotation_acceleration(np.asarray(rate, dtype=np.longdouble), np.zeros_like(half[..., 0]), half)
        turned, light = normal / self.inertia[:, None], 1 / self.mass.astype(np.longdouble)[:, None]

        def parting(forces: Any) -> Any:
            below = np.zeros_like(forces)
            below[..., :-1, :] = forces[..., 1:, :]
            centre = (forces - below) * light
            alpha = -(turned * (forces + below)).sum(axis=-1)
            lever = centripetal + alpha[..., None] * normal
            out = centre - lever  # the upper end's acceleration, but for gravity, which all links share
            out[..., 1:, :] -= (centre + lever)[..., :-1, :]
            out[..., 0, 1] -= self.gravity
            return out

        return parting
