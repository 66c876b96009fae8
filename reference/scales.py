"""The length and the time of a mechanism, which define tolerances and an engine's settings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

from reference.elements import Place, Vector
from reference.forces import ForceElement
from reference.joints import Body, Joint
from reference.plane import components

# Distances on a body below this fraction of a radius of curvature count as rounding errors.
ROUNDED = 1e-12


def length_scale(bodies: Sequence[Body], joints: Sequence[Joint], forces: Sequence[ForceElement] = ()) -> float:
    """The mechanism's length [m]: the largest of the rods' lengths and the distances between points of one body.

    The points are the centre of mass, the points at which joints and forces act, and the point that defines a slot's
    line. A force along a slot's line counts with the slot's points. If the points of each body coincide, the result is
    the largest spring length or radius of curvature of a rolling contact, else 1.
    """
    by_name = {body.name: body for body in bodies}
    points: dict[str, set[Vector]] = {body.name: {(0.0, 0.0)} for body in bodies}
    places = [place for joint in joints for place in joint.points]
    places += [place for force in forces for place in _acting_points(force, joints, by_name)]
    for name, point in places:
        if name is not None:
            points[name].add(point)
    fallback = [length for joint in joints for length in joint.fallback_lengths]
    largest = max(
        (*map(diameter, points.values()), *(length for joint in joints for length in joint.lengths)), default=0.0
    )
    if largest <= ROUNDED * max(fallback, default=0.0):
        fallback += [
            force.fallback_length(_span(force.points, by_name), _guide(force, joints, by_name) is not None)
            for force in forces
        ]
        return max(fallback, default=0.0) or 1.0
    return largest


def time_scale(
    length: float, gravity: Vector, bodies: Sequence[Body], joints: Sequence[Joint], forces: Sequence[ForceElement] = ()
) -> float:
    """The time of one radian of the mechanism's fastest motion [s], or 1 for a mechanism at rest without forces.

    The fastest motion has the largest of these rates: rotation rates of bodies and drives, speed over length, the
    pendulum frequency sqrt(g / length), and the rates under single forces. The rate under a force is a spring's
    frequency, a damper's decay rate, or sqrt(a / length) for an acceleration a.
    """
    by_name = {body.name: body for body in bodies}
    rates = [math.sqrt(math.hypot(*gravity) / length)]
    rates += [abs(body.twist[2]) for body in bodies]
    rates += [math.hypot(*body.twist[:2]) / length for body in bodies]
    rates += [
        abs(rate) / (1.0 if is_angular else length)
        for joint in joints
        for rate, is_angular in zip(joint.rate, joint.is_angular, strict=True)
    ]
    rates += [force.fastest_rate(_acting_points(force, joints, by_name), by_name, length) for force in forces]
    return 1 / max(rates) if max(rates) > 0 else 1.0


def _acting_points(force: ForceElement, joints: Sequence[Joint], bodies: Mapping[str, Body]) -> tuple[Place, ...]:
    """The points at which a force acts in all positions, which are the slot's points for a force along a slot."""
    guide = _guide(force, joints, bodies)
    return force.points if guide is None else guide.points


def _guide(force: ForceElement, joints: Sequence[Joint], bodies: Mapping[str, Body]) -> Joint | None:
    """The joint along whose line the force acts at all times, or None without such a joint."""
    if not force.acts_along_line:
        return None
    span = _span(force.points, bodies)
    return next((joint for joint in joints if joint.guides(force.points, span)), None)


def _span(places: tuple[Place, ...], bodies: Mapping[str, Body]) -> float:
    return math.dist(*(_to_world(*place, bodies) for place in places)) if len(places) == 2 else 0.0


def _to_world(name: str | None, point: Vector, bodies: Mapping[str, Body]) -> Vector:
    if name is None:
        return point
    x, y, angle = bodies[name].pose
    across, up = components(angle, *point)
    return float(x + across), float(y + up)


def diameter(points: Iterable[Vector]) -> float:
    """The largest distance between two points [m], or 0 for one point."""
    return max((math.dist(first, second) for first, second in combinations(points, 2)), default=0.0)
