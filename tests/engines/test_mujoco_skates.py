"""Skates in MuJoCo: every construction has its order, its floor, its price."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, EXTENDED, TUNED, Hardened, MuJoCo
from engines.mujoco.methods import SKATES
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.wheels.cart import Cart
from reference.trajectory import Trajectory
from tests.engines.test_mujoco_rows import ridden

SLEIGH = ChaplyginSleigh()
(BLADE,) = SKATES
FRICTION = replace(TUNED, variant="tendon friction", skates="tendon friction")
SOFT = replace(EXTENDED, variant="rows, shipped compliance", stiffness=Hardened(softening=1.0), estimates=False)
EVERY = (DEFAULT, TUNED, EXTENDED, BLADE, FRICTION)


def run(engine: MuJoCo, scene: Any, dt: float) -> tuple[Trajectory, Trajectory]:
    samples = round(scene.duration / 0.05)
    motion = engine.build(scene.mechanism(), dt)(samples, round(0.05 / dt))
    return motion, scene.motion(motion.t)


def position_error(engine: MuJoCo, scene: Any, dt: float) -> float:
    motion, truth = run(engine, scene, dt)
    return float(np.abs(motion.pose - truth.pose)[..., :2].max())


@pytest.mark.parametrize("engine", [TUNED, FRICTION], ids=lambda engine: engine.skates)
def test_what_changes_once_a_step_is_of_order_one(engine: MuJoCo) -> None:
    coarse, fine = position_error(engine, SLEIGH, 1e-3), position_error(engine, SLEIGH, 2.5e-4)
    # A direction is a whole step late at most: the way on which it then leads off is the speed times the turning.
    t = np.linspace(0.0, SLEIGH.duration, 1001)
    velocity = SLEIGH.motion(t).twist[:, 0]
    assert coarse < 1e-3 * np.trapezoid(np.hypot(velocity[:, 0], velocity[:, 1]) * np.abs(velocity[:, 2]), t)
    assert 3.5 < coarse / fine < 4.5


def test_friction_has_a_floor_that_no_step_removes() -> None:
    # The blade's friction along it is MuJoCo's least, 1e-5 of the weight.
    coarse, fine = position_error(BLADE, SLEIGH, 1e-3), position_error(BLADE, SLEIGH, 1e-4)
    assert 1e-4 < fine < coarse < 5e-3
    assert coarse / fine < 4  # order one would give ten


def test_a_blade_as_shipped_creeps_whatever_the_step() -> None:
    # Friction's time constant of 0.02 s is a slip of that times u w, and it doesn't know the step.
    coarse, fine = position_error(DEFAULT, SLEIGH, 1e-3), position_error(DEFAULT, SLEIGH, 2.5e-4)
    assert 5e-3 < coarse < 5e-2
    assert fine > 0.8 * coarse


def test_without_hardening_written_rows_keep_the_compliance_as_their_floor() -> None:
    assert position_error(SOFT, SLEIGH, 1e-3) > 0.8 * position_error(SOFT, SLEIGH, 2e-3) > 1e-6


@pytest.mark.parametrize("engine", EVERY, ids=lambda engine: engine.variant)
def test_the_start_is_the_mechanisms_own_and_the_forces_belong_to_their_samples(engine: MuJoCo) -> None:
    mechanism = SLEIGH.mechanism()
    motion, truth = run(engine, SLEIGH, 1e-3)
    assert np.abs(motion.pose[0] - mechanism.pose).max() < 1e-14
    assert np.abs(motion.twist[0] - mechanism.twist).max() < 1e-13
    # What acts on slip alone has none at the start, so its first force is zero; later ones lag by a step
    # or by friction's time constant of 0.02 s.
    lag = 0.1 if engine is DEFAULT else 5e-3
    assert np.abs(motion.reaction - truth.reaction)[1:].max() < lag * np.abs(truth.reaction).max()


@pytest.mark.parametrize("engine", EVERY, ids=lambda engine: engine.variant)
def test_two_wheels_on_one_axle_change_nothing_and_break_nothing(engine: MuJoCo) -> None:
    once, twice = Cart(duration=0.5), Cart(redundant=True, duration=0.5)
    dt = 1e-3
    single, double = (engine.build(scene.mechanism(), dt)(10, 50) for scene in (once, twice))
    # Where the constraint is exact its multiplicity can't matter; where it yields, two yield less than one: as much as
    # the construction errs by itself.
    allowed = 1e-8 if engine is EXTENDED else 5e-2
    assert np.abs(single.pose - double.pose).max() < allowed


def test_a_blade_a_thousandth_further_back_would_be_noticed() -> None:
    motion = EXTENDED.build(ChaplyginSleigh(offset=0.5005).mechanism(), 1e-2)(100, 1)
    truth = SLEIGH.motion(motion.t)
    moved = (motion.pose - motion.pose[0]) - (truth.pose - truth.pose[0])
    assert np.abs(moved).max() > 1e-4


def test_a_skate_on_a_moving_body_is_held_by_rows_and_tendons_and_refused_by_contacts() -> None:
    rows, tendon = (engine.build(ridden(), 1e-3)(10, 50) for engine in (EXTENDED, TUNED))
    assert 1e-6 < np.abs(tendon.pose - rows.pose).max() < 1e-3
    for engine in (DEFAULT, BLADE):
        with pytest.raises(Unsupported, match="runs on the body 'floor'"):
            engine.build(ridden(), 1e-3)


def test_an_unknown_construction_is_refused() -> None:
    with pytest.raises(ValueError, match="skates is 'glue'"):
        replace(TUNED, skates="glue")  # pyright: ignore[reportArgumentType]


def test_a_long_coast_ends_straight_and_raises_no_alarm() -> None:
    scene = ChaplyginSleigh(duration=100.0)
    motion, truth = run(EXTENDED, scene, 1e-2)
    # The heading is settled after about 5 s; its error then carries the sleigh 140 m.
    assert np.abs(motion.pose - truth.pose)[..., 2].max() < 2e-9
    assert np.abs(motion.pose - truth.pose).max() < 140 * 2e-9
    assert motion.warnings == ()


def test_the_softness_that_is_declared_of_a_written_row_is_what_it_slips_by():
    engine, mechanism = SOFT, SLEIGH.mechanism()
    soft = engine.softness(mechanism, 1e-3)
    assert soft is not None
    found = engine.build(mechanism, 1e-3)(SLEIGH.samples, 10)
    rows = mechanism.rows(mechanism.pose)
    inverse = float(((rows / mechanism.inertias.reshape(-1)) @ rows.T)[0, 0])
    # slip' + damping slip = compliance A F: behind a force that rises and falls, the slip reaches half of its limit.
    limit = soft.compliance * inverse * np.abs(found.reaction).max() / soft.damping
    assert 0.3 * limit < np.abs(mechanism.slip(found.pose, found.twist)).max() < limit
