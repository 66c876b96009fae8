"""Checks of an engine's declarations (name, settings, packages, orders, costs, enforcement) and of its refusals.

An engine refuses a mechanism by Unsupported with a sentence, and a value by a ValueError that names it.
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
    CHECK_SAMPLES,
    CHECK_STEP,
    CheckedEngine,
    ConformanceCheck,
    Fails,
    NotApplicable,
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

COPY_TOLERANCE = 1e-9  # for equal motions; `gives_the_same_bits` checks for equal bits
ADDRESS = re.compile(r" at 0x[0-9a-f]+", re.IGNORECASE)
BAD_STEPS: tuple[Any, ...] = (0.0, -0.01, math.nan, math.inf, "0.01", None, True)
BAD_COUNTS: tuple[Any, ...] = (0, -1, 1.5, math.nan, "2", None, True)


def has_a_name(subject: CheckedEngine) -> None:
    """`name`, `variant` and `family` are strings that can be printed in one line."""
    for name in ("name", "variant", "family"):
        value = getattr(subject.engine, name, None)
        valid = isinstance(value, str) and bool(value.strip()) and value.isprintable()
        expected = "a string that is not empty and can be printed"
        require(valid, f"{name} = {value!r}", expected, "it is made from a setting")


def is_a_frozen_dataclass(subject: CheckedEngine) -> None:
    """An engine is a frozen dataclass whose repr shows all its settings, in one line and without addresses."""
    engine: Any = subject.engine
    frozen = dataclasses.is_dataclass(engine) and type(engine).__dataclass_params__.frozen  # type: ignore[attr-defined]
    found = f"a {type(engine).__name__} that can be changed"
    require(frozen, found, "a frozen dataclass", "frozen=True is left out")
    representation = repr(engine)
    settings = {field.name: getattr(engine, field.name) for field in dataclasses.fields(engine)}
    hidden = [name for name, value in settings.items() if f"{name}={value!r}" not in representation]
    require(
        not hidden and representation.isprintable() and not ADDRESS.search(representation),
        f"the repr {representation!r}" + (f" without {', '.join(hidden)}" if hidden else ""),
        "every setting, so that equal reprs are equal engines",
        "a setting is an object without a repr of its own, or has repr=False",
    )


def can_be_hashed(subject: CheckedEngine) -> None:
    """An engine has a hash and equals itself."""
    try:
        hash(subject.engine)
    except TypeError as error:
        raise Fails(str(error), "a hash", "a setting is a list or an array instead of a tuple") from error
    equal = subject.engine == subject.engine
    require(equal, "an engine that differs from itself", "equality", "a setting is NaN")


def can_be_pickled(subject: CheckedEngine) -> None:
    """The copy of an engine by pickle is equal to it, with the same repr and the same motion."""
    try:
        copy = pickle.loads(pickle.dumps(subject.engine))
    except Exception as error:
        raise Fails(
            f"{type(error).__name__}: {error}",
            "a copy by pickle",
            "its class is defined in a function, or a setting is a function or holds an object of the engine",
        ) from error
    means = "state that is not in the fields is lost, or is created with other values"
    equal = copy == subject.engine and repr(copy) == repr(subject.engine)
    require(equal, f"a copy {copy!r}", repr(subject.engine), means)
    mechanism = any_built(subject)
    original, copied = (stepped(checked.build(mechanism), 3, 1) for checked in (subject, CheckedEngine(copy)))
    same = np.allclose(original.pose, copied.pose, rtol=0, atol=COPY_TOLERANCE)
    require(same, "another motion of the copy", "the same one", means)


def names_its_packages(subject: CheckedEngine) -> None:
    """`packages` is a tuple of the names of installed packages of Python or npm."""
    packages = getattr(subject.engine, "packages", None)
    if not (isinstance(packages, tuple) and all(isinstance(name, str) for name in packages)):
        raise Fails(f"packages = {packages!r}", "a tuple of strings", "a comma is missing in a tuple of one")
    for name in packages:
        try:
            installed_version(name)
        except Exception as error:
            expected, means = "the name under which it was installed", "it is the name by which it is imported"
            raise Fails(f"{name!r}, which is not installed", expected, means) from error


def has_the_right_shapes(subject: CheckedEngine, world: World) -> None:
    """A run returns a Trajectory of samples + 1 states with the shapes of bodies and rows."""
    if flaw := flaw_of_shapes(subject.run(world.mechanism), world.mechanism, CHECK_SAMPLES):
        raise Fails(*flaw, "the start is missing or counted twice, or an argument is at the wrong position")


def tells_the_size_of_its_model(subject: CheckedEngine, world: World) -> None:
    """The `size` of a model is a Size of counts that are not below zero."""
    size = getattr(subject.build(world.mechanism), "size", None)
    require(isinstance(size, Size), f"size = {size!r}", "a Size", "the run has no property of that name")
    for name, value in vars(size).items():
        valid = type(value) is int and value >= 0
        require(valid, f"size.{name} = {value!r}", "a count", "it is not converted from a type of the engine")


def promises_an_order(subject: CheckedEngine, world: World) -> None:
    """`order` returns a ConvergenceOrder, or NotDeclared with one sentence that says why."""
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


def tells_what_a_step_costs(subject: CheckedEngine, world: World) -> None:
    """`step_cost` is a finite time above zero [s] and the same in each call."""
    subject.build(world.mechanism)
    costs = [subject.engine.step_cost(world.mechanism) for _ in range(2)]
    usable = all(isinstance(cost, int | float) and math.isfinite(cost) and cost > 0 for cost in costs)
    found = f"costs of {costs[0]!r} and {costs[1]!r}"
    require(usable and costs[0] == costs[1], found, "one finite time above zero", "it is measured")


def tells_who_holds_a_joint(subject: CheckedEngine, world: World) -> None:
    """`enforcement` of each joint is one of the values in the contract."""
    subject.build(world.mechanism)
    expected = " or ".join(repr(word) for word in get_args(Enforcement))
    for joint in world.mechanism.joints:
        enforcement = subject.engine.enforcement(joint, world.mechanism)
        found = f"{enforcement!r} for a {type(joint).__name__}"
        require(enforcement in get_args(Enforcement), found, expected, "a kind of joint is forgotten")


def tells_how_joints_give_way(subject: CheckedEngine, world: World) -> None:
    """`regularisation` returns None, or a Regularisation of finite numbers with a flag for each row."""
    subject.build(world.mechanism)
    regularisation = subject.engine.regularisation(world.mechanism, CHECK_STEP)
    if regularisation is None:
        return
    if not isinstance(regularisation, Regularisation):
        found = f"regularisation = {regularisation!r}"
        raise Fails(found, "a Regularisation or None", "it is the engine's own setting")
    for name, least in (("stiffness", 0.0), ("damping", 0.0), ("compliance", -math.inf)):
        value = getattr(regularisation, name)
        valid = math.isfinite(value) and value > least and value >= 0
        expected = "a finite number above zero; a compliance may be zero"
        require(valid, f"{name} = {value!r}", expected, "units are confused")
    count, rows = len(regularisation.rows), world.mechanism.row_count
    require(count == rows, f"{count} rows", f"{rows}", "it counts joints")


def tells_the_steps_of_its_runs(subject: CheckedEngine, world: World) -> None:
    """`inner_steps` returns the step of each run as a fraction of dt, finite and above zero."""
    subject.build(world.mechanism)
    steps = subject.engine.inner_steps(world.mechanism)
    valid = isinstance(steps, tuple) and steps and all(math.isfinite(step) and step > 0 for step in steps)
    require(bool(valid), f"inner_steps = {steps!r}", "a tuple of fractions of dt", "it counts runs")


def builds_or_refuses(subject: CheckedEngine, world: World) -> None:
    """A mechanism is built, or Unsupported is raised with one sentence that says why."""
    try:
        subject.build(world.mechanism)
    except Unsupported as reason:
        require_a_sentence(str(reason), world.name)
        raise


def builds_at_least_one(subject: CheckedEngine) -> None:
    """At least one mechanism of these checks is built, since otherwise no motion is checked."""
    require(
        _first_built(subject) is not None,
        "a refusal of all mechanisms",
        "a run of one",
        "a package that the engine needs is not installed, or the engine is for mechanisms of another kind",
    )


def refuses_odd_mechanisms(subject: CheckedEngine) -> None:
    """Redundant joints, free bodies and joints between moving bodies are built or refused by Unsupported."""
    for name, mechanism in ODD.items():
        try:
            stepped(subject.build(mechanism), 2, 1)
        except Unsupported as reason:
            require_a_sentence(str(reason), name)
        except Fails as failure:
            raise Fails(
                f"with {name}: {failure.__cause__!r}",
                "a run, or Unsupported with a sentence",
                "the engine does not refuse a mechanism before it builds it",
            ) from failure


def refuses_bad_steps(subject: CheckedEngine) -> None:
    """A step that is not a finite time above zero raises a ValueError that names dt."""
    mechanism = any_built(subject)
    for value in BAD_STEPS:
        _refused("dt", value, lambda value=value: subject.engine.build(mechanism, value))


def refuses_bad_counts(subject: CheckedEngine) -> None:
    """A count of samples or steps that is not a whole number above zero raises a ValueError that names it."""
    mechanism = any_built(subject)
    for value in BAD_COUNTS:
        for name, counts in (("samples", (value, 1)), ("every", (2, value))):
            run = subject.build(mechanism)
            _refused(name, value, lambda counts=counts, run=run: run(*counts))


def _refused(name: str, value: Any, call: Callable[[], Any]) -> None:
    means = "the value is not checked before the engine's code gets it, which may abort the process"
    try:
        call()
    except ValueError as error:
        found = f"{name} = {value!r} refused with {error!s}"
        require(name in str(error), found, f"a message with {name}", "another value is named")
    except Exception as error:
        raise Fails(f"{type(error).__name__}: {error} for {name} = {value!r}", "a ValueError", means) from error
    else:
        raise Fails(f"{name} = {value!r} accepted", "a ValueError", means)


def _first_built(subject: CheckedEngine) -> Mechanism | None:
    for world in (*MOVING, *WORLDS):
        with suppress(Unsupported, Fails):
            subject.build(world.mechanism)
            return world.mechanism
    return None


def any_built(subject: CheckedEngine) -> Mechanism:
    """The first mechanism that the engine builds; raises NotApplicable if it builds none."""
    mechanism = _first_built(subject)
    if mechanism is None:
        raise NotApplicable("the engine builds none of the mechanisms of these checks")
    return mechanism


def refuses_a_second_call(subject: CheckedEngine) -> None:
    """A second call of a run raises an exception."""
    run = subject.build(any_built(subject))
    first = stepped(run, 2, 1)
    try:
        second = run(2, 1)
    except Exception:
        return
    same = (second.pose == first.pose).all()
    raise Fails(
        f"a second call that {'repeats the motion' if same else 'continues the motion'}",
        "an exception that says to build again",
        "the model has the final state of the first run, which the caller would take for a start",
    )


def _odd() -> dict[str, Mechanism]:
    nowhere = (0.0, 0.0)
    left, right, still = (
        Body(name, 1.0, 0.1, (x, 0.0, 0.0), (0.0, 0.0, spin))
        for name, x, spin in (("left", 0.0, 0.5), ("right", 1.0, 0.5), ("left", 0.0, 0.0))
    )
    hinge, other = Pin("hinge", None, "left", nowhere, nowhere), Pin("other", None, "right", (1.0, 0.0), nowhere)
    beside = Body("right", 1.0, 0.1, (1.0, 0.0, 0.0), (0.0, 0.5, 0.5))  # It moves as a part of the left body.
    rim = Roll("rim", "left", "right", rolling(Circle(0.5), 0.5, 0.0, 0.0))  # The roll is on the left body's rim.
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
        "a mass of a milligram": ((Body("left", 1e-6, 1e-9, (0.0, 0.0, 0.0), (0.0, 0.0, 0.5)), right), (hinge, other)),
    }
    return {name: Mechanism(*parts, gravity=(0.0, -10.0)) for name, parts in cases.items()}


ODD = _odd()
CHECKS = tuple(
    ConformanceCheck(function, worlds)
    for worlds, functions in (
        ((*WORLDS, SPINNING), (builds_or_refuses,)),
        ((), (builds_at_least_one, refuses_odd_mechanisms, refuses_bad_steps, refuses_bad_counts)),
        ((), (refuses_a_second_call, has_a_name, is_a_frozen_dataclass, can_be_hashed, can_be_pickled)),
        ((), (names_its_packages,)),
        (WORLDS, (has_the_right_shapes, tells_the_size_of_its_model, promises_an_order, tells_what_a_step_costs)),
        (WORLDS, (tells_who_holds_a_joint, tells_how_joints_give_way, tells_the_steps_of_its_runs)),
    )
    for function in functions
)
