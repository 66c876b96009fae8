"""Read the bodies and constraints of a pymunk space as ideal bodies, joints and force elements."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import inf, isinf
from typing import Any, NamedTuple

import numpy as np
import pymunk
from numpy.typing import NDArray
from pymunk import constraints

from engines.pymunk.joints.slide import groove_is_exact
from engines.pymunk.model import can_turn
from engines.reading import MOST_BODIES, Names, Note, refuse
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Body, Drive, Gear, Joint, Pin, Rod, Slot, Vector

Array = NDArray[np.float64]
LIMIT_JOINTS = (constraints.SlideJoint, constraints.RotaryLimitJoint)
EQUALITY = "its min and max are equal, so it is read as a {}; pymunk's {} is the joint for this"
# Largest difference [rad, m] between equal ends of a limit, relative for lengths above 1 m.
EQUAL_ENDS = 1e-12
READ_BODIES = {
    "dynamic body": "a body; with an infinite moment, one that turns steadily",
    "kinematic body": "a body that a drive turns about its place",
    "force or torque that stands on a body": "a constant one",
}


@dataclass(eq=False)
class ImportedSpace:
    """A space and the elements of its mechanism; bodies that are not in `moving` belong to the ground."""

    space: pymunk.Space
    moving: list[pymunk.Body] = field(default_factory=list)  # in the order of the mechanism
    body_names: dict[pymunk.Body, str] = field(default_factory=dict)
    bodies: list[Body] = field(default_factory=list)
    joints: list[Joint] = field(default_factory=list)
    forces: list[ForceElement] = field(default_factory=list)
    notes: list[Note] = field(default_factory=list)
    names: Names = field(default_factory=Names)
    prescribed: list[str] = field(default_factory=list)  # Names of the joints of prescribed motions.
    pushed: dict[int, tuple[Vector, float]] = field(default_factory=dict)  # Forces and torques by index in `moving`.
    suspects: dict[str, str] = field(default_factory=dict)  # Reasons by joint why the joint is not ideal at any step.
    labels: dict[constraints.Constraint, str] = field(default_factory=dict)

    def name_of(self, body: pymunk.Body) -> str | None:
        return self.body_names.get(body)

    def local(self, body: pymunk.Body, point: Vector) -> Vector:
        """A point [m] of a pymunk body relative to the centre of mass; for the ground, the point in the world."""
        if body in self.body_names:
            x, y = body.center_of_gravity
            return (float(point[0] - x), float(point[1] - y))
        world = body.local_to_world((point[0], point[1]))
        return (float(world.x), float(world.y))

    def ends(self, constraint: Any) -> tuple[str | None, str | None, Vector, Vector]:
        a, b = constraint.a, constraint.b
        anchors = self.local(a, constraint.anchor_a), self.local(b, constraint.anchor_b)
        return self.name_of(a), self.name_of(b), *anchors

    def angle(self, body: pymunk.Body) -> float:
        return float(body.angle) if body in self.body_names else 0.0

    def ground_angle(self, body: pymunk.Body) -> float:
        """The angle [rad] of a body that belongs to the ground; 0 for other bodies."""
        return 0.0 if body in self.body_names else float(body.angle)


def import_space(space: pymunk.Space) -> ImportedSpace:
    out = ImportedSpace(space)
    if space.damping != 1:
        raise refuse("space.damping", f"it is {space.damping:g}: this drag has no ideal counterpart here")
    moving = [body for body in space.bodies if _moves(body)]
    if not moving:
        raise refuse("the space", "nothing in it can move")
    if len(moving) > MOST_BODIES:
        raise refuse("the space", f"it has {len(moving)} moving bodies; the judge takes up to {MOST_BODIES}")
    for number, body in enumerate(moving, start=1):
        out.moving.append(body)
        out.body_names[body] = out.names.new(str(getattr(body, "name", f"body {number}")))
    for body in moving:
        _add_body(out, body)
    counts: dict[str, int] = {}
    for constraint in space.constraints:
        kind = type(constraint).__name__
        counts[kind] = counts.get(kind, 0) + 1
        label = out.names.new(str(getattr(constraint, "name", f"{kind} {counts[kind]}")))
        out.labels[constraint] = label
        _add_constraint(out, constraint, label)
    return out


def _moves(body: pymunk.Body) -> bool:
    if body.body_type == pymunk.Body.KINEMATIC:
        return bool(body.angular_velocity != 0 or tuple(body.velocity) != (0, 0))
    return body.body_type == pymunk.Body.DYNAMIC


def _add_body(out: ImportedSpace, body: pymunk.Body) -> None:
    name = out.body_names[body]
    if body.is_sleeping:
        raise refuse(name, "it is asleep at the start, where nothing moves it; call its activate() first")
    if getattr(body, "_velocity_func", None) or getattr(body, "_position_func", None):
        raise refuse(name, "it moves by a function of its own, which has no ideal counterpart")
    centre = body.local_to_world(body.center_of_gravity)
    pose = (float(centre.x), float(centre.y), float(body.angle))
    rate = float(body.angular_velocity)
    if body.body_type == pymunk.Body.KINEMATIC:
        if body.velocity.length:
            raise refuse(name, "a kinematic body that travels has no ideal counterpart here; it may turn about a place")
        pose = (float(body.position.x), float(body.position.y), float(body.angle))
        out.bodies.append(Body(name, 1.0, 1.0, pose, (0.0, 0.0, rate)))  # the mass has no effect
        pin, drive = out.names.new(f"{name} stays"), out.names.new(f"{name} turns")
        out.joints += [Pin(pin, None, name, pose[:2], (0.0, 0.0)), Drive(drive, None, name, rate, pose[2])]
        out.prescribed += [pin, drive]
        return
    if body.force.length or body.torque:
        _add_push(out, body)
    if not 0 < body.mass < inf or not body.moment > 0:
        raise refuse(name, f"its mass is {body.mass:g} and its moment {body.moment:g}; both must be above zero")
    inertia = 1.0 if isinf(body.moment) else float(body.moment)
    out.bodies.append(
        Body(name, float(body.mass), inertia, pose, (float(body.velocity.x), float(body.velocity.y), rate))
    )
    if isinf(body.moment):
        label = out.names.new(f"{name} turns steadily")
        out.joints.append(Drive(label, None, name, rate, pose[2]))
        out.prescribed.append(label)


def _add_push(out: ImportedSpace, body: pymunk.Body) -> None:
    name, (x, y), torque = out.body_names[body], body.force, float(body.torque)
    if x or y:
        out.forces.append(Force(out.names.new(f"force on {name}"), name, (0.0, 0.0), (float(x), float(y))))
    if torque:
        out.forces.append(Torque(out.names.new(f"torque on {name}"), None, name, torque))
    out.pushed[out.moving.index(body)] = ((float(x), float(y)), torque)
    reason = "pymunk resets it in every step; it is assumed that your loop sets it again before every step"
    out.notes.append(Note(f"the force or torque that stands on {name}", reason))


def _add_constraint(out: ImportedSpace, constraint: constraints.Constraint, label: str) -> None:
    a, b = constraint.a, constraint.b
    # A body that belongs to the ground need not be in the space.
    if any(_moves(body) and body.space is not out.space for body in (a, b)):
        raise refuse(label, "it holds a body that is not in the space; add the body too")
    if isinstance(constraint, LIMIT_JOINTS) and not is_equality(constraint):
        out.notes.append(Note(label, "its limit is left out, since it is not reached in the judged motion"))
        return
    if out.name_of(a) == out.name_of(b):
        out.notes.append(Note(label, "it joins two bodies that do not move relative to each other"))
        return
    if constraint.max_force != inf:
        raise refuse(label, f"its force is limited to {constraint.max_force:g}, but an ideal joint has no limit")
    if getattr(constraint, "_pre_solve_func", None) or getattr(constraint, "_post_solve_func", None):
        raise refuse(label, "a function of its own runs before or after it is solved")
    add = next((entry.add for kind, entry in READ_CONSTRAINTS.items() if isinstance(constraint, kind)), None)
    if add is None:
        names = ", ".join(kind.__name__ for kind in READ_CONSTRAINTS)
        raise refuse(label, f"a {type(constraint).__name__} has no ideal counterpart here; read are {names}")
    add(out, constraint, label)


def _add_slot(out: ImportedSpace, groove: constraints.GrooveJoint, label: str) -> None:
    a, b = groove.a, groove.b
    ends = [out.local(a, point) for point in (groove.groove_a, groove.groove_b)]
    line = pymunk.Vec2d(ends[1][0] - ends[0][0], ends[1][1] - ends[0][1])
    if not line.length:
        raise refuse(label, "its groove has no length")
    point = out.local(b, groove.anchor_b)
    # The slot's point on the line is the projection of the anchor, since the ends of the groove may be far away.
    anchor = pymunk.Vec2d(*out.local(a, a.world_to_local(b.local_to_world(groove.anchor_b))))
    along = line.normalized() * (anchor - ends[0]).dot(line.normalized())
    on_line = (float(ends[0][0] + along.x), float(ends[0][1] + along.y))
    out.joints.append(Slot(label, out.name_of(a), out.name_of(b), on_line, float(line.angle), point))
    if can_turn(a) or not groove_is_exact(point, can_turn(b)):
        out.suspects[label] = (
            "pymunk's GrooveJoint does not push straight across its groove, at any step, unless its anchor is "
            "a centre of mass and the groove is in a body that can't turn freely; slide a body of its own in "
            "the groove, by its centre, and pin the other body to it"
        )


def _add_rod(out: ImportedSpace, constraint: constraints.PinJoint | constraints.SlideJoint, label: str) -> None:
    slides = isinstance(constraint, constraints.SlideJoint)
    length = float(constraint.min if slides else constraint.distance)
    if not length:
        zero = "its min and max are zero" if slides else "its distance is zero"
        raise refuse(label, f"{zero}, which has no direction; give a PivotJoint")
    out.joints.append(Rod(label, *out.ends(constraint), length))
    if slides:
        out.notes.append(Note(label, EQUALITY.format("rod", "PinJoint")))


def _add_fixed_angle(out: ImportedSpace, limit: constraints.RotaryLimitJoint, label: str) -> None:
    angle = float(limit.min) + out.ground_angle(limit.a) - out.ground_angle(limit.b)
    out.joints.append(Drive(label, out.name_of(limit.a), out.name_of(limit.b), 0.0, angle))
    out.notes.append(Note(label, EQUALITY.format("joint that holds the angle", "GearJoint")))


def _add_drive(out: ImportedSpace, motor: constraints.SimpleMotor, label: str) -> None:
    angle = out.angle(motor.b) - out.angle(motor.a)
    out.joints.append(Drive(label, out.name_of(motor.a), out.name_of(motor.b), -float(motor.rate), angle))


def _add_gear(out: ImportedSpace, gear: constraints.GearJoint, label: str) -> None:
    # In Chipmunk angle_a = ratio angle_b - phase (preStep in cpGearJoint.c).
    ratio, a, b = float(gear.ratio), out.name_of(gear.a), out.name_of(gear.b)
    if not ratio:
        raise refuse(label, "its ratio is zero")
    phase = -float(gear.phase) + ratio * out.ground_angle(gear.b) - out.ground_angle(gear.a)
    if a is None or b is None:
        out.joints.append(Drive(label, None, a or b, 0.0, phase if b is None else -phase / ratio))
    else:
        out.joints.append(Gear(label, b, a, ratio, phase))


def _add_spring(out: ImportedSpace, spring: constraints.DampedSpring, label: str) -> None:
    if getattr(spring, "_force_func", None):
        raise refuse(label, "its force is a function of its own")
    _add_elastic_and_viscous(out, spring, label, out.ends(spring), (Spring, Damper), spring.rest_length)


def _add_torsion_spring(out: ImportedSpace, spring: constraints.DampedRotarySpring, label: str) -> None:
    if getattr(spring, "_torque_func", None):
        raise refuse(label, "its force is a function of its own")
    # In Chipmunk the relative angle is first angle - second angle.
    ends = out.name_of(spring.b), out.name_of(spring.a)
    rest_angle = spring.rest_angle + out.ground_angle(spring.b) - out.ground_angle(spring.a)
    _add_elastic_and_viscous(out, spring, label, ends, (TorsionSpring, TorsionDamper), rest_angle)


def _add_elastic_and_viscous(
    out: ImportedSpace, spring: Any, label: str, ends: tuple[Any, ...], kinds: tuple[Any, Any], rest: float
) -> None:
    elastic, viscous = kinds
    if spring.stiffness:
        out.forces.append(elastic(label, *ends, float(spring.stiffness), float(rest)))
    if spring.damping:
        out.forces.append(viscous(out.names.new(f"{label} damper"), *ends, float(spring.damping)))


class ConstraintEntry(NamedTuple):
    read_as: str
    add: Callable[[ImportedSpace, Any, str], None]


# Ideal counterparts of constraints. Other kinds of constraints are refused.
READ_CONSTRAINTS: Mapping[type[constraints.Constraint], ConstraintEntry] = {
    constraints.PivotJoint: ConstraintEntry(
        "a pin", lambda out, pivot, label: out.joints.append(Pin(label, *out.ends(pivot)))
    ),
    constraints.GrooveJoint: ConstraintEntry("a slot", _add_slot),
    constraints.PinJoint: ConstraintEntry("a rod", _add_rod),
    constraints.GearJoint: ConstraintEntry("a gear, or a fixed angle", _add_gear),
    constraints.SimpleMotor: ConstraintEntry("a drive, also from rest", _add_drive),
    constraints.DampedSpring: ConstraintEntry("a spring and a damper", _add_spring),
    constraints.DampedRotarySpring: ConstraintEntry("a torsion spring and damper", _add_torsion_spring),
    constraints.SlideJoint: ConstraintEntry("nothing where it is not reached; a rod where min = max", _add_rod),
    constraints.RotaryLimitJoint: ConstraintEntry(
        "nothing where it is not reached; a fixed angle where min = max", _add_fixed_angle
    ),
}


def is_equality(constraint: constraints.Constraint) -> bool:
    if not isinstance(constraint, LIMIT_JOINTS):
        return False
    return constraint.max - constraint.min <= EQUAL_ENDS * max(1.0, abs(constraint.max))


def both_sided(limit: Any) -> constraints.Constraint:
    if isinstance(limit, constraints.SlideJoint):
        rod = constraints.PinJoint(limit.a, limit.b, limit.anchor_a, limit.anchor_b)
        rod.distance = limit.min
        return rod
    return constraints.GearJoint(limit.a, limit.b, limit.min, 1.0)


def copy_space(imported: ImportedSpace) -> tuple[pymunk.Space, list[pymunk.Body]]:
    """A copy of the space, and the bodies of the copy in the order of the mechanism."""
    original, space = imported.space, imported.space.copy()
    # A sleeping body in the copy may abort the process (pymunk 7.3.1). `sleepers` reports bodies that may sleep.
    space.sleep_time_threshold = inf
    copies = dict(zip(original.bodies, space.bodies, strict=True))
    for body, copy in copies.items():
        if body.center_of_gravity.length:
            # pymunk (7.3.1) sets the position of a copy before the centre of mass, which then displaces the body.
            copy.angle, copy.position = body.angle, body.position
    for copy, constraint in zip(space.constraints, original.constraints, strict=True):
        if isinstance(constraint, constraints.PinJoint):
            copy.distance = constraint.distance  # pymunk (7.3.1) sets the distance to its current value
    return space, [copies[body] for body in imported.moving]


def set_poses(bodies: Sequence[pymunk.Body], pose: Array) -> None:
    for body, (x, y, angle) in zip(bodies, pose.tolist(), strict=True):
        body.angle = angle
        body.position = pymunk.Vec2d(x, y) - body.center_of_gravity.rotated(angle)
