"""Steps of their own size where it is hard: beside singular positions, and with springs a million times as stiff."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import Lagrange
from reference.forces import Damper, Spring, TorsionDamper, TorsionSpring
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.search.mechanisms import mechanism as random_mechanism

HOLONOMIC = ("pin", "slot", "rod", "gear", "weld", "spring", "torsion-spring")


@pytest.mark.parametrize("off", [1e-2, 1e-4, 1e-6])
def test_a_linkage_that_almost_folds_into_a_line_holds_the_tolerance(off):
    # A coupler as long as the ground and a rocker as long as the crank: twice a turn all bars lie in one line, where
    # the linkage could go on as another one, but for what the coupler is longer.
    scene = FreeFourBar(
        crank=1.0, coupler=2.0 * (1 + off), rocker=1.0, ground=(2.0, 0.0), start=1.0, rate=5.0, duration=3.0
    )
    exact = scene.motion(0.1 * np.arange(31)).pose
    for tolerance in (1e-6, 1e-9):
        run = Lagrange(tolerance=tolerance).build(scene.mechanism(), 0.1)(30, 1)
        assert run.warnings == ()
        # Some hundred steps and several passages of the line; the largest measured is 4.4 times the tolerance.
        assert np.abs(run.pose - exact)[..., 2].max() < 20 * tolerance


def stiffened(mechanism: Mechanism, factor: float) -> Mechanism:
    """With springs so many times as stiff."""
    forces = tuple(
        replace(force, stiffness=force.stiffness * factor) if isinstance(force, (Spring, TorsionSpring)) else force
        for force in mechanism.forces
    )
    return replace(mechanism, forces=forces)


@pytest.mark.parametrize("number", [5, 13, 17, 25, 29, 41, 44])
def test_random_mechanisms_with_stiff_springs_hold_the_tolerance_over_their_fastest_swings(number):
    stiff = stiffened(random_mechanism(31, number, HOLONOMIC), 1e6)
    unit = np.array([stiff.length_scale, stiff.length_scale, 1.0])
    exact, *runs = (
        Lagrange(tolerance=tolerance).build(stiff, stiff.time_scale / 10)(10, 1) for tolerance in (1e-13, 1e-8, 1e-10)
    )
    assert np.abs((exact.pose - stiff.pose) / unit).max() > 0.05  # these do move
    # The largest measured, of 45 mechanisms, is 2.6 times the tolerance.
    for tolerance, run in zip((1e-8, 1e-10), runs, strict=True):
        assert np.abs((run.pose - exact.pose) / unit).max() < 20 * tolerance


def test_a_step_that_stability_sets_and_not_accuracy_is_told():
    # A damper that stops a body in a millionth of the time in which gravity moves it: an explicit method creeps.
    scene = FreeFourBar()
    damped = replace(
        scene.mechanism(),
        forces=(Damper("stop", None, scene.mechanism().bodies[2].name, (3.0, 0.0), (0.0, 0.0), 1e5),),
    )
    run = Lagrange(tolerance=1e-8).build(damped, 0.01)(10, 1)
    assert any("stability and not accuracy sets the steps" in warning for warning in run.warnings)
    turned = replace(damped, forces=(TorsionDamper("stop", None, damped.bodies[2].name, 1e5),))
    assert Lagrange(tolerance=1e-8).build(turned, 0.01)(10, 1).warnings
    assert Lagrange(tolerance=1e-8).build(scene.mechanism(), 0.01)(10, 1).warnings == ()
