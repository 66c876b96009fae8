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

from reference.checks import Positive, Valid, validated
from reference.joints import Triple
from reference.kinds import NOT_FINITE, Rule, from_to

Array = NDArray[np.float64]

NEAR = 0.5  # of m s: up to there exponentials have not gone apart


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

    @cached_property
    def _start(self) -> tuple[float, float, float]:
        """sin and cos of psi at the start, and -L psi' there."""
        sine = 0.0 if abs(self.angle) == math.pi else math.sin(self.angle)
        return sine, math.cos(self.angle), sine + self.length * self.curvature

    @validated
    def relative_angle(self, way: ArrayLike) -> Array:
        """psi [rad, not wrapped] after the hitch has gone `way` s [m] (...); negative when it is pushed back."""
        way = np.asarray(way, dtype=float)
        across, along = self._moved(way)
        # The turn of (q, p) is half that of psi, and monotonous; it is less than pi unless the wheel goes round.
        half_turns = np.round(self._rate * way / math.pi) if self._discriminant < 0 else 0.0
        return self.angle + 2 * (np.arctan2(across, along) - math.copysign(math.pi, self.radius) * half_turns)

    @cached_property
    def _rate(self) -> float:
        """Of the turn of (q, p) where the wheel goes round for ever [rad/m]."""
        return math.sqrt(-self._discriminant) / (2 * self.length)

    def _rest(self, way: Array) -> Array:
        """The turn of (q, p) less its half turns [rad]."""
        return self._rate * way - np.round(self._rate * way / math.pi) * math.pi

    def _moved(self, way: Array) -> tuple[Array, Array]:
        """(q, p), that began as a unit vector, across and along its start, up to a common factor."""
        sine, cosine, swing = self._start
        if self._discriminant < 0:
            rest = self._rest(way)
            double = 2 * self.length * self._rate
            across, along = -np.sin(rest) * swing, np.cos(rest) * double + np.sin(rest) * cosine
            return across, along
        root = math.sqrt(self._discriminant)  # 2 L m
        size = root * np.abs(way) / (2 * self.length)
        near = size < NEAR
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
        return across, along

    @validated
    def heading(self, way: ArrayLike) -> Array:
        """The drawbar's direction in the world, from the wheel to the hitch [rad]."""
        way = np.asarray(way, dtype=float)
        if self._discriminant >= 0:
            return self.start[2] + self.curvature * way + self.relative_angle(way)
        # The hitch's turn and psi nearly cancel on a small circle: what they share, 2 rate s, is not added at all.
        across, along = self._moved(way)
        slower = 1 / (self.length**2 * (abs(self.curvature) + 2 * self._rate))  # |c| - 2 rate
        shared = math.copysign(1.0, self.radius) * (slower * way + 2 * self._rest(way))
        return self.start[2] + self.angle + shared + 2 * np.arctan2(across, along)

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
