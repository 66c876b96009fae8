"""The closed form of a four-bar for many crank angles: angles, rates and accelerations, block by block in the cache.

In the frame whose x axis points from A to D, with d = |AD|, theta' = theta - arg(D), and the mirror image taken for the
other branch, the triangle B C D has the side s = |DB| and, as exact differences that keep their relative accuracy,

    s^2               = (l1 - d)^2              + 4 l1 d sin^2(theta'/2)
    U = (l2+l3)^2-s^2 = (l2+l3)^2 - (l1+d)^2    + 4 l1 d cos^2(theta'/2)
                      = (l2+l3)^2 - (l1-d)^2    - 4 l1 d sin^2(theta'/2)
    W = s^2-(l2-l3)^2 = (l1-d)^2 - (l2-l3)^2    + 4 l1 d sin^2(theta'/2)
                      = (l1+d)^2 - (l2-l3)^2    - 4 l1 d cos^2(theta'/2)
    q = 4 area(BCD) = sqrt(U W)                       (Heron)
    p = s^2 + l3^2 - l2^2,  r = s^2 - l3^2 + l2^2     (2 s l3 cos, 2 s l2 cos of the triangle's angles at D and B)

so that C - D is B - D turned by -arg(p + i q) and scaled, and C - B is D - B turned by arg(r + i q). With
g = gx + i gy = (B - D) e^{-i theta} and y = gy / q, the chapter's (18.71), (18.70) and derivatives become rational:

    beta'  = (gx - y p) l1 / s^2,                          phi'  = beta'  + 2 l1 y
    beta'' = (gy (1 - beta' - phi') - y' p) l1 / s^2,      phi'' = beta'' + 2 l1 y'
    y'     = (l1 - gx - 2 l1 y^2 (l2^2 + l3^2 - s^2)) / q

One tangent of the half crank angle and two arctangents are all the transcendental functions needed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# All buffers of one block together fit a core's second-level cache; below about 1000 numpy's call overhead shows.
BLOCK = 8192
# A crank angle is a rounded number: one that misses the reachable range by this many roundings is taken as its end.
ROUNDINGS = 16


class Kinematics(NamedTuple):
    """Angles [rad], rates [rad/s] and accelerations [rad/s^2] of coupler and rocker, in the shape of the arguments."""

    beta: Any
    phi: Any
    beta_dot: Any
    phi_dot: Any
    beta_ddot: Any
    phi_ddot: Any


class OutOfReach(Exception):
    """Some angle in a block does not close the loop; `index` is the first, `undetermined` if B lies on D."""

    def __init__(self, index: int, undetermined: bool = False) -> None:
        super().__init__(index)
        self.index = index
        self.undetermined = undetermined


def difference(*terms: float) -> float:
    """The sum of terms, and exactly zero where it is nothing but the rounding of the terms themselves."""
    total = math.fsum(terms)
    return 0.0 if abs(total) <= 4 * np.finfo(float).eps * sum(abs(term) for term in terms) else total


@dataclass(frozen=True)
class Constants:
    """What the closed form needs of the lengths l1, l2, l3 [m] and the ground vector A -> D."""

    l1: float
    l2: float
    l3: float
    d: float
    heading: float  # rad, direction of A -> D
    outer_far: float  # U at theta' = pi; negative: B can't go that far from D
    outer_near: float  # U at theta' = 0; negative: no position at all
    inner_near: float  # W at theta' = 0; negative: B can't come so near to D
    inner_far: float  # W at theta' = pi; negative: no position at all

    @classmethod
    def of(cls, l1: float, l2: float, l3: float, ground: tuple[float, float]) -> Constants:
        d = math.hypot(*ground)
        return cls(
            l1=l1,
            l2=l2,
            l3=l3,
            d=d,
            heading=math.atan2(ground[1], ground[0]),
            outer_far=difference(l2, l3, -l1, -d) * (l2 + l3 + l1 + d),
            outer_near=difference(l2, l3, -l1, d) * difference(l2, l3, l1, -d),
            inner_near=difference(l1, -d, -l2, l3) * difference(l1, -d, l2, -l3),
            inner_far=difference(l1, d, -l2, l3) * difference(l1, d, l2, -l3),
        )


def sweep(
    constants: Constants, theta: Array, theta_dot: Array, theta_ddot: Array, branch: Array, order: int
) -> tuple[Array, ...]:
    """The first 2 (order + 1) fields of Kinematics, flat, for flat theta (n,) and others of n or 1 elements.

    Raises OutOfReach. At the ends of the reachable range rates and accelerations are not finite.
    """
    out = tuple(np.empty(theta.size) for _ in range(2 * (order + 1)))
    work = np.empty((14, min(BLOCK, theta.size)))
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        for start in range(0, theta.size, BLOCK):
            piece = slice(start, min(start + BLOCK, theta.size))
            rate, bend, sign = (value if value.size == 1 else value[piece] for value in (theta_dot, theta_ddot, branch))
            results = [column[piece] for column in out]
            try:
                _block(constants, theta[piece], rate, bend, sign, results, work[:, : piece.stop - start], order)
            except OutOfReach as refusal:
                raise OutOfReach(start + refusal.index, refusal.undetermined) from None
    return out


def _block(
    c: Constants,
    theta: Array,
    theta_dot: Array,
    theta_ddot: Array,
    branch: Array,
    out: list[Array],
    work: Array,
    order: int,
) -> None:
    half, cosine, sine, gx, gy, s, u, w, q, p, r, vx, vy, spare = work
    mirrored = branch.size > 1 or branch.flat[0] != 1

    # sin^2 and cos^2 of theta'/2, and 2 d sin cos = d sin theta'.
    np.multiply(theta, 0.5, out=half)
    np.tan(half, out=half)
    if c.heading == 0:
        if mirrored:
            half *= branch
        np.multiply(half, half, out=sine)
        np.add(sine, 1, out=cosine)
        np.divide(1, cosine, out=cosine)
        sine *= cosine
        np.multiply(half, cosine, out=gy)
    else:
        turn_x, turn_y = math.cos(c.heading / 2), math.sin(c.heading / 2)
        np.multiply(half, turn_y, out=cosine)
        cosine += turn_x
        half *= turn_x
        half -= turn_y
        if mirrored:
            half *= branch
        np.multiply(half, half, out=sine)
        np.multiply(cosine, half, out=gy)
        cosine *= cosine
        np.add(cosine, sine, out=spare)
        np.divide(1, spare, out=spare)
        sine *= spare
        cosine *= spare
        gy *= spare
    gy *= 2 * c.d

    cosine *= 4 * c.l1 * c.d
    np.multiply(sine, 4 * c.l1 * c.d, out=s)
    # From the end of the range where U, or W, is smaller: there it may vanish, and its digits must not cancel.
    if abs(c.outer_near) < abs(c.outer_far):
        np.subtract(c.outer_near, s, out=u)
    else:
        np.add(cosine, c.outer_far, out=u)
    if abs(c.inner_near) < abs(c.inner_far):
        np.add(s, c.inner_near, out=w)
    else:
        np.subtract(c.inner_far, cosine, out=w)
    s += (c.l1 - c.d) ** 2
    _refuse_out_of_reach(c, u, w, s)
    np.multiply(u, w, out=q)
    np.sqrt(q, out=q)
    excess = (c.l3 - c.l2) * (c.l3 + c.l2)
    np.add(s, excess, out=p)
    np.subtract(s, excess, out=r)
    np.multiply(sine, 2 * c.d, out=gx)
    gx += c.l1 - c.d

    # B - D seen from the direction that it never turns away from by a right angle: D -> A, or A -> B if that is longer.
    winding = c.l1 > c.d
    if winding:
        vx, vy = gx, gy
    else:
        np.multiply(sine, 2 * c.l1, out=vx)
        vx += c.d - c.l1
        np.multiply(gy, -c.l1 / c.d, out=vy)
    # That turn and the triangle's angle add up to less than a whole turn: one arctangent, a quarter turn off its cut.
    beta, phi = out[0], out[1]
    real, imaginary = cosine, u
    np.multiply(vx, q, out=w)
    np.multiply(vy, q, out=spare)
    np.multiply(vy, r, out=real)
    real += w
    np.multiply(vx, r, out=imaginary)
    np.subtract(spare, imaginary, out=imaginary)
    np.arctan2(imaginary, real, out=beta)
    np.multiply(vy, p, out=real)
    np.subtract(w, real, out=real)
    np.multiply(vx, p, out=imaginary)
    imaginary += spare
    np.arctan2(imaginary, real, out=phi)
    beta += math.pi / 2
    phi -= math.pi / 2
    if mirrored:
        beta *= branch
        phi *= branch
    if winding:
        beta += theta
        beta -= math.pi
        phi += theta
    else:
        beta += c.heading
        phi += c.heading + math.pi
    if order == 0:
        return

    # half, cosine, sine, u, w, spare and (unless winding) vx, vy are free from here on.
    ratio, y, beta_slope, phi_slope = half, w, u, cosine
    np.divide(c.l1, s, out=ratio)
    np.divide(gy, q, out=y)
    np.multiply(y, p, out=beta_slope)
    np.subtract(gx, beta_slope, out=beta_slope)
    beta_slope *= ratio
    np.multiply(y, 2 * c.l1, out=phi_slope)
    phi_slope += beta_slope
    np.multiply(beta_slope, theta_dot, out=out[2])
    np.multiply(phi_slope, theta_dot, out=out[3])
    if order == 1:
        return

    y_slope, bend = y, sine
    y_slope *= y
    np.subtract(c.l2**2 + c.l3**2, s, out=bend)
    y_slope *= bend
    y_slope *= -2 * c.l1
    y_slope -= gx
    y_slope += c.l1
    y_slope /= q
    np.add(beta_slope, phi_slope, out=bend)
    np.subtract(1, bend, out=bend)
    bend *= gy
    np.multiply(y_slope, p, out=spare)
    bend -= spare
    bend *= ratio  # beta''
    y_slope *= 2 * c.l1
    y_slope += bend  # phi''
    square = branch * theta_dot**2
    np.multiply(bend, square, out=out[4])
    np.multiply(y_slope, square, out=out[5])
    if theta_ddot.size > 1 or theta_ddot.flat[0] != 0:
        beta_slope *= theta_ddot
        phi_slope *= theta_ddot
        out[4] += beta_slope
        out[5] += phi_slope


def _refuse_out_of_reach(c: Constants, u: Array, w: Array, s: Array) -> None:
    """Raise OutOfReach unless every triangle closes; misses by rounding are made exact zeros."""
    lowest = min(float(np.min(u)), float(np.min(w)))
    if not lowest >= 0:  # a NaN fails too
        allowed = -ROUNDINGS * np.finfo(float).eps * (c.l1 + c.d) ** 2
        bad = ~(np.minimum(u, w) >= allowed)
        if np.any(bad):
            raise OutOfReach(int(np.argmax(bad)))
        np.maximum(u, 0, out=u)
        np.maximum(w, 0, out=w)
    if c.l1 == c.d and float(np.min(s)) == 0:
        raise OutOfReach(int(np.argmin(s)), undetermined=True)
