"""A pytest plugin for any project: the fixture `crosscheck`, and the tests of the grid with `-m crosscheck`.

    def test_my_linkage(crosscheck):
        crosscheck.check("linkage.xml", tolerance=1e-4)

    def test_my_engine(crosscheck):
        crosscheck.conform(MyEngine(), expected_failures={"orders_are_kept": "a known bug, number 12"})

Every run of pytest imports this module, so slow imports are inside functions.
`pytest -m crosscheck --scene ... --engine ... --baseline ... --crosscheck-report ...` runs the grid from any folder.
Without `-m crosscheck` these options do not exist, since other plugins may have options with the same names.
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


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "crosscheck: every scene in every engine variant, against the truth (minutes)")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the tests of the grid unless `-m crosscheck` is given."""
    if config.pluginmanager.has_plugin(PLUGIN):
        return
    grid = [item for item in items if item.get_closest_marker("crosscheck")]
    config.hook.pytest_deselected(items=grid)
    items[:] = [item for item in items if item not in grid]


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests(early_config: pytest.Config, parser: pytest.Parser, args: list[str]) -> None:
    """With `-m crosscheck`, add the options of the grid, and the tests of the grid unless the user names tests."""
    expression = early_config.known_args_namespace.markexpr or ""
    if not re.search(r"\bcrosscheck\b", expression) or re.search(r"\bnot\s+crosscheck\b", expression):
        return
    _require_ours()
    early_config.pluginmanager.import_plugin(PLUGIN)
    grid_tests = early_config.rootpath / "reports" / "gate" / "grid_tests.py"
    known_args = parser.parse_known_args(args, namespace=copy.copy(early_config.option))
    if not grid_tests.exists() and not known_args.file_or_dir:
        args += ["--pyargs", GRID]


def _require_ours() -> None:
    """Raise UsageError if another package hides `reference`, `engines` or `reports`."""
    from planar_crosscheck import clash

    if message := clash():
        raise pytest.UsageError(f"crosscheck: {message}")


class Crosscheck:
    """The fixture `crosscheck`. Paths of models start at the folder of the test file or at the current folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def check(self, model: Any, tolerance: float = 1e-4, duration: float = 2.0, **terms: Any) -> CheckReport:
        """Fail the test if the settings of a model miss the tolerance, or if the model can't be checked.

        The message contains the advised settings. `terms` are keyword arguments of `planar_crosscheck.check`.
        """
        from planar_crosscheck import check
        from reports.check.rendering import plain

        beside = self._folder / str(model).rpartition(":")[0] if ":" in str(model) else self._folder / str(model)
        inside = isinstance(model, str | Path) and beside.exists()
        folder = self._folder if inside else None
        result = _failing(lambda: check(model, tolerance, duration, folder=folder, **terms))
        if not result.fine:
            pytest.fail(plain([result.answer]), pytrace=False)
        return result

    def conform(self, engine: Engine, expected_failures: Mapping[str, str] | None = None) -> None:
        """Fail the test if an engine does not conform, or if an expected failure does not occur."""
        from planar_crosscheck import conform

        _failing(lambda: conform(engine, expected_failures))


def _failing(call: Callable[[], Any]) -> Any:
    """Return the result of the call. An exception fails the test with the message of the exception."""
    message = ""
    try:
        return call()
    except (ValueError, AssertionError) as reason:
        message = str(reason) or repr(reason)
    pytest.fail(message, pytrace=False)  # Inside `except`, pytest would print both errors.


@pytest.fixture
def crosscheck(request: pytest.FixtureRequest) -> Crosscheck:
    """A fixture that checks your models and engines. See the examples in planar_crosscheck_pytest.py."""
    _require_ours()
    return Crosscheck(request.path.parent)
