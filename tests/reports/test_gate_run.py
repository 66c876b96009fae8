"""Tests of the grid as a suite of pytest, of the judge's processes, and of the gate with wrong engines."""

from __future__ import annotations

from functools import cache
from typing import Any, cast

import pytest

from engines import Engine, mujoco, pymunk
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.gate.judge import integrate
from reports.gate.prediction import prediction
from reports.gate.pytest_plugin import _engines
from reports.gate.theory import Case, checks, kinds
from reports.gate.walk import JudgeRun, run_judge
from reports.model.checks import Check
from reports.model.measure import measure
from tests import ROOT
from tests.reports.test_gate import row
from tests.reports.test_gate_baseline import written
from tests.toys import Disc
from tests.wrong.adapters import SMALL_MISTAKES, Wrong

SUITE = """
import pytest
from reports.gate.theory import Case
from engines import ConvergenceOrder
from tests.toys import Disc, Toy

CASES = [Case(Disc(), Toy(variant, factor=1e-4), ConvergenceOrder(2)) for variant in ("one", "two", "three")]

@pytest.mark.parametrize("case", [pytest.param(case, id=case.label) for case in CASES])
def test_case(verdicts, case):
    assert case in verdicts
    print("ran", sorted(each.method for each in verdicts))
"""


@pytest.fixture
def suite(pytester):
    """A test suite with a grid of three toy engines in a temporary folder."""
    root = ROOT
    pytester.makeini(f"[pytest]\npythonpath = {root}\n")
    pytester.makeconftest('pytest_plugins = ["reports.gate.pytest_plugin"]')
    pytester.makepyfile(SUITE)
    written(pytester.path / "errors.csv", row())
    return pytester


def test_only_what_is_selected_is_run_and_the_table_and_the_file_tell_it(suite, at_home):
    """A test that uses the fixture `verdicts` is run with the selected cases; a test without it is deselected."""
    suite.makepyfile(
        f"{SUITE}\ndef test_of_all(verdicts):\n    assert len(verdicts) == 1\n\ndef test_of_nothing(): pass\n"
    )
    chosen = ("--engine", "toy two", "--baseline", "errors.csv", "--crosscheck-report", "out.md")
    found = suite.runpytest_inprocess("-s", *chosen)
    found.assert_outcomes(passed=2, deselected=3)
    found.stdout.fnmatch_lines(
        ["*ran [[]'toy two'[]]*", "*crosscheck*", "scene *bound*", "disc *toy two*", "written to *"]
    )
    assert "| disc | toy two |" in (suite.path / "out.md").read_text()
    assert "toy one" not in (suite.path / "out.md").read_text()


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--baseline", "nothing.csv"], "baseline nothing.csv: No such file or directory"),
        (["--crosscheck-report", "no/such/folder.md"], "there is no folder no/such"),
        (["--crosscheck-report", "."], "--crosscheck-report .: it is a folder"),
        (["--scene", "moon"], "no case of --scene"),
        (["--cost", "0"], "--cost 0.0: it must be a number above 0, such as 1.5"),
        (["--cost", "nan"], "--cost nan: it must be a number above 0, such as 1.5"),
    ],
)
def test_what_can_not_be_meant_is_one_line_before_anything_is_run(suite, arguments, told):
    found = suite.runpytest_inprocess("--baseline", "errors.csv", *arguments)
    assert found.ret == pytest.ExitCode.USAGE_ERROR
    assert told in found.stderr.str()
    assert "Traceback" not in found.stderr.str()


NO_KINDS: frozenset[Any] = frozenset()


class Cut(Disc):
    """A scene of 70 samples in 0.705 s whose motion can be compared until `until` [s]."""

    name = "cut disc"
    until = 0.115

    @property
    def comparable_until(self) -> float:
        return self.until


@pytest.mark.parametrize(
    ("until", "samples"),
    # The horizon of 27 samples divided by their spacing is rounded to a number below 27.
    [(11.5, 11), (1e-3, 1), (27, 27)],
)
def test_the_judge_ends_at_the_last_sample_that_can_be_compared_and_takes_one_at_least(monkeypatch, until, samples):
    monkeypatch.setattr(Cut, "until", until * (0.705 / 70))
    assert integrate(Cut(duration=0.705), 2, 1).t[-1] == pytest.approx(samples * 0.705 / 70, rel=1e-12)


class Unknown(Disc):
    """A scene whose reference motion can't be computed."""

    name = "unknown disc"

    def _motion(self, times: Any) -> Any:
        raise ValueError("nobody knows where it is")


def test_the_judge_runs_in_processes_of_its_own_and_one_that_fails_ends_the_gate_with_its_reason():
    job = JudgeRun(Disc(), NO_KINDS)
    assert run_judge([job, job], 1) == {job: prediction(Disc(), NO_KINDS)}
    with pytest.raises(RuntimeError, match=r"the judge on unknown disc: .*nobody knows where it is"):
        run_judge([JudgeRun(Unknown(), NO_KINDS)], 1)


SCENE = DrivenFourBar()
ENGINES: dict[str, Engine] = {"pymunk": pymunk.TUNED, "mujoco": mujoco.TUNED}
ASKED = (
    *SMALL_MISTAKES,
    "velocities are half a step late",
    "velocities are of the step before",
    "reactions are twice as large",
    "reactions have the other sign",
)

# (engine, mistake) -> the reason why the mistake is not detected.
SYMMETRIC = (
    "its own velocities are half a step early, so a step before they are half a step late: 7.6e-4 rad/s at 1e-5 s"
)
UNSEEN: dict[tuple[str, str], str] = {
    ("pymunk", "velocities are of the step before"): SYMMETRIC,
}


@cache
def found(name: str, mistake: str) -> tuple[Check, ...]:
    """The checks that an engine with this mistake fails."""
    engine = cast(Engine, Wrong(mistake, ENGINES[name]))
    if ENGINES[name].missing:
        pytest.skip(ENGINES[name].missing)
    case = Case(SCENE, engine, engine.order(SCENE.mechanism()))
    rows = [measure(cell, repeat=False) for cell in case.cells()]
    judge = prediction(SCENE, kinds(SCENE, [engine]))
    return tuple(check for check in checks(case, rows, judge) if not check.passed)


@pytest.mark.parametrize("name", ENGINES)
def test_a_right_engine_passes_under_another_name(name: str) -> None:
    assert found(name, "nothing") == ()


@pytest.mark.parametrize("mistake", ASKED)
@pytest.mark.parametrize("name", ENGINES)
def test_a_wrong_engine_fails_unless_the_mistake_is_below_the_methods_own_error(name: str, mistake: str) -> None:
    assert bool(found(name, mistake)) is ((name, mistake) not in UNSEEN), UNSEEN.get((name, mistake))


def test_engines_of_the_gate_are_names_or_references(tmp_path, monkeypatch):
    monkeypatch.setattr("sys.path", [*__import__("sys").path])
    assert _engines(["pymunk", "mujoco tuned"]) == ((), ("pymunk", "mujoco tuned"))
    (tmp_path / "own_toy.py").write_text("from tests.toys import Toy\nOWN = (Toy('a'), Toy('b'))\n")
    result = _engines([f"{tmp_path}/own_toy.py:OWN", "engines.pymunk:TUNED"])
    assert [engine.variant for engine in result[0]] == ["a", "b", "tuned"]
    assert result[1] == ("toy a", "toy b", "pymunk tuned")
    (tmp_path / "another.py").write_text("from tests.toys import Toy\nOTHER = Toy('tuned', name='pymunk')\n")
    with pytest.raises(pytest.UsageError, match="another engine is called 'pymunk tuned'; give it another name"):
        _engines([f"{tmp_path}/another.py"])
    with pytest.raises(pytest.UsageError, match="there is no such file"):
        _engines([f"{tmp_path}/missing.py"])
