"""Checks of what an engine says of itself: its name, settings, packages, promises, costs, and who holds a joint."""

from __future__ import annotations

import dataclasses
import importlib.metadata
import math
import pickle
import re
from typing import Any, get_args

import numpy as np

from engines import Holder, Promise, Softness, Unpromised
from engines.conformance.check import STEP, Check, Fails, Subject, require_a_sentence, stepped
from engines.conformance.refusing import any_built
from engines.conformance.worlds import WORLDS, World

SAME = 1e-9  # whether two runs agree to the last bit is another check's
ADDRESS = re.compile(r" at 0x[0-9a-f]+", re.IGNORECASE)


def has_a_name(subject: Subject) -> None:
    """`name`, `variant` and `family` are words that can be printed in one line."""
    for name in ("name", "variant", "family"):
        value = getattr(subject.engine, name, None)
        if not (isinstance(value, str) and value.strip() and value.isprintable()):
            raise Fails(
                f"{name} = {value!r}", "a string that is not empty and can be printed", "it is made from a setting"
            )


def is_a_frozen_dataclass(subject: Subject) -> None:
    """An engine is a frozen dataclass whose repr shows all its settings, in one line and without addresses."""
    engine: Any = subject.engine
    if not (dataclasses.is_dataclass(engine) and type(engine).__dataclass_params__.frozen):  # type: ignore[attr-defined]
        raise Fails(f"a {type(engine).__name__} that can be changed", "a frozen dataclass", "frozen=True is left out")
    shown = repr(engine)
    settings = {field.name: getattr(engine, field.name) for field in dataclasses.fields(engine)}
    hidden = [name for name, value in settings.items() if f"{name}={value!r}" not in shown]
    if hidden or not shown.isprintable() or ADDRESS.search(shown):
        raise Fails(
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
    if subject.engine != subject.engine:
        raise Fails("an engine that differs from itself", "equality", "a setting is NaN")


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
    if copy != subject.engine or repr(copy) != repr(subject.engine):
        raise Fails(f"a copy {copy!r}", repr(subject.engine), means)
    mechanism = any_built(subject)
    here, there = (stepped(each.build(mechanism), 3, 1) for each in (subject, Subject(copy)))
    if not np.allclose(here.pose, there.pose, rtol=0, atol=SAME):
        raise Fails("another motion of the copy", "the same one", means)


def names_its_packages(subject: Subject) -> None:
    """`packages` is a tuple of installed distributions, whose versions are printed under the numbers."""
    packages = getattr(subject.engine, "packages", None)
    if not (isinstance(packages, tuple) and all(isinstance(name, str) for name in packages)):
        raise Fails(f"packages = {packages!r}", "a tuple of strings", "a comma is missing in a tuple of one")
    for name in packages:
        try:
            importlib.metadata.version(name)
        except Exception as error:
            raise Fails(
                f"{name!r}, which is not installed",
                "the name under which it was installed",
                "it is the name by which it is imported",
            ) from error


def promises_an_order(subject: Subject, world: World) -> None:
    """`order` gives a Promise, or Unpromised with one sentence that says why."""
    subject.build(world.mechanism)
    order = subject.engine.order(world.mechanism)
    if isinstance(order, Unpromised):
        require_a_sentence(str(order.reason), "Unpromised")
        return
    if not isinstance(order, Promise):
        raise Fails(f"order = {order!r}", "a Promise or Unpromised", "it is a number")
    if not order.order > 0:
        raise Fails(f"an order of {order.order!r}", "more than 0", "a method that does not converge is Unpromised")


def tells_what_a_step_costs(subject: Subject, world: World) -> None:
    """`step_cost` is a finite time above zero [s], and the same each time that it is asked."""
    subject.build(world.mechanism)
    costs = [subject.engine.step_cost(world.mechanism) for _ in range(2)]
    usable = all(isinstance(cost, int | float) and math.isfinite(cost) and cost > 0 for cost in costs)
    if not (usable and costs[0] == costs[1]):
        raise Fails(f"costs of {costs[0]!r} and {costs[1]!r}", "one finite time above zero", "it is measured")


def tells_who_holds_a_joint(subject: Subject, world: World) -> None:
    """`holder` says of every joint who holds it, in the words of the contract."""
    subject.build(world.mechanism)
    for joint in world.mechanism.joints:
        found = subject.engine.holder(joint, world.mechanism)
        if found not in get_args(Holder):
            raise Fails(
                f"{found!r} for a {type(joint).__name__}",
                " or ".join(repr(word) for word in get_args(Holder)),
                "a kind of joint is forgotten",
            )


def tells_how_joints_give_way(subject: Subject, world: World) -> None:
    """`softness` gives None, or a Softness of finite numbers for every row of the mechanism."""
    subject.build(world.mechanism)
    soft = subject.engine.softness(world.mechanism, STEP)
    if soft is None:
        return
    if not isinstance(soft, Softness):
        raise Fails(f"softness = {soft!r}", "a Softness or None", "it is the engine's own setting")
    for name, least in (("stiffness", 0.0), ("damping", 0.0), ("compliance", -math.inf)):
        value = getattr(soft, name)
        if not (math.isfinite(value) and value > least and value >= 0):
            raise Fails(
                f"{name} = {value!r}", "a finite number, above zero but for the compliance", "units are mixed up"
            )
    if len(soft.rows) != world.mechanism.row_count:
        raise Fails(f"{len(soft.rows)} rows", f"{world.mechanism.row_count}", "it counts joints")


def tells_the_steps_of_its_runs(subject: Subject, world: World) -> None:
    """`steps_of_runs` gives the step of each run, in parts of dt: above zero, and finite."""
    subject.build(world.mechanism)
    steps = subject.engine.steps_of_runs(world.mechanism)
    if not (isinstance(steps, tuple) and steps and all(math.isfinite(step) and step > 0 for step in steps)):
        raise Fails(f"steps of runs {steps!r}", "a tuple of parts of dt", "it counts runs")


CHECKS = (
    Check(has_a_name),
    Check(is_a_frozen_dataclass),
    Check(can_be_hashed),
    Check(can_be_pickled),
    Check(names_its_packages),
    Check(promises_an_order, WORLDS),
    Check(tells_what_a_step_costs, WORLDS),
    Check(tells_who_holds_a_joint, WORLDS),
    Check(tells_how_joints_give_way, WORLDS),
    Check(tells_the_steps_of_its_runs, WORLDS),
)
