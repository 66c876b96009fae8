"""Every scene of every page in every method: below what theory promises, and equal to the baseline's numbers.

The cells are of the report's grid. No number of a scene and no bound stands here: `reports.gate.theory` says where a
bound comes from, `reports.gate.change` what a baseline's number is worth.
"""

from __future__ import annotations

import pytest

from engines import Promise
from reference.scene import Scene
from reference.scenes import SCENES
from reports.gate.baseline import Baseline
from reports.gate.checks import CHECKS
from reports.gate.pytest_plugin import KNOWN
from reports.gate.verdicts import Case, cases
from reports.gate.walk import Verdict
from reports.grid.outcomes import Outcome
from reports.pages.catalogue import PAGES, page_of, untaught
from tests.toys import Disc

GRID = cases(PAGES)
each_case = pytest.mark.parametrize("case", [pytest.param(case, id=case.label) for case in GRID])


@pytest.mark.crosscheck
@each_case
def test_a_method_is_as_exact_as_theory_promises(verdicts: dict[Case, Verdict], case: Case) -> None:
    verdict = verdicts[case]
    if verdict.rows[-1].outcome == Outcome.UNSUPPORTED:
        # What can't be built can't be at any step, and says why.
        assert all(row.outcome == Outcome.UNSUPPORTED and row.sentence for row in verdict.rows)
        assert not case.known
        return
    assert not verdict.theory_complaints, "\n".join(verdict.theory_complaints)


@pytest.mark.crosscheck
@each_case
def test_a_method_gives_the_numbers_of_the_baseline(verdicts: dict[Case, Verdict], case: Case) -> None:
    verdict = verdicts[case]
    assert not verdict.change_complaints, "\n".join(verdict.change_complaints)


@pytest.mark.crosscheck
def test_the_baseline_knows_some_of_the_grid(request: pytest.FixtureRequest) -> None:
    baseline: Baseline = request.config.stash[KNOWN]
    known = {(scene, method) for scene, method, _, _ in baseline.cells}
    assert known & {(case.scene.name, case.method) for case in GRID}


def test_every_method_promises_an_order_or_says_why_it_can_not():
    for case in GRID:
        assert isinstance(case.promise, Promise) or case.promise.reason.strip(), case.label


def test_every_promise_of_a_page_names_a_real_case_and_is_not_what_the_engine_promises_anyway():
    for page in PAGES:
        real = {
            (scene.name, f"{e.name} {e.variant}"): (scene, e) for scene in page.scenes for e in page.engines_of(scene)
        }
        for key, promise in page.orders.items():
            scene, engine = real[key]
            assert engine.order(scene.mechanism()) != promise, key


def test_every_known_deviation_names_a_real_case_and_a_check():
    for page in PAGES:
        real = {(scene.name, f"{e.name} {e.variant}") for scene in page.scenes for e in page.engines_of(scene)}
        for scene, method, check in page.known:
            assert (scene, method) in real, (scene, method)
            assert check in CHECKS, check


def test_the_grid_has_every_scene_of_every_page():
    assert {case.scene for case in GRID} == {scene for page in PAGES for scene in page.scenes}
    assert GRID


@pytest.mark.parametrize("scene", [pytest.param(scene, id=scene.name) for scene in SCENES])
def test_every_scene_of_the_list_is_taught_by_one_page_with_its_own_numbers(scene: Scene):
    assert not untaught([scene])
    assert [page.name for page in PAGES if scene in page.scenes] == [page_of(scene).name]


def test_a_page_teaches_only_scenes_of_the_list():
    assert {scene for page in PAGES for scene in page.scenes} == set(SCENES)


def test_a_scene_that_no_page_teaches_is_named():
    assert untaught((*SCENES, Disc())) == ("disc",)
    assert untaught(SCENES, [page for page in PAGES if page.name != "wheels"]) == ("car_and_trailer", "cart")
    assert page_of(Disc()) is None
