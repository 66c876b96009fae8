"""Body curve and space curve of any motion with rotation, and their shapes as CSV, SVG or DXF.

The body curve is the polhode (moving centrode), the space curve the herpolhode (fixed centrode).
"""

from __future__ import annotations

import csv
import io
import math
from dataclasses import dataclass
from functools import cached_property
from typing import Annotated

import numpy as np

from reference.checks import LARGEST_COUNT, InvalidMechanism, Numbers, Positive, Valid, index_of, validated
from reference.plane import perpendicular, rotated
from reference.rolling.kinematics import Rolling
from reference.rolling.open_curves import FEWEST, STILL, Traced, spline
from reference.trajectory import Trajectory
from reference.validators import NOT_FINITE, Array, from_to, of_shape

# Smallest rotation rate, relative to the largest, at which the instant centre counts as finite. The centre's distance
# is then a million times the size of the motion.
SLOWEST = 1e-6

Poses = Annotated[Array, of_shape("n", 3)]
Places = Annotated[Array, of_shape("n", 2)]
States = Annotated[Numbers, of_shape("...", 3)]


@validated
def instant_centre(pose: States, twist: States) -> tuple[Array, Array]:
    """The point without velocity, r_{C/O'} = k x v_{O'} / omega, in space and in the body (..., 2) [m].

    pose and twist (..., 3) are of one body. NaN if the rotation rate is zero, since the centre is then at infinity.
    """
    rate = np.where(twist[..., 2] == 0, np.nan, twist[..., 2])
    arm = perpendicular(twist[..., :2]) / rate[..., None]
    return pose[..., :2] + arm, rotated(-pose[..., 2], arm)


@validated
def centrode_error(truth: Trajectory, other: Trajectory, body: int = 0) -> Array:
    """Distance (times,) [m] between the instant centres in two motions of a body, for velocity errors as lengths.

    Both trajectories must have the same times. NaN if either rotation rate vanishes; near such a time the distance
    grows without bound.
    """
    if truth.t.shape != other.t.shape or not np.allclose(truth.t, other.t, rtol=0, atol=1e-9):
        raise ValueError("centrode error: the two trajectories have different times; sample the truth at the engine's")
    body = index_of("centrode_error", "body", body, truth.pose.shape[1])
    exact = instant_centre(truth.pose[:, body], truth.twist[:, body])[0]
    return np.linalg.norm(instant_centre(other.pose[:, body], other.twist[:, body])[0] - exact, axis=-1)


@dataclass(frozen=True, eq=False)
class Centrodes(Valid):
    """The body curve and the space curve of a motion, sampled in the order of increasing rotation.

    pose (n, 3) [m, m, rad] is the body's motion. space and body (n, 2) [m] are the instant centre in the world and in
    the body's frame. error [m] is the change of the curves without every second sample, a bound on the interpolation
    error.
    """

    pose: Poses
    space: Places
    body: Places
    error: Annotated[float, NOT_FINITE]

    @property
    def theta(self) -> Array:
        return self.pose[:, 2]

    @cached_property
    def space_curve(self) -> Traced:
        """The fixed curve A with its material on the left, traversed as the contact moves for growing theta."""
        return Traced(self.theta, self.space)

    @cached_property
    def body_curve(self) -> Traced:
        """The moving curve B, traversed against the motion of the contact."""
        return Traced(-self.theta[::-1], self.body[::-1])

    @property
    def space_curvature(self) -> Array:
        """curvature_A (n,) [1/m], positive towards the left of the contact's path."""
        return self.space_curve.curvature_of(self.theta)

    @property
    def body_curvature(self) -> Array:
        return self.body_curve.curvature_of(-self.theta)

    @property
    def space_arc(self) -> Array:
        """Arc length of the contact on A (n,) [m]."""
        return self.space_curve.arc_of(self.theta)

    @property
    def body_arc(self) -> Array:
        """Arc length (n,) [m] of the contact on B, which equals `space_arc`."""
        return self.body_curve.limits[1] - self.body_curve.arc_of(-self.theta)

    @property
    def rate(self) -> Array:
        """ds/dtheta (n,) [m/rad] from the path of the centre, which equals 1 / (curvature_A + curvature_B)."""
        return self.space_curve.speed_of(self.theta)

    def rolling(self) -> Rolling:
        """The body curve rolling on the space curve, which reproduces the motion; the start is the middle sample.

        The first and last sample limit the rolling, up to an error of the tangents of about `error` per step.
        """
        middle = len(self.theta) // 2
        start = float(self.theta[middle])
        space_arc = float(self.space_curve.arc_of(start))
        rolling = Rolling.at_arcs(self.body_curve, self.space_curve, space_arc, float(self.body_curve.arc_of(-start)))
        turns = 2 * math.pi * round((start - rolling.theta) / (2 * math.pi))
        return Rolling(rolling.body, rolling.ground, rolling.theta + turns, rolling.ground_arc, rolling.body_arc)


@validated
def centrodes(t: Annotated[Array, of_shape("n")], pose: Poses, twist: Poses) -> Centrodes:
    """The centrodes of a body with poses and twists (n, 3) at times (n,) [s].

    Raises InvalidMechanism for fewer than 16 samples, times that don't increase, numbers that are not finite, and a
    rotation rate that vanishes or changes its sign. The centre is then at infinity; cut the motion there.
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
    """The centrodes of a body with poses (n, 3) at times (n,) [s]; the twists are derivatives of a spline of degree 7.

    Angles may be wrapped if neighbours differ by less than half a turn. Raises the errors of `centrodes`. The curves
    depend on the order of the poses, but not on the speed of the motion.
    """
    t, pose = _checked(t, pose)
    full = centrodes(t, pose, spline(t, pose).derivative()(t))
    if len(t) < 2 * FEWEST:
        return full
    half = spline(t[::2], pose[::2])
    space, _ = instant_centre(half(t), half.derivative()(t))
    order = slice(None) if pose[-1, 2] > pose[0, 2] else slice(None, None, -1)
    # The spline through every second sample would be extrapolated at the end of an even number of samples.
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


def _halved(theta: Array, points: Array) -> float:
    """The largest distance [m] of left-out points from the curve through every second point, or NaN for few points."""
    if len(theta) < 2 * FEWEST:
        return math.nan
    last = len(theta) - 1 + len(theta) % 2
    left_out = slice(1, last, 2)
    return float(np.linalg.norm(spline(theta[::2], points[::2])(theta[left_out]) - points[left_out], axis=-1).max())


POSE_COLUMNS = ("t", "x", "y", "angle")
Points = Annotated[int, from_to(2, LARGEST_COUNT)]


@dataclass(frozen=True, eq=False)
class Shapes(Valid):
    """Points at equal distances along two boundaries; points of equal index touch each other.

    space and body (n, 2) [m] are the fixed part in the world and the moving part in the body's frame. pose (n, 3) [m,
    m, rad] is the moving part's pose at each contact. `Centrodes` explains error [m].
    """

    space: Places
    body: Places
    pose: Poses
    error: Annotated[float, NOT_FINITE]


@validated
def shapes_of(motion: Centrodes, points: Points = 400) -> Shapes:
    space, body = motion.space_curve, motion.body_curve
    arcs = np.linspace(0.0, space.limits[1], points)
    theta = space.parameter(arcs)
    fixed, moving = space.point_of(theta), body.point_of(-theta)
    pose = np.column_stack([fixed - rotated(theta, moving), theta])
    return Shapes(fixed, moving, pose, motion.error)


@validated
def poses_from_csv(text: str) -> tuple[Array, Array]:
    """Times (n,) [s] and poses (n, 3) [m, m, rad] from CSV with the columns t, x, y, angle in any order.

    Raises InvalidMechanism, which names a missing column or a line with numbers that are not finite.
    """
    reader = csv.DictReader(io.StringIO(text), skipinitialspace=True)
    names = [name.strip() for name in reader.fieldnames or []]
    missing = [name for name in POSE_COLUMNS if name not in names]
    if missing:
        raise InvalidMechanism(f"poses: the first line has no column {missing[0]!r}; it must name t, x, y and angle")
    reader.fieldnames = names
    rows = []
    for number, row in enumerate(reader, start=2):
        try:
            rows.append([float(row[name]) for name in POSE_COLUMNS])
            if not np.isfinite(rows[-1]).all():
                raise ValueError
        except (TypeError, ValueError):
            raise InvalidMechanism(
                f"poses: line {number} is {list(row.values())}; t, x, y, angle must be finite numbers"
            ) from None
    table = np.array(rows).reshape(-1, 4)
    return table[:, 0], table[:, 1:]


@validated
def as_csv(shapes: Shapes) -> str:
    """CSV with space_x, space_y, body_x, body_y [m] and the moving part's x, y [m] and angle [rad] at each contact."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["space_x", "space_y", "body_x", "body_y", "x", "y", "angle"])
    writer.writerows([float(v) for v in row] for row in np.hstack([shapes.space, shapes.body, shapes.pose]))
    return out.getvalue()


@validated
def as_svg(shapes: Shapes, width: Positive = 200.0) -> str:
    """SVG of both curves, `width` [mm] wide, with the moving part in the pose of the first contact."""
    moved = placed_body(shapes, 0)
    corners = np.vstack([shapes.space, moved])
    low, size = corners.min(axis=0), np.ptp(corners, axis=0)
    margin = 0.05 * float(size.max())
    scale = width / (float(size[0]) + 2 * margin)
    height = (float(size[1]) + 2 * margin) * scale

    def path(points: Array) -> str:
        x = (points[:, 0] - low[0] + margin) * scale
        y = height - (points[:, 1] - low[1] + margin) * scale
        return "M" + " L".join(f"{a:.4f},{b:.4f}" for a, b in zip(x, y, strict=True))

    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width:.4f}mm" height="{height:.4f}mm" '
        f'viewBox="0 0 {width:.4f} {height:.4f}" fill="none" stroke-width="{width / 400:.4f}">\n'
        f'<path id="space" stroke="#1b4965" d="{path(shapes.space)}"/>\n'
        f'<path id="body" stroke="#c1121f" d="{path(moved)}"/>\n</svg>\n'
    )


@validated
def placed_body(shapes: Shapes, index: int) -> Array:
    """The moving part's points (n, 2) [m] in the world at contact `index`."""
    x, y, angle = shapes.pose[index_of("placed_body", "index", index, len(shapes.pose))]
    return rotated(angle, shapes.body) + np.array([x, y])


@validated
def as_dxf(shapes: Shapes) -> str:
    """DXF in metres with two polylines, on the layers SPACE (world's frame) and BODY (body's own frame)."""
    from ezdxf.filemanagement import new  # slow to import

    document = new("R2010", setup=False, units=6)  # 6: metres
    for layer, color, points in (("SPACE", 5, shapes.space), ("BODY", 1, shapes.body)):
        document.layers.add(layer, color=color)
        document.modelspace().add_lwpolyline([(float(x), float(y)) for x, y in points], dxfattribs={"layer": layer})
    out = io.StringIO()
    document.write(out)
    return out.getvalue()
