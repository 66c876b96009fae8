"""Every printed slip is wrong by numbers, its correction is right by numbers, and neither decides: a derivative
does.
"""

from __future__ import annotations

import math
import subprocess
import sys

import numpy as np
import pytest

from reference.chapter.errata.catalogue import ERRATA, Erratum, derivative

IDS = [str(erratum.number) for erratum in ERRATA]


@pytest.mark.parametrize("erratum", ERRATA, ids=IDS)
def test_the_correction_is_the_derivative_and_the_printed_formula_is_not(erratum: Erratum) -> None:
    values = erratum.values()
    assert values.printed.shape == values.right.shape == values.decides.shape
    # Numbers of the order of 1 to 10; Cauchy's integral divides rounding by radius^2 = 1/16.
    assert np.abs(values.right - values.decides).max() < 1e-12
    # The four-bar's slip is a claim of impossibility: what is printed instead is an integration, right to its
    # tolerance.
    least = 1e-3 if erratum.number == 19 else 0.1
    assert np.abs(values.printed - values.decides).max() > least


def test_the_miss_of_the_claim_is_that_of_our_tolerance_and_not_of_the_printed_rates() -> None:
    (claim,) = [erratum for erratum in ERRATA if erratum.by_tolerance is not None]
    assert claim.number == 19
    assert claim.by_tolerance is not None
    misses = claim.by_tolerance()
    assert misses[1e-3] == claim.values().miss
    # Over a turn and a bit an error grows by less than ten times its tolerance.
    assert all(miss < 10 * tolerance for tolerance, miss in misses.items())
    assert min(misses) <= 1e-12


def test_every_computable_slip_of_class_e_is_there_once() -> None:
    """Ten of the thirteen: 10 (names of curves exchanged) and 18 (a letter in a sentence) have nothing to compute."""
    assert [erratum.number for erratum in ERRATA] == [1, 2, 11, 19, 23, 24, 25, 26, 27, 28]


def test_the_two_slips_that_dimensions_cannot_catch_have_the_right_size_and_the_wrong_direction() -> None:
    skate = next(erratum for erratum in ERRATA if erratum.number == 11).values()
    difference = skate.printed - skate.right
    assert math.hypot(*difference) == pytest.approx(
        math.sqrt(2) * 1.3 * 1.7, rel=1e-14
    )  # v thetadot, a quarter turn off
    swapped = next(erratum for erratum in ERRATA if erratum.number == 28).values()
    assert swapped.printed[0] == swapped.right[0]
    assert abs(swapped.printed[1] - swapped.right[1]) > 1


def test_the_derivative_knows_functions_whose_derivatives_are_known() -> None:
    assert derivative(np.exp, 0.3) == pytest.approx(math.exp(0.3), rel=1e-14)
    assert derivative(np.sin, 0.3, order=2) == pytest.approx(-math.sin(0.3), rel=1e-13)
    assert derivative(lambda t: np.stack([t**3, 1 / (1 + t)]), 1.0) == pytest.approx([3.0, -0.25], rel=1e-13)


def test_the_two_problems_and_parking_are_where_a_first_user_looks():
    from reference.chapter.errata.linkages import accelerations, velocities
    from reference.chapter.parking import Move, park

    assert velocities(1.0, (0.0, 0.0), (2.0, 1.0)).b == pytest.approx([3.0, 0.0])
    assert accelerations(1.0, (0.0, 0.0), (2.0, 0.0), (0.0, 0.0)).a == pytest.approx([0.0, 4.0])
    assert park((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)) == (Move(0.0, 1.0), Move(0.0))


def test_a_joint_is_imported_without_any_scene():
    code = "import sys, reference.joints, reference.mechanism; print([m for m in sys.modules if 'scene' in m])"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert told.stdout.strip() == "[]"
