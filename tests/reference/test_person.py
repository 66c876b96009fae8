"""A falling person: freedoms on one foot and two, minimal coordinates against the Mechanism, errors shown, bad
stances.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.scenes.person import (
    HEAD_ARMS_TRUNK,
    SHANK,
    SHANK_AND_FOOT,
    THIGH,
    UPRIGHT,
    OneFoot,
    SwayingOnOneFoot,
    TwoFeet,
    modes_upright,
)
from reference.trajectory import energy, joint_gap, slip

SCENES = [
    OneFoot(),
    SwayingOnOneFoot(),
    TwoFeet(),
    TwoFeet(knees=-1, stance=0.3, hip_x=0.1, trunk=0.2, mass=60.0, height=1.6, hip_y=0.72),
]


@pytest.mark.parametrize("scene", SCENES)
def test_minimal_coordinates_satisfy_the_mechanism(scene: OneFoot) -> None:
    mechanism = scene.mechanism()
    t = np.linspace(0, scene.duration, 15)
    motion = scene.motion(t)
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-14
    assert np.abs(slip(mechanism, motion)).max() < 1e-13
    pose, twist, change = scene.placement(t)
    # J a = bias, and Newton's law with the reactions of the rows alone: the two formulations share no equation of
    # motion.
    left = (mechanism.rows(pose) @ change.reshape(len(t), -1, 1))[..., 0]
    assert np.abs(left - mechanism.bias(pose, twist)).max() < 1e-12 * np.abs(change).max()
    force = (np.swapaxes(mechanism.rows(pose), -1, -2) @ motion.reaction[..., None])[..., 0]
    excess = (mechanism.inertias * (change - mechanism.free_fall)).reshape(len(t), -1)
    assert np.abs(force - excess).max() < 1e-11 * np.abs(excess).max()
    # Tolerances of 3e-14 and 3e-13 a step.
    total = energy(mechanism, motion)
    assert np.ptp(total) < 1e-12 * np.abs(total).max()
    # A standing knee makes a deviation e-fold in 0.03 s: tolerances of 1e-13 a step grow by e^10.
    assert scene.truth_error(t).max() < (1e-9 if isinstance(scene, SwayingOnOneFoot) else 1e-10)


def test_one_foot_is_an_open_chain_and_two_close_it() -> None:
    one, two = OneFoot().mechanism(), TwoFeet().mechanism()
    assert (len(one.bodies), one.row_count, one.degrees_of_freedom()) == (5, 10, (5, 5))
    assert (len(two.bodies), two.row_count, two.degrees_of_freedom()) == (5, 12, (3, 3))


def test_with_straight_legs_on_one_spot_the_loop_is_singular() -> None:
    """Both knees straight and both ankles together: the last ankle's pull along the leg is already provided."""
    scene = TwoFeet()
    mechanism = replace(scene, stance=1e-3, hip_x=5e-4).mechanism()
    pose = mechanism.pose.copy()
    reach = 0.0
    for body, behind, length in zip(range(2), scene._behind, scene.lengths, strict=False):
        pose[body] = (0.0, reach + behind, math.pi / 2)
        reach += length
    pose[2] = (0.0, reach + scene._behind[2], math.pi / 2)
    for body in (3, 4):
        pose[body] = (0.0, reach - scene._behind[body], -math.pi / 2)
        reach -= scene.lengths[body]
    assert mechanism.degrees_of_freedom(pose) == (4, 4)


def test_nothing_is_below_the_ground_until_the_scene_ends() -> None:
    for scene in (OneFoot(), TwoFeet()):
        pose, _, _ = scene.placement(np.linspace(0, scene.duration, 29))
        for body, (behind, length) in enumerate(zip(scene._behind, scene.lengths, strict=True)):
            for point in (-behind, length - behind):
                assert (pose[:, body, 1] + point * np.sin(pose[:, body, 2])).min() > -1e-12
        hip = pose[:, 2, 1] - scene._behind[2] * np.sin(pose[:, 2, 2])
        assert hip[-1] < 0.85 * hip[0]  # it collapses


def test_the_table_adds_up_to_one_body() -> None:
    """Winter: HAT and two legs with feet; both centres and both radii obey his third column, the radius about an
    end.
    """
    assert HEAD_ARMS_TRUNK.mass + 2 * THIGH.mass + 2 * SHANK_AND_FOOT.mass == pytest.approx(1.0, abs=1e-12)
    for segment, about_the_end in ((HEAD_ARMS_TRUNK, 0.798), (THIGH, 0.540), (SHANK, 0.528), (SHANK_AND_FOOT, 0.735)):
        # printed to three digits
        assert math.hypot(segment.centre, segment.gyration) == pytest.approx(about_the_end, abs=1e-3)
    scene = OneFoot()
    assert scene.masses.sum() == pytest.approx(75.0 * (1 - 0.0145), rel=1e-12)  # the standing foot is ground


@pytest.mark.parametrize("scene", SCENES)
def test_a_thigh_longer_by_a_thousandth_and_gravity_of_the_wrong_sign_are_caught(scene: OneFoot) -> None:
    mechanism = scene.mechanism()
    longer = replace(scene, height=scene.height * 1.001)
    assert np.abs(joint_gap(mechanism, longer.motion([0.1]))).max() > 1e-4
    # Upwards the legs soon straighten, where the hip is no coordinate.
    upwards = replace(scene, gravity=-scene.gravity, duration=0.04)
    assert np.abs(upwards.motion([0.04]).pose - scene.motion([0.04]).pose).max() > 1e-3


def test_the_branch_is_the_bend_of_the_knees() -> None:
    for scene in (scene for scene in SCENES if isinstance(scene, TwoFeet)):
        assert np.all(scene.branch_of(scene.motion(np.linspace(0, scene.duration, 9)).pose) == scene.knees)


def test_feet_too_far_apart_and_other_bad_numbers_are_refused() -> None:
    with pytest.raises(InvalidMechanism, match=r"stance is 1\.8 m"):
        TwoFeet(stance=1.8)
    with pytest.raises(InvalidMechanism, match="from the right ankle"):
        TwoFeet(stance=1.2, hip_x=0.3)
    with pytest.raises(InvalidMechanism, match="from the left ankle"):
        TwoFeet(hip_y=1.0)
    wrong: dict[str, Any]
    for wrong in ({"mass": 0.0}, {"height": -1.0}, {"trunk": math.nan}, {"stance": math.inf}, {"knees": 0}):
        with pytest.raises(InvalidMechanism, match=next(iter(wrong))):
            TwoFeet(**wrong)


def test_the_sway_starts_on_a_swinging_mode_and_upright_grows_in_three_others() -> None:
    scene = SwayingOnOneFoot()
    squares, shapes = modes_upright(scene)
    assert np.sum(squares < 0) == 2
    parts = np.abs(np.linalg.solve(shapes, scene.start[:5] - UPRIGHT))
    # Six digits of the start are given: what lies on the other modes is what they leave out.
    assert np.all(np.delete(parts, 0) < 1e-5 * parts[0])
    # The linearised motion: a quarter of a swing brings the lifted leg to upright, but for third powers of 0.1 rad.
    quarter = math.pi / 2 / math.sqrt(-squares[0])
    aside = scene.states([quarter])[0][0] - np.array(UPRIGHT)
    assert np.abs(aside).max() < 0.05 * 0.1
    # The fastest growing mode alone, by the equations of motion: it must keep its shape and grow like cosh.
    rate = math.sqrt(squares[-1])
    start = 1e-7 * shapes[:, -1] / np.abs(shapes[:, -1]).max()
    grown = replace(
        scene,
        **dict(zip(("left_shank", "left_thigh", "trunk", "right_thigh", "right_shank"), start.tolist(), strict=True)),
    )
    end = grown.states([0.2])[0][0] - UPRIGHT
    assert np.abs(end - start * math.cosh(rate * 0.2)).max() < 1e-5 * np.abs(end).max()


def test_a_difference_of_the_swaying_start_grows_tenfold_within_its_horizon_and_not_much_more() -> None:
    scene = SwayingOnOneFoot()
    moved = replace(scene, left_thigh=scene.left_thigh + 1e-6)
    growth = [np.abs(moved.states([t])[0] - scene.states([t])[0]).max() / 1e-6 for t in (scene.horizon, scene.duration)]
    assert 3 < growth[0] < 30
    assert growth[1] > 100
