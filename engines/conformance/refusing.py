"""Checks of refusals: mechanisms by Unsupported with a sentence, values by a ValueError that names them."""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from engines import Unsupported
from engines.conformance.check import Check, Fails, NotAsked, Subject, require_a_sentence, stepped
from engines.conformance.worlds import MOVING, SPINNING, WORLDS, World, rolling
from reference.joints import Drive, Joint, Pin, Skate, Slot
from reference.mechanism import Body, Mechanism
from reference.rolling.curves import Circle, Line
from reference.rolling.roll import Roll

BAD_STEPS: tuple[Any, ...] = (0.0, -0.01, math.nan, math.inf, "0.01", None, True)
BAD_COUNTS: tuple[Any, ...] = (0, -1, 1.5, math.nan, "2", None, True)


def builds_or_refuses(subject: Subject, world: World) -> None:
    """A mechanism is built, or refused by Unsupported with one sentence that says why."""
    try:
        subject.build(world.mechanism)
    except Unsupported as reason:
        require_a_sentence(str(reason), world.name)
        raise


def builds_at_least_one(subject: Subject) -> None:
    """At least one of the mechanisms of these checks is built, or nothing is checked at all."""
    if _first_built(subject) is None:
        raise Fails(
            "a refusal of every one of them",
            "a run of one",
            "a package that the engine needs is not installed, or it is made for mechanisms of another kind",
        )


def refuses_odd_mechanisms(subject: Subject) -> None:
    """Joints that hold twice, bodies that nothing holds and joints between moving bodies are built or refused too."""
    for name, mechanism in ODD.items():
        try:
            run = subject.build(mechanism)
        except Unsupported as reason:
            require_a_sentence(str(reason), name)
            continue
        except Fails as failure:
            raise _of(name, failure) from failure
        try:
            stepped(run, 2, 1)
        except Fails as failure:
            raise _of(name, failure) from failure


def _of(name: str, failure: Fails) -> Fails:
    return Fails(
        f"with {name}: {failure.__cause__!r}",
        "a run, or Unsupported with a sentence",
        "a mechanism that can't be built is not looked for before it is built",
    )


def refuses_bad_steps(subject: Subject) -> None:
    """A step that is not a finite time above zero is a ValueError that names dt."""
    mechanism = any_built(subject)
    for value in BAD_STEPS:
        _refused("dt", value, lambda value=value: subject.engine.build(mechanism, value))


def refuses_bad_counts(subject: Subject) -> None:
    """Counts of samples and of steps that are not whole numbers above zero are a ValueError that names them."""
    mechanism = any_built(subject)
    for value in BAD_COUNTS:
        run = subject.build(mechanism)
        _refused("samples", value, lambda value=value, run=run: run(value, 1))
        run = subject.build(mechanism)
        _refused("every", value, lambda value=value, run=run: run(2, value))


def _refused(name: str, value: Any, ask: Callable[[], Any]) -> None:
    means = "the value is not looked at, or by the engine's own code, which may abort the process for others"
    try:
        ask()
    except ValueError as error:
        if name in str(error):
            return
        raise Fails(
            f"{name} = {value!r} refused with {error!s}", f"a message with {name}", "another value is named"
        ) from None
    except Exception as error:
        raise Fails(f"{type(error).__name__}: {error} for {name} = {value!r}", "a ValueError", means) from error
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
    found = _first_built(subject)
    if found is None:
        raise NotAsked("the engine builds none of the mechanisms of these checks")
    return found


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


def _free(name: str, x: float, spin: float = 0.5) -> Body:
    return Body(name, 1.0, 0.1, (x, 0.0, 0.0), (0.0, 0.0, spin))


def _odd() -> dict[str, Mechanism]:
    """Mechanisms that are valid and that an engine may not have thought of."""
    left, right, still = _free("left", 0.0), _free("right", 1.0), _free("left", 0.0, 0.0)
    hinge, other = (
        Pin("hinge", None, "left", (0.0, 0.0), (0.0, 0.0)),
        Pin("other", None, "right", (1.0, 0.0), (0.0, 0.0)),
    )
    beside = Body("right", 1.0, 0.1, (1.0, 0.0, 0.0), (0.0, 0.5, 0.5))  # moves with the left body's rotation
    wheel = rolling(Circle(0.5), 0.5, 0.0, 0.0)  # on the left body's rim
    cases: dict[str, tuple[tuple[Body, ...], tuple[Joint, ...]]] = {
        "no joint": ((left,), ()),
        "one body that nothing holds": ((left, right), (hinge,)),
        "a pin between free bodies": ((left, beside), (Pin("B", "left", "right", (0.5, 0.0), (-0.5, 0.0)),)),
        "a pin held twice": ((left,), (hinge, Pin("again", None, "left", (0.0, 0.0), (0.0, 0.0)))),
        "a drive of a free body": ((left,), (Drive("motor", None, "left", 0.5, 0.0),)),
        "two drives of one body": (
            (left,),
            (hinge, Drive("motor", None, "left", 0.5, 0.0), Drive("second", None, "left", 0.5, 0.0)),
        ),
        "a drive between two cranks": ((left, right), (hinge, other, Drive("belt", "left", "right", 0.0, 0.0))),
        "a drive of a body against a free one": ((left, right), (Drive("belt", "left", "right", 0.0, 0.0),)),
        "a slot that a body carries past a fixed point": (
            (still,),
            (Slot("guide", "left", None, (0.0, 0.0), 0.0, (0.3, 0.0)),),
        ),
        "two crossed slots at one point": (
            (left,),
            (
                Slot("level", None, "left", (0.0, 0.0), 0.0, (0.0, 0.0)),
                Slot("upright", None, "left", (0.0, 0.0), math.pi / 2, (0.0, 0.0)),
            ),
        ),
        "a skate on a moving body": ((left, beside), (Skate("blade", "left", "right", (0.0, 0.0)),)),
        "two skates on one body": (
            (still,),
            (Skate("front", None, "left", (0.5, 0.0)), Skate("rear", None, "left", (-0.5, 0.0))),
        ),
        "a skate on a hinged body": ((still,), (hinge, Skate("blade", None, "left", (0.5, 0.0)))),
        "a disc that rolls on a moving body": (
            (still, _free("right", 1.0, 0.0)),
            (hinge, Roll("rim", "left", "right", wheel)),
        ),
        "a hinged disc that rolls": (
            (Body("left", 1.0, 0.1, (0.0, 0.3, 0.0)),),
            (
                Roll("rim", None, "left", rolling(Line(), 0.3, 0.0, 0.0)),
                Pin("hinge", None, "left", (0.0, 0.3), (0.0, 0.0)),
            ),
        ),
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
)
