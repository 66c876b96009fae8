"""Where one curve touches another that it rolls on, at given rotations."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from reference.rolling.curves import Array


@dataclass(frozen=True)
class Contact:
    """The contact at rotations (...) [rad] of the body, everything in the ground's frame unless it says otherwise."""

    theta: Array
    ground_arc: Array  # (...) m
    body_arc: Array  # (...) m; ground_arc + body_arc is constant
    point: Array  # (..., 2) m, where the curves touch
    arm: Array  # (..., 2) m, r_{O'/C}: the body's origin seen from the contact
    tangent_angle: Array  # (...) rad, of e_t: the direction in which the ground is traversed
    ground_curvature: Array  # (...) 1/m
    body_curvature: Array  # (...) 1/m

    @property
    def rate(self) -> Array:
        """ds/dtheta = 1 / (curvature_A + curvature_B) (...) [m/rad]."""
        return 1 / (self.ground_curvature + self.body_curvature)

    @property
    def tangent(self) -> Array:
        """e_t (..., 2)."""
        return np.stack([np.cos(self.tangent_angle), np.sin(self.tangent_angle)], axis=-1)

    @property
    def normal(self) -> Array:
        """e_n (..., 2), towards the interior of the body: -k x e_t whatever the curves are."""
        return np.stack([np.sin(self.tangent_angle), -np.cos(self.tangent_angle)], axis=-1)

    @property
    def conformality(self) -> Array:
        """(curvature_A + curvature_B) / max(|curvature|) (...): 1 on flat ground, 0 when the curves fit each other."""
        largest = np.maximum(np.abs(self.ground_curvature), np.abs(self.body_curvature))
        return (self.ground_curvature + self.body_curvature) / largest
