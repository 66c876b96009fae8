"""Slots and chains in pymunk: the groove joint's trap, bodies that keep their angle, and how many sweeps are enough."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pymunk
import pytest
from pymunk.constraints import GrooveJoint

from engines import Promise, Size, Unsupported
from engines.lagrange import TRUTH, Lagrange
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, Pymunk
from engines.pymunk.contraction import LEFT, as_real, contraction, contraction_at, contractions, gain, sweeps
from engines.pymunk.expected import worst_contraction
from reference.joints import Drive, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scene import Scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.person import OneFoot
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.scenes.wheels.car_and_trailer import CarAndTrailer
from reference.trajectory import Trajectory, energy, joint_gap
from reports.search.mechanisms import mechanism
from reports.search.parts import EVERY
from tests.mechanisms import four_bar

every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)
DRIVEN, FREE = DrivenSliderCrank(), FreeSliderCrank()


def largest(values) -> float:
    return float(np.nanmax(np.abs(values)))


def run(engine, scene: Scene, every: int) -> Trajectory:
    return engine.build(scene.mechanism(), scene.spacing / every)(scene.samples, every)


@cache
def truth(scene: Scene) -> Trajectory:
    return scene.motion(np.arange(scene.samples + 1) * scene.spacing)


def rod_in_a_groove() -> Mechanism:
    """The slider-crank without a slider: the end of its rod runs in the slot."""
    scene = DRIVEN.mechanism()
    guide = Slot("guide", None, "rod", (0.0, 0.0), 0.0, (DRIVEN.rod / 2, 0.0))
    return Mechanism(scene.bodies[:2], (*scene.joints[:2], guide, scene.joints[5]), scene.gravity)


@cache
def rod_truth() -> Trajectory:
    return Lagrange("dop853", "projection", 1e-12).build(rod_in_a_groove(), 1e-2)(60, 1)


# Slots


def test_the_driven_slider_crank_extended_reaches_its_goal():
    trajectory = run(EXTENDED, DRIVEN, 10)
    exact = truth(DRIVEN)
    assert largest(trajectory.pose - exact.pose) < 1e-11
    assert largest(trajectory.twist - exact.twist) < 1e-9
    assert largest(trajectory.reaction - exact.reaction) < 1e-7 * largest(exact.reaction)


@pytest.mark.parametrize(("engine", "expected"), [(DEFAULT, 1), (LEAPFROG, 2)], ids=["default", "leapfrog"])
def test_the_driven_slider_crank_has_the_order_of_the_method(engine, expected):
    coarse, fine = (largest(run(engine, DRIVEN, every).pose - truth(DRIVEN).pose) for every in (10, 40))
    assert np.log2(coarse / fine) / 2 == pytest.approx(expected, abs=0.1)


def test_the_free_slider_crank_extended_keeps_its_energy():
    trajectory, mechanism = run(EXTENDED, FREE, 10), FREE.mechanism()
    # h = 1.25e-4 s at up to 15 rad/s, order 6; two seconds.
    assert largest(trajectory.pose - truth(FREE).pose) < 1e-9
    total = energy(mechanism, trajectory)
    assert np.ptp(total) < 1e-8 * largest(total)


def test_a_rod_in_a_groove_joint_is_wrong_at_any_step():
    """cpGrooveJoint solves both directions and keeps one: right only where the normal is an axis of the mass."""
    mechanism, exact = rod_in_a_groove(), rod_truth()
    for every in (1, 10):
        trajectory = replace(DEFAULT, slot="groove").build(mechanism, 1e-2 / every)(60, every)
        assert largest(joint_gap(mechanism, trajectory)) > 0.1  # m, in a mechanism of 1 m
        assert largest(trajectory.pose - exact.pose) > 0.1


def test_a_rod_in_a_slot_is_exact_by_a_pin_joint_across_it():
    mechanism, exact = rod_in_a_groove(), rod_truth()
    trajectory = EXTENDED.build(mechanism, 1e-3)(60, 10)
    assert largest(trajectory.pose - exact.pose) < 1e-10
    assert largest(trajectory.reaction - exact.reaction) < 1e-6 * largest(exact.reaction)
    coarse, fine = (largest(LEAPFROG.build(mechanism, 1e-2 / every)(60, every).pose - exact.pose) for every in (10, 40))
    assert np.log2(coarse / fine) / 2 == pytest.approx(2, abs=0.1)


def test_a_groove_joint_pushes_a_free_body_that_only_slides_along_it():
    """Nothing is violated, and yet the engine gives it a velocity across."""
    space, body = pymunk.Space(), pymunk.Body(1.0, 0.1)
    body.velocity, body.angular_velocity = (1.0, -0.3), 1.0  # of the anchor (0.3, 0.3): (0.7, 0)
    space.add(body, GrooveJoint(space.static_body, body, (-10, 0.3), (10, 0.3), (0.3, 0.3)))
    space.step(1e-9)
    across = body.velocity.y + 0.3 * body.angular_velocity
    assert abs(across) > 0.01


@pytest.mark.parametrize("point", [(0.0, 0.0), (0.2, 0.1)])
@pytest.mark.parametrize("first", [None, "rail"])
def test_a_slot_in_any_body_for_any_point_is_held(point, first):
    rail = Body("rail", 3.0, 1.0, (0.0, 0.0, 0.3), (0.0, 0.0, 0.0))
    line = 0.4 + (0.3 if first else 0.0)
    along = np.array([np.cos(line), np.sin(line)])
    turned = np.array([[np.cos(0.9), -np.sin(0.9)], [np.sin(0.9), np.cos(0.9)]]) @ point
    centre = 0.5 * along - turned
    velocity = 0.7 * along - 1.5 * np.array([-turned[1], turned[0]])
    runner = Body("runner", 1.0, 0.2, (*centre.tolist(), 0.9), (*velocity.tolist(), 1.5))
    mechanism = Mechanism((rail, runner), (Slot("slot", first, "runner", (0.0, 0.0), 0.4, point),), (0.3, -1.0))
    exact = Lagrange("dop853", "projection", 1e-12).build(mechanism, 1e-2)(50, 1)
    trajectory = EXTENDED.build(mechanism, 2e-3)(50, 5)
    assert largest(trajectory.pose - exact.pose) < 1e-9
    assert largest(trajectory.reaction - exact.reaction) < 1e-6 * largest(mechanism.gravity)  # times 1 kg: N


@every_method
def test_a_body_driven_against_the_ground_without_a_pin_turns_exactly(method):
    body = Body("block", 1.0, 0.1, (0.0, 0.0, 0.2), (1.0, 0.0, 2.0))
    joints = (Drive("level", None, "block", 2.0, 0.2), Slot("guide", None, "block", (0.0, 0.0), 0.0, (0.0, 0.0)))
    trajectory = method.build(Mechanism((body,), joints, (0.0, -9.81)), 1e-2)(50, 4)
    assert largest(trajectory.pose[:, 0, 2] - 0.2 - 2.0 * trajectory.t) < 1e-11  # 1600 steps, weighted
    # A slot stops the fall, and nothing stops the slide.
    assert largest(trajectory.pose[-1, 0, 0] - trajectory.t[-1]) < 1e-11


@every_method
def test_what_hangs_on_a_body_that_is_driven_without_a_pin_does_not_turn_it(method):
    block = Body("block", 1.0, 0.1, (0.0, 0.0, 0.0))
    pendulum = Body("pendulum", 2.0, 0.1, (0.8, 0.0, 0.0))
    joints = (
        Drive("level", None, "block", 0.0, 0.0),
        Slot("guide", None, "block", (0.0, 0.0), 0.0, (0.0, 0.0)),
        Pin("hook", "block", "pendulum", (0.3, 0.0), (-0.5, 0.0)),
    )
    trajectory = method.build(Mechanism((block, pendulum), joints, (0.0, -9.81)), 1e-3)(20, 10)
    # The bar falls from level, 0.3 m off the block's middle: its weight would turn the block if it could be turned.
    assert largest(trajectory.pose[:, 0, 2]) < 1e-12
    assert largest(trajectory.pose[-1, 1, 2]) > 0.1


def test_a_second_drive_of_a_body_that_can_only_turn_as_driven_is_refused():
    body = Body("block", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    joints = (Drive("one", None, "block", 0.0, 0.0), Drive("two", None, "block", 0.0, 0.0))
    with pytest.raises(Unsupported, match="'two' joins two bodies whose motion is already prescribed"):
        TUNED.build(Mechanism((body,), joints), 1e-3)


def test_no_more_is_built_than_the_slider_crank_has():
    # The crank's pin and drive and the block's angle are motions; two pins and a groove are left.
    size = TUNED.build(DRIVEN.mechanism(), 1e-3).size
    assert size == Size(bodies=3, coordinates=9, rows=5, solver_rows=5)


# Chains


@pytest.mark.parametrize("links", [2, 3, 10, 40, 80])
def test_sweeps_over_a_chain_of_equal_links_converge_as_a_relaxation_does(links):
    rho = contraction(LinkPendulum(links=links).mechanism())
    # cos^2 of half the step of the slowest wave on a chain held at one end.
    assert rho == pytest.approx(math.cos(math.pi / (2 * links)) ** 2, abs=1e-6)


def test_sweeps_are_counted_for_the_joints_that_forces_must_find():
    assert contraction(LinkPendulum(links=1).mechanism()) == 0  # one joint feels no other
    driven, free = (contraction(four_bar(10.0, drive=drive)) for drive in (10.0, None))
    assert driven < free < 1
    # A hundredfold mass on a light link converges a hundred times slower.
    assert 1 - contraction(LinkPendulum(tip=100.0).mechanism()) == pytest.approx(0.01, rel=0.05)


def test_sweeps_are_counted_for_the_worst_pose_of_the_motion():
    """The free four-bar of the chapter folds on its way: there 0.81 is left by a sweep, at its start 0.59."""
    scene = FreeFourBar()
    mechanism = scene.mechanism()
    passed = scene.motion(np.linspace(0, scene.duration, 200)).pose
    worst = max(contraction_at(mechanism, pose) for pose in passed)
    assert sweeps(contraction(mechanism)) < sweeps(worst)
    # A rough run of soft joints looks at some poses, beside those of the motion: it may count one sweep more or less.
    assert abs(sweeps(worst_contraction(mechanism, scene.duration)) - sweeps(worst)) <= 1
    assert worst_contraction(mechanism, 0.0) == contraction(mechanism)
    assert LEAPFROG.sweeping(mechanism, scene.duration).iterations > LEAPFROG.sweeping(mechanism).iterations
    assert LEAPFROG.sweeping(mechanism, scene.duration).gain == 1


def test_the_gain_is_all_with_enough_sweeps_and_less_in_proportion_to_what_is_missing():
    rho = contraction(TenLinks().mechanism())
    assert gain(rho, sweeps(rho)) == 1
    assert gain(rho, 2) < gain(rho, 10) < 1
    assert sweeps(0.0) == 5
    assert sweeps(1 - 1e-9) == 300


@pytest.mark.parametrize("iterations", [2, 5, 10])
def test_the_gain_by_rule_is_stable_and_closing_all_of_a_gap_with_as_few_sweeps_feeds_energy_in(iterations):
    mechanism, dt = TenLinks().mechanism(), 1e-3

    def gained(closed: float) -> float:
        engine = Pymunk("mine", iterations=iterations, error_bias=(1 - closed) ** (1 / dt), leapfrog=True)
        return float(np.ptp(energy(mechanism, engine.build(mechanism, dt)(300, 10))))

    # J; the ten links of 1 kg and 1 m fall by 5 m: about 490 J turn from potential to kinetic.
    assert gained(gain(contraction(mechanism), iterations)) < 1
    assert gained(1.0) > 500


def kept_impulses(left: complex) -> float:
    """How gap, velocity and kept impulse of a mode grow in a step that closes all of the gap; sweeps leave `left`."""
    change = [[1, 1, 0], [left - 1, 2 * left - 1, left], [left - 1, 2 * left - 2, left]]
    return float(np.abs(np.linalg.eigvals(np.array(change))).max())


@pytest.mark.parametrize("angle", [0.0, 1e-4, 0.01, 0.04, 0.3, 1.0, 3.0])
@pytest.mark.parametrize("size", [0.5, 0.9, 0.99])
def test_of_a_complex_mode_so_many_sweeps_are_made_that_half_of_what_is_stable_is_left(size, angle):
    mode = size * np.exp(1j * angle)
    count = math.log(LEFT) / math.log(as_real(np.array([mode]))[0])
    turned = min(count * angle, math.pi)
    left = size**count * np.exp(1j * turned)
    assert kept_impulses(1.99 * left) < 1
    assert kept_impulses(2.02 * left) > 1
    # With whole numbers of sweeps, and more of them, it stays stable: the angle goes on, and what is left falls.
    assert all(kept_impulses(mode**more) < 1 for more in range(math.ceil(count), 3 * math.ceil(count)))


@pytest.mark.parametrize("number", [239, 255, 266])
def test_a_weld_among_other_joints_does_not_blow_up_however_short_steps_are_and_where_it_does_nothing_is_promised(
    number,
):
    """Their modes are complex: swept as if these were real, 255 missed its motion by a thousandfold of it."""
    own = mechanism(77777, number, EVERY)
    span = 0.4 * own.time_scale
    truth = TRUTH.build(own, span)(1, 1)

    def missed(engine: Pymunk, steps: int) -> float:
        return largest(engine.build(own, span / steps)(1, steps).pose[-1] - truth.pose[-1])

    assert missed(TUNED, 640) < 0.3 * missed(TUNED, 160)
    assert isinstance(TUNED.order(own), Promise)
    assert isinstance(DEFAULT.order(own), Promise) == (missed(DEFAULT, 640) < missed(DEFAULT, 160))


def test_a_small_gain_does_not_underflow_to_a_gain_of_one_at_small_steps():
    """0.95 ** (1/dt) is zero as a double at dt = 1e-5 s, and zero closes all of a gap: the unit of time is the step."""
    assert 0.9 ** (1 / 1e-5) == 0
    heavy = LinkPendulum(tip=1e4)
    model = LEAPFROG.model(heavy.mechanism(), 1e-5)
    rho = contraction(heavy.mechanism())
    assert model.unit == 1e-5
    assert next(iter(model.space.constraints)).error_bias == pytest.approx(1 - gain(rho, 300), rel=1e-12)
    assert model.space.gravity == pytest.approx((0.0, -9.81e-10), rel=1e-12)


def test_units_of_time_change_no_motion():
    """The same method in seconds and in steps, at a gain that both can express."""
    mechanism = replace(LinkPendulum(tip=1e4), rate=0.5).mechanism()
    rho = contraction(mechanism)
    seconds = Pymunk("mine", 300, (1 - gain(rho, 300)) ** (1 / 1e-2), leapfrog=True)
    one, other = (engine.build(mechanism, 1e-2)(20, 2) for engine in (seconds, LEAPFROG))
    for quantity in ("pose", "twist"):
        assert largest(getattr(one, quantity) - getattr(other, quantity)) < 1e-9
    assert any("not converged, 300 sweeps leave 97%" in warning for warning in other.warnings)


@pytest.mark.parametrize(
    ("links", "every", "goal"), [(1, 3, 5e-12), (2, 5, 5e-12), (10, 10, 1e-10)], ids=["1", "2", "10"]
)
def test_chains_extended_reach_their_goals(links, every, goal):
    scene = LinkPendulum(links=links, duration=1.0, horizon=1.0)
    trajectory, exact = run(EXTENDED, scene, every), truth(scene)
    assert largest(trajectory.pose - exact.pose) < goal * (1 + links / 10)  # m at the tip, of `links` metres
    assert largest(trajectory.reaction - exact.reaction) < 1e-6 * largest(exact.reaction)


def test_a_hundred_links_are_reported_as_not_converged_and_stay_together():
    scene = LinkPendulum(links=100, length=0.01, mass=0.01, duration=0.2, horizon=0.2)
    trajectory = run(LEAPFROG, scene, 10)
    assert any("not converged" in warning for warning in trajectory.warnings)
    assert largest(joint_gap(scene.mechanism(), trajectory)) < 1e-3  # m, of 1 m
    assert largest(trajectory.pose[:, -1, :2] - truth(scene).pose[:, -1, :2]) < 1e-2


@every_method
def test_heavy_bodies_on_light_ones_hold_together_by_the_same_rule(method):
    scene = OneFoot()
    trajectory, exact = run(method, scene, 3), truth(scene)
    assert largest(trajectory.pose - exact.pose) < {DEFAULT: 0.02, TUNED: 0.02, LEAPFROG: 1e-3, EXTENDED: 1e-5}[method]


def test_a_fixed_number_of_sweeps_would_have_torn_them():
    engine = Pymunk("mine", iterations=5, error_bias=0.0, leapfrog=True)
    assert largest(run(engine, OneFoot(), 10).pose - truth(OneFoot()).pose) > 0.1


def test_n_four_bars_are_exact_until_they_are_singular():
    scene = NFourBar(loops=2, duration=0.6, horizon=0.6)
    trajectory = run(EXTENDED, scene, 5)
    assert largest(trajectory.pose - truth(scene).pose) < 1e-8


@every_method
@pytest.mark.parametrize("mass", [1e-300, 1e300])
def test_masses_too_far_apart_for_numbers_are_a_result_and_not_an_exception(method, mass):
    mechanism = LinkPendulum().mechanism()
    odd = replace(mechanism, bodies=(mechanism.bodies[0], replace(mechanism.bodies[1], mass=mass, inertia=mass)))
    with np.errstate(all="ignore"):
        assert method.build(odd, 1e-3)(5, 2).pose.shape == (6, 2, 3)


@pytest.mark.parametrize(
    "scene",
    [FreeFourBar(), DrivenSliderCrank(offset=0.693), NFourBar(duration=0.5, horizon=0.5), CarAndTrailer()],
    ids=lambda scene: scene.name,
)
def test_contractions_of_many_poses_are_those_of_each(scene):
    own = scene.mechanism()
    poses = scene.motion(np.linspace(0.0, scene.duration, 5)).pose
    assert contractions(own, poses) == pytest.approx([contraction_at(own, pose) for pose in poses], abs=1e-12)
