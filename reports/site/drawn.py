"""A mechanism as SVG groups: one group a body, which only has to be moved and turned to show another instant."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from reference.joints import Pin, Skate, Slot
from reference.mechanism import Mechanism
from reference.rolling.roll import Roll
from reports.site.lesson import Point, Take

Array = NDArray[np.float64]

BLOCK = 0.07  # of the mechanism's length: half the side of a body that has no extent of its own
BLADE = 0.16  # of the mechanism's length: a blade
OUTLINE = 160  # points of a curve


def number(value: float, digits: int = 5) -> str:
    """A coordinate for a drawing, without trailing zeros."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".")
    return "0" if text in ("-0", "") else text


def path(points: Iterable[Sequence[float] | Array], closed: bool = False) -> str:
    """The `d` of a line through points."""
    return "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points) + ("Z" if closed else "")


def placed(pose: Sequence[float]) -> str:
    """The transform of a body at a pose (x, y, angle) [m, m, rad]."""
    x, y, angle = pose
    return f"translate({number(x)} {number(y)}) rotate({number(np.degrees(angle), 4)})"


def body_shape(mechanism: Mechanism, take: Take, name: str) -> str:
    """What is drawn of a body, in its own frame."""
    size = mechanism.length_scale
    points: list[Point] = list(take.ends.get(name, ()))
    parts: list[str] = []
    for joint in mechanism.joints:
        for owner, attribute in ((joint.first, "first_point"), (joint.second, "second_point")):
            if owner != name or isinstance(joint, Roll) or not hasattr(joint, attribute):
                continue
            point = getattr(joint, attribute)
            if not (isinstance(joint, Slot) and owner == joint.first) and point not in points:
                points.append(point)
        if isinstance(joint, Skate) and joint.second == name:
            half = BLADE * size / 2 * np.array([np.cos(joint.angle), np.sin(joint.angle)])
            centre = np.array(joint.second_point)
            parts.append(f'<path class="blade" d="{path([centre - half, centre + half])}"/>')
            points.append((0.0, 0.0))
        if isinstance(joint, Roll):
            for owner, curve in ((joint.first, joint.rolling.ground), (joint.second, joint.rolling.body)):
                if owner == name:
                    arcs = np.linspace(0.0, curve.length, OUTLINE)
                    outline = curve.point(arcs)
                    parts.append(f'<path class="outline" d="{path(outline, closed=True)}"/>')
                    parts.append(f'<path class="spoke" d="{path([(0.0, 0.0), outline[0]])}"/>')
    for owner, curve in take.curves:
        if owner == name:
            parts.append(f'<path class="curve" d="{path(curve)}"/>')
    unique = sorted(dict.fromkeys(points))
    if len(unique) > 1:
        parts.append(f'<path class="bar" d="{path(unique)}"/>')
    elif len(unique) == 1 and np.hypot(*unique[0]) > 1e-9 * size:
        parts.append(f'<path class="bar" d="{path([unique[0], (0.0, 0.0)])}"/>')
    elif not parts:
        half = BLOCK * size
        corners = [(-half, -0.6 * half), (half, -0.6 * half), (half, 0.6 * half), (-half, 0.6 * half)]
        parts.append(f'<path class="outline" d="{path(corners, closed=True)}"/>')
    for point in pins_of(mechanism, name):
        parts.append(
            f'<circle class="pin" cx="{number(point[0])}" cy="{number(point[1])}" r="{number(0.018 * size)}"/>'
        )
    return "".join(parts)


def pins_of(mechanism: Mechanism, name: str) -> list[Point]:
    """The points of a body at which it is pinned [m]."""
    sides = [
        (owner, point)
        for joint in mechanism.joints
        if isinstance(joint, Pin)
        for owner, point in ((joint.first, joint.first_point), (joint.second, joint.second_point))
    ]
    return list(dict.fromkeys(point for owner, point in sides if owner == name))


def ground(mechanism: Mechanism, take: Take, pose: Array) -> str:
    """What does not move: supports, lines of slots, curves that are rolled on; `pose` (times, bodies, 3), the truth."""
    size, parts = mechanism.length_scale, []
    for joint in mechanism.joints:
        if isinstance(joint, Pin) and None in (joint.first, joint.second):
            x, y = joint.first_point if joint.first is None else joint.second_point
            half = 0.05 * size
            corners = [(x, y), (x - half, y - 1.6 * half), (x + half, y - 1.6 * half)]
            parts.append(f'<path class="support" d="{path(corners, closed=True)}"/>')
        if isinstance(joint, Slot) and joint.first is None:
            along = np.array([np.cos(joint.line_angle), np.sin(joint.line_angle)])
            origin = np.array(joint.first_point)
            reach = (pose[:, mechanism.body_index(str(joint.second)), :2] - origin) @ along
            ends = [origin + along * (reach.min() - 0.2 * size), origin + along * (reach.max() + 0.2 * size)]
            parts.append(f'<path class="rail" d="{path(ends)}"/>')
        if isinstance(joint, Roll) and joint.first is None:
            parts.append(f'<path class="rail" d="{path(rolled_on(joint, pose, mechanism))}"/>')
    for owner, curve in take.curves:
        if owner is None:
            parts.append(f'<path class="curve fixed" d="{path(curve)}"/>')
    return "".join(parts)


def rolled_on(joint: Roll, pose: Array, mechanism: Mechanism) -> Array:
    """The part of the ground's curve on which a body rolls (points, 2) [m], or all of a closed one."""
    curve = joint.rolling.ground
    low, high = curve.limits
    if np.isfinite(curve.length):
        return curve.point(np.linspace(max(low, 0.0), min(high, curve.length), OUTLINE))
    travelled = np.ptp(pose[:, mechanism.body_index(str(joint.second)), :2], axis=0).max()
    reach = travelled + joint.rolling.body.length / 2
    return curve.point(np.linspace(joint.rolling.ground_arc - reach, joint.rolling.ground_arc + reach, OUTLINE))


def point_path(pose: Array, point: Point) -> Array:
    """Where a point of a body is (times, 2) [m], for its poses (times, 3)."""
    cosine, sine = np.cos(pose[:, 2]), np.sin(pose[:, 2])
    x, y = point
    return pose[:, :2] + np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)


def box(mechanism: Mechanism, take: Take, pose: Array) -> tuple[float, float, float, float]:
    """Left, bottom, width and height [m] of what the truth passes through, with a margin."""
    corners = []
    for index, body in enumerate(mechanism.bodies):
        points: list[Point] = [(0.0, 0.0), *take.ends.get(body.name, ())]
        for joint in mechanism.joints:
            for owner, attribute in ((joint.first, "first_point"), (joint.second, "second_point")):
                if owner == body.name and hasattr(joint, attribute):
                    points.append(getattr(joint, attribute))
            if isinstance(joint, Roll):
                for owner, curve in ((joint.first, joint.rolling.ground), (joint.second, joint.rolling.body)):
                    if owner == body.name:
                        points += [tuple(each) for each in curve.point(np.linspace(0, curve.length, 24))]
        corners += [point_path(pose[:, index], point) for point in points]
    fixed = [
        joint.first_point if joint.first is None else joint.second_point
        for joint in mechanism.joints
        if isinstance(joint, Pin) and None in (joint.first, joint.second)
    ]
    fixed += [point for owner, curve in take.curves if owner is None for point in curve]
    everything = np.concatenate([*corners, np.array(fixed, dtype=float).reshape(-1, 2)])
    low, high = everything.min(axis=0), everything.max(axis=0)
    margin = 0.09 * float((high - low).max())
    width, height = high - low + 2 * margin
    least = 0.32 * width  # a picture that is a thin strip shows nothing
    lift = max(0.0, least - height) / 2
    return float(low[0] - margin), float(low[1] - margin - lift), float(width), float(max(height, least))
