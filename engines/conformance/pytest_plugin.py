"""The checks as tests of anybody's: a test with the fixture `conformance` is run once for every check and mechanism.

In conftest.py `pytest_plugins = ["engines.conformance.pytest_plugin"]`, and in a test file

    @pytest.mark.conforms(my_package.DEFAULT, my_package.TUNED)
    def test_it_conforms(conformance):
        conformance()
"""

from __future__ import annotations

from collections.abc import Callable

import pytest

from engines.conformance import Case, cases


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line("markers", "conforms(*engines): the engines that the fixture `conformance` checks")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """One test a case; a test that names no engine fails."""
    if "conformance" not in metafunc.fixturenames:
        return
    engines = [engine for marker in metafunc.definition.iter_markers("conforms") for engine in marker.args]
    if not engines:
        where = metafunc.definition.name
        pytest.fail(f"{where}: it names no engine; mark it pytest.mark.conforms(ENGINE)", pytrace=False)
    metafunc.parametrize("conformance", list(cases(*engines)), ids=str, indirect=True)


@pytest.fixture
def conformance(request: pytest.FixtureRequest) -> Callable[[], None]:
    """What asks one check: it fails with the check's sentence, and skips with the reason where nothing is asked."""
    case: Case = request.param

    def ask() -> None:
        result = case.result()
        if result.status == "fails":
            pytest.fail(result.sentence, pytrace=False)
        if result.status != "holds":
            pytest.skip(f"{result.status}: {result.sentence}")

    return ask
