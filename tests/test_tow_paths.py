"""The length of a towed wheel's path, and its cusps, against quadrature of |cos psi| and the classical tractrix."""

import itertools
import math

import mpmath
import numpy as np
import pytest

from reference.scenes.wheels.tractrix import Tow

# (length, angle, radius): straight, wide and tight circles to both sides, R = L, folded and nearly so.
TOWS = [
    (1.5, 0.7, math.inf),
    (1.5, 2.5, math.inf),
    (1.0, math.pi - 1e-6, math.inf),
    (1.0, -2.0, 4.0),
    (1.0, 3.0, -2.5),
    (1.0, 0.3, 1.0),
    (1.0, 2.8, -1.0),
    (2.0, 0.4, 0.7),
    (2.0, -1.0, -1.3),
    (1.0, 0.0, 0.2),
]
WAYS = np.array([-6.0, -1.3, 0.0, 0.4, 2.0, 9.0])


def by_quadrature(tow, way):
    """int |cos psi| ds in panels that end at every change of sign of cos psi, found on a fine table."""
    table = np.linspace(0.0, way, 4001)
    cosine = np.cos(tow.relative_angle(table))
    ends = [0.0]
    for left in np.flatnonzero(cosine[1:] * cosine[:-1] < 0):
        low, high = table[left], table[left + 1]
        for _ in range(60):
            middle = 0.5 * (low + high)
            same = np.cos(tow.relative_angle(middle)) * cosine[left] > 0
            low, high = (middle, high) if same else (low, middle)
        ends.append(low)
    ends.append(way)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    total = 0.0
    for first, last in itertools.pairwise(ends):
        parts = np.linspace(first, last, 65)
        half = 0.5 * np.diff(parts)
        at = 0.5 * (parts[1:] + parts[:-1])[:, None] + half[:, None] * nodes
        total += abs(np.sum(half[:, None] * weights * np.cos(tow.relative_angle(at))))
    return total, ends[1:-1]


@pytest.mark.parametrize(("length", "angle", "radius"), TOWS)
def test_the_path_is_as_long_as_the_wheel_has_rolled_either_way(length, angle, radius):
    tow = Tow(length, angle, radius)
    found = tow.wheel_path_length(WAYS)
    for way, ours in zip(WAYS, found, strict=True):
        total, ends = by_quadrature(tow, way)
        assert ours == pytest.approx(total, abs=1e-12 * (1 + abs(way)))
        cusps = tow.cusps(min(0.0, way), max(0.0, way))
        assert np.sort(ends) == pytest.approx(cusps, abs=1e-9)
        assert np.abs(np.cos(tow.relative_angle(cusps))).max(initial=0.0) < 1e-12
        # One way at a time is the same as many at once.
        assert tow.wheel_path_length(way) == pytest.approx(ours, abs=1e-14 * (1 + abs(way)))
    rolled = np.abs(tow.wheel_advance(WAYS))
    assert np.all(rolled <= found + 1e-12)


def test_the_path_is_that_of_a_polygon_through_the_wheels_places():
    tow = Tow(1.0, 2.8, -1.2, (0.3, -0.4, 1.0))
    places = tow.wheel(np.linspace(0.0, 5.0, 200_001))
    polygon = np.sum(np.linalg.norm(np.diff(places, axis=0), axis=-1))
    assert tow.wheel_path_length(5.0) == pytest.approx(polygon, rel=1e-9)


def test_a_tractrix_is_as_long_as_huygens_found():
    # Straight tow from a right angle: psi = 2 atan(e^(-s/L)), and the arc is L ln(1 / sin psi).
    tow = Tow(1.5, math.pi / 2)
    with mpmath.workdps(40):
        for way in (0.1, 1.0, 7.0):
            psi = 2 * mpmath.atan(mpmath.exp(-mpmath.mpf(way) / 1.5))
            assert tow.wheel_path_length(way) == pytest.approx(float(-1.5 * mpmath.log(mpmath.sin(psi))), rel=1e-14)


def test_a_wheel_that_follows_steadily_goes_round_its_own_circle():
    settled = -math.asin(1 / 3)
    tow = Tow(1.0, settled, 3.0)
    assert tow.wheel_path_length([10.0, -10.0]) == pytest.approx(10 * math.sqrt(8) / 3, rel=1e-13)
    behind, folded = Tow(1.0, 0.0), Tow(1.0, math.pi)
    assert behind.wheel_path_length(3.0) == 3.0
    assert folded.wheel_path_length(3000.0) == 3000.0
    assert folded.wheel_advance(3000.0) == -3000.0
    assert len(folded.cusps(-1e3, 1e3)) == 0
