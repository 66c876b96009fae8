"""Tests of steps and costs of cells, of fits of power laws, and of the page "scaling"."""

from __future__ import annotations

import math
from dataclasses import dataclass

import pytest

from engines import ConvergenceOrder, NotDeclared
from reference.scenes.pendulum.scenes import LinkPendulum, LongPendulum
from reports.cli.selection import BadInput, steps_per_sample
from reports.model.cells import COST_LIMIT, FULL, QUICK, Cell, estimated_cost, sweep_cells
from reports.model.outcomes import Outcome
from reports.pages.scaling.page import MethodSeries, SizePoint, cost_table, crossing, series_of
from reports.write.rows import Rows
from tests.rows import row_of, table
from tests.toys import Disc, Toy


def test_the_banded_solver_and_a_dense_solver_give_equal_forces():
    long, plain = LongPendulum(7, tip=3.0).mechanism(), LinkPendulum(7, tip=3.0).mechanism()
    assert long.degrees_of_freedom() == plain.degrees_of_freedom()
    truth = LongPendulum(7, tip=3.0)
    angle, rate = truth.states([0.2, 0.5])
    pose, _, acceleration = truth.chain.placement(angle, rate, truth.chain.accelerations(angle, rate))
    # The tolerance covers forces of 1e3 N and a condition number of 1e3 in the dense solver.
    assert long.reaction(pose, acceleration) == pytest.approx(plain.reaction(pose, acceleration), abs=1e-8)
    assert long.reaction(pose, acceleration) == pytest.approx(truth.motion([0.2, 0.5]).reaction, abs=1e-8)


@dataclass(frozen=True)
class ToyChain(Disc):
    links: int = 1


def test_each_point_of_a_series_has_the_numbers_of_its_cell():
    def cell(links, duration=0.2, every=1, variant="tuned"):
        return Cell(ToyChain(links=links, duration=duration), Toy(variant), every, "growth", 10)

    rows = {
        cell(100): row_of("toy tuned", cpu=7e-3, angle=1.3e-3),
        cell(10): row_of("toy tuned", cpu=3e-3, angle=1.1e-3),
        cell(1000, 0.01): row_of("toy tuned", cpu=5e-3, angle=1.7e-3),
        cell(2000, 0.01, 2): row_of("toy tuned", cpu=11e-3, angle=9.0, outcome=Outcome.SATURATED),
        cell(50): row_of("toy tuned", cpu=13e-3, angle=9.0, outcome=Outcome.TORN),
        cell(10, variant="other"): row_of("toy other", cpu=17e-3, angle=1.9e-3),
    }
    tuned, other = series_of(rows, 0.2)
    assert (tuned.method, other.method) == ("toy tuned", "toy other")
    assert [p.size for p in tuned.points] == [10, 50, 100, 1000, 2000]
    # The CPU time of a step is the CPU time per simulated second times the step.
    assert [p.step for p in tuned.points] == pytest.approx([6e-5, math.nan, 1.4e-4, 5e-6, 5.5e-6], nan_ok=True)
    # Rows of short runs and rows of failed runs have no error.
    assert [p.error for p in tuned.points] == pytest.approx([1.1e-3, math.nan, 1.3e-3, math.nan, math.nan], nan_ok=True)
    assert [p.outcome for p in tuned.points] == ["finished", "torn", "finished", "finished", "saturated"]
    assert (other.points[0].step, other.points[0].error) == (pytest.approx(3.4e-4), 1.9e-3)


def test_a_step_must_divide_the_sampling_to_ten_digits():
    scene = Disc()
    assert steps_per_sample(scene, scene.spacing / 7) == 7
    assert steps_per_sample(scene, scene.spacing / 7 * (1 + 1e-10)) == 7
    assert steps_per_sample(scene, scene.spacing) == 1
    for wrong in (1.001, 0.999, 1 + 1e-7):
        with pytest.raises(BadInput, match=r"does not divide .* --every 7"):
            steps_per_sample(scene, scene.spacing / 7 * wrong)
    with pytest.raises(BadInput, match="--every 1"):
        steps_per_sample(scene, 1.0)
    for step in (0.0, -1.0, math.nan, math.inf):
        with pytest.raises(BadInput, match="greater than zero"):
            steps_per_sample(scene, step)


@dataclass(frozen=True)
class Costly(Toy):
    cost: float = 3e-3

    def step_cost(self, mechanism):
        return self.cost


def test_a_grid_has_each_step_below_the_cost_limit_and_always_the_largest_step():
    assert (QUICK, FULL) == ((1, 3, 10), (1, 3, 10, 30, 100, 300))
    # A step takes 0.2 ms, so 20 samples with 200 steps each take the limit of 0.8 s.
    cells = sweep_cells((Disc(),), (Costly(cost=2e-4),), FULL)
    assert [cell.every for cell in cells] == [1, 3, 10, 30, 100]
    assert estimated_cost(cells[-1]) <= COST_LIMIT < estimated_cost(Cell(Disc(), Costly(cost=2e-4), 300))
    assert [cell.every for cell in sweep_cells((Disc(),), (Costly(cost=10.0),), FULL)] == [1]


@pytest.mark.parametrize(
    ("order", "finest"),
    [
        (ConvergenceOrder(1), 300),
        (ConvergenceOrder(4), 100),
        (ConvergenceOrder(5), 30),
        (ConvergenceOrder(8), 10),
        (NotDeclared("?"), 300),
    ],
)
def test_a_grid_ends_at_the_step_at_which_the_declared_order_has_divided_the_error_by_1e8(order, finest, monkeypatch):
    monkeypatch.setattr(Toy, "order", lambda toy, mechanism: order)
    assert max(cell.every for cell in sweep_cells((Disc(),), (Toy(f"of {order}"),), FULL)) == finest


def test_a_cost_table_is_in_microseconds_and_a_crossing_is_where_the_first_method_becomes_more_expensive():
    def line(*costs):
        return MethodSeries("e", "v", tuple(SizePoint(10**n, cost, 0.1, "torn") for n, cost in enumerate(costs)))

    cells = table(cost_table((line(1e-6, 1e-4, math.nan),)))
    assert cells == [["method", "1", "10", "100"], ["e v", "1", "100", "**torn**"]]
    crossings = [crossing(line(*costs), line(3, 3, 3)) for costs in ((1, 2, 9), (1, 4, 9), (9, 2, 1), (1, 1, 1))]
    assert crossings == [(10, 100), (1, 10), None, None]
    rows = [row_of("toy x", step=step) for step in (1e-2, 1e-3, 1e-4)]
    near = [Rows(rows).near(step) for step in (1.9e-3, 5.1e-3, 2.9e-3)]
    assert [row.step if row else None for row in near] == [1e-3, 1e-2, None]
