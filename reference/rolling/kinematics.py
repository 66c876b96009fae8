"""Pose, velocity (18.66) and acceleration of a curve that rolls on a fixed curve, by the rotation."""

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
from reference.rolling.contact import Contact, first_fit, refuse_conformal, refuse_overlap, signed_circle
from reference.rolling.curves import Curve, Line, Side
from reference.validators import Array, of_shape

Place = Annotated[ArrayLike, of_shape("...", 2)]


@dataclass(frozen=True)
class Rolling(Valid):
    """The curve `body` rolls without slip on the fixed curve `ground`; for conventions see `reference.rolling.curves`.

    At the rotation `theta` [rad], which is not wrapped, the contact has the arc lengths `ground_arc` and `body_arc`
    [m]. `Rolling.at_angle` computes `body_arc`, and `Rolling.at_arcs` computes `theta`.

    Raises InvalidMechanism for different tangents at the start, curvatures that nearly cancel (`NEAR_CONFORMAL`), arcs
    that are not on their curve, and closed curves that are not inside their ring. If the curves are neither convex nor
    a ring, a second contact is not detected.
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
        """Start at a rotation [rad] of the body and a contact at an arc [m] of the ground; the body must not be
        straight.
        """
        wanted = math.remainder(float(ground.angle(ground_arc)) + math.pi - theta, 2 * math.pi)
        return cls(body, ground, theta, ground_arc, float(body.arc(wanted)))

    @classmethod
    @validated
    def at_arcs(cls, body: Curve, ground: Curve, ground_arc: float = 0.0, body_arc: float = 0.0) -> Rolling:
        """Start with a contact at these arcs [m]; the rotation is between -pi and pi."""
        theta = math.remainder(float(ground.angle(ground_arc) + math.pi - body.angle(body_arc)), 2 * math.pi)
        return cls(body, ground, theta, ground_arc, body_arc)

    @cached_property
    def _body_start(self) -> float:
        return float(self.body.parameter(self.body_arc))

    @cached_property
    def _start_angles(self) -> tuple[float, float]:
        """Tangent angles of ground and body at the start, not wrapped. Only changes of these angles are used."""
        return float(self.ground.angle(self.ground_arc)), float(self.body.angle_of(self._body_start))

    @cached_property
    def _apart_everywhere(self) -> bool:
        """Whether curvature_A + curvature_B is not negative for any two points of the curves."""
        return self.ground.curvature_range[0] + self.body.curvature_range[0] >= 0

    def _ground_arc(self, body_arc: Array) -> Array:
        """The arc of the ground (...) [m] in contact with the body at `body_arc` (...) [m].

        An arc that differs from an end of the ground by rounding only is set to that end.
        """
        arc = self.ground_arc + (self.body_arc - body_arc)
        rounding = 4 * np.finfo(float).eps * (abs(self.ground_arc) + abs(self.body_arc))
        for end in self.ground.limits:
            arc = np.where(np.abs(arc - end) <= rounding, end, arc)
        return arc

    def _rotation(self, body_parameter: Array) -> tuple[Array, Array]:
        """start - theta (...), and the derivative by the body's parameter, which is positive if rolling is possible."""
        ground = self.ground.parameter(self._ground_arc(self.body.arc_of(body_parameter)))
        ground_start, body_start = self._start_angles
        turned = (self.ground.angle_of(ground) - ground_start) - (self.body.angle_of(body_parameter) - body_start)
        curvature = self.ground.curvature_of(ground) + self.body.curvature_of(body_parameter)
        return -turned, curvature * self.body.speed_of(body_parameter)

    @cached_property
    def _parameter_limits(self) -> tuple[float, float]:
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
        """The range of rotations [rad] in which the body can roll, which may be infinite."""
        low, high = self._parameter_limits
        with np.errstate(invalid="ignore"):
            later = self.theta - float(self._rotation(np.asarray(low))[0]) if math.isfinite(low) else math.inf
            earlier = self.theta - float(self._rotation(np.asarray(high))[0]) if math.isfinite(high) else -math.inf
        return (earlier, later)

    def _body_parameter(self, theta: Array) -> Array:
        rotation = theta - self.theta
        if isinstance(self.ground, Line) and not isinstance(self.body, (Line, Side)):
            return self.body.parameter_at(self._start_angles[1] - rotation)
        circles = signed_circle(self.ground), signed_circle(self.body)
        if circles[0] is not None and circles[1] is not None:
            ground, body = circles[0][1], circles[1][1]
            # For a disc in a hole of nearly the same size, the sum of the signed radii has no cancellation, unlike
            # angles.
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
        """Mean decrease of the body's parameter per radian of rotation, for the first guess of a root search."""

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

    @validated
    def position(self, theta: ArrayLike, point: Place = (0.0, 0.0)) -> Array:
        """The roulette: positions (..., 2) [m] of a point of the body; `point` [m] is in the body's frame."""
        contact = self.contact(theta)
        return contact.point + contact.arm + rotated(contact.theta, np.asarray(point, dtype=float))

    @validated
    def velocity(self, theta: ArrayLike, rate: ArrayLike) -> Array:
        """(18.66) v = omega x r_{O'/C} (..., 2) [m/s] of the body's origin at the rate omega (...) [rad/s]."""
        return rotation_velocity(rate, self.contact(theta).arm)

    @validated
    def pinned_acceleration(self, theta: ArrayLike, rate: ArrayLike, angular_acceleration: ArrayLike) -> Array:
        """alpha x r - omega^2 r (..., 2) [m/s^2]: the acceleration of a body that is pinned at the contact."""
        return rotation_acceleration(rate, angular_acceleration, self.contact(theta).arm)

    @validated
    def rolling_acceleration(self, theta: ArrayLike, rate: ArrayLike) -> Array:
        """omega^2 / (curvature_A + curvature_B) e_n (..., 2) [m/s^2], which rolling adds at every point."""
        contact = self.contact(theta)
        return (np.asarray(rate) ** 2 * contact.rate)[..., None] * contact.normal

    @validated
    def acceleration(self, theta: ArrayLike, rate: ArrayLike, angular_acceleration: ArrayLike) -> Array:
        """Accelerations (..., 2) [m/s^2] of the origin at rates [rad/s] and angular accelerations [rad/s^2] (...)."""
        return self.pinned_acceleration(theta, rate, angular_acceleration) + self.rolling_acceleration(theta, rate)
