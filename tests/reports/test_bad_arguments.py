"""What can't be meant is refused in a sentence that names it, by everything that users call; what can be is taken."""

from __future__ import annotations

import dataclasses
import faulthandler
import math
import os
import random
import signal
from array import array
from collections import Counter, deque
from typing import Any

import numpy as np
import pytest

from engines import registry
from engines.extrapolated import Extrapolated
from reference.chapter.parking import park
from reference.checks import Count, Fraction, InvalidMechanism, NonNegative, Positive, Valid, take, validated
from reference.mechanism import Body
from reference.scene import Scene
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.linkage import FourBar, Unreachable
from reference.scenes.four_bar.scenes import OverdrivenFourBar
from reports.model.cells import Cell
from tests.arguments import Trial, dataclasses_of_the_suite, functions_of_the_suite, trials
from tests.mechanisms import four_bar
from tests.samples import INSTANCES, SCENES_OF_LIMITS

TRIED = 2000
# Dataclasses that users don't make: what the suite gives back or uses inside, and the catalogue of errata.
NOT_MADE_BY_USERS = {
    f"{module}.{name}"
    for module, names in {
        "reference.chapter.errata.catalogue": "WordSlip",
        "reference.chapter.errata.erratum": "Values Erratum",
        "reference.chapter.errata.linkages": "BarState TwoPoints",
        "reference.scenes.four_bar.closed_form": "Constants",
        "reference.kinds": "Rule Kind",
        "reference.rows": "JointGroup JointRows",
        "reference.forces": "ForceGroup AppliedForces",
        "reference.numerics.integration": "Integrated",
        "reference.numerics.windows": "Windows InDouble",
        "reference.scenes.pendulum.joint_forces": "JointForces",
        "reports.gate.change": "Altered",
        "engines.capability": "Capability",
        "engines.contract": "Size Softness Promise Unpromised",
        "engines.pymunk.contraction": "Sweeping",
        "engines.loading": "Kind",
        "engines.entry_points": "Registered",
        "engines.lagrange.machine": "Machine",
        "engines.lagrange.arrays": "Arrays",
        "reference.rolling.contact": "Contact",
        "reference.scenes.wheels.trailers": "Convoy",
        "engines.mujoco.construction": "Hooks Building WrittenJoint",
        "engines.mujoco.model": "Model Settings",
        "engines.pymunk.running": "Recording",
        "engines.mujoco.joints.drive": "DrivenCoordinate",
        "engines.mujoco.running": "MuJoCoRun",
        "engines.tree": "Link Tree",
        "engines.pymunk.joints.drive": "Crank",
        "engines.pymunk.model": "Settings Model",
        "engines.reading": "Note Obstacle Change Give Reading Source",
        "engines.mujoco.reading.frame": "Frame Groups",
        "engines.mujoco.writers": "Mjcf Urdf",
        "engines.mujoco.reading.elements": "Scene",
        "engines.mujoco.reading.own_model": "OwnMuJoCo",
        "engines.pymunk.reading.joints": "Described",
        "engines.pymunk.reading.own_model": "OwnPymunk",
        "engines.pymunk.reading.script": "Made",
        "engines.importers": "Importer",
        "engines.single_run": "Recorded",
        "engines.conformance.same": "Isometry",
        "engines.conformance.check": "Case Check Result",
        "engines.conformance.world": "Motion World",
    }.items()
    for name in names.split()
}
ABSTRACT = {"reference.scenes.four_bar.scenes.FourBarScene", "reference.scenes.rolling.scenes.RollingScene"}


LONGEST = 300.0  # s of the processor's time, since a loaded machine may take any time


@pytest.fixture(autouse=True)
def _nothing_hangs(request: pytest.FixtureRequest):
    """A check that lets a number through may step for ever: then the process says where, and ends."""
    if not hasattr(signal, "setitimer"):  # Windows
        yield
        return
    # What pytest captures would be lost with the process.
    capture: Any = request.config.pluginmanager.getplugin("capturemanager")
    with capture.global_and_fixture_disabled():
        plain = os.dup(2)
    faulthandler.register(signal.SIGPROF, file=plain, chain=True)  # and then the signal does what it always does
    signal.setitimer(signal.ITIMER_PROF, LONGEST)
    yield
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    faulthandler.unregister(signal.SIGPROF)
    os.close(plain)


def outcome(trial: Trial) -> str:
    """'refused', or what happened instead."""
    try:
        trial.call()
    except ValueError as refusal:
        if isinstance(refusal, InvalidMechanism) and f"{trial.name} is " in str(refusal) and "must be" in str(refusal):
            return "refused"
        return f"another sentence: {refusal}"
    except Exception as foreign:
        return f"{type(foreign).__name__}: {foreign}"
    return "answered"


def told(tried: list[Trial]) -> list[str]:
    """One line for every argument that was not refused."""
    results = [(trial, outcome(trial)) for trial in tried]
    print(dict(Counter("refused" if what == "refused" else what.split(":")[0] for _, what in results)))
    return [f"{trial.owner}({trial.name}={trial.value!r}): {what}" for trial, what in results if what != "refused"]


def test_two_thousand_arguments_that_can_not_be_meant_are_refused():
    assert told(random.Random(0).sample(trials(), TRIED)) == []


@pytest.mark.slow
def test_every_argument_that_can_not_be_meant_is_refused():
    assert told(trials()) == []


@pytest.mark.parametrize(
    ("annotation", "valid", "beyond"),
    [(Fraction, (0, 1), (-1e-9, 1 + 1e-9)), (Count, (1, 2**31 - 1), (0, 2**31)), (NonNegative, (0.0,), (-1e-9,))],
)
def test_a_bound_itself_is_valid_and_what_lies_beyond_it_is_not(annotation, valid, beyond):
    for value in valid:
        assert take("test", "value", value, annotation) == value
    for value in beyond:
        with pytest.raises(InvalidMechanism, match="test: value is"):
            take("test", "value", value, annotation)


@validated
def halves(mass: Positive, /, count: Count = 1, *, share: Fraction = 0.5) -> float:
    return mass * share / count


def test_arguments_given_by_name_are_checked_as_those_given_by_place():
    assert halves(2.0, count=2, share=1) == 1.0
    for call in (lambda: halves(-1.0), lambda: halves(1.0, count=0), lambda: halves(1.0, share=math.nan)):
        with pytest.raises(InvalidMechanism, match=r"halves: \w+ is"):
            call()


def test_every_class_that_users_make_checks_its_fields_and_is_tried():
    found = dataclasses_of_the_suite()
    assert {name for name, each in found.items() if not issubclass(each, Valid)} <= NOT_MADE_BY_USERS
    kinds = {type(each) for each in INSTANCES}
    assert {name for name, each in found.items() if issubclass(each, Valid) and each not in kinds} == ABSTRACT


def test_functions_of_every_part_are_tried():
    owners = [function.__module__ for function, _ in functions_of_the_suite()]
    assert len(owners) > 120
    scenes = (f"scenes.{part}" for part in ("four_bar", "skates", "wheels", "rolling", "pendulum", "slider_crank"))
    for part in (*scenes, "rolling", "chapter.shapes", "mechanism"):
        assert any(f"{owner}.".startswith(f"reference.{part}.") for owner in owners), part


# ------------------------------------------------------------------------------------------------- what can be meant


def unusual(value: Any) -> list[Any]:
    """The same value in other clothes."""
    if isinstance(value, bool):
        return [np.bool_(value), np.array(value)]
    if isinstance(value, int):
        return [np.int64(value), np.int32(value), np.array(value)]
    if isinstance(value, float):
        whole = [int(value)] if math.isfinite(value) and value.is_integer() else []
        return [
            np.float64(value),
            np.array(value),
            *whole,
            *([np.float32(value)] if float(np.float32(value)) == value else []),
        ]
    if isinstance(value, str):
        return [np.str_(value), np.array(value)]
    if isinstance(value, tuple) and value and all(isinstance(each, float) for each in value):
        numbers = array("d", value)
        iterator = (each for each in value)
        return [
            list(value),
            np.array(value),
            tuple(map(np.float64, value)),
            deque(value),
            numbers,
            memoryview(numbers),
            iterator,
        ]
    return []


@pytest.mark.parametrize("sample", INSTANCES, ids=lambda each: type(each).__name__)
def test_the_same_values_in_other_clothes_make_the_same(sample):
    for field in dataclasses.fields(sample):
        for value in unusual(getattr(sample, field.name)):
            assert repr(dataclasses.replace(sample, **{field.name: value})) == repr(sample), (field.name, value)


def test_lists_and_numbers_of_numpy_are_taken_by_functions():
    linkage = FourBar(0.4, np.float64(0.5), 0.6, [0.5, 0])  # type: ignore[arg-type]
    assert repr(linkage) == "FourBar(crank=0.4, coupler=0.5, rocker=0.6, ground=(0.5, 0.0))"
    assert linkage.angles([1.0], np.int64(1))[0] == linkage.angles(1.0)[0]
    assert park([0, 0, 0], np.array([1, 1, 0])) == park((0.0, 0.0, 0.0), (1.0, 1.0, 0.0))  # type: ignore[arg-type]
    cell = Cell(SCENES[0], registry.ENGINES[0], np.int64(3), samples=np.int64(2))  # type: ignore[arg-type]
    assert (type(cell.every), type(cell.samples)) == (int, int)


@pytest.mark.parametrize("engine", [*registry.ENGINES, Extrapolated(registry.ENGINES[0], "e", (1, 2), (1,))])
def test_every_engine_takes_numpys_steps_and_counts_and_refuses_others_alike(engine):
    mechanism = four_bar()
    plain = engine.build(mechanism, 0.0009765625)(2, 1)
    build: Any = engine.build  # what its types allow is not asked here
    numpys = build(mechanism, np.float32(0.0009765625))(np.int64(2), np.int32(1))
    np.testing.assert_array_equal(plain.pose, numpys.pose)
    for wrong in (True, "1e-3", 1e-3j, None, math.nan, 0.0, -1e-3, [1e-3]):
        with pytest.raises(InvalidMechanism, match=r"dt is .*must be a finite number greater than zero"):
            build(mechanism, wrong)
    with pytest.raises(InvalidMechanism, match=r"mechanism is .*must be a Mechanism"):
        build(SCENES[0], 1e-3)
    for wrong in (True, 2.0, "2", None, 0, -1, 2**31):
        with pytest.raises(InvalidMechanism, match=r"samples is .*must be a whole number from 1"):
            build(mechanism, 1e-3)(wrong, 1)
        with pytest.raises(InvalidMechanism, match=r"every is .*must be a whole number from 1"):
            build(mechanism, 1e-3)(1, wrong)


# -------------------------------------------------------------------------------------------------------------- times

NO_TIMES = [[math.inf], [math.nan], [-1.0], [0.0, -1e-9], "abc", ["0"], None, [[0.0, 0.1]], [1j], [True], {}]
TOO_LATE = [[1e16], [1e300], [0.0, 1e6]]


@pytest.mark.parametrize("scene", [*SCENES, *SCENES_OF_LIMITS], ids=lambda scene: scene.name)
def test_poses_of_another_number_of_bodies_are_of_no_branch(scene):
    bodies = len(scene.mechanism().bodies)
    for count in (0, bodies - 1, bodies + 1):
        with pytest.raises(InvalidMechanism, match=f"pose is of {count} bodies; it must be of {bodies}"):
            scene.branch_of(np.zeros((4, count, 3)))


@pytest.mark.parametrize("scene", [*SCENES, *SCENES_OF_LIMITS], ids=lambda scene: scene.name)
def test_a_scene_refuses_times_that_are_none(scene):
    for times in NO_TIMES:
        with pytest.raises(InvalidMechanism, match=f"scene '{scene.name}': t is .*must be finite numbers in one row"):
            scene.motion(times)
    for times in TOO_LATE:
        with pytest.raises(InvalidMechanism, match=r"known up to .* times its duration"):
            scene.motion(times)


@pytest.mark.parametrize("scene", [*SCENES, *SCENES_OF_LIMITS], ids=lambda scene: scene.name)
def test_no_times_give_a_motion_without_samples_and_one_number_one_sample(scene):
    one, none = scene.motion(0), scene.motion([])
    for name in ("t", "pose", "twist", "reaction"):
        assert getattr(one, name).shape[0] == 1
        assert getattr(none, name).shape == (0, *getattr(one, name).shape[1:])


def test_a_crank_beyond_its_limit_is_refused_also_where_its_angle_could_be_reached_again():
    scene = OverdrivenFourBar()
    again = scene.stopping_time + 0.9 * 2 * math.pi / scene.rate
    scene.four_bar.angles(scene.start + scene.rate * 2 * scene.duration)  # reachable, but not from the start
    with pytest.raises(Unreachable):
        scene.motion([2 * scene.duration])
    with pytest.raises(Unreachable):
        scene.motion([min(again, scene.latest)])


# ---------------------------------------------------------------------------------------------------------- sentences


def test_a_refusal_names_the_owner_the_field_the_value_and_what_would_be_valid():
    with pytest.raises(InvalidMechanism) as refusal:
        Body("crank", np.complex128(1 + 2j), 1.0, (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    assert str(refusal.value) == (
        "Body 'crank': mass is np.complex128(1+2j); it must be a finite number greater than zero"
    )
    with pytest.raises(InvalidMechanism) as refusal:
        park((0.0, 0.0), (0.0, 0.0, 0.0))  # type: ignore[arg-type]
    assert str(refusal.value) == "park: start is (0.0, 0.0); it must be a tuple of 3 values, each a finite number"


def test_a_value_too_long_to_print_is_shortened():
    for value in (np.zeros(1000), 10**5000, "x" * 1000):
        with pytest.raises(InvalidMechanism, match="mass is ") as refusal:
            Body("b", value, 1.0, (0.0, 0.0, 0.0))  # type: ignore[arg-type]
        assert len(str(refusal.value)) < 200


def test_an_annotation_that_no_check_is_known_for_is_an_error_and_not_skipped():
    @validated
    def strange(value: bytes | frozenset[int]) -> None: ...

    with pytest.raises(TypeError, match="no check is known"):
        strange(b"")


@pytest.mark.parametrize(
    ("name", "value"),
    [("duration", "long"), ("duration", -1.0), ("horizon", math.nan), ("samples", 2.5), ("samples", 0)],
)
def test_what_a_scenes_class_sets_without_a_field_is_checked_too(name, value):
    class Plain(Scene):
        name, source, duration, horizon = "plain", "", 1.0, 1.0  # no annotations, so no fields

        def mechanism(self):
            return four_bar()

        def _motion(self, times):
            raise NotImplementedError

    assert dataclasses.dataclass(frozen=True)(Plain)().duration == 1.0
    setattr(Plain, name, value)
    with pytest.raises(InvalidMechanism, match=f"scene 'plain': {name} is "):
        Plain()
