"""The closed form of a four-bar for many crank angles: angles, rates and accelerations.

The triangles A B D and B C D at the diagonal B D are solved without cancellation. `reference/scenes/derivations.md`
defines the letters and derives the equations.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from reference.validators import Array

Interval = tuple[float, float]

# Number of roundings by which a crank angle may be outside the reachable range.
ANGLE_ROUNDINGS = 16


class Kinematics(NamedTuple):
    """Angles [rad], rates [rad/s] and accelerations [rad/s^2] of coupler and rocker, shaped like the arguments."""

    beta: Any
    phi: Any
    beta_dot: Any
    phi_dot: Any
    beta_ddot: Any
    phi_ddot: Any


class OutOfReach(Exception):
    """The loop can't close at the crank angle with this `index`. If `undetermined`, B is on D."""

    def __init__(self, index: int, undetermined: bool = False) -> None:
        super().__init__(index)
        self.index = index
        self.undetermined = undetermined


def difference(*terms: float) -> float:
    """The sum of terms, or zero for a sum within the rounding of the terms."""
    total = math.fsum(terms)
    return 0.0 if abs(total) <= 4 * np.finfo(float).eps * sum(abs(term) for term in terms) else total


class Constants(NamedTuple):
    """Constants of the closed form for lengths l1, l2, l3 [m] and the ground vector A -> D of length d [m].

    heading [rad] is the direction of A -> D. outer_near and outer_far are U at theta' = 0 and pi, inner_near and
    inner_far are W at theta' = 0 and pi. The largest distance of B from D can't be reached if outer_far < 0, the
    smallest distance if inner_near < 0. The loop has no position if outer_near < 0 or inner_far < 0.
    """

    l1: float
    l2: float
    l3: float
    d: float
    heading: float
    outer_far: float
    outer_near: float
    inner_near: float
    inner_far: float

    @classmethod
    def of(cls, l1: float, l2: float, l3: float, ground: tuple[float, float]) -> Constants:
        d = math.hypot(*ground)
        return cls(
            *(l1, l2, l3, d, math.atan2(ground[1], ground[0])),
            outer_far=difference(l2, l3, -l1, -d) * (l2 + l3 + l1 + d),
            outer_near=difference(l2, l3, -l1, d) * difference(l2, l3, l1, -d),
            inner_near=difference(l1, -d, -l2, l3) * difference(l1, -d, l2, -l3),
            inner_far=difference(l1, d, -l2, l3) * difference(l1, d, l2, -l3),
        )

    def crank_limits(self) -> tuple[Interval, ...] | None:
        """The intervals (low, high) of theta [rad] in which the loop closes, up to whole turns, or None for all
        theta."""
        # U or W is zero at theta' = 2 atan(sqrt(ratio)).
        outer = 2 * math.atan2(math.sqrt(self.outer_near), math.sqrt(-self.outer_far)) if self.outer_far < 0 else None
        inner = 2 * math.atan2(math.sqrt(-self.inner_near), math.sqrt(self.inner_far)) if self.inner_near < 0 else None
        if inner is None:
            return None if outer is None else ((self.heading - outer, self.heading + outer),)
        if outer is None:
            return ((self.heading + inner, self.heading + 2 * math.pi - inner),)
        return ((self.heading - outer, self.heading - inner), (self.heading + inner, self.heading + outer))


class Triangles(NamedTuple):
    square: Array  # s^2
    m: Array
    n: Array
    h: Array
    p: Array
    r: Array
    area: Array  # |q|


def closed_form(
    c: Constants, theta: Array, theta_dot: Array, theta_ddot: Array, branch: Array, order: int
) -> tuple[Array, ...]:
    """The first 2 (order + 1) fields of Kinematics; all arrays have the same shape.

    Raises OutOfReach. At the ends of the reachable range rates and accelerations are not finite.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        triangles = _triangles(c, theta)
        out = _angles(c, triangles, theta, branch)
        if order == 0:
            return out
        square, m, n, h, p, _, area = triangles
        q, half = branch * area, 0.5 / square
        y = h / q
        beta_1 = (m - y * p) * half
        phi_1 = beta_1 + y
        out += beta_1 * theta_dot, phi_1 * theta_dot
        if order == 1:
            return out
        # This is 2 l1 d cos(theta'); the square of the shorter bar avoids cancellation.
        turned = 2 * c.l1**2 - m if c.l1 < c.d else 2 * c.d**2 - n
        y_1 = (turned - y * y * (c.l2**2 + c.l3**2 - square)) / q
        beta_2 = (h * (1 - (beta_1 + phi_1)) - y_1 * p) * half
        phi_2 = beta_2 + y_1
        beta_ddot, phi_ddot = beta_2 * theta_dot**2, phi_2 * theta_dot**2
        if np.any(theta_ddot):
            beta_ddot, phi_ddot = beta_ddot + beta_1 * theta_ddot, phi_ddot + phi_1 * theta_ddot
        return (*out, beta_ddot, phi_ddot)


def _triangles(c: Constants, theta: Array) -> Triangles:
    # One tangent gives sin^2 and cos^2 of theta'/2, and the product of sine and cosine.
    half, turn_x, turn_y = np.tan(0.5 * theta), math.cos(c.heading / 2), math.sin(c.heading / 2)
    sine, cosine = half * turn_x - turn_y, half * turn_y + turn_x  # both over cos(theta/2)
    product, sine, cosine = sine * cosine, sine * sine, cosine * cosine
    scale = 1 / (cosine + sine)
    fourfold = 4 * c.l1 * c.d
    along = fourfold * (sine * scale)
    # U and W are computed from the end of the range at which their value is smaller and may be zero.
    near_u, near_w = abs(c.outer_near) < abs(c.outer_far), abs(c.inner_near) < abs(c.inner_far)
    across = fourfold * (cosine * scale)
    u = c.outer_near - along if near_u else c.outer_far + across
    w = c.inner_near + along if near_w else c.inner_far - across
    square = along + (c.l1 - c.d) ** 2
    u, w = _within_reach(c, u, w, square)
    excess = (c.l3 - c.l2) * (c.l3 + c.l2)
    return Triangles(
        square=square,
        m=along + 2 * c.l1 * (c.l1 - c.d),
        n=along + 2 * c.d * (c.d - c.l1),
        h=fourfold * (product * scale),
        p=square + excess,
        r=square - excess,
        area=np.sqrt(u * w),
    )


def _angles(c: Constants, triangles: Triangles, theta: Array, branch: Array) -> tuple[Array, Array]:
    _, m, n, h, p, r, area = triangles
    # v is B - D, scaled and rotated. The angle of v is measured from the longer of D -> A and A -> B and is below a
    # right angle.
    winding = c.l1 > c.d
    vx, vy = (m, h) if winding else (n, -h)
    # The sum of the angles of v and of the triangle is less than a whole turn, so one arctangent is enough.
    p, r = branch * p, branch * r
    wide_x, wide_y = vx * area, vy * area
    beta = np.arctan2(wide_y - vx * r, vy * r + wide_x)
    phi = np.arctan2(vx * p + wide_y, wide_x - vy * p)
    quarter = branch * (math.pi / 2)
    beta = beta + (quarter - math.pi if winding else quarter + c.heading)
    phi = phi + (-quarter if winding else math.pi - quarter + c.heading)
    return (beta + theta, phi + theta) if winding else (beta, phi)


def _within_reach(c: Constants, u: Array, w: Array, square: Array) -> tuple[Array, Array]:
    """Set negative values of U and W within rounding to zero. Raises OutOfReach unless every triangle closes."""
    if u.size and not min(float(np.min(u)), float(np.min(w))) >= 0:  # or NaN
        allowed = -ANGLE_ROUNDINGS * np.finfo(float).eps * (c.l1 + c.d) ** 2
        bad = ~(np.minimum(u, w) >= allowed)
        if np.any(bad):
            raise OutOfReach(int(np.argmax(bad)))
        u, w = np.maximum(u, 0), np.maximum(w, 0)
    if c.l1 == c.d and np.any(square == 0):
        raise OutOfReach(int(np.argmin(square)), undetermined=True)
    return u, w


def grashof(crank: float, coupler: float, rocker: float, ground: float) -> str:
    """The Grashof class by name, with the shortest bar s, the longest bar l and the remaining bars p, q [m].

    s + l > p + q: triple-rocker (no bar turns fully). s + l = p + q to rounding: change-point. s + l < p + q:
    double-crank if the ground is the shortest bar, double-rocker if the coupler is the shortest bar, else crank-rocker.
    If the rocker is the shortest bar, it turns fully and the crank swings.
    """
    bars = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": ground}
    shortest, *_ = ranked = sorted(bars, key=bars.__getitem__)
    s, p, q, longest = (bars[name] for name in ranked)
    excess = difference(s, longest, -p, -q)
    if excess > 0:
        return "triple-rocker"
    if excess == 0:
        return "change-point"
    return {"ground": "double-crank", "coupler": "double-rocker"}.get(shortest, "crank-rocker")
