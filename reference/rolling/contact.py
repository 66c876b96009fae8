"""Where one curve touches another that it rolls on, and where two can't roll: they cut, fit, or one leaves a ring."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import InvalidMechanism
from reference.plane import rotated
from reference.rolling.curves import Array, Curve, Placed, Ring


@dataclass(frozen=True)
class Contact:
    """The contact at rotations (...) [rad] of the body, everything in the ground's frame unless it says otherwise."""

    theta: Array
    ground_arc: Array  # (...) m
    body_arc: Array  # (...) m; ground_arc + body_arc is constant
    point: Array  # (..., 2) m, where the curves touch
    arm: Array  # (..., 2) m, r_{O'/C}: the body's origin seen from the contact
    tangent_angle: Array  # (...) rad, of e_t: the direction in which the ground is traversed
    ground_curvature: Array  # (...) 1/m
    body_curvature: Array  # (...) 1/m

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
        """e_n (..., 2), towards the interior of the body: -k x e_t whatever the curves are."""
        return np.stack([np.sin(self.tangent_angle), -np.cos(self.tangent_angle)], axis=-1)

    @property
    def conformality(self) -> Array:
        """(curvature_A + curvature_B) / max(|curvature|) (...): 1 on flat ground, 0 when the curves fit each other."""
        largest = np.maximum(np.abs(self.ground_curvature), np.abs(self.body_curvature))
        return (self.ground_curvature + self.body_curvature) / largest


# The contact is lost as the inverse of (curvature_A + curvature_B) / max(|curvature|): at this fraction about seven
# of a double's sixteen digits are left in it, and a truth of fewer would be none.
NEAR_CONFORMAL = 1e-9
SCAN = 721  # places at which a pair that might be conformal somewhere is examined, once round


def first_fit(body: Curve, ground: Curve, body_arc: float, ground_arc: float, end: float, side: int) -> float:
    """The first arc of the body [m] on one side (+1, -1) of its start where the curvatures cancel, or the `end` [m].

    At the start `body_arc` touches the ground at `ground_arc` [m]. `end`: the last arc there is, maybe infinite.
    """
    total = ground_arc + body_arc
    period = body.length if not math.isfinite(ground.length) else body.length + ground.length
    if not math.isfinite(end):
        if not math.isfinite(period):
            return end
        reach = body_arc + side * period
    else:
        reach = end

    def free(arc: ArrayLike) -> Array:
        on_body = body.curvature_of(body.parameter(arc))
        on_ground = ground.curvature_of(ground.parameter(total - np.asarray(arc)))
        with np.errstate(invalid="ignore"):  # at a pole, where rolling never ends
            return on_ground + on_body - NEAR_CONFORMAL * np.maximum(np.abs(on_ground), np.abs(on_body))

    arcs = np.linspace(body_arc, reach, SCAN)
    blocked = np.flatnonzero(free(arcs) <= 0)
    if blocked.size == 0:
        return end
    good, bad = float(arcs[max(blocked[0] - 1, 0)]), float(arcs[blocked[0]])
    for _ in range(60):
        middle = 0.5 * (good + bad)
        good, bad = (middle, bad) if free(middle) > 0 else (good, middle)
    return good


def refuse_conformal(contact: Contact) -> None:
    """Raises InvalidMechanism where curvature_A + curvature_B isn't positive, or below NEAR_CONFORMAL of the larger."""
    with np.errstate(divide="ignore", invalid="ignore"):
        near = ~(contact.conformality >= NEAR_CONFORMAL)
    if np.any(near):
        theta, arc, on_body, a, b = (
            float(value[near].flat[0])
            for value in (
                np.broadcast_to(contact.theta, near.shape),
                np.broadcast_to(contact.ground_arc, near.shape),
                np.broadcast_to(contact.body_arc, near.shape),
                contact.ground_curvature,
                contact.body_curvature,
            )
        )
        raise InvalidMechanism(
            f"rolling: at theta = {theta:.9g} rad (arc {arc:.9g} m of the ground, {on_body:.9g} m of the body) the "
            f"curvatures are {a:.9g} and {b:.9g} 1/m; their sum must be positive, and above "
            f"{NEAR_CONFORMAL:g} of the larger, else the curves cut into each other or fit so closely "
            "that the contact has no place"
        )


def refuse_overlap(body: Curve, ground: Curve, contact: Contact) -> None:
    """A closed curve inside a ring must lie inside it all round, not only at the contact; else InvalidMechanism."""
    around, within = _ring(ground), _ring(body)
    if around is not None and within is None and math.isfinite(body.length):
        (centre, radius), other = around, body
    elif within is not None and around is None and math.isfinite(ground.length):
        (centre, radius), other = within, ground
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


def _ring(curve: Curve) -> tuple[Array, float] | None:
    """Centre (2,) [m] and radius [m] of a ring, placed or not; None for any other curve."""
    if isinstance(curve, Ring):
        return np.asarray(curve.centre, dtype=float), curve.radius
    inner = _ring(curve.curve) if isinstance(curve, Placed) else None
    if inner is None or not isinstance(curve, Placed):
        return None
    return rotated(np.asarray(curve.turn), inner[0]) + np.asarray(curve.shift), inner[1]
