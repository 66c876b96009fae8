"""Chains of links: joint forces against Lagrange's equations, modes against formulas, their horizon and their digits.

Accelerations in fifty digits are asked by `laws`, motions and forces of the scenes by `test_scenes`.
"""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
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
from tests.reference.laws.pendulums import links as law_of


def random_chain(links: int) -> tuple[Chain, np.ndarray, np.ndarray]:
    generator = np.random.default_rng(links)
    chain = Chain(tuple(generator.uniform(0.5, 2, links)), tuple(generator.uniform(0.5, 2, links)))
    return chain, generator.uniform(-3, 3, (4, links)), generator.normal(size=(4, links))


@pytest.mark.parametrize("links", [1, 5, 40])
def test_joint_forces_and_lagrange_give_the_same_accelerations(links: int) -> None:
    chain, angle, rate = random_chain(links)
    found = chain.accelerations(angle, rate)
    expected = np.array([lagrangian_accelerations(chain, a, r) for a, r in zip(angle, rate, strict=True)])
    # Both systems' condition numbers grow like links^2.
    assert np.abs(found - expected).max() < 1e-15 * (10 + links**2) * np.abs(expected).max()
    alone = np.array([chain.forces(a, r) for a, r in zip(angle, rate, strict=True)])
    assert np.abs(chain.forces(angle, rate) - alone).max() < 1e-12 * np.abs(alone).max()


def lagrangian_accelerations(chain: Chain, angle, rate):
    """angle'' (links,) [rad/s^2] by Lagrange's equations, dense: no joint force in it; the second opinion."""
    difference = angle[:, None] - angle
    right = -(chain.inertia_matrix * np.sin(difference)) @ rate**2 - chain.stiffness * np.sin(angle)
    return np.linalg.solve(chain.inertia_matrix * np.cos(difference), right)


def test_the_stated_error_is_above_the_true_one_of_a_motion_known_in_closed_form() -> None:
    chain, exact = LinkPendulum(links=1, angle=2.0, duration=3.0), BarPendulum()
    t = np.linspace(0, 3, 26)
    true = np.abs(chain.motion(t).pose - exact.motion(t).pose)[..., 0, 2].max()
    stated = chain.truth_error(t).max()
    assert stated > true > 0
    # Ten times two errors of one size: a bound that says something.
    assert stated < 1e3 * true
    # Some dozen windows, each with a rounding of its accelerations.
    assert true < 1e-14


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


def test_bad_chains_are_refused_and_a_singular_motion_is_reported() -> None:
    with pytest.raises(InvalidMechanism, match="0 links"):
        Chain((), ())
    with pytest.raises(InvalidMechanism, match="1 lengths and 2 masses"):
        Chain((1.0,), (1.0, 1.0))
    with pytest.raises(IntegrationFailed, match="the motion stops at t = "), np.errstate(all="ignore"):
        integrate(lambda state: state**2, [1.0], 2.0)  # 1 / (1 - t)


@pytest.mark.parametrize("ratio", [1.0, 1e2, 1e4, 1e6, 1e9])
def test_a_heavy_tip_costs_no_digits(ratio: float) -> None:
    generator = np.random.default_rng(3)
    # Extended precision has 11 bits more than a double, and a ratio of masses costs as many digits as it has.
    allowed = 1e-14 + 1e-3 * 2.2e-16 * ratio
    for links in (2, 5):
        chain = Chain((1.0,) * links, (1.0,) * (links - 1) + (ratio,))
        for _ in range(4):
            angle, rate = generator.uniform(-2, 2, (2, links))
            numbers = map(mp.mpf, (*chain.lengths, *chain.masses, *angle.tolist(), *rate.tolist(), chain.gravity))
            with mp.workdps(60):
                exact = np.array([float(value) for value in law_of(links).exact(*numbers)])
            assert np.abs(chain.accelerations(angle, rate) - exact).max() < allowed * (1 + np.abs(exact).max())


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
