"""What methods claim of themselves near a singular position, where runs at all steps may be wrong alike."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import CLAIM, Engine
from engines.constraint_error import FORCES, closing, displaced_reaction, reaction_doubts
from engines.lagrange import TRUTH
from engines.mujoco import EXTENDED as MUJOCO
from engines.pymunk import EXTENDED as PYMUNK
from reference.forces import Spring
from reference.joints import Pin, Rod
from reference.mechanism import Mechanism
from reports.search.claims import CLAIMED, REPORTED, compared
from reports.search.subjects import CLAIMS, Adapted
from tests.mechanisms import bar, pendulum
from tests.present import present

DT, STEPS = 2e-3, 100


def toggle(miss: float) -> Mechanism:
    """A bar on a pin of the ground, and another bar on it that falls. A strut to the ground holds the first: its line
    misses the pin by `miss` [m], so that its force is torque / miss, and no motion of the first bar is exact.
    """
    bars = bar("held", (0.0, 0.0), (1.0, 0.0)), bar("falling", (1.0, 0.0), (1.6, 0.3))
    arm = float(np.hypot(0.6, 0.3)) / 2
    joints = (
        Pin("A", None, "held", (0.0, 0.0), (-0.5, 0.0)),
        Pin("B", "held", "falling", (0.5, 0.0), (-arm, 0.0)),
        Rod("strut", None, "held", (-0.7, miss), (0.1, miss), 1.3),
    )
    return Mechanism(bars, joints, (0.0, -9.81))


@pytest.mark.parametrize(
    ("engine", "miss"),
    [*((MUJOCO, miss) for miss in (3e-7, 1e-6, 2e-6, 5e-6, 1e-4, 1e-2)), *((PYMUNK, miss) for miss in (1e-6, 1e-2))],
    ids=lambda value: getattr(value, "name", str(value)),
)
def test_a_held_bar_that_moves_by_more_than_is_claimed_is_reported_before(engine: Engine, miss: float):
    own = toggle(miss)
    run = engine.build(own, DT)(STEPS, 1)
    moved = np.abs(run.pose[:, 0] - own.pose[0]).max(axis=1)
    claimed = run.t < (np.inf if run.unresolved_at is None else run.unresolved_at)
    assert moved[claimed].max(initial=0.0) <= CLAIM
    if moved.max() <= CLAIM / 10 and engine is MUJOCO:
        assert run.unresolved_at is None


def test_reactions_that_a_displacement_changes_are_reported():
    # Both poses below are right to the claim. The strut's force is the torque over the miss, which the displacement of
    # the first one changes by some percent.
    for miss, told in ((5e-6, True), (1e-3, False)):
        own = toggle(miss)
        run, truth = MUJOCO.build(own, DT)(10, 1), TRUTH.build(own, DT)(10, 1)
        off = np.abs(run.reaction - truth.reaction)[1:].max() / np.abs(truth.reaction).max()
        assert np.abs(run.pose - truth.pose).max() < CLAIM
        assert (off > FORCES) == told
        assert any("reactions are resolved" in words for words in run.warnings) == told


def test_the_displacement_that_closes_gaps_leads_back_whatever_the_masses():
    own = toggle(1e-3)
    heavy = replace(own, bodies=(own.bodies[0], replace(own.bodies[1], mass=1e6)))
    for each in (own, heavy):
        pose = np.repeat(each.pose[None], 3, axis=0)
        pose[1:, 0, 2] += 1e-7  # the first bar turned about its own centre
        t = np.arange(3.0)
        moved = closing(each, t, pose)
        assert np.abs(each.gap(pose + moved, t)).max() < 1e-3 * np.abs(each.gap(pose, t)).max()
        assert np.abs(moved[0]).max() < 1e-12  # rounding of the start, over the miss
        assert not closing(each, t, np.full_like(pose, np.nan)).any()


def test_reactions_at_a_displaced_pose_are_those_that_give_the_same_accelerations():
    own = pendulum()
    change = np.array([[[0.3, -2.0, 1.0]]])
    pose, moved = own.pose[None], np.full((1, 1, 3), 1e-3)
    force = own.reactions_of(pose, change, own.inertias)
    pulled = np.einsum("tr,trc->tc", force, own.rows(pose)).reshape(pose.shape) / own.inertias
    expected = own.reactions_of(pose + moved, pulled, own.inertias)
    assert displaced_reaction(own, pose, force, moved) == pytest.approx(expected, rel=1e-12)
    assert displaced_reaction(own, pose, force, 0 * moved) == pytest.approx(force, rel=1e-9)


def test_the_search_counts_a_silent_error_as_a_fault_and_a_report_of_a_right_motion_not():
    own = pendulum()
    truth = TRUTH.build(own, DT)(STEPS, 1)
    right = replace(truth, estimate=np.zeros_like(truth.pose))
    wrong = replace(right, pose=truth.pose + np.linspace(0, 2 * CLAIM, STEPS + 1)[:, None, None] * [0.0, 0.0, 1.0])
    for run, error in ((right, 0.0), (wrong, 2 * CLAIM), (replace(wrong, unresolved_at=DT * STEPS * 0.4), 0.8 * CLAIM)):
        found, bound = compared(own, run, truth)[CLAIMED]
        assert found == pytest.approx(error, abs=2 * CLAIM / STEPS)
        assert bound == CLAIM
    assert compared(own, replace(right, unresolved_at=0.0), truth)[REPORTED] == (1.0, 1.0)
    assert REPORTED not in compared(own, wrong, truth)


def test_claims_are_asked_of_methods_with_an_estimate_alone():
    asked = Adapted(MUJOCO), Adapted(MUJOCO.within(pendulum()))
    case = asked[0].draw(5, 1, ("pin", "spring", "toggle", "fold"), 0)
    assert CLAIMED in asked[0].ask(case, 1, (CLAIMS,)).errors
    assert "no estimate" in Adapted(replace(MUJOCO, estimates=False)).ask(case, 1, (CLAIMS,)).not_asked[0]
    assert present(MUJOCO.build(pendulum(), DT)(STEPS, 1).estimate).max() < CLAIM


def test_an_error_of_a_force_is_counted_in_the_largest_force_and_not_in_that_of_a_stiff_spring_which_does_not_pull():
    own = pendulum()
    x, y, _ = own.pose[0]
    stiff = replace(own, forces=(Spring("s", None, "bar", (float(x), float(y) + 1.0), (0.0, 0.0), 1e8, 1.0),))
    heaviest = own.bodies[0].mass * stiff.length_scale / stiff.time_scale**2
    pose, twist = stiff.pose[None], stiff.twist[None]
    force = np.full((1, stiff.row_count), 10.0)
    assert heaviest > 1e4 * force.max()
    assert reaction_doubts(stiff, pose, twist, force, 0.01 * force)
    assert not reaction_doubts(stiff, pose, twist, force, FORCES / 2 * force)
