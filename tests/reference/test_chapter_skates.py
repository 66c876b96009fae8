"""The skate is the only linear condition on one body in the plane that is not integrable; no factor of 2."""

from __future__ import annotations

import numpy as np
import pytest

from reference.chapter.integrability import growth, is_integrable
from reference.chapter.skates import coriolis_factors, frobenius, one_form, skate_of
from reference.checks import InvalidMechanism
from reference.mechanism import Body, Mechanism
from reference.scenes.skates.sleigh import ChaplyginSleigh

RANDOM = np.random.default_rng(185)
ROWS = [*map(tuple, RANDOM.normal(size=(12, 3)).tolist()), (1e-9, 2e-9, 3e-9), (1e9, 0.0, -1e9), (0.0, -2.0, 0.0)]


@pytest.mark.parametrize("row", ROWS)
def test_a_row_with_a_part_along_the_plane_is_a_skate_and_never_integrable(row):
    skate, size = skate_of(row), np.hypot(*row[:2])
    assert skate is not None
    place = np.zeros(3)
    for place in RANDOM.normal(size=(4, 3)):
        body = Body("body", 1.0, 1.0, tuple(place.tolist()))
        held = Mechanism((body,), (skate,)).rows(place[None])[0]
        # Rounding of a point and a blade's angle, relative to the row.
        assert held == pytest.approx(one_form(row)(place)[0] / size, abs=1e-15 * (1 + np.abs(row).max() / size))
        assert frobenius(row, place) == pytest.approx(-(size**2), rel=1e-13)
    unit = tuple(number / max(map(abs, row)) for number in row)
    assert not is_integrable(one_form(unit), place)
    assert growth(one_form(unit), place) == (2, 3)


def test_a_row_of_turning_alone_is_no_skate_and_integrable():
    assert skate_of((0.0, 0.0, -3.0)) is None
    assert is_integrable(one_form((0.0, 0.0, -3.0)), np.array([0.3, -0.2, 0.8]))
    with pytest.raises(InvalidMechanism, match="one of its three numbers must differ from zero"):
        skate_of((0.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("speed", "rate", "alpha"), [(1.3, 1.7, -0.6), (-2.0, 0.4, 5.0), (1e-6, -1e6, 0.0), (3, 1e-6, 0)]
)
def test_the_skates_coriolis_like_term_stands_once_and_a_sliders_twice(speed, rate, alpha):
    assert coriolis_factors(speed, rate, alpha) == pytest.approx((1.0, 2.0), rel=1e-12)


def test_the_sleigh_of_the_suite_has_the_term_once():
    """Without the formula: its truth's velocity of C, differentiated by differences of sixth order."""
    scene, step = ChaplyginSleigh(), 1e-3
    motion = scene.motion(0.7 + step * np.arange(-3, 4))
    heading = motion.pose[:, 0, 2]
    arm = -scene.offset * np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    of_c = motion.twist[:, 0, :2] + motion.twist[:, 0, 2:] * np.stack([-arm[:, 1], arm[:, 0]], axis=-1)
    change = np.array([-1, 9, -45, 0, 45, -9, 1]) @ of_c / (60 * step)
    along, across = (
        np.array([np.cos(heading[3]), np.sin(heading[3])]),
        np.array([-np.sin(heading[3]), np.cos(heading[3])]),
    )
    # Differences of numbers near 1 with 1e-16, over a millisecond.
    assert change @ across == pytest.approx((of_c[3] @ along) * motion.twist[3, 0, 2], rel=1e-11)


def test_coriolis_factors_need_both_motions():
    for speed, rate in ((0.0, 1.0), (1.0, 0.0)):
        with pytest.raises(InvalidMechanism, match="neither may be zero"):
            coriolis_factors(speed, rate)
