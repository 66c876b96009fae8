"""What remarks under experiments on skates, wheels and rolling say is what the rows of these experiments say."""

from __future__ import annotations

import pytest

from engines import mujoco, pymunk
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.scenes.wheels.cart import Cart
from reports.model.cells import Cell
from reports.model.measure import measure
from reports.model.outcomes import Outcome
from reports.pages.rolling import experiments as rolling_failures
from reports.pages.rolling.experiments import polygon_cells, softness_cells
from reports.pages.skate import experiments as skate_failures
from tests.committed_rows import committed_rows


def rows_of(experiment, failures):
    (found,) = [failure for failure in failures if failure.title == experiment]
    rows = committed_rows(found.cells)
    assert rows, f"no row of {experiment!r} is published"
    return list(rows.values())


def test_steps_far_too_large_open_the_contact_more_at_larger_steps_and_no_engine_warns():
    (found,) = [failure for failure in rolling_failures.FAILURES if failure.title == "Steps far too large"]
    rows = [measure(cell, repeat=False) for cell in found.cells]
    for method in {row.method for row in rows}:
        own = sorted((row for row in rows if row.method == method), key=lambda row: row.step)
        gaps = [row.gap for row in own]
        assert gaps == sorted(gaps)
        assert all(row.outcome == Outcome.TORN and "without a warning" in row.sentence for row in own)
        assert gaps[0] > 0.2 * found.cells[0].scene.mechanism().length_scale


def test_corners_alone_make_the_error_of_a_coarse_polygon_and_with_512_the_step_still_has_a_part():
    rows = committed_rows([cell for _, cell in polygon_cells()])
    angle = {(corners, cell.every): rows[cell].angle for corners, cell in polygon_cells()}
    for corners in (32, 128):
        assert angle[corners, 100] == pytest.approx(angle[corners, 10], rel=0.05)
    assert 0.7 < angle[512, 100] / angle[512, 10] < 0.9


def test_a_soft_contacts_error_is_its_time_constants_and_a_stiff_ones_is_the_steps_too():
    rows = committed_rows([cell for _, cell in softness_cells()])
    angle = {(constant, cell.every): rows[cell].angle for constant, cell in softness_cells()}
    assert angle[2e-2, 10] == pytest.approx(angle[2e-2, 100], rel=0.05)
    assert abs(angle[6e-3, 10] / angle[6e-3, 100] - 1) > 0.2
    assert angle[2e-3, 10] > 2 * angle[2e-3, 100]
    # The shortest constant is not the best one.
    assert angle[2e-4, 100] > angle[6e-4, 100]


def test_a_second_wheel_on_an_axle_changes_no_methods_position_error():
    for scene, doubled in ((CarAndTrailer(), CarAndTrailer(redundant=True)), (Cart(), Cart(redundant=True))):
        for engine in (pymunk.DEFAULT, pymunk.TUNED, mujoco.DEFAULT, mujoco.TUNED):
            for every in (1, 10):
                one, two = Cell(scene, engine, every), Cell(doubled, engine, every, "failure")
                rows = committed_rows([one, two])
                assert rows[two].position == pytest.approx(rows[one].position, rel=0.01)


def test_mujocos_default_blade_does_not_creep_at_rest_and_its_tuned_row_does():
    rows = {(row.method, row.step): row for row in rows_of("At rest across a slope", skate_failures.FAILURES)}
    assert rows["pymunk default", 0.01].position == 0
    for step in (0.01, 0.001):
        assert rows["mujoco default", step].position < 1e-12
        assert rows["mujoco tuned", step].position > 1e-7


def test_the_naive_zeroing_is_the_same_construction_as_pymunks_default():
    zeroed = next(engine for engine in skate_failures.NAIVE if "centre" in engine.variant)
    assert isinstance(zeroed, pymunk.Pymunk)
    assert pymunk.DEFAULT.skate == zeroed.skate == "centre"
