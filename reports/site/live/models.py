"""Models for the engines in the page: MuJoCo's as MJCF, pymunk's space as a list of numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from itertools import chain
from typing import Any

import pymunk as pymunk_package
from pymunk.constraints import GrooveJoint, PivotJoint

from engines import Unsupported
from engines.mujoco import MuJoCo
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.writers import mjcf
from engines.pymunk import Pymunk
from engines.pymunk.joints.slide import AimedGroove, Zeroed
from engines.pymunk.model import Model
from reference.joints import Pin, Skate, Slot
from reference.mechanism import Mechanism
from reports.site.drawn import index_of
from reports.site.live.sliders import ENGINES


@dataclass(frozen=True)
class MujocoText:
    """A MuJoCo model for the page: MJCF as `crosscheck export` writes it, and the places of our bodies in it."""

    text: str
    bodies: tuple[int, ...]  # MuJoCo's number of each body of the mechanism
    # Parents first: body, parent (-1: ground), indices of rotation and slide in qpos (-1: none), slide direction.
    links: tuple[tuple[float, ...], ...]
    idle: tuple[str, ...]  # settings without an effect on this model


def mujoco_text(engine: MuJoCo, mechanism: Mechanism, step: float) -> MujocoText:
    """Return the model of this method for a step [s], which sets the depth of a blade in the ground.

    Raises Unsupported for a method with Python code in every step: the page has none.
    """
    model = engine.model(mechanism, step, unit=1.0)
    springs = model.compiled.neq or model.compiled.npair
    return MujocoText(
        mjcf(model),
        tuple(int(model.compiled.body(f"body {number}").id) for number in range(len(mechanism.bodies))),
        links(model),
        () if springs else tuple(name for name in ENGINES["mujoco"] if name != "integrator"),
    )


def links(model: MuJoCoModel) -> tuple[tuple[float, ...], ...]:
    """Return the records `MujocoText.links`, parents first: how the pose of each body follows from qpos."""
    records = []
    for link in model.tree.links:
        rotation = -1 if link.rotation is None else model.address[link.rotation]
        slide = model.address[link.column] if link.kind == "slot" else -1
        records.append((link.body, -1 if link.parent is None else link.parent, rotation, slide, *link.direction))
    return tuple(records)


STEP = 1e-3  # s; these models do not depend on the step


class RecordKind(IntEnum):
    """The kind of a record, with the numbers of munk2d.c."""

    PIVOT, GROOVE, CIRCLE, SEGMENT, POLYGON, ZEROED, AIMED = range(1, 8)


Indexed = Callable[[Any], int]


@dataclass(frozen=True)
class MunkSpace:
    """A space for the page: its numbers; settings without an effect; indices of the constraints of pins and slots."""

    numbers: tuple[float, ...]
    idle: tuple[str, ...]
    impulses: tuple[int, ...]  # -1 without a constraint of pymunk


def space_of(engine: Pymunk, mechanism: Mechanism, duration: float) -> MunkSpace:
    """Return the space of this method for a motion of `duration` [s]. Raises Unsupported.

    The numbers are: gravity; collision slop and bias; number of bodies; iterations; error_bias; 1 if error_bias is the
    residual after a step, 0 after a second; bodies; records. A body: kind (0 dynamic, 1 kinematic), mass, moment, x, y,
    angle, vx, vy, rate, origin in our frame. A record: kind, count of the numbers that follow, these numbers. Bodies
    are numbered from 0, and -1 is the ground. Records are in the order in which the adapter added the constraints,
    which is the order of the solver's iterations.
    """
    model = engine.model(mechanism, STEP, duration)
    space, unit = model.space, model.unit
    places: dict[Any, int] = {body: index for index, body in enumerate(model.bodies)}

    def index(body: Any) -> int:
        return places.get(body, -1)

    constraints = list(space._constraints)  # the public property is a set
    # The gap of an aimed groove is never closed, so its error_bias does not count.
    aimed = [aim.constraint for aim in model.before_step if isinstance(aim, AimedGroove)]
    biases = {constraint.error_bias for constraint in constraints if constraint not in aimed}
    gravity = (component / unit**2 for component in space.gravity)
    head = (*gravity, space.collision_slop, space.collision_bias, len(model.bodies), space.iterations)
    head += (max(biases, default=1.0), float(unit != 1))
    records = [_constraint(constraint, index) for constraint in constraints]
    records += [_shape(shape, index) for shape in space.shapes]
    records += _by_hand(model, mechanism)
    flat = [head, *_bodies(model), *((kind, len(numbers), *numbers) for kind, numbers in records)]
    idle = {"iterations": not (constraints or space.shapes), "bias": not biases}
    joined = [(index(constraint.a), index(constraint.b)) for constraint in constraints]
    pairs = [
        (index_of(mechanism, joint.first), index_of(mechanism, joint.second))
        for joint in mechanism.joints
        if isinstance(joint, Pin | Slot)
    ]
    return MunkSpace(
        tuple(map(float, chain(*flat))),
        tuple(name for name in idle if idle[name]),
        tuple(joined.index(pair) if pair in joined else -1 for pair in pairs),
    )


def _bodies(model: Model) -> list[tuple[float, ...]]:
    records = []
    for body, origin in zip(model.bodies, model.origins, strict=True):
        kinematic = body.body_type == pymunk_package.Body.KINEMATIC
        weight = (1.0, 1.0) if kinematic else (body.mass, body.moment)
        velocity = (component / model.unit for component in (*body.velocity, body.angular_velocity))
        placed = (*body.position, body.angle, *velocity, *origin)
        records.append((float(kinematic), *weight, *placed))
    return records


def _constraint(each: Any, index: Indexed) -> tuple[RecordKind, tuple[float, ...]]:
    between = (index(each.a), index(each.b))
    match each:
        case PivotJoint():
            return RecordKind.PIVOT, (*between, *each.anchor_a, *each.anchor_b)
        case GrooveJoint():
            return RecordKind.GROOVE, (*between, *each.groove_a, *each.groove_b, *each.anchor_b)
        case _:
            raise Unsupported(f"the page knows no {type(each).__name__}")


def _shape(each: Any, index: Indexed) -> tuple[RecordKind, tuple[float, ...]]:
    common = (index(each.body), each.friction, each.filter.categories)
    match each:
        case pymunk_package.Circle():
            return RecordKind.CIRCLE, (*common, each.radius, *each.offset)
        case pymunk_package.Segment():
            return RecordKind.SEGMENT, (*common, each.radius, *each.a, *each.b)
        case pymunk_package.Poly():
            return RecordKind.POLYGON, (*common, *chain(*each.get_vertices()))
        case _:
            raise Unsupported(f"the page knows no {type(each).__name__}")


def _by_hand(model: Model, mechanism: Mechanism) -> list[tuple[RecordKind, tuple[float, ...]]]:
    """Return records of our adapter's code around a step; munk2d.c has the two kinds that enforce skates."""
    skates = [mechanism.body_index(str(joint.second)) for joint in mechanism.joints if isinstance(joint, Skate)]
    records: list[tuple[RecordKind, tuple[float, ...]]] = []
    for hands in (model.after_step, model.before_step):
        if hands and len(hands) != len(skates):
            raise Unsupported("this method needs Python code in every step, which the page has not")
        for body, hand in zip(skates, hands, strict=False):
            match hand:
                case Zeroed():
                    records.append((RecordKind.ZEROED, (body, hand._angle, hand._arm, hand._push, hand._spin)))
                case AimedGroove():
                    row = list(model.space._constraints).index(hand.constraint)
                    records.append((RecordKind.AIMED, (body, row, hand._angle, hand._back, hand._front)))
                case _:
                    raise Unsupported("this method needs Python code in every step, which the page has not")
    return records
