"""One cell measured: every field of its row, and each outcome by a toy that deserves it, the gravest first."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace

import numpy as np
import pytest

from engines import Size
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.trajectory import Trajectory
from reports.grid.cells import Cell
from reports.grid.measure import BLOWN, SATURATED, TORN, Measurement, blank, classify, compare, measure, sizes
from reports.grid.outcomes import LETTERS, MEANINGS, Outcome, describe_exit
from tests.rows import row, row_of
from tests.test_errors import SCENE, Pair
from tests.toys import Disc, FailingToy, ImpossibleDisc, Plain, Toy

DISC = Disc()
LENGTH = DISC.mechanism().length_scale
TIMES = np.linspace(0, 0.2, 21)


@dataclass(frozen=True)
class Given(Plain):
    """An engine whose motion was written down beforehand, and that says so of its model."""

    trajectory: Trajectory
    variant: str = "given"
    name: str = "toy"

    def build(self, mechanism, dt):
        return GivenRun(self.trajectory)


class GivenRun:
    size = Size(113, 127, 131, 137)

    def __init__(self, trajectory):
        self.trajectory = trajectory

    def __call__(self, samples, every):
        return self.trajectory


def disc(**changes) -> Trajectory:
    """The disc's true motion with other fields."""
    return replace(DISC.motion(TIMES), **changes)


def shifted(column: int, offset, start: int = 0) -> Trajectory:
    """The disc's pose off by `offset` in one coordinate from one sample on."""
    trajectory = disc()
    trajectory.pose[start:, 0, column] += offset
    return trajectory


def outcome_of(trajectory: Trajectory, scene=DISC) -> tuple[str, str]:
    found = measure(Cell(scene, Given(trajectory), 1), repeat=False)
    return found.outcome, found.sentence


def test_no_two_fields_of_the_row_by_hand_share_a_number():
    values = [getattr(row(), f.name) for f in fields(Measurement)]
    numbers = [value for value in values if isinstance(value, (int, float))]
    assert len(set(values)) == len(values)
    assert len({f"{value:.1e}" for value in numbers if isinstance(value, float)}) == sum(
        isinstance(value, float) for value in numbers
    )


def test_a_blank_row_says_what_its_cell_is():
    cell = Cell(Disc(rate=3.0), Toy("tuned", factor=5.0), 7, "failure", 11)
    found = blank(cell, Outcome.ABORTED, "a sentence")
    said = {
        "key": cell.key,
        "purpose": "failure",
        "scene": "disc",
        "parameters": "Disc(rate=3.0, duration=0.2, horizon=0.2)",
        "engine": "toy",
        "variant": "tuned",
        "settings": "Toy(variant='tuned', factor=5.0, power=2.0, plateau=0.0, name='toy')",
        "every": 7,
        "samples": 11,
        "step": 0.2 / 11 / 7,
        "outcome": "aborted",
        "sentence": "a sentence",
    }
    found = found.as_dict()
    assert {name: found.pop(name) for name in said} == said
    # Nothing else is known: no number, no count.
    assert all(value == 0 if isinstance(value, int) else math.isnan(value) for value in found.values())
    assert row_of("toy tuned").method == "toy tuned"


def test_every_field_of_a_measured_row_is_its_own():
    """A motion with another error in every quantity, through `measure`: each field by hand."""
    t = np.linspace(0, SCENE.duration, SCENE.samples + 1)
    truth = SCENE.motion(t)
    pose, twist, reaction = truth.pose.copy(), truth.twist.copy(), truth.reaction.copy()
    pose[2, 0, 0] += 1e-3  # gap and position
    pose[4, 1, 0] += 3e-3  # position
    pose[5, 0, 2] += 5e-3  # drive gap and angle
    pose[6, 1, 2] += 7e-3  # angle
    pose[-1, 1, 2] += 11e-3  # beyond the horizon
    twist[7, 1, 0] += 13e-3  # velocity
    twist[8, 1, 2] += 17e-3  # rate
    twist[9, 0, 0] += 19e-5  # slip
    reaction[10, 1] += 23e-3
    reaction[:, 2] = np.nan
    estimate = np.zeros_like(pose)
    estimate[3, 1, 2], estimate[5, 0, 2], estimate[5, 0, 0] = -29e-3, 2e-3, 99.0
    given = Given(Trajectory(t, pose, twist, reaction, 0.6, ("a warning", "a warning", "another"), None, estimate))
    cell = Cell(SCENE, given, 1, "failure")
    found = measure(cell, repeat=False)
    count = 2 * int(np.sum(t <= SCENE.horizon * (1 + 1e-12)))
    expected = {
        "key": cell.key,
        "purpose": "failure",
        "scene": "pair",
        "parameters": repr(SCENE),
        "engine": "toy",
        "variant": "given",
        "settings": repr(given),
        "every": 1,
        "samples": 30,
        "step": 0.01,
        "outcome": "finished",
        "sentence": "a warning; another",
        "position": 3e-3,
        "position_rms": math.sqrt((1e-6 + 9e-6) / count),
        "angle": 7e-3,
        "angle_rms": math.sqrt((25e-6 + 49e-6) / count),
        "angle_duration": 11e-3,
        "velocity": 13e-3,
        "rate": 17e-3,
        "gap": 1e-3,
        "drive_gap": 5e-3,
        "slip": 19e-5,
        "reaction": 23e-3 / 20,
        "reaction_rows": 2,
        "flips": 0,
        "estimate": 29e-3,
        "bodies": 113,
        "coordinates": 127,
        "rows": 131,
        "solver_rows": 137,
        "own_bodies": 2,
        "own_coordinates": 6,
        "own_rows": 3,
        "own_freedoms": 3,
        "cpu": 0.6 / 0.3,
        "runs": 1,
    }
    # 7 kg at v(0.07 s) = 0.42 m/s and 13 mm/s more is more than what the other offsets do to the energy.
    expected["energy"] = 0.5 * 7 * (0.433**2 - 0.42**2) / (0.5 * 3 * 25 + 0.5 * 7 * 1.8**2)
    told = found.as_dict()
    assert told.pop("build") >= 0
    assert math.isnan(told.pop("limit"))
    words = {name: value for name, value in expected.items() if isinstance(value, str)}
    assert {name: told.pop(name) for name in words} == words
    assert told == pytest.approx({name: value for name, value in expected.items() if name not in words}, rel=1e-9)


def test_the_freedoms_are_those_of_the_configuration_and_the_estimate_is_unknown_without_one():
    found = measure(Cell(DISC, Given(disc()), 1), repeat=False)
    assert (found.own_bodies, found.own_coordinates, found.own_rows, found.own_freedoms) == (1, 3, 2, 1)
    assert math.isnan(found.estimate)
    assert found.reaction_rows == 2


def test_the_own_freedoms_are_those_of_the_configuration_and_sizes_are_the_engines():
    sleigh = Mechanism((Body("body", 1.0, 1.0, (0.0, 0.0, 0.0)),), (Skate("blade", None, "body", (0.0, 0.0)),))
    assert sizes(sleigh, Size(113, 127, 131, 137)) == {
        "bodies": 113,
        "coordinates": 127,
        "rows": 131,
        "solver_rows": 137,
        "own_bodies": 1,
        "own_coordinates": 3,
        "own_rows": 1,
        "own_freedoms": 3,
    }


def test_rows_told_are_those_known_at_any_sample():
    reaction = disc().reaction.copy()
    reaction[:5, 0], reaction[:, 1] = np.nan, np.nan
    found = measure(Cell(DISC, Given(disc(reaction=reaction)), 1), repeat=False)
    assert found.reaction_rows == 1


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
    ],
)
def test_each_outcome_has_its_bound_and_its_number(trajectory, outcome, telling):
    found = outcome_of(trajectory)
    assert found[0] == outcome
    assert found[1] == telling if not telling else telling in found[1]


def test_beyond_the_horizon_a_wrong_angle_is_told_and_is_no_failure():
    scene = Disc(horizon=0.1)
    outcome, sentence = outcome_of(shifted(2, 0.75, 15), scene)
    assert (outcome, sentence) == ("finished", "beyond the horizon an angle is wrong by 0.75 rad")


def test_a_drive_that_falls_behind_is_torn():
    t = np.linspace(0, SCENE.duration, SCENE.samples + 1)
    for lag, outcome in ((1.01 * SATURATED, "torn"), (0.99 * SATURATED, "finished")):
        late = SCENE.motion(t)
        late.pose[:, 0, 2] -= lag * t / t[-1]
        found = measure(Cell(Pair(horizon=0.01), Given(late), 1), repeat=False)
        assert found.outcome == outcome
        assert found.drive_gap == pytest.approx(lag)
    late = SCENE.motion(t)
    late.pose[:, 0, 2] -= t / t[-1]
    found = measure(Cell(SCENE, Given(late), 1), repeat=False)
    assert (found.outcome, found.sentence) == ("torn", "the drive fell behind by 1 rad")


@pytest.mark.parametrize(
    ("variant", "outcome"),
    [
        ("flip", "branch flip"),
        ("blind", "diverged"),
        ("nan", "diverged"),
        ("tear", "torn"),
        ("reset", "reset"),
        ("saturate", "saturated"),
        ("refuse", "refused"),
        ("unsupported", "unsupported"),
    ],
)
def test_a_toy_that_fails_as_it_says_is_told_apart(variant, outcome):
    found = measure(Cell(DISC, FailingToy(variant), 1), repeat=False)
    assert found.outcome == outcome
    assert found.sentence


def test_a_toy_that_flips_is_counted():
    found = measure(Cell(DISC, FailingToy("flip"), 1), repeat=False)
    assert (found.outcome, found.flips, found.sentence) == (
        "branch flip",
        1,
        "1 change of assembly that the truth lacks",
    )


def told(trajectory: Trajectory, count: int | None = None, **fields_of_a_row) -> str:
    """What a row with these fields is, by the first rule that holds."""
    quiet = {"gap": 0.0, "drive_gap": 0.0, "flips": 0, "angle": 0.0, "angle_duration": 0.0}
    given = row(**{**quiet, **fields_of_a_row})
    count = len(trajectory.t) if count is None else count
    return classify(given, DISC.mechanism(), trajectory, count)[0]


def test_the_gravest_finding_decides():
    everything = {
        "gap": 2 * BLOWN * LENGTH,
        "drive_gap": 1.0,
        "flips": 2,
        "angle": 1.0,
        "angle_duration": 1.0,
    }
    assert told(disc(reset_at=0.1), 5, **everything) == "reset"
    assert told(disc(), 5, **everything) == "diverged"
    assert told(disc(), **everything) == "diverged"
    everything["gap"] = 0.5 * BLOWN * LENGTH
    assert told(disc(), **everything) == "torn"
    everything["gap"] = 0.0
    assert told(disc(), **everything) == "torn"
    everything["drive_gap"] = 0.0
    assert told(disc(), **everything) == "branch flip"
    everything["flips"] = 0
    assert told(disc(), **everything) == "saturated"
    everything["angle"] = 0.0
    assert told(disc(), **everything) == "finished"


def test_two_changes_of_assembly_are_said_to_be_two():
    sentence = classify(row(gap=0.0, drive_gap=0.0, flips=2), DISC.mechanism(), disc(), len(TIMES))[1]
    assert sentence == "2 changes of assembly that the truth lacks"


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


def test_where_the_textbook_refuses_there_is_no_error_and_the_sentence_says_so():
    found = measure(Cell(ImpossibleDisc(), Given(disc(warnings=("a warning",))), 1), repeat=False)
    assert (found.outcome, found.sentence) == ("finished", "the reference refuses: no such motion; a warning")
    assert found.gap == 0.0
    assert math.isnan(found.angle)


def test_a_motion_that_is_finite_nowhere_is_diverged_from_the_start():
    outcome, sentence = outcome_of(shifted(0, np.nan))
    assert (outcome, sentence) == ("diverged", "not finite from 0 s")


def test_what_comes_after_the_first_sample_that_is_not_finite_is_not_compared():
    trajectory = shifted(2, 0.25, 15)
    trajectory.pose[5] = np.nan
    found = compare(Cell(DISC, Toy(), 1), DISC.mechanism(), trajectory, row())
    assert (found.outcome, found.angle) == ("diverged", 0.0)


def test_every_outcome_has_a_meaning_a_letter_of_its_own_and_three_can_be_compared():
    assert set(MEANINGS) == set(LETTERS) == set(Outcome)
    assert all(outcome.meaning == MEANINGS[outcome] and outcome.letter == LETTERS[outcome] for outcome in Outcome)
    assert len(set(MEANINGS.values())) == len(MEANINGS)
    good = [outcome for outcome in Outcome if outcome.comparable]
    assert good == [Outcome.FINISHED, Outcome.CONVERGED, Outcome.PLATEAU]
    # The two that a map shows alike show a number there instead of a letter.
    letters = [outcome.letter for outcome in Outcome if outcome is not Outcome.CONVERGED]
    assert len(set(letters)) == len(letters)
    assert {str(outcome) for outcome in Outcome} == {
        "finished", "converged", "plateau", "saturated", "branch flip", "torn", "diverged", "reset", "refused",
        "unsupported", "aborted", "timed out", "failed", "lost",
    }  # fmt: skip


def test_the_bounds_are_those_that_the_meanings_tell():
    assert (TORN, BLOWN, SATURATED) == (1 / 20, 1000, 1 / 2)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (-6, "aborted with signal 6 (SIGABRT)"),
        (-11, "aborted with signal 11 (SIGSEGV)"),
        (-250, "aborted with signal 250 (unknown)"),
        (3, "the process ended by itself with exit status 3"),
        (0, "the process ended by itself with exit status 0"),
    ],
)
def test_an_exit_code_is_put_in_words(code, words):
    assert describe_exit(code) == words
