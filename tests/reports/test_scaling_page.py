"""Scaling: the long chain knows what linear algebra finds, exponents are those of known laws, the page is whole."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import Lagrange
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.many_links import LongPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reports.cli.selection import QUICK_MOST, choose_cells
from reports.model.cells import Cell, estimated_seconds
from reports.model.measure import measure
from reports.model.page import Material
from reports.model.scaling_fit import series_of
from reports.pages.pendulum import page as pendulum
from reports.pages.rendering import render_page
from reports.pages.scaling.experiments import BandedChain
from reports.pages.scaling.page import CELLS, COSTLY, PAGE, SMALL, STEP
from reports.pages.skate import page as skate


def links(cell: Cell) -> int:
    assert isinstance(cell.scene, LongPendulum)
    return cell.scene.links


TINY = tuple(cell for cell in CELLS if links(cell) <= 3)


@pytest.fixture(scope="module")
def material():
    return Material({cell: measure(cell, repeat=False) for cell in TINY})


def test_what_the_long_chain_knows_is_what_linear_algebra_finds():
    long, plain = LongPendulum(7, tip=3.0).mechanism(), LinkPendulum(7, tip=3.0).mechanism()
    assert long.degrees_of_freedom() == plain.degrees_of_freedom()
    truth = LongPendulum(7, tip=3.0)
    angle, rate = truth.states([0.2, 0.5])
    pose, _, acceleration = truth.chain.placement(angle, rate, truth.chain.accelerations(angle, rate))
    # Forces of up to 1e3 N; the plain mechanism solves 14 rows of condition 1e3 for them.
    assert long.reaction(pose, acceleration) == pytest.approx(plain.reaction(pose, acceleration), abs=1e-8)
    assert long.reaction(pose, acceleration) == pytest.approx(truth.motion([0.2, 0.5]).reaction, abs=1e-8)


def test_the_reference_as_a_method_is_of_order_four():
    scene = LongPendulum(5)
    errors = []
    for steps in (100, 200):
        run = BandedChain().build(scene.mechanism(), scene.duration / steps)(1, steps)
        errors.append(np.abs(run.pose[-1] - scene.motion([scene.duration]).pose[0]).max())
    assert math.log2(errors[0] / errors[1]) == pytest.approx(4, abs=0.3)


def test_the_reference_reads_reactions_of_the_same_sign_as_exact_multipliers():
    mechanism = LongPendulum(3).mechanism()
    ours, exact = (e.build(mechanism, 1e-3)(1, 10).reaction for e in (BandedChain(), Lagrange("rk4", "projection")))
    assert ours == pytest.approx(exact, abs=1e-6)  # N of 30; both integrated with an error of 1e-10


def test_the_reference_refuses_what_is_no_chain_of_uniform_bars():
    chain = LongPendulum(3).mechanism()
    heavy = replace(chain.bodies[1], inertia=1.01 * chain.bodies[1].inertia)
    for mechanism, why in (
        (FreeFourBar().mechanism(), "as many pins"),
        (replace(chain, bodies=(chain.bodies[0], heavy, chain.bodies[2])), "not uniform"),
        (replace(chain, gravity=(1.0, -9.81)), "gravity along y"),
    ):
        with pytest.raises(Unsupported, match=why):
            BandedChain().build(mechanism, STEP)


def test_every_cell_has_the_same_step_and_the_largest_are_run_for_their_cost_alone():
    assert {round(cell.step / STEP, 9) for cell in CELLS} == {1.0}
    assert all(cell.scene.duration < 0.5 for cell in CELLS if links(cell) in COSTLY)
    assert len({cell.key for cell in CELLS}) == len(CELLS)


def test_a_quick_run_has_the_small_chains_and_a_full_one_all():
    pendulums = tuple(scene for scene in SCENES if pendulum.PAGE.teaches(scene))
    engines = tuple(dict.fromkeys(cell.engine for cell in CELLS))
    for full in (False, True):
        chosen = [c for c in choose_cells(pendulums, engines, (PAGE,), full) if isinstance(c.scene, LongPendulum)]
        quick = [cell for cell in CELLS if links(cell) in SMALL and estimated_seconds(cell) <= QUICK_MOST]
        assert chosen == (list(CELLS) if full else quick)
    others = tuple(scene for scene in SCENES if skate.PAGE.teaches(scene))
    assert not any(isinstance(c.scene, LongPendulum) for c in choose_cells(others, engines, (PAGE,), True))


def test_costs_are_of_a_step_and_errors_of_whole_runs_alone(material):
    for series in series_of(material.rows, 0.5):
        for point in series.points:
            assert 1e-8 < point.step < 1  # s: a step, not a simulated second
            assert point.error < 0.1
    timed_only = series_of(material.rows, 0.6)
    assert all(math.isnan(point.error) and point.step > 0 for series in timed_only for point in series.points)


def test_the_page_is_whole_with_rows_and_without(material):
    files = render_page(PAGE, material, "the command")
    assert "scaling_cost.svg" in files
    for method in {row.method for row in material.rows.values()}:
        assert files["scaling.md"].count(f"| {method} |") == 3, method
    assert "Nothing was run yet" in render_page(PAGE, Material({}), "the command")["scaling.md"]
