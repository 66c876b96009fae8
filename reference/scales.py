"""The length and the time of a mechanism, by which tolerances and an engine's settings are measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence

from reference.body import Body
from reference.joints import Drive, Joint, Vector


def length_scale(bodies: Sequence[Body], joints: Sequence[Joint]) -> float:
    """The largest distance between two joint points of one body, or of one and the centre of mass [m]; or 1."""
    points: dict[str, set[Vector]] = {body.name: {(0.0, 0.0)} for body in bodies}
    for joint in joints:
        for name, point in ((joint.first, "first_point"), (joint.second, "second_point")):
            if name is not None and hasattr(joint, point):
                points[name].add(getattr(joint, point))
    return max((diameter(own) for own in points.values()), default=0.0) or 1.0


def time_scale(length: float, gravity: Vector, bodies: Sequence[Body], joints: Sequence[Joint]) -> float:
    """One radian of the fastest motion that a description promises [s]; 1 when nothing moves or pulls.

    The inverse of the largest of: a body's rotation rate, a drive's rate, speed over length, and the pendulum
    frequency sqrt(g / length).
    """
    rates = [math.sqrt(math.hypot(*gravity) / length)]
    rates += [abs(body.twist[2]) for body in bodies]
    rates += [math.hypot(*body.twist[:2]) / length for body in bodies]
    rates += [abs(joint.turning_rate) for joint in joints if isinstance(joint, Drive)]
    return 1 / max(rates) if max(rates) > 0 else 1.0


def diameter(points: Iterable[Vector]) -> float:
    """The largest distance between two points, in O(n log n): only opposite corners of the convex hull are compared.

    The opposite corner moves on as one goes round the hull (rotating calipers, Shamos 1978). Its neighbour is compared
    too: where sides are parallel up to rounding, either of the two may be found to be the opposite one.
    """
    hull = convex_hull(points)
    count, opposite, largest = len(hull), 1 % len(hull), 0.0
    for index in range(count):
        corner, following = hull[index], hull[(index + 1) % count]
        while _area(corner, following, hull[(opposite + 1) % count]) > _area(corner, following, hull[opposite]):
            opposite = (opposite + 1) % count
        for other in (hull[opposite], hull[(opposite + 1) % count]):
            largest = max(largest, math.dist(corner, other), math.dist(following, other))
    return largest


def convex_hull(points: Iterable[Vector]) -> list[Vector]:
    """The corners of the convex hull of one point or more, counter-clockwise, none on a side between two others."""
    ordered = sorted(set(points))
    if len(ordered) == 1:
        return ordered
    hull: list[Vector] = []
    for way in (ordered, ordered[::-1]):  # the lower side, then the upper one (Andrew 1979)
        side: list[Vector] = []
        for point in way:
            while len(side) > 1 and _area(side[-2], side[-1], point) <= 0:
                side.pop()
            side.append(point)
        hull += side[:-1]
    return hull


def _area(first: Vector, second: Vector, third: Vector) -> float:
    """Twice the area of a triangle, positive if it is counter-clockwise."""
    return (second[0] - first[0]) * (third[1] - first[1]) - (second[1] - first[1]) * (third[0] - first[0])
