"""The page of published problems: Newton's bounds and Acrobot's energy, each held against a second way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, TUNED
from engines.pymunk import TUNED as PYMUNK
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.published.acrobot import PUBLISHED, START, STEPS, Acrobot, by_hand
from reports.pages.published.newton import BOUNDS, FOUR_BAR, Newton, freudenstein
from reports.pages.published.newton import STEPS as NEWTONS
from reports.pages.published.page import PAGE, drifts, largest_step
from reports.pages.rendering import render_page


@pytest.fixture(scope="module")
def answers():
    """Of RK4 by hand, and of three methods."""
    methods = (DEFAULT, TUNED, PYMUNK)
    tasks = (Acrobot(), *map(Acrobot, methods), *map(Newton, methods))
    return {task: answered(task) for task in tasks}


def test_the_start_of_acrobot_is_the_one_that_loses_what_was_published():
    assert by_hand(START, STEPS[0]) == pytest.approx(PUBLISHED[0], rel=1e-7)
    assert by_hand(START + 1e-3, STEPS[0]) != pytest.approx(PUBLISHED[0], rel=1e-3)


def test_the_second_published_number_follows_and_the_third_is_rounding(answers):
    hand = answers[Acrobot()]
    assert hand.array("drift")[1] == pytest.approx(PUBLISHED[1], rel=0.1)
    assert hand.array("drift")[2] < PUBLISHED[2] / 10
    # Of states in numbers of 32 bits: their rounding is 2^-24 = 6e-8 of each, in parts of the first energy less.
    assert PUBLISHED[2] / 3 < hand.array("rounded")[2] < 3 * PUBLISHED[2]


def test_mujocos_rk4_is_gymnasiums_method(answers):
    """Its hinges are the same two angles; a step of 0.2 s is sampled at every step, the smaller ones at some."""
    ours, theirs = answers[Acrobot()].array("drift"), answers[Acrobot(TUNED)].array("drift")
    assert theirs[0] == pytest.approx(ours[0], rel=1e-9)
    np.testing.assert_allclose(theirs, ours, rtol=1e-2)


def test_freudensteins_rocker_is_the_scenes():
    t = np.linspace(0.0, FOUR_BAR.duration, 50)
    truth = FOUR_BAR.motion(t).pose[..., 2]
    off = (truth[:, 2] - freudenstein(truth[:, 0]) + np.pi) % (2 * np.pi) - np.pi
    assert np.abs(off).max() < 1e-12


def test_a_method_with_exact_joints_passes_all_bounds_and_a_wrong_linkage_none():
    told = answered(Newton(TRUTH))
    assert all(largest_step(told, name) == max(NEWTONS) for name in BOUNDS)
    # What is left of the period's measure is the cosine: a swing by 0.05 rad is slower by 0.05^2/16 than a small one.
    assert told.array("period") == pytest.approx(1.1e-3, rel=0.05)
    wrong = np.degrees(freudenstein(np.zeros(1)) - FOUR_BAR.motion([0.0]).pose[0, 2, 2] + 0.01)
    assert np.abs(wrong) > BOUNDS["angle"]


def test_the_bounds_tell_the_default_from_the_tuned(answers):
    loose, tight = answers[Newton(DEFAULT)], answers[Newton(TUNED)]
    assert largest_step(tight, "angle") == max(NEWTONS)
    assert (largest_step(loose, "angle") or 0) < max(NEWTONS)
    assert largest_step(replace(loose, values={"gap": np.full(len(NEWTONS), 1.0)}), "gap") is None


def test_the_page_has_a_line_for_each_method_and_leaves_out_what_was_not_run(answers):
    plain = replace(PAGE, figures=lambda material: {})  # what is drawn is drawn once
    text = render_page(PAGE, Material({}, answers), "the command")["published.md"]
    assert "| published | 3.55e-03 | 4.19e-06 | 1.52e-08 |" in text
    assert "| RK4 in the two angles | 3.55e-03 | 3.91e-06 | 1.28e-09 |" in text
    assert len(drifts(Material({}, answers))) == 5
    others = {task: answer for task, answer in answers.items() if task != Acrobot()}
    lost = {Acrobot(PYMUNK): replace(answers[Acrobot(PYMUNK)], values={"drift": np.full(3, np.inf)})}
    partial = render_page(plain, Material({}, {**others, **lost}), "the command")["published.md"]
    assert "| pymunk tuned | gave up | gave up | gave up |" in partial
    assert ["comes out within a tenth" in told for told in (text, partial)] == [True, False]
    bare = render_page(plain, Material({}, {}), "the command")["published.md"]
    assert [("## Acrobot's energy" in told, "## Newton's bounds" in told) for told in (text, bare)] == [
        (True,) * 2,
        (False,) * 2,
    ]
