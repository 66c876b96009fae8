"""Wrong models: an engine that is given a mechanism in which one number is wrong, and read out as if it were right.

This is what a mistake in an adapter comes to: its engine moves another mechanism, and the report asks for the scene's.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, TypeVar

import numpy as np
import pytest
from numpy.typing import NDArray

from engines import Engine
from engines.box2d import Box2D
from engines.mjx import Mjx
from engines.mujoco import MuJoCo
from engines.pymunk import Pymunk
from reference.joints import Drive, Gear, Joint, Roll, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.closed_curves import Cam, Ellipse
from reference.rolling.curves import Circle, Curve, Line, Placed, Ring
from reference.rolling.kinematics import Rolling
from reports.gate.change import Altered
from reports.gate.judge import projected

Array = NDArray[np.float64]
Some = TypeVar("Some")

KINDS = ("mass", "inertia", "length", "gravity", "point", "angle", "size", "rate")
# In longer chains the first, the middle and the last body and joint stand for all.
MANY = 6
# Newton steps that close the joints of a wrong model: quadratic from a relative miss of 1e-2.
CLOSING_STEPS = 6


@dataclass(frozen=True)
class Misbuilt(Mechanism):
    """What an engine builds its model from, while what is read out of it belongs to the mechanism `right`.

    Joints that can't all be closed with the wrong number are as nearly closed as they can be.
    """

    right: Mechanism = field(kw_only=True)

    def _refuse_a_bad_start(self) -> None:
        pass

    def reaction(
        self,
        pose: Array,
        acceleration: Array,
        inertias: Array | None = None,
        gravity: Array | None = None,
        twist: Array | None = None,
    ) -> Array:
        """Reactions on the right mechanism's rows; its masses too, unless the engine gives its own."""
        return self.right.reaction(pose, acceleration, inertias, gravity, twist)


@dataclass(frozen=True)
class Mistake:
    """One number of a mechanism that is wrong: `owner` is a body or joint ("" for gravity and the ground's points).

    Kinds, for a relative error r, with L the mechanism's length and T its time scale:

    mass, inertia: of a body, times 1 + r. length: all joint points of a body, times 1 + r. gravity: times 1 + r, or r L
    / T^2 downwards where there is none. point: of a joint, moved by r L. angle: of a skate's blade, a slot's line, a
    drive's start or a rolling curve, plus r. size: of a rolling curve, times 1 + r. rate: of a drive, or of the whole
    start where nothing is driven, times 1 + r, or r / T where it is zero.
    """

    kind: str
    owner: str = ""
    detail: str = ""

    def __str__(self) -> str:
        return " ".join(filter(None, (self.kind, self.owner, self.detail)))

    def made(self, right: Mechanism, relative: float) -> Misbuilt:
        """The wrong model, its start closed again: poses and twists next to the right ones, by mass."""
        bodies, joints, gravity = list(right.bodies), list(right.joints), right.gravity
        twist = right.twist.copy()
        length, time = right.length_scale, right.time_scale
        match self.kind:
            case "mass" | "inertia":
                index = right.body_index(self.owner)
                value = getattr(bodies[index], self.kind)
                bodies[index] = replace(bodies[index], **{self.kind: value * (1 + relative)})
            case "gravity":
                extra = (0.0, -length / time**2) if not any(gravity) else gravity
                gravity = (gravity[0] + relative * extra[0], gravity[1] + relative * extra[1])
            case "length":
                joints = [_lengthened(joint, self.owner or None, 1 + relative) for joint in joints]
            case "rate" if not self.owner:
                # From rest every body begins to turn; what the joints allow of it is left by the closing.
                twist = twist * (1 + relative) if twist.any() else np.add(twist, [0.0, 0.0, relative / time])
            case _:
                index = [joint.name for joint in joints].index(self.owner)
                joints[index] = _wrong_joint(joints[index], self.kind, self.detail, relative, length, time)
        wrong = Misbuilt(tuple(bodies), tuple(joints), gravity, right.forces, right=right)
        pose, closed = right.pose, twist
        for _ in range(CLOSING_STEPS):
            pose, closed = projected(wrong, pose, twist, 0.0)
        return replace(wrong, bodies=tuple(_moved(b, p, v) for b, p, v in zip(bodies, pose, closed, strict=True)))


def _moved(body: Body, pose: Array, twist: Array) -> Body:
    return replace(body, pose=tuple(map(float, pose)), twist=tuple(map(float, twist)))


def _lengthened(joint: Joint, body: str | None, factor: float) -> Joint:
    """The joint with its point on this body (None: the ground) so many times as far from the centre of mass."""
    changes = {}
    for name, point in ((joint.first, "first_point"), (joint.second, "second_point")):
        if name == body and point in joint.__dataclass_fields__:
            x, y = getattr(joint, point)
            changes[point] = (x * factor, y * factor)
    return replace(joint, **changes)


def _wrong_joint(joint: Any, kind: str, detail: str, relative: float, length: float, time: float) -> Any:
    match kind, joint:
        case "rate", Drive(turning_rate=rate):
            return replace(joint, turning_rate=rate * (1 + relative) if rate else relative / time)
        case "angle", Drive():
            return replace(joint, offset=joint.offset + relative)
        case "angle", Skate():
            return replace(joint, angle=joint.angle + relative)
        case "angle", Slot():
            return replace(joint, line_angle=joint.line_angle + relative)
        case _, Roll(rolling=rolling):
            return replace(joint, rolling=_wrong_rolling(rolling, kind, detail, relative, length))
        case _:
            point, axis = detail.split()
            moved = list(getattr(joint, point))
            moved["xy".index(axis)] += relative * length
            return replace(joint, **{point: tuple(moved)})


def _wrong_rolling(rolling: Rolling, kind: str, detail: str, relative: float, length: float) -> Rolling:
    which, _, axis = detail.partition(" ")
    curve: Curve = getattr(rolling, which)
    match kind:
        case "size":
            wrong = _scaled(curve, 1 + relative)
        case "angle":
            wrong = Placed(curve, turn=relative)
        case _:
            wrong = Placed(curve, shift=(relative * length, 0.0) if axis == "x" else (0.0, relative * length))
    arc = rolling.ground_arc * (1 + relative if (kind, which) == ("size", "ground") else 1.0)
    body, ground = (wrong, rolling.ground) if which == "body" else (rolling.body, wrong)
    return Rolling.at_angle(body, ground, rolling.theta, arc)


def _scaled(curve: Curve, factor: float) -> Curve:
    match curve:
        case Circle() | Ring():
            return replace(curve, radius=curve.radius * factor, centre=_times(curve.centre, factor))
        case Ellipse():
            return Ellipse(curve.along_x * factor, curve.along_y * factor)
        case Cam():
            return Cam(curve.radius * factor, _times(curve.cosines, factor), _times(curve.sines, factor))
        case Placed():
            return Placed(_scaled(curve.curve, factor), _times(curve.shift, factor), curve.turn)
        case _:
            raise TypeError(f"no size is known of {curve!r}")


def _times(values: Any, factor: float) -> Any:
    return tuple(value * factor for value in values)


def _some(many: Sequence[Some]) -> Sequence[Some]:
    return many if len(many) <= MANY else (many[0], many[len(many) // 2], many[-1])


def mistakes(mechanism: Mechanism) -> tuple[Mistake, ...]:
    """Everything in a mechanism that can be wrong by itself; of long chains the ends and the middle."""
    return tuple(_mistakes(mechanism))


def _mistakes(mechanism: Mechanism) -> Iterator[Mistake]:
    bodies = [body.name for body in _some(mechanism.bodies)]
    joints = _some(mechanism.joints)
    yield from (Mistake(kind, name) for kind in ("mass", "inertia") for name in bodies)
    yield Mistake("gravity")
    for name in (*bodies, None):
        if any(_lengthened(joint, name, 2.0) != joint for joint in mechanism.joints):
            yield Mistake("length", name or "")
    for joint in joints:
        match joint:
            case Roll():
                for which in ("body", "ground"):
                    yield from (Mistake("point", joint.name, f"{which} {axis}") for axis in "xy")
                    yield Mistake("angle", joint.name, which)
                    if not isinstance(getattr(joint.rolling, which), Line):
                        yield Mistake("size", joint.name, which)
            case _:
                if isinstance(joint, Drive | Skate | Slot):
                    yield Mistake("angle", joint.name)
                for point in ("first_point", "second_point"):
                    if point in joint.__dataclass_fields__:
                        yield from (Mistake("point", joint.name, f"{point} {axis}") for axis in "xy")
    drives = [joint for joint in joints if isinstance(joint, Drive)]
    yield from (Mistake("rate", drive.name) for drive in drives)
    if not any(isinstance(joint, Drive) and joint.turning_rate for joint in drives):
        yield Mistake("rate")


@dataclass(frozen=True)
class Made:
    """The change of a mechanism that makes this mistake, so large."""

    mistake: Mistake
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return self.mistake.made(mechanism, self.relative)


def mistaken(engine: Engine, mistake: Mistake, relative: float) -> Altered:
    """An engine with one mistake in every model that it builds, held to the promises of the right one."""
    return Altered(engine, Made(mistake, relative))


# What the search has to find: a part of a number, or a sign.

Change = Callable[[Mechanism], Mechanism]

FORCES = ("spring", "torsion-spring", "damper", "torsion-damper", "force", "torque")
FIELD = {"spring": "stiffness", "torsion-spring": "stiffness", "force": "second_point"}  # a force's is its lever arm
FIELD |= {"damper": "damping", "torsion-damper": "damping", "torque": "torque"}
# Of joints that hold velocities: a kind of Mistake, and its detail.
WRONG = {"skate": ("angle", ""), "roll": ("size", "body"), "drive": ("rate", "")}


@dataclass(frozen=True)
class Heavier:
    """Every inertia off by a part."""

    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return replace(mechanism, bodies=tuple(_larger(body, "inertia", self.relative) for body in mechanism.bodies))


@dataclass(frozen=True)
class Stronger:
    """This number of every force element off by a part."""

    name: str
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        return replace(mechanism, forces=tuple(_larger(force, self.name, self.relative) for force in mechanism.forces))


@dataclass(frozen=True)
class Moved:
    """A number of the last joint of a kind off by a part: its point on the second body, unless WRONG says another."""

    kind: str
    relative: float

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        own = [joint for joint in mechanism.joints if type(joint).__name__.lower() == self.kind]
        what, detail = WRONG.get(self.kind, ("point", "second_point x"))
        return Mistake(what, own[-1].name, detail).made(mechanism, self.relative) if own else mechanism


@dataclass(frozen=True)
class Reversed:
    """Gears turn the wrong way round: a sign of their row."""

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        joints = tuple(
            replace(joint, ratio=-joint.ratio) if isinstance(joint, Gear) else joint for joint in mechanism.joints
        )
        return Misbuilt(mechanism.bodies, joints, mechanism.gravity, mechanism.forces, right=mechanism)


def _larger(part: Any, name: str, relative: float) -> Any:
    if not hasattr(part, name):
        return part
    value = getattr(part, name)
    return replace(part, **{name: tuple((1 + relative) * v for v in value) if isinstance(value, tuple) else
                            (1 + relative) * value})  # fmt: skip


def planted(kind: str, relative: float) -> Change:
    """The fault of a kind of joint, of a force element, or of all inertias."""
    if kind == "inertia":
        return Heavier(relative)
    if kind == "gear":
        return Reversed()
    return Stronger(FIELD[kind], relative) if kind in FORCES else Moved(kind, relative)


def plant(monkeypatch: pytest.MonkeyPatch, change: Change) -> None:
    """Have the engines whose laws of an instant are asked build their models from changed mechanisms."""
    for engine, name in ((MuJoCo, "model"), (Mjx, "model"), (Pymunk, "swept_model"), (Box2D, "build")):
        monkeypatch.setattr(engine, name, _planted(getattr(engine, name), change))


def _planted(right: Callable[..., Any], change: Change) -> Callable[..., Any]:
    def wrong(self: Any, mechanism: Mechanism, *given: Any, **named: Any) -> Any:
        made = right(self, change(mechanism), *given, **named)
        if isinstance(self, MuJoCo):  # what is read out belongs to the mechanism that was asked for
            return replace(made, mechanism=mechanism)
        return (replace(made[0], mechanism=mechanism), made[1]) if isinstance(self, Mjx) else made

    return wrong
