"""The skate: its row and parking; the sleigh's constants of motion, its long runs, and wrong sleighs.

The sleigh and the pinned body in fifty digits are asked by `laws`, their motions and forces by `test_scenes`.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from reference.chapter.parking import Move, commutator, commutator_displacement, park, sidestep, stops, trace
from reference.checks import InvalidMechanism
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards


def test_the_joint_has_the_row_of_18_64_and_leaves_three_configurations_and_two_velocities():
    for angle in (0.0, 0.7, -2.0):
        body = Body("sledge", 2.0, 0.3, (0.4, 0.1, angle))
        mechanism = Mechanism((body,), (Skate("skate", None, "sledge", (-0.5, 0.3)),))
        printed = [-math.sin(angle), math.cos(angle), -0.5]  # the coordinate y' of C drops out
        assert np.abs(mechanism.rows(mechanism.pose)[0] - printed).max() < 1e-15
        assert mechanism.degrees_of_freedom() == (3, 2)
        assert np.isnan(mechanism.gap(mechanism.pose, 0.0)).all()


def test_a_blade_at_an_angle_and_on_another_body_stops_the_relative_velocity_across_it():
    rng = np.random.default_rng(5)
    poses, twists = rng.normal(size=(2, 2, 3))
    point, angle = (0.3, -0.4), 0.9
    bodies = tuple(Body(name, 1.0, 1.0, tuple(pose.tolist())) for name, pose in zip("ab", poses, strict=True))
    mechanism = Mechanism(bodies, (Skate("blade", "a", "b", point, angle),))
    turn = np.array([[math.cos(poses[1, 2]), -math.sin(poses[1, 2])], [math.sin(poses[1, 2]), math.cos(poses[1, 2])]])
    place = poses[1, :2] + turn @ point

    def at(body):
        arm = place - poses[body, :2]
        return twists[body, :2] + twists[body, 2] * np.array([-arm[1], arm[0]])

    left = np.array([-math.sin(poses[1, 2] + angle), math.cos(poses[1, 2] + angle)])
    assert mechanism.slip(poses, twists)[0] == pytest.approx((at(1) - at(0)) @ left, abs=1e-14)


def test_a_start_that_slides_sideways_is_refused():
    body = Body("sledge", 1.0, 1.0, (0.0, 0.0, 0.0), (1.0, 0.1, 0.0))
    with pytest.raises(InvalidMechanism, match="moving apart"):
        Mechanism((body,), (Skate("skate", None, "sledge", (0.0, 0.0)),))


def test_any_pose_is_reached_from_any_other_by_turn_slide_turn():
    rng = np.random.default_rng(7)
    for start, goal in zip(rng.uniform(-9, 9, (50, 3)), rng.uniform(-9, 9, (50, 3)), strict=True):
        for backwards in (True, False):
            moves = park(tuple(start), tuple(goal), backwards)
            assert np.abs(stops(tuple(start), moves)[-1] - goal).max() < 1e-13
            assert abs(moves[0].turn) <= (math.pi / 2 if backwards else math.pi)
    assert park((1.0, 2.0, 0.0), (1.0, 2.0, 3.0)) == (Move(), Move(turn=3.0))


def test_no_part_of_a_manoeuvre_skids():
    path = trace((0.0, 0.0, 0.3), (*park((0.0, 0.0, 0.3), (1.0, 2.0, -1.0)), *sidestep(1.0, 0.7, 0.5)))
    moved, middle = np.diff(path, axis=0), 0.5 * (path[1:, 2] + path[:-1, 2])
    assert np.abs(-np.sin(middle) * moved[:, 0] + np.cos(middle) * moved[:, 1]).max() < 1e-14


def test_the_commutator_moves_sideways_by_the_product_of_its_moves_as_they_shrink():
    assert (
        np.abs(stops((0.0, 0.0, 0.0), commutator(0.6, 0.5))[-1] - [*commutator_displacement(0.6, 0.5), 0.0]).max()
        < 1e-15
    )
    turn = np.array([1e-1, 1e-2, 1e-3])
    rest = commutator_displacement(turn, turn) / turn[:, None] ** 2 - [0.0, 1.0]
    assert np.abs(rest[:, 0] / turn + 1 / 2).max() < 1e-3  # -turn/2 + turn^3/24
    assert np.abs(rest[:, 1] / turn**2 + 1 / 6).max() < 1e-4  # -turn^2/6 + turn^4/120


def test_a_sidestep_is_exactly_sideways_within_its_room():
    for distance in (2.3, -0.01, 1e-6):
        moves = sidestep(distance, 0.5, 0.4)
        assert np.abs(stops((0.0, 0.0, 0.0), moves)[-1] - [0.0, distance, 0.0]).max() < 1e-14
        assert np.abs(trace((0.0, 0.0, 0.0), moves)[:, 2]).max() <= 0.4 + 1e-12
    assert sidestep(0.0, 1.0, 1.0) == ()
    with pytest.raises(InvalidMechanism, match="room"):
        sidestep(1.0, 0.0, 1.0)


def test_a_skate_almost_below_the_centre_of_mass_moves_as_one_below_it():
    almost, below = (ChaplyginSleigh(offset=offset).motion([1.0, 3.0]) for offset in (1e-9, 0.0))
    assert np.abs(almost.pose - below.pose).max() < 1e-7


def test_a_long_run_keeps_its_digits():
    sleigh = ChaplyginSleigh(duration=1000.0)
    motion = sleigh.motion([999.0, 1000.0])
    # By then it slides straight at V; the distance is 1000 V, whose rounding is 3e-13.
    assert np.hypot(*np.diff(motion.pose[:, 0, :2], axis=0)[0]) == pytest.approx(sleigh._top_speed, abs=2e-12)


def test_a_stiff_sleigh_settles_and_is_then_followed_for_ever():
    for sleigh in (ChaplyginSleigh(speed=1e5, duration=1e3), ChaplyginSleigh(offset=-1e-3, inertia=1e-9, duration=1e3)):
        long = sleigh.skate_pose([1e-2 + sleigh._settled, 1000.0])
        gone, settled = long[1] - long[0], long[1, 2]
        top = math.copysign(sleigh._top_speed * (1000 - 1e-2 - sleigh._settled), sleigh.offset)
        assert np.abs(gone[:2] - top * np.array([math.cos(settled), math.sin(settled)])).max() < 1e-14 * abs(top)
    # Before it settles the quadrature alone has the motion: the two halves agree.
    sleigh = ChaplyginSleigh()
    later = sleigh._settled + 1.0
    assert abs(sleigh._moved(later) - sleigh.skate_pose(later)[0] @ [1, 1j, 0]) < 1e-13


def test_backwards_a_small_turning_grows_at_the_linear_rate_and_the_sleigh_turns_round():
    sleigh = SleighBackwards(turning_rate=1e-9)
    turning = sleigh.rates([1.0, 2.0])[1]
    assert math.log(turning[1] / turning[0]) == pytest.approx(sleigh.growth_rate(), rel=1e-14)
    assert ChaplyginSleigh().growth_rate() < 0
    speed = SleighBackwards().rates([0.0, 20.0])[0]
    assert speed[0] == pytest.approx(-1.0, abs=1e-6)
    assert speed[1] == pytest.approx(1.0, abs=1e-6)
    # Two turns of the heading's limit: pi k/|a| for a full reversal from a straight run.
    assert SleighBackwards().heading(200.0) == pytest.approx(math.pi * math.sqrt(0.4) / 0.5, rel=1e-3)


def test_bad_sleighs_are_refused_and_a_point_mass_goes_straight():
    with pytest.raises(InvalidMechanism, match="nothing resists turning"):
        ChaplyginSleigh(inertia=0.0, offset=0.0)
    point = ChaplyginSleigh(inertia=0.0)
    motion = point.motion([0.0, 1.0, 2.0])
    assert np.abs(motion.twist[:, 0, :2] - motion.twist[0, 0, :2]).max() < 1e-14
    assert np.abs(motion.reaction).max() == 0
    with pytest.raises(InvalidMechanism, match="inertia"):
        point.mechanism()
