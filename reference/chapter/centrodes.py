"""Body curve and space curve of any motion that rotates: where the instant centre runs, and rolling it back.

The body curve is the polhode (moving centrode), the space curve the herpolhode (fixed centrode).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from reference.checks import InvalidMechanism, Numbers, Valid, index_of, validated
from reference.kinds import NOT_FINITE, of_shape
from reference.plane import perpendicular, rotated
from reference.rolling.curves import Array
from reference.rolling.kinematics import Rolling
from reference.rolling.traced import FEWEST, STILL, Traced, spline
from reference.trajectory import Trajectory

# A rotation this much slower than its fastest has its instant centre a million times farther away than the motion is
# large: for the shapes it is at infinity.
SLOWEST = 1e-6

Poses = Annotated[Array, of_shape("n", 3)]
States = Annotated[Numbers, of_shape("...", 3)]


@validated
def instant_centre(pose: States, twist: States) -> tuple[Array, Array]:
    """The point that has no velocity, r_{C/O'} = k x v_{O'} / omega, in space and in the body (..., 2) [m].

    pose, twist (..., 3) of one body. NaN where the rotation rate is zero: the centre is at infinity.
    """
    rate = np.where(twist[..., 2] == 0, np.nan, twist[..., 2])
    arm = perpendicular(twist[..., :2]) / rate[..., None]
    return pose[..., :2] + arm, rotated(-pose[..., 2], arm)


@validated
def centrode_error(truth: Trajectory, other: Trajectory, body: int = 0) -> Array:
    """Distance (times,) [m] between the instant centres in space of one body: an engine's velocity error as a length.

    Both trajectories at the same times. NaN where either rotation rate vanishes; it grows without bound towards there.
    """
    if truth.t.shape != other.t.shape or not np.allclose(truth.t, other.t, rtol=0, atol=1e-9):
        raise ValueError("centrode error: the two trajectories have different times; sample the truth at the engine's")
    body = index_of("centrode_error", "body", body, truth.pose.shape[1])
    exact = instant_centre(truth.pose[:, body], truth.twist[:, body])[0]
    return np.linalg.norm(instant_centre(other.pose[:, body], other.twist[:, body])[0] - exact, axis=-1)


@dataclass(frozen=True, eq=False)
class Centrodes(Valid):
    """Both curves of a motion, sampled in the order of growing rotation; make one with `centrodes` or `from_poses`."""

    pose: Poses  # (n, 3) m, m, rad
    space: Annotated[Array, of_shape("n", 2)]  # (n, 2) m, instant centre in the world
    body: Annotated[Array, of_shape("n", 2)]  # (n, 2) m, the same in the body's frame
    error: Annotated[
        float, NOT_FINITE
    ]  # m, how far the curves move if every second sample is left out: a bound on interpolation

    @property
    def theta(self) -> Array:
        """Rotation (n,) [rad], growing."""
        return self.pose[:, 2]

    @cached_property
    def space_curve(self) -> Traced:
        """The fixed curve A, traversed as the contact runs while theta grows: its material on the left."""
        return Traced(self.theta, self.space)

    @cached_property
    def body_curve(self) -> Traced:
        """The moving curve B, traversed against the contact, as rolling has it."""
        return Traced(-self.theta[::-1], self.body[::-1])

    @property
    def space_curvature(self) -> Array:
        """curvature_A (n,) [1/m], positive towards the left of the contact's way."""
        return self.space_curve.curvature_of(self.theta)

    @property
    def body_curvature(self) -> Array:
        """curvature_B (n,) [1/m]."""
        return self.body_curve.curvature_of(-self.theta)

    @property
    def space_arc(self) -> Array:
        """How far the contact has run on A (n,) [m]."""
        return self.space_curve.arc_of(self.theta)

    @property
    def body_arc(self) -> Array:
        """How far the contact has run on B (n,) [m], counted along its own way: equal to `space_arc`."""
        return self.body_curve.limits[1] - self.body_curve.arc_of(-self.theta)

    @property
    def rate(self) -> Array:
        """ds/dtheta (n,) [m/rad] from the way of the centre; 1 / (curvature_A + curvature_B) says the same."""
        return self.space_curve.speed_of(self.theta)

    def rolling(self) -> Rolling:
        """The body curve rolling on the space curve, started in the middle: it gives the motion back.

        Its `limits` are the ends of the table up to the error of the tangents there, of the order of `error` per step.
        """
        middle = len(self.theta) // 2
        start = float(self.theta[middle])
        space_arc = float(self.space_curve.arc_of(start))
        rolling = Rolling.at_arcs(self.body_curve, self.space_curve, space_arc, float(self.body_curve.arc_of(-start)))
        turns = 2 * math.pi * round((start - rolling.theta) / (2 * math.pi))
        return Rolling(rolling.body, rolling.ground, rolling.theta + turns, rolling.ground_arc, rolling.body_arc)


@validated
def centrodes(t: Annotated[Array, of_shape("n")], pose: Poses, twist: Poses) -> Centrodes:
    """Both curves from times (n,) [s], poses and twists (n, 3) of one body, as a truth or an engine gives them.

    Raises InvalidMechanism where the rotation rate vanishes or changes its sign (the centre is at infinity: cut the
    motion there), where nothing rotates, for fewer than 16 samples, times that don't grow, or numbers not finite.
    """
    t, pose = _checked(t, pose)
    if twist.shape != pose.shape:
        raise InvalidMechanism(f"centrodes: twists have the shape {twist.shape}; give one for each pose, {pose.shape}")
    rate = twist[:, 2]
    fastest = float(np.abs(rate).max())
    if fastest * float(np.ptp(t)) <= 1e-9:
        raise InvalidMechanism("centrodes: the body doesn't rotate; a translation has no instant centre")
    slow = np.flatnonzero(np.abs(rate) <= SLOWEST * fastest)
    if slow.size:
        raise InvalidMechanism(
            f"centrodes: the rotation rate vanishes at t = {t[slow[0]]:.6g} s (sample {slow[0]}), where the "
            "instant centre goes to infinity; cut the motion before it"
        )
    turned = np.flatnonzero(rate[1:] * rate[:-1] < 0)
    if turned.size:
        raise InvalidMechanism(
            f"centrodes: the rotation rate changes its sign between t = {t[turned[0]]:.6g} and "
            f"{t[turned[0] + 1]:.6g} s, and the instant centre passes infinity; cut the motion there"
        )
    space, body = instant_centre(pose, twist)
    return _assembled(pose, space, body)


@validated
def from_poses(t: Annotated[Array, of_shape("n")], pose: Poses) -> Centrodes:
    """Both curves from a table of poses (n, 3) at times (n,) [s] alone: twists by a spline of degree 7.

    Angles may be wrapped, if no two neighbours differ by half a turn. Raises as `centrodes`. Only the order of the
    poses matters: the curves of a motion don't depend on how fast it is run through.
    """
    t, pose = _checked(t, pose)
    full = centrodes(t, pose, spline(t, pose).derivative()(t))
    if len(t) < 2 * FEWEST:
        return full
    half = spline(t[::2], pose[::2])
    space, _ = instant_centre(half(t), half.derivative()(t))
    order = slice(None) if pose[-1, 2] > pose[0, 2] else slice(None, None, -1)
    # Not at the very ends: there the half table would extrapolate.
    inner = slice(0, len(t) - 1 + len(t) % 2)
    moved = np.linalg.norm(space[inner] - full.space[order][inner], axis=-1)
    return Centrodes(full.pose, full.space, full.body, max(full.error, float(np.max(moved))))


def _checked(t: Array, pose: Array) -> tuple[Array, Array]:
    pose = pose.copy()
    if len(pose) != len(t):
        raise InvalidMechanism(f"centrodes: times {t.shape} and poses {pose.shape}; give (n,) times and (n, 3) poses")
    if len(t) < FEWEST:
        raise InvalidMechanism(f"centrodes: {len(t)} poses are too few; give at least {FEWEST}")
    if np.any(np.diff(t) <= 0):
        where = int(np.argmax(np.diff(t) <= 0)) + 1
        raise InvalidMechanism(f"centrodes: time {t[where]!r} s (sample {where}) is not after the one before it")
    pose[:, 2] = np.unwrap(pose[:, 2])
    return t, pose


def _assembled(pose: Array, space: Array, body: Array) -> Centrodes:
    if pose[-1, 2] < pose[0, 2]:
        pose, space, body = pose[::-1], space[::-1], body[::-1]
    if np.any(np.diff(pose[:, 2]) <= 0):
        where = int(np.argmax(np.diff(pose[:, 2]) <= 0))
        raise InvalidMechanism(
            f"centrodes: the angle doesn't grow between {pose[where, 2]:.9g} and {pose[where + 1, 2]:.9g} rad "
            "though the rotation rate keeps its sign; poses and twists don't belong together, or "
            "the samples are too far apart"
        )
    span = float(np.ptp(pose[:, 2]))
    size = max(float(np.abs(body).max()), float(np.ptp(space, axis=0).max()))
    if float(np.ptp(space, axis=0).max()) <= STILL * max(size, float(np.abs(space).max())):
        raise InvalidMechanism(
            f"centrodes: the instant centre stays at ({space[0, 0]:.6g}, {space[0, 1]:.6g}) m over {span:.3g} rad; the "
            "body only rotates about it, and both curves are that point"
        )
    return Centrodes(pose, space, body, max(_halved(pose[:, 2], space), _halved(pose[:, 2], body)))


def _halved(theta: Array, points: NDArray[np.float64]) -> float:
    """How far the points left out lie from the curve through every second one [m]; NaN if too few are left."""
    if len(theta) < 2 * FEWEST:
        return math.nan
    last = len(theta) - 1 + len(theta) % 2
    left_out = slice(1, last, 2)
    return float(np.linalg.norm(spline(theta[::2], points[::2])(theta[left_out]) - points[left_out], axis=-1).max())
