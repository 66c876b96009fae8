"""Tests of the bounds and the sentences of outcomes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.measure import compare, measure
from reports.model.outcomes import BLOWN, SATURATED, TORN, of_motion
from tests.reports.test_measure import DISC, INSTANTS, LENGTH, SCENE, Given, Pair, disc, shifted
from tests.rows import row
from tests.toys import ImpossibleDisc, Toy


def outcome_of(trajectory: Trajectory, scene=DISC) -> tuple[str, str]:
    result = measure(Cell(scene, Given(trajectory), 1), repeat=False)
    return result.outcome, result.sentence


@pytest.mark.parametrize(
    ("trajectory", "outcome", "telling"),
    [
        (disc(), "finished", ""),
        (disc(reset_at=0.05), "reset", "started anew by itself at 0.05 s"),
        (shifted(0, np.nan, 7), "diverged", "not finite from 0.07 s"),
        (disc(twist=np.where(np.arange(21) < 6, 0.0, np.nan)[:, None, None] + disc().twist), "diverged", "from 0.06 s"),
        (shifted(1, 1.01 * BLOWN * LENGTH), "diverged", f"opened by {1.01 * BLOWN * LENGTH:.2g} m"),
        (shifted(1, 0.99 * BLOWN * LENGTH), "torn", f"in a mechanism of {LENGTH:.2g} m"),
        (shifted(1, 1.01 * TORN * LENGTH), "torn", f"opened by {1.01 * TORN * LENGTH:.2g} m"),
        (shifted(1, 0.99 * TORN * LENGTH), "finished", ""),
        (shifted(2, 1.01 * SATURATED), "saturated", f"wrong by {1.01 * SATURATED:.2g} rad within the horizon"),
        (shifted(2, 0.99 * SATURATED), "finished", ""),
        (disc(unresolved_at=0.05, estimate=np.full((21, 1, 3), 3e-5)), "unresolved", "its own estimate is 3e-05 rad"),
        (disc(unresolved_at=0.0, estimate=np.full((21, 1, 3), np.nan)), "unresolved", "so it has no estimate"),
    ],
)
def test_each_outcome_has_its_bound_and_its_number(trajectory, outcome, telling):
    result = outcome_of(trajectory)
    assert result[0] == outcome
    assert result[1] == telling if not telling else telling in result[1]


def cut(count):
    exact = disc()
    return Trajectory(exact.t[:count], exact.pose[:count], exact.twist[:count], exact.reaction[:count], 0.0)


@pytest.mark.parametrize(
    ("trajectory", "found", "expected"),
    [
        (None, "a NoneType", "a Trajectory"),
        (cut(0), "t of the shape (0,)", "(21,)"),
        (cut(18), "t of the shape (18,)", "(21,)"),
        (disc(t=INSTANTS + 0.005), "an instant that is 0.005 s off", "multiples of 0.01 s"),
        (disc(pose=np.zeros((21, 2, 3)), twist=np.zeros((21, 2, 3))), "pose of the shape (21, 2, 3)", "(21, 1, 3)"),
        (disc(reaction=np.zeros((21, 3))), "reaction of the shape (21, 3)", "(21, 2)"),
        (disc(stepping=math.nan), "stepping = nan s", "CPU seconds from 0 on"),
    ],
)
def test_a_result_without_a_motion_at_the_requested_instants_is_failed_with_a_sentence(trajectory, found, expected):
    row = measure(Cell(DISC, Given(trajectory), 1), repeat=False)
    assert (row.outcome, row.sentence) == (
        "failed",
        f"its run gave {found}{' with 1 steps a sample' * ('instant' in found)}; the contract of engines asks for "
        f"{expected}",
    )
    assert math.isnan(row.angle)
    assert math.isnan(row.cpu)


def test_a_drive_that_falls_behind_is_torn():
    t = np.linspace(0, SCENE.duration, SCENE.samples + 1)
    for lag, outcome, telling in (
        (1.01 * SATURATED, "torn", "the drive fell behind by"),
        (0.99 * SATURATED, "finished", ""),
    ):
        late = replace(SCENE.motion(t), stepping=0.0)
        late.pose[:, 0, 2] -= lag * t / t[-1]
        result = measure(Cell(Pair(horizon=0.01), Given(late), 1), repeat=False)
        assert result.outcome == outcome
        assert telling in result.sentence
        assert result.drive_gap == pytest.approx(lag)


def told(trajectory: Trajectory, count: int | None = None, **fields_of_a_row) -> str:
    quiet = {"gap": 0.0, "drive_gap": 0.0, "flips": 0, "angle": 0.0, "angle_duration": 0.0}
    values = row(**{**quiet, **fields_of_a_row})
    count = len(trajectory.t) if count is None else count
    return of_motion(values, DISC.mechanism(), trajectory, count)[0]


def test_the_gravest_defect_determines_the_outcome():
    """A row with all defects has the gravest outcome. Without the gravest defect, it has the next outcome."""
    everything = {"gap": 2 * BLOWN * LENGTH, "drive_gap": 1.0, "flips": 2, "angle": 1.0, "angle_duration": 1.0}
    assert told(disc(reset_at=0.1), 5, **everything) == "reset"
    assert told(disc(), 5, **everything) == "diverged"
    for outcome, changed in (
        ("diverged", {}),
        ("torn", {"gap": 0.5 * BLOWN * LENGTH}),
        ("torn", {"gap": 0.0}),
        ("branch flip", {"drive_gap": 0.0}),
        ("saturated", {"flips": 0}),
        ("finished", {"angle": 0.0}),
    ):
        everything |= changed
        assert told(disc(), **everything) == outcome


@pytest.mark.parametrize(
    ("warnings", "quiet"),
    [((), True), (("ours: the solver missed",), True), (("Nan in qacc",), False), (("ours: a", "theirs"), False)],
)
def test_only_the_engines_own_words_count_as_a_warning(warnings, quiet):
    trajectory = replace(shifted(1, 2 * TORN * LENGTH), warnings=warnings)
    outcome, sentence = outcome_of(trajectory)
    assert outcome == "torn"
    assert ("without a warning" in sentence) == quiet
    assert all(warning in sentence for warning in warnings)


def test_a_refused_exact_motion_gives_no_errors_and_a_sentence():
    result = measure(Cell(ImpossibleDisc(), Given(disc(warnings=("a warning",))), 1), repeat=False)
    assert (result.outcome, result.sentence) == ("finished", "the reference refuses: no such motion; a warning")
    assert result.gap == 0.0
    assert math.isnan(result.angle)


def test_samples_after_the_first_one_that_is_not_finite_are_not_compared():
    trajectory = shifted(2, 0.25, 15)
    trajectory.pose[5] = np.nan
    result = compare(Cell(DISC, Toy(), 1), DISC.mechanism(), trajectory, row())
    assert (result.outcome, result.angle) == ("diverged", 0.0)
