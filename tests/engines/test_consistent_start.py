"""Tests that a model whose initial state violates joints starts at the nearest consistent state or is refused."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from itertools import pairwise
from math import cos, dist, hypot, sin

import mujoco
import numpy as np
import pymunk
import pytest
from pymunk.constraints import PinJoint, PivotJoint, SimpleMotor

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.reading import read as read_mujoco
from engines.mujoco.reading.own_model import positions
from engines.pymunk.reading import read
from reference.checks import InvalidMechanism
from reports.check.checked import SweepPlan, check
from reports.check.judging import refuse_disagreement
from tests import ROOT
from tests.independent import Equations

STEPPED = 1e-6  # See ACCELERATION_ERROR in tests/engines/test_reading_pymunk.py.


def linkage(*points, ground=(0, 0), gravity=-9.81):
    """(a space with a chain of bars, the bars). The first bar is pinned to the ground."""
    space = pymunk.Space()
    space.gravity = (0, gravity)
    bars = []
    for p, q in pairwise(points):
        bar = pymunk.Body(1.0, dist(p, q) ** 2 / 12)
        bar.position = (p[0] + q[0]) / 2, (p[1] + q[1]) / 2
        space.add(bar)
        bars.append(bar)
    pivots = [(space.static_body, bars[0], points[0])]
    pivots += [(a, b, at) for a, b, at in zip(bars, bars[1:], points[1:], strict=False)]
    if ground is not None:
        pivots.append((space.static_body, bars[-1], points[-1]))
    space.add(*[PivotJoint(a, b, at) for a, b, at in pivots])
    return space, bars


A, B, C, D = (0, 0), (0.0, 0.5), (1.2, 0.9), (1.1, 0.0)


def one_motor():
    space, bars = linkage(A, B, C, D)
    space.add(SimpleMotor(space.static_body, bars[0], -5))
    return space


def two_motors_on_a_moving_chain():
    space, bars = linkage(A, B, C, (2.0, 0.3), ground=None)
    bars[2].velocity, bars[2].angular_velocity = (0.3, -0.2), 1.5
    space.add(SimpleMotor(space.static_body, bars[0], -3), SimpleMotor(bars[0], bars[1], 2))
    return space


def a_motor_twice():
    space = one_motor()
    first, second, _ = space.bodies
    space.add(SimpleMotor(space.static_body, first, -5), PivotJoint(first, second, B))
    return space


@pytest.mark.parametrize("make", [one_motor, two_motors_on_a_moving_chain, a_motor_twice])
def test_velocities_that_violate_joints_become_the_nearest_consistent_ones(make):
    space = make()
    reading, equations = read(space), Equations(space)
    wanted = equations.nearest_speeds()
    assert reading.mechanism.twist.reshape(-1) == pytest.approx(wanted, abs=1e-9 * np.abs(wanted).max())
    assert refuse_disagreement(reading) < STEPPED
    note = reading.notes[0]
    assert note.element == "the start"
    assert "SimpleMotor 1 torque" in note.reason
    energy = 0.5 * np.sum((wanted - equations.speed) ** 2 / equations.inverse)
    assert f"({energy:.3g} J" in note.reason


def test_a_consistent_start_is_not_changed():
    reading = read(linkage(A, B, C, D)[0])
    assert not reading.mechanism.twist.any()
    assert not reading.notes


@pytest.mark.parametrize(
    ("rates", "named"), [((1.0, 2.0), ("SimpleMotor 1, SimpleMotor 2",)), ((3.0,), ("SimpleMotor 1", "PivotJoint"))]
)
def test_contradictory_motor_rates_are_refused_in_one_line(rates, named):
    space, bars = linkage(A, B, C, D)
    if len(rates) == 1:  # With this pivot the chain is a truss without freedom.
        space.add(PivotJoint(space.static_body, bars[0], B))
    space.add(*[SimpleMotor(space.static_body, bars[0], rate) for rate in rates])
    with pytest.raises(InvalidMechanism, match="no velocities satisfy") as refused:
        read(space)
    assert all(name in str(refused.value) for name in named)
    assert "\n" not in str(refused.value)


ROUND = """<mujoco><option timestep="0.001" integrator="{integrator}"/><default><geom contype="0" conaffinity="0"
 type="capsule" size=".02"/><joint axis="0 -1 0"/><equality solref="{solref} 1"/></default><worldbody>
 <body name="one"><joint name="a"/><geom fromto="0 0 0 .3 0 0"/></body>
 <body name="two" pos="0 0 .5"><joint name="b"/><geom fromto="0 0 0 .2 0 .2"/></body></worldbody>
 <equality><joint name="mesh" joint1="b" joint2="a" polycoef="0 -2 0 0 0"/></equality>
 <keyframe><key qvel="3 0"/></keyframe></mujoco>"""


def test_a_stiffer_row_in_mujoco_is_nearer_to_the_impulse_of_ideal_joints():
    errors = []
    for solref in (0.02, 0.005):
        model = mujoco.MjModel.from_xml_string(ROUND.format(integrator="RK4", solref=solref))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, 0)
        reading = read_mujoco(model, data)
        first, second = (body.inertia + body.mass * hypot(*body.pose[:2]) ** 2 for body in reading.mechanism.bodies)
        second = reading.mechanism.bodies[1].inertia + reading.mechanism.bodies[1].mass * (0.1**2 + 0.1**2)
        rate = first * 3 / (first + 4 * second)
        assert reading.mechanism.twist[:, 2] == pytest.approx([rate, -2 * rate], rel=1e-12)
        assert "mesh torque" in reading.notes[0].reason
        assert refuse_disagreement(reading) < STEPPED
        checked = check(reading, "meshed", 0.3, 1e-4, plan=SweepPlan(0.0))
        errors.append(checked.own_errors.largest)
        # The compliance of the row causes the error, and not the step.
        assert checked.parts.softness == pytest.approx(checked.own_errors.largest, rel=0.05)
    assert errors[1] < 0.5 * errors[0]


def six_digits(values):
    return [float(f"{value:.6g}") for value in values]


@pytest.mark.parametrize("size", [1.0, 1e-3])
def test_joints_open_by_six_digit_rounding_are_closed(size):
    space, bars = linkage(*((size * x, size * y) for x, y in (A, B, C, D)), gravity=-9.81 * size)
    exact = [(*bar.position, 0.0) for bar in bars]
    turn = 0.3  # The whole mechanism is rotated, so that no digit of a position is zero.
    for bar in bars:
        bar.position, bar.angle = six_digits(bar.position.rotated(turn)), six_digits([turn])[0]
    for pivot in space.constraints:
        if pivot.a is space.static_body:
            pivot.anchor_a = pivot.anchor_a.rotated(turn)
    rod = PinJoint(bars[0], bars[2], (0, 0), (0, 0))
    rod.distance = dist(exact[0][:2], exact[2][:2])
    space.add(rod)
    reading = read(space, 1e-3)
    mechanism = reading.mechanism
    assert np.abs(mechanism.gap(mechanism.pose, 0.0)).max() < 1e-12 * size
    turned = [(x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn)) for x, y, _ in exact]
    assert mechanism.pose[:, :2] == pytest.approx(np.array(turned), abs=5e-6 * size)
    assert [note for note in reading.notes if "nearest positions" in note.reason]
    run = reading.model.run(10, 1)
    assert run.pose[0] == pytest.approx(mechanism.pose, abs=1e-12 * size)
    bars[1].position += (1e-4 * size, 0)  # larger than rounding to six digits
    with pytest.raises(InvalidMechanism, match="is open by"):
        read(space, 1e-3)


COUPLED = """<mujoco><worldbody>
<body><joint name="a" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.3 0 -0.1" size="0.01"/></body>
<body pos="1 0 0"><joint name="b" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.3 0 0.1" size="0.01"/>
  <body pos="0.3 0 0.1"><joint name="c" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 0.2 0 0" size="0.01"/></body>
</body></worldbody><tendon><fixed name="sum"><joint joint="a" coef="18"/><joint joint="b" coef="-7"/><joint joint="c"
coef="9"/></fixed></tendon><equality><tendon tendon1="sum"/></equality></mujoco>"""
CYLINDER = (ROOT / "tests/reports/inputs/b02b_cylinder_spring.xml").read_text()


@pytest.mark.parametrize("text", [CYLINDER, COUPLED], ids=["loop", "coupling"])
def test_joints_of_mujoco_open_by_six_digit_rounding_are_closed(text):
    model = mujoco.MjModel.from_xml_string(text)
    first = read_mujoco(model)
    truth = TRUTH.build(first.mechanism, 1e-3)(100, 1)
    data = mujoco.MjData(model)
    data.qpos[:] = six_digits(positions(first.model.planar, truth.pose[-1:])[0])
    reading = read_mujoco(model, data)
    mechanism = reading.mechanism
    assert np.abs(np.nan_to_num(mechanism.gap(mechanism.pose, 0.0))).max() < 1e-11  # amplified rounding
    assert [note for note in reading.notes if "nearest positions" in note.reason]
    assert mechanism.pose == pytest.approx(truth.pose[-1], abs=5e-6)
    assert refuse_disagreement(reading) < 1e-6
    data.qpos[0] += 1e-3
    with pytest.raises((InvalidMechanism, Unsupported), match="is open by"):
        read_mujoco(model, data)
