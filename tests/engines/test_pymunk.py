"""The pymunk adapter: what it builds, at which instant it reads, and how its error falls with the step."""

from __future__ import annotations

from functools import cache

import numpy as np
import pymunk
import pytest
from numpy.typing import NDArray
from pymunk import constraints
from pymunk._chipmunk_cffi import lib
from scipy.special import ellipj, ellipk

from engines import Size
from engines.extrapolated import Extrapolated
from engines.lagrange import Lagrange
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED
from engines.pymunk.methods import AIMED, SETTLED
from engines.pymunk.running import Recorder
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.pendulum.scenes import TenLinks
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.trajectory import Trajectory, energy
from tests.mechanisms import bar, four_bar, pendulum

FREE, MOVING, DRIVEN = four_bar(), four_bar(10.0), four_bar(10.0, drive=10.0)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)


@cache
def exact(which: str) -> Trajectory:
    """Half a second, 50 samples, by exact multipliers at tight tolerance: another formulation, no pymunk."""
    mechanism = {"free": FREE, "moving": MOVING, "driven": DRIVEN, "elbow": elbow()}[which]
    return Lagrange("dop853", "projection", TIGHT).build(mechanism, 1e-3)(50, 10)


TIGHT = 1e-13


def elbow() -> Mechanism:
    """Two bars from the origin, driven against each other where they meet."""
    upper, lower = bar("upper", (0.0, 0.0), (1.0, 0.0)), bar("lower", (1.0, 0.0), (1.0, -0.7), rate=2.0)
    joints = (
        Pin("A", None, "upper", (0.0, 0.0), (-0.5, 0.0)),
        Pin("B", "upper", "lower", (0.5, 0.0), (-0.35, 0.0)),
        Drive("motor", "upper", "lower", 2.0, -np.pi / 2),
    )
    return Mechanism((upper, lower), joints, (0.0, -9.81))


def largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values).max())


def order(method, mechanism: Mechanism, truth: Trajectory, quantity: str, every: int) -> float:
    """Observed order of the error between `every` and four times as many steps a sample of 0.01 s."""
    coarse, fine = (
        largest(getattr(method.build(mechanism, 0.01 / n)(50, n), quantity) - getattr(truth, quantity))
        for n in (every, 4 * every)
    )
    return float(np.log2(coarse / fine) / 2)


# What is built


def test_the_default_is_the_engine_as_shipped():
    space, body = pymunk.Space(), pymunk.Body(1, 1)
    pivot = constraints.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    assert space.iterations == DEFAULT.iterations == 10
    assert pivot.error_bias == DEFAULT.error_bias == pytest.approx(0.9**60, rel=1e-5)  # it rounds 0.1 to single


@every_method
def test_no_more_is_built_than_the_mechanism_has(method):
    assert method.build(FREE, 1e-3).size == Size(bodies=3, coordinates=9, rows=8, solver_rows=8)
    # The crank's pin and drive are its motion: only three pins are left to forces.
    assert method.build(DRIVEN, 1e-3).size == Size(bodies=3, coordinates=9, rows=6, solver_rows=6)
    assert method.build(elbow(), 1e-3).size == Size(bodies=2, coordinates=6, rows=5, solver_rows=5)


@pytest.mark.parametrize("grounded_first", [True, False])
def test_a_crank_turns_about_its_pin_whatever_the_order_of_its_joints(grounded_first):
    centre, rate, own = np.array([2.0, -1.0]), -3.0, (0.3, 0.1)
    angle = 0.7
    arm = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ own
    position, velocity = centre - arm, -rate * np.array([-arm[1], arm[0]])
    (x, y), (along, up) = map(float, position), map(float, velocity)
    body = Body("crank", 2.0, 0.5, (x, y, angle), (along, up, rate))
    joints = (
        (Pin("A", None, "crank", (2.0, -1.0), own), Drive("drive", None, "crank", rate, angle))
        if grounded_first
        else (Drive("drive", "crank", None, -rate, -angle), Pin("A", "crank", None, own, (2.0, -1.0)))
    )
    mechanism = Mechanism((body,), joints, (0.0, -9.81))
    for method in METHODS:
        trajectory = method.build(mechanism, 1e-2)(30, 3)
        # Rounding: the angle is a sum of at most 720 steps near one radian, weighted by less than 100 if extrapolated.
        assert largest(mechanism.gap(trajectory.pose, trajectory.t)) < 1e-12
        assert largest(mechanism.slip(trajectory.pose, trajectory.twist)) < 1e-12
        # The pin carries weight and centripetal force, and the drive the moment of the weight about the pin.
        swing = trajectory.pose[:, 0, :2] - centre
        sign = 1 if grounded_first else -1
        order = [0, 1, 2] if grounded_first else [1, 2, 0]
        force = sign * 2.0 * (-(rate**2) * swing + [0, 9.81])
        torque = sign * 2.0 * 9.81 * swing[:, 0]
        error = np.abs(trajectory.reaction[:, order] - np.column_stack([force, torque]))
        assert error[1:].max() < 1e-9  # rounding
        # Before the first sample no step lies: there stands the third step's force, 0.09 rad on, or what the third and
        # fourth extrapolate to, 6 (rate dt)^2 of the force away, or that extrapolated, with a fifth of the step.
        assert error[0].max() < {DEFAULT: 0.09, TUNED: 0.09, LEAPFROG: 6e-3, EXTENDED: 1e-9}[method] * 2.0 * 9.81


def test_bodies_are_recorded_in_the_order_asked_for_whatever_the_order_in_which_c_visits_them():
    model = DEFAULT.model(four_bar(), 1e-3)
    told = []
    for bodies in (model.bodies, model.bodies[::-1]):
        recorder = Recorder(model.space, bodies, 2, 0)
        for _ in range(2):
            lib.cpSpaceEachBody(model.space._space, recorder.visitor, recorder.states)
        told.append(recorder.read(1, with_velocities=False)[0])
    np.testing.assert_array_equal(told[0], told[1][:, ::-1])
    np.testing.assert_array_equal(told[0][0, :, :3], four_bar().pose)


# When it reads


def pendulum_truth(t: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Angle and rate of the uniform bar of 1 m let go 1 rad from the vertical, by Jacobi's elliptic functions."""
    frequency, modulus = np.sqrt(1.5 * 9.81), np.sin(0.5) ** 2
    sine, cosine, *_ = ellipj(ellipk(modulus) - frequency * t, modulus)
    swing = 2 * np.arcsin(np.sin(0.5) * sine)
    return swing - np.pi / 2, -2 * np.sin(0.5) * frequency * cosine


def pendulum_errors(method, every: int) -> tuple[float, float]:
    trajectory = method.build(pendulum(), 0.01 / every)(100, every)
    angle, rate = pendulum_truth(trajectory.t)
    return largest(trajectory.pose[:, 0, 2] - angle), largest(trajectory.twist[:, 0, 2] - rate)


@pytest.mark.parametrize(("method", "expected"), [(DEFAULT, (1, 1)), (TUNED, (1, 2)), (LEAPFROG, (2, 2))])
def test_a_pendulum_swings_as_elliptic_functions_say_to_the_order_of_the_method(method, expected):
    # From rest the tuned motion is late by half a step, and its velocities are read early by the same.
    coarse, fine = pendulum_errors(method, 10), pendulum_errors(method, 40)
    for quantity in range(2):
        observed = np.log2(coarse[quantity] / fine[quantity]) / 2
        assert observed == pytest.approx(expected[quantity], abs=0.1)  # the next power of the step is 1e-3 of this


def test_the_extended_pendulum_is_exact_to_rounding():
    # 8000 steps a second, each rounded by 1e-16, weighted by about 10; rates a natural frequency (4/s) larger.
    angle, rate = pendulum_errors(EXTENDED, 10)
    assert angle < 1e-11
    assert rate < 1e-10


def test_a_velocity_read_at_the_wrong_instant_would_be_seen():
    """What the engine holds in a leapfrog is half a step ahead; taken for the velocity now, it is first order."""
    model = LEAPFROG.model(pendulum(), 1e-3)
    model.kick(0.5e-3)
    for _ in range(500):
        model.space.step(1e-3)
    _, rate = pendulum_truth(np.array([0.5]))
    held = model.bodies[0].angular_velocity
    read = LEAPFROG.build(pendulum(), 1e-3)(1, 500).twist[1, 0, 2]
    acceleration = -1.5 * 9.81 * np.cos(pendulum_truth(np.array([0.5]))[0][0])
    assert held - rate[0] == pytest.approx(0.5e-3 * acceleration, rel=0.05)
    assert abs(read - rate[0]) < 0.05 * abs(held - rate[0])


# How its error falls


@pytest.mark.parametrize("quantity", ["pose", "twist", "reaction"])
def test_the_free_four_bar_has_the_order_of_the_method(quantity):
    truth = exact("free")
    # The bias as shipped leaves a gap of the order of dt; at these steps the next order still shows in the motion.
    assert order(DEFAULT, FREE, truth, "pose", 10) == pytest.approx(1, abs=0.25)
    assert order(LEAPFROG, FREE, truth, quantity, 10) == pytest.approx(2, abs=0.15)
    # From rest the tuned motion is late by half a step, and its velocities are read early by the same.
    tuned = 2 if quantity == "twist" else 1
    assert order(TUNED, FREE, truth, quantity, 10) == pytest.approx(tuned, abs=0.15)


def test_the_driven_four_bar_as_tuned_is_first_order_in_the_rates():
    # The crank is prescribed, so that the poses err only by the gap, dt squared; rates are read half a step early.
    truth = exact("driven")
    assert order(TUNED, DRIVEN, truth, "twist", 10) == pytest.approx(1, abs=0.1)
    assert order(TUNED, DRIVEN, truth, "pose", 10) == pytest.approx(2, abs=0.1)


@pytest.mark.parametrize(("which", "mechanism"), [("free", FREE), ("driven", DRIVEN)])
def test_tuned_is_within_two_thousandths_of_a_radian_at_a_tenth_of_a_millisecond(which, mechanism):
    trajectory = TUNED.build(mechanism, 1e-4)(50, 100)
    assert largest(trajectory.pose - exact(which).pose) < 2e-3


@pytest.mark.parametrize(("which", "mechanism"), [("free", FREE), ("driven", DRIVEN), ("moving", MOVING)])
def test_the_extended_four_bar_reaches_its_goal(which, mechanism):
    truth = exact(which)
    trajectory = EXTENDED.build(mechanism, 1e-3)(50, 10)
    # Truncation h^6 with h = 1/2000 s and rates of 10/s is 1e-12 and below; rounding of 8000 steps a second the same.
    assert largest(trajectory.pose - truth.pose) < 1e-11
    assert largest(trajectory.twist - truth.twist) < 1e-9
    # A force is a difference of velocities over a step of 1e-4 s: rounding grows by 1e4.
    assert largest(trajectory.reaction - truth.reaction) < 1e-8 * largest(truth.reaction)
    if which != "driven":
        total = energy(mechanism, trajectory)
        assert np.ptp(total) < 3e-11 * largest(total)
    assert trajectory.estimate is not None
    assert largest(trajectory.estimate) < 1e-9


@pytest.mark.parametrize("scene", [FreeFourBar(), DrivenFourBar()], ids=lambda scene: scene.name)
def test_over_the_whole_scene_tuned_and_extended_reach_their_goals(scene):
    """Against the textbook's own motion: a closed form if driven, a minimal-coordinate equation if free."""
    mechanism, truth = scene.mechanism(), scene.motion(np.arange(scene.samples + 1) * scene.spacing)
    tuned = TUNED.build(mechanism, scene.spacing / 100)(scene.samples, 100)
    assert largest(tuned.pose - truth.pose) < 2e-3
    extended = EXTENDED.build(mechanism, scene.spacing / 10)(scene.samples, 10)
    # As above, over twice the time.
    assert largest(extended.pose - truth.pose) < 1e-11
    assert largest(extended.twist - truth.twist) < 1e-9
    assert largest(extended.reaction - truth.reaction) < 1e-8 * largest(truth.reaction)


def test_extrapolating_in_even_powers_only_would_be_seen():
    truth = exact("moving")
    even = Extrapolated(LEAPFROG, "even", levels=(2, 3, 4, 6, 8), powers=(2, 4, 6, 8))
    error = largest(even.build(MOVING, 1e-3)(50, 10).pose - truth.pose)
    assert error > 1e3 * largest(EXTENDED.build(MOVING, 1e-3)(50, 10).pose - truth.pose)


@pytest.mark.parametrize("method", [LEAPFROG, EXTENDED], ids=lambda method: method.variant)
def test_a_motor_between_two_moving_bodies_keeps_rate_and_angle(method):
    truth, trajectory = exact("elbow"), method.build(elbow(), 1e-3)(50, 10)
    # Second order with rates of 4/s at 1e-3 s. Five sweeps over this chain shrink what is open by a few only, so that
    # the cold start of the leapfrog is still felt for some samples, in the reactions most. Extrapolated runs begin with
    # sweeps that leave nothing; a difference of velocities over 1e-4 s is then all that rounds.
    assert largest(trajectory.pose - truth.pose) < (2e-5 if method is LEAPFROG else 1e-12)
    late = 25 if method is LEAPFROG else 0
    assert largest((trajectory.reaction - truth.reaction)[late:]) < (1e-2 if method is LEAPFROG else 1e-6)
    assert largest(elbow().gap(trajectory.pose, trajectory.t)[:, -1]) < 1e-12


# Reactions


@pytest.mark.parametrize("method", [DEFAULT, TUNED], ids=lambda method: method.variant)
def test_reactions_are_the_engines_own_impulses_over_the_step(method):
    dt, every = 1e-3, 7
    model = method.model(MOVING, dt)
    reaction = method.build(MOVING, dt)(20, every).reaction
    for sample in range(1, 21):
        for _ in range(every):
            model.space.step(dt)
        forces = [constraint.impulse / dt for constraint in model.space.constraints]
        # A difference of velocities near 10 m/s over 1e-3 s: rounding 1e-12, times the row system's condition.
        assert np.hypot(*reaction[sample].reshape(4, 2).T) == pytest.approx(forces, abs=1e-9)


@every_method
def test_a_hanging_bar_is_held_up_by_its_weight_from_the_first_sample_on(method):
    mechanism = pendulum(angle=-np.pi / 2)
    trajectory = method.build(mechanism, 1e-3)(10, 10)
    # Force on the second body, the bar: upwards, 1 kg. Rounding of velocities over the smallest step of 1.25e-4 s.
    assert largest(trajectory.reaction - [0.0, 9.81]) < 1e-9


@every_method
def test_two_free_bodies_keep_their_momentum(method):
    left, right = (
        bar("left", (0.0, 0.0), (1.0, 0.0), rate=3.0),
        bar("right", (1.0, 0.0), (1.5, 0.5), (0.0, 3.0), rate=-2.0),
    )
    mechanism = Mechanism((left, right), (Pin("B", "left", "right", (0.5, 0.0), (-np.sqrt(0.125), 0.0)),))
    trajectory = method.build(mechanism, 1e-3)(100, 10)
    mass = np.array([left.mass, right.mass])
    momentum = np.sum(mass[:, None] * trajectory.twist[..., :2], axis=1)
    assert largest(momentum - momentum[0]) < 1e-11  # impulses are equal and opposite: rounding only
    assert largest(trajectory.reaction) > 0.1  # and there are some


@pytest.mark.parametrize("method", [SETTLED, AIMED], ids=lambda method: method.variant)
def test_how_often_a_run_is_sampled_changes_neither_its_poses_nor_its_iterations(method):
    """A run begins with many iterations a step; they end with the steps that ask for them, wherever a sample stands."""
    mechanism = TenLinks().mechanism() if method is SETTLED else ChaplyginSleigh().mechanism()
    often, seldom = (method.build(mechanism, 1e-3)(60 // every, every).pose for every in (1, 10))
    assert np.array_equal(often[::10], seldom)
