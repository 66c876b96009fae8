"""The length and the time of a mechanism, which define tolerances and an engine's settings."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

from reference.elements import Place, Vector
from reference.forces import ForceElement
from reference.joints import Body, Joint
from reference.plane import components

# Distance of points on one body, relative to a radius of curvature, up to which it counts as a rounding error of a
# contact at the centre of mass.
ROUNDED = 1e-12


def length_scale(bodies: Sequence[Body], joints: Sequence[Joint], forces: Sequence[ForceElement] = ()) -> float:
    """The largest length [m] of a rod, or distance between two points of one body at which an element acts.

    The centre of mass is one of these points, and so is the point that defines a slot's line. A force along a slot's
    line acts at the slot's points instead of its own. If the points of each body coincide, the result is the largest
    length of a spring or radius of curvature of a rolling contact, or else 1.
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
    length: float,
    gravity: Vector,
    bodies: Sequence[Body],
    joints: Sequence[Joint],
    forces: Sequence[ForceElement] = (),
) -> float:
    """The time of one radian of the fastest motion that a description shows [s]; 1 if nothing moves or pulls.

    It is the inverse of the largest of: a body's rotation rate, a drive's rate, speed over length, the pendulum
    frequency sqrt(g / length), and the rate of the motion that each force alone would cause: a spring's frequency, a
    damper's rate of decay, and sqrt(a / length) for a constant acceleration a.
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
    """The points at which a force acts, in all positions: those of a slot for a force along its line."""
    guide = _guide(force, joints, bodies)
    return force.points if guide is None else guide.points


def _guide(force: ForceElement, joints: Sequence[Joint], bodies: Mapping[str, Body]) -> Joint | None:
    """The joint along whose line the force acts at all times; None if there is none."""
    if not force.acts_along_line:
        return None
    span = _span(force.points, bodies)
    return next((joint for joint in joints if joint.guides(force.points, span)), None)


def _span(places: tuple[Place, ...], bodies: Mapping[str, Body]) -> float:
    """The distance of two points at t = 0 [m]; 0 for fewer."""
    return math.dist(*(_to_world(*place, bodies) for place in places)) if len(places) == 2 else 0.0


def _to_world(name: str | None, point: Vector, bodies: Mapping[str, Body]) -> Vector:
    if name is None:
        return point
    x, y, angle = bodies[name].pose
    across, up = components(angle, *point)
    return float(x + across), float(y + up)


def diameter(points: Iterable[Vector]) -> float:
    """The largest distance between two points [m]; 0 for one."""
    return max((math.dist(first, second) for first, second in combinations(points, 2)), default=0.0)
