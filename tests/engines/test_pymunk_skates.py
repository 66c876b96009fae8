"""A skate in pymunk: which constructions hold it, which only look as if they did, and to what order."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from engines import Promise, Unpromised, Unsupported
from engines.lagrange import Lagrange
from engines.pymunk import EXTENDED, TUNED, Pymunk, methods
from reference.joints import Skate
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.trajectory import Trajectory, energy

SLEIGH, CAR = ChaplyginSleigh(), CarAndTrailer()
SLED = SLEIGH.mechanism()


def largest(values) -> float:
    return float(np.abs(values).max())


def run(engine, scene, every: int) -> tuple[Trajectory, Trajectory]:
    """What the engine makes of the scene at `every` steps of a sample of 0.01 s, and the truth."""
    trajectory = engine.build(scene.mechanism(), 0.01 / every)(scene.samples, every)
    return trajectory, scene.motion(trajectory.t)


def position_error(engine, scene, every: int) -> float:
    trajectory, truth = run(engine, scene, every)
    return largest(trajectory.pose - truth.pose)


def slip(scene, trajectory: Trajectory) -> float:
    return largest(scene.mechanism().slip(trajectory.pose, trajectory.twist))


@pytest.mark.parametrize("engine", [methods.SKATE_PROJECTED, methods.SKATE_GROOVE], ids=lambda each: each.variant)
def test_a_row_held_at_the_end_of_each_step_is_of_first_order(engine):
    coarse, fine = (position_error(engine, SLEIGH, every) for every in (10, 40))
    assert np.log2(coarse / fine) / 2 == pytest.approx(1, abs=0.1)  # the next power of the step is 1e-2 of this


def test_no_slip_proves_nothing_the_shifted_velocity_is_another_motion_at_any_step():
    for every in (10, 40):
        trajectory, truth = run(methods.SKATE_POINT, SLEIGH, every)
        assert slip(SLEIGH, trajectory) < 1e-14
        assert largest(trajectory.pose[..., :2] - truth.pose[..., :2]) > 1  # m, of a path of 6 m
        # It pumps energy in: the sleigh ends many times livelier than it began.
        assert energy(SLED, trajectory)[-1] > 5 * SLEIGH.energy


def test_zeroing_the_centres_velocity_is_another_motion_unless_the_skate_is_there():
    assert position_error(methods.SKATE_CENTRE, SLEIGH, 40) > 1
    there = ChaplyginSleigh(offset=0.0)
    assert position_error(methods.SKATE_CENTRE, there, 40) < 5e-3  # a circle, first order


@pytest.mark.parametrize("engine", [methods.SKATE_CENTRE, methods.SKATE_POINT], ids=lambda engine: engine.variant)
def test_a_naive_skate_promises_an_order_only_where_a_force_at_the_blade_turns_nothing(engine):
    assert isinstance(engine.order(SLED), Unpromised)
    for point in ((0.0, 0.0), (-0.1, 0.3)):  # the centre of mass, and a point across a blade along (0.3, 0.1)
        blade = Skate("blade", None, "sled", point, float(np.arctan2(0.1, 0.3)))
        mechanism = Mechanism((Body("sled", 1.0, 0.1, (0.0, 0.0, 0.0)),), (blade,))
        assert engine.order(mechanism) == Promise(1, differences=1)


def test_the_predicted_groove_slips_by_rounding_only():
    predicted, _ = run(TUNED, SLEIGH, 10)
    assert slip(SLEIGH, predicted) < 1e-10
    assert TUNED.softness(SLED, 1e-3) is None


@pytest.mark.parametrize(
    "scene", [SLEIGH, ChaplyginSleigh(offset=-0.2), ChaplyginSleigh(offset=0.0), ChaplyginSleigh(turning_rate=-1.0)]
)
def test_the_extended_sleigh_reaches_its_goal(scene):
    trajectory, truth = run(EXTENDED, scene, 1)
    assert largest(trajectory.pose - truth.pose) < 1e-11
    assert slip(scene, trajectory) < 1e-11
    scale = largest(truth.reaction)
    assert largest(trajectory.reaction - truth.reaction) < 1e-8 * max(scale, 1e-3)


def test_a_groove_extrapolated_is_as_good_and_both_powers_are_right():
    # Were the powers of the error others, five levels would leave 1e-5 and more.
    assert position_error(methods.SKATE_GROOVE_EXTRAPOLATED, SLEIGH, 1) < 1e-11
    assert position_error(replace(methods.SKATE_GROOVE_EXTRAPOLATED, powers=(2, 3, 4, 5)), SLEIGH, 1) > 1e-7


@cache
def towed() -> tuple[Trajectory, Trajectory]:
    return run(EXTENDED, CAR, 1)


def test_the_extended_car_and_trailer_reach_their_goal():
    trajectory, truth = towed()
    assert largest(trajectory.pose - truth.pose) < 1e-10
    assert largest(trajectory.twist - truth.twist) < 1e-8
    assert slip(CAR, trajectory) < 1e-8
    # The first force is extrapolated from the steps after it, on top of the extrapolation in the step.
    assert largest(trajectory.reaction[1:] - truth.reaction[1:]) < 1e-4 * largest(truth.reaction)


def test_a_blade_anywhere_on_its_axle_is_the_same_blade():
    """A groove at the wheel itself, off the line of the centre of mass, would give a wrong impulse."""
    for own in ((-0.5, 0.4), (-0.5, -1.0)):
        moved = replace(SLED, joints=(Skate("skate", None, "sleigh", own),))
        trajectory = TUNED.build(moved, 1e-3)(20, 10)
        plain = TUNED.build(SLED, 1e-3)(20, 10)
        assert largest(trajectory.pose - plain.pose) < 1e-14


def test_a_blade_set_at_an_angle_is_turned_with_the_body():
    turned = Mechanism(
        (replace(SLED.bodies[0], twist=(np.cos(0.3), np.sin(0.3) + 0.0, 0.0)),),
        (Skate("skate", None, "sleigh", (-0.5 * np.cos(0.3), -0.5 * np.sin(0.3)), 0.3),),
    )
    for engine in (TUNED, EXTENDED, methods.SKATE_PROJECTED):
        trajectory = engine.build(turned, 1e-2)(50, 1)
        # Without turning it slides straight along the blade.
        path = trajectory.pose[:, 0, :2] - turned.pose[0, :2]
        assert largest(path - trajectory.t[:, None] * [np.cos(0.3), np.sin(0.3)]) < 1e-12


def board_and_blade() -> Mechanism:
    """A blade that runs on a board which is itself free: two bodies, nothing holds them but the row."""
    board = Body("board", 3.0, 2.0, (0.0, 0.0, 0.2), (0.1, 0.0, 0.5))
    # The blade, 0.5 behind its body's centre, touches at that moment the board's material at (0.5, 0) [m].
    touch = np.array([0.5, 0.0])
    heading = 0.4
    ahead = np.array([np.cos(heading), np.sin(heading)])
    material = np.array([0.1, 0.0]) + 0.5 * np.array([-touch[1], touch[0]])
    rate = 2.0
    own = material + 1.0 * ahead + 0.5 * rate * np.array([-ahead[1], ahead[0]])
    centre = touch + 0.5 * ahead
    body = Body("sleigh", 2.0, 0.3, (*centre.tolist(), heading), (*own.tolist(), rate))
    return Mechanism((board, body), (Skate("skate", "board", "sleigh", (-0.5, 0.0)),))


def test_a_skate_on_a_body_that_moves_is_held_too():
    mechanism = board_and_blade()
    truth = Lagrange("dop853", "projection", 1e-12).build(mechanism, 1e-2)(50, 1)
    trajectory = EXTENDED.build(mechanism, 1e-2)(50, 1)
    assert largest(trajectory.pose - truth.pose) < 1e-9
    assert largest(mechanism.slip(trajectory.pose, trajectory.twist)) < 1e-8
    for engine in (methods.SKATE_CENTRE, methods.SKATE_PROJECTED):
        with pytest.raises(Unsupported, match="on the ground only"):
            engine.build(mechanism, 1e-2)


def test_a_construction_that_does_not_exist_is_refused_with_those_that_do():
    with pytest.raises(ValueError, match="'projection', 'groove'"):
        Pymunk("mine", skate="velcro")  # type: ignore[arg-type]


@pytest.mark.parametrize("engine", methods.SKATES, ids=lambda each: each.variant)
def test_a_sleigh_that_is_thrown_too_far_is_a_result_and_not_an_exception(engine):
    wild = replace(SLED, bodies=(replace(SLED.bodies[0], twist=(1e200, 0.0, 0.0)),))
    trajectory = engine.build(wild, 1e200)(10, 2)
    assert trajectory.pose.shape == (11, 1, 3)


def test_a_blade_that_is_aimed_closes_no_gap_and_so_adds_no_noise():
    # It closed what rounding shows of a gap within a step: 1e-16 m in 1e-4 s, and reactions are changes of velocity
    # over a step. They were wrong by 1e-6 N here, and are by 2e-10 N.
    scene = ChaplyginSleigh(duration=3.0, horizon=3.0)
    trajectory = methods.SKATE_GROOVE_EXTRAPOLATED.build(scene.mechanism(), 1e-3)(100, 30)
    right = scene.motion(trajectory.t)
    assert largest(trajectory.reaction - right.reaction) < 1e-8
    assert largest(trajectory.twist - right.twist) < 1e-11
