"""The length and the time of a mechanism, by which tolerances and an engine's settings are measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import assert_never

from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Body, Drive, Joint, Rod, Roll, Vector

ROUNDED = 1e-12  # of a curve's radius: less than that is what rounding makes of a contact at a centre of mass


def length_scale(bodies: Sequence[Body], joints: Sequence[Joint], forces: Sequence[ForceElement] = ()) -> float:
    """The largest of rods and of distances between two points of one body at which something is joined or pulls [m].

    The centre of mass is one of these points. Where all of them are one, the largest rest length or radius of curvature
    where something rolls; or 1.
    """
    points: dict[str, set[Vector]] = {body.name: {(0.0, 0.0)} for body in bodies}
    for joint in (*joints, *forces):
        for name, point in ((joint.first, "first_point"), (joint.second, "second_point")):
            if name is not None and hasattr(joint, point):
                points[name].add(getattr(joint, point))
    rods = [joint.length for joint in joints if isinstance(joint, Rod)]
    rests = [force.rest_length for force in forces if isinstance(force, Spring)]
    rolls = [joint.rolling for joint in joints if isinstance(joint, Roll)]
    bent = [
        abs(float(curve.curvature(arc)))
        for rolling in rolls
        for curve, arc in ((rolling.ground, rolling.ground_arc), (rolling.body, rolling.body_arc))
    ]
    radii = [1 / each for each in bent if each]
    largest = max((*map(diameter, points.values()), *rods), default=0.0)
    if largest <= ROUNDED * max(radii, default=0.0):
        return max((*rests, *radii), default=0.0) or 1.0
    return largest


def time_scale(
    length: float,
    gravity: Vector,
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    forces: Sequence[ForceElement] = (),
) -> float:
    """One radian of the fastest motion that a description promises [s]; 1 when nothing moves or pulls.

    The inverse of the largest of: a body's rotation rate, a drive's rate, speed over length, the pendulum frequency
    sqrt(g / length), and what each force alone would do to its bodies: a spring's frequency, a damper's rate of decay,
    and a constant acceleration's sqrt(a / length).
    """
    rates = [math.sqrt(math.hypot(*gravity) / length)]
    rates += [abs(body.twist[2]) for body in bodies]
    rates += [math.hypot(*body.twist[:2]) / length for body in bodies]
    rates += [abs(joint.turning_rate) for joint in joints if isinstance(joint, Drive)]
    own = {body.name: body for body in bodies}
    rates += [_rate(force, length, own) for force in forces]
    return 1 / max(rates) if max(rates) > 0 else 1.0


def _rate(force: ForceElement, length: float, bodies: Mapping[str, Body]) -> float:
    """How fast a force alone would move its bodies [1/s]."""
    ends = [(bodies[name], point) for name, point in _ends(force) if name is not None]
    # The inverse of the mass that a force at a point feels, at most, and of the inertia that a torque feels.
    light = sum(1 / body.mass + (x * x + y * y) / body.inertia for body, (x, y) in ends)
    turning = sum(1 / body.inertia for body, _ in ends)
    match force:
        case Spring():
            return math.sqrt(force.stiffness * light)
        case TorsionSpring():
            return math.sqrt(force.stiffness * turning)
        case Damper():
            return force.damping * light
        case TorsionDamper():
            return force.damping * turning
        case Torque():
            return math.sqrt(abs(force.torque) * turning)
        case Force():
            return math.sqrt(math.hypot(*force.force) * light / length)
        case _:
            assert_never(force)


def _ends(force: ForceElement) -> tuple[tuple[str | None, Vector], tuple[str | None, Vector]]:
    """The bodies between which a force acts, and where; a torque acts anywhere."""
    first, second = getattr(force, "first_point", (0.0, 0.0)), getattr(force, "second_point", (0.0, 0.0))
    return (force.first, first), (force.second, second)


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
