"""Ellipses and smooth convex cams as boundaries that are described by arc length.

The arc of an ellipse is an elliptic integral, continued over any number of turns. The support function of a cam is a
Fourier series. All functions of a cam but the inverse of the arc have a closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive, cached_readonly
from reference.numerics.roots import solve_increasing
from reference.rolling.curves import Curve, along
from reference.validators import Array

# Number of tabulated points in half a turn. Cubic interpolation between the points has an error of at most 1e-9, except
# for very flat ellipses.
GUESSES = 257


@dataclass(frozen=True)
class Ellipse(Curve):
    """(a cos u, b sin u) [m] with the natural parameter u, counter-clockwise; semi-axes `along_x` = a, `along_y` = b.

    Arc 0 is the point (a, 0), where the tangent angle is pi/2. Arc = b E(u | 1 - a^2/b^2). The incomplete integral is
    evaluated within half a turn only, so that the relative error does not grow with the number of turns.
    """

    along_x: Positive
    along_y: Positive

    def __post_init__(self) -> None:
        super().__post_init__()
        ratio = max(self.along_x / self.along_y, self.along_y / self.along_x)
        if ratio > 1e3:
            raise InvalidMechanism(
                f"ellipse: its axes differ by a factor {ratio:.3g}, so its ends are nearly of infinite curvature; "
                "the factor must be at most 1e3"
            )

    @cached_property
    def _round(self) -> float:
        from scipy.special import ellipe

        a, b = self.along_x, self.along_y
        return float(4 * max(a, b) * ellipe(1 - min(a / b, b / a) ** 2))

    @property
    def curvature_range(self) -> tuple[float, float]:
        flat, sharp = sorted((self.along_y / self.along_x**2, self.along_x / self.along_y**2))
        return (flat, sharp)

    def speed_of(self, p: ArrayLike) -> Array:
        u = along(p)
        return np.hypot(self.along_x * np.sin(u), self.along_y * np.cos(u))

    def arc_of(self, p: ArrayLike) -> Array:
        from scipy.special import ellipeinc, elliprd, elliprf

        u = along(p)
        half_turns = np.round(u / math.pi)
        rest = u - half_turns * math.pi
        a, b = self.along_x, self.along_y
        if a <= b:
            part = b * ellipeinc(rest, 1 - (a / b) ** 2)
        else:  # Carlson's form has two positive terms, so short arcs at a sharp end have no cancellation.
            sine, cosine = np.sin(rest), np.cos(rest)
            square, excess = (a / b) ** 2, (a - b) * (a + b) / b**2
            slope = cosine**2 + square * sine**2
            ones = np.ones_like(slope)
            part = b * sine * (elliprf(cosine**2, slope, ones) + excess / 3 * sine**2 * elliprd(cosine**2, slope, ones))
        return half_turns * (self.length / 2) + part

    @property
    def length(self) -> float:
        return self._round

    def parameter(self, arc: ArrayLike) -> Array:
        arc = along(arc)
        # The search is within half a turn, so that the error does not grow with the number of turns.
        half_turns = np.round(arc / (self.length / 2))
        rest = arc - half_turns * (self.length / 2)
        root = solve_increasing(lambda u: (self.arc_of(u), self.speed_of(u)), rest, self._guess(rest), 1e-3)
        return root + half_turns * math.pi

    @cached_readonly
    def _half_turn(self) -> tuple[Array, Array, Array]:
        u = np.linspace(-math.pi / 2, math.pi / 2, GUESSES)
        return u, self.arc_of(u), self.speed_of(u)

    def _guess(self, rest: Array) -> Array:
        u, arcs, speeds = self._half_turn
        index = np.clip(np.searchsorted(arcs, rest) - 1, 0, GUESSES - 2)
        width, part = arcs[index + 1] - arcs[index], rest - arcs[index]
        x = np.clip(part / width, 0.0, 1.0)
        first, second = width / speeds[index], width / speeds[index + 1]  # slopes
        step = u[1] - u[0]
        return u[index] + x * (first + x * (3 * step - 2 * first - second + x * (first + second - 2 * step)))

    def parameter_at(self, angle: ArrayLike) -> Array:
        normal = along(angle) - math.pi / 2
        return _unwrapped(np.arctan2(self.along_y * np.sin(normal), self.along_x * np.cos(normal)), normal)

    def point_of(self, p: ArrayLike) -> Array:
        u = along(p)
        return np.stack([self.along_x * np.cos(u), self.along_y * np.sin(u)], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        u = along(p)
        direction = np.arctan2(self.along_y * np.cos(u), -self.along_x * np.sin(u))
        return _unwrapped(direction, u + math.pi / 2)

    def curvature_of(self, p: ArrayLike) -> Array:
        return self.along_x * self.along_y / self.speed_of(p) ** 3


def _unwrapped(angle: Array, about: Array) -> Array:
    return angle + 2 * math.pi * np.round((about - angle) / (2 * math.pi))


@dataclass(frozen=True)
class Cam(Curve):
    """The convex curve whose tangent with the outward normal nu has the distance h(nu) [m] from the origin:

    h = radius + sum over k = 1.. of cosines[k-1] cos(k nu) + sines[k-1] sin(k nu),

    and nu is the natural parameter.

    The first terms shift the cam (cosines=(e,) is a disc with eccentricity e); the second terms make the cam oval, and
    the third terms make it three-lobed. The radius of curvature is h + h'', and the arc is the integral of h + h''. The
    normal points to +x at arc 0. Raises InvalidMechanism if the radius of curvature is not positive everywhere.
    """

    radius: Positive
    cosines: tuple[float, ...] = ()
    sines: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        low, _ = self._bend_range
        if not low[0] > 1e-9 * self.radius:
            raise InvalidMechanism(
                f"cam: its radius of curvature falls to {low[0]:.6g} m where the normal points to {low[1]:.6g} "
                "rad, so it is not convex there; reduce the higher harmonics until "
                "radius + sum (1 - k^2) c_k stays positive"
            )

    @cached_readonly
    def _harmonics(self) -> tuple[Array, Array, Array]:
        count = max(len(self.cosines), len(self.sines))
        cosines, sines = np.zeros(count), np.zeros(count)
        cosines[: len(self.cosines)], sines[: len(self.sines)] = self.cosines, self.sines
        return np.arange(1.0, count + 1), cosines, sines

    def _series(self, normal: Array, order: int) -> Array:
        k, cosines, sines = self._harmonics
        phase = normal[..., None] * k + order * math.pi / 2
        return np.sum(k**order * (cosines * np.cos(phase) + sines * np.sin(phase)), axis=-1)

    def speed_of(self, p: ArrayLike) -> Array:
        normal = along(p)
        return self.radius + self._series(normal, 0) + self._series(normal, 2)

    @cached_property
    def _bend_range(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(radius of curvature, normal angle) at the radius's minimum and maximum, from roots of a polynomial."""
        k, cosines, sines = self._harmonics
        half = 0.5 * (1 - k**2) * 1j * k * (cosines - 1j * sines)
        polynomial = np.concatenate([half[::-1], [0.0], np.conj(half)])
        normals = np.zeros(1)
        if np.any(np.abs(polynomial) > 0):
            roots = np.roots(polynomial)
            # Roots on the unit circle are extrema. Roots off the circle do no harm, since the minimum and the maximum
            # of all candidates are used.
            normals = np.concatenate([normals, np.angle(roots[np.abs(roots) > 0])])
        bends = self.speed_of(normals)
        low, high = int(np.argmin(bends)), int(np.argmax(bends))
        return (float(bends[low]), float(normals[low])), (float(bends[high]), float(normals[high]))

    @property
    def length(self) -> float:
        return 2 * math.pi * self.radius

    @property
    def curvature_range(self) -> tuple[float, float]:
        low, high = self._bend_range
        return (1 / high[0], 1 / low[0])

    def arc_of(self, p: ArrayLike) -> Array:
        # The integral of h + h'' as a sum of terms that vanish at arc 0, to avoid cancellation for short arcs.
        normal, (k, cosines, sines) = along(p), self._harmonics
        phase = normal[..., None] * k
        harmonics = (1 / k - k) * (cosines * np.sin(phase) + 2 * sines * np.sin(0.5 * phase) ** 2)
        return self.radius * normal + np.sum(harmonics, axis=-1)

    def parameter(self, arc: ArrayLike) -> Array:
        arc = along(arc)
        turns = np.round(arc / self.length)
        rest = arc - turns * self.length
        root = solve_increasing(lambda nu: (self.arc_of(nu), self.speed_of(nu)), rest, rest / self.radius, 1e-3)
        return root + 2 * math.pi * turns

    def parameter_at(self, angle: ArrayLike) -> Array:
        return along(angle) - math.pi / 2

    def point_of(self, p: ArrayLike) -> Array:
        normal = along(p)
        support, slope = self.radius + self._series(normal, 0), self._series(normal, 1)
        cosine, sine = np.cos(normal), np.sin(normal)
        return np.stack([support * cosine - slope * sine, support * sine + slope * cosine], axis=-1)

    def angle_of(self, p: ArrayLike) -> Array:
        return along(p) + math.pi / 2

    def curvature_of(self, p: ArrayLike) -> Array:
        return 1 / self.speed_of(p)
