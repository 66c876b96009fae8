"""Boundaries by arc length that are not closed: parabola and catenary, and a spline of degree 7 through points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive, cached_readonly
from reference.numerics.roots import solve_increasing
from reference.rolling.curves import ByArc, Curve, along, within
from reference.validators import Array, of_shape

if TYPE_CHECKING:
    from scipy.interpolate import BSpline


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


SPLINE_DEGREE = 7
# Minimum number of points of a curve, so that a spline through half of the points can show the error.
FEWEST = 16
NODES, WEIGHTS = np.polynomial.legendre.leggauss(12)
# Smallest speed along the curve, relative to the mean speed, at which the tangent is determined.
STILL = 1e-6


def spline(parameters: Array, values: Array) -> BSpline:
    """The interpolating spline of degree 7 through values (n, ...) at increasing parameters (n,)."""
    from scipy.interpolate import make_interp_spline

    return make_interp_spline(parameters, values, k=SPLINE_DEGREE)


@dataclass(frozen=True, eq=False)
class Traced(Curve):
    """The smooth curve through `points` (n, 2) [m] at increasing `parameters` (n,), traversed in their order.

    Arc 0 is the first point; the curve ends at the last one. Raises InvalidMechanism for fewer than 16 points, numbers
    not finite, parameters that don't increase, and a point at which the speed is zero or the curve has a cusp.
    """

    parameters: Annotated[Array, of_shape("n")]
    points: Annotated[Array, of_shape("n", 2)]

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.parameters)
        if count < FEWEST or self.points.shape != (count, 2):
            raise InvalidMechanism(
                f"traced curve: {count} parameters and points of shape {self.points.shape}; "
                f"give (n, 2) points with n of at least {FEWEST}"
            )
        if np.any(np.diff(self.parameters) <= 0):
            where = int(np.argmax(np.diff(self.parameters) <= 0))
            raise InvalidMechanism(f"traced curve: parameter {where + 1} is not greater than the one before it")
        middles = 0.5 * (self.parameters[1:] + self.parameters[:-1])
        examined = np.concatenate([self.parameters, middles])
        speed = self.speed_of(examined)
        extent = float(np.ptp(self.points, axis=0).max())
        mean = float(np.sum(np.linalg.norm(np.diff(self.points, axis=0), axis=-1)) / np.ptp(self.parameters))
        if extent <= 1e-9 * float(np.abs(self.points).max()) or np.min(speed) <= STILL * mean:
            x, y = self.point_of(examined[int(np.argmin(speed))])
            raise InvalidMechanism(
                f"traced curve: it stands still or has a cusp near ({x:.6g}, {y:.6g}) m, at parameter "
                f"{examined[int(np.argmin(speed))]:.6g}; a boundary must have a tangent everywhere, so cut it there"
            )
        tangents = self._tangents(self.parameters)
        cosine = np.sum(tangents[:-1] * tangents[1:], axis=-1)
        if np.any(cosine <= 0):
            where = int(np.argmax(cosine <= 0))
            raise InvalidMechanism(
                f"traced curve: between points {where} and {where + 1} it turns by a quarter or more: a cusp or "
                "a corner, or too few points; cut it there or give more"
            )

    @cached_property
    def _splines(self) -> tuple[BSpline, BSpline, BSpline]:
        line = spline(self.parameters, self.points)
        return line, line.derivative(1), line.derivative(2)

    def _tangents(self, p: Array) -> Array:
        return self._splines[1](p)

    @cached_readonly
    def _knots(self) -> tuple[Array, Array]:
        start, width = self.parameters[:-1, None], np.diff(self.parameters)[:, None]
        pieces = np.sum(WEIGHTS * self.speed_of(start + 0.5 * width * (NODES + 1)), axis=-1) * width[:, 0] / 2
        tangent = self._tangents(self.parameters)
        return np.concatenate([[0.0], np.cumsum(pieces)]), np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))

    @property
    def limits(self) -> tuple[float, float]:
        return (0.0, float(self._knots[0][-1]))

    @property
    def curvature_range(self) -> tuple[float, float]:
        return self._bends

    @cached_property
    def _bends(self) -> tuple[float, float]:
        curvature = self.curvature_of(
            np.concatenate([self.parameters, 0.5 * (self.parameters[1:] + self.parameters[:-1])])
        )
        return (float(curvature.min()), float(curvature.max()))

    def _interval(self, p: Array) -> Any:
        return np.clip(np.searchsorted(self.parameters, p, side="right") - 1, 0, len(self.parameters) - 2)

    def arc_of(self, p: ArrayLike) -> Array:
        p = along(p)
        knot = self._interval(p)
        start = self.parameters[knot]
        width = p - start
        places = start[..., None] + 0.5 * width[..., None] * (NODES + 1)
        return self._knots[0][knot] + np.sum(WEIGHTS * self.speed_of(places), axis=-1) * width / 2

    def speed_of(self, p: ArrayLike) -> Array:
        return np.linalg.norm(self._splines[1](along(p)), axis=-1)

    def parameter(self, arc: ArrayLike) -> Array:
        arc = within("traced curve", arc, self.limits, "where its points end")
        arcs, ends = self._knots[0], (float(self.parameters[0]), float(self.parameters[-1]))
        guess = np.interp(arc, arcs, self.parameters)
        scale = ends[1] - ends[0]
        return solve_increasing(
            lambda p: (self.arc_of(p), self.speed_of(p)), np.clip(arc, *self.limits), guess, scale, ends
        )

    def parameter_at(self, angle: ArrayLike) -> Array:
        angle = along(angle)
        low, high = self.curvature_range
        if low * high <= 0:
            raise InvalidMechanism("traced curve: it bends both ways, so its direction does not determine a point")
        sense, angles = math.copysign(1.0, low + high), self._knots[1]
        if np.any((sense * angle < sense * angles[0]) | (sense * angle > sense * angles[-1])):
            raise InvalidMechanism(
                f"traced curve: its tangent has angles from {angles[0]:.6g} to {angles[-1]:.6g} rad only; stay "
                "between them"
            )
        return solve_increasing(
            lambda p: (sense * self.angle_of(p), sense * self.curvature_of(p) * self.speed_of(p)),
            sense * angle,
            np.interp(sense * angle, sense * angles, self.parameters),
            float(np.ptp(self.parameters)),
            (float(self.parameters[0]), float(self.parameters[-1])),
        )

    def point_of(self, p: ArrayLike) -> Array:
        return self._splines[0](along(p))

    def angle_of(self, p: ArrayLike) -> Array:
        p = along(p)
        knot = self._interval(p)
        at_knot, tangent = self._tangents(self.parameters[knot]), self._tangents(p)
        crossed = at_knot[..., 0] * tangent[..., 1] - at_knot[..., 1] * tangent[..., 0]
        return self._knots[1][knot] + np.arctan2(crossed, np.sum(at_knot * tangent, axis=-1))

    def curvature_of(self, p: ArrayLike) -> Array:
        p = along(p)
        first, second = self._splines[1](p), self._splines[2](p)
        return (first[..., 0] * second[..., 1] - first[..., 1] * second[..., 0]) / self.speed_of(p) ** 3
