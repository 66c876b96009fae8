"""Tests of couplings and coupled forces in numpy, in compiled code, and in models of MuJoCo."""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH, Lagrange
from engines.mujoco import TUNED as MUJOCO
from engines.mujoco.reading import read
from engines.mujoco.reading.own_model import centres
from engines.pymunk import TUNED as PYMUNK
from reference.checks import InvalidMechanism
from reference.couplings import Coupling, Term
from reference.forces import CoupledForce
from reference.joints import Body, Pin
from reference.mechanism import Mechanism
from reference.reactions import banded_reaction
from reference.trajectory import energy
from reports.check.judging import refuse_disagreement
from tests import independent

TERMS = (
    Term(None, "a", 1.3),
    Term("a", "b", -0.7),
    Term("b", "c", 0.4, True, (0.1, 0.2), 0.5, (-0.3, 0.1)),
    Term("d", None, 0.6, True, (0.2, 0.0), -1.1, (0.5, 2.0)),
)
BODIES = tuple(
    Body(name, 1.0 + number, 0.3 + 0.1 * number, (0.8 * number, 0.3 - 0.2 * number, 0.4 * number), twist)
    for number, (name, twist) in enumerate(
        {"a": (0.3, -0.2, 1.1), "b": (0.0, 0.4, -0.7), "c": (-0.5, 0.1, 0.3), "d": (0.2, 0.2, 2.0)}.items()
    )
)


def value(terms, bodies=BODIES):
    pose = {body.name: np.array(body.pose) for body in bodies} | {None: np.zeros(3)}
    return float(sum(term.value(pose[term.first], pose[term.second]) for term in terms))


def held(terms=TERMS, *forces):
    """A mechanism with the four bodies, whose velocities are compatible with the coupling."""
    free = Mechanism(BODIES, (), (0.2, -9.81))
    loose = replace(free, bodies=tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in BODIES))
    row = replace(loose, joints=(Coupling("sum", terms, value(terms)),)).rows(free.pose)[0]
    twist = free.twist.reshape(-1) - row * (row @ free.twist.reshape(-1)) / (row @ row)
    bodies = tuple(replace(b, twist=tuple(v)) for b, v in zip(BODIES, twist.reshape(-1, 3).tolist(), strict=True))
    return Mechanism(bodies, (Coupling("sum", terms, value(terms)),), (0.2, -9.81), forces)


PULL = CoupledForce("pull", TERMS[::-1], 1.5, 7.0, 0.0, 0.2)
CASES = {
    "four bodies": held(),
    "one term": held(TERMS[2:3]),
    "with a spring": held(TERMS, PULL),
    "a damper alone": replace(held(TERMS, replace(PULL, damping=0.4)), joints=()),
}


@pytest.mark.parametrize("name", CASES)
def test_rows_of_couplings_are_derivatives_of_gaps_and_compiled_code_equals_numpy(name):
    mechanism, step = CASES[name], 1e-30
    if mechanism.joints:
        rows = mechanism.rows(mechanism.pose)
        for column in range(12):
            way = np.zeros(12)
            way[column] = 1.0
            moved = mechanism.gap(mechanism.pose + 1j * step * way.reshape(-1, 3), 0.0)
            assert rows[:, column] == pytest.approx(np.imag(moved) / step, abs=1e-14)
    runs = [replace(Lagrange("rk4"), compiled=linkage).build(mechanism, 1e-3)(4, 25) for linkage in (True, False)]
    for subject in ("pose", "twist", "reaction"):
        ours, theirs = (getattr(run, subject) for run in runs)
        assert ours == pytest.approx(theirs, abs=1e-12 * max(1.0, np.abs(theirs).max(initial=0.0)))
    if not mechanism.applied.dissipate:  # the truth, compiled
        motion = TRUTH.build(mechanism, 0.05)(20, 1)
        total = energy(mechanism, motion)
        assert np.ptp(total) < 1e-10 * np.abs(total).max()


def test_reactions_from_the_envelope_equal_those_of_dense_rows():
    # If two terms of a row act on the same body, their sum is squared.
    resting = tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in BODIES)
    pins = [Pin(body.name, None, body.name, body.pose[:2], (0.0, 0.0)) for body in BODIES]
    sums = (Coupling("sum", TERMS, value(TERMS)), Coupling("part", TERMS[1:3], value(TERMS[1:3])))
    mechanism = Mechanism(resting, (*pins, *sums), (0.0, -9.81))
    excess, poses = np.random.default_rng(5).normal(size=(3, 4, 3)), np.repeat(mechanism.pose[None], 3, axis=0)
    ours = banded_reaction(mechanism.joint_rows, poses, excess, mechanism.inertias)
    rows, mass = mechanism.rows(mechanism.pose), mechanism.inertias.reshape(-1)
    wanted = [np.linalg.solve((rows / mass) @ rows.T, rows @ acceleration.reshape(-1)) for acceleration in excess]
    assert ours == pytest.approx(np.array(wanted), rel=1e-9, abs=1e-9)


def test_all_other_engines_refuse_a_coupling():
    for engine in (MUJOCO, PYMUNK):
        with pytest.raises(Unsupported, match="joint 'sum'"):
            engine.build(CASES["four bodies"], 1e-3)
    with pytest.raises(InvalidMechanism, match="it has no terms"):
        Coupling("sum", ())
    with pytest.raises(InvalidMechanism, match="joint 'sum': no body is called 'e'"):
        Mechanism(BODIES, (Coupling("sum", (Term("a", "e", 1.0),)),))


def test_the_length_scale_of_a_single_pinion_is_its_radius():
    addends = Term(None, "b", -2.0, True), Term(None, "a", 0.1)
    free = tuple(Body(name, 1.0, 1.0, (0.0, 0.0, 0.0)) for name in "ab")
    assert Mechanism(free, (Coupling("teeth", addends),)).length_scale == pytest.approx(0.05)
    assert Mechanism(free, (Coupling("teeth", addends[1:]),)).length_scale == 1.0


OPTION = '<option timestep="0.001"/><default><geom contype="0" conaffinity="0"/></default>'
FINGERS = """<body name="palm"><joint name="wrist" axis="0 1 0" stiffness="2"/><geom type="capsule" fromto="0 0 0
 0 0 .1" size=".02"/><body name="first" pos="0 0 .1"><joint name="one" axis="0 1 0" damping=".002"/><geom type="capsule"
 fromto="0 0 0 .02 0 .06" size=".006"/><body name="second" pos=".02 0 .06"><joint name="two" axis="0 -1 0"/><geom
 type="capsule" fromto="0 0 0 0 0 .05" size=".006"/></body></body></body>"""
RACK = """<body name="frame"><joint name="swing" axis="0 1 0"/><geom type="box" size=".1 .02 .02" pos=".1 0 -.2"/>
 <body name="pinion"><joint name="turn" axis="0 1 0"/><geom type="cylinder" size=".05 .01" euler="90 0 0" mass=".4"
 pos=".01 0 0"/></body><body name="rack" pos="0 0 .06"><joint name="travel" type="slide" axis="1 0 .2"/>
 <geom type="box" size=".2 .01 .01" mass=".6"/></body></body>"""
TABLE = """<body name="table"><joint name="x" type="slide" axis="1 0 0"/><joint name="z" type="slide" axis="1 0 1"/>
 <joint name="spin" axis="0 1 0"/><geom type="box" size=".2 .1 .05" pos=".1 0 0"/></body>
 <body name="arm" pos="1 0 0"><joint name="lift" axis="0 1 0"/><joint name="reach" type="slide" axis="1 0 0"/>
 <geom type="box" size=".2 .1 .05" pos=".3 0 0"/></body>"""
MODELS = {  # Name -> worldbody, equalities and further elements, factors of each sum in MuJoCo's coordinates, start.
    "a rack in a frame that swings": (
        RACK,
        '<equality><joint name="teeth" joint1="travel" joint2="turn" polycoef="0 .05 0 0 0"/></equality>',
        [(0.0, -0.05, 1.0)],
        (0.5, 4.0, 0.2),
    ),
    "a tendon of slides and a hinge": (
        TABLE,
        '<tendon><fixed name="t"><joint joint="x" coef="2"/><joint joint="z" coef="-.7"/>'
        '<joint joint="lift" coef=".3"/><joint joint="reach" coef="1.1"/></fixed></tendon>'
        '<equality><tendon tendon1="t"/></equality>',
        [(2.0, -0.7, 0.0, 0.3, 1.1)],
        (0.1, 0.2, 0.4, 1.0, (-0.2 + 0.14 - 0.3) / 1.1),
    ),
    "a servo on a tendon": (
        FINGERS,
        '<tendon><fixed name="t"><joint joint="one" coef=".5"/><joint joint="two" coef="1"/></fixed></tendon>'
        '<actuator><general tendon="t" gear="1.5" gainprm=".3" biastype="affine" biasprm=".01 -.2 -.01"/></actuator>'
        '<keyframe><key ctrl="2"/></keyframe>',
        [],
        (0.4, 0.2, -0.8),
    ),
    "a motor, a spring and a damper on a tendon of slides": (
        RACK,
        '<tendon><fixed name="t" stiffness="30" damping=".4" springlength=".1"><joint joint="travel" coef="1"/>'
        '<joint joint="turn" coef=".1"/></fixed></tendon><actuator><motor tendon="t" gear="2"/></actuator>'
        '<keyframe><key ctrl="1.5"/></keyframe>',
        [],
        (0.4, 0.2, -0.8),
    ),
}


@pytest.mark.parametrize("name", MODELS)
def test_a_coupling_in_mujoco_has_the_motion_of_the_mechanism(name):
    bodies, rest, sums, start = MODELS[name]
    model = mujoco.MjModel.from_xml_string(f"<mujoco>{OPTION}<worldbody>{bodies}</worldbody>{rest}</mujoco>")
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    data.qvel[:] = start
    reading = read(model, data)
    assert refuse_disagreement(reading) < 1e-9
    t = np.linspace(0.0, 0.6, 13)
    ours = TRUTH.build(reading.mechanism, t[1])(len(t) - 1, 1)
    wanted, forces = independent.motion(model, data, [independent.coupled(*sum_) for sum_ in sums], t)
    unit = reading.mechanism.length_scale
    for sample, coordinates in enumerate(wanted):
        data.qpos[:] = coordinates
        mujoco.mj_kinematics(model, data)
        places = centres(reading.model.planar, data) @ reading.model.planar.frame.both.T
        assert ours.pose[sample, :, :2] == pytest.approx(places, abs=1e-8 * max(1.0, unit))
    names = [name for joint in reading.mechanism.joints for name in [type(joint).__name__] * joint.size]
    coupled = [index for index, kind in enumerate(names) if kind == "Coupling"]
    assert len(coupled) == len(sums)
    # The reaction acts on the same sum of coordinates, so it equals MuJoCo's force.
    assert ours.reaction[:, coupled] == pytest.approx(
        forces, rel=1e-6, abs=1e-7 * max(1.0, np.abs(forces).max(initial=0))
    )
