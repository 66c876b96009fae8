"""The position of a rolling body as a fast function of its rotation.

`reference.rolling` computes contacts for arrays of rotations. This module has closed forms for two round curves and for
a round curve on a line. For other pairs of curves, a table of polynomials interpolates exact contacts.

Vectors are complex numbers x + i y. The body's origin in the frame of the ground is P = point + a with the arm a =
r_{O'/C}. The derivatives of P by the rotation theta are P' = i a (18.66) and P'' = s' e_n - a, where s is the arc
length and s' = ds/dtheta. `reference.rolling.kinematics` defines the symbols.
"""

from __future__ import annotations

import math
from cmath import rect
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from engines.remembered import by_identity
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring
from reference.rolling.kinematics import Rolling

# P'' is interpolated at the Chebyshev points of a cell. P' and P are integrals of the polynomial, since differentiation
# would amplify rounding errors.
NODES = 6
COARSEST = 2 * math.pi / 256
FINEST = 2 * math.pi / 2**17  # Width of a cell [rad]; a finer table would have more cells than a motion uses.
CELLS_IN_BLOCK = 16  # Number of cells that are computed together.
EXAMINED = np.arange(-32, 32, 4)  # Indices of the cells that determine the width, relative to the first cell.
# Rotations in a cell as shares of its half width. SAMPLED has the middle and the nodes, COMPARED the points between
# nodes.
SAMPLED = np.append(0.0, np.cos(math.pi * (np.arange(NODES) + 0.5) / NODES))
COMPARED = np.cos(math.pi * np.arange(NODES + 1) / NODES)
# Sufficient error relative to the largest P''. The value is that of a few rounding errors of a contact.
ROUNDING = 1e-14
# Largest permitted error relative to the largest P''. Otherwise exact contacts are used, which take a hundred times as
# long.
POOR = 1e-11
# Largest rotation [rad]. In a diverged motion rotations become so large that their rounding is too coarse.
FARTHEST = 1e9

Place = tuple[complex, complex, complex]
NOWHERE = complex(math.nan, math.nan)
LOST: Place = (NOWHERE, NOWHERE, NOWHERE)


def unplaced(curve: Curve) -> tuple[Curve, complex, float]:
    """The curve before all displacements, the total shift [m] as x + i y, and the total rotation [rad]."""
    if not isinstance(curve, Placed):
        return curve, 0j, 0.0
    inner, shift, turn = unplaced(curve.curve)
    return inner, complex(*curve.shift) + rect(1.0, curve.turn) * shift, turn + curve.turn


class Rolled(Protocol):
    """A rolling pair as functions of the unwrapped rotation theta [rad] of the body relative to the ground.

    `arm` and `contact` raise ValueError for a rotation that is infinite or outside the limits of rolling.
    """

    def place(self, theta: float) -> Place:
        """P, P' and P'' [m, m/rad, m/rad^2], or NaN outside the limits of rolling."""
        ...

    def arm(self, theta: float) -> complex:
        """The vector from the contact to the body's origin [m] in the ground's frame."""
        ...

    def contact(self, theta: float) -> tuple[complex, complex]:
        """The contact [m] in the ground's frame, and in the body's frame."""
        ...


@by_identity()  # making a table takes as long as thousands of steps
def rolled(rolling: Rolling) -> Rolled:
    ground, body = _round(rolling.ground), _round(rolling.body)
    if body is not None and ground is not None:
        return RoundOnRound(rolling, ground, body)
    if body is not None and isinstance(unplaced(rolling.ground)[0], Line):
        return RoundOnLine(rolling, body)
    return Table(rolling)


def _round(curve: Curve) -> tuple[complex, float] | None:
    """Centre [m] and radius [m] of a disc or a hole, whose radius is negative, or None for another curve."""
    curve, shift, turn = unplaced(curve)
    if isinstance(curve, Circle | Ring):
        return shift + rect(1.0, turn) * complex(*curve.centre), curve.sense * curve.radius
    return None


def _exactly(rolling: Rolling, theta: float) -> Place:
    place, first, second = _contacts(rolling, np.array(theta))
    return complex(place), complex(first), complex(second)


def _contacts(rolling: Rolling, theta: NDArray[np.float64]) -> tuple[NDArray[np.complex128], ...]:
    contact = rolling.contact(theta)
    point, arm = (vector[..., 0] + 1j * vector[..., 1] for vector in (contact.point, contact.arm))
    normal = np.sin(contact.tangent_angle) - 1j * np.cos(contact.tangent_angle)
    return point + arm, 1j * arm, contact.rate * normal - arm


class RoundOnLine:
    """A disc on a line; the centre of the disc moves along a straight line."""

    def __init__(self, rolling: Rolling, body: tuple[complex, float]) -> None:
        self._start = rolling.theta
        self._middle, radius = body
        start = rolling.contact(rolling.theta)
        self._along = radius * rect(1.0, float(start.tangent_angle))  # Displacement of the disc's centre per radian.
        self._radius = -1j * self._along  # From the contact to the disc's centre.
        self._point = complex(*start.point)

    @property
    def constants(self) -> tuple[complex, ...]:
        """a, b, m, s of P = a + b (theta - s) - e^(i theta) m; b is along the tangent."""
        return self._point + self._radius, self._along, self._middle, self._start

    def place(self, theta: float) -> Place:
        if not -FARTHEST <= theta <= FARTHEST:
            return LOST
        along, out = self._along, rect(1.0, theta) * self._middle
        return self._point + self._radius + along * (theta - self._start) - out, along - 1j * out, out

    def arm(self, theta: float) -> complex:
        return self._radius - rect(1.0, theta) * self._middle

    def contact(self, theta: float) -> tuple[complex, complex]:
        return self._point + self._along * (theta - self._start), self._middle - self._radius * rect(1.0, -theta)


class RoundOnRound:
    """A disc or a ring on a disc or in a ring; the body's centre moves on a circle about the ground's centre.

    The radii are r_A of the ground and r_B of the body, and the radius of a hole is negative. If the body turns by one
    radian, the tangent turns by r_B / (r_A + r_B).
    """

    def __init__(self, rolling: Rolling, ground: tuple[complex, float], body: tuple[complex, float]) -> None:
        self._start = rolling.theta
        (self._centre, around), (self._middle, radius) = ground, body
        self._turning = radius / (around + radius)
        # Three vectors as factors on the tangent: from the ground's centre to the contact, from the contact to the
        # body's centre, and the sum of both.
        self._ground, self._radius, self._between = -1j * around, -1j * radius, -1j * (around + radius)
        self._angle = float(rolling.contact(rolling.theta).tangent_angle)

    @property
    def constants(self) -> tuple[complex, ...]:
        """a, b, c, m, s, t, k of P = a + b e_t - e^(i theta) m and P' = i (c e_t - e^(i theta) m).

        The unit tangent e_t has the angle t + k (theta - s).
        """
        return self._centre, self._between, self._radius, self._middle, self._start, self._angle, self._turning

    def place(self, theta: float) -> Place:
        if not -FARTHEST <= theta <= FARTHEST:
            return LOST
        tangent = rect(1.0, self._angle + self._turning * (theta - self._start))
        out, radius = rect(1.0, theta) * self._middle, self._radius * tangent
        return self._centre + self._between * tangent - out, 1j * (radius - out), out - self._turning * radius

    def arm(self, theta: float) -> complex:
        tangent = rect(1.0, self._angle + self._turning * (theta - self._start))
        return self._radius * tangent - rect(1.0, theta) * self._middle

    def contact(self, theta: float) -> tuple[complex, complex]:
        angle = self._angle + self._turning * (theta - self._start)
        on_body = self._middle - self._radius * rect(1.0, angle - theta)
        return self._centre + self._ground * rect(1.0, angle), on_body


class Table:
    """Any rolling pair by polynomials in cells of equal width, which are computed at their first use."""

    def __init__(self, rolling: Rolling) -> None:
        self._rolling = rolling
        low, high = rolling.limits
        self._low, self._high = max(low, -FARTHEST), min(high, FARTHEST)
        self._cells: dict[int, tuple[complex, ...] | None] = {}
        width, previous = COARSEST, math.inf
        while True:
            self._width, self._per_radian = width, 1 / width
            error = self._error()
            # If the two curvatures are nearly equal, exact contacts have large rounding errors, which finer cells do
            # not reduce.
            if error < ROUNDING or width <= FINEST or (error < POOR and error > previous / 4):
                break
            # The error is proportional to width^NODES.
            halvings = math.ceil(math.log2(error / ROUNDING) / NODES) if error < math.inf else 1
            width, previous = max(width / 2 ** min(halvings, 3), FINEST), error
        self.exact_only = not error < POOR
        self.place(rolling.theta)

    def place(self, theta: float) -> Place:
        if not self._low <= theta <= self._high:
            return LOST
        cell = self._cells.get(math.floor(theta * self._per_radian)) or self._cell(theta)
        if cell is None:
            return _exactly(self._rolling, theta)
        middle, p, q, a, b, c, d, e, f, b1, c1, d1, e1, f1, a2, b2, c2, d2, e2, f2 = cell
        u = theta - middle.real
        return (
            (((((((f2 * u + e2) * u + d2) * u + c2) * u + b2) * u + a2) * u) + q) * u + p,
            ((((((f1 * u + e1) * u + d1) * u + c1) * u + b1) * u) + a) * u + q,
            ((((f * u + e) * u + d) * u + c) * u + b) * u + a,
        )

    def arm(self, theta: float) -> complex:
        cell = None
        if self._low <= theta <= self._high:
            cell = self._cells.get(math.floor(theta * self._per_radian)) or self._cell(theta)
        if cell is None:
            return -1j * _exactly(self._rolling, theta)[1]
        middle, _, q, a, _, _, _, _, _, b1, c1, d1, e1, f1, _, _, _, _, _, _ = cell
        u = theta - middle.real
        return -1j * (((((((f1 * u + e1) * u + d1) * u + c1) * u + b1) * u) + a) * u + q)

    def contact(self, theta: float) -> tuple[complex, complex]:
        place, once, _ = self.place(theta) if self._low <= theta <= self._high else _exactly(self._rolling, theta)
        out = 1j * once  # from the body's origin to the contact
        return place + out, out * rect(1.0, -theta)

    @property
    def width(self) -> float:
        return self._width

    def cells(self, first: int, count: int) -> NDArray[np.complex128]:
        """The cells with the indices from `first` on (count, 20), see `_fitted`, or NaN outside the limits."""
        none = (NOWHERE,) * (3 + NODES + 2 * NODES - 1)
        for index in range(first, first + count):
            if index not in self._cells:
                self._compute_block(index)
        return np.array([self._cells[index] or none for index in range(first, first + count)])

    def _cell(self, theta: float) -> tuple[complex, ...] | None:
        index = math.floor(theta * self._per_radian)
        if index not in self._cells and not self.exact_only:
            self._compute_block(index)
        return self._cells.get(index)

    def _compute_block(self, member: int) -> None:
        """Compute the block of cells that contains `member`; a cell that exceeds the limits is None."""
        start = member // CELLS_IN_BLOCK * CELLS_IN_BLOCK
        index = np.arange(start, start + CELLS_IN_BLOCK)
        low, high = index * self._width, (index + 1) * self._width
        inside = (low >= self._low) & (high <= self._high)
        self._cells.update(dict.fromkeys(index.tolist()))
        if np.any(inside):
            self._cells.update(
                zip(index[inside].tolist(), map(tuple, self._fitted(index[inside]).tolist()), strict=True)
            )

    def _fitted(self, index: NDArray[np.int_]) -> NDArray[np.complex128]:
        """The middle of a cell, P and P' in the middle, and the coefficients of P'', P' and P (cells, 20)."""
        return self._through(index, _contacts(self._rolling, self._at(index, SAMPLED)))

    def _at(self, index: NDArray[np.int_], share: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray((index[:, None] + 0.5) * self._width + 0.5 * self._width * share, dtype=float)

    def _through(self, index: NDArray[np.int_], contacts: tuple[NDArray[np.complex128], ...]) -> NDArray[np.complex128]:
        """The result of `_fitted` from contacts (cells, 1 + NODES or more), which begin with those at SAMPLED."""
        place, first, second = contacts
        power = np.arange(NODES)
        powers = np.linalg.inv(np.vander(SAMPLED[1:], increasing=True)) / (0.5 * self._width) ** power[:, None]
        coefficients = second[:, 1 : 1 + NODES] @ powers.T
        integral = coefficients / (power + 1)
        middle = ((index + 0.5) * self._width).astype(complex)
        return np.column_stack(
            [middle, place[:, 0], first[:, 0], coefficients, integral[:, 1:], integral / (power + 2)]
        )

    def _error(self) -> float:
        """The largest error of P'' between the nodes in the cells EXAMINED, relative to the largest P''."""
        around = EXAMINED + math.floor(self._rolling.theta * self._per_radian)
        inside = (around * self._width >= self._low) & ((around + 1) * self._width <= self._high)
        if not np.any(inside):
            return math.inf
        contacts = _contacts(self._rolling, self._at(around[inside], np.append(SAMPLED, COMPARED)))
        cells, exact = self._through(around[inside], contacts), contacts[2][:, 1 + NODES :]
        u = 0.5 * self._width * COMPARED
        fitted = sum(cells[:, 3 + k, None] * u**k for k in range(NODES))
        return float(np.abs(fitted - exact).max() / np.abs(exact).max())
