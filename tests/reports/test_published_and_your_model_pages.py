"""Tests of the pages "published" and "your_model": numbers agree with independent computations."""

from __future__ import annotations

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, TUNED
from engines.pymunk import TUNED as PYMUNK
from reports.model.page import Material
from reports.model.tasks import Answer, answered
from reports.pages.published.experiments import (
    ACROBOT_START,
    ACROBOT_STEPS,
    NEWTON_BOUNDS,
    NEWTON_FOUR_BAR,
    NEWTON_STEPS,
    PUBLISHED,
    Acrobot,
    DirectRK4,
    NewtonBounds,
    freudenstein,
    rk4_drift,
)
from reports.pages.published.page import PAGE, bounds, drifts, largest_step
from reports.pages.rendering import render_page
from reports.pages.your_model import page as others
from reports.pages.your_model.page import MODEL_CHECKS
from reports.pages.your_model.page import PAGE as YOUR_MODEL
from tests.reports.models_of_others import models, spaces, unpacked


@pytest.fixture(scope="module")
def answers():
    methods = (DEFAULT, TUNED, PYMUNK)
    tasks = (DirectRK4(), *map(Acrobot, methods), *map(NewtonBounds, methods))
    return {task: answered(task) for task in tasks}


def test_the_start_of_acrobot_reproduces_the_first_published_drift():
    assert rk4_drift(ACROBOT_START, ACROBOT_STEPS[0]) == pytest.approx(PUBLISHED[0], rel=1e-7)
    assert rk4_drift(ACROBOT_START + 1e-3, ACROBOT_STEPS[0]) != pytest.approx(PUBLISHED[0], rel=1e-3)


def test_rk4_predicts_the_second_published_number_and_its_states_in_32_bits_the_third(answers):
    hand = answers[DirectRK4()]
    assert hand.array("drift")[1] == pytest.approx(PUBLISHED[1], rel=0.1)
    assert hand.array("drift")[2] < PUBLISHED[2] / 10
    # States in 32 bits have the rounding error 2^-24 = 6e-8; relative to the initial energy, it is smaller.
    assert PUBLISHED[2] / 3 < hand.array("rounded")[2] < 3 * PUBLISHED[2]


def test_mujocos_rk4_has_the_drift_of_gymnasiums_method(answers):
    """The drifts agree closely only at 0.2 s, since only this run has a sample at every step."""
    ours, theirs = answers[DirectRK4()].array("drift"), answers[Acrobot(TUNED)].array("drift")
    assert theirs[0] == pytest.approx(ours[0], rel=1e-9)
    np.testing.assert_allclose(theirs, ours, rtol=1e-2)


def test_the_rocker_by_freudensteins_equation_agrees_with_the_scene():
    t = np.linspace(0.0, NEWTON_FOUR_BAR.duration, 50)
    truth = NEWTON_FOUR_BAR.motion(t).pose[..., 2]
    off = (truth[:, 2] - freudenstein(truth[:, 0]) + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off).max() < 1e-12


def test_a_method_with_exact_joints_passes_all_bounds_and_a_wrong_linkage_none():
    reported = answered(NewtonBounds(TRUTH))
    assert all(largest_step(reported, name) == max(NEWTON_STEPS) for name in NEWTON_BOUNDS)
    # The expected motion is a cosine, but a pendulum with the amplitude 0.05 rad is slower by 0.05^2/16.
    assert reported.array("period") == pytest.approx(1.1e-3, rel=0.05)
    wrong = np.degrees(freudenstein(np.zeros(1)) - NEWTON_FOUR_BAR.motion([0.0]).pose[0, 2, 2] + 0.01)
    assert np.abs(wrong) > NEWTON_BOUNDS["angle"]


def test_the_bounds_distinguish_default_and_tuned(answers):
    loose, tight = answers[NewtonBounds(DEFAULT)], answers[NewtonBounds(TUNED)]
    assert largest_step(tight, "angle") == max(NEWTON_STEPS)
    assert (largest_step(loose, "angle") or 0) < max(NEWTON_STEPS)
    assert largest_step(replace(loose, values={"gap": np.full(len(NEWTON_STEPS), 1.0)}), "gap") is None


def test_the_page_has_a_line_for_each_method_that_was_run(answers):
    missing = {Acrobot(PYMUNK): replace(answers[Acrobot(PYMUNK)], values={"drift": np.full(3, np.inf)})}
    text = render_page(PAGE, Material({}, {**answers, **missing}), "the command")["published.md"]
    assert "| published | 3.55e-3 | 4.19e-6 | 1.52e-8 |" in text
    assert "| RK4 in the two angles | 3.55e-3 | 3.91e-6 | 1.28e-9 |" in text
    assert "| pymunk tuned | gave up | gave up | gave up |" in text
    assert len(drifts(Material({}, answers))) == 5
    assert drifts(Material({})) == bounds(Material({})) == []


@pytest.fixture(scope="module")
def checks():
    return {walk: answered(replace(walk, duration=0.3)) for walk in MODEL_CHECKS}


def found(answer: Answer):
    return json.loads(str(answer.values["found"]))


def test_the_page_has_the_results_of_the_checks(checks):
    assert all(answer.finished for answer in checks.values())
    text = render_page(YOUR_MODEL, Material({}, checks), "the command")["your_model.md"]
    for walk, answer in checks.items():
        advised = found(answer)["advised"]
        assert all(text_value in text for text_value in (walk.text.strip(), advised["words"], *advised["lines"]))
    assert text.count(".svg)") == 6
    soft, hard, swing = (found(checks[walk])["parts"] for walk in MODEL_CHECKS)  # the titles state these facts
    assert soft["softness"] > 1e-4
    assert (hard["softness"], hard["falling"], swing["divided"]) == (0, True, False)
    assert render_page(YOUR_MODEL, Material({}), "the command")["your_model.md"].count("was not checked yet") == 3


@pytest.mark.slow
def test_the_table_of_the_page_has_every_space_of_pymunks_examples_and_every_model_of_the_packages(tmp_path):
    assert [asdict(space) for space in spaces()] == [row for row in others.rows() if row["source"] == "pymunk"]
    if not unpacked(tmp_path):
        pytest.skip("pip finds no registry here")
    assert [asdict(space) for space in models(tmp_path)] == [row for row in others.rows() if row["source"] != "pymunk"]
