"""The steps that people use: which cells they add to the grid, and of which methods."""

from __future__ import annotations

import pytest

from reports.model.catalogue import PAGES
from reports.model.cells import COST_LIMIT, FULL, Cell, estimated_cost, sweep_cells
from reports.model.usual_steps import FEATURED, USUAL_STEPS, is_step, usual_cells, usual_variants
from tests.toys import Disc, Toy

# Samples 10, 9.97, 20 and 50 ms apart, and scenes of 0.3 to 10 s; chains are left out, whose costs take long to tell.
NAMES = (
    "driven_four_bar",
    "free_four_bar",
    "sleigh",
    "pendulum_1",
    "rolling_in_ring",
    "elliptic_gears",
    "person_two_feet",
)
SCENES = [(page, scene) for page in PAGES for scene in page.scenes if scene.name in NAMES]


@pytest.mark.parametrize(("page", "scene"), SCENES, ids=[scene.name for _, scene in SCENES])
def test_a_scene_is_run_at_each_usual_step_once_within_a_hundredth(page, scene):
    engines = [engine for engine in page.engines_of(scene) if engine.variant in FEATURED]
    swept = sweep_cells((scene,), engines, FULL)
    cells = [*swept, *usual_cells((scene,), engines)]
    for engine in engines:
        for step in USUAL_STEPS.values():
            own = [cell for cell in cells if cell.engine == engine and abs(cell.step / step - 1) < 0.01]
            dear = estimated_cost(Cell(scene, engine, max(1, round(scene.spacing / step)))) > 0.9 * COST_LIMIT
            assert len(own) == 1 or (dear and not own), (engine.name, engine.variant, step)
    added = [cell for cell in cells if cell.purpose == "usual"]
    assert all(any(is_step(cell.step, step) for step in USUAL_STEPS.values()) for cell in added)
    assert all(cell.step * cell.every * cell.sample_count == pytest.approx(scene.duration) for cell in added)
    assert all(estimated_cost(cell) <= COST_LIMIT for cell in added)


def test_a_step_that_the_sweep_has_is_not_run_twice_and_one_that_it_left_out_for_its_cost_is_not_run():
    # Samples 1e-2 s apart: ten steps between them are 1 ms, which the sweep has.
    cells = usual_cells((Disc(),), (Toy("default"),))
    assert [(cell.every, cell.samples) for cell in cells if is_step(cell.step, 1e-3)] == []
    assert [round(cell.step, 6) for cell in cells] == [0.016667, 0.002]


def test_the_usual_variants_are_the_three_words_in_their_order_or_the_first_of_others():
    methods = [("a", "tuned"), ("a", "x"), ("a", "default"), ("b", "one"), ("b", "two"), ("b", "three"), ("b", "four")]
    assert usual_variants(methods) == {"a": ("default", "tuned"), "b": ("one", "two", "three")}
    engines = (Toy("default"), Toy("soft"), Toy("one", name="b"), Toy("two", name="b"))
    chosen = {(cell.engine.name, cell.engine.variant) for cell in usual_cells((Disc(),), engines)}
    assert chosen == {("toy", "default"), ("b", "one"), ("b", "two")}
