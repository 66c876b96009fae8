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
from reports.model.cells import Cell
from reports.model.measure import Measurement, blank, measure, sizes
from reports.model.outcomes import Outcome
from tests.reports.test_errors import SCENE
from tests.rows import row, row_of
from tests.toys import Disc, Plain, Toy

DISC = Disc()
LENGTH = DISC.mechanism().length_scale
TIMES = np.linspace(0, 0.2, 21)


@dataclass(frozen=True, eq=False)  # its arrays can't be compared or hashed
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


def test_the_truth_is_at_an_engine_s_own_instants():
    late = TIMES * (1 + 1e-9)  # as no rounding of steps makes them
    found = measure(Cell(DISC, Given(DISC.motion(late)), 1), repeat=False)
    assert found.position < 1e-14 < 1e-3 * np.abs(DISC.motion(late).pose - DISC.motion(TIMES).pose).max()
    rounded = np.nextafter(TIMES, 1.0)
    assert measure(Cell(DISC, Given(replace(disc(), t=rounded)), 1), repeat=False).position == 0.0


def test_sizes_are_the_engine_s_beside_the_mechanism_s_own():
    sleigh = Mechanism((Body("body", 1.0, 1.0, (0.0, 0.0, 0.0)),), (Skate("blade", None, "body", (0.0, 0.0)),))
    assert sizes(sleigh, Size(113, 127, 131, 137), 3) == {
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


@dataclass(frozen=True)
class Moving(Toy):
    """An engine that counts from another origin, and moves the mechanism's own arrays there."""

    name: str = "moving"

    def build(self, mechanism, dt):
        pose = mechanism.pose
        pose += 1.0
        return super().build(mechanism, dt)


def test_an_engine_that_writes_into_a_mechanism_spoils_its_own_row_alone():
    alone = measure(Cell(DISC, Toy(), 2))
    spoilt = measure(Cell(DISC, Moving(), 2))
    assert (spoilt.outcome, "read-only" in spoilt.sentence) == (Outcome.REFUSED, True)
    after = measure(Cell(DISC, Toy(), 2))
    assert (after.outcome, after.angle, after.energy) == (alone.outcome, alone.angle, alone.energy)
