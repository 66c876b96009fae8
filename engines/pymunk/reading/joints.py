"""pymunk's bodies and constraints as ideal bodies, joints and force elements."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import inf, isinf
from typing import Any

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk.constraints import (
    Constraint,
    DampedRotarySpring,
    DampedSpring,
    GearJoint,
    GrooveJoint,
    PinJoint,
    PivotJoint,
    RotaryLimitJoint,
    SimpleMotor,
    SlideJoint,
)

from engines.pymunk.joints.slide import groove_is_exact
from engines.reading import MOST_BODIES, Names, Note, refuse
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Body, Drive, Gear, Joint, Pin, Rod, Slot, Vector

Array = NDArray[np.float64]
LIMITS = (SlideJoint, RotaryLimitJoint)
EQUALITY = "its min and max are equal, so it is taken as a {}; pymunk's {} holds from both sides at once"
SAME = 1e-12  # rad, or of a length: ends of a limit that differ by rounding
STILL = 0.0
# What each kind of constraint is read as; no other is read.
CONSTRAINTS: dict[type, str] = {
    PivotJoint: "a pin",
    GrooveJoint: "a slot",
    PinJoint: "a rod",
    GearJoint: "a gear, or a fixed angle",
    SimpleMotor: "a drive, also from rest",
    DampedSpring: "a spring and a damper",
    DampedRotarySpring: "a torsion spring and damper",
    SlideJoint: "nothing where it is not reached; a rod where min = max",
    RotaryLimitJoint: "nothing where it is not reached; a fixed angle where min = max",
}
READ_NAMES = [kind.__name__ for kind in CONSTRAINTS]
BODIES = {
    "dynamic body": "a body; with an infinite moment, one that turns steadily",
    "kinematic body": "a body that a drive turns about its place",
    "force or torque that stands on a body": "a constant one",
}


@dataclass(eq=False)
class Described:
    """A space while it is read. `moving`: the bodies of the mechanism, in its order; others are the ground."""

    space: pymunk.Space
    moving: list[pymunk.Body] = field(default_factory=list)
    words: dict[pymunk.Body, str] = field(default_factory=dict)
    bodies: list[Body] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    forces: list[ForceElement] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    names: Names = field(default_factory=Names)
    prescribed: list[str] = field(default_factory=list)  # joints that only say how a body moves
    pushed: dict[int, tuple[Vector, float]] = field(default_factory=dict)  # by place in `moving`: force and torque
    suspects: dict[str, str] = field(default_factory=dict)  # joints that are not ideal at any step, and why
    constraints: dict[Constraint, str] = field(default_factory=dict)

    def name(self, body: pymunk.Body) -> str | None:
        return self.words.get(body)

    def own(self, body: pymunk.Body, point: Vector) -> Vector:
        """A point of a pymunk body in our frame, from the centre of mass; of the ground, in the world."""
        if body in self.words:
            x, y = body.center_of_gravity
            return (float(point[0] - x), float(point[1] - y))
        place = body.local_to_world((point[0], point[1]))
        return (float(place.x), float(place.y))

    def anchors(self, constraint: Any) -> tuple[Vector, Vector]:
        """The anchors of both bodies in our frames."""
        return self.own(constraint.a, constraint.anchor_a), self.own(constraint.b, constraint.anchor_b)

    def angle(self, body: pymunk.Body) -> float:
        """0 on the ground, where lines and angles are those of the world."""
        return float(body.angle) if body in self.words else 0.0

    def standing(self, body: pymunk.Body) -> float:
        """The angle of a body of the ground in the world."""
        return 0.0 if body in self.words else float(body.angle)


def described(space: pymunk.Space) -> Described:
    """All of a space. Raises Unsupported for what has no ideal counterpart."""
    out = Described(space)
    if space.damping != 1:
        raise refuse("space.damping", f"it is {space.damping:g}: a drag against nothing has no ideal counterpart here")
    moves = [body for body in space.bodies if _moves(body)]
    if not moves:
        raise refuse("the space", "nothing in it can move")
    if len(moves) > MOST_BODIES:
        raise refuse("the space", f"it has {len(moves)} moving bodies; the judge takes up to {MOST_BODIES}")
    for number, body in enumerate(moves, start=1):
        out.moving.append(body)
        out.words[body] = out.names.new(str(getattr(body, "name", f"body {number}")))
    for body in moves:
        _add_body(out, body)
    counts: dict[str, int] = {}
    for constraint in space.constraints:
        kind = type(constraint).__name__
        counts[kind] = counts.get(kind, 0) + 1
        label = out.names.new(str(getattr(constraint, "name", f"{kind} {counts[kind]}")))
        out.constraints[constraint] = label
        _add_constraint(out, constraint, label)
    return out


def _moves(body: pymunk.Body) -> bool:
    if body.body_type == pymunk.Body.KINEMATIC:
        return bool(body.angular_velocity != STILL or tuple(body.velocity) != (STILL, STILL))
    return body.body_type == pymunk.Body.DYNAMIC


def _add_body(out: Described, body: pymunk.Body) -> None:
    name = out.words[body]
    if body.is_sleeping:
        raise refuse(name, "it is asleep at the start, where nothing moves it; call its activate() first")
    if getattr(body, "_velocity_func", None) or getattr(body, "_position_func", None):
        raise refuse(name, "it moves by a function of its own, which has no ideal counterpart")
    place = body.local_to_world(body.center_of_gravity)
    pose = (float(place.x), float(place.y), float(body.angle))
    if body.body_type == pymunk.Body.KINEMATIC:
        if body.velocity.length:
            raise refuse(name, "a kinematic body that travels has no ideal counterpart here; it may turn about a place")
        rate = float(body.angular_velocity)
        pose = (float(body.position.x), float(body.position.y), float(body.angle))
        out.bodies.append(Body(name, 1.0, 1.0, pose, (0.0, 0.0, rate)))  # of a known motion: any mass will do
        pin, drive = out.names.new(f"{name} stays"), out.names.new(f"{name} turns")
        out.joints += [Pin(pin, None, name, pose[:2], (0.0, 0.0)), Drive(drive, None, name, rate, pose[2])]
        out.prescribed += [pin, drive]
        return
    if body.force.length or body.torque:
        _add_push(out, body)
    if not 0 < body.mass < inf or not body.moment > 0:
        raise refuse(name, f"its mass is {body.mass:g} and its moment {body.moment:g}; both must be above zero")
    rate = float(body.angular_velocity)
    twist = (float(body.velocity.x), float(body.velocity.y), rate)
    if isinf(body.moment):
        out.bodies.append(Body(name, float(body.mass), 1.0, pose, twist))
        label = out.names.new(f"{name} turns steadily")
        out.joints.append(Drive(label, None, name, rate, pose[2]))
        out.prescribed.append(label)
    else:
        out.bodies.append(Body(name, float(body.mass), float(body.moment), pose, twist))


def _add_push(out: Described, body: pymunk.Body) -> None:
    """The force and the torque that stand on a body, as constant ones."""
    name, (x, y), torque = out.words[body], body.force, float(body.torque)
    if x or y:
        out.forces.append(Force(out.names.new(f"force on {name}"), name, (0.0, 0.0), (float(x), float(y))))
    if torque:
        out.forces.append(Torque(out.names.new(f"torque on {name}"), None, name, torque))
    out.pushed[out.moving.index(body)] = ((float(x), float(y)), torque)
    reason = "pymunk takes it off after one step; it is taken as set anew before every step, by a loop of yours"
    out.notes.append(Note(f"the force or torque that stands on {name}", reason))


def _add_constraint(out: Described, constraint: Constraint, label: str) -> None:
    a, b = constraint.a, constraint.b
    # A body that stands still need not be in the space.
    if any(_moves(body) and body.space is not out.space for body in (a, b)):
        raise refuse(label, "it holds a body that is not in the space; add the body too")
    first, second = out.name(a), out.name(b)
    if isinstance(constraint, LIMITS) and not is_equality(constraint):
        out.notes.append(Note(label, "its limit is left out, since it is not reached in the judged motion"))
        return
    if first == second:
        out.notes.append(Note(label, "it joins what stands still"))
        return
    if constraint.max_force != inf:
        raise refuse(label, f"its force is limited to {constraint.max_force:g}, which no ideal joint is")
    if getattr(constraint, "_pre_solve_func", None) or getattr(constraint, "_post_solve_func", None):
        raise refuse(label, "a function of its own runs before or after it is solved")
    if not isinstance(constraint, tuple(CONSTRAINTS)):
        kind = type(constraint).__name__
        raise refuse(label, f"a {kind} has no ideal counterpart here; read are {', '.join(READ_NAMES)}")
    match constraint:
        case PivotJoint():
            out.joints.append(Pin(label, first, second, *out.anchors(constraint)))
        case GrooveJoint():
            _add_slot(out, constraint, label)
        case PinJoint() | SlideJoint():
            _add_rod(out, constraint, label)
        case RotaryLimitJoint():
            turned = float(constraint.min) + out.standing(a) - out.standing(b)
            out.joints.append(Drive(label, first, second, 0.0, turned))
            out.notes.append(Note(label, EQUALITY.format("joint that holds the angle", "GearJoint")))
        case GearJoint():
            out.joints.append(_geared(out, constraint, label))
        case SimpleMotor():
            turned = out.angle(b) - out.angle(a)
            out.joints.append(Drive(label, first, second, -float(constraint.rate), turned))
        case DampedSpring() | DampedRotarySpring():
            _add_spring(out, constraint, label)


def _add_slot(out: Described, groove: GrooveJoint, label: str) -> None:
    a, b = groove.a, groove.b
    ends = [out.own(a, point) for point in (groove.groove_a, groove.groove_b)]
    line = pymunk.Vec2d(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
    if not line.length:
        raise refuse(label, "its groove has no length")
    point = out.own(b, groove.anchor_b)
    # The place of the anchor on the line now: an end of the groove may be far from all that moves.
    anchor = pymunk.Vec2d(*out.own(a, a.world_to_local(b.local_to_world(groove.anchor_b))))
    along = line.normalized() * (anchor - ends[0]).dot(line.normalized())
    at = (float(ends[0][0] + along.x), float(ends[0][1] + along.y))
    out.joints.append(Slot(label, out.name(a), out.name(b), at, float(line.angle), point))
    if _turns(a) or not groove_is_exact(point, _turns(b)):
        out.suspects[label] = (
            "pymunk's GrooveJoint does not push straight across its groove, at any step, unless its anchor is "
            "a centre of mass and the groove is in a body that can't turn freely; slide a body of its own in "
            "the groove, by its centre, and pin the other body to it"
        )


def _add_rod(out: Described, constraint: PinJoint | SlideJoint, label: str) -> None:
    slides = isinstance(constraint, SlideJoint)
    length = float(constraint.min if slides else constraint.distance)
    if not length:
        words = "its min and max are zero" if slides else "its distance is zero"
        raise refuse(label, f"{words}, which has no direction; give a PivotJoint")
    ends = out.name(constraint.a), out.name(constraint.b), *out.anchors(constraint)
    out.joints.append(Rod(label, *ends, length))
    if slides:
        out.notes.append(Note(label, EQUALITY.format("rod", "PinJoint")))


def _add_spring(out: Described, spring: Any, label: str) -> None:
    straight = isinstance(spring, DampedSpring)
    if getattr(spring, "_force_func" if straight else "_torque_func", None):
        raise refuse(label, "its force is a function of its own")
    first, second = out.name(spring.a), out.name(spring.b)
    # Chipmunk's relative angle is that of the first body against the second.
    ends: tuple[Any, ...] = (first, second, *out.anchors(spring)) if straight else (second, first)
    elastic: Any = Spring if straight else TorsionSpring
    viscous: Any = Damper if straight else TorsionDamper
    rest = spring.rest_length if straight else spring.rest_angle + out.standing(spring.b) - out.standing(spring.a)
    if spring.stiffness:
        out.forces.append(elastic(label, *ends, float(spring.stiffness), float(rest)))
    if spring.damping:
        out.forces.append(viscous(out.names.new(f"{label} damper"), *ends, float(spring.damping)))


def is_equality(constraint: Constraint) -> bool:
    """Whether it is a limit whose two ends are one, which holds as a joint does."""
    return isinstance(constraint, LIMITS) and constraint.max - constraint.min <= SAME * max(1.0, abs(constraint.max))


def both_sided(limit: Any) -> Constraint:
    """The joint of pymunk's that an `is_equality` limit stands for."""
    if isinstance(limit, SlideJoint):
        rod = PinJoint(limit.a, limit.b, limit.anchor_a, limit.anchor_b)
        rod.distance = limit.min
        return rod
    return GearJoint(limit.a, limit.b, limit.min, 1.0)


def _turns(body: pymunk.Body) -> bool:
    """Whether an impulse can turn it."""
    return body.body_type == pymunk.Body.DYNAMIC and not isinf(body.moment)


def _geared(out: Described, gear: GearJoint, label: str) -> Joint:
    """angle of a = ratio times angle of b - phase (preStep in Chipmunk's cpGearJoint.c)."""
    ratio, a, b = float(gear.ratio), out.name(gear.a), out.name(gear.b)
    if not ratio:
        raise refuse(label, "its ratio is zero")
    phase = -float(gear.phase) + ratio * out.standing(gear.b) - out.standing(gear.a)
    if b is None:
        return Drive(label, None, a, 0.0, phase)
    if a is None:
        return Drive(label, None, b, 0.0, -phase / ratio)
    return Gear(label, b, a, ratio, phase)


def copied(described: Described) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A copy of the space, and its bodies in the mechanism's order."""
    given, space = described.space, described.space.copy()
    # No body falls asleep in what is judged (`sleepers`), and pymunk (7.3.1) aborts after some copies in which
    # bodies do.
    space.sleep_time_threshold = inf
    copies = dict(zip(given.bodies, space.bodies, strict=True))
    for own, mine in copies.items():
        if own.center_of_gravity.length:
            # pymunk (7.3.1) places a copy before it knows where the centre of mass is, and so elsewhere.
            mine.angle, mine.position = own.angle, own.position
    for mine, own in zip(space.constraints, given.constraints, strict=True):
        if isinstance(own, PinJoint):
            mine.distance = own.distance  # a copy of pymunk (7.3.1) takes the distance at which its bodies are
    return space, [copies[body] for body in described.moving]


def moved_to(described: Described, pose: Array) -> pymunk.Space:
    """A copy of the space with the centres of mass and angles of the moving bodies at a pose (bodies, 3)."""
    space, bodies = copied(described)
    place(bodies, pose)
    return space


def place(bodies: Sequence[pymunk.Body], pose: Array) -> None:
    """Put centres of mass and angles at a pose (bodies, 3)."""
    for body, (x, y, angle) in zip(bodies, pose.tolist(), strict=True):
        body.angle = angle
        body.position = pymunk.Vec2d(x, y) - body.center_of_gravity.rotated(angle)
