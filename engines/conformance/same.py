"""Checks that a motion does not depend on how it is described.

The same mechanism is turned, shifted, mirrored, relabelled and reordered, and its joints are named from the other side.
What an engine gives must be the same, described back.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from engines import Unsupported
from engines.conformance.check import Check, Fails, Subject, finite, require
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
    """The world mirrored at the y axis (x -> -x) if `mirrored`, then turned by `turn` [rad], then shifted [m]."""

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
        """A point in a body's own frame, which a mirror mirrors as well, and nothing else moves."""
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
                if isinstance(joint, Pin | Weld):  # a force in the world's directions, and a weld's torque
                    own[:, :2] = own[:, :2] @ self._matrix
                    own[:, 2:] *= sense
                elif isinstance(joint, Drive | Gear):
                    own *= sense
                elif isinstance(joint, Roll):  # a boundary keeps its material on the left, so its direction turns round
                    own[:, 0] *= sense
                row += joint.size
            return pose, twist, reaction

        return changed, back

    def _joint(self, joint: Joint) -> Joint:
        """The joint in the new world; what belongs to the first body is the world's where that is the ground."""
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
                raise TypeError(f"no isometry of a {type(joint).__name__} is defined here")

    def _force(self, force: ForceElement) -> ForceElement:
        """The force element in the new world."""
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
                raise TypeError(f"no isometry of a {type(force).__name__} is defined here")

    def _between(self, pair: Weld | TorsionSpring, angle: float) -> float:
        """An angle of the second body against the first, where the ground's stays zero."""
        turned = float(pair.second is not None) - float(pair.first is not None)
        return (-angle if self.mirrored else angle) + self.turn * turned

    def _points(self, joint: Pin | Slot | Rod | Weld | Spring | Damper) -> dict[str, Any]:
        """Both points where they are now."""
        points = {"first_point": (joint.first, joint.first_point), "second_point": (joint.second, joint.second_point)}
        return {
            name: self._place(*point) if body is None else self._inside(point) for name, (body, point) in points.items()
        }

    def _rolling(self, rolling: Rolling, ground: bool) -> Rolling:
        first, first_arc, second, second_arc = rolling.ground, rolling.ground_arc, rolling.body, rolling.body_arc
        theta = rolling.theta
        if self.mirrored:
            (first, first_arc), (second, second_arc) = _mirrored(first, first_arc), _mirrored(second, second_arc)
            theta = -theta
        if ground and (self.turn or any(self.shift)):
            first, theta = Placed(first, self.shift, self.turn), theta + self.turn
        return Rolling(second, first, theta, first_arc, second_arc)


def _mirrored(curve: Curve, arc: float) -> tuple[Curve, float]:
    """The curve after x -> -x, again with its material on the left, and the arc of the same place."""
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
    raise ValueError(f"mirrored: the curve is a {type(curve).__name__}; it must be a Circle, a Ring or a Line")


def relabelled(mechanism: Mechanism) -> Described:
    """Names with spaces and letters of another alphabet, against the order in which the bodies and joints stand."""
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


def _named(what: str, index: int) -> str:
    return f"{what} {1000 - index} / {index}"


def bodies_reordered(mechanism: Mechanism) -> Described:
    """The last body comes first."""
    changed = replace(mechanism, bodies=mechanism.bodies[::-1])
    return changed, lambda run: (run.pose[:, ::-1], run.twist[:, ::-1], run.reaction)


def joints_reordered(mechanism: Mechanism) -> Described:
    """The last joint comes first; reactions stand in the order of the joints."""
    changed = replace(mechanism, joints=mechanism.joints[::-1])
    place = [changed.row_names.index(name) for name in mechanism.row_names]
    return changed, lambda run: (run.pose, run.twist, run.reaction[:, place])


def joints_swapped(mechanism: Mechanism) -> Described:
    """Pins and drives with their bodies swapped: what is told is then the force on the other body.

    A slot's line, a skate's ground and a roll's outer side belong to the first body, so these have no other side.
    """

    def swapped(joint: Any) -> Joint:
        if isinstance(joint, Pin):
            points = {"first_point": joint.second_point, "second_point": joint.first_point}
            return replace(joint, first=joint.second, second=joint.first, **points)
        if isinstance(joint, Drive):
            numbers = {"turning_rate": -joint.turning_rate, "offset": -joint.offset}
            return replace(joint, first=joint.second, second=joint.first, **numbers)
        return joint

    changed = replace(mechanism, joints=tuple(swapped(joint) for joint in mechanism.joints))
    signs = [-1.0 if isinstance(j, Pin | Drive) else 1.0 for j in mechanism.joints for _ in range(j.size)]
    return changed, lambda run: (run.pose, run.twist, run.reaction * signs)


# Below these, relative to the largest value, only rounding differs: a solver that ends by a tolerance lets some more
# through than the 1e-13 of a direct one, and reactions are differences of velocities over a step.
ROUNDING = {"pose": 1e-10, "twist": 1e-9, "reaction": 1e-6}
# Where an engine decides at a threshold (whether two shapes that just touch do touch) or treats the rows of a joint one
# after the other, two descriptions may come out with errors of their own. Both are of the size of its error at this
# step, so they differ by at most twice that; and half as much again, since errors are known at samples only.
OWN = 3.0
# The order in which an iterative solver goes over the joints changes what its sweeps leave, so the error itself: the
# rate of a Gauss-Seidel sweep is that of the matrix, whatever the order, but not the first sweep's share. A decade.
SWEPT = 10.0


def same_if_turned(subject: Subject, world: World) -> None:
    """The whole world turned by an odd angle moves in the same way."""
    _same(subject, world, Isometry(turn=0.7), OWN, "a direction of the world is used as one of a body, or of gravity")


def same_if_shifted(subject: Subject, world: World) -> None:
    """The whole world shifted moves in the same way."""
    _same(subject, world, Isometry(shift=(3.7, -2.9)), OWN, "a point of the ground is taken from the origin")


def same_if_mirrored(subject: Subject, world: World) -> None:
    """The whole world seen in a mirror moves in the mirrored way."""
    means = "a sign of an angle or of a direction across is taken for granted"
    _same(subject, world, Isometry(mirrored=True), OWN, means)


def same_if_relabelled(subject: Subject, world: World) -> None:
    """Other names of bodies and joints change nothing."""
    _same(subject, world, relabelled, OWN, "bodies are sorted by name, or a name means something")


def same_if_bodies_are_reordered(subject: Subject, world: World) -> None:
    """Bodies in another order move in the same way, and are told in that order."""
    _same(subject, world, bodies_reordered, OWN, "states stand in the engine's order instead of the mechanism's")


def same_if_joints_are_reordered(subject: Subject, world: World) -> None:
    """Joints in another order move in the same way, with an error of the same size, and reactions in that order."""
    _same(subject, world, joints_reordered, SWEPT, "reactions stand in the engine's order, or only a tree is built")


def same_if_bodies_of_joints_are_swapped(subject: Subject, world: World) -> None:
    """Pins and drives named from their other body move in the same way, with reactions of the other sign."""
    _same(subject, world, joints_swapped, OWN, "the ground, or the parent, is expected to be the first body of a joint")


def _same(subject: Subject, world: World, change: Change, factor: float, means: str) -> None:
    run = finite(subject.run(world.mechanism))
    exact = world.exact(run.t)
    changed, back = change(world.mechanism)
    try:
        other = back(finite(subject.fresh(changed)))
    except Unsupported as reason:
        raise Fails(f"a refusal: {reason}", "the same motion, since it builds the other description", means) from reason
    for name, now in zip(("pose", "twist", "reaction"), other, strict=True):
        was = getattr(run, name)
        if np.array_equal(np.isnan(was), np.isnan(now)) and np.isnan(was).all():
            continue
        own = factor * float(np.nanmax(np.abs(was - getattr(exact, name))))
        size = max(1.0, float(np.nanmax(np.abs(was))))
        bound = own + ROUNDING[name] * size
        differ = float(np.max(np.abs(np.nan_to_num(now) - np.nan_to_num(was))))
        require(
            differ <= bound and np.array_equal(np.isnan(was), np.isnan(now)),
            f"a {name} that differs by {differ:.3g}",
            f"at most {bound:.2g}: {factor:g} times its error at this step, and rounding",
            means,
        )


CHECKS = (
    *(Check(function, MOVING) for function in (same_if_turned, same_if_shifted, same_if_mirrored, same_if_relabelled)),
    Check(same_if_bodies_are_reordered, tuple(world for world in MOVING if len(world.mechanism.bodies) > 1)),
    Check(same_if_joints_are_reordered, tuple(world for world in MOVING if len(world.mechanism.joints) > 1)),
    Check(same_if_bodies_of_joints_are_swapped, tuple(world for world in MOVING if {"pin", "drive"} & {*world.kinds})),
)
