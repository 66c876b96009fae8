"""The pymunk adapter: what it builds, at which instant it reads, what it refuses in a sentence and leaves behind.

Which order and error each method reaches stands in `test_matrix`.
"""

from __future__ import annotations

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pymunk
import pytest
from numpy.typing import NDArray
from pymunk import constraints
from pymunk._chipmunk_cffi import lib

from engines import Size, Unsupported
from engines.extrapolated import Extrapolated
from engines.lagrange import TRUTH, Lagrange
from engines.pymunk import DEFAULT, EXTENDED, LEAPFROG, METHODS, TUNED, bare_loop
from engines.pymunk.methods import AIMED, SETTLED, SKATES
from engines.pymunk.running import Recorder
from reference.joints import Drive, Joint, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.pendulum.scenes import LinkPendulum, TenLinks
from reference.scenes.rolling.scenes import RollingEllipse, RollingOnCircle
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from tests import ROOT
from tests.engines.test_matrix import elbow
from tests.mechanisms import bar, four_bar, pendulum

FREE, MOVING, DRIVEN = four_bar(), four_bar(10.0), four_bar(10.0, drive=10.0)
every_method = pytest.mark.parametrize("method", METHODS, ids=lambda method: method.variant)


def largest(values: NDArray[np.float64]) -> float:
    return float(np.abs(values).max())


def test_the_default_is_the_engine_as_shipped():
    space, body = pymunk.Space(), pymunk.Body(1, 1)
    pivot = constraints.PivotJoint(space.static_body, body, (0, 0), (0, 0))
    assert space.iterations == DEFAULT.iterations == 10
    assert pivot.error_bias == DEFAULT.error_bias == pytest.approx(0.9**60, rel=1e-5)  # it rounds 0.1 to single


@every_method
def test_no_more_is_built_than_the_mechanism_has(method):
    assert method.build(FREE, 1e-3).size == Size(bodies=3, coordinates=9, rows=8, solver_rows=8)
    # The crank's pin and drive are its motion: only three pins are left to forces.
    assert method.build(DRIVEN, 1e-3).size == Size(bodies=3, coordinates=9, rows=6, solver_rows=6)
    assert method.build(elbow(), 1e-3).size == Size(bodies=2, coordinates=6, rows=5, solver_rows=5)
    # The crank's pin and drive and the block's angle are motions; two pins and a groove are left.
    assert method.build(DrivenSliderCrank().mechanism(), 1e-3).size == Size(3, 9, 5, 5)


@pytest.mark.parametrize("grounded_first", [True, False])
def test_a_crank_turns_about_its_pin_whatever_the_order_of_its_joints(grounded_first):
    centre, rate, own = np.array([2.0, -1.0]), -3.0, (0.3, 0.1)
    angle = 0.7
    arm = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]) @ own
    position, velocity = centre - arm, -rate * np.array([-arm[1], arm[0]])
    (x, y), (along, up) = map(float, position), map(float, velocity)
    body = Body("crank", 2.0, 0.5, (x, y, angle), (along, up, rate))
    joints = (
        (Pin("A", None, "crank", (2.0, -1.0), own), Drive("drive", None, "crank", rate, angle))
        if grounded_first
        else (Drive("drive", "crank", None, -rate, -angle), Pin("A", "crank", None, own, (2.0, -1.0)))
    )
    mechanism = Mechanism((body,), joints, (0.0, -9.81))
    for method in METHODS:
        trajectory = method.build(mechanism, 1e-2)(30, 3)
        # Rounding: the angle is a sum of at most 720 steps near one radian, weighted by less than 100 if extrapolated.
        assert largest(mechanism.gap(trajectory.pose, trajectory.t)) < 1e-12
        assert largest(mechanism.slip(trajectory.pose, trajectory.twist)) < 1e-12
        # The pin carries weight and centripetal force, and the drive the moment of the weight about the pin.
        swing = trajectory.pose[:, 0, :2] - centre
        sign = 1 if grounded_first else -1
        order = [0, 1, 2] if grounded_first else [1, 2, 0]
        force = sign * 2.0 * (-(rate**2) * swing + [0, 9.81])
        torque = sign * 2.0 * 9.81 * swing[:, 0]
        error = np.abs(trajectory.reaction[:, order] - np.column_stack([force, torque]))
        assert error[1:].max() < 1e-9  # rounding
        # Before the first sample no step lies: there stands the third step's force, 0.09 rad on, or what the third and
        # fourth extrapolate to, 6 (rate dt)^2 of the force away, or that extrapolated, with a fifth of the step.
        assert error[0].max() < {DEFAULT: 0.09, TUNED: 0.09, LEAPFROG: 6e-3, EXTENDED: 1e-9}[method] * 2.0 * 9.81


def test_bodies_are_recorded_in_the_order_asked_for_whatever_the_order_in_which_c_visits_them():
    model = DEFAULT.model(four_bar(), 1e-3)
    told = []
    for bodies in (model.bodies, model.bodies[::-1]):
        recorder = Recorder(model.space, bodies, 2, 0)
        for _ in range(2):
            lib.cpSpaceEachBody(model.space._space, recorder.visitor, recorder.states)
        told.append(recorder.read(1, with_velocities=False)[0])
    np.testing.assert_array_equal(told[0], told[1][:, ::-1])
    np.testing.assert_array_equal(told[0][0, :, :3], four_bar().pose)


def test_a_velocity_read_at_the_wrong_instant_would_be_seen():
    """What the engine holds in a leapfrog is half a step ahead; taken for the velocity now, it is first order."""
    model = LEAPFROG.model(pendulum(), 1e-3)
    model.kick(0.5e-3)
    for _ in range(500):
        model.space.step(1e-3)
    exact = TRUTH.build(pendulum(), 0.5)(1, 1)
    rate, acceleration = exact.twist[1, 0, 2], -1.5 * 9.81 * np.cos(exact.pose[1, 0, 2])
    held = model.bodies[0].angular_velocity
    read = LEAPFROG.build(pendulum(), 1e-3)(1, 500).twist[1, 0, 2]
    assert held - rate == pytest.approx(0.5e-3 * acceleration, rel=0.05)
    assert abs(read - rate) < 0.05 * abs(held - rate)


@pytest.mark.parametrize("method", [DEFAULT, TUNED], ids=lambda method: method.variant)
def test_reactions_are_the_engines_own_impulses_over_the_step(method):
    dt, every = 1e-3, 7
    model = method.model(MOVING, dt)
    reaction = method.build(MOVING, dt)(20, every).reaction
    for sample in range(1, 21):
        for _ in range(every):
            model.space.step(dt)
        forces = [constraint.impulse / dt for constraint in model.space.constraints]
        # A difference of velocities near 10 m/s over 1e-3 s: rounding 1e-12, times the row system's condition.
        assert np.hypot(*reaction[sample].reshape(4, 2).T) == pytest.approx(forces, abs=1e-9)


@every_method
def test_two_free_bodies_keep_their_momentum(method):
    left, right = (
        bar("left", (0.0, 0.0), (1.0, 0.0), rate=3.0),
        bar("right", (1.0, 0.0), (1.5, 0.5), (0.0, 3.0), rate=-2.0),
    )
    mechanism = Mechanism((left, right), (Pin("B", "left", "right", (0.5, 0.0), (-np.sqrt(0.125), 0.0)),))
    trajectory = method.build(mechanism, 1e-3)(100, 10)
    mass = np.array([left.mass, right.mass])
    momentum = np.sum(mass[:, None] * trajectory.twist[..., :2], axis=1)
    assert largest(momentum - momentum[0]) < 1e-11  # impulses are equal and opposite: rounding only
    assert largest(trajectory.reaction) > 0.1  # and there are some


@pytest.mark.parametrize("method", [SETTLED, AIMED], ids=lambda method: method.variant)
def test_how_often_a_run_is_sampled_changes_neither_its_poses_nor_its_iterations(method):
    """A run begins with many iterations a step; they end with the steps that ask for them, wherever a sample stands."""
    mechanism = TenLinks().mechanism() if method is SETTLED else ChaplyginSleigh().mechanism()
    often, seldom = (method.build(mechanism, 1e-3)(60 // every, every).pose for every in (1, 10))
    assert np.array_equal(often[::10], seldom)


def test_two_bodies_of_prescribed_motion_cannot_be_joined():
    one = Body("one", 1.0, 1.0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    joints = (
        Pin("A", None, "one", (0.0, 0.0), (0.0, 0.0)),
        Drive("first", None, "one", 1.0, 0.0),
        Drive("second", None, "one", 1.0, 0.0),
    )
    for pinned in (0, 1):  # a crank, and a body that can only turn as driven
        with pytest.raises(Unsupported, match="'second' joins two bodies whose motion is already prescribed"):
            TUNED.build(Mechanism((one,), joints[pinned:]), 1e-3)


def test_a_joint_that_has_no_construction_is_refused_in_a_sentence():
    class Weld:
        """Looks like a joint to the mechanism, is none that the engine knows."""

        def __init__(self, pin: Joint) -> None:
            self.pin = pin

        def __getattr__(self, name: str):
            return getattr(self.pin, name)

    mechanism = pendulum()
    odd = replace(mechanism)
    object.__setattr__(odd, "joints", (Weld(mechanism.joints[0]),))
    with pytest.raises(Unsupported, match="no construction for a Weld"):
        TUNED.build(odd, 1e-3)


@every_method
def test_a_motion_that_blows_up_is_a_result_and_not_an_exception(method):
    heavy = replace(MOVING, bodies=(*MOVING.bodies[:2], replace(MOVING.bodies[2], mass=1e-6, inertia=1e-9)))
    trajectory = method.build(heavy, 1e200)(20, 2)
    assert trajectory.pose.shape == (21, 3, 3)
    assert not np.all(np.isfinite(trajectory.pose))
    assert np.all(np.isnan(trajectory.reaction[~np.all(np.isfinite(trajectory.pose), axis=(1, 2))]))


def thrown(mass: float | None = None) -> Mechanism:
    """A sleigh that goes too far at once, or two links of masses too far apart for numbers."""
    if mass is None:
        sled = ChaplyginSleigh().mechanism()
        return replace(sled, bodies=(replace(sled.bodies[0], twist=(1e150, 0.0, 0.0)),))
    links = LinkPendulum().mechanism()
    return replace(links, bodies=(links.bodies[0], replace(links.bodies[1], mass=mass, inertia=mass)))


@pytest.mark.parametrize(
    ("methods", "wild", "step"),
    [
        (METHODS, RollingEllipse().mechanism(), 1e200),
        (METHODS, RollingOnCircle().mechanism(), 1e200),
        (SKATES, thrown(), 1e200),
        (METHODS, thrown(1e-300), 1e-3),
        (METHODS, thrown(1e300), 1e-3),
    ],
    ids=["ellipse", "hill", "sleigh", "light", "heavy"],
)
def test_so_is_one_of_contacts_of_blades_and_of_masses_too_far_apart(methods, wild, step):
    for method in methods:
        with np.errstate(all="ignore"):
            assert method.build(wild, step)(5, 2).pose.shape == (6, len(wild.bodies), 3)


@pytest.mark.parametrize(("engine", "levels"), [(TUNED, (1,)), (Extrapolated(TUNED, "two", (1, 3), (1,)), (1, 3))])
def test_the_bare_loop_takes_all_steps_of_a_run(engine, levels, monkeypatch):
    steps = []
    monkeypatch.setattr("engines.pymunk.repeat", lambda _, count: steps.append(count) or range(count))
    bare_loop(engine, FREE, 1e-4, 20)
    assert steps == [20 * level for level in levels]


def test_the_bare_loop_of_another_engine_is_refused():
    other = Extrapolated(Lagrange("rk4", "none"), "extended", (1, 2), (4,))
    with pytest.raises(ValueError, match="it must be pymunk"):
        bare_loop(other, FREE, 1e-3, 10)


def test_no_space_is_left_for_the_end_of_the_interpreter():
    """Freeing one there may crash the process after it has said all, and its exit status is another."""
    code = """
import gc, pymunk, engines.registry
gc.collect()
print([each for each in gc.get_objects() if isinstance(each, (pymunk.Space, pymunk.Body))])
"""
    told = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert (told.returncode, told.stdout, told.stderr) == (0, "[]\n", "")


@pytest.mark.parametrize("rest", [1.0, 3.0])
def test_the_impulse_of_a_spring_has_a_sign_as_the_page_on_settings_says(rest):
    pushes = 1 if rest > 2 else -1  # at a length of 2
    for spring, speed in (
        (lambda a, b: pymunk.constraints.DampedSpring(a, b, (0, 0), (0, 0), rest, 50, 0), lambda b: b.velocity.x),
        (lambda a, b: pymunk.constraints.DampedRotarySpring(a, b, rest - 2, 50, 0), lambda b: b.angular_velocity),
    ):
        space, body = pymunk.Space(), pymunk.Body(1, 1)
        body.position = 2, 0
        joint = spring(space.static_body, body)
        space.add(body, joint)
        space.step(0.01)
        assert abs(joint.impulse) > 0.1
        if isinstance(joint, pymunk.constraints.DampedSpring):
            assert joint.impulse * pushes > 0
        assert joint.impulse == pytest.approx(speed(body))
