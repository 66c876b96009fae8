"""Tests of Newton's solver Kamino against the judge, of refusals, and of statements in the adapter.

On a new computer Warp compiles its kernels for minutes, so the tests that run Warp are marked as slow.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported, newton
from reference.joints import Pin
from reference.scenes.catalogue import scene
from tests.engines.test_promised import FLYING, LOOPS, MECHANISMS, PINNED, SAMPLES, exact, installed, span

BUILT = sorted({*PINNED, *FLYING, *LOOPS, "spring", "damper"})


@pytest.fixture
def with_newton() -> None:
    installed(newton.DEFAULT)


@pytest.mark.parametrize("solver", ["featherstone", "mujoco", "kamimo"])
def test_another_solver_of_newton_is_refused_by_name(solver):
    with pytest.raises(ValueError, match=f"solver is '{solver}'"):
        replace(newton.DEFAULT, solver=solver)


def test_joints_that_are_not_built_are_refused_by_name():
    with pytest.raises(Unsupported, match="'motor': our adapter of newton builds no motor"):
        newton.DEFAULT.build(MECHANISMS["a drive against its pin"], 1e-3)


@pytest.mark.slow
@pytest.mark.usefixtures("with_newton")
@pytest.mark.parametrize("name", BUILT)
def test_kamino_moves_with_the_error_of_semi_implicit_euler(name):
    """The largest error is 3 % of the motion. A chain of ten links has the largest error, 9e-3."""
    run = newton.TUNED.build(MECHANISMS[name], span(name) / SAMPLES / 80)(SAMPLES, 80)
    moved = np.abs(exact(name) - exact(name)[0]).max()
    assert np.abs(run.pose - exact(name)).max() < 1e-6 + 0.03 * moved


@pytest.mark.slow
@pytest.mark.usefixtures("with_newton")
def test_the_order_and_the_bodies_of_joints_do_not_matter():
    linkage = scene("free_four_bar").mechanism()
    pins = [joint for joint in linkage.joints if isinstance(joint, Pin)]
    swapped = [
        replace(pin, first=pin.second, second=pin.first, first_point=pin.second_point, second_point=pin.first_point)
        for pin in reversed(pins)
    ]
    right, other = (
        newton.TUNED.build(replace(linkage, joints=tuple(joints)), 1e-3)(5, 20).pose for joints in (pins, swapped)
    )
    assert np.abs(right - other).max() < 1e-3 * np.abs(right - right[0]).max()
