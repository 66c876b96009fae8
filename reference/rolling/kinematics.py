"""One rigid curve rolling on another: contact, pose, velocity (18.66) and acceleration as functions of the rotation.

Contacts at which rolling is not possible are refused: the curves cut, they fit each other, or one is outside a ring.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism, Valid, validated
from reference.numerics.roots import solve_increasing
from reference.plane import rotated, rotation_acceleration, rotation_velocity
from reference.rolling.curves import Array, Circle, Curve, Line, Placed, Ring, Side, Vector
from reference.validators import of_shape


@dataclass(frozen=True)
class Contact:
    """The contact at rotations theta (...) [rad] of the body, in the ground's frame.

    ground_arc, body_arc (...) [m], whose sum is constant; point (..., 2) [m] of contact; arm (..., 2) [m]: r_{O'/C},
    from the contact to the body's origin; tangent_angle (...) [rad] of e_t, the direction in which the ground is
    traversed; ground_curvature, body_curvature (...) [1/m].
    """

    theta: Array
    ground_arc: Array
    body_arc: Array
    point: Array
    arm: Array
    tangent_angle: Array
    ground_curvature: Array
    body_curvature: Array

    @property
    def rate(self) -> Array:
        """ds/dtheta = 1 / (curvature_A + curvature_B) (...) [m/rad]."""
        return 1 / (self.ground_curvature + self.body_curvature)

    @property
    def tangent(self) -> Array:
        """e_t (..., 2)."""
        return np.stack([np.cos(self.tangent_angle), np.sin(self.tangent_angle)], axis=-1)

    @property
    def normal(self) -> Array:
        """e_n = -k x e_t (..., 2), towards the interior of the body."""
        return np.stack([np.sin(self.tangent_angle), -np.cos(self.tangent_angle)], axis=-1)

    @property
    def conformality(self) -> Array:
        """(curvature_A + curvature_B) / max(|curvature|) (...): 1 on flat ground, 0 for curves that fit each other."""
        largest = np.maximum(np.abs(self.ground_curvature), np.abs(self.body_curvature))
        return (self.ground_curvature + self.body_curvature) / largest


# Smallest conformality that is allowed. The error of the contact is proportional to the inverse of the conformality; at
# this value about seven of a double's sixteen digits remain.
NEAR_CONFORMAL = 1e-9
# Points of a curve, once round, at which conformality and overlap are examined.
SCAN = 721


def first_fit(body: Curve, ground: Curve, body_arc: float, ground_arc: float, end: float, side: int) -> float:
    """The first arc of the body [m] on one side (+1, -1) of its start at which the curvatures cancel, or the `end` [m].

    At the start `body_arc` touches the ground at `ground_arc` [m]. `end`: the last arc of the curves, or infinity.
    """
    total = ground_arc + body_arc
    period = body.length if not math.isfinite(ground.length) else body.length + ground.length
    if not math.isfinite(end):
        if not math.isfinite(period):
            return end
        last = body_arc + side * period
    else:
        last = end

    def free(arc: ArrayLike) -> Array:
        on_body = body.curvature_of(body.parameter(arc))
        on_ground = ground.curvature_of(ground.parameter(total - np.asarray(arc)))
        with np.errstate(invalid="ignore"):  # at the pole of a spiral
            return on_ground + on_body - NEAR_CONFORMAL * np.maximum(np.abs(on_ground), np.abs(on_body))

    arcs = np.linspace(body_arc, last, SCAN)
    blocked = np.flatnonzero(free(arcs) <= 0)
    if blocked.size == 0:
        return end
    good, bad = float(arcs[max(blocked[0] - 1, 0)]), float(arcs[blocked[0]])
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if free(middle) > 0 else (good, middle)
    return good


def refuse_conformal(contact: Contact) -> None:
    """Raise InvalidMechanism if curvature_A + curvature_B is below NEAR_CONFORMAL of the larger curvature."""
    with np.errstate(divide="ignore", invalid="ignore"):
        near = ~(contact.conformality >= NEAR_CONFORMAL)
    if np.any(near):
        arcs = (contact.theta, contact.ground_arc, contact.body_arc)
        values = np.broadcast_arrays(*arcs, contact.ground_curvature, contact.body_curvature)
        theta, arc, on_body, a, b = (float(value[near].flat[0]) for value in values)
        raise InvalidMechanism(
            f"rolling: at theta = {theta:.9g} rad (arc {arc:.9g} m of the ground, {on_body:.9g} m of the body) the "
            f"curvatures are {a:.9g} and {b:.9g} 1/m; their sum must be positive, and above "
            f"{NEAR_CONFORMAL:g} of the larger, else the curves cut into each other or fit so closely "
            "that the contact is not determined"
        )


def refuse_overlap(body: Curve, ground: Curve, contact: Contact) -> None:
    """Raise InvalidMechanism unless a closed curve in a ring is entirely inside the ring."""
    rings = [(hole[0], -hole[1]) if (hole := _circle(curve)) and hole[1] < 0 else None for curve in (ground, body)]
    if rings[0] is not None and rings[1] is None and math.isfinite(body.length):
        (centre, radius), other = rings[0], body
    elif rings[1] is not None and rings[0] is None and math.isfinite(ground.length):
        (centre, radius), other = rings[1], ground
    else:
        return
    rim = other.point(np.linspace(0, other.length, SCAN))
    theta, origin = contact.theta, contact.point + contact.arm
    if other is body:
        world = rotated(theta[..., None], rim) + origin[..., None, :]
    else:
        world = rotated(-theta[..., None], rim - origin[..., None, :])
    excess = np.linalg.norm(world - centre, axis=-1).max(axis=-1) - radius
    if np.any(excess > 1e-9 * radius):
        worst = np.unravel_index(int(np.argmax(excess)), excess.shape)
        raise InvalidMechanism(
            f"rolling: at theta = {float(theta[worst]):.9g} rad the curve inside the ring of radius "
            f"{radius:g} m reaches {float(excess[worst]):.3g} m beyond it; "
            "the ring must be larger than its roller everywhere"
        )


def _circle(curve: Curve) -> tuple[Array, float] | None:
    """Centre (2,) [m] and radius [m] of a round curve, placed or not, negative for a hole; None for any other curve."""
    if isinstance(curve, Circle | Ring):
        return np.asarray(curve.centre, dtype=float), curve.sense * curve.radius
    if isinstance(curve, Placed) and (inner := _circle(curve.curve)):
        return rotated(np.asarray(curve.turn), inner[0]) + np.asarray(curve.shift), inner[1]
    return None


Place = Annotated[ArrayLike, of_shape("...", 2)]


@dataclass(frozen=True)
class Rolling(Valid):
    """The curve `body` rolls without slip on the fixed curve `ground`; convention: `reference.rolling.curves`.

    At the rotation `theta` [rad] the contact is at `ground_arc` and `body_arc` [m]. `Rolling.at_angle` and
    `Rolling.at_arcs` compute one of these numbers from the other two. Rotations are not wrapped.

    Raises InvalidMechanism, with the position, if the tangents don't match at the start, if curvature_A + curvature_B
    is below `NEAR_CONFORMAL` of the larger curvature (negative: the curves would cut into each other), if an arc is not
    on a curve, or if a hole is too small for the curve in it. A second contact of curves that are neither convex nor a
    ring is not noticed.
    """

    body: Curve
    ground: Curve
    theta: float
    ground_arc: float
    body_arc: float

    def __post_init__(self) -> None:
        super().__post_init__()
        mismatch = float(self.ground.angle(self.ground_arc) + math.pi - self.theta - self.body.angle(self.body_arc))
        mismatch = math.remainder(mismatch, 2 * math.pi)
        if abs(mismatch) > 1e-9:
            raise InvalidMechanism(
                f"rolling: at theta = {self.theta!r} rad the curves cross at an angle of {mismatch:.3g} rad instead of "
                "touching; the tangent angles must satisfy angle_A + pi = theta + angle_B"
            )
        start = self._contact_at(np.asarray(self.theta), np.asarray(self._body_start))
        refuse_conformal(start)
        if not self._apart_everywhere:
            refuse_overlap(self.body, self.ground, start)

    @classmethod
    @validated
    def at_angle(cls, body: Curve, ground: Curve, theta: float = 0.0, ground_arc: float = 0.0) -> Rolling:
        """Start at a rotation [rad] of the body, touching the ground at an arc [m]; the body must not be straight."""
        wanted = math.remainder(float(ground.angle(ground_arc)) + math.pi - theta, 2 * math.pi)
        return cls(body, ground, theta, ground_arc, float(body.arc(wanted)))

    @classmethod
    @validated
    def at_arcs(cls, body: Curve, ground: Curve, ground_arc: float = 0.0, body_arc: float = 0.0) -> Rolling:
        """Start with a contact at these arcs [m]; of the possible rotations the one within half a turn is used."""
        theta = math.remainder(float(ground.angle(ground_arc) + math.pi - body.angle(body_arc)), 2 * math.pi)
        return cls(body, ground, theta, ground_arc, body_arc)

    @cached_property
    def _body_start(self) -> float:
        return float(self.body.parameter(self.body_arc))

    @cached_property
    def _start_angles(self) -> tuple[float, float]:
        """Unwrapped tangent angles of ground and body at the start; only their changes matter."""
        return float(self.ground.angle(self.ground_arc)), float(self.body.angle_of(self._body_start))

    @cached_property
    def _apart_everywhere(self) -> bool:
        """Whether the ranges of curvature exclude that the curves fit or cut anywhere."""
        return self.ground.curvature_range[0] + self.body.curvature_range[0] >= 0

    def _ground_arc(self, body_arc: Array) -> Array:
        """The arc of the ground (...) [m] that touches the body at `body_arc` (...) [m].

        An arc within rounding of an end of the ground is set to that end.
        """
        arc = self.ground_arc + (self.body_arc - body_arc)
        rounding = 4 * np.finfo(float).eps * (abs(self.ground_arc) + abs(self.body_arc))
        for end in self.ground.limits:
            arc = np.where(np.abs(arc - end) <= rounding, end, arc)
        return arc

    def _rotation(self, body_parameter: Array) -> tuple[Array, Array]:
        """-(theta - start) (...) and its slope, by the body's parameter; it increases wherever rolling is possible."""
        ground = self.ground.parameter(self._ground_arc(self.body.arc_of(body_parameter)))
        ground_start, body_start = self._start_angles
        turned = (self.ground.angle_of(ground) - ground_start) - (self.body.angle_of(body_parameter) - body_start)
        curvature = self.ground.curvature_of(ground) + self.body.curvature_of(body_parameter)
        return -turned, curvature * self.body.speed_of(body_parameter)

    @cached_property
    def _parameter_limits(self) -> tuple[float, float]:
        """The body's parameters between which rolling is possible."""
        low, high = self.body.limits
        ground_low, ground_high = self.ground.limits
        total = self.ground_arc + self.body_arc
        low, high = max(low, total - ground_high), min(high, total - ground_low)
        if not self._apart_everywhere:
            start = self.body, self.ground, self.body_arc, self.ground_arc
            low, high = first_fit(*start, low, -1), first_fit(*start, high, +1)
        ends = (float(self.body.parameter(arc)) if math.isfinite(arc) else arc for arc in (low, high))
        return tuple(ends)  # type: ignore[return-value]

    @cached_property
    def limits(self) -> tuple[float, float]:
        """Rotations [rad] between which the body can roll: infinite, or those at which curves fit or a curve ends."""
        low, high = self._parameter_limits
        with np.errstate(invalid="ignore"):
            later = self.theta - float(self._rotation(np.asarray(low))[0]) if math.isfinite(low) else math.inf
            earlier = self.theta - float(self._rotation(np.asarray(high))[0]) if math.isfinite(high) else -math.inf
        return (earlier, later)

    def _body_parameter(self, theta: Array) -> Array:
        rotation = theta - self.theta
        if isinstance(self.ground, Line) and not isinstance(self.body, (Line, Side)):
            return self.body.parameter_at(self._start_angles[1] - rotation)
        circles = _circle(self.ground), _circle(self.body)
        if circles[0] is not None and circles[1] is not None:
            ground, body = circles[0][1], circles[1][1]
            # From the sum of the signed radii, since angles cancel for a disc in a hole of nearly its size.
            return self._body_start - rotation * (body * (ground / (ground + body)))
        low, high = self.limits
        slack = 1e-12 * (1 + abs(self.theta))
        if np.any((theta < low - slack) | (theta > high + slack)):
            worst = float(theta[(theta < low - slack) | (theta > high + slack)].flat[0])
            raise InvalidMechanism(
                f"rolling: the body can't turn to {worst!r} rad; between {low:.9g} and {high:.9g} rad it rolls, "
                "and there a curve ends or curvature_A + curvature_B falls to zero and the curves fit each other"
            )
        slope = self._mean_slope
        return solve_increasing(
            self._rotation, -rotation, self._body_start - rotation * slope, 1e-3 * abs(slope), self._parameter_limits
        )

    @cached_property
    def _mean_slope(self) -> float:
        """Mean decrease of the body's parameter per radian of rotation, for the first guess of the search."""

        def mean(curve: Curve) -> float:
            low, high = curve.curvature_range
            return math.copysign(2 * math.pi / curve.length, high + low) if low != high else low

        if math.isfinite(self.body.length):
            once = float(self.body.parameter(self.body_arc + self.body.length)) - self._body_start
            if math.isfinite(self.ground.length) or self.ground.curvature_range == (0.0, 0.0):
                curvature = mean(self.body) + mean(self.ground)
                if curvature > 0:
                    return once / self.body.length / curvature
        return 1 / float(self._rotation(np.asarray(self._body_start))[1])

    def _contact_at(self, theta: Array, body_parameter: Array) -> Contact:
        body_arc = self.body.arc_of(body_parameter)
        ground_arc = self._ground_arc(body_arc)
        ground = self.ground.parameter(ground_arc)
        return Contact(
            theta=theta,
            ground_arc=ground_arc,
            body_arc=body_arc,
            point=self.ground.point_of(ground),
            arm=-rotated(theta, self.body.point_of(body_parameter)),
            tangent_angle=self.ground.angle_of(ground),
            ground_curvature=self.ground.curvature_of(ground),
            body_curvature=self.body.curvature_of(body_parameter),
        )

    @validated
    def contact(self, theta: ArrayLike) -> Contact:
        """The contact on both curves at rotations theta (...) [rad]."""
        theta = np.asarray(theta, dtype=float)
        contact = self._contact_at(theta, self._body_parameter(theta))
        refuse_conformal(contact)
        if not self._apart_everywhere:
            refuse_overlap(self.body, self.ground, contact)
        return contact

    @validated
    def pose(self, theta: ArrayLike) -> Array:
        """Poses (..., 3) [m, m, rad] of the body's frame at rotations theta (...) [rad]."""
        contact = self.contact(theta)
        return np.concatenate([contact.point + contact.arm, contact.theta[..., None]], axis=-1)

    def _arm(self, contact: Contact, point: Vector | ArrayLike) -> Array:
        """r_{P/C} (..., 2) [m] of a point P of the body, in its own frame."""
        return contact.arm + rotated(contact.theta, np.asarray(point, dtype=float))

    @validated
    def position(self, theta: ArrayLike, point: Place = (0.0, 0.0)) -> Array:
        """Positions (..., 2) [m] of a point of the body, given in its own frame [m]: the roulette."""
        contact = self.contact(theta)
        return contact.point + self._arm(contact, point)

    @validated
    def velocity(self, theta: ArrayLike, rate: ArrayLike, point: Place = (0.0, 0.0)) -> Array:
        """(18.66) v = omega x r_{P/C} (..., 2) [m/s] of a point of the body at the rate omega (...) [rad/s]."""
        return rotation_velocity(rate, self._arm(self.contact(theta), point))

    @validated
    def pinned_acceleration(
        self, theta: ArrayLike, rate: ArrayLike, angular_acceleration: ArrayLike, point: Place = (0.0, 0.0)
    ) -> Array:
        """alpha x r - omega^2 r (..., 2) [m/s^2]: the acceleration as if the body were pinned at C."""
        return rotation_acceleration(rate, angular_acceleration, self._arm(self.contact(theta), point))

    @validated
    def rolling_acceleration(self, theta: ArrayLike, rate: ArrayLike) -> Array:
        """omega^2 / (curvature_A + curvature_B) e_n (..., 2) [m/s^2]: the additional acceleration of all points."""
        contact = self.contact(theta)
        return (np.asarray(rate) ** 2 * contact.rate)[..., None] * contact.normal

    @validated
    def acceleration(
        self, theta: ArrayLike, rate: ArrayLike, angular_acceleration: ArrayLike, point: Place = (0.0, 0.0)
    ) -> Array:
        """Accelerations (..., 2) [m/s^2] of a point at rates [rad/s] and angular accelerations [rad/s^2] (...)."""
        pinned = self.pinned_acceleration(theta, rate, angular_acceleration, point)
        return pinned + self.rolling_acceleration(theta, rate)
