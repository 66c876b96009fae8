"""The scene of Andrews' squeezing mechanism, with numbers and names of the test set for initial value problems.

The directions of the bars, the reduced inertia and the potential are closed functions of the crank's angle phi, which
`reference/scenes/derivations.md` derives. Vectors of the plane are complex numbers.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import InvalidMechanism, NonNegative, Positive, Sign, Valid, validated
from reference.forces import Spring, Torque
from reference.joints import Pin, Vector, bodies_of
from reference.mechanism import Mechanism
from reference.numerics import gauss_collocation as gauss
from reference.plane import placed
from reference.scene import PlacedScene, shared

Array = NDArray[Any]
Pair = tuple[Positive, float]
Triple = tuple[Positive, float, float]
Seven = tuple[Positive, Positive, Positive, Positive, Positive, Positive, Positive]

BODY_NAMES = ("K1", "K2", "K3", "K4", "K5", "K6", "K7")
QUARTER = math.pi / 2
# Tolerance at which the motion has all published digits.
ANDREWS_TOLERANCE = gauss.WINDOW_TOLERANCE / 10
# `Dyad.side` of three pairs of bars in the order bar and rod, upper, lower.
SIDES = (-1, 1, -1)


@dataclass(frozen=True)
class Andrews(PlacedScene):
    """Seven bodies with `masses` [kg] and `inertias` [kg m^2] start from rest with the crank at `angle` [rad].

    Lengths [m] in the test set's letters are `crank` (rr, ra), `rod` (d, da), `bar` (ss, sa, sb), `spring_point` (sc,
    sd), `upper` (zt, ta, tb), `upper_end` (e, ea), `lower` (u, ua, ub) and `lower_end` (zf, fa). Each field but
    `spring_point` has the length between two joints and then the position of the centre of mass. The spring has
    `stiffness` [N/m] and `rest_length` [m], and the crank a constant `torque` [N m]. Raises InvalidMechanism if the
    bars can't be assembled at the start.
    """

    name: ClassVar[str] = "andrews"
    source: ClassVar[str] = "IVP test set, II-17; IFToMM library of computational benchmark problems, A03"
    masses: Seven = (0.04325, 0.00365, 0.02373, 0.00706, 0.07050, 0.00706, 0.05498)
    inertias: Seven = (2.194e-6, 4.410e-7, 5.255e-6, 5.667e-7, 1.169e-5, 5.667e-7, 1.912e-5)
    pivot_a: Vector = (-0.06934, -0.00227)
    pivot_b: Vector = (-0.03635, 0.03273)
    pivot_c: Vector = (0.014, 0.072)
    crank: Pair = (0.007, 0.00092)
    rod: Pair = (0.028, 0.0115)
    bar: Triple = (0.035, 0.01874, 0.01043)
    spring_point: Vector = (0.018, 0.02)
    upper: Triple = (0.04, 0.02308, 0.00916)
    upper_end: Pair = (0.02, 0.01421)
    lower: Triple = (0.04, 0.01228, 0.00449)
    lower_end: Pair = (0.02, 0.01421)
    stiffness: Positive = 4530.0
    rest_length: NonNegative = 0.07785
    torque: float = 0.033
    angle: float = -0.0617138900142764496358948458001
    duration: Positive = 0.05
    horizon: Positive = 0.05  # errors grow about linearly, since one freedom has constant energy

    def __post_init__(self) -> None:
        super().__post_init__()
        if not all(np.isfinite(part).all() for angle in self.angles(self.angle) for part in angle):
            raise InvalidMechanism(
                f"{self._owner()}: the bars don't reach from the pivots to the rod's end, or are in line, at the start"
            )

    @property
    def samples(self) -> int:
        """A hundred samples are needed, since the crank rotates by up to half a radian in half a millisecond."""
        return 100

    @property
    def pairs(self) -> tuple[Dyad, Dyad, Dyad]:
        firsts, seconds = (
            (self.bar[0], self.upper[0], self.lower[0]),
            (self.rod[0], self.upper_end[0], self.lower_end[0]),
        )
        return tuple(Dyad(*lengths) for lengths in zip(firsts, seconds, SIDES, strict=True))  # type: ignore[return-value]

    @validated
    def angles(self, phi: ArrayLike) -> tuple[Moving, ...]:
        """Angles of the seven bodies [rad] and their derivatives by the crank's angle phi (...) [rad].

        The bodies' frames are those of the test set. The crank's angle is phi; the angles of the swinging bodies are
        between -pi and pi. The result is NaN if the bars can't be assembled.
        """
        return self._angles(np.asarray(phi, dtype=float))

    def _angles(self, crank: Array) -> tuple[Moving, ...]:
        ones = np.ones_like(crank)
        turning = Moving(crank, ones, 0 * ones)
        pivot_a, pivot_b = complex(*self.pivot_a), complex(*self.pivot_b)
        holding, upper, lower = self.pairs
        bar, rod = holding.angles(direction(turning).times(self.crank[0]).shifted(-pivot_b))
        end = direction(bar).times(self.bar[0]).shifted(pivot_b - pivot_a)  # P, from A
        delta, psi = upper.angles(end)
        epsilon, chi = lower.angles(end)
        # The y axis of bodies 3, 4 and 7 points backwards along the bar.
        return turning, rod, bar.shifted(QUARTER), psi.shifted(QUARTER), delta, chi, epsilon.shifted(QUARTER)

    @cached_property
    def _points(self) -> tuple[dict[str, complex], ...]:
        """For each body, a mapping from joints to points [m] in the body's frame, from the centre of mass."""
        (rr, ra), (d, da), (ss, sa, sb), (sc, sd) = self.crank, self.rod, self.bar, self.spring_point
        (zt, ta, tb), (e, ea), (u, ua, ub), (zf, fa) = self.upper, self.upper_end, self.lower, self.lower_end
        return (
            {"O": complex(-ra), "R": complex(rr - ra)},
            {"R": complex(da), "P": complex(da - d)},
            {"B": complex(-sb, sa), "P": complex(-sb, sa - ss), "D": complex(sd - sb, sa - sc)},
            {"E": complex(0, e - ea), "P": complex(0, -ea)},
            {"A": complex(-ta, -tb), "E": complex(zt - ta, -tb)},
            {"H": complex(fa - zf), "P": complex(fa)},
            {"A": complex(ub, ua), "H": complex(ub, ua - u)},
        )

    def _placed(self, phi: Array) -> tuple[tuple[Moving, ...], list[Moving], Moving]:
        """Angles and centres of mass of the bodies, and the spring's vector, as functions of the crank's angle."""
        angles = self._angles(phi)
        frames = [direction(angle) for angle in angles]
        ends = {"O": Moving(*(0j * frames[0].value,) * 3)}
        ends["A"], ends["B"] = (ends["O"].shifted(complex(*pivot)) for pivot in (self.pivot_a, self.pivot_b))
        centres: dict[int, Moving] = {}
        # The known first point of each body determines the centre of mass and the second point.
        for body, start, other in (
            (0, "O", "R"),
            (1, "R", "P"),
            (2, "B", "D"),
            (4, "A", "E"),
            (3, "E", "P"),
            (6, "A", "H"),
            (5, "H", "P"),
        ):
            frame, points = frames[body], self._points[body]
            centres[body] = ends[start].plus(frame.times(-points[start]))
            ends[other] = centres[body].plus(frame.times(points[other]))
        return angles, [centres[body] for body in range(7)], ends["D"].shifted(-complex(*self.pivot_c))

    def _reduced(self, phi: Array) -> tuple[Array, Array, Array]:
        """The reduced inertia m [kg m^2], m' and the potential's derivative V' [N m] (...) at crank angles."""
        angles, centres, spring = self._placed(phi)
        reduced, change = 0.0 * phi, 0.0 * phi
        for mass, inertia, angle, centre in zip(self.masses, self.inertias, angles, centres, strict=True):
            reduced = reduced + mass * np.abs(centre.first) ** 2 + inertia * angle.first**2
            change = (
                change
                + 2 * mass * np.real(np.conj(centre.first) * centre.second)
                + 2 * inertia * angle.first * angle.second
            )
        length = np.abs(spring.value)
        pull = self.stiffness * (length - self.rest_length) / length
        return reduced, change, pull * np.real(np.conj(spring.value) * spring.first) - self.torque

    @cached_property
    def rate_unit(self) -> float:
        """Approximate rate of the crank after one radian [rad/s]. The inverse is the integration's unit of time."""
        strength = abs(self.torque) + self.stiffness * self.crank[0] ** 2
        return math.sqrt(strength / float(self._reduced(np.array(self.angle))[0]))

    def _rates(self, state: Array) -> Array:
        phi, rate = state[..., 0], state[..., 1]
        inertia, change, slope = self._reduced(phi)
        return np.stack([rate, -(change * rate**2 / 2 + slope / self.rate_unit**2) / inertia], axis=-1)

    def _states(self, times: Array) -> Array:
        if not times.any():  # a mechanism needs only the start
            return np.full((len(times), 2), (self.angle, 0.0), dtype=float)
        until = max(self.duration, float(times.max()))
        return shared(Andrews._solved, self, until)(times * self.rate_unit) * [1.0, self.rate_unit]

    def _solved(self, until: float) -> gauss.CollocationMotion:
        def accelerations(phi: Array, rate: Array) -> Array:
            return self._rates(np.concatenate([phi, rate], axis=-1))[..., 1:]

        end = until * self.rate_unit * (1 + 1e-15)
        return gauss.integrate(accelerations, [self.angle], [0.0], end, 1.0, tolerance=ANDREWS_TOLERANCE)

    def placement(self, times: Array) -> tuple[Array, Array, Array]:
        state = self._states(times)
        phi, rate = state[:, 0], state[:, 1]
        gain = self._rates(state / [1.0, self.rate_unit])[:, 1] * self.rate_unit**2
        angles, centres, _ = self._placed(phi)

        def by_time(parts: Sequence[Moving]) -> tuple[Array, Array, Array]:
            value, first, second = (np.stack(members, axis=-1) for members in zip(*parts, strict=True))
            of_rate, of_gain = rate[:, None], gain[:, None]
            return value, first * of_rate, first * of_gain + second * of_rate**2

        pose, twist, acceleration = map(placed, by_time(centres), by_time(angles))
        return pose, twist, acceleration

    def mechanism(self) -> Mechanism:
        pose, twist, _ = self.placement(np.zeros(1))
        bodies = bodies_of(BODY_NAMES, self.masses, self.inertias, pose[0], twist[0])
        local = [{name: (point.real, point.imag) for name, point in points.items()} for points in self._points]
        joints = (
            Pin("O", None, "K1", (0.0, 0.0), local[0]["O"]),
            Pin("R", "K1", "K2", local[0]["R"], local[1]["R"]),
            Pin("B", None, "K3", self.pivot_b, local[2]["B"]),
            Pin("A5", None, "K5", self.pivot_a, local[4]["A"]),
            Pin("E", "K5", "K4", local[4]["E"], local[3]["E"]),
            Pin("A7", None, "K7", self.pivot_a, local[6]["A"]),
            Pin("H", "K7", "K6", local[6]["H"], local[5]["H"]),
            Pin("P3", "K3", "K2", local[2]["P"], local[1]["P"]),
            Pin("P4", "K4", "K2", local[3]["P"], local[1]["P"]),
            Pin("P6", "K6", "K2", local[5]["P"], local[1]["P"]),
        )
        forces = (
            Spring("spring", None, "K3", self.pivot_c, local[2]["D"], self.stiffness, self.rest_length),
            Torque("torque", None, "K1", self.torque),
        )
        return Mechanism(bodies, joints, (0.0, 0.0), forces)

    def _branch_of(self, pose: Array) -> NDArray[np.int_]:
        """1 if the joints of all three pairs of bars are on the same side as at the start (...,), else -1."""
        angle = pose[..., 2]
        folds = (
            (angle[..., 2] - QUARTER, angle[..., 1]),
            (angle[..., 4], angle[..., 3] - QUARTER),
            (angle[..., 6] - QUARTER, angle[..., 5]),
        )
        sines = [side * np.sin(first - second) for (first, second), side in zip(folds, SIDES, strict=True)]
        return np.where(np.min(sines, axis=0) > 0, 1, -1)


class Moving(NamedTuple):
    """A quantity (...,) and its first two derivatives by a coordinate."""

    value: Array
    first: Array
    second: Array

    def plus(self, other: Moving) -> Moving:
        return Moving(*(a + b for a, b in zip(self, other, strict=True)))

    def times(self, factor: complex) -> Moving:
        return Moving(*(factor * part for part in self))

    def shifted(self, by: complex) -> Moving:
        return Moving(self.value + by, self.first, self.second)


def direction(angle: Moving) -> Moving:
    unit = np.exp(1j * angle.value)
    return Moving(unit, 1j * angle.first * unit, (1j * angle.second - angle.first**2) * unit)


@dataclass(frozen=True)
class Dyad(Valid):
    """Two bars of lengths `first` and `second` [m] from a pivot to a point.

    `side` is 1 if the joint of both bars is to the left of the line from the pivot to the point, else -1.
    """

    first: Positive
    second: Positive
    side: Sign

    def angles(self, reach: Moving) -> tuple[Moving, Moving]:
        """Directions of both bars [rad], from -pi to pi, for the complex vector `reach` [m] from pivot to point.

        The result is NaN for points out of reach. With reach = a e^(i mu) + b e^(i nu), the component of the derivative
        along one bar depends only on the rotation of the other bar.
        """
        a, b = self.first, self.second
        with np.errstate(invalid="ignore", divide="ignore"):
            distance = np.abs(reach.value)
            along = (distance**2 + a**2 - b**2) / (2 * distance)
            across = self.side * np.sqrt(a**2 - along**2)
            unit = reach.value / distance
            bar_a, bar_b = unit * (along + 1j * across) / a, unit * (distance - along - 1j * across) / b
            folded = np.imag(bar_a * np.conj(bar_b))  # sin(mu - nu), zero if the bars are in line

            def rates(change: Array) -> tuple[Array, Array]:
                along_b, along_a = np.real(change * np.conj(bar_b)), np.real(change * np.conj(bar_a))
                return -along_b / (a * folded), along_a / (b * folded)

            mu, nu = rates(reach.first)
            mu_second, nu_second = rates(reach.second + a * bar_a * mu**2 + b * bar_b * nu**2)
            return Moving(np.angle(bar_a), mu, mu_second), Moving(np.angle(bar_b), nu, nu_second)
