"""MuJoCo models become mechanisms: the same accelerations, element by element, or a sentence that names what can't.

Of a file that was rounded to some digits the motion is that of the exact plane, and the effect is told.
"""

from __future__ import annotations

import re
from dataclasses import replace
from math import pi

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.reading import read
from engines.mujoco.reading.own_model import positions
from engines.mujoco.reading.settings import switch_off
from engines.reading import Reading
from reports.check.checked import Plan, check
from reports.check.judging import apart, refuse_disagreement, soft_motion
from tests import independent

# Both sides solve small systems of equations whose numbers differ by a factor of a thousand at most.
ROUNDING = 1e-9
PENDULUM = """
<body name="upper"><joint name="A" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 .1" size=".02"/>
  <body name="lower" pos=".3 0 .1"><joint name="B" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .4 .1 0" size=".02"/><site name="tip" pos=".4 0 0"/></body></body>
"""
FOUR_BAR = """
<body name="crank"><joint name="A"/><geom fromto="0 0 0 0 0 .3"/>
  <body name="coupler" pos="0 0 .3"><joint name="B"/><geom fromto="0 0 0 .8 0 .3"/></body></body>
<body name="rocker" pos=".7 0 0"><joint name="D"/><geom fromto="0 0 0 .1 0 .6"/></body>
"""
CONNECT = '<connect name="C" body1="coupler" body2="rocker" anchor=".8 0 .3"/>'


def model_of(bodies, more="", option=""):
    """A model without contact; joints turn about y unless they say otherwise."""
    return mujoco.MjModel.from_xml_string(f"""
<mujoco><option {option}><flag contact="disable"/></option><compiler angle="radian"/>
<default><geom type="capsule" size=".02"/><joint axis="0 1 0"/></default>
<worldbody><site name="post" pos=".2 0 .9"/>{bodies}</worldbody>{more}</mujoco>""")


def moving(model, seed=1):
    """The model at its start, moving at random as its equalities allow."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    wanted = np.random.default_rng(seed).uniform(-2, 2, model.nv)
    rows = np.zeros((data.nefc, model.nv))
    if data.nefc:
        mujoco.mju_sparse2dense(rows, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind) if (
            mujoco.mj_isSparse(model)
        ) else rows.__setitem__(slice(None), data.efc_J.reshape(data.nefc, model.nv))
        rows = rows[data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)]
    data.qvel[:] = wanted - np.linalg.pinv(rows) @ (rows @ wanted) if len(rows) else wanted
    if np.abs(data.qvel).max() < 1e-12:  # nothing can move
        data.qvel[:] = 0.0
    mujoco.mj_forward(model, data)
    return data


def changed(reading: Reading, **values) -> Reading:
    """The reading with another mechanism, which is not what the model is."""
    return replace(reading, mechanism=replace(reading.mechanism, **values))


BOX = '<inertial pos=".1 0 .05" mass="2" diaginertia=".02 .03 .03"/>'
ELEMENTS = {
    "hinges": (PENDULUM, ""),
    "a body welded to its parent": (
        PENDULUM.replace("<site", '<body pos=".4 0 .2"><geom fromto="0 0 0 .1 0 .2"/></body><site'),
        "",
    ),
    "a slide": (f'<body name="a"><joint type="slide" axis="1 0 2"/>{BOX}</body>', ""),
    "a slide, then a hinge": (
        f'<body name="a"><joint type="slide" axis="1 0 2"/><joint pos=".2 0 0"/>{BOX}</body>',
        "",
    ),
    "a hinge, then a slide": (
        f'<body name="a"><joint pos=".2 0 0"/><joint type="slide" axis="1 0 2"/>{BOX}</body>',
        "",
    ),
    "a slide in a moving body": (
        PENDULUM.replace("<site", f'<body pos=".1 0 0"><joint type="slide" axis="1 0 0"/>{BOX}</body><site'),
        "",
    ),
    "two slides and a hinge": (
        f'<body name="a"><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint/>{BOX}</body>',
        "",
    ),
    "two slides": (f'<body><joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/>{BOX}</body>', ""),
    "hinges against each other": (PENDULUM.replace('name="B" axis="0 1 0"', 'name="B" axis="0 -1 0"'), ""),
    "a connect": (FOUR_BAR, f"<equality>{CONNECT}</equality>"),
    "a connect of sites": (
        PENDULUM.replace('axis="0 1 0"/>\n    <geom', 'axis="0 1 0"/><site name="end" pos=".2 0 0"/>\n    <geom')
        + '<body pos=".5 0 .1"><joint/><geom fromto="0 0 0 .1 0 .2"/><site name="mine"/></body>',
        '<equality><connect site1="end" site2="mine"/></equality>',
    ),
    "a weld": (FOUR_BAR, '<equality><weld name="C" body1="coupler" body2="rocker"/></equality>'),
    "a weld that holds a point alone": (
        FOUR_BAR,
        '<equality><weld name="C" body1="coupler" body2="rocker" torquescale="0"/></equality>',
    ),
    "a coupling of two grounded hinges": (
        FOUR_BAR,
        '<equality><joint joint1="A" joint2="D" polycoef="0 -1.5 0 0 0"/></equality>',
    ),
    "a coupling along a chain": (
        PENDULUM,
        '<equality><joint joint1="B" joint2="A" polycoef="0 -.4 0 0 0"/></equality>',
    ),
    "a locked hinge": (FOUR_BAR, '<equality><joint joint1="D"/></equality>'),
    "a spring, a damper and armature of a hinge": (
        PENDULUM.replace('name="A"', 'name="A" armature=".1"').replace(
            'name="B"', 'name="B" stiffness="3" springref=".4" damping=".2"'
        ),
        "",
    ),
    "a spring, a damper and armature of a slide": (
        f'<body><joint type="slide" axis="1 0 2" stiffness="30" springref=".1" damping=".3" armature=".5"/>{BOX}'
        '<body pos=".2 0 0"><joint/><geom fromto="0 0 0 .3 0 0"/></body></body>',
        "",
    ),
    "a spring of a slide in a moving body": (
        PENDULUM.replace(
            "<site",
            f'<body pos=".1 0 0"><joint type="slide" axis="1 0 0" stiffness="30" damping="1"/>{BOX}</body><site',
        ),
        "",
    ),
    "a spatial tendon": (
        PENDULUM,
        '<tendon><spatial stiffness="20" springlength=".3" damping=".5"><site site="post"/><site site="tip"/>'
        "</spatial></tendon>",
    ),
    "a fixed tendon": (
        PENDULUM,
        '<tendon><fixed stiffness="2" springlength=".3" damping=".5"><joint joint="A" coef="2"/>'
        '<joint joint="B" coef="2"/></fixed></tendon>',
    ),
    "a motor": (PENDULUM, '<actuator><motor joint="B" gear="2"/></actuator>'),
    "a motor of a slide": (
        f'<body><joint name="S" type="slide" axis="1 0 2"/>{BOX}</body>',
        '<actuator><motor joint="S" gear="2"/></actuator>',
    ),
    "a position servo": (
        PENDULUM.replace('name="B"', 'name="B" ref=".3"'),
        '<actuator><position joint="B" kp="5" gear="2"/></actuator>',
    ),
    "a velocity servo": (PENDULUM, '<actuator><velocity joint="B" kv="3" gear="2"/></actuator>'),
    "a force at a site": (
        PENDULUM,
        '<actuator><general site="tip" refsite="post" gear="1 0 2 0 .5 0"/></actuator>',
    ),
    "a body without weight": (PENDULUM.replace('name="lower"', 'name="lower" gravcomp=".7"'), ""),
    "a rod of a tendon": (
        PENDULUM,
        '<tendon><spatial name="t"><site site="post"/><site site="tip"/></spatial></tendon>'
        '<equality><tendon tendon1="t"/></equality>',
    ),
}


@pytest.mark.parametrize("name", ELEMENTS)
def test_an_element_gives_the_same_accelerations(name):
    bodies, more = ELEMENTS[name]
    option = 'gravity="1 0 -9.81"' if len(name) % 2 else ""
    model = model_of(bodies, more, option)
    data = moving(model)
    data.ctrl[:] = 0.7
    reading = read(model, data)
    assert refuse_disagreement(reading) < ROUNDING
    # What stands in the model is felt: with all forces and all gravity taken away the accelerations are others.
    with pytest.raises(Unsupported, match="differ from those of the ideal mechanism"):
        refuse_disagreement(changed(reading, gravity=(0.3, -5.0), forces=()))


@pytest.mark.parametrize("name", ["hinges", "a connect", "a slide, then a hinge", "a force at a site"])
def test_the_plane_is_found_however_the_model_is_turned(name):
    bodies, more = ELEMENTS[name]
    turned = f'<body euler=".4 .9 -.3" pos="1 2 3">{bodies}</body>'
    model = model_of(turned, more, 'gravity="1 2 -9"')
    data = moving(model)
    data.ctrl[:] = 0.7
    reading = read(model, data)
    assert refuse_disagreement(reading) < ROUNDING
    assert any(note.element == "gravity" for note in reading.notes)  # the part of it across the plane


def test_a_free_body_that_starts_in_the_plane_is_read():
    model = model_of(
        '<body name="a" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="2" diaginertia=".1 .2 .3"/></body>'
    )
    data = mujoco.MjData(model)
    data.qvel[:] = [1.0, 0.0, 2.0, 0.0, 3.0, 0.0]  # linear in the world, angular in the body's own frame
    reading = read(model, data)
    assert refuse_disagreement(reading) < ROUNDING
    (body,) = reading.mechanism.bodies
    assert reading.mechanism.degrees_of_freedom() == (3, 3)
    assert body.inertia == pytest.approx(0.2)
    run = reading.model.run(100, 10)  # 2 s, more than half a turn: the quaternion's angle is followed
    assert run.pose[-1, 0, 2] - run.pose[0, 0, 2] == pytest.approx(np.sign(body.twist[2]) * 3.0 * run.t[-1], rel=1e-6)


def test_the_first_keyframe_counts_and_any_can_be_named(tmp_path):
    from engines.mujoco.reading import READER

    file = tmp_path / "two_keys.xml"
    keys = '<keyframe><key name="low" qpos=".3 0"/><key name="high" qpos="2 0"/></keyframe>'
    file.write_text(f"<mujoco><worldbody>{PENDULUM}</worldbody>{keys}</mujoco>")
    first, high, none = (
        READER.read("two_keys.xml", tmp_path, (), key, None).mechanism.bodies[0].pose[2] for key in ("", "high", "none")
    )
    assert abs(first) == pytest.approx(0.3)
    assert abs(high) == pytest.approx(2.0)
    assert none == 0
    with pytest.raises(ValueError, match="there are low, high, and none"):
        READER.read("two_keys.xml", tmp_path, (), "middle", None)


@pytest.mark.parametrize(
    "change",
    [
        lambda m: {"bodies": (replace(m.bodies[0], mass=1.001 * m.bodies[0].mass), *m.bodies[1:])},
        lambda m: {"bodies": (replace(m.bodies[0], inertia=1.001 * m.bodies[0].inertia), *m.bodies[1:])},
        lambda m: {"gravity": (m.gravity[0], 1.001 * m.gravity[1])},
    ],
    ids=["mass", "inertia", "gravity"],
)
def test_a_wrong_reading_is_stopped_at_the_start(change):
    reading = read(model_of(FOUR_BAR, f"<equality>{CONNECT}</equality>"))
    with pytest.raises(Unsupported, match=r"most of all at '(crank|coupler|rocker)'"):
        refuse_disagreement(changed(reading, **change(reading.mechanism)))


def test_an_element_that_explains_a_disagreement_is_named():
    model = model_of(PENDULUM.replace('name="B"', 'name="B" damping=".5"'))
    reading = read(model, moving(model))
    with pytest.raises(Unsupported, match="agree without 'damper'"):
        refuse_disagreement(changed(reading, forces=()))


def test_an_equality_of_which_mujoco_makes_no_row_is_left_out_with_a_note():
    body = '<body name="a" {}><joint name="j" axis="0 1 0"/><geom size=".1" pos=".4 0 0"/></body>'
    for turned in ("", 'euler="0 30 0"'):
        model = f'<mujoco><worldbody>{body.format(turned)}</worldbody><equality><connect body1="a" anchor="0 0 0"/>'
        reading = read(mujoco.MjModel.from_xml_string(f"{model}</equality></mujoco>"))
        assert [joint.name for joint in reading.mechanism.joints] == ["j"]
        assert ("equality 0", True) in [(note.element, "makes no row" in note.reason) for note in reading.notes]
        assert refuse_disagreement(reading) < 1e-9
        assert not reading.model.give(np.zeros(2), reading.mechanism.pose).stiffness.any()


@pytest.mark.parametrize("option", ['density="1000"', 'viscosity="10"'])
def test_a_fluid_that_is_switched_off_moves_nothing(option):
    model = model_of(PENDULUM, "", option)
    data = moving(model)
    wet = data.qacc.copy()
    switch_off(model, "fluid")
    mujoco.mj_forward(model, data)
    dry = moving(model_of(PENDULUM)).qacc
    assert np.array_equal(data.qacc, dry)
    assert np.abs(wet - dry).max() > 1e-3 * np.abs(dry).max()


def test_softness_as_declared_is_what_mujoco_does():
    model = model_of(
        FOUR_BAR, f"<equality>{CONNECT}</equality>", 'timestep="0.0002" integrator="RK4" tolerance="1e-15"'
    )
    reading = read(model)
    run = reading.model.run(40, 50)
    soft = soft_motion(reading.mechanism, reading.model.give, run.t)
    ideal_is_off = apart(reading.mechanism, soft, run.pose).max()
    # RK4 at 0.2 ms: the step's own error is far below; the ideal motion is 1e-3 off.
    assert ideal_is_off < 1e-6
    stiffer = [replace(reading.model.give(np.zeros(8), reading.mechanism.pose), compliance=np.zeros((8, 8)))]
    wrong = soft_motion(reading.mechanism, lambda gap, pose: stiffer[0], run.t)
    assert apart(reading.mechanism, wrong, run.pose).max() > 1e-5


def test_a_contact_is_named_with_its_time_and_at_the_start_refused():
    def with_floor(height):
        return mujoco.MjModel.from_xml_string(
            f'<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" pos="0 0 {height}"/>{PENDULUM}'
            "</worldbody></mujoco>"
        )

    reading = read(with_floor(-0.3))
    run = reading.model.run(40, 10)
    met, *_ = reading.model.obstacles(run.t, run.pose, run.twist)
    assert met.words.startswith("geom 'floor' touches geom")
    assert 0.1 < met.t < 0.5
    with pytest.raises(
        Unsupported,
        match=r"geom 'floor' touches .*: so it does at the start.* --without contact judges your model without it",
    ):
        read(with_floor(0.0))


REFUSED = {
    "a ball": (PENDULUM.replace('name="B" axis="0 1 0"', 'name="B" type="ball"'), "", "joint 'B': a ball joint"),
    "not parallel": (
        PENDULUM.replace('name="B" axis="0 1 0"', 'name="B" axis="1 1 0"'),
        "",
        "joint 'B': it is not parallel to joint 'A'",
    ),
    "a slide out of the plane": (
        PENDULUM.replace('name="B" axis="0 1 0"', 'name="B" type="slide" axis="0 1 0"'),
        "",
        "joint 'B': it slides out of the plane",
    ),
    "two hinges in one body": (
        PENDULUM.replace('<joint name="B"', '<joint pos=".1 0 0"/><joint name="B"'),
        "",
        "two hinges with nothing between",
    ),
    "friction": (PENDULUM.replace('name="B"', 'name="B" frictionloss=".1"'), "", "joint 'B': its friction loss"),
    "armature between bodies": (PENDULUM.replace('name="B"', 'name="B" armature=".1"'), "", "joint 'B': its armature"),
    "a fluid": (PENDULUM, "", "density or viscosity"),
    "a coupling that bends": (
        PENDULUM,
        '<equality><joint name="bent" joint1="B" joint2="A" polycoef="0 1 2 0 0"/></equality>',
        "equality 'bent': a coupling that is not linear",
    ),
    "a tendon that wraps": (
        PENDULUM.replace("<site", '<site name="mid" pos=".1 0 0"/><site'),
        '<tendon><spatial name="t" stiffness="1"><site site="post"/><site site="mid"/><site site="tip"/></spatial>'
        "</tendon>",
        "tendon 't': only a tendon straight",
    ),
    "a tendon out of the plane": (
        PENDULUM.replace('pos=".4 0 0"', 'pos=".4 .1 0"'),
        '<tendon><spatial name="t" stiffness="1"><site site="post"/><site site="tip"/></spatial></tendon>',
        "tendon 't': its two sites",
    ),
    "a muscle": (
        PENDULUM,
        '<actuator><muscle name="m" joint="B" lengthrange="0 1"/></actuator>',
        "actuator 'm': only a motor",
    ),
    "nothing moves": ('<body><geom fromto="0 0 0 1 0 0"/></body>', "", "nothing in it can move"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_ideal_counterpart_is_named(name):
    bodies, more, sentence = REFUSED[name]
    model = model_of(bodies, more, 'density="1000"' if name == "a fluid" else "")
    data = mujoco.MjData(model)
    data.ctrl[:] = 1.0
    with pytest.raises(Unsupported) as reason:
        read(model, data)
    assert sentence in str(reason.value)


@pytest.mark.parametrize(
    "name",
    ["a slide, then a hinge", "a hinge, then a slide", "two slides and a hinge", "a slide in a moving body"],
)
def test_poses_go_back_to_mujocos_positions(name):
    model = model_of(*ELEMENTS[name])
    data = moving(model)
    data.qpos[:] = 0.3 * np.arange(1, model.nq + 1)
    reading = read(model, data)
    run = reading.model.run(20, 10)
    found = positions(reading.model.scene, run.pose)  # type: ignore[attr-defined]
    again = mujoco.MjData(model)
    for name_of in ("qpos", "qvel"):
        getattr(again, name_of)[:] = getattr(data, name_of)
    for sample in range(21):
        np.testing.assert_allclose(found[sample], again.qpos, atol=1e-10)
        mujoco.mj_step(model, again, nstep=10)


def test_a_run_begins_with_the_mocap_body_where_the_state_has_it():
    """A pendulum whose pin a keyframe has moved, and turned about the body's origin, together with the mocap body."""
    model = model_of(
        '<body name="post" mocap="true"/><body name="bob"><joint type="slide" axis="1 0 0"/>'
        '<joint type="slide" axis="0 0 1"/><joint/><inertial pos=".2 0 0" mass="1" diaginertia=".1 .1 .1"/></body>',
        '<equality><connect body1="bob" body2="post" anchor=".1 0 0"/></equality>'
        '<keyframe><key qpos=".2 .1 0" mpos=".3 0 .2" mquat="0.5 0 0.5 0"/></keyframe>',
    )
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    reading = read(model, data)
    run = reading.model.run(10, 5)
    assert np.ptp(run.pose[:, 0, 2]) > 0.01
    # As soft as a connect is as shipped: its weight opens it by a part of a millimetre.
    assert np.abs(reading.mechanism.gap(run.pose, run.t)).max() < 2e-3


@pytest.mark.parametrize("sample", [11, 20])  # a sum of steps of 0.1 s is a rounding below 1.1, and above 2
def test_the_samples_from_a_reset_on_are_no_numbers(sample):
    """The state in which MuJoCo begins anew has a velocity above mjMAXVAL = 1e10, and would be taken for an error."""
    body = '<body><joint type="slide" axis="1 0 0"/><geom fromto="0 0 0 .1 0 0"/></body>'
    gravity = 1e10 / (0.1 * (sample - 0.5))
    run = read(model_of(body, option=f'gravity="{gravity} 0 0" timestep="0.1"')).model.run(30, 1)
    assert run.reset_at == pytest.approx(0.1 * sample)
    np.testing.assert_array_equal(np.isfinite(run.pose).all(axis=(1, 2)), np.arange(31) < sample)


# A four-bar linkage in the plane of x and z, its bodies' own axes y in the plane; {} are a right angle as the file has
# it, the axis of a hinge, and how far beside the plane the coupler lies [m].
ROUNDED_FOUR_BAR = """<mujoco model="four bar"><compiler angle="radian"/><option timestep="0.001"/><worldbody>
 <body name="crank" {0}><joint name="A" axis="0 0 1"/><inertial pos="0 0.15 0" mass="1" diaginertia="0.01 0.001 0.01"/>
 <body name="coupler" pos="0 0.3 {2}"><joint name="B" axis="{1} 0 1"/>
 <inertial pos="0.4 0.15 0" mass="2" diaginertia="0.02 0.2 0.19"/></body></body>
 <body name="rocker" pos="0.7 0 0" {3}><joint name="D" axis="0 0 1"/>
 <inertial pos="0.05 0.3 0" mass="1.5" diaginertia="0.05 0.001 0.05"/></body></worldbody>
 <equality><connect name="C" body1="coupler" body2="rocker" anchor="0.8 0.3 0"/></equality></mujoco>"""
QUARTER_TURN = f'euler="{pi / 2!r} 0 0"'


def rounded_model(crank=QUARTER_TURN, axis=0.0, beside=0.0, rocker=QUARTER_TURN):
    return mujoco.MjModel.from_xml_string(ROUNDED_FOUR_BAR.format(crank, axis, beside, rocker))


@pytest.fixture(scope="module")
def exact_motion():
    t, model = np.linspace(0.0, 1.0, 21), rounded_model()
    return t, independent.motion(model, mujoco.MjData(model), [independent.connected("C")], t)[0]


ROUNDED = {
    "six digits of quaternions": ('quat="0.707105 0.707108 0 0"', 0.0, 0.0, 'quat="0.707108 0.707105 0 0"'),
    "1.5708 in one body": ('euler="1.5708 0 0"', 0.0, -0.1, QUARTER_TURN),
    "nothing": (QUARTER_TURN, 0.0, 0.3, QUARTER_TURN),
}


@pytest.mark.parametrize("name", ROUNDED)
def test_a_rounded_file_moves_as_the_exact_one_and_its_effect_is_told(name, exact_motion):
    t, coordinates = exact_motion
    reading = read(rounded_model(*ROUNDED[name]))
    motion = TRUTH.build(reading.mechanism, t[1])(len(t) - 1, 1)
    angles = motion.pose[..., 2] - motion.pose[:1, :, 2]
    ours = np.column_stack([angles[:, 0], angles[:, 1] - angles[:, 0], angles[:, 2]])
    tilt = getattr(reading.model, "tilt")  # noqa: B009
    # Neighbouring starts are 30 times as far apart after a second, and what is beside the plane moves by the tilt.
    assert np.abs(np.abs(ours) - np.abs(coordinates)).max() < 30 * tilt + 1e-8
    assert refuse_disagreement(reading) < 1e-9
    found = check(reading, name, 0.5, 1e-2, plan=Plan(0.0))
    told = [note.reason for note in found.reading.notes if note.element == "the directions of joints"]
    assert len(told) == (name != "nothing")
    for words in told:
        off, *moved = (float(each) for each in re.findall(r"(\d[\d.]*e-\d+|0\.\d+) (?:m|rad)", words))
        assert off == pytest.approx(tilt, rel=0.05)
        assert 4e-8 < tilt < 1e-5
        assert max(moved[:2]) < 100 * tilt
        assert "with stiff loops by" in words


@pytest.mark.parametrize(("angle", "remedy"), [("1.57", True), ("1.3", False)])
def test_what_is_tilted_by_more_is_no_plane(angle, remedy):
    with pytest.raises(Unsupported, match="joint 'D': it is not parallel to joint 'A', but") as refused:
        read(rounded_model(rocker=f'euler="{angle} 0 0"'))
    assert ("with six digits or more" in str(refused.value)) is remedy
