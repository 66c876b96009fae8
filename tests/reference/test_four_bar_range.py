"""Which four-bars and crank angles there are: classes, limits, change points, and what is refused."""

import math

import numpy as np
import pytest

from reference.checks import InvalidMechanism
from reference.scenes.four_bar.linkage import FourBar, Unreachable
from tests.present import present
from tests.reference.test_four_bar import CHAPTER, ROCKING, gap, random_linkages, wrapped


def test_crank_limits_are_where_the_triangle_flattens_and_the_crank_is_refused_beyond():
    for linkage in random_linkages(200):
        limits = linkage.crank_limits()
        turns = linkage.grashof() == "double-crank" or (
            linkage.grashof() == "crank-rocker" and linkage.crank < linkage.rocker
        )
        assert (limits is None) == turns
        for low, high in limits or ():
            for end, outward in ((low, -1), (high, 1)):
                span = abs(linkage.crank * np.exp(1j * end) - complex(*linkage.ground))
                flat = (linkage.coupler + linkage.rocker, abs(linkage.coupler - linkage.rocker))
                assert min(abs(span - s) for s in flat) < 1e-14
                linkage.angles(end)
                with pytest.raises(Unreachable):
                    linkage.angles(end + outward * 1e-9)


def test_an_unreachable_angle_is_named_with_the_possible_range():
    (low, high), *_ = present(ROCKING.crank_limits())
    with pytest.raises(Unreachable, match=r"crank angle 4\.5 rad") as refusal:
        ROCKING.angles(np.array([(low + high) / 2, 4.5]))
    assert f"{low:.9g}" in str(refusal.value)
    assert f"{high:.9g}" in str(refusal.value)


@pytest.mark.parametrize(
    ("lengths", "ground", "name"),
    [
        ((1.0, 2.0, 2.5), (3.0, 0.0), "crank-rocker"),
        ((2.5, 2.0, 1.0), (3.0, 0.0), "crank-rocker"),  # the rocker turns
        ((2.0, 2.5, 3.0), (1.0, 0.0), "double-crank"),
        ((2.0, 1.0, 2.5), (3.0, 0.0), "double-rocker"),
        ((2.0, 2.2, 1.9), (3.0, 0.0), "triple-rocker"),
        ((0.1, 0.3, 0.1), (0.3, 0.0), "change-point"),
        ((0.1, 0.7, 0.2), (0.8, 0.0), "change-point"),  # 0.1 + 0.8 and 0.7 + 0.2 differ by rounding
    ],
)
def test_grashof_classes_by_name(lengths, ground, name):
    crank, coupler, rocker = lengths
    assert FourBar(crank, coupler, rocker, ground).grashof() == name


@pytest.mark.parametrize(
    ("excess", "name"), [(1e-11, "triple-rocker"), (-1e-11, "crank-rocker"), (0.0, "change-point")]
)
def test_a_hundredth_of_a_nanometre_a_metre_is_no_rounding(excess, name):
    # s + l - p - q for s = 1, l = 3, p = 1.5, q = 2.5 m.
    assert FourBar(1.0, 1.5, 2.5 - excess, (3.0, 0.0)).grashof() == name


def test_a_parallelogram_keeps_its_digits_beside_its_change_point():
    parallelogram = FourBar(0.1, 0.3, 0.1, (0.3, 0.0))
    assert parallelogram.crank_limits() is None
    for theta in (1e-3, -1e-3, 1e-6, -1e-6, 1e-9, -1e-9, 1e-100, -1e-100):
        # One of the two branches is the parallelogram, whose coupler stays parallel to the ground.
        pairs = np.array([wrapped(parallelogram.angles(theta, branch)) for branch in (1, -1)])
        beta, phi = pairs[np.argmin(np.abs(pairs[:, 0]))]
        # The formulas lose nothing here, where a difference of squared lengths would leave eps / theta.
        assert abs(beta) < 4e-15
        assert abs(phi - theta) < 4e-15


def test_b_on_d_is_refused_where_c_is_not_determined():
    kite = FourBar(1.0, 0.5, 0.5, (0.6, 0.8))
    with pytest.raises(Unreachable, match="B lies on D"):
        FourBar(1.0, 0.5, 0.5, (1.0, 0.0)).angles([1.0, 0.0])
    theta = np.arctan2(0.8, 0.6) + np.array([-0.9, -1e-3, 1e-3, 0.9])
    assert np.max(gap(kite, theta, *kite.angles(theta))) < 1e-15


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ((0.0, 1.0, 1.0, (1.0, 0.0)), "crank is 0.0"),
        ((1.0, -1.0, 1.0, (1.0, 0.0)), "coupler is -1.0"),
        ((1.0, 1.0, math.nan, (1.0, 0.0)), "rocker is nan"),
        ((1.0, 1.0, 1.0, (0.0, 0.0)), "other than"),
        ((1.0, 1.0, 1.0, (math.inf, 0.0)), "ground is"),
        ((1.0, 1.0, 1.0, (3.1, 0.0)), "can't be assembled"),
        ((5.0, 1.0, 1.0, (1.0, 0.0)), "can't be assembled"),
    ],
)
def test_impossible_linkages_are_refused_in_a_sentence(values, words):
    with pytest.raises(InvalidMechanism, match=words):
        FourBar(*values)


def test_bad_arguments_are_refused_in_a_sentence():
    with pytest.raises(ValueError, match=r"theta is .*must be finite numbers"):
        CHAPTER.angles([0.0, math.nan])
    with pytest.raises(ValueError, match=r"theta is .*must be finite numbers"):
        CHAPTER.angles(math.inf)
    with pytest.raises(ValueError, match="branch is 0"):
        CHAPTER.angles(0.0, 0)
    with pytest.raises(InvalidMechanism, match="density"):
        CHAPTER.forces(0.0, 1.0, density=(1.0, 2.0))  # pyright: ignore[reportArgumentType]
    with pytest.raises(InvalidMechanism, match=r"density is .*greater than zero"):
        CHAPTER.forces(0.0, 1.0, density=(1.0, 0.0, 1.0))
