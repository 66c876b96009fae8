"""Tests of the convergence and stability of pymunk's iterations."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import ConvergenceOrder
from engines.lagrange import TRUTH
from engines.pymunk import DEFAULT, LEAPFROG, TUNED, Pymunk
from engines.pymunk.convergence import convergence_factor, convergence_factor_at, corrects_gap, step_spectral_radius
from engines.pymunk.iterations import iterations_in_step, stable_gain, worst_factor
from reference.joints import Drive, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.trajectory import energy, joint_gap
from reports.search.mechanisms import mechanism
from reports.search.parts import ALL_KINDS
from tests.engines.test_pymunk import every_method, largest
from tests.mechanisms import four_bar

WITH_MOTOR = (451161196, 54)  # Seed and number of a mechanism with a motor, pins and a gear.


@every_method
def test_a_load_on_a_body_that_is_driven_without_a_pin_does_not_turn_it(method):
    block = Body("block", 1.0, 0.1, (0.0, 0.0, 0.0))
    pendulum = Body("pendulum", 2.0, 0.1, (0.8, 0.0, 0.0))
    joints = (
        Drive("level", None, "block", 0.0, 0.0),
        Slot("guide", None, "block", (0.0, 0.0), 0.0, (0.0, 0.0)),
        Pin("hook", "block", "pendulum", (0.3, 0.0), (-0.5, 0.0)),
    )
    trajectory = method.build(Mechanism((block, pendulum), joints, (0.0, -9.81)), 1e-3)(20, 10)
    # The weight of the bar, 0.3 m from the middle of the block, would turn a block that is free to rotate.
    assert largest(trajectory.pose[:, 0, 2]) < 1e-12
    assert largest(trajectory.pose[-1, 1, 2]) > 0.1


@pytest.mark.parametrize("links", [2, 10, 80])
def test_the_convergence_factor_of_a_chain_of_equal_links(links):
    rho = convergence_factor(LinkPendulum(links=links).mechanism())
    # The slowest mode is the longest wave of a chain with one fixed end.
    assert rho == pytest.approx(math.cos(math.pi / (2 * links)) ** 2, abs=1e-6)


def test_the_convergence_factor_ignores_prescribed_motions_and_depends_on_masses():
    assert convergence_factor(LinkPendulum(links=1).mechanism()) == 0  # a single joint
    driven, free = (convergence_factor(four_bar(10.0, drive=drive)) for drive in (10.0, None))
    assert driven < free < 1
    # With a mass ratio of 100 the convergence is a hundred times slower.
    assert 1 - convergence_factor(LinkPendulum(tip=100.0).mechanism()) == pytest.approx(0.01, rel=0.05)


def test_the_number_of_iterations_follows_from_the_worst_pose_of_the_motion():
    """The convergence factor of the free four-bar is 0.59 at the start, and 0.81 when the linkage folds."""
    scene = FreeFourBar()
    mechanism = scene.mechanism()
    passed = scene.motion(np.linspace(0, scene.duration, 200)).pose
    worst = max(convergence_factor_at(mechanism, pose) for pose in passed)
    assert iterations_in_step(convergence_factor(mechanism)) < iterations_in_step(worst)
    # The pilot run has other sample times than the motion, so the number of iterations may differ by one.
    assert abs(iterations_in_step(worst_factor(mechanism, scene.duration)) - iterations_in_step(worst)) <= 1
    assert worst_factor(mechanism, 0.0) == convergence_factor(mechanism)
    # Bars that are a thousand times as long have the same factor, since gaps are relative to the length.
    longer = {name: 1e3 * getattr(scene, name) for name in ("crank", "coupler", "rocker")}
    larger = replace(scene, **longer, ground=(1200.0, 0.0), gravity=(0.0, -9810.0)).mechanism()
    assert worst_factor(larger, scene.duration) == pytest.approx(worst_factor(mechanism, scene.duration))
    assert LEAPFROG.plan(mechanism, scene.duration).iterations > LEAPFROG.plan(mechanism).iterations
    assert LEAPFROG.plan(mechanism, scene.duration).gain == 1


@pytest.mark.parametrize("iterations", [2, 10])
def test_with_few_iterations_the_stable_gain_adds_no_energy_and_a_gain_of_one_does(iterations):
    mechanism, dt = TenLinks().mechanism(), 1e-3

    def gained(closed: float) -> float:
        engine = Pymunk("mine", iterations=iterations, error_bias=(1 - closed) ** (1 / dt), leapfrog=True)
        return float(np.ptp(energy(mechanism, engine.build(mechanism, dt)(300, 10))))

    # The ten links of 1 kg and 1 m fall by 5 m, so about 490 J of potential energy become kinetic energy.
    assert gained(stable_gain(convergence_factor(mechanism), iterations)) < 1
    assert gained(1.0) > 500


@pytest.mark.parametrize(("seed", "number"), [(77777, 239), (77777, 255), (77777, 266), WITH_MOTOR])
def test_welds_and_motors_are_stable_at_short_steps_or_no_order_is_declared(seed, number):
    """Welds have complex modes, and motors correct no gap.

    With complex modes treated as real, the error of mechanism 255 would be a thousand times the motion. With motors
    that correct a gap, the error at a quarter of the step would be five hundred times larger.
    """
    mixed = mechanism(seed, number, ALL_KINDS)
    span = 0.4 * mixed.time_scale
    truth = TRUTH.build(mixed, span)(1, 1)

    def missed(engine: Pymunk, steps: int) -> float:
        return largest(engine.build(mixed, span / steps)(1, steps).pose[-1] - truth.pose[-1])

    assert missed(TUNED, 640) < 0.3 * missed(TUNED, 160)
    assert isinstance(TUNED.order(mixed), ConvergenceOrder)
    assert isinstance(DEFAULT.order(mixed), ConvergenceOrder) == (missed(DEFAULT, 640) < missed(DEFAULT, 160))


@pytest.mark.parametrize(("seed", "number", "few"), [(*WITH_MOTOR, 30), (31, 655, 9), (31, 981, 8)])
def test_impulses_grow_by_the_spectral_radius_of_the_step_if_motors_and_blades_correct_no_gap(seed, number, few):
    mixed = mechanism(seed, number, ALL_KINDS)
    corrected = corrects_gap(mixed, rolls_are_contacts=True)
    assert 0 < corrected.mean() < 1

    def grown(iterations: int) -> float:
        """The growth of impulses in a step, measured in the last two thirds of a run with very short steps."""
        twist = replace(TUNED, iterations=iterations, error_bias=0.0).build(mixed, 1e-7 * mixed.time_scale)(66, 1).twist
        change = np.abs(np.diff(twist, axis=0)).max(axis=(1, 2))
        return float((change[-1] / change[20]) ** (1 / 45))

    # Impulses grow by 5 to 25 % in a step. Other modes change this growth by at most 2 %.
    assert grown(few) == pytest.approx(step_spectral_radius(mixed, mixed.pose, few, corrected), abs=0.02)
    enough = TUNED.plan(mixed).iterations
    assert grown(enough) < 1.01
    # With fewer iterations a step corrects only a fraction of the gap, and the run has a warning.
    short = replace(TUNED, iterations=few).build(mixed, 1e-3 * mixed.time_scale)(2, 2)
    assert any("not converged" in warning for warning in short.warnings)


def test_a_small_gain_does_not_underflow_to_a_gain_of_one_at_small_steps():
    """For dt = 1e-5 s, 0.9 ** (1/dt) underflows to zero. With the value zero a step would correct the whole gap."""
    assert 0.9 ** (1 / 1e-5) == 0
    heavy = LinkPendulum(tip=1e4)
    model = LEAPFROG.model(heavy.mechanism(), 1e-5)
    rho = convergence_factor(heavy.mechanism())
    assert model.unit == 1e-5
    assert next(iter(model.space.constraints)).error_bias == pytest.approx(1 - stable_gain(rho, 300), rel=1e-12)
    assert model.space.gravity == pytest.approx((0.0, -9.81e-10), rel=1e-12)


def test_a_hundred_links_are_reported_as_not_converged_and_stay_together():
    scene = LinkPendulum(links=100, length=0.01, mass=0.01, duration=0.2, horizon=0.2)
    trajectory = LEAPFROG.build(scene.mechanism(), scene.spacing / 10)(scene.samples, 10)
    assert any("not converged" in warning for warning in trajectory.warnings)
    assert largest(joint_gap(scene.mechanism(), trajectory)) < 1e-3  # [m], of a length of 1 m
    assert largest(trajectory.pose[:, -1, :2] - scene.motion(trajectory.t).pose[:, -1, :2]) < 1e-2
