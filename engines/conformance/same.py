"""Checks that a motion does not depend on the description of the mechanism.

A mechanism is rotated, shifted, mirrored, relabelled or reordered, or the two bodies of its joints are swapped.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.conformance.check import CheckedEngine, ConformanceCheck, Fails, finite, require
from engines.conformance.worlds import MOVING, World
from reference.forces import Damper, Force, ForceElement, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Joint, Pin, Rod, Skate, Slot, Weld
from reference.mechanism import Mechanism
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.trajectory import Trajectory

Array = NDArray[np.float64]
Vector = tuple[float, float]
Three = tuple[Array, Array, Array]  # pose and twist (times, bodies, 3), reaction (times, rows)
Described = tuple[Mechanism, Callable[[Trajectory], Three]]
Change = Callable[[Mechanism], Described]


@dataclass(frozen=True)
class Isometry:
    """A transformation of the world: mirror (x -> -x) if `mirrored`, then turn [rad], then shift [m]."""

    turn: float = 0.0
    shift: Vector = (0.0, 0.0)
    mirrored: bool = False

    @property
    def _matrix(self) -> Array:
        cosine, sine = math.cos(self.turn), math.sin(self.turn)
        first = -1.0 if self.mirrored else 1.0
        return np.array([[first * cosine, -sine], [first * sine, cosine]])

    def _place(self, x: float, y: float, shifted: bool = True) -> Vector:
        new = self._matrix @ [x, y] + (np.array(self.shift) if shifted else 0.0)
        return float(new[0]), float(new[1])

    def _inside(self, point: Vector) -> Vector:
        return (-point[0], point[1]) if self.mirrored else point

    def _angle(self, angle: float) -> float:
        return self.turn + (-angle if self.mirrored else angle)

    def __call__(self, mechanism: Mechanism) -> Described:
        sense = -1.0 if self.mirrored else 1.0
        bodies = tuple(
            replace(
                body,
                pose=(*self._place(*body.pose[:2]), self._angle(body.pose[2])),
                twist=(*self._place(*body.twist[:2], shifted=False), sense * body.twist[2]),
            )
            for body in mechanism.bodies
        )
        joints = tuple(self._joint(joint) for joint in mechanism.joints)
        forces = tuple(self._force(force) for force in mechanism.forces)
        changed = Mechanism(bodies, joints, self._place(*mechanism.gravity, shifted=False), forces)

        def back(run: Trajectory) -> Three:
            pose, twist, reaction = run.pose.copy(), run.twist.copy(), run.reaction.copy()
            pose[..., :2] = (pose[..., :2] - np.array(self.shift)) @ self._matrix
            pose[..., 2] = sense * (pose[..., 2] - self.turn)
            twist[..., :2], twist[..., 2] = twist[..., :2] @ self._matrix, sense * twist[..., 2]
            row = 0
            for joint in mechanism.joints:
                own = reaction[:, row : row + joint.size]
                match joint:
                    case Pin() | Weld():  # a force along the world's axes, and the torque of a weld
                        own[:, :2] = own[:, :2] @ self._matrix
                        own[:, 2:] *= sense
                    case Drive() | Gear():
                        own *= sense
                    case Roll():  # a mirrored boundary has the opposite direction
                        own[:, 0] *= sense
                    case Slot() | Skate() | Rod():
                        pass
                    case _:
                        raise _undefined("joint", joint)
                row += joint.size
            return pose, twist, reaction

        return changed, back

    def _joint(self, joint: Joint) -> Joint:
        ground = joint.first is None
        sense = -1.0 if self.mirrored else 1.0
        own_angle = self._angle if ground else (lambda angle: sense * angle)
        match joint:
            case Pin() | Rod():
                return replace(joint, **self._points(joint))
            case Slot():
                return replace(joint, **self._points(joint), line_angle=own_angle(joint.line_angle))
            case Skate():
                return replace(joint, second_point=self._inside(joint.second_point), angle=sense * joint.angle)
            case Gear():
                first, second = (float(name is not None) for name in (joint.first, joint.second))
                return replace(joint, phase=sense * joint.phase + self.turn * (second - joint.ratio * first))
            case Weld():
                return replace(joint, **self._points(joint), angle=self._between(joint, joint.angle))
            case Drive():
                offset = own_angle(joint.offset) if joint.second is not None else sense * joint.offset - self.turn
                return replace(joint, turning_rate=sense * joint.turning_rate, offset=offset)
            case Roll():
                return replace(joint, rolling=self._rolling(joint.rolling, ground))
            case _:
                raise _undefined("joint", joint)

    def _force(self, force: ForceElement) -> ForceElement:
        match force:
            case Spring() | Damper():
                return replace(force, **self._points(force))
            case TorsionSpring():
                return replace(force, rest_angle=self._between(force, force.rest_angle))
            case TorsionDamper():
                return force
            case Torque():
                return replace(force, torque=-force.torque if self.mirrored else force.torque)
            case Force():
                pull = self._place(*force.force, shifted=False)
                return replace(force, second_point=self._inside(force.second_point), force=pull)
            case _:
                raise _undefined("force", force)

    def _between(self, pair: Weld | TorsionSpring, angle: float) -> float:
        """A transformed angle of the second body relative to the first; the angle of the ground stays zero."""
        turned = float(pair.second is not None) - float(pair.first is not None)
        return (-angle if self.mirrored else angle) + self.turn * turned

    def _points(self, joint: Pin | Slot | Rod | Weld | Spring | Damper) -> dict[str, Any]:
        points = [self._place(*point) if body is None else self._inside(point) for body, point in joint.points]
        return dict(zip(("first_point", "second_point"), points, strict=True))

    def _rolling(self, rolling: Rolling, ground: bool) -> Rolling:
        first, first_arc, second, second_arc = rolling.ground, rolling.ground_arc, rolling.body, rolling.body_arc
        theta = rolling.theta
        if self.mirrored:
            (first, first_arc), (second, second_arc) = _mirrored(first, first_arc), _mirrored(second, second_arc)
            theta = -theta
        if ground and (self.turn or any(self.shift)):
            first, theta = Placed(first, self.shift, self.turn), theta + self.turn
        return Rolling(second, first, theta, first_arc, second_arc)


def _undefined(word: str, element: Joint | ForceElement) -> ValueError:
    return ValueError(f"{word} {element.name!r}: no other description of a {type(element).__name__} is defined here")


def _mirrored(curve: Curve, arc: float) -> tuple[Curve, float]:
    """The curve after x -> -x with the material on the left, and the arc length of the same point."""
    match curve:
        case Circle() | Ring():
            x, y = curve.centre
            return replace(curve, centre=(-x, y)), curve.sense * math.pi * curve.radius - arc
        case Line():
            x, y = curve.through
            return replace(curve, heading=-curve.heading, through=(-x, y)), -arc
        case Placed():
            inner, arc = _mirrored(curve.curve, arc)
            return replace(curve, curve=inner, shift=(-curve.shift[0], curve.shift[1]), turn=-curve.turn), arc
        case _:
            raise ValueError(f"mirrored: the curve is a {type(curve).__name__}; it must be a Circle, a Ring or a Line")


def relabelled(mechanism: Mechanism) -> Described:
    """Other names with spaces and Cyrillic letters, in another alphabetical order."""
    names: dict[str | None, str] = {body.name: _named("тело", i) for i, body in enumerate(mechanism.bodies)}
    bodies = tuple(replace(body, name=names[body.name]) for body in mechanism.bodies)
    joints = tuple(
        replace(joint, name=_named("joint", i), first=names.get(joint.first), second=names.get(joint.second))
        for i, joint in enumerate(mechanism.joints)
    )
    forces = tuple(
        replace(force, second=names[force.second])
        if isinstance(force, Force)
        else replace(force, first=names.get(force.first), second=names.get(force.second))
        for force in mechanism.forces
    )
    changed = replace(mechanism, bodies=bodies, joints=joints, forces=forces)
    return changed, lambda run: (run.pose, run.twist, run.reaction)


def _named(kind: str, index: int) -> str:
    return f"{kind} {1000 - index} / {index}"


def bodies_reordered(mechanism: Mechanism) -> Described:
    changed = replace(mechanism, bodies=mechanism.bodies[::-1])
    return changed, lambda run: (run.pose[:, ::-1], run.twist[:, ::-1], run.reaction)


def joints_reordered(mechanism: Mechanism) -> Described:
    """Joints, and reactions, in reverse order."""
    changed = replace(mechanism, joints=mechanism.joints[::-1])
    place = [changed.row_names.index(name) for name in mechanism.row_names]
    return changed, lambda run: (run.pose, run.twist, run.reaction[:, place])


def joints_swapped(mechanism: Mechanism) -> Described:
    """Pins and drives with swapped bodies, so that reactions have the other sign.

    The two bodies of a slot, a skate or a roll have different roles and cannot be swapped.
    """

    def swapped(joint: Joint) -> Joint:
        match joint:
            case Pin():
                points = {"first_point": joint.second_point, "second_point": joint.first_point}
                return replace(joint, first=joint.second, second=joint.first, **points)
            case Drive():
                numbers = {"turning_rate": -joint.turning_rate, "offset": -joint.offset}
                return replace(joint, first=joint.second, second=joint.first, **numbers)
            case Slot() | Skate() | Roll() | Rod() | Gear() | Weld():
                return joint
            case _:
                raise _undefined("joint", joint)

    changed = replace(mechanism, joints=tuple(swapped(joint) for joint in mechanism.joints))
    signs = [-1.0 if isinstance(j, Pin | Drive) else 1.0 for j in mechanism.joints for _ in range(j.size)]
    return changed, lambda run: (run.pose, run.twist, run.reaction * signs)


# Differences by rounding, relative to the largest value. Direct solvers have differences of 1e-13, iterative solvers
# larger ones. Reactions may be changes of velocities over a step.
DESCRIPTION_ROUNDING = {"pose": 1e-10, "twist": 1e-9, "reaction": 1e-6}
# Largest difference relative to the error at this step. Two descriptions may have different errors, for example if
# rounding decides about a contact, or if rows are solved in sequence. The difference between two descriptions is then
# at most twice the error. The margin is for errors between samples.
ERROR_FACTOR = 3.0
# Largest difference relative to the error for joints in another order. The convergence rate of Gauss-Seidel iterations
# depends only on the matrix, but the error after the first iteration depends on the order of the joints.
REORDERED_FACTOR = 10.0


def same_if_turned(subject: CheckedEngine, world: World) -> None:
    """A rotated mechanism has the same motion."""
    means = "a direction of the world is used as one of a body, or of gravity"
    _same(subject, world, Isometry(turn=0.7), means)


def same_if_shifted(subject: CheckedEngine, world: World) -> None:
    """A shifted mechanism has the same motion."""
    _same(subject, world, Isometry(shift=(3.7, -2.9)), "a point of the ground is taken from the origin")


def same_if_mirrored(subject: CheckedEngine, world: World) -> None:
    """A mirrored mechanism has the mirrored motion."""
    means = "the sign of an angle or of a transverse direction is assumed"
    _same(subject, world, Isometry(mirrored=True), means)


def same_if_relabelled(subject: CheckedEngine, world: World) -> None:
    """The motion does not depend on the names of bodies and joints."""
    _same(subject, world, relabelled, "bodies are sorted by name, or a name has a meaning")


def same_if_bodies_are_reordered(subject: CheckedEngine, world: World) -> None:
    """With bodies in another order the motion is the same, and states are in this order."""
    _same(subject, world, bodies_reordered, "states are in the order of the engine instead of the mechanism")


def same_if_joints_are_reordered(subject: CheckedEngine, world: World) -> None:
    """With joints in another order the motion is the same up to the error, and reactions are in this order."""
    means = "reactions are in the order of the engine, or only a tree is built"
    _same(subject, world, joints_reordered, means, REORDERED_FACTOR)


def same_if_bodies_of_joints_are_swapped(subject: CheckedEngine, world: World) -> None:
    """With swapped bodies of pins and drives the motion is the same, and reactions have the other sign."""
    means = "the ground, or the parent, is expected to be the first body of a joint"
    _same(subject, world, joints_swapped, means)


def _same(subject: CheckedEngine, world: World, change: Change, means: str, factor: float = ERROR_FACTOR) -> None:
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t)
    changed, back = change(world.mechanism)
    try:
        restored = back(finite(subject.run(changed)))
    except Unsupported as reason:
        raise Fails(f"a refusal: {reason}", "the same motion, since it builds the other description", means) from reason
    for name, values in zip(("pose", "twist", "reaction"), restored, strict=True):
        expected = getattr(run, name)
        same_nan = np.array_equal(np.isnan(expected), np.isnan(values))
        if same_nan and np.isnan(expected).all():
            continue
        error = factor * float(np.nanmax(np.abs(expected - getattr(exact, name))))
        size = max(1.0, float(np.nanmax(np.abs(expected))))
        bound = error + DESCRIPTION_ROUNDING[name] * size
        difference = float(np.max(np.abs(np.nan_to_num(values) - np.nan_to_num(expected))))
        require(
            difference <= bound and same_nan,
            f"a {name} that differs by {difference:.3g}",
            f"at most {bound:.2g}: {factor:g} times its error at this step, and rounding",
            means,
        )


CHECKS = tuple(
    ConformanceCheck(function, tuple(filter(has, MOVING)))
    for has, functions in (
        (lambda world: True, (same_if_turned, same_if_shifted, same_if_mirrored, same_if_relabelled)),
        (lambda world: len(world.mechanism.bodies) > 1, (same_if_bodies_are_reordered,)),
        (lambda world: len(world.mechanism.joints) > 1, (same_if_joints_are_reordered,)),
        (lambda world: {"pin", "drive"} & {*world.kinds}, (same_if_bodies_of_joints_are_swapped,)),
    )
    for function in functions
)
