"""Chains of links: joint forces against Lagrange and against the Mechanism, modes against formulas, errors measured."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.special import jn_zeros

from reference.chapter.errata.linkages import accelerations, velocities
from reference.checks import InvalidMechanism
from reference.numerics.integration import IntegrationFailed, integrate
from reference.scenes.pendulum.chain import Chain
from reference.scenes.pendulum.link import BarPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reference.trajectory import energy, joint_gap, slip


def random_chain(links: int) -> tuple[Chain, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(links)
    chain = Chain(tuple(generator.uniform(0.5, 2, links)), tuple(generator.uniform(0.5, 2, links)))
    return chain, generator.uniform(-3, 3, (4, links)), generator.normal(size=(4, links))


@pytest.mark.parametrize("links", [1, 2, 5, 40])
def test_joint_forces_and_lagrange_give_the_same_accelerations(links: int) -> None:
    chain, angle, rate = random_chain(links)
    found = chain.accelerations(angle, rate)
    expected = np.array([lagrangian_accelerations(chain, a, r) for a, r in zip(angle, rate, strict=True)])
    # Both systems' condition numbers grow like links^2.
    assert np.abs(found - expected).max() < 1e-15 * (10 + links**2) * np.abs(expected).max()


def lagrangian_accelerations(chain: Chain, angle, rate):
    """angle'' (links,) [rad/s^2] by Lagrange's equations, dense: no joint force in it; the second opinion."""
    difference = angle[:, None] - angle
    right = -(chain.inertia_matrix * np.sin(difference)) @ rate**2 - chain.stiffness * np.sin(angle)
    return np.linalg.solve(chain.inertia_matrix * np.cos(difference), right)


def test_a_length_wrong_by_a_thousandth_is_caught() -> None:
    chain, angle, rate = random_chain(5)
    wrong = Chain((chain.lengths[0] * 1.001, *chain.lengths[1:]), chain.masses)
    assert np.abs(wrong.accelerations(angle, rate) - chain.accelerations(angle, rate)).max() > 1e-4


def test_a_batch_is_the_same_as_one_state_at_a_time() -> None:
    chain, angle, rate = random_chain(7)
    alone = np.array([chain.forces(a, r) for a, r in zip(angle, rate, strict=True)])
    assert np.abs(chain.forces(angle, rate) - alone).max() < 1e-12 * np.abs(alone).max()


SCENES = [LinkPendulum(), LinkPendulum(links=3, tip=50.0, rate=1.0, duration=1.0), TenLinks(), HundredLinks()]


@pytest.mark.parametrize("scene", SCENES)
def test_the_truth_satisfies_joints_energy_and_the_mechanism_own_equations(scene: LinkPendulum) -> None:
    mechanism = scene.mechanism()
    assert mechanism.degrees_of_freedom() == (scene.links, scene.links)
    t = np.linspace(0, scene.duration, 9)
    motion = scene.motion(t)
    size = scene.links * scene.length
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-15 * (10 + size)
    assert np.abs(slip(mechanism, motion)).max() < 1e-14 * (10 + size)
    potential = float(scene.chain.stiffness.sum())
    assert np.ptp(energy(mechanism, motion)) < 1e-12 * potential
    # The force of every joint, and with it every acceleration, from the mechanism's rows alone.
    angle, rate = scene.states(t)
    _, _, acceleration = scene.chain.placement(angle, rate, scene.chain.accelerations(angle, rate))
    expected = mechanism.reaction(motion.pose, acceleration)
    assert np.abs(motion.reaction - expected).max() < 1e-13 * scene.links**2 * np.abs(expected).max()
    bias = mechanism.bias(motion.pose, motion.twist)
    left = (mechanism.rows(motion.pose) @ acceleration.reshape(len(t), -1, 1))[..., 0]
    assert np.abs(left - bias).max() < 1e-12 * (1 + scene.links) * np.abs(bias).max()


def test_a_force_of_the_wrong_sign_is_caught() -> None:
    scene = LinkPendulum()
    angle, rate = scene.states([0.4])
    _, _, acceleration = scene.chain.placement(angle, rate, scene.chain.accelerations(angle, rate))
    motion = scene.motion([0.4])
    assert np.abs(-motion.reaction - scene.mechanism().reaction(motion.pose, acceleration)).max() > 1


@pytest.mark.parametrize("scene", [LinkPendulum(), TenLinks(), HundredLinks()])
def test_the_truth_own_error_is_shown_by_two_tolerances(scene: LinkPendulum) -> None:
    # Up to 3e-13 a step over some hundred steps, until the horizon grown less than tenfold.
    assert scene.truth_error(np.linspace(0, min(scene.horizon, scene.duration), 7)).max() < 1e-10


def test_the_stated_error_is_above_the_true_one_of_a_motion_known_in_closed_form() -> None:
    chain, exact = LinkPendulum(links=1, angle=2.0, duration=3.0), BarPendulum()
    t = np.linspace(0, 3, 26)
    true = np.abs(chain.motion(t).pose - exact.motion(t).pose)[..., 0, 2].max()
    stated = chain.truth_error(t).max()
    assert stated > true > 0
    # Ten times two errors of one size: a bound that says something.
    assert stated < 1e3 * true


def test_one_link_is_the_exact_pendulum() -> None:
    chain, exact = LinkPendulum(links=1, angle=2.0, duration=3.0), BarPendulum()
    t = np.linspace(0, 3, 31)
    # Some dozen windows, each with a rounding of its accelerations.
    assert np.abs(chain.motion(t).pose - exact.motion(t).pose).max() < 1e-14
    assert np.abs(chain.motion(t).reaction - exact.motion(t).reaction).max() < 1e-12


@pytest.mark.parametrize("scene", [LinkPendulum(), TenLinks(), HundredLinks()])
def test_the_stated_horizon_is_within_the_measured_one(scene: LinkPendulum) -> None:
    measured, _ = scene.chain.horizon(
        np.full(scene.links, scene.angle), np.full(scene.links, scene.rate), scene.duration
    )
    assert scene.horizon <= measured


def test_a_double_pendulum_is_chaotic_and_a_small_swing_is_not() -> None:
    chain = LinkPendulum().chain
    time, rate = chain.horizon([math.pi / 2] * 2, [0.0] * 2, 7.0)
    assert 3 < time < 5
    assert 0.5 < rate < 3  # 1/s: of the order of sqrt(g / total length) = 2.2
    assert math.isnan(chain.horizon([0.01] * 2, [0.0] * 2, 10.0)[1])


def test_modes_of_one_two_and_many_links_are_the_known_ones() -> None:
    gravity, length = 9.81, 0.7
    one, _ = Chain((length,), (3.0,), gravity).modes()
    assert one[0] == pytest.approx(math.sqrt(1.5 * gravity / length), rel=1e-14)
    two, _ = Chain((length,) * 2, (3.0,) * 2, gravity).modes()
    # det(K - w^2 M) = 0 with M = m l^2 (4/3, 1/2; 1/2, 1/3), K = m g l (3/2, 1/2).
    exact = np.sqrt((3 + np.array([-6, 6]) / math.sqrt(7)) * gravity / length)
    assert np.abs(two / exact - 1).max() < 1e-14
    links = 300
    many, _ = Chain((1 / links,) * links, (1 / links,) * links, gravity).modes()
    rope = jn_zeros(0, 3) / 2 * math.sqrt(gravity)  # Daniel Bernoulli's hanging chain of unit length
    assert np.abs(many[:3] / rope - 1).max() < 20 / links**2


def test_modes_are_the_motion_of_the_joint_force_equations() -> None:
    chain, _, _ = random_chain(6)
    frequencies, shapes = chain.modes()
    small = 1e-5
    found = chain.accelerations(small * shapes.T, np.zeros((6, 6)))
    # sin x = x - x^3/6, relative 1e-9 for these shapes; the rest is rounding of the weights.
    assert np.abs(found / small + (frequencies**2 * shapes).T).max() < 1e-6 * np.abs(frequencies**2 * shapes).max()


def test_problems_18_5_1_and_18_5_2_are_derivatives_of_position() -> None:
    length = 0.7
    phi, rates, turning = (0.4, -1.1), (2.0, 3.0), (-5.0, 0.6)

    def position(t: complex) -> np.ndarray:
        angles = [p + w * t + a * t * t / 2 for p, w, a in zip(phi, rates, turning, strict=True)]
        return np.array([[length * np.sin(angle), -length * np.cos(angle)] for angle in angles])

    step = 1e-30
    found = velocities(length, phi, rates)
    expected = np.imag(position(1j * step)) / step
    assert np.abs(found.a - expected[0]).max() < 1e-14
    assert np.abs(found.b_relative_to_a - expected[1]).max() < 1e-14
    assert np.abs(found.b - expected.sum(axis=0)).max() < 1e-14
    # Cauchy's integral over a circle in complex time gives the second derivative to all digits.
    circle = 0.3 * np.exp(2j * np.pi * np.arange(48) / 48)
    second = 2 * np.mean([position(z) / z**2 for z in circle], axis=0).real
    change = accelerations(length, phi, rates, turning)
    assert np.abs(change.a - second[0]).max() < 1e-12
    assert np.abs(change.b_relative_to_a - second[1]).max() < 1e-12
    assert np.abs(change.b - second.sum(axis=0)).max() < 1e-12


def test_a_thousand_links_are_practical_and_conserve_energy() -> None:
    scene = LinkPendulum(links=1000, length=1e-3, mass=1e-3, duration=0.02)
    angle, rate = scene.states([0.0, 0.01, 0.02])
    total = scene.chain.energy(angle, rate)
    assert np.ptp(total) < 1e-12 * scene.chain.stiffness.sum()


def test_bad_chains_are_refused() -> None:
    wrong: dict[str, Any]
    for wrong in ({"links": 0}, {"links": 2.5}, {"length": 0.0}, {"mass": math.nan}, {"tip": 0.0}, {"angle": math.inf}):
        with pytest.raises(InvalidMechanism, match=next(iter(wrong))):
            LinkPendulum(**wrong)
    with pytest.raises(InvalidMechanism, match="0 links"):
        Chain((), ())
    with pytest.raises(InvalidMechanism, match=r"lengths is \(1.0, 0.0\)"):
        Chain((1.0, 0.0), (1.0, 1.0))
    with pytest.raises(InvalidMechanism, match="1 lengths and 2 masses"):
        Chain((1.0,), (1.0, 1.0))


def test_times_before_the_start_are_refused_and_a_singular_motion_is_reported() -> None:
    with pytest.raises(ValueError, match="none below zero"):
        LinkPendulum(links=1).motion([-1.0])
    with pytest.raises(IntegrationFailed, match="the motion stops at t = "), np.errstate(all="ignore"):
        integrate(lambda state: state**2, [1.0], 2.0)  # 1 / (1 - t)


def lagrange_in_sixty_digits(chain: Chain, angle: np.ndarray, rate: np.ndarray) -> np.ndarray:
    """angle'' by Lagrange's equations without rounding."""
    with mpmath.workdps(60):
        length, mass = ([mpmath.mpf(value) for value in values] for values in (chain.lengths, chain.masses))
        below = [mpmath.fsum(mass[i + 1 :]) for i in range(chain.links)]
        places = range(chain.links)

        def weight(i: int, j: int) -> mpmath.mpf:
            if i == j:
                return length[i] ** 2 * (mass[i] / 3 + below[i])
            low, high = sorted((i, j))
            return length[low] * length[high] * (mass[high] / 2 + below[high])

        turn, speed = ([mpmath.mpf(float(value)) for value in values] for values in (angle, rate))
        matrix = mpmath.matrix([[weight(i, j) * mpmath.cos(turn[i] - turn[j]) for j in places] for i in places])
        right = mpmath.matrix(
            [
                -mpmath.fsum(weight(i, j) * mpmath.sin(turn[i] - turn[j]) * speed[j] ** 2 for j in places)
                - mpmath.mpf(chain.gravity) * length[i] * (mass[i] / 2 + below[i]) * mpmath.sin(turn[i])
                for i in places
            ]
        )
        return np.array([float(value) for value in mpmath.lu_solve(matrix, right)])


@pytest.mark.parametrize("ratio", [1.0, 1e2, 1e4, 1e6, 1e9])
def test_a_heavy_tip_costs_no_digits(ratio: float) -> None:
    generator = np.random.default_rng(3)
    # Extended precision has 11 bits more than a double, and a ratio of masses costs as many digits as it has.
    allowed = 1e-14 + 1e-3 * 2.2e-16 * ratio
    for links in (2, 5):
        chain = Chain((1.0,) * links, (1.0,) * (links - 1) + (ratio,))
        for _ in range(4):
            angle, rate = generator.uniform(-2, 2, (2, links))
            exact = lagrange_in_sixty_digits(chain, angle, rate)
            assert np.abs(chain.accelerations(angle, rate) - exact).max() < allowed * (1 + np.abs(exact).max())


def test_a_pendulum_with_a_very_heavy_tip_moves_as_a_light_link_on_it_must() -> None:
    # The heavier the tip, the nearer to a limit: the motions with ratios 1e5 and 1e6 differ by about 1e-5.
    almost, more = (LinkPendulum(tip=ratio, duration=0.5).motion([0.5]).pose[0, :, 2] for ratio in (1e5, 1e6))
    assert np.abs(almost - more).max() < 2e-5
    assert np.abs(almost - more).max() > 1e-7


def test_a_chain_moves_from_unequal_angles_as_by_lagranges_equations() -> None:
    chain, t = Chain((0.5, 1.0, 0.8), (1.0, 0.3, 2.0)), [0.0, 0.3, 0.9]
    start = ([0.4, -1.1, 2.0], [1.0, 0.0, -3.0])
    angles, rates, accelerations = chain.motion(*start, t)

    def slope(_: float, state: Any) -> Any:  # no joint force in it
        return np.concatenate([state[3:], lagrangian_accelerations(chain, state[:3], state[3:])])

    other = solve_ivp(slope, (0, 0.9), np.concatenate(start), "DOP853", t, rtol=1e-13, atol=1e-13).y.T
    assert np.abs(np.concatenate([angles, rates], axis=1) - other).max() < 1e-10
    for angle, rate, acceleration in zip(angles, rates, accelerations, strict=True):
        assert acceleration == pytest.approx(lagrangian_accelerations(chain, angle, rate), rel=1e-10)
    energy = chain.energy(angles, rates)
    assert np.abs(energy - energy[0]).max() < 1e-11 * np.abs(energy).max()
    assert chain.truth_error(*start, t).max() < 1e-10
    equal = chain.motion([0.4] * 3, [0.0] * 3, t)[0]
    assert np.abs(equal - angles).max() > 0.1
    with pytest.raises(InvalidMechanism, match="a number a link"):
        chain.motion([0.4, 0.1], [0.0, 0.0], t)


def test_a_chain_takes_lists_and_tuples_as_it_takes_arrays() -> None:
    chain, angle, rate = Chain((1.0, 2.0), (1.0, 3.0)), [0.3, 1], (0, -2.0)
    arrays = np.array(angle), np.array(rate)
    for method in (chain.forces, chain.accelerations, chain.energy):
        assert np.array_equal(method(angle, rate), method(*arrays))
    for ours, theirs in zip(chain.placement(angle, rate, rate), chain.placement(*arrays, arrays[1]), strict=True):
        assert np.array_equal(ours, theirs)
    assert np.array_equal(chain.divergence(angle, rate, [0.1]), chain.divergence(*arrays, [0.1]))
