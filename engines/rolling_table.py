"""Where rolling puts a body, as fast functions of one angle, for every adapter: a step can't wait for arrays.

`reference.rolling` knows the contact for arrays of rotations; one call of it takes longer than a hundred steps of an
engine. Two round curves, or a round one on a line, are in closed form here; any other pair is a table of short
polynomials through exact contacts.

With s' = ds/dtheta, the arm a = r_{O'/C} and e_n (see `reference.rolling.kinematics`), the body's origin in the frame
of the ground is P = point + a, and P' = i a, P'' = s' e_n - a: the velocity (18.66) at one radian a second, and the
acceleration that rolling implies then. Vectors are complex numbers x + i y.
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

# P'' is interpolated at Chebyshev points of a cell, and P' and P are its integrals: nothing is differentiated, so
# nothing is amplified. Powers of the distance from a cell's middle do no harm, because their coefficients fall.
NODES = 6
COARSEST = 2 * math.pi / 256
FINEST = 2 * math.pi / 2**17  # beyond, a table would be larger than the number of its uses
BLOCK = 16  # cells that are laid together
EXAMINED = np.arange(-32, 32, 4)  # cells that tell how wide a cell may be, from that of the start
# Where contacts are taken, in halves of a cell from its middle: there and at the nodes; and where they are compared.
SAMPLED = np.append(0.0, np.cos(math.pi * (np.arange(NODES) + 0.5) / NODES))
BETWEEN = np.cos(math.pi * np.arange(NODES + 1) / NODES)
# Of the largest P'' nearby: a few roundings of a contact.
ROUNDING = 1e-14
# A table that misses more than this falls back on exact contacts, which cost about a hundred times as much.
POOR = 1e-11
# rad; a motion that has blown up asks for places where a double no longer tells one angle from the next.
FARTHEST = 1e9

Place = tuple[complex, complex, complex]
NOWHERE = complex(math.nan, math.nan)
LOST: Place = (NOWHERE, NOWHERE, NOWHERE)


def unplaced(curve: Curve) -> tuple[Curve, complex, float]:
    """The curve inside any number of placings, its shift [m] as x + i y, and its turn [rad]."""
    if not isinstance(curve, Placed):
        return curve, 0j, 0.0
    inner, shift, turn = unplaced(curve.curve)
    return inner, complex(*curve.shift) + rect(1.0, curve.turn) * shift, turn + curve.turn


class Rolled(Protocol):
    """A rolling pair; rotations theta [rad] are those of the body against the ground's, unwrapped.

    Where the pair can't roll, and for an infinite rotation, `arm` and `contact` raise ValueError.
    """

    def place(self, theta: float) -> Place:
        """P, P', P'' [m, m/rad, m/rad^2]; NaN beyond the rotations at which the body can roll."""
        ...

    def arm(self, theta: float) -> complex:
        """The body's origin seen from the contact [m], in the ground's frame."""
        ...

    def contact(self, theta: float) -> tuple[complex, complex]:
        """The contact in the ground's frame, and in the body's [m]."""
        ...


@by_identity()  # a table takes as long as thousands of steps
def rolled(rolling: Rolling) -> Rolled:
    """The fast functions of a pair, made once for as long as the same pair is asked for."""
    ground, body = _round(rolling.ground), _round(rolling.body)
    if body is not None and ground is not None:
        return RoundOnRound(rolling, ground, body)
    if body is not None and isinstance(unplaced(rolling.ground)[0], Line):
        return RoundOnLine(rolling, body)
    return Table(rolling)


def _round(curve: Curve) -> tuple[complex, float] | None:
    """Centre [m] and radius [m] of a disc, or of a hole with a negative radius; None for any other curve."""
    curve, shift, turn = unplaced(curve)
    if isinstance(curve, Circle | Ring):
        return shift + rect(1.0, turn) * complex(*curve.centre), curve.sense * curve.radius
    return None


def _exactly(rolling: Rolling, theta: float) -> Place:
    place, first, second = _contacts(rolling, np.array(theta))
    return complex(place), complex(first), complex(second)


def _contacts(rolling: Rolling, theta: NDArray[np.float64]) -> tuple[NDArray[np.complex128], ...]:
    """P, P' and P'' (...) by the reference."""
    contact = rolling.contact(theta)
    point, arm = (vector[..., 0] + 1j * vector[..., 1] for vector in (contact.point, contact.arm))
    normal = np.sin(contact.tangent_angle) - 1j * np.cos(contact.tangent_angle)
    return point + arm, 1j * arm, contact.rate * normal - arm


class RoundOnLine:
    """A disc on a line: its middle goes straight, and its origin round its middle."""

    def __init__(self, rolling: Rolling, body: tuple[complex, float]) -> None:
        self._start = rolling.theta
        self._middle, radius = body
        start = rolling.contact(rolling.theta)
        self._along = radius * rect(1.0, float(start.tangent_angle))  # of the middle in a radian
        self._radius = -1j * self._along  # from the contact to the middle
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
    """A disc or a ring on a disc or in a ring: its middle goes round the ground's, and its origin round its middle.

    Radii of holes are negative, as their curvatures are. The tangent turns by m = r_B / (r_A + r_B) in a radian.
    """

    def __init__(self, rolling: Rolling, ground: tuple[complex, float], body: tuple[complex, float]) -> None:
        self._start = rolling.theta
        (self._centre, around), (self._middle, radius) = ground, body
        self._turning = radius / (around + radius)
        # Along the normal -i e^(i angle): from the ground's middle to the contact, from there to the body's, and both.
        self._ground, self._radius, self._between = -1j * around, -1j * radius, -1j * (around + radius)
        self._angle = float(rolling.contact(rolling.theta).tangent_angle)

    @property
    def constants(self) -> tuple[complex, ...]:
        """a, b, c, m, s, t, k of P = a + b e_t - e^(i theta) m and P' = i (c e_t - e^(i theta) m).

        e_t is the tangent, at the angle t + k (theta - s).
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
    """Any pair by polynomials in cells of equal width. It grows with the angles that it is asked for."""

    def __init__(self, rolling: Rolling) -> None:
        self._rolling = rolling
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
            # The error falls with the power NODES: halvings that can't be enough are not tried.
            halvings = math.ceil(math.log2(error / ROUNDING) / NODES) if error < math.inf else 1
            width, before = max(width / 2 ** min(halvings, 3), FINEST), error
        self.exact_only = not error < POOR
        self.place(rolling.theta)  # the block about the start; others are laid when they are met

    def place(self, theta: float) -> Place:
        if not self._low <= theta <= self._high:
            return LOST
        cell = self._cells.get(math.floor(theta * self._per_radian)) or self._laid(theta)
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
        if not self._low <= theta <= self._high:
            return -1j * _exactly(self._rolling, theta)[1]
        cell = self._cells.get(math.floor(theta * self._per_radian)) or self._laid(theta)
        if cell is None:
            return -1j * _exactly(self._rolling, theta)[1]
        middle, _, q, a, _, _, _, _, _, b1, c1, d1, e1, f1, _, _, _, _, _, _ = cell
        u = theta - middle.real
        return -1j * (((((((f1 * u + e1) * u + d1) * u + c1) * u + b1) * u) + a) * u + q)

    def contact(self, theta: float) -> tuple[complex, complex]:
        place, once, _ = self.place(theta) if self._low <= theta <= self._high else _exactly(self._rolling, theta)
        out = 1j * once  # from the origin to the contact
        return place + out, out * rect(1.0, -theta)

    @property
    def width(self) -> float:
        """Of a cell [rad]; the cell at zero begins at zero."""
        return self._width

    def cells(self, first: int, count: int) -> NDArray[np.complex128]:
        """(count, 20) the cells from `first` on, as `_fitted` gives them; NaN where there is none."""
        none = (NOWHERE,) * (3 + NODES + 2 * NODES - 1)
        for index in range(first, first + count):
            if index not in self._cells:
                self._lay(index // BLOCK * BLOCK)
        return np.array([self._cells[index] or none for index in range(first, first + count)])

    def _laid(self, theta: float) -> tuple[complex, ...] | None:
        """The cell of a rotation, laid if it is not there yet; None where only exact contacts will do."""
        index = math.floor(theta * self._per_radian)
        if index not in self._cells and not self.exact_only:
            self._lay(index // BLOCK * BLOCK)
        return self._cells.get(index)

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
        return self._through(index, _contacts(self._rolling, self._at(index, SAMPLED)))

    def _at(self, index: NDArray[np.int_], part: NDArray[np.float64]) -> NDArray[np.float64]:
        """(cells, parts): rotations at these parts of half a cell's width from the middles of the cells."""
        return np.asarray((index[:, None] + 0.5) * self._width + 0.5 * self._width * part, dtype=float)

    def _through(self, index: NDArray[np.int_], contacts: tuple[NDArray[np.complex128], ...]) -> NDArray[np.complex128]:
        """`_fitted` through contacts (cells, 1 + NODES or more) at the parts SAMPLED of each cell."""
        place, first, second = contacts
        power = np.arange(NODES)
        powers = np.linalg.inv(np.vander(SAMPLED[1:], increasing=True)) / (0.5 * self._width) ** power[:, None]
        bend = second[:, 1 : 1 + NODES] @ powers.T
        once = bend / (power + 1)
        middle = ((index + 0.5) * self._width).astype(complex)
        return np.column_stack([middle, place[:, 0], first[:, 0], bend, once[:, 1:], once / (power + 2)])

    def _error(self) -> float:
        """How far cells about the start miss P'' half way between their nodes, in parts of the largest P''."""
        around = EXAMINED + math.floor(self._rolling.theta * self._per_radian)
        inside = (around * self._width >= self._low) & ((around + 1) * self._width <= self._high)
        if not np.any(inside):
            return math.inf
        # One search for all contacts: its rounds cost nearly the same for many as for few.
        contacts = _contacts(self._rolling, self._at(around[inside], np.append(SAMPLED, BETWEEN)))
        cells, exact = self._through(around[inside], contacts), contacts[2][:, 1 + NODES :]
        u = 0.5 * self._width * BETWEEN
        fitted = sum(cells[:, 3 + k, None] * u**k for k in range(NODES))
        return float(np.abs(fitted - exact).max() / np.abs(exact).max())
