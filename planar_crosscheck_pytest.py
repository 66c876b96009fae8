"""What pytest finds of us in any project: the fixtures `crosscheck` and `conformance`, and the grid by `-m crosscheck`.

    def test_my_linkage(crosscheck):
        crosscheck.check("linkage.xml", tolerance=1e-4)

    def test_my_engine(crosscheck):
        crosscheck.conform(MyEngine(), expected_failures={"orders_are_kept": "a known bug, number 12"})

    @pytest.mark.conforms(MyEngine())  # the same with a test for every question and mechanism
    def test_it_conforms(conformance):
        conformance()

An installation registers this module under pytest11, so it is imported whenever somebody's tests are run: what takes
time is imported when it is used. `pytest -m crosscheck --scene ... --engine ... --baseline ... --crosscheck-report ...`
runs the grid from any folder; these options are there only then, since other plugins have such words too.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from engines import Engine
    from reports.check.request import CheckReport

GRID = "reports.gate.grid_tests"
PLUGIN = "reports.gate.pytest_plugin"


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config, parser: pytest.Parser, args: list[str]) -> None:
    """`-m crosscheck` brings the grid's options, and the grid where no tests are named. In the checkout it is there."""
    expression = early_config.known_args_namespace.markexpr or ""
    if not re.search(r"\bcrosscheck\b", expression) or re.search(r"\bnot\s+crosscheck\b", expression):
        return
    _require_ours()
    early_config.pluginmanager.import_plugin(PLUGIN)
    own = early_config.rootpath / "reports" / "gate" / "grid_tests.py"
    known = parser.parse_known_args(args, namespace=copy.copy(early_config.option))  # the grid's options are known now
    if not own.exists() and not known.file_or_dir:
        args += ["--pyargs", GRID]


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "conforms(*engines): the engines that the fixture `conformance` checks")


def _require_ours() -> None:
    """Fail in a sentence where another package hides one of ours: its name is as general as `reports`."""
    from planar_crosscheck import clash

    if told := clash():
        raise pytest.UsageError(f"crosscheck: {told}")


class Crosscheck:
    """The fixture `crosscheck`. Models are looked for beside the test's own file, then in the folder of the run."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def check(self, model: Any, tolerance: float = 1e-4, duration: float = 2.0, **terms: Any) -> CheckReport:
        """Fail the test, with the lines to paste, if a model's own settings miss a tolerance; see
        `planar_crosscheck.check`, which has the other terms. A model that can't be judged fails it too.
        """
        from planar_crosscheck import check
        from reports.check.rendering import plain

        beside = self._folder / str(model).rpartition(":")[0] if ":" in str(model) else self._folder / str(model)
        inside = isinstance(model, str | Path) and beside.exists()
        found = None
        try:
            found = check(model, tolerance, duration, folder=self._folder if inside else None, **terms)
            told = "" if found.fine else plain([found.answer])
        except ValueError as reason:
            told = str(reason)
        if found is None or told:
            pytest.fail(told, pytrace=False)
        return found

    def conform(self, engine: Engine, expected_failures: Mapping[str, str] | None = None) -> None:
        """Fail the test if an engine does not conform, or if a failure that was expected does not come true."""
        from planar_crosscheck import conform

        told = ""
        try:
            conform(engine, expected_failures)
        except AssertionError as reason:
            told = str(reason)
        if told:
            pytest.fail(told, pytrace=False)


@pytest.fixture
def crosscheck(request: pytest.FixtureRequest) -> Crosscheck:
    """Checks models and engines of one's own; see the first lines of planar_crosscheck_pytest.py."""
    _require_ours()
    return Crosscheck(request.path.parent)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a case of `conformance`; a test that names no engine fails."""
    if "conformance" not in metafunc.fixturenames:
        return
    _require_ours()
    from engines.conformance import cases

    engines = [engine for marker in metafunc.definition.iter_markers("conforms") for engine in marker.args]
    if not engines:
        where = metafunc.definition.name
        pytest.fail(f"{where}: it names no engine; mark it pytest.mark.conforms(ENGINE)", pytrace=False)
    metafunc.parametrize("conformance", list(cases(*engines)), ids=str, indirect=True)


@pytest.fixture
def conformance(request: pytest.FixtureRequest) -> Callable[[], None]:
    """What asks one check: it fails with the check's sentence, and skips with the reason where nothing is asked."""

    def ask() -> None:
        result = request.param.result()
        if result.status == "fails":
            pytest.fail(result.sentence, pytrace=False)
        if result.status != "holds":
            pytest.skip(f"{result.status}: {result.sentence}")

    return ask
