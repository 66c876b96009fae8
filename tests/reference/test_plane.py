"""Vectors of the plane against the derivatives of positions, by Cauchy's formula, and against complex numbers."""

import numpy as np
import pytest

from reference.numerics.calculus import derivative
from reference.plane import components, from_complex, perpendicular, rotated, rotation_acceleration, rotation_velocity

RNG = np.random.default_rng(3)
ANGLE, RATE, ALPHA = RNG.uniform(-3, 3, (3, 7))
VECTOR = RNG.uniform(-2, 2, (7, 2))


def test_a_rotated_vector_is_a_product_of_complex_numbers():
    turned = from_complex(np.exp(1j * ANGLE) * (VECTOR[:, 0] + 1j * VECTOR[:, 1]))
    np.testing.assert_allclose(rotated(ANGLE, VECTOR), turned, atol=1e-15)
    np.testing.assert_allclose(np.stack(components(ANGLE, *VECTOR.T), axis=-1), turned, atol=1e-15)
    np.testing.assert_allclose(rotated(np.pi / 2, VECTOR), perpendicular(VECTOR), atol=1e-15)


@pytest.mark.parametrize("index", range(7))
def test_velocity_and_acceleration_are_derivatives_of_a_rotated_vector(index):
    angle, rate, alpha, vector = ANGLE[index], RATE[index], ALPHA[index], VECTOR[index]

    def place(t):
        return np.moveaxis(rotated(angle + rate * t + alpha * t * t / 2, vector), -1, 0)

    arm = rotated(angle, vector)
    np.testing.assert_allclose(rotation_velocity(rate, arm), derivative(place, 0.0), atol=1e-12)
    np.testing.assert_allclose(rotation_acceleration(rate, alpha, arm), derivative(place, 0.0, order=2), atol=1e-11)
    assert np.abs(rotation_acceleration(rate, -alpha, arm) - derivative(place, 0.0, order=2)).max() > 1e-2
