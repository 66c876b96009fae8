"""Tests of every method in every scene of the pages against the bounds of theory and the numbers of the baseline.

The cells are those of the report. The tests are part of the package, so `pytest -m crosscheck` runs them in any folder.
"""

from __future__ import annotations

import pytest

from engines import registry
from reports.gate.pytest_plugin import GIVEN, KNOWN
from reports.gate.theory import Case, cases
from reports.gate.walk import CaseVerdict, grown, lost
from reports.model.catalogue import PAGES, with_engines
from reports.model.outcomes import Outcome

GRID = cases(PAGES)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """Parametrise the tests by the cases of the grid. Engines that `--engine` gives by a reference are included."""
    if metafunc.function in (
        test_a_method_is_as_exact_as_theory_promises,
        test_a_method_gives_the_numbers_of_the_baseline,
    ):
        engines = metafunc.config.stash.get(GIVEN, ())
        grid = cases(with_engines(PAGES, engines)) if engines else GRID
        metafunc.parametrize("case", [pytest.param(case, id=case.label) for case in grid])


def verdict_of(verdicts: dict[Case, CaseVerdict], case: Case) -> CaseVerdict:
    """The verdict of a case. If the engine's extra is not installed, the test is skipped."""
    if absent := case.engine.missing:
        pytest.skip(absent)
    return verdicts[case]


@pytest.mark.crosscheck
def test_a_method_is_as_exact_as_theory_promises(verdicts: dict[Case, CaseVerdict], case: Case) -> None:
    verdict = verdict_of(verdicts, case)
    if verdict.rows[-1].outcome == Outcome.UNSUPPORTED:
        # The engine does not support the case at any step.
        assert all(row.outcome == Outcome.UNSUPPORTED and row.sentence for row in verdict.rows)
        assert not case.known
        return
    assert not verdict.theory_complaints, "\n".join(verdict.theory_complaints)


@pytest.mark.crosscheck
def test_a_method_gives_the_numbers_of_the_baseline(verdicts: dict[Case, CaseVerdict], case: Case) -> None:
    verdict = verdict_of(verdicts, case)
    assert not verdict.change_complaints, "\n".join(verdict.change_complaints)


@pytest.mark.crosscheck
def test_with_other_versions_no_method_is_worse_over_all_its_scenes(
    request: pytest.FixtureRequest, verdicts: dict[Case, CaseVerdict]
) -> None:
    results = [str(check) for check in grown(verdicts.values(), request.config.stash[KNOWN]) if not check.passed]
    assert not results, "\n".join(results)


@pytest.mark.crosscheck
def test_the_grid_has_every_scene_and_method_of_the_baseline(request: pytest.FixtureRequest) -> None:
    absent_pairs = lost(request.config.stash[KNOWN], GRID)
    absent = {sentence for _, method in absent_pairs if (sentence := absence(method))}
    gone = [f"{scene}-{method}" for scene, method in absent_pairs if not absence(method)]
    assert not gone, f"the grid has lost what the baseline has: {', '.join(gone)}"
    if absent:
        pytest.skip("; ".join(sorted(absent)))


def absence(method: str) -> str:
    """A sentence on how to install the extra of a method, or an empty text if the method needs no installation."""
    return next((sentence for name, sentence in registry.ABSENT.items() if method.startswith(f"{name} ")), "")
