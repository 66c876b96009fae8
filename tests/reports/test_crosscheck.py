"""Runs the tests of the grid, which are in `reports.gate.grid_tests`."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from engines import method_name, registry
from reference.scenes.catalogue import SCENES
from reports.gate.change import Baseline, Old
from reports.gate.grid_tests import (
    pytest_generate_tests,
    test_a_method_gives_the_numbers_of_the_baseline,
    test_a_method_is_as_exact_as_theory_promises,
    test_the_grid_has_every_scene_and_method_of_the_baseline,
    test_with_other_versions_no_method_is_worse_over_all_its_scenes,
)
from reports.gate.pytest_plugin import KNOWN
from reports.model.catalogue import PAGES, page_of
from reports.model.checks import CHECKS
from reports.model.outcomes import Outcome
from tests.toys import Disc

__all__ = [
    "pytest_generate_tests",
    "test_a_method_gives_the_numbers_of_the_baseline",
    "test_a_method_is_as_exact_as_theory_promises",
    "test_the_grid_has_every_scene_and_method_of_the_baseline",
    "test_with_other_versions_no_method_is_worse_over_all_its_scenes",
]


def test_every_promise_of_a_page_is_of_a_real_case_and_is_not_what_the_engine_promises_anyway():
    for page in PAGES:
        real = {(scene.name, method_name(e)): (scene, e) for scene in page.scenes for e in page.engines_of(scene)}
        for key, promise in page.orders.items():
            scene, engine = real[key]
            assert engine.order(scene.mechanism()) != promise, key


def test_every_known_deviation_names_a_real_case_and_a_check():
    for page in PAGES:
        real = {(scene.name, method_name(e)) for scene in page.scenes for e in page.engines_of(scene)}
        for (scene, method, check), deviation in page.known.items():
            assert (scene, method) in real, (scene, method)
            assert check in CHECKS, check
            assert (check == "outcome") == (deviation.outcome is not None), (scene, method, check)


def test_what_an_engine_that_is_not_installed_leaves_out_is_skipped_by_its_extra_and_any_other_loss_fails(monkeypatch):
    missing = Baseline({("disc", "gone default", 20, 1): Old(Outcome.FINISHED, {})})
    request: Any = SimpleNamespace(config=SimpleNamespace(stash={KNOWN: missing}))
    with pytest.raises(AssertionError, match="has lost what the baseline has: disc-gone default"):
        test_the_grid_has_every_scene_and_method_of_the_baseline(request)
    monkeypatch.setattr(registry, "ABSENT", {"gone": 'gone is not installed: pip install "planar-crosscheck[gone]"'})
    with pytest.raises(pytest.skip.Exception, match=r"planar-crosscheck\[gone\]"):
        test_the_grid_has_every_scene_and_method_of_the_baseline(request)


def test_every_scene_of_the_list_is_taught_by_one_page_with_its_own_numbers():
    for scene in SCENES:
        assert [page for page in PAGES if scene in page.scenes] == [page_of(scene)]
    assert page_of(Disc()) is None
