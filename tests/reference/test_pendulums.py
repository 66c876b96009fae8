"""Tests of pendulums, chains, N four-bars and a falling person."""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from scipy.special import jn_zeros

from reference.scenes.n_four_bar import NFourBar, TenFourBars
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.link import BarPendulum, Pendulum, PointPendulum, incomplete, jacobi, quarter_period
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reference.scenes.person import (
    HEAD_ARMS_TRUNK,
    SHANK,
    SHANK_AND_FOOT,
    THIGH,
    UPRIGHT,
    SwayingOnOneFoot,
    modes_upright,
)


@pytest.mark.parametrize("complement", [1.0, 0.1, 1e-8, 1e-30])
def test_jacobi_functions_are_accurate_up_to_the_separatrix(complement: float) -> None:
    with mpmath.workdps(60):
        parameter = 1 - mpmath.mpf(complement)
        quarter = quarter_period(complement)
        exact = mpmath.pi / 2 / mpmath.agm(1, mpmath.sqrt(mpmath.mpf(complement)))
        assert abs(quarter / exact - 1) < 5e-16
        for argument in np.linspace(-3.3 * quarter, 3.3 * quarter, 23):
            sn, cn, dn, amplitude = (float(value) for value in jacobi(argument, complement))
            exact_sn, exact_cn, exact_dn = (
                mpmath.ellipfun(f, mpmath.mpf(argument), m=parameter) for f in ("sn", "cn", "dn")
            )  # The argument has a rounding of at most 230e-16, and the functions' slopes are at most 1.
            tolerance = 8e-16 * (1 + abs(argument))
            assert abs(sn - exact_sn) < tolerance
            assert abs(cn - exact_cn) < tolerance
            assert abs(dn / exact_dn - 1) < tolerance
            assert abs(math.sin(amplitude) - exact_sn) < tolerance


def test_the_incomplete_integral_is_accurate_next_to_the_quarter_period() -> None:
    for complement in (0.5, 1e-8, 1e-30):
        for sine, cosine in ((0.3, 0.7), (1.0, 1e-9), (1.0, -1e-9), (-1.0, -0.2), (1.0, 0.0)):
            with mpmath.workdps(60):
                exact = mpmath.ellipf(mpmath.atan2(mpmath.mpf(sine), mpmath.mpf(cosine)), 1 - mpmath.mpf(complement))
                assert abs(float(incomplete(sine, cosine, complement)) - exact) < 1e-15 * (1 + abs(exact))


def test_the_period_of_small_swings_and_the_kinds_of_pendulum_motion() -> None:
    # K(k) = pi/2 (1 + k^2/4 + ...), k = 5e-4.
    assert Pendulum(2.0, 1e-3).period == pytest.approx(math.pi * (1 + 1e-6 / 16), rel=1e-12)
    assert Pendulum(2.0, 1.0).kind == "swinging"
    assert Pendulum(2.0, 0.0, 4.1).kind == "whirling"
    assert Pendulum(2.0, 0.0, 4.0).kind == "separatrix"
    assert math.isinf(Pendulum(2.0, 0.0, 4.0).period)


def test_the_phase_of_the_benchmark_pendulum_is_accurate_after_845_periods() -> None:
    scene = PointPendulum()
    (x, y), t = scene.bob(scene.motion(scene.duration).pose)[0], scene.duration
    with mpmath.workdps(40):
        sine = mpmath.ellipfun("sn", mpmath.sqrt(9.81) * t + mpmath.ellipk(0.5), m=0.5) / mpmath.sqrt(2)
        # Each of the 845 periods of 2.4 s has a rounding of 2e-16, and the speed is at most 4.4 m/s.
        assert abs(x - 2 * sine * mpmath.sqrt(1 - sine**2)) < 3e-12
        assert abs(y + 1 - 2 * sine**2) < 3e-12


@pytest.mark.parametrize("pendulum", [Pendulum(3.0, 1.0, 0.2), Pendulum(3.0, -2.5, -1.0), Pendulum(2.0, 3.0, 5.0)])
def test_passages_agree_with_sign_changes_of_the_sampled_motion(pendulum):
    t = np.linspace(0, 12 * pendulum.period, 12_001)
    motion = pendulum.motion(t)[0]
    for angle in (0.5, -0.9, 0.0):
        side = np.sin((motion - angle) / 2)
        seen = t[1:][side[1:] * side[:-1] < 0]
        assert len(seen) > 10
        np.testing.assert_allclose(pendulum.passages(angle, float(t[-1])), seen, atol=2 * t[1])
        for last in (0, 3, len(seen) - 1):  # `until` is shortly after and shortly before a passage
            exact = float(pendulum.passages(angle, float(t[-1]))[last])
            assert len(pendulum.passages(angle, exact * (1 + 1e-12))) == last + 1
            assert len(pendulum.passages(angle, exact * (1 - 1e-12))) == last


def random_chain(links: int) -> tuple[Chain, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(links)
    chain = Chain(tuple(generator.uniform(0.5, 2, links)), tuple(generator.uniform(0.5, 2, links)))
    return chain, generator.uniform(-3, 3, (4, links)), generator.normal(size=(4, links))


@pytest.mark.parametrize("links", [1, 5, 40])
def test_accelerations_from_joint_forces_agree_with_lagranges_equations(links: int) -> None:
    chain, angle, rate = random_chain(links)
    found = chain.accelerations(angle, rate)
    expected = np.array([lagrangian_accelerations(chain, a, r) for a, r in zip(angle, rate, strict=True)])
    # Both systems have condition numbers proportional to links^2.
    assert np.abs(found - expected).max() < 1e-15 * (10 + links**2) * np.abs(expected).max()
    alone = np.array([chain.forces(a, r) for a, r in zip(angle, rate, strict=True)])
    assert np.abs(chain.forces(angle, rate) - alone).max() < 1e-12 * np.abs(alone).max()


def lagrangian_accelerations(chain: Chain, angle, rate):
    """angle'' (links,) [rad/s^2] by Lagrange's equations with a dense matrix."""
    difference = angle[:, None] - angle
    right = -(chain.inertia_matrix * np.sin(difference)) @ rate**2 - chain.stiffness * np.sin(angle)
    return np.linalg.solve(chain.inertia_matrix * np.cos(difference), right)


def test_the_error_bound_of_a_chain_of_one_link_is_above_the_error_against_the_closed_form() -> None:
    chain, exact = LinkPendulum(links=1, angle=2.0, duration=3.0), BarPendulum()
    t = np.linspace(0, 3, 26)
    true = np.abs(chain.motion(t).pose - exact.motion(t).pose)[..., 0, 2].max()
    stated = chain.truth_error(t).max()
    assert stated > true > 0
    # The bound is ten times the difference of two integrations, so it is not much larger than ten times the error.
    assert stated < 1e3 * true
    # There are about a dozen windows, each with a rounding error of the accelerations.
    assert true < 1e-14


@pytest.mark.parametrize("scene", [LinkPendulum(), TenLinks(), pytest.param(HundredLinks(), marks=pytest.mark.slow)])
def test_the_declared_horizon_is_not_above_the_measured_horizon(scene: LinkPendulum) -> None:
    measured, _ = scene.chain.horizon(
        np.full(scene.links, scene.angle), np.full(scene.links, scene.rate), scene.duration
    )
    assert scene.horizon <= measured


def test_modes_of_one_two_and_many_links_agree_with_closed_forms() -> None:
    gravity, length = 9.81, 0.7
    one, _ = Chain((length,), (3.0,), gravity).modes()
    assert one[0] == pytest.approx(math.sqrt(1.5 * gravity / length), rel=1e-14)
    two, _ = Chain((length,) * 2, (3.0,) * 2, gravity).modes()
    # det(K - w^2 M) = 0 with M = m l^2 (4/3, 1/2; 1/2, 1/3), K = m g l (3/2, 1/2).
    exact = np.sqrt((3 + np.array([-6, 6]) / math.sqrt(7)) * gravity / length)
    assert np.abs(two / exact - 1).max() < 1e-14
    links = 300
    many, _ = Chain((1 / links,) * links, (1 / links,) * links, gravity).modes()
    rope = jn_zeros(0, 3) / 2 * math.sqrt(gravity)  # a hanging chain of unit length (Daniel Bernoulli)
    assert np.abs(many[:3] / rope - 1).max() < 20 / links**2


SCENES = [NFourBar(loops=1), NFourBar(), NFourBar(loops=3, length=0.7, mass=2.0, speed=-2.5), TenFourBars()]


@pytest.mark.parametrize("scene", SCENES)
def test_n_four_bars_have_n_more_freedoms_at_singular_times(scene: NFourBar) -> None:
    mechanism = scene.mechanism()
    times = scene.singular_times(3 * scene.period)
    assert len(times) == 6  # twice a turn
    motion = scene.motion(times)
    for pose in motion.pose:
        assert abs(math.cos(pose[0, 2]) ** 2 - 1) < 1e-14
        assert mechanism.degrees_of_freedom(pose) == (scene.loops + 1, scene.loops + 1)
    between = scene.motion((times[1:] + times[:-1]) / 2)
    for pose in between.pose:
        assert mechanism.degrees_of_freedom(pose) == (1, 1)


def test_the_branch_distinguishes_parallelograms_from_folded_loops() -> None:
    scene, mechanism = NFourBar(), NFourBar().mechanism()
    assert np.all(scene.branch_of(scene.motion(np.linspace(0, 10, 501)).pose) == 1)
    assert np.all(scene.branch_of(scene.motion(scene.singular_times(10.0)).pose) == 1)
    # Each case has crank, pivot position, coupler and angle of a folded loop. In the first case crank 0 lies along the
    # ground and coupler 0 along crank 1. In the second and third case crank 2 lies along the ground and coupler 1 along
    # crank 1. At t = 1.25 s crank 1 points to the left, so a parallelogram fits better than the first folded form.
    for t, crank, at, coupler, way in ((0.3, 0, 0.5, 3, 0.0), (0.3, 2, 1.5, 4, math.pi), (1.25, 2, 1.5, 4, math.pi)):
        folded = scene.motion([t]).pose[0].copy()
        angle = folded[1, 2]
        folded[crank] = (at, 0.0, way)
        folded[coupler] = (1 + 0.5 * math.cos(angle), 0.5 * math.sin(angle), angle + way)
        assert np.abs(mechanism.gap(folded, 0.0)).max() < 1e-14
        assert scene.branch_of(folded) == -1
        assert t == 0.3 or math.cos(angle) < -1 / 2


def test_cranks_that_start_upright_at_rest_do_not_move():
    scene = NFourBar(speed=0.0, duration=1000.0)
    assert scene.period == math.inf
    assert scene.singular_times(1e6).size == 0
    motion = scene.motion([0.0, 50.0, 1000.0])
    assert np.abs(motion.pose - motion.pose[0]).max() == 0
    assert np.abs(motion.twist).max() == 0


def test_segment_masses_sum_to_one_and_radii_of_gyration_agree_with_winters_table() -> None:
    """The third column has radii of gyration about the proximal end."""
    assert HEAD_ARMS_TRUNK.mass + 2 * THIGH.mass + 2 * SHANK_AND_FOOT.mass == pytest.approx(1.0, abs=1e-12)
    for segment, about_the_end in ((HEAD_ARMS_TRUNK, 0.798), (THIGH, 0.540), (SHANK, 0.528), (SHANK_AND_FOOT, 0.735)):
        # three digits
        assert math.hypot(segment.centre, segment.gyration) == pytest.approx(about_the_end, abs=1e-3)


def test_the_swaying_person_starts_on_an_oscillating_mode() -> None:
    scene = SwayingOnOneFoot()
    squares, shapes = modes_upright(scene)
    assert np.sum(squares < 0) == 2
    parts = np.abs(np.linalg.solve(shapes, scene.start[:5] - UPRIGHT))
    # The start has six digits, so amplitudes of other modes are about 1e-6.
    assert np.all(np.delete(parts, 0) < 1e-5 * parts[0])
    # After a quarter period of the linearised motion the lifted leg is vertical, with an error of third order in 0.1
    # rad.
    quarter = math.pi / 2 / math.sqrt(-squares[0])
    aside = scene.states([quarter])[0][0] - np.array(UPRIGHT)
    assert np.abs(aside).max() < 0.05 * 0.1
