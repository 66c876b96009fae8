"""Tests of Drake, of Newton's solver Kamino and of MuJoCo Warp: statements in the adapters, refusals, failed runs.

On a new computer Warp compiles its kernels for minutes, so the tests that run Warp are marked as slow. `test_promised`,
`test_claims` and `test_conformance` test motions and refusals of all engines.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import Unsupported, mjx, mujoco_warp, newton
from engines.device import DEVICE, chosen_device
from engines.drake import CENIC, DEFAULT, TUNED, DrakePlant
from engines.tree import spanning_tree
from reference.joints import Drive, Pin, Rod
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import scene
from tests.engines.test_promised import FLYING, LOOPS, MECHANISMS, PINNED, SAMPLES, exact, span

BAR = Body("bar", 1.0, 0.1, (0.5, 0.0, 0.0))
HINGE = Pin("hinge", None, "bar", (0.0, 0.0), (-0.5, 0.0))
with_drake, with_newton, with_warp = (
    pytest.mark.skipif(bool(engine.missing), reason=engine.missing)
    for engine in (DEFAULT, newton.DEFAULT, mujoco_warp.DEFAULT)
)


@with_drake
def test_a_step_closes_half_of_a_gap():
    """In the solver SAP the relaxation time of a rigid constraint is the step."""
    plant = DrakePlant(spanning_tree(scene("free_four_bar").mechanism()), 1e-3, "discrete")
    plant.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, 0.0])
    position = plant.plant.GetPositions(plant.context)
    position[plant.address[0]] += 1e-6
    plant.plant.SetPositions(plant.context, position)
    plant.plant.SetVelocities(plant.context, 0.0 * position)
    gaps = []
    for _ in range(2):
        pose = plant.tree.instant(*plant._state())[0]
        gaps.append(np.abs(plant.mechanism.gap(pose[None], np.zeros(1))[0]).max())
        plant._advance(1)
    assert gaps[1] / gaps[0] == pytest.approx(0.5, abs=1e-3)


@with_drake
def test_a_constraint_with_the_ground_is_one_with_a_welded_body():
    """Drake would end the process if the constraint used the body of the world."""
    swinging = Mechanism((BAR,), (Rod("rod", None, "bar", (0.0, 0.0), (0.5, 0.0), 1.0),), (0.0, -10.0))
    run = DEFAULT.build(swinging, 1e-3)(10, 10)
    assert np.abs(swinging.gap(run.pose, run.t)).max() < 1e-6


@with_drake
def test_a_run_that_drake_gives_up_ends_with_its_reason_and_keeps_the_samples_before():
    again = Pin("again", None, "bar", (0.0, 0.0), (-0.5, 0.0))
    run = DEFAULT.build(Mechanism((BAR,), (HINGE, again), (0.0, -10.0)), 1e-3)(2, 2)
    assert run.warnings[0].startswith("drake: The Hessian")
    assert np.isfinite(run.pose[0]).all()
    assert np.isnan(run.pose[1:]).all()


@with_drake
def test_what_continuous_time_does_not_move_is_refused_by_name():
    turning = Body("bar", 1.0, 0.1, (0.5, 0.0, 0.0), (0.0, 1.0, 2.0))
    driven = Mechanism((turning,), (HINGE, Drive("motor", None, "bar", 2.0, 0.0)))
    with pytest.raises(Unsupported, match=r"joint 'motor'.*no constraints and no PD gains"):
        TUNED.build(driven, 1e-3)
    with pytest.raises(Unsupported, match="drive 'motor': CENIC turns"):
        CENIC.build(driven, 1e-3)
    with pytest.raises(Unsupported, match="joint 'C'"):
        TUNED.build(scene("free_four_bar").mechanism(), 1e-3)


BUILT = sorted({*PINNED, *FLYING, *LOOPS, "spring", "damper"})


def test_joints_that_are_not_built_are_refused_by_name():
    with pytest.raises(Unsupported, match="'motor': our adapter of newton builds no motor"):
        newton.DEFAULT.build(MECHANISMS["a drive against its pin"], 1e-3)


@pytest.mark.slow
@with_newton
@pytest.mark.parametrize("name", BUILT)
def test_kamino_moves_with_the_error_of_semi_implicit_euler(name):
    """The largest error is 3 % of the motion. A chain of ten links has the largest error, 9e-3."""
    run = newton.TUNED.build(MECHANISMS[name], span(name) / SAMPLES / 80)(SAMPLES, 80)
    moved = np.abs(exact(name) - exact(name)[0]).max()
    assert np.abs(run.pose - exact(name)).max() < 1e-6 + 0.03 * moved


@pytest.mark.slow
@with_newton
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


def test_an_unknown_device_is_refused_by_name(monkeypatch):
    assert chosen_device() == "cpu"
    monkeypatch.setenv(DEVICE, "abacus")
    with pytest.raises(Unsupported, match="'abacus'; it must be 'cpu' or 'cuda'"):
        chosen_device()


@pytest.mark.parametrize("engine", [mjx.DEFAULT, mujoco_warp.DEFAULT], ids=lambda engine: engine.name)
def test_joints_that_need_a_contact_are_refused(engine):
    for name in ("sleigh", "rolling_disc"):
        with pytest.raises(Unsupported, match=f"our adapter of {engine.title} builds none"):
            engine.build(scene(name).mechanism(), 1e-2)


@pytest.mark.slow
@with_warp
def test_a_device_that_is_not_here_is_refused(monkeypatch):
    monkeypatch.setenv(DEVICE, "cuda")
    with pytest.raises(Unsupported, match="Warp finds no device 'cuda' here"):
        mujoco_warp.DEFAULT.build(scene("pendulum_2").mechanism(), 1e-2)


@pytest.mark.slow
@with_warp
@pytest.mark.parametrize("engine", mujoco_warp.VARIANTS, ids=lambda engine: engine.variant)
@pytest.mark.parametrize("name", [name for name in MECHANISMS if name != "weld that closes a loop"])
def test_it_moves_as_mujoco_with_the_same_settings(engine, name):
    """The error of single precision in these motions is at most 2e-6."""
    spacing = span(name) / SAMPLES / 40
    found, expected = (method.build(MECHANISMS[name], spacing)(SAMPLES, 40) for method in (engine, engine.settings))
    bound = 1e-4 if any("velocity term" in warning for warning in found.warnings) else 5e-6
    assert np.abs(found.pose - expected.pose).max() < bound * max(1.0, np.abs(expected.pose).max())


@pytest.mark.slow
@with_warp
def test_the_stiffest_impedance_is_worse_in_single_precision():
    linkage, truth = scene("free_four_bar"), scene("free_four_bar").motion
    stiffest = mujoco_warp.MuJoCoWarp("stiffest", mujoco_warp.C_TUNED)
    errors = []
    for engine in (mujoco_warp.TUNED, stiffest):
        run = engine.build(linkage.mechanism(), 1e-3)(50, round(0.02 * linkage.duration / 1e-3))
        errors.append(np.abs(run.pose - truth(run.t).pose).max())
    assert errors[0] < errors[1]
