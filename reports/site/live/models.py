"""Models for the engines in a page, as MJCF for MuJoCo and as a list of numbers for pymunk."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from itertools import chain
from typing import Any

import pymunk as pymunk_package
from pymunk.constraints import GrooveJoint, PivotJoint

from engines import Engine, Unsupported
from engines.mujoco import MuJoCo
from engines.mujoco.model import MuJoCoModel
from engines.mujoco.writers import mjcf
from engines.pymunk import Pymunk
from engines.pymunk.joints.slide import AimedGroove, Zeroed
from engines.pymunk.model import Model
from reference.joints import Pin, Skate, Slot
from reference.mechanism import Mechanism
from reports.site.drawn import index_of
from reports.site.live.sliders import ENGINES, INTEGRATORS

PYTHON_ONLY = "our code for it runs in Python only"  # why the page cannot run a method with our code in every step


@dataclass(frozen=True)
class MujocoText:
    """A MuJoCo model for the page. `text` is the MJCF that `crosscheck export` writes."""

    text: str
    bodies: tuple[int, ...]  # Number in MuJoCo of each body of the mechanism.
    # A link is (body, parent, index in qpos of the rotation, index in qpos of the slide, direction of the slide). The
    # parent -1 is the ground, and an index of -1 means that there is none. Parents come first.
    links: tuple[tuple[float, ...], ...]
    idle: tuple[str, ...]  # settings without an effect on this model


def mujoco_text(engine: MuJoCo, mechanism: Mechanism, step: float) -> MujocoText:
    """Return the model of this method for a step [s].

    Raises Unsupported for a method with Python code in every step, since the page has no Python.
    """
    model = engine.model(mechanism, step, unit=1.0)
    if model.hooks:
        raise Unsupported(PYTHON_ONLY)
    springs = model.compiled.neq or model.compiled.npair
    return MujocoText(
        mjcf(model),
        tuple(int(model.compiled.body(f"body {number}").id) for number in range(len(mechanism.bodies))),
        links(model),
        () if springs else tuple(name for name in ENGINES["mujoco"] if name != "integrator"),
    )


def own_values(
    munk: Engine | str, muj: Engine | str, mechanism: Mechanism, step: float, duration: float
) -> dict[str, str]:
    """Return the values of the engines' settings that the methods themselves choose, as texts of the controls."""
    texts: dict[str, str] = {}
    if isinstance(munk, Pymunk):
        numbers = space_of(munk, mechanism, duration).numbers
        texts |= {"iterations": f"{numbers[5]:.0f}", "bias": f"{numbers[6]:.2g}"}
    if isinstance(muj, MuJoCo):
        model = muj.model(mechanism, step, unit=1.0).compiled
        options = model.opt
        texts |= {
            "integrator": dict(INTEGRATORS)[options.integrator],
            "solverIterations": str(options.iterations),
            "tolerance": f"{options.tolerance:g}",
        }
        kind = "eq" if model.neq else "pair"
        if model.neq + model.npair:
            constant, impedance = getattr(model, f"{kind}_solref")[0][0], getattr(model, f"{kind}_solimp")[0][0]
            texts["timeConstant"] = f"{1000 * constant:.2g} ms" if constant > 0 else "given by a stiffness"
            texts["impedance"] = f"{impedance:.4g}"
    return texts


def links(model: MuJoCoModel) -> tuple[tuple[float, ...], ...]:
    """Return `MujocoText.links`, from which the page computes the pose of each body."""
    records = []
    for link in model.tree.links:
        rotation = -1 if link.rotation is None else model.address[link.rotation]
        slide = model.address[link.column] if link.kind == "slot" else -1
        records.append((link.body, -1 if link.parent is None else link.parent, rotation, slide, *link.direction))
    return tuple(records)


STEP = 1e-3  # step [s] of pymunk's models, which do not depend on the step


class RecordKind(IntEnum):
    """The kind of a record, with the numbers in munk2d.c."""

    PIVOT, GROOVE, CIRCLE, SEGMENT, POLYGON, ZEROED, AIMED = range(1, 8)


Indexed = Callable[[Any], int]


@dataclass(frozen=True)
class MunkSpace:
    """A pymunk space for the page. `space_of` defines the numbers."""

    numbers: tuple[float, ...]
    idle: tuple[str, ...]  # Settings without an effect on this model.
    impulses: tuple[int, ...]  # Index of the constraint of each pin and slot, or -1 if pymunk has no constraint for it.


def space_of(engine: Pymunk, mechanism: Mechanism, duration: float) -> MunkSpace:
    """Return the space of this method for a motion of `duration` [s].

    Raises Unsupported for a method with Python code in every step that munk2d.c does not have.

    The list of numbers begins with gx, gy, collision_slop, collision_bias, number of bodies, iterations, error_bias,
    and a flag (1: error_bias is the residual after a step, 0: after a second). Each body follows with its kind (0
    dynamic, 1 kinematic), mass, moment, x, y, angle, vx, vy, rate, and its origin (x, y) in our frame. Each record
    follows with its kind, the count of its numbers, and its numbers. In a record, bodies are numbered from 0, and -1 is
    the ground. The constraints have the order of the solver's iterations.
    """
    model = engine.model(mechanism, STEP, duration)
    space, unit = model.space, model.unit
    places: dict[Any, int] = {body: index for index, body in enumerate(model.bodies)}

    def index(body: Any) -> int:
        return places.get(body, -1)

    constraints = list(space._constraints)  # This list has an order, while the public property is a set.
    # An aimed groove has no gap, so its error_bias has no effect.
    aimed = [aim.constraint for aim in model.before_step if isinstance(aim, AimedGroove)]
    biases = {constraint.error_bias for constraint in constraints if constraint not in aimed}
    gravity = (component / unit**2 for component in space.gravity)
    head = (*gravity, space.collision_slop, space.collision_bias, len(model.bodies), space.iterations)
    head += (max(biases, default=1.0), float(unit != 1))
    records = [_constraint(constraint, index) for constraint in constraints]
    records += [_shape(shape, index) for shape in space.shapes]
    records += _step_code(model, mechanism)
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


def _step_code(model: Model, mechanism: Mechanism) -> list[tuple[RecordKind, tuple[float, ...]]]:
    """Return records of the adapter's code before and after a step. munk2d.c implements the two kinds for skates."""
    skates = [mechanism.body_index(str(joint.second)) for joint in mechanism.joints if isinstance(joint, Skate)]
    records: list[tuple[RecordKind, tuple[float, ...]]] = []
    for updates in (model.after_step, model.before_step):
        if updates and len(updates) != len(skates):
            raise Unsupported(PYTHON_ONLY)
        for body, update in zip(skates, updates, strict=False):
            match update:
                case Zeroed():
                    records.append((RecordKind.ZEROED, (body, update._angle, update._arm, update._push, update._spin)))
                case AimedGroove():
                    row = list(model.space._constraints).index(update.constraint)
                    records.append((RecordKind.AIMED, (body, row, update._angle, update._back, update._front)))
                case _:
                    raise Unsupported(PYTHON_ONLY)
    return records
