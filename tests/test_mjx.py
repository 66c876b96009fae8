"""MJX: MuJoCo's model by another implementation. Slow: a model takes tens of seconds to compile."""

from __future__ import annotations

import numpy as np
import pytest

from engines import Promise, Unpromised, Unsupported
from engines.mjx import DEFAULT, NO_VELOCITY_TERM, TUNED, VARIANTS
from reports.pages.catalogue import SCENES
from reports.pages.engines.velocity_term import VelocityTerm

BY_NAME = {scene.name: scene for scene in SCENES}


@pytest.fixture
def installed() -> None:
    if DEFAULT.missing:
        pytest.skip(DEFAULT.missing)


def test_what_c_code_would_have_to_run_is_refused():
    for name in ("sleigh", "rolling_disc"):
        with pytest.raises(Unsupported, match="MJX does not run"):
            DEFAULT.build(BY_NAME[name].mechanism(), 1e-2)


def test_an_order_is_promised_of_trees_alone():
    tree, loop = BY_NAME["pendulum_2"].mechanism(), BY_NAME["free_four_bar"].mechanism()
    orders = [engine.order(tree) for engine in VARIANTS]
    assert [order.order for order in orders if isinstance(order, Promise)] == [1, 4]
    for engine in VARIANTS:
        assert isinstance(engine.order(loop), Unpromised)


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
def test_a_tree_moves_as_in_mujoco():
    scene = BY_NAME["pendulum_2"]
    for engine in VARIANTS:
        here = engine.build(scene.mechanism(), 1e-2)(50, 1)
        there = engine.settings.build(scene.mechanism(), 1e-2)(50, 1)
        # The same formulas in another order of summation; the chaos of a double pendulum is a factor of 10 in 0.5 s.
        np.testing.assert_allclose(here.pose, there.pose, rtol=0, atol=1e-9)
        np.testing.assert_allclose(here.reaction, there.reaction, rtol=0, atol=1e-6 * np.nanmax(np.abs(there.reaction)))
        assert not here.warnings


@pytest.mark.slow
@pytest.mark.usefixtures("installed")
def test_a_loop_is_wrong_by_the_velocity_term_and_says_so():
    scene = BY_NAME["free_four_bar"]
    run = DEFAULT.build(scene.mechanism(), 1e-3)(10, 10)
    assert run.warnings == (NO_VELOCITY_TERM,)
    found = VelocityTerm(TUNED).run()
    # The accelerations of loops that turn, by MJX, are those of the same softness without J-dot v, to the solver's
    # tolerance; with it, as the other implementation has them, they differ by a part of themselves.
    assert np.max(found["without"]) < 1e-6
    assert np.max(found["with"]) > 1e-2
