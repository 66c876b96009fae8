"""The rule by which MuJoCo's rows get their stiffness, and what a step makes of it."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

from typing import Any

import mujoco
import numpy as np
import pytest

from engines.mujoco import Hardened, MuJoCo, Shipped, TiedToStep
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from tests.mechanisms import four_bar

FREE = FreeFourBar()


@pytest.mark.parametrize("make", [lambda: TiedToStep(0.0), lambda: Hardened(softening=-1.0), lambda: Hardened(share=0)])
def test_bad_stiffness_is_refused(make: Any) -> None:
    with pytest.raises(ValueError, match="greater than zero"):
        make()


@pytest.mark.parametrize("stiffness", [Shipped(), TiedToStep(), TiedToStep(1.0), Hardened()])
def test_every_spring_of_a_row_is_critically_damped(stiffness: Any) -> None:
    mechanism, dt = four_bar(crank_rate=10.0), 1e-3
    spring, damper = stiffness.gains(mechanism, dt)
    assert damper**2 == pytest.approx(4 * spring, rel=1e-14)
    first, second = stiffness.reference(mechanism, dt)
    if first < 0:  # the direct form tells both; the other a time constant, at least two steps, and a damping ratio
        assert (-first, -second) == pytest.approx((spring, damper), rel=1e-14)
    else:
        assert (max(first, 2 * dt), second) == pytest.approx((2 / damper, 1.0), rel=1e-14)


def test_the_shipped_stiffness_is_mujocos_own() -> None:
    equality = mujoco.MjSpec().add_equality()
    assert tuple(equality.solref) == Shipped().reference(FREE.mechanism(), 1e-3)
    assert tuple(equality.solimp) == Shipped().impedance


@pytest.mark.parametrize("steps", [2.0, 3.0, 5.0, 10.0, 20.0])
@pytest.mark.parametrize("dt", [1e-2, 1e-4])
def test_the_first_acceleration_of_a_loop_under_discrete_is_divided_by_what_its_spring_is_in_a_step(steps, dt):
    # From a closed start the exact loop has J a = -bias. Backward Euler's spring (stiffness k, damping b per inertia)
    # gives that over 1 + h b + h^2 k = (1 + 1 / steps)^2: a share that no step changes.
    def first(integrator):
        engine = MuJoCo("loop", integrator=integrator, stiffness=TiedToStep(steps))
        run = engine.build(DrivenFourBar().mechanism(), dt)
        mujoco.mj_forward(run.model.compiled, run.data)
        return run.data.efc_J.reshape(run.data.nefc, -1)[:2] @ run.data.qacc

    np.testing.assert_allclose(first("discrete") / first("implicitfast"), (1 + 1 / steps) ** -2, rtol=1e-4)
