"""How many steps stand for one: when rough runs are made, what they cost, and when no more of them are tried."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from engines import finer
from engines.finer import Division, division, tells_itself
from engines.pymunk import EXTENDED
from engines.pymunk.methods import SETTLED
from reference.mechanism import Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reference.trajectory import Trajectory
from tests.mechanisms import pendulum
from tests.toys import Toy

ORDER = 4.0


def run_with(estimate: float, mechanism: Mechanism, duration: float = 1.0, samples: int = 16) -> Trajectory:
    """A motion at rest whose estimate is this many radians, everywhere."""
    t = np.linspace(0.0, duration, samples + 1)
    still = np.zeros((samples + 1, len(mechanism.bodies), 3))
    reaction = np.zeros((samples + 1, mechanism.row_count))
    return Trajectory(t, still, still, reaction, estimate=np.full_like(still, estimate) * [0, 0, 1])


def losing(losses: dict[int, float], mechanism: Mechanism, asked: list[int]):
    """Builds rough runs that lose so much in a time scale, by how many times as fine they are."""
    duration = 0.5 * mechanism.time_scale
    roughest = 0

    def build(dt: float):
        def run(samples: int, every: int) -> Trajectory:
            nonlocal roughest
            roughest = roughest or every
            asked.append(every // roughest)
            lost = losses[every // roughest] * duration / mechanism.time_scale
            return run_with(lost, mechanism, duration, samples)

        return run

    return division(Toy("rough"), build, mechanism, duration, ORDER)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("losses", "asked", "steps"),
    [
        ({1: 1e-7}, [1], 1),  # a usual motion
        ({1: 1e-2, 4: 1e-4}, [1, 4], 13),  # 4 (1e-4 / 1e-6)^(1/4), rounded up
        ({1: 5.0, 4: 9.0, 16: 1e-5}, [1, 4, 16], 29),  # too fast to be followed, until the steps are short enough
        ({1: 1e-3, 4: 9.0}, [1, 4], 1),  # it seemed to be followed, and is lost by finer steps: no series in the step
    ],
)
def test_rough_runs_become_finer_for_as_long_as_that_can_help(losses, asked, steps):
    made: list[int] = []
    found = losing(losses, pendulum(), made)
    assert made == asked
    assert found.steps == steps


def test_a_run_tells_itself_if_its_estimate_is_small_at_the_rough_step_too():
    own = pendulum()
    duration = 0.5 * own.time_scale
    rough = duration / finer.FEWEST
    small = finer.USUAL * duration / own.time_scale
    assert tells_itself(run_with(0.9 * small, own, duration), own, rough, ORDER)
    assert not tells_itself(run_with(1.1 * small, own, duration), own, rough, ORDER)
    # With half the step an order of four leaves a sixteenth, and longer steps than the rough ones are no excuse.
    assert tells_itself(run_with(0.9 * small / 16, own, duration), own, rough / 2, ORDER)
    assert not tells_itself(run_with(1.1 * small / 16, own, duration), own, rough / 2, ORDER)
    assert not tells_itself(run_with(1.1 * small, own, duration), own, 2 * rough, ORDER)


def test_a_usual_motion_makes_no_rough_run(monkeypatch):
    def refuse(*_):
        raise AssertionError("a rough run was made")

    monkeypatch.setattr(finer, "_found", refuse)
    own = FreeFourBar().mechanism()
    found = EXTENDED.build(own, 1e-3)(10, 10)
    assert found.estimate is not None
    assert found.estimate.max() < 1e-9


def test_what_a_rough_run_takes_is_part_of_the_stepping(monkeypatch):
    own = FreeFourBar().mechanism()
    monkeypatch.setattr("engines.extrapolated.tells_itself", lambda *_: False)
    monkeypatch.setattr("engines.extrapolated.division", lambda *_: Division(1, 7.0))
    assert EXTENDED.build(own, 1e-3)(2, 5).stepping > 7.0
    # And what was run before the steps were divided.
    monkeypatch.setattr("engines.extrapolated.division", lambda *_: Division(2, 0.0))
    divided = EXTENDED.build(own, 1e-3)(2, 5)
    plain = replace(EXTENDED, pins=replace(EXTENDED.pins, divides=False)).build(own, 0.5e-3)(2, 10)
    assert np.array_equal(divided.pose, plain.pose)
    assert divided.t[-1] == pytest.approx(plain.t[-1])


def test_rough_runs_are_made_and_counted_for_each_motion_anew():
    made: list[int] = []
    own = pendulum()
    found = [losing({1: 1e-2, 4: 1e-4}, own, made) for _ in range(2)]
    assert made == [1, 4, 1, 4]
    assert all(one.seconds > 0 for one in found)


def test_what_goes_wrong_in_a_rough_run_is_heard():
    def build(dt: float):
        raise RuntimeError("a fault of ours")

    with pytest.raises(RuntimeError, match="a fault of ours"):
        division(Toy("rough"), build, pendulum(), 0.1, ORDER)  # type: ignore[arg-type]


def test_no_rough_run_is_made_where_the_worst_pose_of_the_motion_makes_its_steps_too_dear():
    own = pendulum()
    duration = 0.5 * own.time_scale
    least = {"cost": 0.0}

    class Later(Toy):
        def step_cost_within(self, mechanism: Mechanism, duration: float) -> float:
            return least["cost"]

    def refuse(dt: float):
        raise AssertionError("a rough run was made")

    least["cost"] = 1.1 * finer.DEAREST / finer.FEWEST
    assert division(Later("dear"), refuse, own, duration, ORDER).steps == 1
    least["cost"] = 0.9 * finer.DEAREST / finer.FEWEST
    with pytest.raises(AssertionError, match="was made"):
        division(Later("cheap"), refuse, own, duration, ORDER)


def test_pymunks_steps_cost_more_in_a_motion_that_meets_a_singular_position():
    scene = DrivenSliderCrank(offset=0.693)  # a dead centre is a hundredth away
    own = scene.mechanism()
    engine = EXTENDED.pins
    assert engine.step_cost_within(own, 1e-3) == pytest.approx(engine.step_cost(own), rel=0.5)
    assert engine.step_cost_within(own, scene.duration) > 20 * engine.step_cost(own)
    levels = sum(engine.levels)
    assert engine.step_cost_within(own, 0.1) == pytest.approx(levels * SETTLED.step_cost_within(own, 0.1))


def test_durations_that_differ_by_rounding_are_one(monkeypatch):
    own, duration = FreeFourBar().mechanism(), 0.3
    assert duration != 3 * 0.1
    asked: list[int] = []
    monkeypatch.setattr("engines.pymunk.expected._poses", lambda *_: asked.append(1) or [])
    assert SETTLED.sweeping(own, 3 * 0.1) == SETTLED.sweeping(own, duration)
    assert asked == [1]
