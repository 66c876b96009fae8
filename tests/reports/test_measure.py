"""Tests of errors of motions with known offsets, and of all fields of a row, by values that were computed by hand."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from engines import Size
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.cells import Cell
from reports.model.errors import (
    branch_flips,
    constraint_errors,
    largest,
    motion_errors,
    reaction_error,
    root_mean_square,
    usable_samples,
)
from reports.model.measure import measure
from tests.toys import Disc, Plain

TIMES = np.array([0.0, 0.1, 0.2, 0.3])


@dataclass(frozen=True)
class Pair(Scene):
    """A driven disc, and a free disc whose kinetic energy changes. The reactions are the force of a pin and a
    torque."""

    name: ClassVar[str] = "pair"
    source: ClassVar[str] = "invented"

    duration: float = 0.3
    horizon: float = 0.2

    def mechanism(self) -> Mechanism:
        first = Body("first", 2.0, 3.0, (0.0, 0.0, 0.0), (0.0, 0.0, 5.0))
        second = Body("second", 7.0, 11.0, (1.0, 1.0, 0.0), (0.0, 0.0, 0.0))
        joints = (Pin("axle", None, "first", (0.0, 0.0), (0.0, 0.0)), Drive("motor", None, "first", 5.0, 0.0))
        return Mechanism((first, second), joints, (0.0, -10.0))

    def _motion(self, times: NDArray[np.float64]) -> Trajectory:
        """The second disc has the velocity 6 t along x. This velocity is physically impossible, but no error depends on
        that."""
        t = times
        pose, twist = np.zeros((len(t), 2, 3)), np.zeros((len(t), 2, 3))
        pose[:, 0, 2], twist[:, 0, 2] = 5 * t, 5.0
        pose[:, 1], twist[:, 1, 0] = np.stack([3 * t**2, 0 * t + 1, 0 * t], axis=-1), 6 * t
        reaction = np.column_stack([0 * t, 0 * t + 20.0, 0 * t + 8.0])
        return Trajectory(t, pose, twist, reaction)


SCENE = Pair()
MECHANISM = SCENE.mechanism()
TRUTH = SCENE.motion(TIMES)
KINETIC = 0.5 * 3 * 5**2 + 0.5 * 7 * 1.8**2  # largest exact kinetic energy [J], which is reached at 0.3 s


def moved(**offsets: list[tuple[tuple[int, ...], float]]) -> Trajectory:
    """The exact motion with the offsets `field=[(index, offset), ...]`."""
    fields = {name: getattr(TRUTH, name).copy() for name in ("pose", "twist", "reaction")}
    for name, changes in offsets.items():
        for index, offset in changes:
            fields[name][index] += offset
    return replace(TRUTH, **fields)


def errors(trajectory: Trajectory) -> dict[str, float]:
    return motion_errors(SCENE, MECHANISM, TRUTH, trajectory)


# Root mean square of six values, if one value is 1 and the other values are 0 (two bodies at three samples).
SIXTH = 1 / math.sqrt(6)
MOTIONS: dict[str, tuple[dict[str, Any], dict[str, float]]] = {
    "the truth": ({}, {}),
    "across": ({"pose": [((1, 1, 0), -0.25)]}, {"position": 0.25, "position_rms": 0.25 * SIXTH}),
    "7 kg lifted": (
        {"pose": [((1, 1, 1), -0.25)]},
        {"position": 0.25, "position_rms": 0.25 * SIXTH, "energy": 7 * 10 * 0.25 / KINETIC},
    ),
    "a distance and no coordinate": (
        {"pose": [((1, 1, 0), 0.3), ((1, 1, 1), 0.4)]},
        {"position": 0.5, "position_rms": 0.5 * SIXTH, "energy": 7 * 10 * 0.4 / KINETIC},
    ),
    "an angle": ({"pose": [((2, 0, 2), -0.25)]}, {"angle": 0.25, "angle_rms": 0.25 * SIXTH, "angle_duration": 0.25}),
    "beyond the horizon": (
        {
            "pose": [((3, 0, 2), 0.25), ((3, 1, 0), 9.0), ((3, 1, 1), 9.0)],
            "twist": [((3, 1, 0), 9.0), ((3, 0, 2), 9.0)],
            "reaction": [((3, 1), 9.0)],
        },
        {"angle_duration": 0.25},
    ),
    "a speed": (  # the exact velocity is (1.2, 0) m/s, to which (0.3, 0.4) m/s is added
        {"twist": [((2, 1, 0), 0.3), ((2, 1, 1), 0.4)]},
        {"velocity": 0.5, "energy": 0.5 * 7 * (1.5**2 + 0.4**2 - 1.2**2) / KINETIC},
    ),
    "a rate": ({"twist": [((2, 1, 2), 0.25)]}, {"rate": 0.25, "energy": 0.5 * 11 * 0.25**2 / KINETIC}),
    "energy of rotation": ({"twist": [((0, 0, 2), 1.0)]}, {"rate": 1.0, "energy": 0.5 * 3 * (36 - 25) / KINETIC}),
    # The error of a force is relative to the largest force, 20 N, and that of a torque to the largest torque, 8 N m.
    "a force": ({"reaction": [((1, 0), -3.0)]}, {"reaction": 3 / 20}),
    "another force": ({"reaction": [((1, 1), -3.0)]}, {"reaction": 3 / 20}),
    "a torque": ({"reaction": [((1, 2), -3.0)]}, {"reaction": 3 / 8}),
    "both": ({"reaction": [((1, 0), 1.0), ((2, 2), 1.0)]}, {"reaction": 1 / 8}),
    "a torque that nobody tells": ({"reaction": [((1, 0), 1.0), ((slice(None), 2), math.nan)]}, {"reaction": 1 / 20}),
}


@pytest.mark.parametrize("name", MOTIONS)
def test_each_offset_is_the_error_of_its_own_quantities_and_of_no_other(name):
    offsets, expected = MOTIONS[name]
    nonzero = {name: value for name, value in errors(moved(**offsets)).items() if value != 0}
    assert nonzero == pytest.approx(expected, rel=1e-12)


def test_errors_without_a_scale_or_without_data_are_nan():
    at_rest = replace(TRUTH, twist=np.zeros_like(TRUTH.twist))
    assert math.isnan(motion_errors(SCENE, MECHANISM, at_rest, TRUTH)["energy"])
    assert math.isnan(errors(replace(TRUTH, reaction=np.full_like(TRUTH.reaction, math.nan)))["reaction"])
    nothing = np.zeros((4, 3))
    assert math.isnan(reaction_error(MECHANISM, nothing, nothing + 1))
    disc = Disc().mechanism()
    assert math.isnan(constraint_errors(disc, Disc().motion([0.0, 0.1]))["drive_gap"])


def test_the_root_mean_square_is_that_of_all_numbers_and_the_largest_ignores_signs():
    assert root_mean_square(np.array([[3.0, -4.0], [np.nan, 0.0]])) == pytest.approx(math.sqrt(25 / 3), rel=1e-15)
    assert largest(np.array([[3.0, -4.0], [np.nan, 0.0]])) == 4.0
    assert math.isnan(largest(np.array([np.nan])))
    assert math.isnan(root_mean_square(np.array([])))
    assert largest(np.array([1.0, -np.inf, np.nan])) == np.inf


@pytest.mark.parametrize("name", ["pose", "twist"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_samples_count_until_the_first_pose_or_twist_that_is_not_finite(name, value):
    trajectory = moved(**{name: [((2, 1, 0), value)]})
    assert usable_samples(trajectory) == 2
    assert usable_samples(TRUTH) == 4
    assert usable_samples(moved(reaction=[((0, 0), np.nan)])) == 4  # An unknown reaction is not a failure.


def test_changes_of_assembly_count_relative_to_the_exact_motion():
    scene = Disc()
    truth = scene.motion(TIMES)

    def flips(*sides: float) -> int:
        trajectory = replace(truth, pose=truth.pose.copy())
        trajectory.pose[:, 0, 2] = sides  # An angle above 2 rad belongs to the other assembly.
        return branch_flips(scene, truth, trajectory)

    assert flips(0, 0, 0, 0) == 0
    assert flips(0, 3, 3, 3) == 1
    assert flips(0, 3, 0, 0) == 2
    assert flips(3, 3, 3, 3) == 1  # the first pose has the wrong assembly
    trajectory = replace(truth, pose=truth.pose.copy())
    trajectory.pose[2:, 0, 2] = 3
    assert branch_flips(scene, trajectory, trajectory) == 0
    assert branch_flips(scene, trajectory, truth) == 1
    assert branch_flips(SCENE, TRUTH, TRUTH) == 0  # a scene with only one assembly


DISC = Disc()
LENGTH = DISC.mechanism().length_scale
INSTANTS = np.linspace(0, 0.2, 21)


@dataclass(frozen=True, eq=False)  # arrays can't be compared or hashed
class Given(Plain):
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
    return replace(DISC.motion(INSTANTS), **changes)


def shifted(column: int, offset, start: int = 0) -> Trajectory:
    """The exact motion of the disc with `offset` added to one coordinate from the sample `start` on."""
    trajectory = disc()
    trajectory.pose[start:, 0, column] += offset
    return trajectory


def test_every_field_of_a_measured_row_has_its_own_value():
    """Each quantity has a different error, so that exchanged fields are detected."""
    t = np.linspace(0, SCENE.duration, SCENE.samples + 1)
    truth = SCENE.motion(t)
    pose, twist, reaction = truth.pose.copy(), truth.twist.copy(), truth.reaction.copy()
    pose[2, 0, 0] += 1e-3  # Gap and position.
    pose[4, 1, 0] += 3e-3  # position.
    pose[5, 0, 2] += 5e-3  # drive gap, angle
    pose[6, 1, 2] += 7e-3  # angle.
    pose[-1, 1, 2] += 11e-3  # Beyond the horizon.
    twist[7, 1, 0] += 13e-3  # velocity.
    twist[8, 1, 2] += 17e-3  # rate.
    twist[9, 0, 0] += 19e-5  # slip.
    reaction[10, 1] += 23e-3
    reaction[:, 2] = np.nan
    estimate = np.zeros_like(pose)
    estimate[3, 1, 2], estimate[5, 0, 2], estimate[5, 0, 0] = -29e-3, 2e-3, 99.0
    engine = Given(Trajectory(t, pose, twist, reaction, 0.6, ("a warning", "a warning", "another"), None, estimate))
    cell = Cell(SCENE, engine, 1, "failure")
    result = measure(cell, repeat=False)
    count = 2 * int(np.sum(t <= SCENE.horizon * (1 + 1e-12)))
    expected = {
        "key": cell.key,
        "purpose": "failure",
        "scene": "pair",
        "parameters": repr(SCENE),
        "engine": "toy",
        "variant": "given",
        "settings": repr(engine),
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
    # The largest error of the energy comes from the body of 7 kg: 13 mm/s are added to its 0.42 m/s at 0.07 s.
    expected["energy"] = 0.5 * 7 * (0.433**2 - 0.42**2) / (0.5 * 3 * 25 + 0.5 * 7 * 1.8**2)
    reported = result.as_dict()
    assert reported.pop("build") >= 0
    assert math.isnan(reported.pop("limit"))
    text = {name: value for name, value in expected.items() if isinstance(value, str)}
    assert {name: reported.pop(name) for name in text} == text
    assert reported == pytest.approx({name: value for name, value in expected.items() if name not in text}, rel=1e-9)


def test_the_exact_motion_is_computed_at_the_instants_of_the_engine():
    late = INSTANTS * (1 + 1e-9)  # The relative difference of 1e-9 is larger than the rounding of steps.
    result = measure(Cell(DISC, Given(DISC.motion(late)), 1), repeat=False)
    assert result.angle < 1e-14 < 1e-3 * np.abs(DISC.motion(late).pose - DISC.motion(INSTANTS).pose).max()


def test_reaction_rows_count_the_rows_known_at_all_samples_after_the_first():
    reaction = disc().reaction.copy()
    reaction[0, 0], reaction[:, 1] = np.nan, np.nan
    result = measure(Cell(DISC, Given(disc(reaction=reaction)), 1), repeat=False)
    assert (result.outcome, result.reaction_rows) == ("finished", 1)
