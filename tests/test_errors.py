"""Errors by hand: a motion with a known offset in every number, and what each field makes of it."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from numpy.typing import NDArray

from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.errors import (
    branch_flips,
    constraint_errors,
    largest,
    motion_errors,
    reaction_error,
    root_mean_square,
    usable_samples,
)
from tests.toys import Disc

TIMES = np.array([0.0, 0.1, 0.2, 0.3])


@dataclass(frozen=True)
class Pair(Scene):
    """A driven disc and a free one, whose kinetic energy changes: rows x, y of a pin and a torque."""

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
        """The second disc moves along x at 6 t: not a motion of this mechanism, and no error knows that."""
        t = times
        pose, twist = np.zeros((len(t), 2, 3)), np.zeros((len(t), 2, 3))
        pose[:, 0, 2], twist[:, 0, 2] = 5 * t, 5.0
        pose[:, 1], twist[:, 1, 0] = np.stack([3 * t**2, 0 * t + 1, 0 * t], axis=-1), 6 * t
        reaction = np.column_stack([0 * t, 0 * t + 20.0, 0 * t + 8.0])
        return Trajectory(t, pose, twist, reaction)


SCENE = Pair()
MECHANISM = SCENE.mechanism()
TRUTH = SCENE.motion(TIMES)
KINETIC = 0.5 * 3 * 5**2 + 0.5 * 7 * 1.8**2  # J, the truth's largest: at 0.3 s, beyond the horizon too


def moved(**offsets: tuple[tuple[int, ...], float]) -> Trajectory:
    """The truth with `field=(index, offset)` added to single numbers."""
    found = {name: getattr(TRUTH, name).copy() for name in ("pose", "twist", "reaction")}
    for name, (index, offset) in offsets.items():
        found[name][index] += offset
    return replace(TRUTH, **found)


def errors(trajectory: Trajectory) -> dict[str, float]:
    return motion_errors(SCENE, MECHANISM, TRUTH, trajectory)


def wrong(trajectory: Trajectory) -> dict[str, float]:
    """The errors that are not zero."""
    return {name: value for name, value in errors(trajectory).items() if value != 0}


def test_the_truth_itself_has_no_error():
    assert wrong(TRUTH) == {}


@pytest.mark.parametrize("column", [0, 1])
def test_an_offset_across_is_a_position_error_and_no_angle(column):
    found = wrong(moved(pose=((1, 1, column), -0.25)))
    # Two bodies at the three samples of the horizon: six distances, one of them 0.25 m.
    expected = {"position": 0.25, "position_rms": 0.25 / math.sqrt(6)}
    if column == 1:  # 7 kg lifted by -0.25 m
        expected["energy"] = 7 * 10 * 0.25 / KINETIC
    assert found == pytest.approx(expected, rel=1e-12)


def test_position_is_a_distance_not_a_coordinate():
    trajectory = moved(pose=((1, 1, 0), 0.3))
    trajectory.pose[1, 1, 1] += 0.4
    assert errors(trajectory)["position"] == pytest.approx(0.5, rel=1e-12)


def test_an_offset_in_angle_is_an_angle_error_alone():
    assert wrong(moved(pose=((2, 0, 2), -0.25))) == pytest.approx(
        {"angle": 0.25, "angle_rms": 0.25 / math.sqrt(6), "angle_duration": 0.25}, rel=1e-12
    )


def test_beyond_the_horizon_an_angle_counts_for_the_whole_duration_and_nothing_else_counts():
    trajectory = moved(pose=((3, 0, 2), 0.25), twist=((3, 1, 0), 9.0), reaction=((3, 1), 9.0))
    trajectory.pose[3, 1, :2] += 9.0
    trajectory.twist[3, 0, 2] += 9.0
    assert wrong(trajectory) == {"angle_duration": 0.25}


def test_velocity_is_a_speed_and_rate_is_the_rate():
    # 1.2 m/s along x at 0.2 s, with (0.3, 0.4) m/s more: 0.5 m/s off.
    trajectory = moved(twist=((2, 1, 0), 0.3))
    trajectory.twist[2, 1, 1] += 0.4
    found = wrong(trajectory)
    assert set(found) == {"velocity", "energy"}
    assert found["velocity"] == pytest.approx(0.5, rel=1e-12)
    # 11 kg m^2 that turn at 0.25 rad/s and should not.
    found = wrong(moved(twist=((2, 1, 2), 0.25)))
    assert found == pytest.approx({"rate": 0.25, "energy": 0.5 * 11 * 0.25**2 / KINETIC}, rel=1e-12)


def test_energy_is_relative_to_the_largest_kinetic_energy_of_the_truth_and_unknown_without_any():
    found = errors(moved(twist=((0, 0, 2), 1.0)))["energy"]
    assert found == pytest.approx((0.5 * 3 * 36 - 0.5 * 3 * 25) / KINETIC, rel=1e-12)
    still = replace(TRUTH, twist=np.zeros_like(TRUTH.twist))
    assert math.isnan(motion_errors(SCENE, MECHANISM, still, TRUTH)["energy"])


@pytest.mark.parametrize(("row", "scale"), [(0, 20.0), (1, 20.0), (2, 8.0)])
def test_a_reaction_is_held_against_the_largest_of_its_kind(row, scale):
    assert list(MECHANISM.turning) == [False, False, True]
    assert wrong(moved(reaction=((1, row), -3.0))) == pytest.approx({"reaction": 3 / scale}, rel=1e-12)


def test_the_worse_of_force_and_torque_is_the_reaction_error_and_unknown_rows_count_for_nothing():
    trajectory = moved(reaction=((1, 0), 1.0))  # 1/20
    trajectory.reaction[2, 2] += 1.0  # 1/8
    assert errors(trajectory)["reaction"] == pytest.approx(1 / 8, rel=1e-12)
    trajectory.reaction[:, 2] = np.nan
    assert errors(trajectory)["reaction"] == pytest.approx(1 / 20, rel=1e-12)
    trajectory.reaction[:] = np.nan
    assert math.isnan(errors(trajectory)["reaction"])
    nothing = np.zeros((4, 3))
    assert math.isnan(reaction_error(MECHANISM, nothing, nothing + 1))


def test_the_root_mean_square_is_that_of_all_numbers_and_the_largest_ignores_signs():
    assert root_mean_square(np.array([[3.0, -4.0], [np.nan, 0.0]])) == pytest.approx(math.sqrt(25 / 3), rel=1e-15)
    assert largest(np.array([[3.0, -4.0], [np.nan, 0.0]])) == 4.0
    assert math.isnan(largest(np.array([np.nan])))
    assert math.isnan(root_mean_square(np.array([])))
    assert largest(np.array([1.0, -np.inf, np.nan])) == np.inf


def test_gap_is_of_lengths_drive_gap_of_angles_and_slip_of_velocities():
    for index, offset, expected in (
        (("pose", (1, 0, 0)), 0.25, {"gap": 0.25}),
        (("pose", (2, 0, 1)), -0.25, {"gap": 0.25}),
        (("pose", (3, 0, 2)), -0.5, {"drive_gap": 0.5}),
        (("twist", (1, 0, 1)), -0.75, {"slip": 0.75}),
        (("twist", (1, 0, 2)), 0.5, {"slip": 0.5}),
    ):
        found = constraint_errors(MECHANISM, moved(**{index[0]: (index[1], offset)}))
        assert set(found) == {"gap", "drive_gap", "slip"}
        assert {name: value for name, value in found.items() if value > 1e-15} == pytest.approx(expected)


def test_a_mechanism_without_a_drive_knows_no_drive_gap():
    disc = Disc().mechanism()
    assert math.isnan(constraint_errors(disc, Disc().motion([0.0, 0.1]))["drive_gap"])


@pytest.mark.parametrize("name", ["pose", "twist"])
@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_samples_count_until_the_first_pose_or_twist_that_is_not_finite(name, value):
    trajectory = moved(**{name: ((2, 1, 0), value)})
    assert usable_samples(trajectory) == 2
    assert usable_samples(TRUTH) == 4
    assert usable_samples(moved(reaction=((0, 0), np.nan))) == 4  # an unknown reaction is no failure


def test_a_change_of_assembly_is_counted_each_time_and_one_of_the_truth_is_none():
    scene = Disc()
    truth = scene.motion(TIMES)

    def flips(*sides: float) -> int:
        trajectory = replace(truth, pose=truth.pose.copy())
        trajectory.pose[:, 0, 2] = sides  # the toy's other assembly is beyond 2 rad
        return branch_flips(scene, truth, trajectory)

    assert flips(0, 0, 0, 0) == 0
    assert flips(0, 3, 3, 3) == 1
    assert flips(0, 3, 0, 0) == 2
    assert flips(3, 3, 3, 3) == 1  # on the wrong side from the start
    trajectory = replace(truth, pose=truth.pose.copy())
    trajectory.pose[2:, 0, 2] = 3
    assert branch_flips(scene, trajectory, trajectory) == 0
    assert branch_flips(scene, trajectory, truth) == 1
    assert branch_flips(SCENE, TRUTH, TRUTH) == 0  # a scene of one assembly
