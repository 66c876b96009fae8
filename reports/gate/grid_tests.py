"""Every scene of every page in every method: below what theory promises, and equal to the baseline's numbers.

The cells are of the report's grid. No number of a scene and no bound stands here: `reports.gate.theory` says where a
bound comes from, `reports.gate.change` what a baseline's number is worth. It stands in the package, so that an
installation has it: pytest -p reports.gate.pytest_plugin -m crosscheck --pyargs reports.gate.grid_tests
"""

from __future__ import annotations

import pytest

from reports.gate.baseline import Baseline
from reports.gate.pytest_plugin import GIVEN, KNOWN
from reports.gate.verdicts import Case, cases
from reports.gate.walk import Verdict
from reports.grid.outcomes import Outcome
from reports.pages.catalogue import PAGES, with_engines

GRID = cases(PAGES)


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """The grid, with the engines that `--engine` names by a reference."""
    if metafunc.function in (
        test_a_method_is_as_exact_as_theory_promises,
        test_a_method_gives_the_numbers_of_the_baseline,
    ):
        given = metafunc.config.stash[GIVEN]
        found = cases(with_engines(PAGES, given)) if given else GRID
        metafunc.parametrize("case", [pytest.param(case, id=case.label) for case in found])


@pytest.mark.crosscheck
def test_a_method_is_as_exact_as_theory_promises(verdicts: dict[Case, Verdict], case: Case) -> None:
    verdict = verdicts[case]
    if verdict.rows[-1].outcome == Outcome.UNSUPPORTED:
        # What can't be built can't be at any step, and says why.
        assert all(row.outcome == Outcome.UNSUPPORTED and row.sentence for row in verdict.rows)
        assert not case.known
        return
    assert not verdict.theory_complaints, "\n".join(verdict.theory_complaints)


@pytest.mark.crosscheck
def test_a_method_gives_the_numbers_of_the_baseline(verdicts: dict[Case, Verdict], case: Case) -> None:
    verdict = verdicts[case]
    assert not verdict.change_complaints, "\n".join(verdict.change_complaints)


@pytest.mark.crosscheck
def test_the_baseline_knows_some_of_the_grid(request: pytest.FixtureRequest) -> None:
    baseline: Baseline = request.config.stash[KNOWN]
    known = {(scene, method) for scene, method, _, _ in baseline.cells}
    assert known & {(case.scene.name, case.method) for case in GRID}
