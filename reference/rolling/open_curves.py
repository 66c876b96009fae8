"""Parabola, catenary and logarithmic spiral as boundaries, for the classical roulettes."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive
from reference.numerics.roots import solve_increasing
from reference.rolling.curves import Array, ByArc, Curve, along, within


def _slope(owner: str, angle: ArrayLike) -> Array:
    """tan(angle); raises InvalidMechanism for angles of a quarter turn or more, which these curves don't have."""
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

    def parameter(self, arc: ArrayLike) -> Array:
        """p = asinh(slope), with arc = focal (p + sinh(2p)/2)."""
        scaled = along(arc) / self.focal
        # For small p, arc / focal is 2p. For large p, arc / focal is exp(2p)/4, so a logarithm limits the guess.
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
class LogSpiral(Curve):
    """r = radius exp(growth p) [m] about its pole, the origin, traversed outwards. Arcs are measured from the pole.

    The natural parameter p is the polar angle [rad], which tends to -infinity at the pole. The pole, arc 0, is refused,
    since the curvature 1 / (growth arc) is infinite there.
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
    def _stretch(self) -> float:
        return math.hypot(1, self.growth) / self.growth

    def _refuse_pole(self, arc: ArrayLike) -> None:
        if np.any(along(arc) == 0):
            raise InvalidMechanism(
                "logarithmic spiral: arc 0 is its pole, of infinite curvature; arcs must be positive"
            )

    def angle(self, arc: ArrayLike) -> Array:
        self._refuse_pole(arc)
        return super().angle(arc)

    def curvature(self, arc: ArrayLike) -> Array:
        self._refuse_pole(arc)
        return super().curvature(arc)

    def parameter(self, arc: ArrayLike) -> Array:
        arc = within("logarithmic spiral", arc, self.limits, "at the pole; arcs must be greater than zero")
        with np.errstate(divide="ignore"):
            return np.log(arc / (self._stretch * self.radius)) / self.growth

    def parameter_at(self, angle: ArrayLike) -> Array:
        return along(angle) - math.atan2(1, self.growth)

    def arc_of(self, p: ArrayLike) -> Array:
        return self._stretch * self.radius * np.exp(self.growth * along(p))

    def speed_of(self, p: ArrayLike) -> Array:
        return self.growth * self.arc_of(p)

    def point_of(self, p: ArrayLike) -> Array:
        p = along(p)
        radius = self.radius * np.exp(self.growth * p)
        turn = np.where(np.isfinite(p), p, 0.0)  # at the pole the radius is zero, and the angle is arbitrary
        return np.stack([radius * np.cos(turn), radius * np.sin(turn)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return along(p) + math.atan2(1, self.growth)

    def curvature_of(self, p: ArrayLike) -> Array:
        with np.errstate(divide="ignore"):
            return 1 / (self.growth * self.arc_of(p))
