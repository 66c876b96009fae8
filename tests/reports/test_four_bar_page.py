"""Where methods fail on the four-bar: each experiment of the page ends as its words say."""

from __future__ import annotations

from dataclasses import replace

import pytest

from engines import pymunk
from reference.scenes.four_bar.scenes import DrivenFourBar, OverdrivenFourBar, Parallelogram, SpinningFourBar
from reports.model.cells import Cell
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.pages.four_bar import experiments as failures

BROKEN = {Outcome.TORN, Outcome.RESET, Outcome.DIVERGED, Outcome.BRANCH_FLIP, Outcome.SATURATED}


def run(scene, engine, every: int, samples: int | None = None) -> Measurement:
    return measure(Cell(scene, engine, every, "failure", samples), repeat=False)


def test_integrated_rates_drift_in_one_revolution_and_are_lost_in_a_hundred():
    scene = DrivenFourBar()
    errors = {}
    for revolutions in (1, 100):
        t = [i * scene.duration / 50 for i in range(50 * revolutions + 1)]
        run = scene.four_bar.integrate_rates(t, scene.rate, scene.start, rtol=failures.RATE_TOLERANCE)
        beta, _ = scene.four_bar.angles([scene.start + scene.rate * at for at in t])
        errors[revolutions] = abs(run.beta - beta)[run.beta == run.beta].max()
    # rtol 1e-3 of angles of a radian, made anew some ten times in a revolution, with nothing that takes it back.
    assert 1e-2 < errors[1] < 0.1
    assert errors[100] > 1


def test_where_few_sweeps_close_the_whole_gap_a_smaller_step_makes_the_change_point_worse():
    """pymunk's tuned variant avoids it: sweeps, and the part that is closed, follow from how fast sweeps converge."""
    few = replace(pymunk.TUNED, iterations=50, error_bias=0.0)
    assert Outcome(run(Parallelogram(), few, 10).outcome).comparable
    assert Outcome(run(Parallelogram(), few, 100).outcome) in BROKEN


@pytest.mark.parametrize("engine", failures.ALL, ids=lambda engine: f"{engine.name} {engine.variant}")
def test_no_engine_can_drive_a_crank_beyond_its_limit(engine):
    assert Outcome(run(OverdrivenFourBar(), engine, 1).outcome) in BROKEN


def test_the_reference_refuses_what_the_engines_try():
    (refusal,) = failures._refusal(Material({}))
    assert "can't close" in refusal.outcome


@pytest.mark.parametrize("engine", failures.ALL, ids=lambda engine: f"{engine.name} {engine.variant}")
def test_two_radians_of_the_crank_in_a_step_are_too_many_for_everyone(engine):
    assert Outcome(run(SpinningFourBar(), engine, 1, samples=5).outcome) in BROKEN
