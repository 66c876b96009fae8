"""What engines in the page are given: MuJoCo's model as text, pymunk's space as a list of numbers."""

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
from engines.mujoco.model import Model as TreeModel
from engines.mujoco.writers import mjcf
from engines.pymunk import Pymunk
from engines.pymunk.joints.slide import AimedGroove, Zeroed
from engines.pymunk.model import Model
from reference.joints import Pin, Skate, Slot
from reference.mechanism import Mechanism
from reports.site.drawn import index_of
from reports.site.live.sliders import ENGINES


@dataclass(frozen=True)
class Text:
    """A model for the page: MJCF as `crosscheck export` writes it, and where our bodies are in it."""

    text: str
    bodies: tuple[int, ...]  # MuJoCo's number of each body of the mechanism
    # Parents first: body, parent (-1: ground), places in qpos of rotation and slide (-1: none), the slide's direction.
    links: tuple[tuple[float, ...], ...]
    idle: tuple[str, ...]  # sliders of the engine that act on nothing


def text_of(engine: MuJoCo, mechanism: Mechanism, step: float) -> Text:
    """The model of this method; for a step [s], since how deep a skate stands in the ground depends on it.

    Raises Unsupported where our code helps while it is stepped: the page has none.
    """
    model = engine.model(mechanism, step, unit=1.0)
    springs = model.compiled.neq or model.compiled.npair
    return Text(
        mjcf(model, engine.stiffness.softening),
        tuple(int(model.compiled.body(f"body {number}").id) for number in range(len(mechanism.bodies))),
        links(model),
        () if springs else tuple(name for name in ENGINES["mujoco"] if name != "integrator"),
    )


def links(model: TreeModel) -> tuple[tuple[float, ...], ...]:
    """Of each body, parents first, how its pose follows from qpos, as `Text` has it."""
    found = []
    for link in model.tree.links:
        rotation = -1 if link.rotation is None else model.address[link.rotation]
        slide = model.address[link.column] if link.kind == "slot" else -1
        found.append((link.body, -1 if link.parent is None else link.parent, rotation, slide, *link.direction))
    return tuple(found)


STEP = 1e-3  # s: told in seconds, nothing of these models depends on it


class Part(IntEnum):
    """What a record of the plan is, as munk2d.c has it."""

    PIVOT, GROOVE, CIRCLE, SEGMENT, POLYGON, ZEROED, AIMED = range(1, 8)


Indexed = Callable[[Any], int]


@dataclass(frozen=True)
class Plan:
    """A space for the page: its numbers; sliders that act on nothing; of each pin and slot the place of its impulse."""

    numbers: tuple[float, ...]
    idle: tuple[str, ...]
    impulses: tuple[int, ...]  # -1 where no constraint of pymunk holds the joint


def plan_of(engine: Pymunk, mechanism: Mechanism, duration: float) -> Plan:
    """The numbers: gravity; collision slop and bias; the number of bodies; iterations; error_bias; 1 if that is what is
    left after a step, 0 after a second; bodies; records. For a motion of `duration` [s]. Raises Unsupported.

    A body: kind (0 dynamic, 1 kinematic), mass, moment, x, y, angle, vx, vy, rate, and its origin in our frame. A
    record: what it is, how many numbers follow, and these. Bodies are counted from 0, -1 is the ground, and records
    stand in the order in which the adapter added the constraints, since the solver sweeps in that order.
    """
    model = engine.model(mechanism, STEP, duration)
    space, unit = model.space, model.unit
    places: dict[Any, int] = {body: index for index, body in enumerate(model.bodies)}

    def index(body: Any) -> int:
        return places.get(body, -1)

    constraints = list(space._constraints)  # the public property is a set
    # Of a groove that is aimed nothing is closed, whatever the others' error_bias.
    aimed = [aim.constraint for aim in model.aims if isinstance(aim, AimedGroove)]
    biases = {each.error_bias for each in constraints if each not in aimed}
    gravity = (each / unit**2 for each in space.gravity)
    head = (*gravity, space.collision_slop, space.collision_bias, len(model.bodies), space.iterations)
    head += (max(biases, default=1.0), float(unit != 1))
    records = [_constraint(each, index) for each in constraints]
    records += [_shape(each, index) for each in space.shapes]
    records += _by_hand(model, mechanism)
    flat = [head, *_bodies(model), *((part, len(numbers), *numbers) for part, numbers in records)]
    idle = {"iterations": not (constraints or space.shapes), "bias": not biases}
    held = [(index(each.a), index(each.b)) for each in constraints]
    pairs = [
        (index_of(mechanism, joint.first), index_of(mechanism, joint.second))
        for joint in mechanism.joints
        if isinstance(joint, Pin | Slot)
    ]
    return Plan(
        tuple(map(float, chain(*flat))),
        tuple(name for name in idle if idle[name]),
        tuple(held.index(pair) if pair in held else -1 for pair in pairs),
    )


def _bodies(model: Model) -> list[tuple[float, ...]]:
    told = []
    for body, origin in zip(model.bodies, model.origins, strict=True):
        kinematic = body.body_type == pymunk_package.Body.KINEMATIC
        weight = (1.0, 1.0) if kinematic else (body.mass, body.moment)
        velocity = (each / model.unit for each in (*body.velocity, body.angular_velocity))
        placed = (*body.position, body.angle, *velocity, *origin)
        told.append((float(kinematic), *weight, *placed))
    return told


def _constraint(each: Any, index: Indexed) -> tuple[Part, tuple[float, ...]]:
    between = (index(each.a), index(each.b))
    match each:
        case PivotJoint():
            return Part.PIVOT, (*between, *each.anchor_a, *each.anchor_b)
        case GrooveJoint():
            return Part.GROOVE, (*between, *each.groove_a, *each.groove_b, *each.anchor_b)
        case _:
            raise Unsupported(f"the page knows no {type(each).__name__}")


def _shape(each: Any, index: Indexed) -> tuple[Part, tuple[float, ...]]:
    common = (index(each.body), each.friction, each.filter.categories)
    match each:
        case pymunk_package.Circle():
            return Part.CIRCLE, (*common, each.radius, *each.offset)
        case pymunk_package.Segment():
            return Part.SEGMENT, (*common, each.radius, *each.a, *each.b)
        case pymunk_package.Poly():
            return Part.POLYGON, (*common, *chain(*each.get_vertices()))
        case _:
            raise Unsupported(f"the page knows no {type(each).__name__}")


def _by_hand(model: Model, mechanism: Mechanism) -> list[tuple[Part, tuple[float, ...]]]:
    """What our adapter does before and after each step, of which the shim knows the two that hold skates."""
    skates = [mechanism.body_index(str(joint.second)) for joint in mechanism.joints if isinstance(joint, Skate)]
    records: list[tuple[Part, tuple[float, ...]]] = []
    for hands in (model.repairs, model.aims):
        if hands and len(hands) != len(skates):
            raise Unsupported("this method aims rows by code of ours in Python, which the page has not")
        for body, hand in zip(skates, hands, strict=False):
            match hand:
                case Zeroed():
                    records.append((Part.ZEROED, (body, hand._angle, hand._arm, hand._push, hand._spin)))
                case AimedGroove():
                    row = list(model.space._constraints).index(hand.constraint)
                    records.append((Part.AIMED, (body, row, hand._angle, hand._back, hand._front)))
                case _:
                    raise Unsupported("this method aims rows by code of ours in Python, which the page has not")
    return records
