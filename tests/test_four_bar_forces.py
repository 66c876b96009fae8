"""What drives and carries a four-bar: the torque, the forces in its pins."""

import numpy as np
import pytest

from tests.test_four_bar import CHAPTER, TURNED


def test_the_drive_torque_is_the_rate_of_work_of_all_bars():
    density, gravity, rate, step = (1.0, 2.5, 0.4), (1.5, -9.81), -3.0, 1e-3

    def work(theta):  # kinetic plus potential energy
        motion = TURNED.kinematics(theta, rate, 0.0, -1)
        mass = np.array(density) * TURNED.lengths
        b = TURNED.crank * np.exp(1j * theta)
        arm, follower = TURNED.coupler / 2 * np.exp(1j * motion.beta), TURNED.rocker / 2 * np.exp(1j * motion.phi)
        centres = (b / 2, b + arm, complex(*TURNED.ground) + follower)
        speeds = (b / 2 * rate, b * rate + arm * motion.beta_dot, follower * motion.phi_dot)
        turning = (rate, motion.beta_dot, motion.phi_dot)
        total = 0
        for m, length, c, v, w in zip(mass, TURNED.lengths, centres, speeds, turning, strict=True):
            total += m * (np.abs(v) ** 2 + length**2 / 12 * w**2) / 2
            total -= m * (gravity[0] * c.real + gravity[1] * c.imag)
        return total

    weights = np.array([3, -32, 168, -672, 0, 672, -168, 32, -3]) / 840 / step
    for theta in (0.3, 2.0, 4.4):
        power = weights @ work(theta + rate * step * np.arange(-4, 5))
        torque = TURNED.drive_torque(theta, rate, 0.0, -1, density, gravity)
        assert abs(torque * rate - power) < 1e-10  # energies of 20 J, rounded, over the step
        wrong = TURNED.drive_torque(theta, rate, 0.0, -1, density, (gravity[0], -gravity[1]))
        assert abs(wrong * rate - power) > 1e-2


def test_a_linkage_at_rest_without_weight_needs_no_force():
    forces = CHAPTER.forces(np.linspace(0, 6, 20), 0.0, gravity=(0.0, 0.0))
    assert max(np.max(np.abs(force)) for force in forces) == 0


def test_the_ground_carries_the_weight_at_rest():
    at_a, _, _, at_d = CHAPTER.reactions(np.linspace(0, 6, 20), 0.0)
    weight = 9.81 * sum(CHAPTER.lengths)
    assert np.max(np.abs(at_a + at_d - (0.0, weight))) < 1e-13


@pytest.mark.parametrize("given", [{}, {"density": (1.0, 3.0, 0.5), "gravity": (2.0, -5.0), "theta_ddot": 7.0}])
def test_the_torque_and_the_pin_forces_asked_for_alone_are_those_asked_for_together(given):
    theta = np.linspace(0, 6, 20)
    together = CHAPTER.forces(theta, 10.0, **given)
    np.testing.assert_array_equal(CHAPTER.drive_torque(theta, 10.0, **given), together.torque)
    np.testing.assert_array_equal(CHAPTER.reactions(theta, 10.0, **given), together[:4])
