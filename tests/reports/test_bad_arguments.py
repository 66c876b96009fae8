"""A bad argument is refused with a sentence that names it; valid values of other types are accepted."""

from __future__ import annotations

import dataclasses
import math
from array import array
from collections import deque
from typing import Any

import numpy as np
import pytest

from engines import registry
from engines.extrapolated import Extrapolated
from engines.lagrange import Lagrange
from reference.chapter.skates import park
from reference.checks import (
    Count,
    Fraction,
    InvalidMechanism,
    Name,
    NonNegative,
    Positive,
    Sign,
    Signs,
    Times,
    validate,
    validated,
)
from reference.joints import Gear, Pin
from reference.mechanism import Body
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.linkage import FourBar
from reference.validators import Array
from reports.model.cells import Cell
from tests.mechanisms import SCENES_OF_LIMITS, four_bar

NO_NUMBERS = [None, object(), {}, "1.5", b"1", 1 + 2j, True, np.bool_(False), [1.0], np.array([1.0, 2.0]), 10**400]
NOT_FINITE = [math.nan, math.inf, np.float32("inf")]
NO_ARRAYS = ["abc", ["1.5"], [1.0, None], [[1.0], [1.0, 2.0]], np.array([object()]), {1.0}, iter([1.0]), 1j]
# Kind of argument -> (annotation, refused values, accepted values).
KINDS = [
    (float, [*NO_NUMBERS, *NOT_FINITE, np.timedelta64(1, "s")], [0.5, 1, np.float32(0.5), np.array(0.5)]),
    (int, [*NO_NUMBERS[:-1], *NOT_FINITE, 2.0, np.float64(2.0)], [1, np.int32(1), np.array(1)]),
    (bool, [None, 0, 1, "True", np.float64(1.0)], [True, np.bool_(True)]),
    (str, [None, 3, b"abc", ["abc"]], ["abc", np.str_("abc")]),
    (Positive, [*NO_NUMBERS, *NOT_FINITE, 0, -1e-300, -(10**400)], [5e-324]),
    (NonNegative, [*NOT_FINITE, -5e-324], [0.0]),
    (Fraction, [*NOT_FINITE, -1e-9, 1 + 1e-9], [0, 1]),
    (Count, [*NO_NUMBERS, 0, -1, 2**31, np.uint64(2**63), 1.5], [1, 2**31 - 1]),
    (Sign, [0, 2, -2, 1.0], [1, -1]),
    (Signs, [0, [1, 0], 0.5], [1, [1, -1]]),
    (Name, ["", " ", "a\nb", "\x00", 3], ["b"]),
    (Array, [*NO_ARRAYS, *NOT_FINITE, [1.0, math.nan]], [0.5, [1, 2], array("d", [1.0]), deque([1.0])]),
    (Times, [*NO_ARRAYS, *NOT_FINITE, -1.0, [0.0, -1e-9], [[0.0, 1.0]]], [0.5, [0.0, 1.0], []]),
]


@pytest.mark.parametrize(("annotation", "refused", "taken"), KINDS, ids=lambda value: str(value)[:20])
def test_every_kind_of_argument_has_its_bounds(annotation, refused, taken):
    for value in taken:
        np.testing.assert_array_equal(validate("test", "value", value, annotation), np.asarray(value))
    for value in refused:
        with pytest.raises(InvalidMechanism, match=r"^test: value is .*must be"):
            validate("test", "value", value, annotation)


POINTS = ((0.0, 0.5), (1.0, 0.0))
# Case -> (call with one free argument, name of this argument, a bad value).
MISTAKES: dict[str, tuple[Any, str, Any]] = {
    "mass of zero": (lambda value: Body("b", value, 1.0, (0.0, 0.0, 0.0)), "mass", 0.0),
    "pose without an angle": (lambda value: Body("b", 1.0, 1.0, value), "pose", (0.0, 0.0)),
    "point in space": (lambda value: Pin("p", None, "b", value, POINTS[1]), "first_point", (0.0, 0.0, 0.0)),
    "ratio that is not a number": (lambda value: Gear("g", "a", "b", value, 0.5), "ratio", math.nan),
    "unknown method": (lambda value: Lagrange(value), "integrator", "rk5"),
    "tolerance of zero": (lambda value: Lagrange("dop853", "projection", value), "tolerance", 0.0),
    "no name of a variant": (lambda value: Extrapolated(Lagrange(), value, (1, 2), (1,)), "variant", ""),
    "step as a fraction of samples": (lambda value: Cell(SCENES[0], Lagrange(), value), "every", 0.5),
    "start without an angle": (lambda value: park(value, (0.0, 0.0, 0.0)), "start", (0.0, 0.0)),
    "branch of zero": (lambda value: FourBar(0.4, 0.5, 0.6, (0.5, 0.0)).angles(1.0, value), "branch", 0),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_at_a_public_entry_point_is_refused_with_the_name_of_the_argument(mistake):
    call, name, value = MISTAKES[mistake]
    with pytest.raises(InvalidMechanism, match=rf"\b{name} is .*must be"):
        call(value)


@validated
def halves(mass: Positive, /, count: Count = 1, *, share: Fraction = 0.5) -> float:
    return mass * share / count


def test_arguments_passed_by_name_are_checked_as_those_passed_by_position():
    assert halves(2.0, count=2, share=1) == 1.0
    for call in (lambda: halves(-1.0), lambda: halves(1.0, count=0), lambda: halves(1.0, share=math.nan)):
        with pytest.raises(InvalidMechanism, match=r"halves: \w+ is"):
            call()


def test_lists_and_numbers_of_numpy_are_accepted():
    linkage = FourBar(0.4, np.float64(0.5), 0.6, [0.5, 0])  # type: ignore[arg-type]
    assert repr(linkage) == "FourBar(crank=0.4, coupler=0.5, rocker=0.6, ground=(0.5, 0.0))"
    assert linkage.angles([1.0], np.int64(1))[0] == linkage.angles(1.0)[0]
    assert park([0, 0, 0], np.array([1, 1, 0])) == park((0.0, 0.0, 0.0), (1.0, 1.0, 0.0))  # type: ignore[arg-type]
    cell = Cell(SCENES[0], registry.ENGINES[0], np.int64(3), samples=np.int64(2))  # type: ignore[arg-type]
    assert (type(cell.every), type(cell.samples)) == (int, int)
    plain = Body("b", 1.0, 2.0, (0.0, 1.0, 2.0))
    members = [0.0, 1.0, 2.0]
    for pose in (members, np.array(members)):
        assert repr(dataclasses.replace(plain, pose=pose)) == repr(plain)  # type: ignore[arg-type]


ONE_OF_EACH = {engine.name: engine for engine in registry.ENGINES}.values()


@pytest.mark.parametrize("engine", [*ONE_OF_EACH, Extrapolated(registry.ENGINES[0], "e", (1, 2), (1,))])
def test_every_engine_accepts_steps_and_counts_of_numpy_and_refuses_bad_ones(engine):
    mechanism = four_bar()
    plain = engine.build(mechanism, 0.0009765625)(2, 1)
    build: Any = engine.build  # the types of these arguments are wrong on purpose
    numpys = build(mechanism, np.float32(0.0009765625))(np.int64(2), np.int32(1))
    np.testing.assert_array_equal(plain.pose, numpys.pose)
    for wrong in (True, "1e-3", None, math.nan, 0.0, -1e-3):
        with pytest.raises(InvalidMechanism, match=r"dt is .*must be a finite number greater than zero"):
            build(mechanism, wrong)
    with pytest.raises(InvalidMechanism, match=r"mechanism is .*must be a Mechanism"):
        build(SCENES[0], 1e-3)
    run = build(mechanism, 1e-3)
    for wrong in (True, 2.0, None, 0, 2**31):
        with pytest.raises(InvalidMechanism, match=r"samples is .*must be a whole number from 1"):
            run(wrong, 1)
        with pytest.raises(InvalidMechanism, match=r"every is .*must be a whole number from 1"):
            run(1, wrong)


@pytest.mark.parametrize("scene", [*SCENES, *SCENES_OF_LIMITS], ids=lambda scene: scene.name)
def test_a_scene_refuses_invalid_times_and_poses(scene):
    for times in ([math.inf], [-1.0], "abc", None, [[0.0, 0.1]], [True]):
        with pytest.raises(InvalidMechanism, match=f"scene '{scene.name}': t is .*must be finite numbers in one row"):
            scene.motion(times)
    for times in ([1e16], [0.0, 1e6]):
        with pytest.raises(InvalidMechanism, match=r"known up to .* times its duration"):
            scene.motion(times)
    bodies = len(scene.mechanism().bodies)
    for count in (0, bodies - 1, bodies + 1):
        with pytest.raises(InvalidMechanism, match=f"pose is of {count} bodies; it must be of {bodies}"):
            scene.branch_of(np.zeros((4, count, 3)))
    at_one_time, at_no_time = scene.motion(0), scene.motion([])
    for name in ("t", "pose", "twist", "reaction"):
        assert getattr(at_one_time, name).shape[0] == 1
        assert getattr(at_no_time, name).shape == (0, *getattr(at_one_time, name).shape[1:])


def test_a_long_value_is_shortened_in_the_message():
    for value in (np.zeros(1000), 10**5000, "x" * 1000):
        with pytest.raises(InvalidMechanism, match="Body 'b': mass is ") as refusal:
            Body("b", value, 1.0, (0.0, 0.0, 0.0))  # type: ignore[arg-type]
        assert len(str(refusal.value)) < 200
