"""The length and the time of a mechanism, by which tolerances and an engine's settings are measured."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations
from typing import assert_never

from reference.couplings import Coupling
from reference.forces import CoupledForce, Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Body, Drive, Joint, Rod, Roll, Slot, Vector
from reference.plane import components

ROUNDED = 1e-12  # of a curve's radius: less than that is what rounding makes of a contact at a centre of mass
ON_LINE = 1e-9  # of the distance between the ends of a spring: how far off a slot's line rounding may place an end


def length_scale(bodies: Sequence[Body], joints: Sequence[Joint], forces: Sequence[ForceElement] = ()) -> float:
    """The largest of rods and of distances between two points of one body at which something is joined or pulls [m].

    The centre of mass is one of these points, and so is the point by which a slot's line is described. A force along
    that line acts at the slot's points, wherever on the line its own end stands. Where all points are one, the largest
    length of a spring or radius of curvature where something rolls; or 1.
    """
    points: dict[str, set[Vector]] = {body.name: {(0.0, 0.0)} for body in bodies}
    own = {body.name: body for body in bodies}
    slots = [joint for joint in joints if isinstance(joint, Slot)]
    for member in (*joints, *forces):
        for name, point in _ends(member, slots, own):
            if name is not None:
                points[name].add(point)
    rods = [joint.length for joint in joints if isinstance(joint, Rod)]
    rests = [_spring_length(force, slots, own) for force in forces if isinstance(force, Spring)]
    rolls = [joint.rolling for joint in joints if isinstance(joint, Roll)]
    bent = [
        abs(float(curve.curvature(arc)))
        for rolling in rolls
        for curve, arc in ((rolling.ground, rolling.ground_arc), (rolling.body, rolling.body_arc))
    ]
    radii = [1 / each for each in bent if each]
    radii += [pitch for joint in joints if isinstance(joint, Coupling) for pitch in _pitches(joint)]
    largest = max((*map(diameter, points.values()), *rods), default=0.0)
    if largest <= ROUNDED * max(radii, default=0.0):
        return max((*rests, *radii), default=0.0) or 1.0
    return largest


def _pitches(coupling: Coupling) -> list[float]:
    """How far its first slide goes in a radian of each of its angles [m]: the radius of a pinion."""
    slide = next((abs(term.factor) for term in coupling.terms if term.sliding and term.factor), None)
    return [abs(term.factor) / slide for term in coupling.terms if not term.sliding and term.factor] if slide else []


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
    own, slots = {body.name: body for body in bodies}, [joint for joint in joints if isinstance(joint, Slot)]
    rates += [_rate(force, length, own, slots) for force in forces]
    return 1 / max(rates) if max(rates) > 0 else 1.0


def _rate(force: ForceElement, length: float, bodies: Mapping[str, Body], slots: Sequence[Slot]) -> float:
    """How fast a force alone would move its bodies [1/s]."""
    ends = [(bodies[name], point) for name, point in _ends(force, slots, bodies) if name is not None]
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
        case CoupledForce():
            felt = sum(
                term.factor**2 * (1 / bodies[name].mass if term.sliding else 1 / bodies[name].inertia)
                for term in force.terms
                for name in (term.first, term.second)
                if name is not None
            )
            unit = length if force.terms[0].sliding else 1.0
            return max(math.sqrt(max(force.stiffness, abs(force.force) / unit) * felt), force.damping * felt)
        case _:
            assert_never(force)


def _ends(
    member: Joint | ForceElement, slots: Sequence[Slot], bodies: Mapping[str, Body]
) -> tuple[tuple[str | None, Vector], tuple[str | None, Vector]]:
    """The two bodies and the points where a joint holds or a force acts; the centre of mass for one without a point."""
    member = _slot_along(member, slots, bodies) or member
    first, second = getattr(member, "first_point", (0.0, 0.0)), getattr(member, "second_point", (0.0, 0.0))
    return (member.first, first), (member.second, second)


def _slot_along(member: Joint | ForceElement, slots: Sequence[Slot], bodies: Mapping[str, Body]) -> Slot | None:
    """The slot along whose line a spring or damper acts in all positions: between the same bodies, one end at the
    second body's point and the other anywhere on the line in the first body.
    """
    if not isinstance(member, Spring | Damper):
        return None
    ends = [(member.first, member.first_point), (member.second, member.second_point)]
    span = math.dist(*(_to_world(name, point, bodies) for name, point in ends))
    for slot in slots:
        for (name, point), (other, held) in (ends, ends[::-1]):
            if (name, other) == (slot.first, slot.second) and math.dist(held, slot.second_point) <= ON_LINE * span:
                x, y = point[0] - slot.first_point[0], point[1] - slot.first_point[1]
                if abs(math.cos(slot.line_angle) * y - math.sin(slot.line_angle) * x) <= ON_LINE * span:
                    return slot
    return None


def _spring_length(spring: Spring, slots: Sequence[Slot], bodies: Mapping[str, Body]) -> float:
    """The rest length [m]; the length at t = 0 if that is zero; the extension at t = 0 of a spring along a slot."""
    length = math.dist(
        _to_world(spring.first, spring.first_point, bodies), _to_world(spring.second, spring.second_point, bodies)
    )
    if _slot_along(spring, slots, bodies) is None:
        return spring.rest_length or length
    extension = abs(length - spring.rest_length)
    return extension if extension > ROUNDED * length else 0.0


def _to_world(name: str | None, point: Vector, bodies: Mapping[str, Body]) -> Vector:
    if name is None:
        return point
    x, y, angle = bodies[name].pose
    across, up = components(angle, *point)
    return float(x + across), float(y + up)


def diameter(points: Iterable[Vector]) -> float:
    """The largest distance between two points [m]; 0 for one."""
    return max((math.dist(first, second) for first, second in combinations(points, 2)), default=0.0)
