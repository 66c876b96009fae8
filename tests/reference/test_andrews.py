"""Andrews' squeezing mechanism against what nobody here wrote: the test set's end, accelerations, multipliers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import TRUTH
from reference.checks import InvalidMechanism
from reference.scenes.andrews import Andrews, Dyad, Moving
from reference.trajectory import energy, joint_gap, slip

SCENE = Andrews()
# The test set's coordinates are beta, Theta, gamma, Phi, delta, Omega, epsilon: angles of one body against another.
START = (
    *(-0.0617138900142764496358948458001, 0.0, 0.455279819163070380255912382449, 0.222668390165885884674473185609),
    *(0.487364979543842550225598953530, -0.222668390165885884674473185609, 1.23054744454982119249735015568),
)
END = (  # at 0.03 s
    *(0.1581077119629904e2, -0.1575637105984298e2, 0.4082224013073101e-1, -0.5347301163226948),
    *(0.5244099658805304, 0.5347301163226948, 0.1048080741042263e1),
)
ACCELERATIONS = (14222.4439199541138705911625887, -10666.8329399655854029433719415, 0.0, 0.0, 0.0, 0.0, 0.0)
MULTIPLIERS = (98.5668703962410896057654982170, -6.12268834425566265503114393122, 0.0, 0.0, 0.0, 0.0)


def test_set_coordinates(angles: np.ndarray) -> np.ndarray:
    """Of the bodies' angles (..., 7)."""
    k1, k2, k3, k4, k5, k6, k7 = np.moveaxis(angles, -1, 0)
    return np.stack([k1, k2 - k1, k3, k4 - k5, k5, k6 - k7, k7], axis=-1)


test_set_coordinates.__test__ = False  # type: ignore[attr-defined]


def test_it_starts_as_the_test_set_does():
    np.testing.assert_allclose(test_set_coordinates(SCENE.mechanism().pose[:, 2]), START, atol=2e-15)
    assert SCENE.mechanism().degrees_of_freedom() == (1, 1)
    assert not SCENE.mechanism().twist.any()


def test_it_ends_as_the_test_set_does():
    # Their digits are good to about 1.4e-9: by two formulations of ours, which agree to 1e-12, the same difference.
    ends = SCENE.motion(0.03).pose[0, :, 2]
    by_multipliers = TRUTH.build(SCENE.mechanism(), 0.03)(1, 1).pose[1, :, 2]
    np.testing.assert_allclose(test_set_coordinates(ends), END, atol=1e-8)
    np.testing.assert_allclose(test_set_coordinates(by_multipliers), END, atol=1e-8)
    np.testing.assert_allclose(ends, by_multipliers, atol=1e-12)


def test_its_first_accelerations_are_those_of_the_test_set():
    _, _, acceleration = SCENE.placement(np.zeros(1))
    np.testing.assert_allclose(test_set_coordinates(acceleration[0, :, 2]), ACCELERATIONS, rtol=1e-14, atol=1e-11)
    mechanism = SCENE.mechanism()
    state = mechanism.pose, mechanism.twist
    pushed = mechanism.rows(state[0]).T @ SCENE.motion(0.0).reaction[0]
    newton = mechanism.unconstrained(*state) + pushed.reshape(7, 3) / mechanism.inertias
    np.testing.assert_allclose(test_set_coordinates(newton[:, 2]), ACCELERATIONS, rtol=1e-11, atol=1e-7)


@pytest.mark.parametrize("told", ["truth", "lagrange"])
def test_its_first_multipliers_are_those_of_the_test_set(told):
    # Its rows are the rod's end less that of body 3, 4 and 6, and M q'' = f - G^T lambda. Ours are the second point
    # less the first, M a = f + J^T reaction, and the rod, K2, is the second: a multiplier is minus the reaction.
    mechanism = SCENE.mechanism()
    motion = SCENE.motion(0.0) if told == "truth" else TRUTH.build(mechanism, 1e-4)(1, 1)
    names = [f"{pin} {direction}" for pin in ("P3", "P4", "P6") for direction in "xy"]
    found = [-motion.reaction[0, mechanism.row_names.index(name)] for name in names]
    np.testing.assert_allclose(found, MULTIPLIERS, rtol=1e-11, atol=1e-9)


def test_the_truth_satisfies_the_joints_and_keeps_the_energy():
    motion, mechanism = SCENE.motion(np.linspace(0, 0.05, 60)), SCENE.mechanism()
    assert np.abs(joint_gap(mechanism, motion)).max() < 1e-15
    assert np.abs(slip(mechanism, motion)).max() < 1e-14 * np.abs(motion.twist[..., 2]).max()
    span = np.sum(mechanism.inertias * motion.twist**2, axis=(1, 2)).max() / 2
    assert np.ptp(energy(mechanism, motion)) < 1e-13 * span
    assert set(SCENE.branch_of(motion.pose)) == {1}


def test_exact_multipliers_follow_the_one_coordinate():
    motion = TRUTH.build(SCENE.mechanism(), 1e-3)(50, 1)
    exact = SCENE.motion(motion.t)
    np.testing.assert_allclose(motion.pose, exact.pose, atol=1e-11)
    np.testing.assert_allclose(motion.reaction, exact.reaction, atol=1e-11 * np.abs(exact.reaction).max())


@pytest.mark.parametrize("change", [{"torque": 0.0331}, {"stiffness": 4535.0}, {"crank": (0.007005, 0.00092)}])
def test_another_number_gives_another_end(change):
    ends = replace(SCENE, duration=0.03, **change).motion(0.03).pose[0, :, 2]
    assert np.abs(test_set_coordinates(ends) - END).max() > 1e-4


def test_a_dyad_closes_and_its_derivatives_are_those_of_differences():
    dyad = Dyad(0.035, 0.028, -1)

    def reach(phi):
        return 0.007 * np.exp(1j * phi) + complex(0.0363, -0.0327)

    phi, step = np.linspace(0, 6, 30), 1e-5
    moving = Moving(reach(phi), 0.007j * np.exp(1j * phi), -0.007 * np.exp(1j * phi))
    mu, nu = dyad.angles(moving)
    closed = 0.035 * np.exp(1j * mu.value) + 0.028 * np.exp(1j * nu.value)
    np.testing.assert_allclose(closed, moving.value, atol=1e-16)
    for which in range(2):
        near = [
            dyad.angles(Moving(reach(phi + s), 0.007j * np.exp(1j * (phi + s)), moving.second))[which]
            for s in (step, -step)
        ]
        found = (mu, nu)[which]
        np.testing.assert_allclose(found.first, (near[0].value - near[1].value) / (2 * step), rtol=1e-6, atol=1e-9)
        np.testing.assert_allclose(found.second, (near[0].first - near[1].first) / (2 * step), rtol=1e-6, atol=1e-7)


def test_bars_that_do_not_reach_are_refused():
    with pytest.raises(InvalidMechanism, match="the bars don't reach from the pivots"):
        replace(SCENE, rod=(0.1, 0.0115))


def test_a_folded_pair_is_told_as_another_branch():
    pose = SCENE.mechanism().pose.copy()
    pose[4, 2], pose[3, 2] = pose[3, 2] - np.pi / 2, pose[4, 2] + np.pi / 2
    assert SCENE.branch_of(pose) == -1
