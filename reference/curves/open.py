"""Curved boundaries that don't close: Parabola, Catenary, LogSpiral, for the classical roulettes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reference.curves.curve import Array, ByArc, Curve, Vector, along, within
from reference.numerics.monotone import solve_increasing
from reference.validation import InvalidMechanism, Positive


def _slope(owner: str, angle: ArrayLike) -> Array:
    """tan(angle), refused at a quarter turn and beyond: these curves never get so steep."""
    angle = along(angle)
    if not np.all(np.abs(angle) < math.pi / 2):
        worst = float(angle.flat[int(np.argmax(np.abs(angle)))])
        raise InvalidMechanism(f"{owner}: its tangent never has the angle {worst!r} rad; it stays within +-pi/2")
    return np.tan(angle)


@dataclass(frozen=True)
class Parabola(Curve):
    """y = x^2 / (4 focal) [m] with its material above, traversed to +x; arc 0 is the vertex, (0, focal) the focus."""

    focal: Positive

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (0.0, 1 / (2 * self.focal))

    @property
    def focus(self) -> Vector:
        return (0.0, self.focal)

    def parameter(self, arc: ArrayLike) -> Array:
        """asinh(slope), in which arc = focal (p + sinh(2p)/2)."""
        scaled = along(arc) / self.focal
        # Exact at both ends: the arc is 2p for small p and exp(2p)/4 for large.
        guess = np.sign(scaled) * np.minimum(np.abs(scaled) / 2, np.log1p(2 * np.abs(scaled)))
        return solve_increasing(lambda q: (q + 0.5 * np.sinh(2 * q), 1 + np.cosh(2 * q)), scaled, guess, 1e-3)

    def parameter_at(self, angle: ArrayLike) -> Array:
        return np.arcsinh(_slope("parabola", angle))

    def arc_of(self, p: ArrayLike) -> Array:
        p = along(p)
        return self.focal * (p + 0.5 * np.sinh(2 * p))

    def speed_of(self, p: ArrayLike) -> Array:
        return self.focal * (1 + np.cosh(2 * along(p)))

    def point_of(self, p: ArrayLike) -> Array:
        slope = np.sinh(along(p))
        return self.focal * np.stack([2 * slope, slope**2], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return np.arctan(np.sinh(along(p)))

    def curvature_of(self, p: ArrayLike) -> Array:
        return 1 / (2 * self.focal * np.cosh(along(p)) ** 3)


@dataclass(frozen=True)
class Catenary(ByArc):
    """y = scale cosh(x / scale) [m] with its material above, traversed to +x; arc 0 is the vertex (0, scale)."""

    scale: Positive

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (0.0, 1 / self.scale)

    def point_of(self, p: ArrayLike) -> Array:
        arc = along(p)
        return np.stack([self.scale * np.arcsinh(arc / self.scale), np.hypot(self.scale, arc)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return np.arctan(along(p) / self.scale)

    def curvature_of(self, p: ArrayLike) -> Array:
        return self.scale / (self.scale**2 + along(p) ** 2)

    def parameter_at(self, angle: ArrayLike) -> Array:
        return self.scale * _slope("catenary", angle)


@dataclass(frozen=True)
class LogSpiral(ByArc):
    """r = radius exp(growth phi) [m] about its pole, the origin, traversed outwards; arc is measured from the pole.

    The pole itself, arc 0, is refused: the curvature 1 / (growth arc) is infinite there.
    """

    radius: Positive
    growth: Positive

    @property
    def limits(self) -> tuple[float, float]:
        return (0.0, math.inf)

    @property
    def curvature_range(self) -> tuple[float, float]:
        return (0.0, math.inf)

    @property
    def _per_arc(self) -> float:
        """Radius per arc."""
        return self.growth / math.hypot(1, self.growth)

    def _polar(self, arc: ArrayLike) -> tuple[Array, Array]:
        arc = within("logarithmic spiral", arc, self.limits, "at the pole; arcs must be greater than zero")
        if np.any(arc <= 0):
            raise InvalidMechanism(
                "logarithmic spiral: arc 0 is its pole, of infinite curvature; arcs must be positive"
            )
        radius = self._per_arc * arc
        return radius, np.log(radius / self.radius) / self.growth

    def point_of(self, p: ArrayLike) -> Array:
        radius, polar = self._polar(p)
        return np.stack([radius * np.cos(polar), radius * np.sin(polar)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return self._polar(p)[1] + math.atan2(1, self.growth)

    def curvature_of(self, p: ArrayLike) -> Array:
        radius, _ = self._polar(p)
        return 1 / (radius * math.hypot(1, self.growth))

    def parameter_at(self, angle: ArrayLike) -> Array:
        polar = along(angle) - math.atan2(1, self.growth)
        return self.radius * np.exp(self.growth * polar) / self._per_arc
