"""Tests of the ideal motion in a new installation. The first motions are computed in numpy while numpy is faster than
compilation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from engines.lagrange import JUDGE_CLAIM, loading
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.check import first_use
from reports.check.judging import reference_motion

SAMPLES, SPACING = 20, 0.01
NUMPY_NOTE = "following the ideal motion"


@pytest.fixture
def new_installation(monkeypatch, tmp_path):
    """An installation without machine code, in which compilation is slower than numpy. The value is the list of the
    reported stages."""
    monkeypatch.setattr(first_use, "COMPILE_SECONDS", math.inf)
    monkeypatch.setattr(first_use, "is_cold", lambda adaptive: True)
    monkeypatch.setattr(loading, "_cache_folder", lambda: tmp_path)
    return list[str]()


def test_the_first_motion_from_numpy_has_the_accuracy_that_the_judge_claims(new_installation):
    mechanism = FreeFourBar().mechanism()
    motion = first_use.ideal_motion(mechanism, SAMPLES, SPACING, 1e-4, new_installation.append)
    expected = reference_motion(mechanism, SAMPLES, SPACING, 1e-4)
    difference = np.abs(motion.trajectory.pose - expected.trajectory.pose) / mechanism.pose_unit
    assert difference.max() < JUDGE_CLAIM
    assert new_installation == [NUMPY_NOTE]
    assert loading.numpy_seconds() > 0


@pytest.mark.parametrize(("limit", "spent"), [(0.0, 0.0), (1e9, 2e9)])
def test_the_code_is_compiled_if_numpy_would_take_longer(new_installation, limit, spent, monkeypatch):
    """Numpy is not used if it would run, or has already run, longer than a compilation takes."""
    monkeypatch.setattr(first_use, "COMPILE_SECONDS", limit)
    loading.add_numpy_seconds(spent)
    first_use.ideal_motion(FreeFourBar().mechanism(), SAMPLES, SPACING, 1e-4, new_installation.append)
    assert new_installation[0] == NUMPY_NOTE
    assert new_installation[1].startswith(loading.COMPILING_NOTE)


def test_a_motion_that_numpy_does_not_resolve_is_repeated_in_machine_code(new_installation, monkeypatch):
    monkeypatch.setattr("engines.lagrange.judge.JUDGE_CLAIM", 0.0)
    first_use.ideal_motion(FreeFourBar().mechanism(), SAMPLES, SPACING, 1e-4, new_installation.append)
    assert len(new_installation) == 2
