"""Joints that hold two bodies by a length, a ratio of angles, or altogether: Rod, Gear, Weld.

What a joint has to have is told in `reference.joints`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from reference.checks import Name, Positive, Valid
from reference.distance import apart, distance, point_rows
from reference.kinds import Rule

Vector = tuple[float, float]
Ratio = Annotated[float, Rule(lambda value: value != 0, "other than zero")]


@dataclass(frozen=True)
class Rod(Valid):
    """A massless rigid rod: the distance of a point of each body stays `length` [m].

    `first_point` and `second_point` [m] are in the bodies' own frames, from the centre of mass; on the ground (None)
    world coordinates. Row: how fast the distance grows [m/s]. Reaction: force on the second body along the direction
    from the first point to the second [N], positive where the rod pushes.
    """

    size: ClassVar[int] = 1
    holonomic: ClassVar[bool] = True
    labels: ClassVar[tuple[str, ...]] = ("along",)

    name: Name
    first: Name | None
    second: Name | None
    first_point: Vector
    second_point: Vector
    length: Positive

    @property
    def rate(self) -> tuple[float, ...]:
        return (0.0,)

    def gap(self, first: NDArray[Any], second: NDArray[Any], t: ArrayLike) -> NDArray[Any]:
        """Distance of the two points minus the rod's length (..., 1) [m], for the bodies' poses (..., 3)."""
        length, _ = distance(first, second, self.first_point, self.second_point)
        return (length - np.asarray(self.length))[..., None]

    def rows(self, first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
        """Velocity row (..., 1, 6): columns are the first body's x, y, angle and then the second's."""
        return distance(first, second, self.first_point, self.second_point)[1][..., None, :]


@dataclass(frozen=True)
class Gear(Valid):
    """A pair of gears on fixed axles, or a belt: second angle = `ratio` times first angle + `phase` [rad].

    Angles are those of the poses, counted in the world and not wrapped; the ground's (None) is zero. A negative ratio
    is of wheels that mesh from outside, a positive one of a belt or a ring. Row: omega of the second minus `ratio`
    times omega of the first [rad/s]. Reaction: torque on the second body [N m]; on the first acts -ratio times as much,
    so that the frame, which is not in the equations, takes the rest.
    """

    size: ClassVar[int] = 1
    holonomic: ClassVar[bool] = True
    labels: ClassVar[tuple[str, ...]] = ("torque",)

    name: Name
    first: Name | None
    second: Name | None
    ratio: Ratio
    phase: float = 0.0

    @property
    def rate(self) -> tuple[float, ...]:
        return (0.0,)

    def gap(self, first: NDArray[Any], second: NDArray[Any], t: ArrayLike) -> NDArray[Any]:
        """Second angle minus what the gear prescribes (..., 1) [rad], for the bodies' poses (..., 3)."""
        return (second[..., 2] - np.asarray(self.ratio) * first[..., 2] - np.asarray(self.phase))[..., None]

    def rows(self, first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
        """Velocity row (..., 1, 6)."""
        rows = np.zeros((*first.shape[:-1], 1, 6), dtype=first.dtype)
        rows[..., 0, 2] = -np.asarray(self.ratio)
        rows[..., 0, 5] = 1
        return rows


@dataclass(frozen=True)
class Weld(Valid):
    """Two bodies as one: a point of each coincide, and the second stands at `angle` [rad] to the first.

    Points [m] are in the bodies' own frames, from the centre of mass; on the ground (None) world coordinates. The angle
    is the difference of the poses' angles, not wrapped. Rows: velocity of the second point minus that of the first, x
    then y, and omega of the second minus omega of the first. Reaction: force [N] at the point, and torque [N m], on the
    second body.
    """

    size: ClassVar[int] = 3
    holonomic: ClassVar[bool] = True
    labels: ClassVar[tuple[str, ...]] = ("x", "y", "torque")

    name: Name
    first: Name | None
    second: Name | None
    first_point: Vector
    second_point: Vector
    angle: float = 0.0

    @property
    def rate(self) -> tuple[float, ...]:
        return (0.0, 0.0, 0.0)

    def gap(self, first: NDArray[Any], second: NDArray[Any], t: ArrayLike) -> NDArray[Any]:
        """Distance of the points, second minus first, and what the angle is off (..., 3) [m, m, rad]."""
        off = second[..., 2] - first[..., 2] - np.asarray(self.angle)
        return np.concatenate([apart(first, second, self.first_point, self.second_point), off[..., None]], axis=-1)

    def rows(self, first: NDArray[Any], second: NDArray[Any]) -> NDArray[Any]:
        """Velocity rows (..., 3, 6): columns are the first body's x, y, angle and then the second's."""
        points = point_rows(first, second, self.first_point, self.second_point)
        rows = np.zeros((*points.shape[:-2], 3, 6), dtype=points.dtype)
        rows[..., :2, :] = points
        rows[..., 2, 2] = -1
        rows[..., 2, 5] = 1
        return rows
