"""Where rolling puts a body, as a fast function of one angle: short polynomials through exact contacts."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from reference.rolling.kinematics import Rolling

# P'' is interpolated at Chebyshev points of a cell, and P' and P are its integrals: nothing is differentiated, so
# nothing is amplified. Powers of the distance from a cell's middle do no harm, because their coefficients fall.
NODES = 6
COARSEST = 2 * math.pi / 256
FINEST = 2 * math.pi / 2**17  # beyond, a table would be larger than the number of its uses
BLOCK = 64  # cells that are laid together
# Of the largest P'' nearby: a few roundings of a contact.
ROUNDING = 1e-14
# A table that misses more than this falls back on exact contacts, which cost about a hundred times as much.
POOR = 1e-11
# rad; a motion that has blown up asks for places where a double no longer tells one angle from the next.
FARTHEST = 1e9

Place = tuple[complex, complex, complex]
NOWHERE = complex(math.nan, math.nan)
LOST: Place = (NOWHERE, NOWHERE, NOWHERE)


class RollTable:
    """P(theta), P'(theta) and P''(theta): the body's origin [m] in the frame of the ground, as x + i y.

    With s' = ds/dtheta, the arm a = r_{O'/C} and e_n (see `reference.rolling.contact`), P = point + a, P' = i a and
    P'' = s' e_n - a: the velocity (18.66) at one radian a second, and the acceleration that rolling implies then.
    Made once; it grows with the angles that it is asked for.
    """

    def __init__(self, rolling: Rolling) -> None:
        self.rolling = rolling
        low, high = rolling.limits
        self._low, self._high = max(low, -FARTHEST), min(high, FARTHEST)
        self._cells: dict[int, tuple[complex, ...] | None] = {}
        width, before = COARSEST, math.inf
        while True:
            self._width, self._per_radian = width, 1 / width
            error = self._error()
            # Where curves nearly fit the contact itself is rounded so coarsely that finer cells bring no more.
            if error < ROUNDING or width <= FINEST or (error < POOR and error > before / 4):
                break
            width, before = width / 2, error
        self.exact_only = not error < POOR
        if not self.exact_only:
            for turn in (-1, 1):  # a turn to both sides; what is met beyond is laid when it is met
                for block in range(min(16, math.ceil(2 * math.pi / (BLOCK * width)))):
                    self.place(rolling.theta + turn * block * BLOCK * width)

    def place(self, theta: float) -> Place:
        """P, P', P'' [m, m/rad, m/rad^2]; NaN beyond the rotations at which the body can roll."""
        if not self._low <= theta <= self._high:
            return LOST
        if self.exact_only:
            return self._exactly(theta)
        index = math.floor(theta * self._per_radian)
        if index not in self._cells:
            self._lay(index // BLOCK * BLOCK)
        cell = self._cells[index]
        if cell is None:
            return self._exactly(theta)
        middle, p, q, a, b, c, d, e, f, b1, c1, d1, e1, f1, a2, b2, c2, d2, e2, f2 = cell
        u = theta - middle.real
        return (
            (((((((f2 * u + e2) * u + d2) * u + c2) * u + b2) * u + a2) * u) + q) * u + p,
            ((((((f1 * u + e1) * u + d1) * u + c1) * u + b1) * u) + a) * u + q,
            ((((f * u + e) * u + d) * u + c) * u + b) * u + a,
        )

    def _contacts(self, theta: NDArray[np.float64]) -> tuple[NDArray[np.complex128], ...]:
        contact = self.rolling.contact(theta)
        point, arm = (vector[..., 0] + 1j * vector[..., 1] for vector in (contact.point, contact.arm))
        normal = np.sin(contact.tangent_angle) - 1j * np.cos(contact.tangent_angle)
        return point + arm, 1j * arm, contact.rate * normal - arm

    def _exactly(self, theta: float) -> Place:
        place, first, second = self._contacts(np.array(theta))
        return complex(place), complex(first), complex(second)

    def _lay(self, start: int) -> None:
        """The cells from `start` on, a block of them; None for those that aren't wholly within the limits."""
        index = np.arange(start, start + BLOCK)
        low, high = index * self._width, (index + 1) * self._width
        inside = (low >= self._low) & (high <= self._high)
        self._cells.update(dict.fromkeys(index.tolist()))
        if np.any(inside):
            self._cells.update(
                zip(index[inside].tolist(), map(tuple, self._fitted(index[inside]).tolist()), strict=True)
            )

    def _fitted(self, index: NDArray[np.int_]) -> NDArray[np.complex128]:
        """(cells, 20): the middle of each cell, P and P' there, and the coefficients of P'', P' and P."""
        middle, half = np.asarray((index + 0.5) * self._width, dtype=float), 0.5 * self._width
        node = np.cos(math.pi * (np.arange(NODES) + 0.5) / NODES)
        place, first, second = self._contacts(np.append(middle, middle[:, None] + half * node))
        count, power = len(middle), np.arange(NODES)
        powers = np.linalg.inv(np.vander(node, increasing=True)) / half ** power[:, None]
        bend = second[count:].reshape(count, NODES) @ powers.T
        once = bend / (power + 1)
        return np.column_stack(
            [middle.astype(complex), place[:count], first[:count], bend, once[:, 1:], once / (power + 2)]
        )

    def _error(self) -> float:
        """How far a block about the start misses P'' half way between its nodes, in parts of the largest P''."""
        around = np.arange(BLOCK) + math.floor(self.rolling.theta * self._per_radian) - BLOCK // 2
        inside = (around * self._width >= self._low) & ((around + 1) * self._width <= self._high)
        if not np.any(inside):
            return math.inf
        cells = self._fitted(around[inside])
        node = np.cos(math.pi * np.arange(NODES + 1) / NODES)
        theta = cells[:, :1].real + 0.5 * self._width * node
        exact = self._contacts(theta)[2]
        u = theta - cells[:, :1].real
        fitted = sum(cells[:, 3 + k, None] * u**k for k in range(NODES))
        return float(np.abs(fitted - exact).max() / np.abs(exact).max())
