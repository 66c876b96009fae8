"""Tests of the fit of orders and plateaus to invented errors, and of runs at the steps that people use."""

from __future__ import annotations

import math

import numpy as np
import pytest

from reports.model.cells import (
    FULL,
    USUAL_STEPS,
    Cell,
    is_run_at,
    is_step,
    usual_cells,
)
from reports.model.convergence import Verdict, by_method, fit, judged, sweeps
from reports.model.measure import measure
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES
from reports.write.rows import Rows
from reports.write.unmeasured import UNMEASURED
from tests.rows import falling, row_of
from tests.toys import Disc, Toy

STEPS = np.array([1e-2 / every for every in (*FULL, 1000)])
ROUNDING = 1e-11


@pytest.mark.parametrize(("order", "floor"), [(1, 1e-2), (4, 1e-8)])
def test_a_floor_above_rounding_is_a_plateau_and_leaves_the_order_alone(order, floor):
    result = fit(STEPS, (10 * STEPS) ** order + floor, ROUNDING)
    assert result.verdict is Verdict.PLATEAU
    # The limit is fitted together with a power of the step, so it is exact up to rounding.
    assert result.plateau == pytest.approx(floor, rel=1e-6)
    # The floor is a part of each error, so it reduces the fitted order by up to a third.
    assert result.order == pytest.approx(order, abs=0.35 * order)
    assert result.points >= 2
    power = fit(STEPS, 3 * STEPS**order, ROUNDING)
    # The slope of a pure power is exact up to the rounding of logarithms.
    assert power.order == pytest.approx(order, abs=1e-9)
    assert power.points == np.sum(3 * STEPS**order > ROUNDING)
    assert power.verdict is (Verdict.ROUNDING if order == 4 else Verdict.FALLS)


@pytest.mark.parametrize("factor", [2.0, -0.09])
def test_a_plateau_is_the_limit_at_a_step_of_zero_and_no_mean_of_the_points_before_it(factor):
    errors = 1e-3 + factor * STEPS
    result = fit(STEPS, errors, ROUNDING)
    assert result.verdict is Verdict.PLATEAU
    assert result.plateau == pytest.approx(1e-3, rel=1e-6)
    # The uncertainty is the difference between the finest error and the limit.
    assert result.uncertainty == pytest.approx(abs(errors[-1] - 1e-3), rel=1e-3)
    mean = np.exp(np.mean(np.log(errors[-4:])))
    assert abs(mean - 1e-3) > 4 * result.uncertainty  # the mean of the last errors differs by more than the uncertainty


def test_an_error_that_changes_sign_and_rises_to_a_limit_has_a_plateau_above_its_smallest_value():
    # Two errors of opposite sign cancel at 5e-4 s; at all smaller steps their sum is larger.
    steps = STEPS[:6]
    errors = abs(1e-3 - 2 * steps)
    rows = [row_of("a x", step=step, angle=error) for step, error in zip(steps, errors, strict=True)]
    sweep = by_method(sweeps(rows), "angle")["disc", "a", "x"]
    assert sweep.verdict is Verdict.PLATEAU
    assert sweep.plateau == pytest.approx(1e-3, rel=1e-6)
    assert sweep.best < 0.5e-3
    assert sweep.lucky
    assert fit(steps[:5], errors[:5], ROUNDING).verdict is Verdict.ERRATIC  # a single rise is no evidence of a limit
    fallen = sweeps(falling("a x", (1e-2, 2e-3, 1.1e-3, 1.01e-3, 1e-3)))
    assert not by_method(fallen, "angle")["disc", "a", "x"].lucky


def test_scattered_errors_have_the_plateau_of_the_finest_step_with_their_scatter_as_uncertainty():
    result = fit(STEPS[:5], [1e-2, 1.2e-3, 1.0e-3, 1.15e-3, 1.1e-3], ROUNDING)
    assert (result.verdict, result.plateau) == (Verdict.PLATEAU, 1.1e-3)
    assert result.uncertainty == pytest.approx(1e-4)
    faster = fit(STEPS[:5], [1e-2, 1.0e-3, 1.1e-3, 1.15e-3, 1.3e-3], ROUNDING)  # errors rise at each smaller step
    assert (faster.verdict, faster.plateau) == (Verdict.PLATEAU, 1.3e-3)
    assert faster.uncertainty == pytest.approx(2e-4)


def test_a_floor_of_rounding_is_not_a_plateau_even_if_it_grows_with_the_number_of_steps():
    result = fit(STEPS, STEPS**4 + 1e-16 / STEPS, ROUNDING)
    assert result.verdict is Verdict.ROUNDING
    assert result.order == pytest.approx(4, abs=0.05)
    assert math.isnan(result.plateau)


def test_coarse_steps_before_the_asymptotic_slope_do_not_bend_the_order():
    errors = STEPS**2 + 2e9 * STEPS**6
    result = fit(STEPS, errors, 0.0)
    assert result.order == pytest.approx(2, abs=0.1)
    assert 3 <= result.points < len(STEPS)


@pytest.mark.parametrize(
    ("errors", "verdict", "points"),
    [
        ([], Verdict.TOO_FEW, 0),
        ([1e-3, math.nan], Verdict.TOO_FEW, 0),
        ([1e-3, 1e-4], Verdict.FALLS, 2),
        ([1e-14, 0.0], Verdict.ROUNDING, 0),
        ([1e-2, 1e-4, 1e-6, math.inf], Verdict.FALLS, 3),  # an unknown error is left out
        ([1e-2, 2e-5, 2e-5, 2e-5], Verdict.PLATEAU, 0),
        ([1e-8, 1e-8, 1e-8, 1e-8], Verdict.PLATEAU, 0),  # all errors are on the plateau
        ([1e-2, 1e-4, 1e-6, 1e-6], Verdict.LEVELS, 3),
        ([1e-6, 1e-5, 1e-4, 1e-3], Verdict.GROWS, 0),
        ([1e-2, 1e-4, 1e-6, 1e-3], Verdict.ERRATIC, 3),
        # An error is below rounding by chance, and then rises to more or less than a hundred times rounding.
        ([1e-3, 1e-13, 1e-9, 1.01e-9], Verdict.LEVELS, 2),
        ([1e-3, 1e-13, 1e-10, 0.99e-9], Verdict.ROUNDING, 0),
    ],
)
def test_verdicts_by_hand(errors, verdict, points):
    steps = [1e-1, 1e-2, 1e-3, 1e-4][: len(errors)]
    result = fit(steps, errors, ROUNDING)
    assert (result.verdict, result.points) == (verdict, points)
    assert fit(steps[::-1], errors[::-1], ROUNDING)[:3] == pytest.approx(result[:3], nan_ok=True)
    assert math.isnan(result.order) == (points == 0)


def test_the_order_is_that_of_least_squares_with_how_far_the_furthest_slope_is_from_it():
    # the three slopes are 1, 1 and 2
    _, order, points, spread, _, _ = fit([1e-1, 1e-2, 1e-3, 1e-4], [1e-2, 1e-3, 1e-4, 1e-6], 0.0)
    assert (order, points, spread) == (pytest.approx(1.3), 4, pytest.approx(0.7))


def test_measured_cells_give_the_order_and_the_plateau_that_the_engine_was_made_with():
    engines = [Toy("first", power=1.0), Toy("fourth", power=4.0, factor=1e3), Toy("soft", plateau=1e-5)]
    rows = [measure(Cell(Disc(), engine, every), repeat=False) for engine in engines for every in FULL]
    angle = {sweep.variant: sweep for sweep in sweeps(rows) if sweep.quantity.name == "angle"}
    assert angle["first"].order == pytest.approx(1, abs=1e-3)
    assert angle["fourth"].order == pytest.approx(4, abs=1e-3)
    assert angle["soft"].verdict is Verdict.PLATEAU
    assert angle["soft"].plateau == pytest.approx(1e-5, rel=1e-3)
    outcomes = {row.variant: row.outcome for row in judged(rows)}
    assert outcomes == {"first": "converged", "fourth": "converged", "soft": "plateau"}


def test_a_sweep_is_of_one_method_in_one_scene_with_each_quantity_its_own():
    rows = []
    for scene, method, shift in (("one", "a x", 0), ("two", "a x", 1), ("one", "b x", 2)):
        for step in (1e-3, 1e-1, 1e-2):
            errors = {q.name: 1e-2 * step ** (1 + shift) * (i + 2) for i, q in enumerate(QUANTITIES)}
            rows.append(row_of(method, scene=scene, step=step, **errors))
    rows.append(row_of("a x", scene="one", step=1e-4, angle=1e-30, outcome=Outcome.SATURATED))
    rows.append(row_of("a x", scene="one", step=1e-5, angle=1e-30, purpose="failure"))
    result = sweeps(rows)
    assert len(result) == 3 * len(QUANTITIES)
    for i, q in enumerate(QUANTITIES):
        sweeps_of_quantity = by_method(result, q.name)
        for shift, key in enumerate((("one", "a", "x"), ("two", "a", "x"), ("one", "b", "x"))):
            sweep = sweeps_of_quantity[key]
            assert (sweep.scene, sweep.engine, sweep.variant, sweep.quantity) == (*key, q)
            assert sweep.method == " ".join(key[1:])
            assert (sweep.best, sweep.best_step) == (pytest.approx(1e-2 * 1e-3 ** (1 + shift) * (i + 2)), 1e-3)
    assert by_method(result, "angle")["one", "a", "x"].order == pytest.approx(1.0)
    assert by_method(result, "angle")["two", "a", "x"].order == pytest.approx(2.0)


def judgements(*errors: float, quantity: str = "angle") -> list[str]:
    return [r.outcome for r in judged(falling("a x", errors, quantity), quantity)]


def test_a_sweep_judges_its_rows():
    assert judgements(1e-2, 1e-4, 1e-6) == ["converged"] * 3
    assert judgements(1e-2, 1e-4) == ["finished"] * 2  # two points do not confirm a slope
    assert judgements(1e-2, 1e-12) == ["converged"] * 2
    # Only rows with errors near the plateau have the outcome "plateau".
    assert judgements(1e-2, 3.1e-5, 1e-5, 1e-5, 1e-5) == ["finished", "finished", "plateau", "plateau", "plateau"]
    assert judgements(1e-2, 1e-4, 1e-6, 1e-6) == ["finished"] * 4  # the error may have changed its sign
    assert judgements(1e-6, 1e-5, 1e-4) == ["finished"] * 3
    assert judgements(1e-2, 1e-4, 1e-6, quantity="position") == ["converged"] * 3
    assert judgements(1e-2, 3.1e-5, 1e-5, 1e-5, 1e-5, quantity="position") == ["finished"] * 2 + ["plateau"] * 3


def test_the_best_row_has_the_least_error_of_those_that_can_be_compared():
    rows = [
        row_of("a x", angle=1e-3, position=1e-9, step=1e-1),
        row_of("a x", angle=1e-5, position=1e-2, step=1e-2),
        row_of("a x", angle=1e-4, position=1e-5, step=1e-3),
        row_of("a x", angle=1e-9, step=1e-4, outcome=Outcome.RESET),
        row_of("a x", angle=math.nan, step=1e-5),
        row_of("a y", angle=1e-12),
        row_of("b x", angle=1e-12),
    ]
    assert Rows(rows).of(method="a x").best().step == 1e-2
    assert Rows(rows).of(method="a x").best("position").step == 1e-1
    assert Rows(rows).of(method="c x").best() is UNMEASURED
    assert Rows(rows[3:5]).best() is UNMEASURED


def test_a_habit_of_one_engines_users_is_no_step_of_another_engine_that_has_its_own_and_of_no_code_of_ours():
    assert is_run_at("1/60 s", "pymunk", "default")
    assert is_run_at("2 ms", "mujoco", "tuned")
    others = (("1/60 s", "mujoco", "default"), ("2 ms", "pymunk", "tuned"), ("2 ms", "mujoco", "extended"))
    assert not any(is_run_at(*other) for other in (*others, ("1/60 s", "lagrange", "rk4 projection")))
    assert all(is_run_at(name, "theirs", "default") for name in USUAL_STEPS)
    assert all(is_run_at("1 ms", *method) for method in (("pymunk", "extended"), ("lagrange", "rk4 projection")))


def test_a_step_that_the_sweep_has_is_not_run_twice_and_one_that_it_left_out_for_its_cost_is_not_run():
    # Samples are 1e-2 s apart, so the sweep has the step 1 ms.
    cells = usual_cells((Disc(),), (Toy("default"),))
    assert [(cell.every, cell.samples) for cell in cells if is_step(cell.step, 1e-3)] == []
    assert [round(cell.step, 6) for cell in cells] == [0.016667, 0.002]
