"""Every printed slip is wrong by numbers, its correction is right by numbers, and neither decides: a derivative
does.
"""

from __future__ import annotations

import math

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
