"""Checks of an engine's answers about itself (name, settings, packages, promises, costs, holders) and of its refusals.

Mechanisms are refused by Unsupported with a sentence, values by a ValueError that names them.
"""

from __future__ import annotations

import dataclasses
import math
import pickle
import re
from collections.abc import Callable
from contextlib import suppress
from typing import Any, get_args

import numpy as np

from engines import ConvergenceOrder, Enforcement, NotDeclared, Regularisation, Size, Unsupported
from engines.conformance.check import (
    SAMPLES,
    STEP,
    Check,
    Fails,
    NotAsked,
    Subject,
    require,
    require_a_sentence,
    stepped,
)
from engines.conformance.worlds import MOVING, SPINNING, WORLDS, World, rolling
from engines.package_versions import installed_version
from engines.trajectory_check import flaw_of_shapes
from reference.joints import Drive, Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line
from reference.rolling.roll import Roll

SAME = 1e-9  # whether two runs agree to the last bit is another check's
ADDRESS = re.compile(r" at 0x[0-9a-f]+", re.IGNORECASE)
BAD_STEPS: tuple[Any, ...] = (0.0, -0.01, math.nan, math.inf, "0.01", None, True)
BAD_COUNTS: tuple[Any, ...] = (0, -1, 1.5, math.nan, "2", None, True)


def has_a_name(subject: Subject) -> None:
    """`name`, `variant` and `family` are words that can be printed in one line."""
    for name in ("name", "variant", "family"):
        value = getattr(subject.engine, name, None)
        sound = isinstance(value, str) and bool(value.strip()) and value.isprintable()
        expected = "a string that is not empty and can be printed"
        require(sound, f"{name} = {value!r}", expected, "it is made from a setting")


def is_a_frozen_dataclass(subject: Subject) -> None:
    """An engine is a frozen dataclass whose repr shows all its settings, in one line and without addresses."""
    engine: Any = subject.engine
    frozen = dataclasses.is_dataclass(engine) and type(engine).__dataclass_params__.frozen  # type: ignore[attr-defined]
    found = f"a {type(engine).__name__} that can be changed"
    require(frozen, found, "a frozen dataclass", "frozen=True is left out")
    shown = repr(engine)
    settings = {field.name: getattr(engine, field.name) for field in dataclasses.fields(engine)}
    hidden = [name for name, value in settings.items() if f"{name}={value!r}" not in shown]
    require(
        not hidden and shown.isprintable() and not ADDRESS.search(shown),
        f"the repr {shown!r}" + (f" without {', '.join(hidden)}" if hidden else ""),
        "every setting, so that equal reprs are equal engines",
        "a setting is an object without a repr of its own, or is kept out of it",
    )


def can_be_hashed(subject: Subject) -> None:
    """An engine can be hashed, and equals itself."""
    try:
        hash(subject.engine)
    except TypeError as error:
        raise Fails(str(error), "a hash", "a setting is a list or an array instead of a tuple") from error
    equal = subject.engine == subject.engine
    require(equal, "an engine that differs from itself", "equality", "a setting is NaN")


def can_be_pickled(subject: Subject) -> None:
    """An engine can be pickled, and is then the same: equal, with the same repr and the same motion."""
    try:
        copy = pickle.loads(pickle.dumps(subject.engine))
    except Exception as error:
        raise Fails(
            f"{type(error).__name__}: {error}",
            "a copy by pickle",
            "its class is defined in a function, or a setting is a function or holds an object of the engine",
        ) from error
    means = "state beside the fields is lost, or made anew with other values"
    equal = copy == subject.engine and repr(copy) == repr(subject.engine)
    require(equal, f"a copy {copy!r}", repr(subject.engine), means)
    mechanism = any_built(subject)
    here, there = (stepped(each.build(mechanism), 3, 1) for each in (subject, Subject(copy)))
    same = np.allclose(here.pose, there.pose, rtol=0, atol=SAME)
    require(same, "another motion of the copy", "the same one", means)


def names_its_packages(subject: Subject) -> None:
    """`packages` is a tuple of installed packages, of Python or npm, whose versions are printed under the numbers."""
    packages = getattr(subject.engine, "packages", None)
    if not (isinstance(packages, tuple) and all(isinstance(name, str) for name in packages)):
        raise Fails(f"packages = {packages!r}", "a tuple of strings", "a comma is missing in a tuple of one")
    for name in packages:
        try:
            installed_version(name)
        except Exception as error:
            expected, means = "the name under which it was installed", "it is the name by which it is imported"
            raise Fails(f"{name!r}, which is not installed", expected, means) from error


def has_the_right_shapes(subject: Subject, world: World) -> None:
    """A run gives a Trajectory of samples + 1 poses, twists and reactions, in the order of bodies and rows."""
    if flaw := flaw_of_shapes(subject.run(world.mechanism), world.mechanism, SAMPLES):
        raise Fails(*flaw, "the start is left out or counted twice, or a field is filled by place")


def tells_the_size_of_its_model(subject: Subject, world: World) -> None:
    """A built model says how large it is, by a Size of counts that are not below zero."""
    size = getattr(subject.build(world.mechanism), "size", None)
    require(isinstance(size, Size), f"size = {size!r}", "a Size", "the run has no property of that name")
    for name, value in vars(size).items():
        sound = type(value) is int and value >= 0
        require(sound, f"size.{name} = {value!r}", "a count", "it is taken from an array of the engine as it is")


def promises_an_order(subject: Subject, world: World) -> None:
    """`order` gives a ConvergenceOrder, or NotDeclared with one sentence that says why."""
    subject.build(world.mechanism)
    order = subject.engine.order(world.mechanism)
    if isinstance(order, NotDeclared):
        require_a_sentence(str(order.reason), "NotDeclared")
        return
    require(
        isinstance(order, ConvergenceOrder), f"order = {order!r}", "a ConvergenceOrder or NotDeclared", "it is a number"
    )
    means = "a method that does not converge is NotDeclared"
    require(order.order > 0, f"an order of {order.order!r}", "more than 0", means)


def tells_what_a_step_costs(subject: Subject, world: World) -> None:
    """`step_cost` is a finite time above zero [s], and the same each time that it is asked."""
    subject.build(world.mechanism)
    costs = [subject.engine.step_cost(world.mechanism) for _ in range(2)]
    usable = all(isinstance(cost, int | float) and math.isfinite(cost) and cost > 0 for cost in costs)
    found = f"costs of {costs[0]!r} and {costs[1]!r}"
    require(usable and costs[0] == costs[1], found, "one finite time above zero", "it is measured")


def tells_who_holds_a_joint(subject: Subject, world: World) -> None:
    """`holder` says of every joint who holds it, in the words of the contract."""
    subject.build(world.mechanism)
    expected = " or ".join(repr(word) for word in get_args(Enforcement))
    for joint in world.mechanism.joints:
        holder = subject.engine.enforcement(joint, world.mechanism)
        found = f"{holder!r} for a {type(joint).__name__}"
        require(holder in get_args(Enforcement), found, expected, "a kind of joint is forgotten")


def tells_how_joints_give_way(subject: Subject, world: World) -> None:
    """`softness` gives None, or a Regularisation of finite numbers for every row of the mechanism."""
    subject.build(world.mechanism)
    soft = subject.engine.regularisation(world.mechanism, STEP)
    if soft is None:
        return
    if not isinstance(soft, Regularisation):
        raise Fails(f"softness = {soft!r}", "a Regularisation or None", "it is the engine's own setting")
    for name, least in (("stiffness", 0.0), ("damping", 0.0), ("compliance", -math.inf)):
        value = getattr(soft, name)
        sound = math.isfinite(value) and value > least and value >= 0
        expected = "a finite number, above zero but for the compliance"
        require(sound, f"{name} = {value!r}", expected, "units are mixed up")
    count, rows = len(soft.rows), world.mechanism.row_count
    require(count == rows, f"{count} rows", f"{rows}", "it counts joints")


def tells_the_steps_of_its_runs(subject: Subject, world: World) -> None:
    """`inner_steps` gives the step of each run, in parts of dt: above zero, and finite."""
    subject.build(world.mechanism)
    steps = subject.engine.inner_steps(world.mechanism)
    sound = isinstance(steps, tuple) and steps and all(math.isfinite(step) and step > 0 for step in steps)
    require(bool(sound), f"steps of runs {steps!r}", "a tuple of parts of dt", "it counts runs")


def builds_or_refuses(subject: Subject, world: World) -> None:
    """A mechanism is built, or refused by Unsupported with one sentence that says why."""
    try:
        subject.build(world.mechanism)
    except Unsupported as reason:
        require_a_sentence(str(reason), world.name)
        raise


def builds_at_least_one(subject: Subject) -> None:
    """At least one of the mechanisms of these checks is built, or nothing is checked at all."""
    require(
        _first_built(subject) is not None,
        "a refusal of every one of them",
        "a run of one",
        "a package that the engine needs is not installed, or it is made for mechanisms of another kind",
    )


def refuses_odd_mechanisms(subject: Subject) -> None:
    """Joints that hold twice, bodies that nothing holds and joints between moving bodies are built or refused too."""
    for name, mechanism in ODD.items():
        try:
            stepped(subject.build(mechanism), 2, 1)
        except Unsupported as reason:
            require_a_sentence(str(reason), name)
        except Fails as failure:
            raise Fails(
                f"with {name}: {failure.__cause__!r}",
                "a run, or Unsupported with a sentence",
                "a mechanism that can't be built is not looked for before it is built",
            ) from failure


def refuses_bad_steps(subject: Subject) -> None:
    """A step that is not a finite time above zero is a ValueError that names dt."""
    mechanism = any_built(subject)
    for value in BAD_STEPS:
        _refused("dt", value, lambda value=value: subject.engine.build(mechanism, value))


def refuses_bad_counts(subject: Subject) -> None:
    """Counts of samples and of steps that are not whole numbers above zero are a ValueError that names them."""
    mechanism = any_built(subject)
    for value in BAD_COUNTS:
        for name, counts in (("samples", (value, 1)), ("every", (2, value))):
            run = subject.build(mechanism)
            _refused(name, value, lambda counts=counts, run=run: run(*counts))


def _refused(name: str, value: Any, call: Callable[[], Any]) -> None:
    means = "the value is not looked at, or by the engine's own code, which may abort the process for others"
    try:
        call()
    except ValueError as error:
        found = f"{name} = {value!r} refused with {error!s}"
        require(name in str(error), found, f"a message with {name}", "another value is named")
    except Exception as error:
        raise Fails(f"{type(error).__name__}: {error} for {name} = {value!r}", "a ValueError", means) from error
    else:
        raise Fails(f"{name} = {value!r} taken", "a ValueError", means)


def _first_built(subject: Subject) -> Mechanism | None:
    """The first mechanism that the engine builds; None if it builds none."""
    for world in (*MOVING, *WORLDS):
        with suppress(Unsupported, Fails):  # how it fails is another check's
            subject.build(world.mechanism)
            return world.mechanism
    return None


def any_built(subject: Subject) -> Mechanism:
    """The same; raises NotAsked if it builds none."""
    mechanism = _first_built(subject)
    if mechanism is None:
        raise NotAsked("the engine builds none of the mechanisms of these checks")
    return mechanism


def refuses_a_second_call(subject: Subject) -> None:
    """A run is one shot: a second call is refused, not continued from where the first one ended."""
    run = subject.build(any_built(subject))
    first = stepped(run, 2, 1)
    try:
        second = run(2, 1)
    except Exception:
        return
    same = (second.pose == first.pose).all()
    raise Fails(
        f"a second call that {'starts anew' if same else 'goes on'}",
        "an exception that says to build again",
        "the model keeps its state after a run, and what calls it twice takes the end of one motion for a start",
    )


def _odd() -> dict[str, Mechanism]:
    """Mechanisms that are valid and that an engine may not have thought of."""
    nowhere = (0.0, 0.0)
    left, right, still = (
        Body(name, 1.0, 0.1, (x, 0.0, 0.0), (0.0, 0.0, spin))
        for name, x, spin in (("left", 0.0, 0.5), ("right", 1.0, 0.5), ("left", 0.0, 0.0))
    )
    hinge, other = Pin("hinge", None, "left", nowhere, nowhere), Pin("other", None, "right", (1.0, 0.0), nowhere)
    beside = Body("right", 1.0, 0.1, (1.0, 0.0, 0.0), (0.0, 0.5, 0.5))  # moves with the left body's rotation
    rim = Roll("rim", "left", "right", rolling(Circle(0.5), 0.5, 0.0, 0.0))  # on the left body's rim
    wheel, axle = Body("left", 1.0, 0.1, (0.0, 0.3, 0.0)), Pin("hinge", None, "left", (0.0, 0.3), nowhere)
    level, upright = (
        Slot(name, None, "left", nowhere, line, nowhere) for name, line in (("x", 0.0), ("y", math.pi / 2))
    )
    motor, second = (Drive(name, None, "left", 0.5, 0.0) for name in ("motor", "second"))
    belt = Drive("belt", "left", "right", 0.0, 0.0)
    front, rear = (Skate(name, None, "left", (x, 0.0)) for name, x in (("front", 0.5), ("rear", -0.5)))
    cases: dict[str, tuple[tuple[Body, ...], tuple[Joint, ...]]] = {
        "no joint": ((left,), ()),
        "one body that nothing holds": ((left, right), (hinge,)),
        "a pin between free bodies": ((left, beside), (Pin("B", "left", "right", (0.5, 0.0), (-0.5, 0.0)),)),
        "a pin held twice": ((left,), (hinge, Pin("again", None, "left", nowhere, nowhere))),
        "a drive of a free body": ((left,), (motor,)),
        "two drives of one body": ((left,), (hinge, motor, second)),
        "a drive between two cranks": ((left, right), (hinge, other, belt)),
        "a drive of a body against a free one": ((left, right), (belt,)),
        "a slot that a body carries past a fixed point": (
            (still,),
            (Slot("guide", "left", None, nowhere, 0.0, (0.3, 0.0)),),
        ),
        "two crossed slots at one point": ((left,), (level, upright)),
        "a skate on a moving body": ((left, beside), (Skate("blade", "left", "right", nowhere),)),
        "two skates on one body": ((still,), (front, rear)),
        "a skate on a hinged body": ((still,), (hinge, front)),
        "a disc that rolls on a moving body": ((still, Body("right", 1.0, 0.1, (1.0, 0.0, 0.0))), (hinge, rim)),
        "a hinged disc that rolls": ((wheel,), (Roll("rim", None, "left", rolling(Line(), 0.3, 0.0, 0.0)), axle)),
        "a mass of a milligram": (
            (Body("left", 1e-6, 1e-9, (0.0, 0.0, 0.0), (0.0, 0.0, 0.5)), right),
            (hinge, other),
        ),
    }
    return {name: Mechanism(*parts, gravity=(0.0, -10.0)) for name, parts in cases.items()}


ODD = _odd()
CHECKS = (
    Check(builds_or_refuses, (*WORLDS, SPINNING)),
    Check(builds_at_least_one),
    Check(refuses_odd_mechanisms),
    Check(refuses_bad_steps),
    Check(refuses_bad_counts),
    Check(refuses_a_second_call),
    Check(has_a_name),
    Check(is_a_frozen_dataclass),
    Check(can_be_hashed),
    Check(can_be_pickled),
    Check(names_its_packages),
    Check(has_the_right_shapes, WORLDS),
    Check(tells_the_size_of_its_model, WORLDS),
    Check(promises_an_order, WORLDS),
    Check(tells_what_a_step_costs, WORLDS),
    Check(tells_who_holds_a_joint, WORLDS),
    Check(tells_how_joints_give_way, WORLDS),
    Check(tells_the_steps_of_its_runs, WORLDS),
)
