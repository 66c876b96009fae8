"""Tests of the judge with users' models whose motion is known in closed form."""

# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import math
from math import cos, inf, sin, sqrt
from typing import Any

import mujoco
import numpy as np
import pymunk
import pytest
from pymunk.constraints import DampedRotarySpring, GearJoint, GrooveJoint, PivotJoint, RotaryLimitJoint, SlideJoint

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.reading import read as read_mjcf
from engines.pymunk.reading import read as read_space
from engines.reading import left_out
from reference.checks import InvalidMechanism
from reports.check.checked import SweepPlan, check
from reports.check.judging import refuse_disagreement

CLOSE = 1e-8  # rad or m; the judge's tolerance is 1e-12 for a step, and these motions have a few hundred steps
INERTIA = 0.5
NOTHING = SweepPlan(0.0)  # only the user's settings are run
WHEEL = (
    '<body name="w"><joint name="a" axis="0 1 0" {0}/><inertial pos="0 0 0" mass="1" diaginertia=".5 .5 .5"/></body>'
)
LIFT = '<body name="l"><joint type="slide" axis="0 0 1"/><inertial pos="0 0 0" mass="2" diaginertia="1 1 1"/></body>'


def mjcf(bodies, more="", flags="", rate=0.0, control=0.0, joint=""):
    """The reading of a model without contacts. The first coordinate has the initial velocity `rate`."""
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><compiler angle="radian"/><option actuatorgroupdisable="3"><flag contact="disable" {flags}/></option>'
        f"<worldbody>{bodies.format(joint)}</worldbody>{more}</mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[0], data.ctrl[:] = rate, control
    return read_mjcf(model, data)


def judged_turn(reading, samples=50, spacing=0.02, body=0, coordinate=2):
    """The times, and the change of one coordinate of a body since the start."""
    motion = TRUTH.build(reading.mechanism, spacing)(samples, 1)
    return motion.t, motion.pose[:, body, coordinate] - motion.pose[0, body, coordinate]


# ---------------------------------------------------------------------------------------------------------- MuJoCo


def servo(t, gear, k=3.0, d=0.4, u=0.3):
    """The solution of I q'' = g (k (u - g q) - d g q'), which is a damped oscillation about u / g."""
    decay = d * gear**2 / (2 * INERTIA)
    rate = sqrt(gear**2 * k / INERTIA - decay**2)
    return u / gear * (1 - np.exp(-decay * t) * (np.cos(rate * t) + decay / rate * np.sin(rate * t)))


MOTOR = '<motor joint="a" gear="2" {0}/>'
RANGE = MOTOR.format('ctrlrange="-1 1.5" ctrllimited="true"')
BRAKE = '<velocity name="brake" joint="a" kv="1" forcerange="-1.5 1.5"/>'
# Case -> (actuators, flag, control, initial rate [rad/s], expected motion). The motion is an angle [rad] as a function
# of time, or a constant torque [N m].
TURNS: dict[str, tuple[str, str, float, float, Any]] = {
    "servo": ('<position joint="a" kp="3" kv=".4" gear="2"/>', "", 0.3, 0.0, lambda t: servo(t, 2.0)),
    "servo the other way": ('<position joint="a" kp="3" kv=".4" gear="-.5"/>', "", 0.3, 0.0, lambda t: servo(t, -0.5)),
    "control beyond its range": (RANGE, "", 4.0, 0.0, 2 * 1.5),
    "range switched off": (RANGE, 'clampctrl="disable"', 4.0, 0.0, 2 * 4.0),
    "force beyond its limit": (MOTOR.format('forcerange="-.5 .5"'), "", 3.0, 0.0, 2 * 0.5),
    "brake": (BRAKE, "", 0.0, 1.0, lambda t: INERTIA * (1 - np.exp(-t / INERTIA))),
    "group switched off": (f'<motor joint="a" group="3"/>{MOTOR}'.format('group="1"'), "", 0.5, 0.0, 2 * 0.5),
}


@pytest.mark.parametrize("case", TURNS)
def test_an_actuator_turns_a_wheel_as_mujoco_documents(case):
    extra, flags, control, rate, angle = TURNS[case]
    reading = mjcf(WHEEL, f"<actuator>{extra}</actuator>", flags, rate, control)
    t, turn = judged_turn(reading)
    wanted = np.array(angle(t) if callable(angle) else angle / INERTIA * t**2 / 2, dtype=float)
    np.testing.assert_allclose(np.abs(turn), np.abs(wanted), rtol=0, atol=CLOSE)
    assert any("MuJoCo takes 1.5" in note.reason for note in reading.notes) == (case == "control beyond its range")


@pytest.mark.parametrize(("active", "flags"), [("false", ""), ("true", 'constraint="disable"')])
def test_an_equality_that_is_switched_off_holds_nothing(active, flags):
    text = f'<equality><weld name="glue" body1="l" active="{active}"/></equality>'
    reading = mjcf(LIFT, text, flags)
    assert any(note.element == "equality 'glue'" for note in reading.notes)
    t, fallen = judged_turn(reading, coordinate=1)
    np.testing.assert_allclose(fallen, -9.81 * t**2 / 2, rtol=0, atol=CLOSE)
    t, fallen = judged_turn(mjcf(LIFT, text.replace(active, "true")), coordinate=1)
    np.testing.assert_allclose(fallen, 0, rtol=0, atol=CLOSE)


LIMITS = {
    "the actuator's": (0.6, 'forcerange="-.6 .6" forcelimited="true"', "", "actuator 'servo'"),
    "the joint's": (1.2, "", 'actuatorfrcrange="-1.2 1.2" actuatorfrclimited="true"', "joint 'a'"),
}


@pytest.mark.parametrize("name", LIMITS)
def test_a_limit_of_a_servos_force_is_named_with_the_time_at_which_it_is_reached(name):
    """The motion is q = q'0 / W sin(W t) with W^2 = g^2 k / I; the actuator's force k g q reaches its limit 0.6."""
    k, gear, rate = 3.0, 2.0, 1.0
    _, linkage, joint, element = LIMITS[name]
    text = f'<actuator><position name="servo" joint="a" kp="{k}" gear="{gear}" {linkage}/></actuator>'
    reading = mjcf(WHEEL, text, rate=rate, joint=joint)
    fast = sqrt(gear**2 * k / INERTIA)
    at = math.asin(0.6 / (k * gear) * fast / rate) / fast
    with pytest.raises(Unsupported, match=rf"^{element} reaches the limit of its force at") as refused:
        check(reading, "servo", 1.0, 1e-3)
    message = str(refused.value)
    time = float(message.split(" at ")[1].split(" s")[0])
    assert at <= time <= at + 0.005  # forces are checked every 1 ms, and three digits are printed
    assert message.endswith(left_out("forcelimit"))
    # The model is checked within the advised duration, or with the limit switched off.
    duration = float(message.split("--duration ")[1].split(";")[0])
    assert check(reading, "servo", duration, 1e-3, plan=NOTHING).met
    without = read_mjcf(reading.model.planar.model, reading.model.planar.data, ("forcelimit",))  # type: ignore[attr-defined]
    assert check(without, "servo", 0.5, 1e-2, plan=NOTHING).met


def test_a_limit_is_seen_that_is_passed_between_two_samples():
    """A thrown body is above its limit for 4 ms, between two samples 10 ms apart."""
    rate = 9.81 * 0.205
    highest = rate**2 / 2 / 9.81 - 9.81 * 0.002**2 / 2
    lift = LIFT.replace('axis="0 0 1"', f'axis="0 0 1" range="-99 {highest!r}" limited="true"')
    model = mujoco.MjModel.from_xml_string(f'<mujoco><option timestep="0.0005"/><worldbody>{lift}</worldbody></mujoco>')
    data = mujoco.MjData(model)
    data.qvel[0] = rate
    with pytest.raises(Unsupported, match=r"^joint 0 reaches its limit at 0\.20[34] s"):
        check(read_mjcf(model, data), "thrown", 2.0, 1e-3)


@pytest.mark.parametrize("flag", ["", 'gravity="disable"'])
def test_what_is_applied_to_joints_and_bodies_acts_in_its_direction(flag):
    """The data contain a torque on a hinge, and a force and a torque on a free body."""
    box = '<body name="f" pos="2 0 0"><freejoint/><inertial pos=".3 0 .1" mass="2" diaginertia=".5 .5 .5"/></body>'
    world = f"<worldbody>{WHEEL.format('')}{box}</worldbody>"
    model = mujoco.MjModel.from_xml_string(f'<mujoco><option><flag contact="disable" {flag}/></option>{world}</mujoco>')
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = 0.7  # about y; angles in the plane of x and z have the opposite sign
    data.xfrc_applied[2] = [3.0, 0.0, -1.0, 0.0, 0.4, 0.0]
    motion = TRUTH.build(read_mjcf(model, data).mechanism, 0.02)(50, 1)
    gone, half = motion.pose - motion.pose[0], motion.t**2 / 2
    np.testing.assert_allclose(gone[:, 0, 2], -0.7 / INERTIA * half, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(gone[:, 1, 0], 3.0 / 2 * half, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(gone[:, 1, 1], (-1.0 / 2 - (0 if flag else 9.81)) * half, rtol=0, atol=CLOSE)
    np.testing.assert_allclose(gone[:, 1, 2], -0.4 / INERTIA * half, rtol=0, atol=CLOSE)


# ---------------------------------------------------------------------------------------------------------- pymunk


def space_of(*bodies, gravity=(0.0, 0.0)):
    space = pymunk.Space()
    space.gravity = gravity
    space.add(*bodies)
    return space


def disc(position=(0.0, 0.0), angle=0.0, mass=1.0):
    body = pymunk.Body(mass, INERTIA)
    body.position, body.angle = position, angle
    return body


def wall(angle):
    body = pymunk.Body(body_type=pymunk.Body.STATIC)
    body.angle = angle
    return body


@pytest.mark.parametrize("first", [True, False], ids=["the wall first", "the body first"])
def test_a_torsion_spring_to_a_turned_static_body_is_at_ease_where_chipmunk_says(first):
    """The torque is zero if the first angle minus the second is the rest angle; the body oscillates about this pose."""
    turned, rest, k = 0.7, 0.3, 4.0
    body, post = disc(angle=0.2), wall(turned)
    ease = turned - rest if first else turned + rest
    space = space_of(body, post)
    space.add(DampedRotarySpring(*((post, body) if first else (body, post)), rest, k, 0.0))
    reading = read_space(space, 0.01)
    t, turn = judged_turn(reading)
    np.testing.assert_allclose(turn, (ease - 0.2) * (1 - np.cos(sqrt(k / INERTIA) * t)), rtol=0, atol=CLOSE)
    assert refuse_disagreement(reading) < 1e-6


@pytest.mark.parametrize("first", [True, False], ids=["the wall first", "the body first"])
def test_a_gear_to_a_turned_static_body_holds_the_angle_that_chipmunk_holds(first):
    """The first angle must be the ratio times the second angle minus the phase; with any other angle the gear is
    open."""
    turned, phase, ratio = 0.4, 0.3, 2.5
    angle = (turned + phase) / ratio if first else ratio * turned - phase

    def reading(off):
        body, post = disc(angle=angle + off), wall(turned)
        body.torque = 1.0
        space = space_of(body, post)
        space.add(GearJoint(*((post, body) if first else (body, post)), phase, ratio))
        return read_space(space, 0.01)

    assert np.abs(judged_turn(reading(0.0))[1]).max() < CLOSE
    assert refuse_disagreement(reading(0.0)) < 1e-6
    with pytest.raises(InvalidMechanism, match=r"is open by 0.01\d* rad"):
        reading(0.01)


@pytest.mark.parametrize("speed", [1.0, -1.0])
def test_both_ends_of_a_groove_are_ends(speed):
    """A body at 1 m/s starts 0.5 m from one end of a groove and 0.7 m from the other end."""
    body = disc((0.1, 0.0))
    body.velocity = (speed, 0.0)
    space = space_of(body)
    space.add(GrooveJoint(space.static_body, body, (-0.6, 0.0), (0.6, 0.0), (0.0, 0.0)))
    with pytest.raises(
        Unsupported, match=r"GrooveJoint 1 reaches its end at 0.[57]0?[0-9]? s.*give a longer groove"
    ) as result:
        check(read_space(space, 0.01), "groove", 2.0, 1e-3)
    assert f"at {0.5 if speed > 0 else 0.7:.3g}" in str(result.value)


@pytest.mark.parametrize("masks", [(1, 1), (2, 2), (2, 1)], ids=["the first's", "the second's", "neither"])
def test_shapes_meet_only_if_the_filters_of_both_allow_it(masks):
    """pymunk itself shows whether the bodies pass through each other."""
    bodies = disc((-1.0, 0.0)), disc((1.0, 0.0))
    space = space_of(*bodies)
    for body, mine, mask, speed in zip(bodies, (1, 2), masks, (1.0, -1.0), strict=True):
        body.velocity = (speed, 0.0)
        shape = pymunk.Circle(body, 0.25)
        shape.filter = pymunk.ShapeFilter(categories=mine, mask=mask)
        space.add(shape)
    model = read_space(space, 0.01).model
    t = np.arange(101) / 50
    poses = np.zeros((101, 2, 3))
    poses[:, 0, 0], poses[:, 1, 0] = t - 1, 1 - t
    seen = [obstacle.t for obstacle in model.obstacles(t, poses, np.zeros_like(poses))]
    for _ in range(200):
        space.step(0.01)
    flew_through = bodies[0].position.x > 0.9
    assert seen == ([] if flew_through else [pytest.approx(0.76, abs=0.021)])
    assert flew_through == (masks != (2, 1))


@pytest.mark.parametrize("added", [True, False])
def test_a_joint_that_lets_its_bodies_overlap_does_so_only_in_the_space(added):
    hinged, other = disc(), disc((0.3, 0.0))
    space = space_of(hinged, other)
    space.add(pymunk.Circle(hinged, 0.25), pymunk.Circle(other, 0.25))
    joint = PivotJoint(hinged, other, (0.3, 0.0), (0.0, 0.0))
    joint.collide_bodies = False
    if added:
        space.add(joint)
        assert read_space(space, 0.01).mechanism.joints
    else:
        with pytest.raises(Unsupported, match=r"a shape of body . touches one of body ."):
            read_space(space, 0.01)


def swinging(threshold, idle):
    """A pendulum that starts at rest, 1e-3 rad from the top."""
    bob = disc((sin(1e-3), cos(1e-3)))
    space = space_of(bob, gravity=(0.0, -9.81))
    space.add(PivotJoint(space.static_body, bob, (0.0, 0.0), bob.world_to_local((0.0, 0.0))))
    space.sleep_time_threshold, space.idle_speed_threshold = threshold, idle
    return space


def test_a_body_that_may_fall_asleep_is_named_with_the_time():
    """pymunk puts a body to sleep after 0.3 s with a speed below 0.02 m/s."""
    space = swinging(0.3, 0.02)
    with pytest.raises(
        Unsupported, match=r"^body 1 may fall asleep at 0\.30?\d? s.* --without sleep judges your model without it"
    ):
        check(read_space(space, 0.01), "asleep", 1.0, 1e-1)
    for _ in range(100):
        space.step(0.01)
    (bob,) = space.bodies
    assert bob.is_sleeping
    with pytest.raises(Unsupported, match=r"^body 1: it is asleep at the start"):
        read_space(space, 0.01)
    bob.activate()  # Pymunk 7.3.1 crashes if a space with a sleeping body is freed.
    # The model is checked without sleep, or if the body is always too fast to sleep.
    assert check(read_space(swinging(0.3, 0.02), 0.001, ["sleep"]), "awake", 1.0, 1e-1, plan=NOTHING).met
    assert check(read_space(swinging(0.3, 1e-5), 0.001), "fast", 1.0, 1e-1, plan=NOTHING).met


def test_limits_have_two_ends_that_count_from_the_first_body_to_the_second():
    first, second = disc(), disc((1.0, 0.0))
    space = space_of(first, second)
    space.add(SlideJoint(first, second, (0, 0), (0, 0), 0.5, 2.0), RotaryLimitJoint(first, second, -0.5, 2.0))
    model = read_space(space, 0.01).model
    poses = np.tile([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]], (3, 1, 1))
    poses[1, 1, 2], poses[2, 1, 0] = 1.5, 0.6  # both within
    assert model.obstacles(np.arange(3.0), poses, np.zeros_like(poses)) == []
    poses[1, 1, 2], poses[2, 1, 0] = -0.6, 0.4
    result = model.obstacles(np.arange(3.0), poses, np.zeros_like(poses))
    assert [(item.t, item.words.split()[0]) for item in result] == [(1.0, "RotaryLimitJoint"), (2.0, "SlideJoint")]


def test_a_space_that_was_stepped_and_opened_says_so():
    space = swinging(inf, 0.0)
    next(iter(space.bodies)).angular_velocity = 3.0
    next(iter(space.bodies)).velocity = (3.0, 0.0)
    space.step(0.02)
    with pytest.raises(InvalidMechanism, match=r"is open by .* stepped by 0.02 s already, .* before its first step$"):
        read_space(space)
