"""Tests that all our engines pass the checks of `engines.conformance`, and that each check finds a mistake."""

from __future__ import annotations

from collections.abc import Iterable
from typing import cast

import numpy as np
import pytest

from engines import Engine, conformance, lagrange, method_name, mujoco, pymunk, registry
from engines.conformance import CHECKS, ConformanceCase, cases
from engines.conformance.same import Isometry, bodies_reordered, joints_reordered, joints_swapped, relabelled
from engines.conformance.worlds import MOVING, SPINNING, WORLDS
from engines.mujoco import methods as of_mujoco
from engines.pymunk import methods as of_pymunk
from reports.__main__ import main
from reports.model.cells import SLOW_TO_BUILD
from tests.wrong.adapters import WRONG, Wrong

METHODS = (*pymunk.METHODS, *mujoco.METHODS, *lagrange.METHODS, *registry.OTHERS)
SPECIAL = (
    *(*of_pymunk.SKATE_METHODS, of_pymunk.ROLL_POLYGON, of_pymunk.ROLL_PIVOT),
    *(*of_mujoco.SKATES, *of_mujoco.SLOTS, *of_mujoco.ROLLS),
)
# Daily tests run one or two methods of each adapter. Other methods differ from these only by settings.
DAILY = (
    *(pymunk.DEFAULT, pymunk.EXTENDED, mujoco.DEFAULT, lagrange.Lagrange("rk4", "projection")),
    *(engine for engine in registry.OTHERS if engine.build_time < SLOW_TO_BUILD and engine.variant == "default"),
)
ALL = (
    *DAILY,
    *(pytest.param(engine, marks=pytest.mark.slow) for engine in (*METHODS, *SPECIAL) if engine not in DAILY),
)
DESCRIPTIONS = {
    "moved": Isometry(turn=0.7, shift=(3.7, -2.9)),
    "mirrored": Isometry(turn=-2.5, shift=(0.3, 0.4), mirrored=True),
    "names": relabelled,
    "bodies": bodies_reordered,
    "joints": joints_reordered,
    "swapped": joints_swapped,
}


def failures(engine: Engine) -> list[str]:
    results = ((case, case.result()) for case in cases(engine))
    return [f"{case}: {result.sentence}" for case, result in results if result.status == "fails"]


@pytest.mark.parametrize("engine", ALL, ids=method_name)
def test_all_our_methods_pass_all_checks(engine):
    if engine.missing:
        pytest.skip(engine.missing)
    assert failures(engine) == []


def close(found: Iterable[np.ndarray], exact) -> bool:
    """Whether poses, twists and reactions are exact. The tolerance is 100 times the judge's tolerance of 1e-13."""
    expected = (exact.pose, exact.twist, exact.reaction)
    return all(np.abs(a - b).max() <= 1e-11 * (1 + np.abs(b).max()) for a, b in zip(found, expected, strict=True))


@pytest.mark.parametrize("world", [*WORLDS, SPINNING], ids=lambda world: world.name)
def test_exact_motions_equal_the_judges_in_every_description(world):
    run = lagrange.TRUTH.build(world.mechanism, 0.05)(6, 1)
    assert close((run.pose, run.twist, run.reaction), world.exact(run.t))
    for name, change in DESCRIPTIONS.items() if world in MOVING else ():
        described, back = change(world.mechanism)
        run = lagrange.TRUTH.build(described, 0.05)(2, 1)
        assert close(back(run), world.exact(run.t)), name


def first_failure(cases_of_check: Iterable[ConformanceCase]) -> tuple[str, str]:
    """The name and the sentence of the first check that fails."""
    results = ((case.check.name, case.result()) for case in cases_of_check)
    return next((name, result.sentence) for name, result in results if result.status == "fails")


@pytest.mark.parametrize("mistake", WRONG)
def test_a_wrong_adapter_fails_the_check_of_its_mistake(mistake):
    check, engine = WRONG[mistake]
    its_cases = [case for case in cases(engine) if case.check.name == check]
    name, sentence = first_failure(its_cases)
    assert sentence.startswith(f"{name}: {its_cases[0].check.requirement} It found ")
    assert "; expected " in sentence
    assert ". Usually: " in sentence


def test_each_check_has_a_deliberate_mistake_and_a_correct_engine_passes():
    assert {check for check, _ in WRONG.values()} == {check.name for check in CHECKS}
    assert failures(cast(Engine, Wrong("nothing"))) == []


def test_an_engine_that_changes_its_mechanism_fails_no_other_check():
    remaining = [repr(world.mechanism) + repr(world.mechanism.twist) for world in WORLDS]
    failed = {line.split(": ")[1] for line in failures(cast(Engine, Wrong("the mechanism is written into")))}
    assert failed == {"leaves_the_mechanism_alone"}
    assert remaining == [repr(world.mechanism) + repr(world.mechanism.twist) for world in WORLDS]


def conform(capsys, *words: str) -> tuple[int, list[str], str]:
    """Run `crosscheck conform` and return (exit status, lines of standard output, text of standard error)."""
    with pytest.raises(SystemExit) as ended:
        main(["conform", *words])
    captured = capsys.readouterr()
    return int(ended.value.code or 0), captured.out.splitlines(), captured.err


def test_the_command_prints_one_line_for_each_check_and_each_refusal(capsys, monkeypatch):
    some = [check for check in CHECKS if check.name in ("builds_or_refuses", "has_a_name", "first_pose_is_the_start")]
    monkeypatch.setattr(conformance, "CHECKS", some)
    status, lines, error = conform(capsys, "mujoco", "--variant", "tuned")
    assert (status, error) == (0, "")
    assert (lines[0], lines[-1]) == ("mujoco tuned", "  every check holds")
    assert [line.split()[1] for line in lines if line.startswith("  holds")] == [check.name for check in some]
    assert len([line for line in lines if "disc in a hole (roll)" in line]) == 1


def test_the_exit_status_is_1_if_a_check_fails(capsys, monkeypatch):
    some = [check for check in CHECKS if check.name == "twists_stand_at_their_instants"]
    monkeypatch.setattr(conformance, "CHECKS", some)
    status, lines, error = conform(capsys, "tests.wrong.adapters:HALF_A_STEP_LATE")
    assert status == 1
    assert error == "crosscheck: wrong velocities are half a step late: not as the contract of an engine says\n"
    assert any(line.startswith("  fails") and "twists_stand_at_their_instants: " in line for line in lines)
