"""Orders and plateaus of invented errors: the fit finds what was put in, and says when it can't."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reports.cells import FULL, Cell
from reports.errors import largest, root_mean_square
from reports.measure import measure
from reports.outcomes import Outcome
from reports.sweep import Verdict, fit, judged, sweeps
from tests.toys import Disc, FailingToy, Toy

STEPS = np.array([1e-2 / every for every in FULL])
ROUNDING = 1e-11


@pytest.mark.parametrize("order", [1, 2, 4])
def test_a_pure_power_gives_its_order_on_every_point_above_rounding(order):
    errors = 3 * STEPS**order
    verdict, found, points, spread, plateau = fit(STEPS, errors, ROUNDING)
    # A pure power in double precision: the slope is exact up to the rounding of logarithms.
    assert found == pytest.approx(order, abs=1e-9)
    assert points == np.sum(errors > ROUNDING)
    assert spread < 1e-9
    assert math.isnan(plateau)
    assert verdict == (Verdict.ROUNDING if errors[-1] <= ROUNDING else Verdict.FALLS)


@pytest.mark.parametrize(("order", "floor"), [(1, 1e-2), (2, 1e-5), (4, 1e-8)])
def test_a_floor_above_rounding_is_a_plateau_and_leaves_the_order_alone(order, floor):
    verdict, found, points, _, plateau = fit(STEPS, (10 * STEPS) ** order + floor, ROUNDING)
    assert verdict is Verdict.PLATEAU
    # The flat end still carries C h^p below a third of the floor, and the falling part up to a third of the floor.
    assert plateau == pytest.approx(floor, rel=0.4)
    assert found == pytest.approx(order, abs=0.35 * order)
    assert points >= 2


def test_an_error_that_starts_at_its_plateau_has_no_order():
    verdict, order, points, _, _ = fit(STEPS, STEPS**4 + 1e-8, ROUNDING)
    assert (verdict, points) == (Verdict.PLATEAU, 0)
    assert math.isnan(order)


def test_a_floor_of_rounding_is_not_a_plateau_even_if_it_grows_with_the_number_of_steps():
    verdict, order, _, _, plateau = fit(STEPS, STEPS**4 + 1e-16 / STEPS, ROUNDING)
    assert verdict is Verdict.ROUNDING
    assert order == pytest.approx(4, abs=0.05)
    assert math.isnan(plateau)


def test_an_error_that_grows_as_the_step_shrinks_is_told_apart():
    assert fit(STEPS, 1e-6 / STEPS, ROUNDING)[0] is Verdict.GROWS


def test_coarse_steps_before_the_asymptotic_slope_do_not_bend_the_order():
    errors = STEPS**2 + 2e9 * STEPS**6
    _, order, points, _, _ = fit(STEPS, errors, 0.0)
    assert order == pytest.approx(2, abs=0.1)
    assert 3 <= points < len(STEPS)


@pytest.mark.parametrize(
    ("steps", "errors", "verdict", "points"),
    [
        ([], [], Verdict.TOO_FEW, 0),
        ([1e-2], [1e-3], Verdict.TOO_FEW, 0),
        ([1e-2, 1e-3], [1e-3, math.nan], Verdict.TOO_FEW, 0),
        ([1e-2, 1e-3], [1e-3, 1e-4], Verdict.FALLS, 2),
        ([1e-2, 1e-3], [1e-3, 1e-3], Verdict.LEVELS, 0),
        ([1e-2, 1e-3], [1e-14, 0.0], Verdict.ROUNDING, 0),
    ],
)
def test_too_few_points_are_said_to_be_too_few(steps, errors, verdict, points):
    found = fit(steps, errors, ROUNDING)
    assert (found[0], found[2]) == (verdict, points)


def test_two_points_never_make_a_plateau_or_a_convergence():
    rows = [measure(Cell(Disc(), Toy(), every), repeat=False) for every in (1, 3)]
    assert {row.outcome for row in judged(rows)} == {Outcome.FINISHED}


def test_measured_cells_give_the_order_and_the_plateau_that_the_engine_was_made_with():
    engines = [Toy("first", order=1.0), Toy("fourth", order=4.0, factor=1e3), Toy("soft", plateau=1e-5)]
    rows = [measure(Cell(Disc(), engine, every), repeat=False) for engine in engines for every in FULL]
    angle = {sweep.variant: sweep for sweep in sweeps(rows) if sweep.quantity.name == "angle"}
    assert angle["first"].order == pytest.approx(1, abs=1e-3)
    assert angle["fourth"].order == pytest.approx(4, abs=1e-3)
    assert angle["soft"].verdict is Verdict.PLATEAU
    assert angle["soft"].plateau == pytest.approx(1e-5, rel=0.4)
    outcomes = {row.variant: row.outcome for row in judged(rows)}  # of the finest step
    assert outcomes == {"first": "converged", "fourth": "converged", "soft": "plateau"}


def test_failed_cells_are_left_out_of_a_fit():
    rows = [measure(Cell(Disc(), FailingToy("saturate"), every), repeat=False) for every in (1, 3, 10)]
    assert all(sweep.verdict is Verdict.TOO_FEW for sweep in sweeps(rows))


def test_errors_over_nothing_known_are_unknown_and_infinite_ones_are_not_hidden():
    assert math.isnan(largest(np.array([np.nan])))
    assert math.isnan(root_mean_square(np.array([])))
    assert largest(np.array([1.0, -np.inf, np.nan])) == np.inf
