"""pymunk extended where sweeps are dear: planned along the way, or left for a projection; and blades without a gap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines.lagrange import loading
from engines.pymunk import EXTENDED
from engines.pymunk.contraction import Sweeping, contraction_at, contractions
from engines.pymunk.engine import Pymunk
from engines.pymunk.methods import SETTLED, SKATE_GROOVE_EXTRAPOLATED
from engines.pymunk.planned import BUSY, planned
from engines.pymunk.projection import Projection
from engines.pymunk.running import record
from reference.four_bar.scenes import FreeFourBar
from reference.four_bar.singular_cases import Parallelogram
from reference.n_four_bar import NFourBar
from reference.skate.sleigh import ChaplyginSleigh
from reference.slider_crank.scenes import DrivenSliderCrank
from reference.wheels.car_and_trailer import CarAndTrailer
from reports.search.mechanisms import mechanism
from tests.present import present

# 0.7 m would be a dead centre.
NEAR = DrivenSliderCrank(offset=0.693)
SAMPLES, MOST = 63, 1500


def planned_along(trajectory, most: int = MOST):
    return planned(NEAR.mechanism(), trajectory, most, SETTLED.fewest, SETTLED.work)


def truth():
    return NEAR.motion(np.linspace(0.0, NEAR.duration, SAMPLES + 1))


def test_many_sweeps_are_planned_near_a_singular_position_and_few_elsewhere():
    told = truth()
    found = np.array(present(planned_along(told)))
    contraction_there = np.array([contraction_at(NEAR.mechanism(), pose) for pose in told.pose])
    worst = int(contraction_there.argmax())
    assert len(found) == SAMPLES
    assert found.max() == found[worst - 1] == found[min(worst, SAMPLES - 1)]
    assert 1000 < found.max() <= MOST
    assert np.median(found) < 60
    assert found.sum() < 0.2 * SAMPLES * MOST


def test_nothing_is_planned_where_nothing_is_won_or_the_way_is_not_known():
    told, own = truth(), NEAR.mechanism()
    assert planned_along(told, BUSY // len(own.joints)) is None
    assert planned_along(told, BUSY // len(own.joints) + 1) is not None
    lost, torn = told.pose.copy(), told.pose.copy()
    lost[-1, 0, 0] = np.nan
    torn[5, 0, 0] += 0.2 * own.length_scale
    assert planned_along(replace(told, pose=lost)) is None
    assert planned_along(replace(told, pose=torn)) is None


def test_a_planned_run_is_as_good_as_one_with_the_most_sweeps_throughout(monkeypatch):
    own, dt = NEAR.mechanism(), NEAR.duration / SAMPLES / 3
    made: list[int] = []

    def counted(*arguments):
        found = planned(*arguments)
        made.append(sum(found or ()))
        return found

    monkeypatch.setattr("engines.pymunk.engine.planned", counted)
    short = EXTENDED.build(own, dt)(SAMPLES, 3)
    most = SETTLED.sweeping(own, NEAR.duration).iterations
    assert len(made) == 4  # the coarsest of five runs tells the way
    assert len(set(made)) == 1
    assert made[0] < 0.3 * SAMPLES * most
    monkeypatch.setattr(Pymunk, "_planned", lambda *_: None)
    whole = EXTENDED.build(own, dt)(SAMPLES, 3)
    right = NEAR.motion(short.t).pose
    errors = [np.abs(run.pose - right).max() for run in (short, whole)]
    assert errors[0] < 1.1 * errors[1] + 1e-12


def test_sweeps_change_at_samples():
    # As if each part were a run of its own: what a step of few sweeps leaves is what many then find.
    scene = NFourBar(duration=0.5, horizon=0.5)
    own, dt = scene.mechanism(), 5e-3
    few, many = (record(SETTLED.swept_model(own, dt, Sweeping(count)), dt, 6, 4, raw=True) for count in (5, 50))
    both = record(SETTLED.swept_model(own, dt, Sweeping(5)), dt, 6, 4, raw=True, planned=(5, 5, 5, 50, 50, 50))
    assert np.array_equal(both.pose[:4], few.pose[:4])
    assert not np.array_equal(both.pose[4:], few.pose[4:])
    assert np.abs(both.after[-1] - many.after[-1]).max() < np.abs(few.after[-1] - many.after[-1]).max()


@pytest.mark.parametrize("scene", [FreeFourBar(), NEAR, NFourBar(duration=0.5, horizon=0.5), CarAndTrailer()])
def test_contractions_of_many_poses_are_those_of_each(scene):
    own = scene.mechanism()
    poses = scene.motion(np.linspace(0.0, scene.duration, 5)).pose
    assert contractions(own, poses) == pytest.approx([contraction_at(own, pose) for pose in poses], abs=1e-12)


def projection_of(own, dt: float = 1e-3) -> Projection:
    found = SETTLED.swept_model(own, dt, Sweeping(5, projected=True)).repairs[-1]
    assert isinstance(found, Projection)
    return found


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_compiled_and_numpys_projection_are_the_same():
    random = np.random.default_rng(5)
    scenes = (FreeFourBar(), NEAR, Parallelogram(), CarAndTrailer())
    drawn = (
        mechanism(9, number, kinds=("pin", "slot", "skate", "drive", "rod", "gear", "weld")) for number in range(12)
    )
    for own in (*(scene.mechanism() for scene in scenes), *drawn):
        projection = projection_of(own)
        state = projection._state()
        state[:, 3:] += random.normal(size=state[:, 3:].shape)
        state[:, :3] += 1e-6 * own.length_scale * random.normal(size=state[:, :3].shape)
        by_numpy = present(projection._change(state))
        by_machine = present(present(projection._compiled)(state))
        assert np.abs(by_numpy).max() > 1e-3
        # Both are least squares by singular values; rows that nearly depend on others amplify their roundings.
        assert np.abs(by_machine - by_numpy).max() < 1e-9 * np.abs(by_numpy).max()


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_a_projected_motion_is_the_same_without_numba(monkeypatch):
    own = Parallelogram().mechanism()
    swept = Sweeping(5, projected=True)
    compiled = record(SETTLED.swept_model(own, 1e-3, swept), 1e-3, 20, 5, raw=True)
    monkeypatch.setattr("engines.pymunk.projection.installed", lambda: False)
    plain = record(SETTLED.swept_model(own, 1e-3, swept), 1e-3, 20, 5, raw=True)
    assert np.abs(compiled.pose - plain.pose).max() < 1e-12
    assert np.abs(compiled.after - plain.after).max() < 1e-10


def test_a_projection_in_a_lost_state_changes_nothing():
    projection = projection_of(FreeFourBar().mechanism())
    state = projection._state()
    state[0, 3] = np.inf
    with np.errstate(invalid="ignore"):
        assert projection._change(state) is None
    if loading.installed():
        assert present(projection._compiled)(state) is None


def test_a_motion_that_is_projected_on_a_part_of_its_way_only_says_so():
    scene = Parallelogram()  # its change points lie ahead: by its start alone the engine would hold the joints
    own = scene.mechanism()
    assert {EXTENDED.holder(joint, own) for joint in own.joints} == {"engine"}
    run = SETTLED.build(own, scene.duration / 120)(10, 12)
    assert any("projected" in words for words in run.warnings)
    assert not SETTLED.build(FreeFourBar().mechanism(), 1e-2)(10, 10).warnings


def test_a_blade_that_is_aimed_closes_no_gap_and_so_adds_no_noise():
    # It closed what rounding shows of a gap within a step: 1e-16 m in 1e-4 s, and reactions are changes of velocity
    # over a step. They were wrong by 1e-6 N here, and are by 2e-10 N.
    scene = ChaplyginSleigh(duration=3.0, horizon=3.0)
    run = SKATE_GROOVE_EXTRAPOLATED.build(scene.mechanism(), 1e-3)(100, 30)
    right = scene.motion(run.t)
    assert np.abs(run.reaction - right.reaction).max() < 1e-8
    assert np.abs(run.twist - right.twist).max() < 1e-11
