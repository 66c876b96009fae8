"""Tests of the exact solver: convergence orders, stabilisation, and motions with a closed form."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

from engines import Regularisation
from engines.constrained import constrained
from engines.lagrange import JUDGE_CLAIM, TRUTH, Judge, Lagrange
from engines.lagrange.dynamics import Dynamics, constrained_acceleration, inverse_inertia, runge_kutta
from engines.lagrange.methods import RK4
from reference.joints import Pin
from reference.mechanism import Body, Mechanism
from reference.plane import rotation_acceleration
from reference.scenes.four_bar.scenes import FreeFourBar, OverdrivenFourBar
from reference.trajectory import joint_gap, slip
from tests.mechanisms import four_bar, pendulum
from tests.present import present


@pytest.fixture(params=["compiled", "numpy"])
def code(request, monkeypatch):
    """Run the test in numpy, and in compiled code if numba is installed."""
    if request.param == "numpy":
        monkeypatch.setattr("engines.lagrange.engine.installed", lambda: False)


in_both_codes = pytest.mark.usefixtures("code")


def swinging_angle(t, amplitude):
    """The exact motion of a uniform bar of 1 m that starts at rest at `amplitude` [rad] from the vertical."""
    frequency, modulus = np.sqrt(1.5 * 9.81), np.sin(amplitude / 2) ** 2
    return 2 * np.arcsin(np.sin(amplitude / 2) * ellipj(ellipk(modulus) - frequency * t, modulus)[0])


@in_both_codes
def test_a_swinging_bar_agrees_with_elliptic_functions():
    run = TRUTH.build(pendulum(angle=-np.pi / 2 + 1.0), 0.1)(30, 1)
    # At a tolerance of 1e-13 the error after 3 s is several 1e-13.
    np.testing.assert_allclose(run.pose[:, 0, 2] + np.pi / 2, swinging_angle(run.t, 1.0), rtol=0, atol=2e-12)
    angle, rate = run.pose[:, 0, 2], run.twist[:, 0, 2]
    arm = 0.5 * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    pull = rotation_acceleration(rate, -1.5 * 9.81 * np.cos(angle), arm) + np.array([0.0, 9.81])  # per kilogram
    np.testing.assert_allclose(run.reaction, pendulum().bodies[0].mass * pull, rtol=0, atol=1e-10)


def test_dense_output_is_as_accurate_as_the_ends_of_steps():
    run = Lagrange(tolerance=1e-13).build(pendulum(angle=-np.pi / 2 + 1.0), 1e-3)(300, 1)
    # At this tolerance steps are longer than the spacing of samples, so most samples come from dense output.
    np.testing.assert_allclose(run.pose[:, 0, 2] + np.pi / 2, swinging_angle(run.t, 1.0), rtol=0, atol=2e-12)


@in_both_codes
@pytest.mark.parametrize(("tolerance", "resolved"), [(1e-13, True), (1e-6, False)])
def test_a_judge_estimates_its_error_and_reports_when_it_exceeds_its_claim(tolerance, resolved):
    run = Judge(tolerance=tolerance).build(pendulum(angle=-np.pi / 2 + 1.0), 0.5)(6, 1)
    error = np.abs(run.pose[:, 0, 2] + np.pi / 2 - swinging_angle(run.t, 1.0))
    estimate = present(run.estimate)[:, 0, 2]
    # In numpy all steps end at samples, so the error of the second run is hardly larger.
    assert error.max() < 2 * estimate.max() + 1e-12
    assert (run.unresolved_at is None) is resolved
    assert any("unresolved" in warning for warning in run.warnings) is not resolved
    if run.unresolved_at is not None:
        assert np.all(estimate[run.t < run.unresolved_at] < JUDGE_CLAIM)


@in_both_codes
@pytest.mark.parametrize("method", ["euler", "rk4", "dop853"])
def test_fixed_steps_report_a_singular_position_or_a_diverged_motion(method):
    run = Lagrange(method).build(OverdrivenFourBar().mechanism(), 1e-2)(40, 5)
    assert any("does not converge" in warning or "is lost" in warning for warning in run.warnings)
    assert Lagrange(method).build(pendulum(), 1e-2)(40, 5).warnings == ()


@in_both_codes
@pytest.mark.parametrize(("gyration", "is_closed"), [(1.0, True), (1e-6, False)])
@pytest.mark.parametrize("method", ["euler none", "rk4 baumgarte", "dop853 projection"])
def test_a_row_that_is_lost_by_rounding_is_reported(method, gyration, is_closed):
    # The body is 2.5 km from its pin. The ratio of the eigenvalues of the pin's rows is (gyration / arm)^2.
    c, s = np.cos(0.7), np.sin(0.7)
    light = Body("light", 1.0, gyration**2, (0.0, 0.0, 0.7), (82 * c, 82 * s, 0.03))
    rate = (82 * 2 + 2500 * 0.03) / -500
    other = Body("other", 1.0, 2.5e7, (3000 * s, -3000 * c, 0.7), (-82 * c, -82 * s, rate))
    pair = Mechanism((light, other), (Pin("pin", "light", "other", (0.0, -2500.0), (0.0, 500.0)),))
    run = Lagrange(*method.split()).build(pair, 0.02)(5, 1)
    if "projection" in method:
        assert bool(np.abs(slip(pair, run)).max() < 1e-6) is is_closed
    assert (run.warnings == ()) is is_closed


@in_both_codes
@pytest.mark.parametrize(("integrator", "order"), [("euler", 1), ("rk4", 4)])
@pytest.mark.parametrize("stabilisation", ["none", "projection"])
def test_the_error_falls_with_the_integrators_order(integrator, order, stabilisation):
    mechanism = four_bar(crank_rate=3.0)
    truth = TRUTH.build(mechanism, 0.02)(6, 1)
    errors = []
    for every in (4, 8, 16):
        run = Lagrange(integrator, stabilisation).build(mechanism, 0.02 / every)(6, every)
        errors.append(np.max(np.abs(run.pose - truth.pose)))
    observed = np.log2(np.array(errors[:-1]) / errors[1:])
    # The tolerance is half an order, since the next power of the step contributes to these errors.
    np.testing.assert_allclose(observed, order, atol=0.5)


def test_projection_closes_large_gaps_and_changes_velocities_least():
    mechanism, random = four_bar(), np.random.default_rng(3)
    open_pose = mechanism.pose + 0.05 * random.normal(size=mechanism.pose.shape)
    wild = random.normal(size=mechanism.twist.shape)
    pose, twist = Dynamics(mechanism).project(open_pose, wild, 0.0)
    assert np.max(np.abs(mechanism.gap(pose, 0.0))) < 1e-14
    assert np.max(np.abs(mechanism.slip(pose, twist))) < 1e-13
    # The removed velocity is orthogonal to the remaining velocity in the norm of the masses.
    assert np.sum(mechanism.inertias * (wild - twist) * twist) == pytest.approx(0, abs=1e-13)


def test_constrained_acceleration_satisfies_newtons_law_and_the_rows():
    mechanism, random = four_bar(), np.random.default_rng(4)
    pose = mechanism.pose + 0.02 * random.normal(size=mechanism.pose.shape)
    twist, rows = random.normal(size=mechanism.twist.shape), mechanism.rows(pose)
    soft = np.arange(mechanism.row_count) % 3 == 0
    inertia = inverse_inertia((rows / mechanism.inertias.reshape(-1)) @ rows.T, soft)
    # A unit force acts in the soft row 0. The acceleration is computed with the constraints of the rigid rows.
    rigid = np.delete(rows, np.flatnonzero(soft), axis=0) / np.sqrt(mechanism.inertias.reshape(-1))
    push = rows[0] / np.sqrt(mechanism.inertias.reshape(-1))
    push = push - rigid.T @ np.linalg.lstsq(rigid.T, push, rcond=None)[0]
    assert inertia[0] == pytest.approx(max(push @ push, 0.1 * np.sum(rows[0] ** 2 / mechanism.inertias.reshape(-1))))
    damper = mechanism.bias(pose, twist) - 3.0 * mechanism.slip(pose, twist) * soft
    for target, compliance in ((None, 0.0), (damper, np.diag(0.2 * inertia * soft))):
        acceleration, reaction = constrained_acceleration(mechanism, pose, twist, target, compliance)
        force = mechanism.inertias * (acceleration - mechanism.unconstrained(pose, twist))
        assert force.reshape(-1) == pytest.approx(rows.T @ reaction, abs=1e-12)
        left_side = rows @ acceleration.reshape(-1) + (compliance + np.zeros_like(rows @ rows.T)) @ reaction
        assert left_side == pytest.approx(mechanism.bias(pose, twist) if target is None else target, abs=1e-11)
    dynamics = Dynamics(mechanism, Regularisation(0.0, 3.0, 0.2, tuple(soft)), soft)
    assert dynamics.acceleration(pose, twist, 0.0) == pytest.approx(acceleration, abs=1e-11)


def test_baumgarte_closes_an_open_joint_critically_damped():
    # The bar is displaced from its pin along its axis. The gap satisfies gap'' = -2 gap'/T - gap/T^2.
    mechanism, constant = replace(pendulum(angle=0.0), gravity=(0.0, 0.0)), 0.1
    regularisation = Lagrange("rk4", "baumgarte").regularisation(mechanism, constant / 5)  # time constant of five steps
    step = runge_kutta(Dynamics(mechanism, regularisation), RK4)
    pose, twist, dt = mechanism.pose + np.array([0.02, 0.0, 0.0]), mechanism.twist, constant / 50
    for i in range(150):
        pose, twist = step(pose, twist, i * dt, dt)
    times = 150 * dt / constant
    # The step is a fiftieth of the time constant. After 150 steps the relative error of RK4 is 1e-7.
    assert mechanism.gap(pose, 0.0)[0] == pytest.approx(0.02 * (1 + times) * np.exp(-times), rel=1e-5)


@in_both_codes
def test_baumgartes_spring_uses_the_drives_angle_at_each_stage():
    mechanism = four_bar(crank_rate=10.0, drive=10.0)
    run = Lagrange("rk4", "baumgarte").build(mechanism, 1e-3)(20, 5)
    # The drive has a constant rate. The gap is only rounding if each stage uses the angle at the time of the stage.
    assert np.max(np.abs(joint_gap(mechanism, run)[:, -1])) < 1e-13


@in_both_codes
def test_the_semi_implicit_euler_method_moves_a_pose_with_the_new_velocity():
    mechanism = Mechanism((Body("stone", 2.0, 1.0, (0, 0, 0), (1.0, 0.0, 3.0)),), (), (0.0, -9.81))
    run = Lagrange("euler", "none").build(mechanism, 0.1)(10, 1)
    # The pose moves by the new velocities, so the displacement is 55 g dt^2, and 55 is the sum of 1 to 10.
    np.testing.assert_allclose(run.pose[-1, 0], [1.0, -9.81 * 0.01 * 55, 3.0], rtol=1e-14)


@pytest.mark.parametrize("settings", [("rk4", "glue"), ("rk4", "none", 1e-6), ("dop853", "baumgarte", 1e-9)])
def test_invalid_settings_are_refused(settings):
    with pytest.raises(ValueError, match=r"must|tolerance"):
        Lagrange(*settings)


@pytest.mark.parametrize("give", [None, 0.3])
def test_a_constrained_motion_satisfies_its_rows_and_newtons_law(give):
    mechanism = FreeFourBar().mechanism()
    state = mechanism.pose, mechanism.twist
    rows, right, free = mechanism.rows(mechanism.pose), mechanism.bias(*state), mechanism.unconstrained(*state)
    soft = None if give is None else give * np.eye(len(rows))[:, :3]
    solution = constrained(rows, right, mechanism.inertias, free, soft)
    compliance = 0.0 if soft is None else soft @ soft.T @ solution.force
    assert rows @ solution.motion.reshape(-1) == pytest.approx(right - compliance, abs=1e-11)
    newton = mechanism.inertias * (solution.motion - free)
    assert newton.reshape(-1) == pytest.approx(rows.T @ solution.force, abs=1e-11)
