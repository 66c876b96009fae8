"""A smooth convex cam from its support function, a Fourier series: everything but the arc's inverse in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Positive
from reference.kept import kept
from reference.numerics.roots import solve_increasing
from reference.rolling.curves import Array, Curve, along


@dataclass(frozen=True)
class Cam(Curve):
    """The convex curve whose tangent with outward normal at the angle nu is at the distance h(nu) from the origin [m]:

    h = radius + sum over k = 1.. of cosines[k-1] cos(k nu) + sines[k-1] sin(k nu),

    with nu its natural parameter.

    The first terms shift the cam (cosines=(e,) is a disc eccentric by e), the second make it oval, the third
    three-lobed; a second and a third make an egg. The radius of curvature is h + h'', the arc its integral; arc 0 is
    where the normal points to +x. Raises InvalidMechanism, with the place, where the radius of curvature isn't
    positive.
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

    @kept
    def _harmonics(self) -> tuple[Array, Array, Array]:
        count = max(len(self.cosines), len(self.sines))
        cosines, sines = np.zeros(count), np.zeros(count)
        cosines[: len(self.cosines)], sines[: len(self.sines)] = self.cosines, self.sines
        return np.arange(1.0, count + 1), cosines, sines

    def _series(self, normal: Array, order: int) -> Array:
        """The derivative of the given order of the series without its constant."""
        k, cosines, sines = self._harmonics
        phase = normal[..., None] * k + order * math.pi / 2
        return np.sum(k**order * (cosines * np.cos(phase) + sines * np.sin(phase)), axis=-1)

    def speed_of(self, p: ArrayLike) -> Array:
        """The radius of curvature h + h'' [m]."""
        normal = along(p)
        return self.radius + self._series(normal, 0) + self._series(normal, 2)

    @cached_property
    def _bend_range(self) -> tuple[tuple[float, float], tuple[float, float]]:
        """(radius of curvature, normal angle) at its minimum and maximum: roots of its derivative as a polynomial."""
        k, cosines, sines = self._harmonics
        half = 0.5 * (1 - k**2) * 1j * k * (cosines - 1j * sines)
        polynomial = np.concatenate([half[::-1], [0.0], np.conj(half)])
        normals = np.zeros(1)
        if np.any(np.abs(polynomial) > 0):
            roots = np.roots(polynomial)
            # Every root on the unit circle is an extremum; others do no harm as candidates.
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
        # The integral of h + h'', in terms that vanish at the start one by one: a short arc keeps its digits.
        normal, (k, cosines, sines) = along(p), self._harmonics
        phase = normal[..., None] * k
        terms = (1 / k - k) * (cosines * np.sin(phase) + 2 * sines * np.sin(0.5 * phase) ** 2)
        return self.radius * normal + np.sum(terms, axis=-1)

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
