"""The grid as a suite of pytest: what is selected, the table, options that can not be meant."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from engines import Promise
from reports.gate import grid_tests
from reports.gate.theory import Case
from tests import ROOT
from tests.reports.test_gate import row
from tests.reports.test_gate_baseline import written
from tests.toys import Disc, Toy


@dataclass(frozen=True)
class Absent(Toy):
    """One whose package is not installed."""

    @property
    def missing(self) -> str:
        return "needs what pip install brings"


SUITE = """
import pytest
from reports.gate.theory import Case
from engines import Promise
from tests.toys import Disc, Toy

CASES = [Case(Disc(), Toy(variant, factor=1e-4), Promise(2)) for variant in ("one", "two", "three")]

@pytest.mark.parametrize("case", [pytest.param(case, id=case.label) for case in CASES])
def test_case(verdicts, case):
    assert case in verdicts
    print("ran", sorted(each.method for each in verdicts))
"""


@pytest.fixture
def suite(pytester):
    """A grid of three toys in a folder of its own."""
    root = ROOT
    pytester.makeini(f"[pytest]\npythonpath = {root}\n")
    pytester.makeconftest('pytest_plugins = ["reports.gate.pytest_plugin"]')
    pytester.makepyfile(SUITE)
    written(pytester.path / "errors.csv", row())
    return pytester


def test_only_what_is_selected_is_run_and_the_table_and_the_file_tell_it(suite):
    """A test of all verdicts is kept with it, and one of nothing is not."""
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


def test_an_engine_that_is_not_there_is_skipped_with_its_extra():
    with pytest.raises(pytest.skip.Exception, match="what pip install brings"):
        grid_tests.verdict_of({}, Case(Disc(), Absent(), Promise(2)))


def test_workers_of_pytest_leave_the_grid_to_its_own(suite):
    """As pytest-xdist marks the configuration of its workers."""
    suite.makeconftest(
        'pytest_plugins = ["reports.gate.pytest_plugin"]\ndef pytest_configure(config): config.workerinput = {}\n'
    )
    found = suite.runpytest_inprocess("-rs", "-p", "no:xdist", "--baseline", "errors.csv")
    found.assert_outcomes(skipped=3)
    found.stdout.fnmatch_lines(["*the grid has workers of its own: pytest -m crosscheck, without -n"])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--baseline", "nothing.csv"], "baseline nothing.csv: No such file or directory"),
        (["--crosscheck-report", "no/such/folder.md"], "there is no folder no/such"),
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
