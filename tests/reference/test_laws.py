"""Formulas of the reference at random arguments over eighteen decades, compared with fifty digits."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.reference.formulas import LAWS
from tests.reference.law import Law, misses, searched

NAMED = {law.name: law for law in LAWS}
# Allowed error in units of the rounding of the arguments. A formula of twenty operations causes up to twenty roundings.
# A lost decimal digit is a factor of ten, and most of the errors found by this test had lost four digits.
ROUNDINGS = 20


@pytest.mark.parametrize("cases", [12, pytest.param(600, marks=pytest.mark.slow)])
@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.name)
def test_formulas_have_errors_of_a_few_roundings_of_their_arguments(law: Law, cases: int) -> None:
    miss = max(searched(law, cases, 1 if cases == 12 else 2), key=lambda one: one.ratio)
    assert miss.ratio < ROUNDINGS, str(miss)


# Arguments at which earlier versions of formulas lost digits.
FOUND = {
    # If the ground is 1500 times shorter than the crank, a sum with the crank's square loses the ground's digits.
    "four-bar, branch +1": (
        *(9025.355793020284, 24461.827924377452, 18821.77529205487, -0.9988767354831353, -5.781930411818574),
        *(-1.8032103807498472, -48.80631439014284, 0.2038044762375766),
    ),
    # The constants of the arc's series were subtracted last, so that a short arc had few digits left.
    "cam at a parameter": (
        *(11902.645692682283, -10724.66978055462, 4319.19523390655, -166.8134543432839, -232.1255391750947),
        *(216.8935151019048, -199.632266555443, -4.975638815152181e-08),
    ),
    # On the flat side the two terms of the tangent angle nearly cancelled.
    "ellipse at a parameter": (0.2970230243104033, 0.0011085289153370565, -1.5707907017221043),
    # For a short path the logarithm of a number near 1 lost digits. On a circle smaller than the drawbar the sum of two
    # angles lost digits.
    "towed wheel": (1185375.3119599016, 0.5602953463275804, 1259916407.01395, 4.095497157341971e-05),
    "towed wheel, going round": (
        *(6.205517261697245, -0.15671260809038934, -0.08751075069403959, -12.758961976426988),
    ),
}


@pytest.mark.parametrize("law", FOUND)
def test_arguments_that_once_lost_digits_have_errors_of_a_few_roundings(law: str) -> None:
    found = misses(NAMED[law.removesuffix(", going round")], FOUND[law])
    assert found is not None
    assert max(miss.ratio for miss in found) < ROUNDINGS


def test_the_search_notices_a_relative_error_of_1e_minus_13() -> None:
    for law in LAWS:
        if "limit" in law.name:  # near a dead centre, where roundings of the arguments are amplified
            continue
        wrong = replace(law, ours=lambda *numbers, law=law: np.asarray(law.ours(*numbers), dtype=float) * (1 + 1e-13))
        assert max(searched(wrong, 6, 1), key=lambda one: one.ratio).ratio > ROUNDINGS, law.name
