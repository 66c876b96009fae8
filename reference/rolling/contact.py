"""The contact of two curves; contacts at which rolling is not possible are refused."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism
from reference.plane import rotated
from reference.rolling.curves import Circle, Curve, Placed, Ring
from reference.validators import Array


@dataclass(frozen=True)
class Contact:
    """The contact at rotations theta (...) [rad] of the body, in the ground's frame.

    ground_arc, body_arc (...) [m]: arc lengths, whose sum is constant. point (..., 2) [m]: the contact. arm (..., 2)
    [m]: r_{O'/C}, from the contact to the body's origin. tangent_angle (...) [rad]: the angle of e_t, the direction in
    which the ground is traversed. ground_curvature, body_curvature (...) [1/m].
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
        return np.stack([np.cos(self.tangent_angle), np.sin(self.tangent_angle)], axis=-1)

    @property
    def normal(self) -> Array:
        """e_n = -k x e_t (..., 2), towards the interior of the body."""
        return np.stack([np.sin(self.tangent_angle), -np.cos(self.tangent_angle)], axis=-1)

    @property
    def conformality(self) -> Array:
        """(curvature_A + curvature_B) / max(|curvature|) (...): 1 for flat ground, 0 for opposite curvatures."""
        largest = np.maximum(np.abs(self.ground_curvature), np.abs(self.body_curvature))
        return (self.ground_curvature + self.body_curvature) / largest


# Smallest allowed conformality of a contact. At this value about seven of the sixteen digits of a double are accurate.
NEAR_CONFORMAL = 1e-9
# Number of points of a closed curve at which conformality and overlap are checked.
SCAN = 721


def first_fit(body: Curve, ground: Curve, body_arc: float, ground_arc: float, end: float, side: int) -> float:
    """The first arc of the body [m] in the direction `side` (+1, -1) at which the curves fit, or the `end` [m].

    At the start, the arc `body_arc` touches the ground at `ground_arc` [m]. end: the last arc of the curves, or
    infinity.
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
    """Raise InvalidMechanism unless a closed curve in a ring is inside the ring at all points."""
    rings = [
        (hole[0], -hole[1]) if (hole := signed_circle(curve)) and hole[1] < 0 else None for curve in (ground, body)
    ]
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


def signed_circle(curve: Curve) -> tuple[Array, float] | None:
    """Centre (2,) [m] and radius [m] of a circle, which may be `Placed`, or None for other curves.

    The radius of a hole is negative.
    """
    if isinstance(curve, Circle | Ring):
        return np.asarray(curve.centre, dtype=float), curve.sense * curve.radius
    if isinstance(curve, Placed) and (inner := signed_circle(curve.curve)):
        return rotated(np.asarray(curve.turn), inner[0]) + np.asarray(curve.shift), inner[1]
    return None
