"""A wheel towed by a drawbar, the hitch on a straight line or a circle: the tractrix, in closed form.

With psi the drawbar's direction (wheel to hitch) less the hitch's direction of travel, s the hitch's way, c = 1/R its
path's curvature: psi' = -sin(psi)/L - c. In p = sin(psi/2), q = cos(psi/2) up to a common factor this is linear,

    p' = -p/(2L) - c q/2,   q' = c p/2 + q/(2L),   exp(M s) = cosh(m s) + M sinh(m s)/m,   m = sqrt(1 - (L c)^2)/(2L),

so one formula has the straight tow (c = 0), R > L (it settles at sin psi = -L/R), R = L (it settles as 1/s) and R < L
(m is imaginary: the wheel goes round for ever).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.body import Triple
from reference.kinds import NOT_FINITE, Rule, from_to
from reference.validation import Positive, Valid, validated

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tow(Valid):
    """A drawbar of `length` L [m], whose hitch travels from `start` (x, y, direction of travel) on a circle of `radius`
    R [m]: positive to the left, negative to the right, infinite straight on.

    `angle` psi [rad] at the start: 0 straight behind (it stays so on a straight line), +-pi folded over, ahead of the
    hitch. A number of exactly +-math.pi on a straight line is taken as that equilibrium, though pi is not a float.
    Raises InvalidMechanism for a length that is not positive, a radius of 0 or not a number, an angle beyond +-pi.
    """

    length: Positive
    angle: Annotated[float, from_to(-math.pi, math.pi)]
    radius: Annotated[float, NOT_FINITE, Rule(lambda value: abs(value) > 0, "other than 0, or infinite")] = math.inf
    start: Triple = (0.0, 0.0, 0.0)

    @cached_property
    def curvature(self) -> float:
        """Of the hitch's path [1/m], to the left."""
        return 1 / self.radius

    @cached_property
    def _discriminant(self) -> float:
        """1 - (L/R)^2 without cancellation at R = L."""
        if math.isinf(self.radius):
            return 1.0
        ratio = self.length / abs(self.radius)
        return (abs(self.radius) - self.length) / abs(self.radius) * (1 + ratio)

    def steady_angle(self) -> float | None:
        """The angle at which the towed wheel settles [rad], on its own circle; None for R < L, when it never does."""
        return -math.asin(self.length * self.curvature) if self._discriminant >= 0 else None

    @validated
    def relative_angle(self, way: ArrayLike) -> Array:
        """psi [rad, not wrapped] after the hitch has gone `way` s [m] (...); negative when it is pushed back."""
        way = np.asarray(way, dtype=float)
        sine, cosine = (0.0 if abs(self.angle) == math.pi else math.sin(self.angle)), math.cos(self.angle)
        swing = sine + self.length * self.curvature  # -L psi' at the start
        if self._discriminant < 0:
            rate = math.sqrt(-self._discriminant) / (2 * self.length)
            half_turns = np.round(rate * way / math.pi)
            rest = rate * way - half_turns * math.pi
            turned = np.arctan2(-np.sin(rest) * swing, np.cos(rest) * 2 * self.length * rate + np.sin(rest) * cosine)
            return self.angle + 2 * (turned - math.copysign(math.pi, self.radius) * half_turns)
        return self.angle + 2 * self._half_turned(way, swing, sine, cosine)

    def _half_turned(self, way: Array, swing: float, sine: float, cosine: float) -> Array:
        """The turn of (q, p), half that of psi and monotonous, so less than pi: no branch to choose."""
        root = math.sqrt(self._discriminant)  # 2 L m
        size = root * np.abs(way) / (2 * self.length)
        near = size < 0.5
        # tanh(m s)/(2 L m), also for m = 0.
        some = np.where(near & (size > 0), size, 1.0)
        tangent = way / (2 * self.length) * np.where(size > 0, np.tanh(some) / some, 1.0)
        # Further on, tanh = 1 hides a start close to the unstable equilibrium: there the exponentials go apart, and the
        # coefficient that is small (root + cosine, or root - cosine) is had from its product with the other.
        product = swing * (sine - self.length * self.curvature)
        growing = root + cosine if cosine >= 0 else product / (root - cosine)
        dying = root - cosine if cosine <= 0 else product / (root + cosine)
        ratio = np.exp(-2 * size)
        forward = np.where(way >= 0, growing + ratio * dying, ratio * growing + dying)
        across = np.where(near, -tangent * swing, np.sign(way) * swing * np.expm1(-2 * size))
        along = np.where(near, 1 + tangent * cosine, forward)
        return np.arctan2(across, along)

    @validated
    def heading(self, way: ArrayLike) -> Array:
        """The drawbar's direction in the world, from the wheel to the hitch [rad]."""
        way = np.asarray(way, dtype=float)
        return self.start[2] + self.curvature * way + self.relative_angle(way)

    @validated
    def hitch(self, way: ArrayLike) -> Array:
        """Where the hitch is (..., 2) [m]."""
        way = np.asarray(way, dtype=float)
        half = 0.5 * self.curvature * way
        chord = way * np.sinc(half / np.pi)
        angle = self.start[2] + half
        return np.stack([self.start[0] + chord * np.cos(angle), self.start[1] + chord * np.sin(angle)], axis=-1)

    @validated
    def wheel(self, way: ArrayLike) -> Array:
        """Where the towed wheel is (..., 2) [m]."""
        heading = self.heading(way)
        return self.hitch(way) - self.length * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
