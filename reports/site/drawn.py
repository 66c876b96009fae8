"""The drawing of a mechanism, with SVG elements for each body and with numbers of the joints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from reference.joints import Joint, Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.plane import rotated
from reference.rolling.roll import Roll
from reports.site.live.sliders import Look, Point

Array = NDArray[np.float64]

# Sizes as fractions of the mechanism's length scale.
BLOCK = 0.07  # Half the side of a rectangle for a body without joints and ends.
PIN = 0.018  # Radius of a pin.
BLADE = 0.16  # Length of a blade.
SUPPORT = 0.05  # Half the width of a support.
OUTLINE = 160  # Number of points of a curve.


def number(value: float, digits: int = 5) -> str:
    """Return a coordinate as text without trailing zeros."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def path(points: Iterable[Sequence[float] | Array], closed: bool = False) -> str:
    """Return the attribute `d` of a line through points."""
    return "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points) + ("Z" if closed else "")


def placed(pose: Sequence[float]) -> str:
    """Return the SVG transform of a body at a pose (x, y, angle) [m, m, rad]."""
    x, y, angle = pose
    return f"translate({number(x)} {number(y)}) rotate({number(np.degrees(angle), 4)})"


@dataclass(frozen=True)
class Stroke:
    """A line of a drawing with points (points, 2) [m]. `kind` selects its style."""

    kind: str
    points: Array
    closed: bool = False

    @property
    def outline(self) -> Array:
        """The points; the first point of a closed line is repeated at the end."""
        return np.vstack([self.points, self.points[:1]]) if self.closed else self.points

    def svg(self) -> str:
        return f'<path class="{self.kind}" d="{path(self.points, self.closed)}"/>'


def body_lines(mechanism: Mechanism, look: Look, name: str) -> list[Stroke]:
    """Return the lines of a body in the body's frame. Pins are left out (see `pins_of`)."""
    size = mechanism.length_scale
    points: list[Point] = list(look.ends.get(name, ()))
    lines: list[Stroke] = []
    for joint in mechanism.joints:
        if not isinstance(joint, Roll):
            points += [point for owner, point in joint.fixed_points if owner == name and point not in points]
        if isinstance(joint, Skate) and joint.second == name:
            half = BLADE * size / 2 * np.array([np.cos(joint.angle), np.sin(joint.angle)])
            across = look.axle * np.array([-half[1], half[0]]) / np.hypot(*half)
            centre = np.array(joint.second_point)
            lines += [
                Stroke("blade", np.array([wheel - half, wheel + half]))
                for wheel in {(*(centre + across),): 0, (*(centre - across),): 0}
            ]
            if look.axle:
                lines.append(Stroke("outline", np.array([centre - across, centre + across])))
            points.append((0.0, 0.0))
        if isinstance(joint, Roll):
            for owner, curve in ((joint.first, joint.rolling.ground), (joint.second, joint.rolling.body)):
                if owner == name:
                    outline = curve.point(np.linspace(0.0, curve.length, OUTLINE))
                    lines += [Stroke("outline", outline, True), Stroke("spoke", np.array([(0.0, 0.0), outline[0]]))]
    lines += [Stroke("curve", np.array(curve)) for owner, curve in look.curves if owner == name]
    unique = sorted(dict.fromkeys(points))
    if len(unique) > 1:
        lines.append(Stroke("bar", np.array(unique)))
    elif len(unique) == 1 and np.hypot(*unique[0]) > 1e-9 * size:
        lines.append(Stroke("bar", np.array([unique[0], (0.0, 0.0)])))
    elif not lines:
        half = BLOCK * size * np.array([1.0, 0.6])
        lines.append(Stroke("outline", half * np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]), True))
    return lines


def body_shape(mechanism: Mechanism, look: Look, name: str) -> str:
    radius = number(PIN * mechanism.length_scale)
    pins = [
        f'<circle class="pin" cx="{number(x)}" cy="{number(y)}" r="{radius}"/>' for x, y in pins_of(mechanism, name)
    ]
    return "".join([line.svg() for line in body_lines(mechanism, look, name)] + pins)


def pins_of(mechanism: Mechanism, name: str) -> list[Point]:
    pins = [joint for joint in mechanism.joints if isinstance(joint, Pin)]
    return list(dict.fromkeys(point for pin in pins for owner, point in pin.points if owner == name))


def ground_lines(mechanism: Mechanism, look: Look, pose: Array) -> list[Stroke]:
    """Return supports, slots and curves of the ground. `pose` (times, bodies, 3) is the exact motion."""
    size = mechanism.length_scale
    lines = []
    for joint in mechanism.joints:
        if isinstance(joint, Pin) and None in (joint.first, joint.second):
            x, y = joint.first_point if joint.first is None else joint.second_point
            half = SUPPORT * size
            corners = [(x, y), (x - half, y - 1.6 * half), (x + half, y - 1.6 * half)]
            lines.append(Stroke("support", np.array(corners), True))
        if isinstance(joint, Slot) and joint.first is None:
            along = np.array([np.cos(joint.line_angle), np.sin(joint.line_angle)])
            origin = np.array(joint.first_point)
            travel = (pose[:, mechanism.body_index(str(joint.second)), :2] - origin) @ along
            ends = (travel.min() - 0.2 * size, travel.max() + 0.2 * size)
            lines.append(Stroke("rail", np.array([origin + along * end for end in ends])))
        if isinstance(joint, Roll) and joint.first is None:
            lines.append(Stroke("rail", rolled_on(joint, pose, mechanism)))
    return [*lines, *(Stroke("curve fixed", np.array(curve)) for owner, curve in look.curves if owner is None)]


def rolled_on(joint: Roll, pose: Array, mechanism: Mechanism) -> Array:
    """Return points (points, 2) [m] of the ground's curve where a body rolls on it. A closed curve is returned
    whole."""
    curve = joint.rolling.ground
    low, high = curve.limits
    if np.isfinite(curve.length):
        return curve.point(np.linspace(max(low, 0.0), min(high, curve.length), OUTLINE))
    travelled = np.ptp(pose[:, mechanism.body_index(str(joint.second)), :2], axis=0).max()
    half = travelled + joint.rolling.body.length / 2
    return curve.point(np.linspace(joint.rolling.ground_arc - half, joint.rolling.ground_arc + half, OUTLINE))


def point_path(pose: Array, point: Point | Array) -> Array:
    """Return the positions (times, 2) [m] of a point of a body with poses (times, 3)."""
    return pose[:, :2] + rotated(pose[:, 2], np.array(point))


def box(mechanism: Mechanism, look: Look, pose: Array) -> tuple[float, float, float, float]:
    """Return left, bottom, width and height [m] of the area of the exact motion with a margin."""
    corners = [
        point_path(pose[:, index], point)
        for index, body in enumerate(mechanism.bodies)
        for line in body_lines(mechanism, look, body.name)
        if line.kind != "curve"  # a curve of instant centres may be much larger than the mechanism
        for point in line.points
    ]
    fixed = [
        joint.first_point if joint.first is None else joint.second_point
        for joint in mechanism.joints
        if isinstance(joint, Pin) and None in (joint.first, joint.second)
    ]
    fixed += [point for owner, curve in look.curves if owner is None for point in curve]
    everything = np.concatenate([*corners, np.array(fixed, dtype=float).reshape(-1, 2)])
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = 0.09 * float((high - low).max())
    width, height = high - low + 2 * margin
    least = 0.32 * width  # smallest height, so that the picture is not a thin strip
    lift = max(0.0, least - height) / 2
    return float(low[0] - margin), float(low[1] - margin - lift), float(width), float(max(height, least))


def index_of(mechanism: Mechanism, name: str | None) -> int:
    return -1 if name is None else mechanism.body_index(name)


def measure_of(mechanism: Mechanism) -> Literal["angle", "position"]:
    """Return the quantity whose error a page shows, which is "position" for mechanisms with skates, else "angle"."""
    return "angle" if mechanism.holonomic.all() else "position"


def joints_of(mechanism: Mechanism) -> list[dict[str, Any]]:
    """Return the pins and slots, from which a page computes gaps."""
    return [
        {
            "name": joint.name,
            "first": index_of(mechanism, joint.first),
            "second": index_of(mechanism, joint.second),
            "firstPoint": list(joint.first_point),
            "secondPoint": list(joint.second_point),
            "line": joint.line_angle if isinstance(joint, Slot) else None,
        }
        for joint in mechanism.joints
        if isinstance(joint, Pin | Slot)
    ]


def between(mechanism: Mechanism, joint: Joint, pose: Array) -> tuple[Array, Array]:
    """Return the poses (times, 3) of both bodies of a joint. Poses of the ground are zero."""
    ground = np.zeros((len(pose), 3))
    names = (joint.first, joint.second)
    first, second = (ground if name is None else pose[:, mechanism.body_index(name)] for name in names)
    return first, second


def place_of(joint: Joint, first: Array, second: Array) -> Array:
    """Return positions (times, 2) [m] of a joint, which are those of the contact of a Roll, else of the point on the
    second body."""
    if isinstance(joint, Roll):
        return first[:, :2] + rotated(first[:, 2], joint.rolling.contact(second[:, 2] - first[:, 2]).point)
    return point_path(second, getattr(joint, "second_point", (0.0, 0.0)))


def loose(mechanism: Mechanism) -> list[Skate | Roll]:
    return [joint for joint in mechanism.joints if isinstance(joint, Skate | Roll)]


def required_friction(reaction: Array) -> Array:
    """Return the friction coefficient (times,) [1] that rolling requires. `reaction` (times, 2): tangential and normal
    force.

    The result is NaN while the normal force pulls, since no coefficient is sufficient.
    """
    with np.errstate(all="ignore"):
        return np.where(reaction[:, 1] > 0, np.abs(reaction[:, 0]) / reaction[:, 1], np.nan)
