"""The checks of `engines.conformance`: ours pass all of them, and each finds the mistake that it is there for."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, cast

import numpy as np
import pytest

from engines import Engine, lagrange, method_name, mujoco, pymunk, registry
from engines.conformance import CHECKS, Case, Subject, cases
from engines.conformance.same import Isometry, bodies_reordered, joints_reordered, joints_swapped, relabelled
from engines.conformance.worlds import MOVING, SPINNING, WORLDS
from engines.mujoco import methods as of_mujoco
from engines.pymunk import methods as of_pymunk
from reports.__main__ import main
from reports.model.cells import SLOW_TO_BUILD
from tests.wrong.adapters import MISTAKES, Wrong
from tests.wrong.talkers import TALKERS

# The check that has to find a mistake, and does so before any other.
FOUND_BY = {
    "a kind of joint is looked up": "builds_or_refuses",
    "a refusal of two words": "builds_or_refuses",
    "the family has two lines": "has_a_name",
    "it can be changed": "is_a_frozen_dataclass",
    "a setting is not shown": "is_a_frozen_dataclass",
    "a setting is a list": "can_be_hashed",
    "its class is local": "can_be_pickled",
    "what is no field is lost": "can_be_pickled",
    "a package has another name": "names_its_packages",
    "the order is a number": "promises_an_order",
    "an order is refused in a word": "promises_an_order",
    "a step costs nothing": "tells_what_a_step_costs",
    "a step's cost is measured": "tells_what_a_step_costs",
    "who holds a skate is told in another word": "tells_who_holds_a_joint",
    "softness counts joints": "tells_how_joints_give_way",
    "runs are counted instead of their steps": "tells_the_steps_of_its_runs",
    "nothing is built": "builds_at_least_one",
    "the first joint is looked at": "refuses_odd_mechanisms",
    "forces are not looked at": "feels_forces_or_refuses_them",
    "a bad step is replaced": "refuses_bad_steps",
    "a bad count is replaced": "refuses_bad_counts",
    "a second call goes on": "refuses_a_second_call",
    "reactions are left out": "has_the_right_shapes",
    "the size is not told": "tells_the_size_of_its_model",
    "time forgets the steps between samples": "samples_at_the_right_times",
    "the cost is in milliseconds": "tells_the_cpu_time_of_stepping",
    "the cost is negative": "tells_the_cpu_time_of_stepping",
    "the cost is of the wall's clock": "tells_the_cpu_time_of_stepping",
    "the state after the first step comes first": "first_pose_is_the_start",
    "the first velocity has had half a kick": "first_twist_is_the_start",
    "random noise": "gives_the_same_bits",
    "the mechanism is written into": "leaves_the_mechanism_alone",
    "steps between samples are one long step": "sampling_changes_nothing",
    "angles are wrapped": "does_not_wrap_angles",
    "reactions have the other sign": "reactions_have_sign_and_size",
    "reactions are twice as large": "reactions_have_sign_and_size",
    "poses are half a step late": "poses_stand_at_their_instants",
    "velocities are half a step late": "twists_stand_at_their_instants",
    "velocities are of the step before": "twists_stand_at_their_instants",
    "poses are of first order": "poses_have_their_order",
    "velocities are of first order": "twists_have_their_order",
    "gravity points down": "same_if_turned",
    "there are walls": "same_if_shifted",
    "a blade's angle has no sign": "same_if_mirrored",
    "names are ASCII": "same_if_relabelled",
    "bodies are told from the ground up": "same_if_bodies_are_reordered",
    "reactions of pins are told first": "same_if_joints_are_reordered",
    "reactions are always of the body": "same_if_bodies_of_joints_are_swapped",
}
METHODS = (*pymunk.METHODS, *mujoco.METHODS, *lagrange.METHODS, *registry.OTHERS)
SPECIAL = (
    *(*of_pymunk.SKATES, *of_pymunk.ROLL_FACETED, of_pymunk.ROLL_PIVOT),
    *(*of_mujoco.SKATES, *of_mujoco.SLOTS, *of_mujoco.ROLLS, *of_mujoco.DRIVES),
)
# Enough for every day: what differs by its settings alone, or takes seconds of steps in Python, is left out.
DAILY = (
    *(pymunk.DEFAULT, pymunk.EXTENDED, mujoco.DEFAULT, mujoco.EXTENDED),
    lagrange.Lagrange("rk4", "projection"),
    *(engine for engine in registry.OTHERS if engine.building < SLOW_TO_BUILD),
)
DESCRIPTIONS = (
    Isometry(turn=0.7, shift=(3.7, -2.9)),
    Isometry(turn=-2.5, shift=(0.3, 0.4), mirrored=True),
    *(relabelled, bodies_reordered, joints_reordered, joints_swapped),
)


def label(engine):
    return method_name(engine)


def failures(engine) -> list[str]:
    """What fails, a line each."""
    found = ((case, case.result()) for case in cases(engine))
    return [f"{case}: {result.sentence}" for case, result in found if result.status == "fails"]


EVERY = (*DAILY, *(pytest.param(each, marks=pytest.mark.slow) for each in (*METHODS, *SPECIAL) if each not in DAILY))


@pytest.mark.parametrize("engine", EVERY, ids=label)
def test_every_construction_of_ours_passes_every_check(engine):
    if engine.missing:
        pytest.skip(engine.missing)
    assert failures(engine) == []


@pytest.mark.parametrize("world", [*WORLDS, SPINNING], ids=lambda world: world.name)
def test_the_exact_motions_are_those_of_exact_multipliers(world):
    run = lagrange.TRUTH.build(world.mechanism, 0.05)(6, 1)
    exact = world.exact(run.t)
    for name in ("pose", "twist", "reaction"):
        found, right = getattr(run, name), getattr(exact, name)
        assert np.abs(found - right).max() <= 1e-11 * (1 + np.abs(right).max())  # its tolerance is 1e-13 of a step


@pytest.mark.parametrize("world", MOVING, ids=lambda world: world.name)
@pytest.mark.parametrize("change", DESCRIPTIONS, ids=["moved", "mirrored", "names", "bodies", "joints", "swapped"])
def test_another_description_is_of_the_same_motion(world, change):
    described, back = change(world.mechanism)
    run = lagrange.TRUTH.build(described, 0.05)(2, 1)
    exact = world.exact(run.t)
    for found, right in zip(back(run), (exact.pose, exact.twist, exact.reaction), strict=True):
        assert np.abs(found - right).max() <= 1e-11 * (1 + np.abs(right).max())


def wrong(mistake: str) -> Any:
    return TALKERS[mistake] if mistake in TALKERS else Wrong(mistake)


def first_failure(among: Iterable[Case]) -> tuple[str, str]:
    """The first check that fails, and its sentence; raises StopIteration if none does."""
    found = ((case.check.name, case.result()) for case in among)
    return next((name, result.sentence) for name, result in found if result.status == "fails")


@pytest.mark.parametrize("mistake", FOUND_BY)
def test_a_wrong_adapter_fails_by_the_name_of_its_mistake(mistake):
    """The one check is asked; that none before it fails is what the slow test below asks."""
    own = [case for case in cases(wrong(mistake)) if case.check.name == FOUND_BY[mistake]]
    name, sentence = first_failure(own)
    assert sentence.startswith(f"{name}: {own[0].check.asks} It found ")
    assert "; expected " in sentence
    assert ". Usually: " in sentence


@pytest.mark.slow
@pytest.mark.parametrize("mistake", FOUND_BY)
def test_the_first_check_that_a_wrong_adapter_fails_has_the_name_of_its_mistake(mistake):
    name, sentence = first_failure(cases(wrong(mistake)))
    assert name == FOUND_BY[mistake], sentence


def test_every_check_has_a_mistake_that_it_finds():
    assert {*FOUND_BY} == {*MISTAKES, *TALKERS} - {"nothing"}
    assert {*FOUND_BY.values()} == {check.name for check in CHECKS}


def test_the_right_engine_inside_the_wrong_ones_passes():
    assert failures(Wrong("nothing")) == []


def test_an_engine_that_spoils_its_mechanism_spoils_no_other_check():
    kept = [repr(world.mechanism) + repr(world.mechanism.twist) for world in WORLDS]
    for case in cases(cast(Engine, Wrong("the mechanism is written into"))):
        result = case.result()
        assert result.status != "fails" or case.check.name == "leaves_the_mechanism_alone", result.sentence
    assert kept == [repr(world.mechanism) + repr(world.mechanism.twist) for world in WORLDS]


def test_what_is_not_supported_is_no_pass():
    subject = Subject(mujoco.DEFAULT)
    check = CHECKS[[check.name for check in CHECKS].index("gives_the_same_bits")]
    hole = next(world for world in WORLDS if world.name == "disc in a hole")
    result = Case(subject, check, hole).result()
    assert result.status == "not supported"
    assert "hollow" in result.sentence


def told(capsys, *words: str) -> tuple[int, list[str], str]:
    """Exit status, lines on standard output, and what stands on the other."""
    with pytest.raises(SystemExit) as ended:
        main(["conform", *words])
    captured = capsys.readouterr()
    return int(ended.value.code or 0), captured.out.splitlines(), captured.err


def test_the_command_tells_a_line_a_check(capsys):
    status, lines, error = told(capsys, "pymunk", "--variant", "leapfrog")
    assert (status, error) == (0, "")
    assert lines[0] == "pymunk leapfrog"
    assert lines[-1] == "  every check holds"
    assert [line.split()[1] for line in lines if line.startswith("  holds")] == [check.name for check in CHECKS]


def test_the_command_says_what_is_not_supported_once(capsys):
    status, lines, _ = told(capsys, "mujoco", "--variant", "tuned")
    assert status == 0
    assert len([line for line in lines if "disc in a hole (roll)" in line]) == 1


def test_the_command_ends_with_1_where_a_check_fails(capsys):
    status, lines, error = told(capsys, "tests.wrong.adapters:HALF_A_STEP_LATE")
    assert status == 1
    assert error == "crosscheck: wrong velocities are half a step late: not as the contract of an engine says\n"
    assert any(line.startswith("  fails") and "twists_stand_at_their_instants: " in line for line in lines)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["pymunkk"], "did you mean 'pymunk'"),
        (["pymunk", "--variant", "tunned"], "did you mean 'tuned'"),
        (["engines.mujoco:TUNEDD"], "engines.mujoco has no TUNEDD"),
        (["engines.nowhere:TUNED"], "ModuleNotFoundError"),
        (["engines.mujoco:MuJoCo"], "engine"),
        (["engines.pymunk:SHIPPED_ITERATIONS"], "int"),
        (["engines.mujoco:"], "package.module:NAME"),
        (["tests.wrong.adapters:NO_ENGINES"], "at least one engine"),
    ],
)
def test_what_names_no_engine_is_refused_in_a_line(capsys, words, sentence):
    status, lines, error = told(capsys, *words)
    assert (status, lines) == (2, [])
    assert sentence in error
    assert error.count("\n") == 1
