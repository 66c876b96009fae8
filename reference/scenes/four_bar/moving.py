"""A four-bar of uniform bars in its one coordinate, the crank's angle theta: reduced inertia, potential, free motion.

With beta', phi' the rates (18.71), (18.70) for a unit rate of the crank, the kinetic energy is J(theta) theta'^2 / 2,

    J = m1 l1^2/3 + m2 (l1^2 + l1 l2 cos(beta - theta) beta' + l2^2 beta'^2/3) + m3 l3^2 phi'^2/3,

and Lagrange's equation J theta'' + J' theta'^2 / 2 + V' = torque. At a crank limit J is infinite; `free_motion`
has another coordinate and passes it.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import Signs, Valid, validated
from reference.joints import Vector
from reference.scenes.four_bar.forces import Densities, three_densities
from reference.scenes.four_bar.linkage import FourBar


@dataclass(frozen=True)
class MovingFourBar(Valid):
    """Uniform bars of `density` [kg/m], one number or three (crank, coupler, rocker), under `gravity` [m/s^2].

    Methods take crank angles theta [rad], rates and accelerations, which broadcast, and the branch; raise Unreachable.
    """

    four_bar: FourBar
    density: Densities = 1.0
    gravity: Vector = (0.0, -9.81)

    @property
    def masses(self) -> tuple[float, float, float]:
        """Of crank, coupler and rocker [kg]."""
        crank, coupler, rocker = three_densities(self.density)
        l1, l2, l3 = self.four_bar.lengths
        return crank * l1, coupler * l2, rocker * l3

    @validated
    def inertia(self, theta: ArrayLike, branch: Signs = 1) -> tuple[Any, Any]:
        """The reduced inertia J(theta) (...) [kg m^2] and its derivative by theta."""
        (l1, l2, l3), (m1, m2, m3) = self.four_bar.lengths, self.masses
        beta, _, beta_1, phi_1, beta_2, phi_2 = self.four_bar.kinematics(theta, 1.0, 0.0, branch)
        cosine, sine = np.cos(beta - theta), np.sin(beta - theta)
        value = m1 * l1**2 / 3 + m2 * (l1**2 + l1 * l2 * cosine * beta_1 + (l2 * beta_1) ** 2 / 3)
        coupling = l1 * l2 * (cosine * beta_2 - sine * (beta_1 - 1) * beta_1)
        slope = m2 * (coupling + 2 / 3 * l2**2 * beta_1 * beta_2) + 2 / 3 * m3 * l3**2 * phi_1 * phi_2
        return value + m3 * (l3 * phi_1) ** 2 / 3, slope

    @validated
    def potential(self, theta: ArrayLike, branch: Signs = 1) -> tuple[Any, Any]:
        """V(theta) (...) [J] and its derivative by theta; zero with all masses at A."""
        (l1, l2, l3), (m1, m2, m3) = self.four_bar.lengths, self.masses
        beta, phi, beta_1, phi_1, _, _ = self.four_bar.kinematics(theta, 1.0, 0.0, branch)
        # Plane vectors are complex numbers here: mass times the places of the middles, and their derivative.
        crank, coupler, rocker = (l1 * np.exp(1j * np.asarray(theta)), l2 * np.exp(1j * beta), l3 * np.exp(1j * phi))
        place = m1 * crank / 2 + m2 * (crank + coupler / 2) + m3 * (complex(*self.four_bar.ground) + rocker / 2)
        moved = 1j * ((m1 / 2 + m2) * crank + m2 * coupler * beta_1 / 2 + m3 * rocker * phi_1 / 2)
        pull = np.conj(complex(*self.gravity))
        return -(pull * place).real, -(pull * moved).real

    @validated
    def acceleration(self, theta: ArrayLike, rate: ArrayLike, branch: Signs = 1) -> Any:
        """theta'' (...) [rad/s^2] when nothing drives the crank."""
        inertia, slope = self.inertia(theta, branch)
        return -(slope * np.asarray(rate) ** 2 / 2 + self.potential(theta, branch)[1]) / inertia

    @validated
    def torque(self, theta: ArrayLike, rate: ArrayLike, acceleration: ArrayLike = 0.0, branch: Signs = 1) -> Any:
        """What the drive must give the crank (...) [N m] for this motion: `FourBar.drive_torque` by energy alone."""
        inertia, slope = self.inertia(theta, branch)
        return inertia * np.asarray(acceleration) + slope * np.asarray(rate) ** 2 / 2 + self.potential(theta, branch)[1]
