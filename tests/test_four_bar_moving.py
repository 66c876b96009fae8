"""The four-bar in its crank's angle: by energy what Newton's laws of its bars give, and the limits of its rocker."""

import numpy as np
import pytest

from reference.scenes.four_bar.free_motion import MovingFourBar
from reference.scenes.four_bar.linkage import FourBar, Unreachable
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from tests.present import present

CHAPTER = DrivenFourBar().four_bar
OTHERS = (
    FourBar(0.5, 1.1, 0.9, (1.0, 0.4)),
    FourBar(0.9, 1.1, 0.5, (1.0, -0.4)),
    FourBar(1.2, 1.1, 1.0, (0.4, 0.1)),
    FourBar(0.8, 0.5, 0.5, (1.2, 0.0)),
)
RNG = np.random.default_rng(8)


def reachable(linkage, count):
    limits = linkage.crank_limits() or ((-np.pi, np.pi),)
    inside = [RNG.uniform(low + 0.1 * (high - low), high - 0.1 * (high - low), count) for low, high in limits]
    return np.concatenate(inside)


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("linkage", [CHAPTER, *OTHERS])
def test_the_torque_by_energy_is_that_of_newtons_laws(linkage, branch):
    theta = reachable(linkage, 20)
    rate, acceleration = RNG.uniform(-5, 5, (2, theta.size))
    density, gravity = (1.5, 0.7, 2.0), (1.3, -9.0)
    moving = MovingFourBar(linkage, density, gravity)
    newton = linkage.drive_torque(theta, rate, acceleration, branch, density, gravity)
    size = np.abs(newton).max()
    assert np.abs(moving.torque(theta, rate, acceleration, branch) - newton).max() < 1e-12 * size
    # Without the term of the changing inertia it would be another one.
    without = newton - moving.inertia(theta, branch)[1] * rate**2 / 2
    assert np.abs(without - newton).max() > 1e-3 * size
    free = moving.acceleration(theta, rate, branch)
    size = np.abs(moving.inertia(theta, branch)[0] * free).max() + np.abs(newton).max()
    assert np.abs(linkage.drive_torque(theta, rate, free, branch, density, gravity)).max() < 1e-12 * size


@pytest.mark.parametrize("branch", [1, -1])
@pytest.mark.parametrize("linkage", [CHAPTER, *OTHERS])
def test_inertia_and_potential_have_the_slopes_of_their_values(linkage, branch):
    theta, step = reachable(linkage, 10), 1e-3
    moving = MovingFourBar(linkage, (1.5, 0.7, 2.0), (1.3, -9.0))
    shifts, weights = np.array([-3, -2, -1, 1, 2, 3]) * step, np.array([-1, 9, -45, 45, -9, 1]) / 60 / step
    for function in (moving.inertia, moving.potential):
        slope = sum(w * function(theta + s, branch)[0] for w, s in zip(weights, shifts, strict=True))
        exact = function(theta, branch)[1]
        assert np.abs(slope - exact).max() < 1e-7 * (1 + np.abs(exact).max())  # differences of order six


def test_energy_and_free_acceleration_are_those_of_the_free_scene():
    scene = FreeFourBar(rate=3.0, density=(1.5, 0.7, 2.0), gravity=(1.3, -9.0))
    t = np.linspace(0.0, 0.2, 21)
    motion, mechanism = scene.motion(t), scene.mechanism()
    theta, rate = motion.pose[:, 0, 2], motion.twist[:, 0, 2]
    angles = scene._angles(t)
    assert scene.moving.acceleration(theta, rate) == pytest.approx(angles.acceleration[:, 0], rel=1e-11)
    kinetic = 0.5 * np.sum(mechanism.inertias * motion.twist**2, axis=(1, 2))
    assert 0.5 * scene.moving.inertia(theta)[0] * rate**2 == pytest.approx(kinetic, rel=1e-12)
    potential = -np.sum(mechanism.inertias * mechanism.free_fall * motion.pose, axis=(1, 2))
    assert scene.moving.potential(theta)[0] == pytest.approx(potential, rel=1e-12)
    assert scene.moving.masses == scene.masses


def test_a_crank_angle_out_of_reach_has_no_inertia():
    with pytest.raises(Unreachable):
        MovingFourBar(OTHERS[3]).inertia(0.0 + np.pi)


@pytest.mark.parametrize("linkage", [CHAPTER, *OTHERS, FourBar(0.4, 1.0, 0.9, (0.0, 1.2))])
def test_the_rocker_reaches_its_limits_and_nothing_beyond(linkage):
    limits = linkage.rocker_limits()
    ends = linkage.crank_limits() or ((0.0, 2 * np.pi),)
    theta = np.concatenate([np.linspace(low, high, 20_001) for low, high in ends])
    phi = np.concatenate([linkage.angles(theta, branch)[1] for branch in (1, -1)])
    if limits is None:
        assert np.ptp(np.sort(np.remainder(phi, 2 * np.pi))) > 2 * np.pi - 1e-2
        return
    found = []
    for low, high in limits:
        turned = low + np.remainder(phi - low + 1e-9, 2 * np.pi) - 1e-9
        inside = turned[turned <= high + 1e-9]
        found.append(inside.size)
        # The table comes within the square of its spacing, and within its spacing where the crank has a limit too.
        assert inside.min() == pytest.approx(low, abs=1e-3)
        assert inside.max() == pytest.approx(high, abs=1e-3)
    assert sum(found) == phi.size


def test_at_the_rockers_limits_crank_and_coupler_are_in_line():
    linkage = FourBar(0.4, 1.0, 0.9, (1.1, 0.3))
    for low, high in present(linkage.rocker_limits()):
        for phi in (low, high):
            joint = np.array(linkage.ground) + linkage.rocker * np.array([np.cos(phi), np.sin(phi)])
            distance = np.hypot(*joint)
            assert min(abs(distance - 1.4), abs(distance - 0.6)) < 1e-14
