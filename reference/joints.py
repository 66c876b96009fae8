"""Rigid bodies, and the joints between two bodies or between a body and the ground.

A joint is defined by its gap, which is zero if the joint is satisfied, and by velocity rows J with J v = rate. The
tuple `JOINTS` has all classes. New classes must be needed by a scene and implemented in `engines.lagrange`.

Besides the properties of `elements.JointElement`, a joint has `labels`, the names of its `size` rows. A joint has two
functions of the poses (..., 3) of its two bodies, with the pose zero for the ground. `gap(first, second, t)` has the
shape (..., size). `rows(first, second)` has the shape (..., size, 6): its columns are x, y and angle of the first body,
then of the second. Rows are analytic functions, so they can be differentiated by a complex step. The reaction of a row
acts on the second body, and its opposite on the first. `rows.JointRows` evaluates the stackable joints of one class
together, with arrays in their numeric fields.

Points (..., 2) [m] are in the bodies' own frames, from the centre of mass; points on the ground (None) are world
coordinates.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, get_args

import numpy as np
from numpy.typing import ArrayLike

from reference.checks import Name, Positive, Valid
from reference.couplings import Coupling
from reference.elements import BetweenTwo, JointElement, Place, UnitExponents, Vector
from reference.plane import AnyArray, apart, direction_row, distance, point_rows
from reference.rolling.roll import Roll
from reference.validators import Rule

Triple = tuple[float, float, float]
Ratio = Annotated[float, Rule(lambda value: value != 0, "other than zero")]

# A point is on a slot's line if its distance from the line is at most this fraction of a spring's span. The fraction is
# far above rounding errors and far below mistakes in the input.
ON_LINE = 1e-9


@dataclass(frozen=True)
class Body(Valid):
    """A rigid body in the plane, described at its centre of mass.

    mass [kg]; inertia [kg m^2] about the centre of mass; pose (x, y, angle) [m, m, rad] and twist (vx, vy, omega)
    [m/s, m/s, rad/s] at t = 0. Raises InvalidMechanism unless mass and inertia are positive and all numbers finite.
    """

    name: Name
    mass: Positive
    inertia: Positive
    pose: Triple
    twist: Triple = (0.0, 0.0, 0.0)


def bodies_of(names: Sequence[str], masses: Any, inertias: Any, pose: Any, twist: Any) -> tuple[Body, ...]:
    """Bodies with these names, masses and inertias (bodies,), poses and twists (bodies, 3)."""
    numbers = (np.asarray(values, dtype=float).tolist() for values in (masses, inertias, pose, twist))
    return tuple(Body(name, m, i, tuple(p), tuple(v)) for name, m, i, p, v in zip(names, *numbers, strict=True))


@dataclass(frozen=True)
class _JointOfTwo(BetweenTwo, JointElement):
    pass


@dataclass(frozen=True)
class Pin(_JointOfTwo):
    """An ideal hinge (18.62): the point `first_point` of the first body and `second_point` of the second coincide.

    Rows: velocity of the second point minus velocity of the first, x then y. Reaction: force on the second body [N].
    """

    size: ClassVar[int] = 2
    labels: ClassVar[tuple[str, ...]] = ("x", "y")

    first_point: Vector
    second_point: Vector

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        return apart(first, second, self.first_point, self.second_point)

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return point_rows(first, second, self.first_point, self.second_point)


def _turning_row(first: AnyArray, ratio: Any) -> AnyArray:
    """The row (..., 1, 6) of the second body's rate minus `ratio` times the first body's rate, at poses (..., 3)."""
    rows = np.zeros((*first.shape[:-1], 1, 6), dtype=first.dtype)
    rows[..., 0, 2], rows[..., 0, 5] = -ratio, 1
    return rows


@dataclass(frozen=True)
class Drive(_JointOfTwo):
    """A prescribed relative rotation: the second body turns against the first at a constant `turning_rate` [rad/s].

    `offset` [rad] is the relative angle at t = 0. Row: omega of the second minus omega of the first. Reaction: torque
    on the second body [N m].
    """

    labels: ClassVar[tuple[str, ...]] = ("torque",)
    angular: ClassVar[tuple[int, ...]] = (0,)
    unit_exponents: ClassVar[UnitExponents] = {"turning_rate": (0, -1)}

    turning_rate: float
    offset: float

    @property
    def rate(self) -> tuple[float, ...]:
        return (self.turning_rate,)

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        """Relative angle minus the prescribed angle (..., 1) [rad] at times t [s], which broadcast against the
        poses.
        """
        prescribed = np.asarray(self.offset) + np.asarray(self.turning_rate) * np.asarray(t)
        return (second[..., 2] - first[..., 2] - prescribed)[..., None]

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return _turning_row(first, 1)


@dataclass(frozen=True)
class Slot(_JointOfTwo):
    """A straight slot in the first body, in which the point `second_point` of the second body slides.

    The line passes through `first_point` [m] of the first body at the angle `line_angle` [rad] in its frame. The second
    body may rotate; a `Drive` of rate zero prevents its rotation. Row: velocity of the second point relative to the
    first body, perpendicular to the line and positive to its left. Reaction: force perpendicular to the line on the
    second body [N].
    """

    labels: ClassVar[tuple[str, ...]] = ("across",)

    first_point: Vector
    line_angle: float
    second_point: Vector

    @property
    def fixed_points(self) -> tuple[Place, ...]:
        return ((self.second, self.second_point),)

    def guides(self, places: tuple[Place, ...], span: float) -> bool:
        """Whether one place is the sliding point and the other place is on the line in the first body."""
        for (line_body, on_line), (sliding_body, sliding_point) in (places, places[::-1]):
            if (line_body, sliding_body) != (self.first, self.second):
                continue
            x, y = on_line[0] - self.first_point[0], on_line[1] - self.first_point[1]
            off_line = abs(math.cos(self.line_angle) * y - math.sin(self.line_angle) * x)
            if max(off_line, math.dist(sliding_point, self.second_point)) <= ON_LINE * span:
                return True
        return False

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        """Distance of the second point from the line, positive to its left (..., 1) [m]."""
        line = first[..., 2] + np.asarray(self.line_angle)
        across_x, across_y = np.moveaxis(apart(first, second, self.first_point, self.second_point), -1, 0)
        return (np.cos(line) * across_y - np.sin(line) * across_x)[..., None]

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        line = first[..., 2] + np.asarray(self.line_angle)
        return direction_row(first, second, self.second_point, -np.sin(line), np.cos(line))


@dataclass(frozen=True)
class Skate(_JointOfTwo):
    """An ideal skate or massless wheel (18.64): a point of the second body can't move perpendicular to the blade.

    `second_point` [m] is the contact of the blade, and `angle` [rad] is the blade's direction in the second body's
    frame. Row: the velocity of the contact perpendicular to the blade, relative to the first body. A skate does not
    constrain the configuration, so its gap is NaN. Reaction: force on the second body [N], to the left of the blade.
    """

    holonomic: ClassVar[bool] = False
    labels: ClassVar[tuple[str, ...]] = ("across",)

    second_point: Vector
    angle: float = 0.0

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        """NaN (..., 1), since the constraint is not a function of the pose (18.65)."""
        return np.full((*np.broadcast_shapes(first.shape[:-1], second.shape[:-1]), 1), np.nan)

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        heading = second[..., 2] + np.asarray(self.angle)
        return direction_row(first, second, self.second_point, -np.sin(heading), np.cos(heading))


@dataclass(frozen=True)
class Rod(_JointOfTwo):
    """A massless rigid rod: the distance between a point of each body is `length` [m].

    Row: the rate of the distance [m/s]. Reaction: force on the second body [N] in the direction from the first point to
    the second, positive if the rod pushes.
    """

    labels: ClassVar[tuple[str, ...]] = ("along",)
    acts_along_line: ClassVar[bool] = True

    first_point: Vector
    second_point: Vector
    length: Positive

    @property
    def lengths(self) -> tuple[float, ...]:
        return (self.length,)

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        length, _ = distance(first, second, self.first_point, self.second_point)
        return (length - np.asarray(self.length))[..., None]

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return distance(first, second, self.first_point, self.second_point)[1][..., None, :]


@dataclass(frozen=True)
class Gear(_JointOfTwo):
    """A pair of gears on fixed axles, or a belt, with second angle = `ratio` * first angle + `phase` [rad].

    The angles of the poses are used, not wrapped; the angle of the ground (None) is zero. External gears have a
    negative ratio; belts and ring gears have a positive ratio. Row: omega of the second body minus `ratio` times omega
    of the first [rad/s]. Reaction: torque on the second body [N m]; -ratio times that torque acts on the first body.
    The bearings carry the remaining forces, which are not in the equations.
    """

    labels: ClassVar[tuple[str, ...]] = ("torque",)
    angular: ClassVar[tuple[int, ...]] = (0,)

    ratio: Ratio
    phase: float = 0.0

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        return (second[..., 2] - np.asarray(self.ratio) * first[..., 2] - np.asarray(self.phase))[..., None]

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        return _turning_row(first, np.asarray(self.ratio))


@dataclass(frozen=True)
class Weld(_JointOfTwo):
    """A rigid connection: two points coincide, and the second body has the angle `angle` [rad] relative to the first.

    The relative angle is the difference of the poses' angles, not wrapped. Rows: velocity of the second point minus
    velocity of the first point, x then y, and omega of the second body minus omega of the first body. Reaction: force
    [N] at the point and torque [N m] on the second body.
    """

    size: ClassVar[int] = 3
    labels: ClassVar[tuple[str, ...]] = ("x", "y", "torque")
    angular: ClassVar[tuple[int, ...]] = (2,)

    first_point: Vector
    second_point: Vector
    angle: float = 0.0

    def gap(self, first: AnyArray, second: AnyArray, t: ArrayLike) -> AnyArray:
        angle_error = second[..., 2] - first[..., 2] - np.asarray(self.angle)
        vector = apart(first, second, self.first_point, self.second_point)
        return np.concatenate([vector, angle_error[..., None]], axis=-1)

    def rows(self, first: AnyArray, second: AnyArray) -> AnyArray:
        points = point_rows(first, second, self.first_point, self.second_point)
        rows = np.zeros((*points.shape[:-2], 3, 6), dtype=points.dtype)
        rows[..., :2, :] = points
        rows[..., 2, 2] = -1
        rows[..., 2, 5] = 1
        return rows


Joint = Pin | Slot | Skate | Roll | Drive | Rod | Gear | Weld | Coupling
# Tests compare the tables of joints in engines and tools with this tuple.
JOINTS: tuple[type[Joint], ...] = get_args(Joint)
