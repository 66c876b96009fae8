"""pymunk extended where sweeps are dear, and are left for a projection; and blades without a gap."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pymunk
import pytest
from pymunk._chipmunk_cffi import lib

from engines.lagrange import loading
from engines.pymunk import EXTENDED, bare_loop
from engines.pymunk.contraction import Sweeping, contraction_at, contractions
from engines.pymunk.marching import Marching
from engines.pymunk.methods import SETTLED, SKATE_GROOVE_EXTRAPOLATED
from engines.pymunk.projection import Projection
from engines.pymunk.running import record
from reference.forces import Torque
from reference.four_bar.scenes import FreeFourBar
from reference.four_bar.singular_cases import Parallelogram
from reference.n_four_bar import NFourBar
from reference.pendulum.scenes import TenLinks
from reference.skate.sleigh import ChaplyginSleigh
from reference.slider_crank.scenes import DrivenSliderCrank
from reference.wheels.car_and_trailer import CarAndTrailer
from reports.search.mechanisms import mechanism
from tests.present import present

# 0.7 m would be a dead centre.
NEAR = DrivenSliderCrank(offset=0.693)


@pytest.mark.parametrize("scene", [FreeFourBar(), NEAR, NFourBar(duration=0.5, horizon=0.5), CarAndTrailer()])
def test_contractions_of_many_poses_are_those_of_each(scene):
    own = scene.mechanism()
    poses = scene.motion(np.linspace(0.0, scene.duration, 5)).pose
    assert contractions(own, poses) == pytest.approx([contraction_at(own, pose) for pose in poses], abs=1e-12)


def projected_model(own, dt: float = 1e-3):
    return SETTLED.swept_model(own, dt, Sweeping(5, projected=True))


def projection_of(model) -> Projection:
    found = model.repairs[-1]
    assert isinstance(found, Projection)
    return found


def disturbed(own):
    """A model of it that projects, whose bodies were moved by a little and pushed by a lot."""
    model, random = projected_model(own), np.random.default_rng(5)
    for body in model.bodies:
        if body.body_type == pymunk.Body.DYNAMIC:
            x, y = 1e-6 * own.length_scale * random.normal(size=2)
            body.position += (x, y)
            body.velocity += tuple(random.normal(size=2))
            if np.isfinite(body.moment):
                body.angular_velocity += random.normal()
    return model


def twists(model):
    return np.array([(*body.velocity, body.angular_velocity) for body in model.bodies])


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_compiled_and_numpys_projection_are_the_same():
    scenes = (FreeFourBar(), NEAR, Parallelogram(), CarAndTrailer(), NFourBar(loops=10))
    drawn = (
        mechanism(9, number, kinds=("pin", "slot", "skate", "drive", "rod", "gear", "weld")) for number in range(12)
    )
    for own in (*(scene.mechanism() for scene in scenes), *drawn):
        model = disturbed(own)
        projection = projection_of(model)
        change = present(projection._change(projection._state()))
        before = twists(model)
        assert present(projection.marching).project()
        # Rows that nearly depend on others amplify the roundings of both.
        moved = [body.body_type == pymunk.Body.DYNAMIC for body in model.bodies]
        assert np.abs(change).max() > 1e-3
        assert np.abs(twists(model) - before - change)[moved].max() < 1e-9 * np.abs(change).max()


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_near_a_singular_position_both_are_least_squares_by_singular_values():
    # Rows that are nearly dependent: the row system has the square of their condition, and its factor too few digits.
    scene = NFourBar()
    time = scene.singular_times(2.0)[0]
    for away in (0.0, 1e-8, 1e-6):
        model = disturbed(scene.mechanism())
        pose = scene.motion(np.array([time - away])).pose[0]
        for body, (x, y, angle) in zip(model.bodies, pose.tolist(), strict=True):
            body.position, body.angle = (x, y), angle
        projection = projection_of(model)
        change, before = present(projection._change(projection._state())), twists(model)
        assert present(projection.marching).project()
        # Rounding over a smallest singular value of 1e-8.
        assert np.abs(twists(model) - before - change).max() < 1e-6 * np.abs(change).max()


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
@pytest.mark.parametrize("scene", [Parallelogram(), NEAR, NFourBar(loops=3)])
def test_a_projected_motion_is_the_same_without_numba(scene, monkeypatch):
    own = scene.mechanism()
    swept = Sweeping(5, projected=True)
    compiled = record(SETTLED.swept_model(own, 1e-3, swept), 1e-3, 20, 5, raw=True)
    monkeypatch.setattr("engines.pymunk.projection.installed", lambda: False)
    plain = record(SETTLED.swept_model(own, 1e-3, swept), 1e-3, 20, 5, raw=True)
    assert np.abs(compiled.pose - plain.pose).max() < 1e-12
    assert np.abs(compiled.after - plain.after).max() < 1e-10


def test_a_projection_in_a_lost_state_changes_nothing():
    model = projected_model(FreeFourBar().mechanism())
    projection = projection_of(model)
    lib.cpBodySetVelocity(model.bodies[0]._body, (np.inf, 0.0))
    before = twists(model)
    with np.errstate(invalid="ignore"):
        assert projection._change(projection._state()) is None
    if loading.installed():
        assert not present(projection.marching).project()
    assert np.array_equal(twists(model), before)


def test_a_motion_that_is_projected_on_a_part_of_its_way_only_says_so():
    scene = Parallelogram()  # its change points lie ahead: by its start alone the engine would hold the joints
    own = scene.mechanism()
    assert {EXTENDED.holder(joint, own) for joint in own.joints} == {"engine"}
    run = SETTLED.build(own, scene.duration / 120)(10, 12)
    assert any("projected" in words for words in run.warnings)
    assert not SETTLED.build(FreeFourBar().mechanism(), 1e-2)(10, 10).warnings


def test_a_singular_position_is_passed_where_sweeps_would_be_too_many():
    # 83 sweeps left enough there for an angle to be wrong by 1e-4 rad at this step, and by 500 rad at 1e-4 s.
    scene = NFourBar(duration=1.2, horizon=1.2)
    own = scene.mechanism()
    run = EXTENDED.build(own, 1e-2)(24, 5)
    assert run.unresolved_at is None
    assert np.abs(run.pose - scene.motion(run.t).pose).max() < 1e-9
    assert SETTLED.sweeping(own, scene.duration).projected
    assert not replace(SETTLED, projects=False).sweeping(own, scene.duration).projected


def test_sweeps_are_left_alone_where_python_would_have_to_project():
    # A torque is set from Python before every step: a projection takes longer there, and so may the sweeps.
    free = TenLinks().mechanism()
    pushed = replace(free, forces=(Torque("push", None, free.bodies[0].name, 1.0),))
    assert SETTLED.sweeping(free).projected
    assert not SETTLED.sweeping(pushed).projected


def test_a_blade_that_is_aimed_closes_no_gap_and_so_adds_no_noise():
    # It closed what rounding shows of a gap within a step: 1e-16 m in 1e-4 s, and reactions are changes of velocity
    # over a step. They were wrong by 1e-6 N here, and are by 2e-10 N.
    scene = ChaplyginSleigh(duration=3.0, horizon=3.0)
    run = SKATE_GROOVE_EXTRAPOLATED.build(scene.mechanism(), 1e-3)(100, 30)
    right = scene.motion(run.t)
    assert np.abs(run.reaction - right.reaction).max() < 1e-8
    assert np.abs(run.twist - right.twist).max() < 1e-11


@pytest.mark.skipif(not loading.installed(), reason="numba, the extra 'fast', is not installed")
def test_the_bare_loop_takes_the_steps_of_a_run_in_compiled_code_too(monkeypatch):
    taken: list[int] = []
    march = Marching.march

    def counted(self, dt, samples, every, values):
        taken.append(samples * every)
        march(self, dt, samples, every, values)
        assert np.isfinite(values[-6 * 10 :]).all()  # the state after the last step, of ten links

    monkeypatch.setattr(Marching, "march", counted)
    assert bare_loop(EXTENDED, TenLinks().mechanism(), 1e-3, 7) > 0
    assert taken == [7 * level for level in EXTENDED.pins.levels]
