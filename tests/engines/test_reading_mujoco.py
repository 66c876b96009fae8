"""Tests of the reader for MuJoCo models. Accelerations agree with the model, or a refusal names the element."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco.declared import jacobian
from engines.mujoco.reading import READER, read
from engines.mujoco.reading.own_model import in_state, positions
from engines.mujoco.reading.settings import switch_off
from engines.reading import Reading, ReadingTerms
from reports.check.judging import pose_distance, refuse_disagreement, soft_motion

# Rounding of small systems of equations with coefficients that differ by a factor of at most a thousand.
SMALL_SYSTEM_ROUNDING = 1e-9
TWO_LINKS = """
<body name="upper"><joint name="A" axis="0 1 0"/><geom type="capsule" fromto="0 0 0 .3 0 .1" size=".02"/>
  <body name="lower" pos=".3 0 .1"><joint name="B" axis="0 1 0"/>
    <geom type="capsule" fromto="0 0 0 .4 .1 0" size=".02"/><site name="tip" pos=".4 0 0"/></body></body>
"""
FOUR_BAR_MJCF = """
<body name="crank"><joint name="A"/><geom fromto="0 0 0 0 0 .3"/>
  <body name="coupler" pos="0 0 .3"><joint name="B"/><geom fromto="0 0 0 .8 0 .3"/></body></body>
<body name="rocker" pos=".7 0 0"><joint name="D"/><geom fromto="0 0 0 .1 0 .6"/></body>
"""
CONNECT_EQUALITY = '<connect name="C" body1="coupler" body2="rocker" anchor=".8 0 .3"/>'


def model_of(bodies, more="", option="", turned=""):
    """A model without contact, whose joints turn about y by default. turned: attributes of a body around the model."""
    inside = f'<site name="post" pos=".2 0 .9"/>{bodies}'
    inside = f"<body {turned}>{inside}</body>" if turned else inside
    return mujoco.MjModel.from_xml_string(f"""
<mujoco><option {option}><flag contact="disable"/></option><compiler angle="radian"/>
<default><geom type="capsule" size=".02"/><joint axis="0 1 0"/></default>
<worldbody>{inside}</worldbody>{more}</mujoco>""")


def moving(model, seed=1):
    """The initial state of the model with random velocities that satisfy the equalities."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    wanted = np.random.default_rng(seed).uniform(-2, 2, model.nv)
    rows = jacobian(model, data)[data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)]
    data.qvel[:] = wanted - np.linalg.pinv(rows) @ (rows @ wanted) if len(rows) else wanted
    if np.abs(data.qvel).max() < 1e-12:  # No motion is possible.
        data.qvel[:] = 0.0
    mujoco.mj_forward(model, data)
    return data


def changed(reading: Reading, **values) -> Reading:
    """The reading with changed values of the mechanism. The model is not changed."""
    return replace(reading, mechanism=replace(reading.mechanism, **values))


TENDON_MJCF = '<tendon><spatial name="t" stiffness="1"><site site="post"/>{}<site site="tip"/></spatial></tendon>'
BOX = '<inertial pos=".1 0 .05" mass="2" diaginertia=".02 .03 .03"/>'
SLIDE, TURNED = '<joint type="slide" axis="1 0 2"/>', '<joint pos=".2 0 0"/>'
ALONG = '<joint type="slide" axis="1 0 0"/>'
CROSSED = f'{ALONG}<joint type="slide" axis="0 0 1"/>'
# All ways to connect a body with its parent.
CONNECTIONS = (SLIDE, SLIDE + TURNED, TURNED + SLIDE, CROSSED + TURNED, CROSSED, '<joint axis="0 -1 0"/>')
TREES = TWO_LINKS.replace(
    "<site", f'<body pos=".4 0 .2"><geom fromto="0 0 0 .1 0 .2"/></body><body pos=".1 0 0">{ALONG}{BOX}</body><site'
) + "".join(f"<body>{joints}{BOX}</body>" for joints in CONNECTIONS)
SPRUNG_BODIES = f"""<body name="upper" gravcomp=".7"><joint name="A" armature=".1"/><geom fromto="0 0 0 .3 0 .1"/>
<body pos=".1 0 0"><joint type="slide" axis="1 0 0" stiffness="30" damping="1"/>{BOX}</body>
<body name="lower" pos=".3 0 .1"><joint name="B" axis="0 -1 0" ref=".3" stiffness="3" springref=".4" damping=".2"/>
<geom fromto="0 0 0 .4 .1 0"/><site name="tip" pos=".4 0 0"/></body></body>
<body><joint name="S" type="slide" axis="1 0 2" stiffness="30" springref=".1" damping=".3" armature=".5"/>
{BOX}</body>"""
TENDONS_AND_ACTUATORS = """<tendon><spatial stiffness="20" springlength=".3" damping=".5"><site site="post"/>
<site site="tip"/></spatial>
<fixed stiffness="2" springlength=".3" damping=".5"><joint joint="A" coef="2"/><joint joint="B" coef="-2"/></fixed>
<fixed stiffness="1" springlength=".2" damping=".1"><joint joint="A" coef="2"/><joint joint="S" coef="3"/></fixed>
</tendon>
<actuator><motor joint="B" gear="2"/><motor joint="S" gear="2"/><position joint="B" kp="5" gear="2"/>
<velocity joint="B" kv="3" gear="2"/><general site="tip" refsite="post" gear="1 0 2 0 .5 0"/></actuator>"""
SITES = (
    TWO_LINKS.replace('axis="0 1 0"/>\n    <geom', 'axis="0 1 0"/><site name="end" pos=".2 0 0"/>\n    <geom')
    + '<body pos=".5 0 .1"><joint/><geom fromto="0 0 0 .1 0 .2"/><site name="mine"/></body>'
)
MJCF_MODELS = {"trees": (TREES, ""), "forces": (SPRUNG_BODIES, TENDONS_AND_ACTUATORS)} | {
    name: (bodies, (TENDON_MJCF.format("") if "tendon" in held else "") + f"<equality>{held}</equality>")
    for name, bodies, held in (
        ("a connect", FOUR_BAR_MJCF, CONNECT_EQUALITY),
        ("a connect of sites", SITES, '<connect site1="end" site2="mine"/>'),
        ("a weld", FOUR_BAR_MJCF, '<weld body1="coupler" body2="rocker"/>'),
        ("a weld that holds a point alone", FOUR_BAR_MJCF, '<weld body1="coupler" body2="rocker" torquescale="0"/>'),
        ("a coupling of two grounded hinges", FOUR_BAR_MJCF, '<joint joint1="A" joint2="D" polycoef="0 -1.5 0 0 0"/>'),
        ("a coupling along a chain", TWO_LINKS, '<joint joint1="B" joint2="A" polycoef="0 -.4 0 0 0"/>'),
        ("a locked hinge", FOUR_BAR_MJCF, '<joint joint1="D"/>'),
        ("a rod of a tendon", TWO_LINKS, '<tendon tendon1="t"/>'),
    )
}


@pytest.mark.parametrize("turned", ["", 'euler=".4 .9 -.3" pos="1 2 3"'])
@pytest.mark.parametrize("name", MJCF_MODELS)
def test_an_element_gives_the_same_accelerations_in_any_plane(name, turned):
    model = model_of(*MJCF_MODELS[name], 'gravity="1 0.5 -9.81"', turned)
    data = moving(model)
    data.ctrl[:] = 0.7
    reading = read(model, data)
    assert refuse_disagreement(reading) < SMALL_SYSTEM_ROUNDING
    assert any(note.element == "gravity" for note in reading.notes)  # The component across the plane.
    # If forces are removed and gravity is changed, the accelerations differ.
    with pytest.raises(Unsupported, match="differ from those of the ideal mechanism"):
        refuse_disagreement(changed(reading, gravity=(0.3, -5.0), forces=()))


def test_a_free_body_that_starts_in_the_plane_is_read():
    model = model_of(
        '<body name="a" pos="0 0 1"><freejoint/><inertial pos="0 0 0" mass="2" diaginertia=".1 .2 .3"/></body>'
    )
    data = mujoco.MjData(model)
    data.qvel[:] = [1.0, 0.0, 2.0, 0.0, 3.0, 0.0]  # Linear in the world frame, angular in the body frame.
    reading = read(model, data)
    assert refuse_disagreement(reading) < SMALL_SYSTEM_ROUNDING
    (body,) = reading.mechanism.bodies
    assert reading.mechanism.degrees_of_freedom() == (3, 3)
    assert body.inertia == pytest.approx(0.2)
    run = reading.model.run(100, 10)  # In 2 s the body makes almost a turn.
    assert run.pose[-1, 0, 2] - run.pose[0, 0, 2] == pytest.approx(np.sign(body.twist[2]) * 3.0 * run.t[-1], rel=1e-6)


def test_the_first_keyframe_is_the_default_and_a_name_chooses_another(tmp_path):
    file = tmp_path / "two_keys.xml"
    keys = '<keyframe><key name="low" qpos=".3 0"/><key name="high" qpos="2 0"/></keyframe>'
    file.write_text(f"<mujoco><worldbody>{TWO_LINKS}</worldbody>{keys}</mujoco>")
    first, high, none = (
        READER.read("two_keys.xml", tmp_path, ReadingTerms(key=key)).mechanism.bodies[0].pose[2]
        for key in ("", "high", "none")
    )
    assert abs(first) == pytest.approx(0.3)
    assert abs(high) == pytest.approx(2.0)
    assert none == 0
    with pytest.raises(ValueError, match="there are low, high, and none"):
        READER.read("two_keys.xml", tmp_path, ReadingTerms(key="middle"))


def test_a_wrong_reading_is_refused_with_the_name_of_a_body():
    reading = read(model_of(*MJCF_MODELS["a connect"]))
    (crank, *others), gravity = reading.mechanism.bodies, reading.mechanism.gravity
    for values in (
        {"bodies": (replace(crank, mass=1.001 * crank.mass), *others)},
        {"bodies": (replace(crank, inertia=1.001 * crank.inertia), *others)},
        {"gravity": (gravity[0], 1.001 * gravity[1])},
    ):
        with pytest.raises(Unsupported, match=r"most of all at '(crank|coupler|rocker)'"):
            refuse_disagreement(changed(reading, **values))


def test_an_element_that_explains_a_disagreement_is_named():
    model = model_of(TWO_LINKS.replace('name="B"', 'name="B" damping=".5"'))
    reading = read(model, moving(model))
    with pytest.raises(Unsupported, match="agree without 'damper'"):
        refuse_disagreement(changed(reading, forces=()))


def test_an_equality_without_a_row_in_mujoco_is_omitted_with_a_note():
    body = '<body name="a" {}><joint name="j" axis="0 1 0"/><geom size=".1" pos=".4 0 0"/></body>'
    for turned in ("", 'euler="0 30 0"'):
        model = f'<mujoco><worldbody>{body.format(turned)}</worldbody><equality><connect body1="a" anchor="0 0 0"/>'
        reading = read(mujoco.MjModel.from_xml_string(f"{model}</equality></mujoco>"))
        assert [joint.name for joint in reading.mechanism.joints] == ["j"]
        assert ("equality 0", True) in [(note.element, "makes no row" in note.reason) for note in reading.notes]
        assert refuse_disagreement(reading) < 1e-9
        assert not reading.model.regularisation(np.zeros(2), reading.mechanism.pose).stiffness.any()


def test_a_fluid_that_is_switched_off_exerts_no_force():
    model = model_of(TWO_LINKS, "", 'density="1000" viscosity="10"')
    data = moving(model)
    wet = data.qacc.copy()
    switch_off(model, "fluid")
    mujoco.mj_forward(model, data)
    dry = moving(model_of(TWO_LINKS)).qacc
    assert np.array_equal(data.qacc, dry)
    assert np.abs(wet - dry).max() > 1e-3 * np.abs(dry).max()


def test_a_soft_loop_moves_according_to_its_declared_regularisation():
    reading = read(model_of(*MJCF_MODELS["a connect"], 'timestep="0.0002" integrator="RK4" tolerance="1e-15"'))
    run = reading.model.run(40, 50)
    soft = soft_motion(reading.mechanism, reading.model.regularisation, run.t)
    # The error of RK4 with steps of 0.2 ms is far smaller than this tolerance. The ideal motion differs by 1e-3.
    assert pose_distance(reading.mechanism, soft, run.pose).max() < 1e-6
    stiffer = [replace(reading.model.regularisation(np.zeros(8), reading.mechanism.pose), compliance=np.zeros((8, 8)))]
    wrong = soft_motion(reading.mechanism, lambda gap, pose: stiffer[0], run.t)
    assert pose_distance(reading.mechanism, wrong, run.pose).max() > 1e-5


def test_a_contact_is_reported_with_its_time_and_refused_at_the_start():
    def with_floor(height):
        return mujoco.MjModel.from_xml_string(
            f'<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1" pos="0 0 {height}"/>{TWO_LINKS}'
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


BENT = '<equality><joint name="bent" joint1="B" joint2="A" polycoef="0 1 2 0 0"/></equality>'
MUSCLE = '<actuator><muscle name="m" joint="B" lengthrange="0 1"/></actuator>'
TIP, HINGE = 'name="tip" pos=".4 0 0"', 'name="B" axis="0 1 0"'


@pytest.mark.parametrize(
    ("old", "new", "more", "sentence"),
    [
        (HINGE, 'name="B" type="ball"', "", "joint 'B': a ball joint"),
        (HINGE, 'name="B" axis="1 1 0"', "", "joint 'B': it is not parallel to joint 'A'"),
        (HINGE, f'type="slide" {HINGE}', "", "joint 'B': it slides out of the plane"),
        (f"<joint {HINGE}", f'<joint pos=".1 0 0"/><joint {HINGE}', "", "two hinges with nothing between"),
        (HINGE, f'frictionloss=".1" {HINGE}', "", "joint 'B': its friction loss"),
        (HINGE, f'armature=".1" {HINGE}', "", "joint 'B': its armature"),
        ("", "", '<option density="1000"/>', "density or viscosity"),
        ("", "", BENT, "equality 'bent': a coupling that is not linear"),
        (
            TIP,
            f'name="mid"/><site {TIP}',
            TENDON_MJCF.format('<site site="mid"/>'),
            "tendon 't': only a tendon straight",
        ),
        (TIP, 'name="tip" pos=".4 .1 0"', TENDON_MJCF.format(""), "tendon 't': its two sites"),
        ("", "", MUSCLE, "actuator 'm': only a motor"),
        (TWO_LINKS, '<body><geom fromto="0 0 0 1 0 0"/></body>', "", "nothing in it can move"),
    ],
)
def test_an_element_without_planar_counterpart_is_refused_by_name(old, new, more, sentence):
    model = model_of(TWO_LINKS.replace(old, new) if old else TWO_LINKS, more)
    data = mujoco.MjData(model)
    data.ctrl[:] = 1.0
    with pytest.raises(Unsupported) as reason:
        read(model, data)
    assert sentence in str(reason.value)


def test_positions_follow_from_poses():
    model = model_of(TREES)
    data = moving(model)
    data.qpos[:] = 0.3 * np.arange(1, model.nq + 1)
    reading = read(model, data)
    run, again = reading.model.run(20, 10), in_state(model, data)
    for qpos in positions(reading.model.planar, run.pose):  # type: ignore[attr-defined]
        np.testing.assert_allclose(qpos, again.qpos, atol=1e-10)
        mujoco.mj_step(model, again, nstep=10)


def test_a_run_starts_with_the_mocap_body_of_the_state():
    """A keyframe moves and rotates the mocap body that has the pin of the pendulum."""
    model = model_of(
        f'<body name="post" mocap="true"/><body name="bob">{CROSSED}<joint/><inertial pos=".2 0 0" mass="1" '
        'diaginertia=".1 .1 .1"/></body>',
        '<equality><connect body1="bob" body2="post" anchor=".1 0 0"/></equality>'
        '<keyframe><key qpos=".2 .1 0" mpos=".3 0 .2" mquat="0.5 0 0.5 0"/></keyframe>',
    )
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    reading = read(model, data)
    run = reading.model.run(10, 5)
    assert np.ptp(run.pose[:, 0, 2]) > 0.01
    # With MuJoCo's default stiffness the weight causes a gap of less than 1 mm in the connect constraint.
    assert np.abs(reading.mechanism.gap(run.pose, run.t)).max() < 2e-3


@pytest.mark.parametrize("sample", [11, 20])  # The rounded sum of 0.1 s steps is below 1.1 s, or above 2 s.
def test_samples_from_a_reset_on_are_nan(sample):
    """MuJoCo resets the state if a velocity exceeds mjMAXVAL = 1e10."""
    body = '<body><joint type="slide" axis="1 0 0"/><geom fromto="0 0 0 .1 0 0"/></body>'
    gravity = 1e10 / (0.1 * (sample - 0.5))
    run = read(model_of(body, option=f'gravity="{gravity} 0 0" timestep="0.1"')).model.run(30, 1)
    assert run.reset_at == pytest.approx(0.1 * sample)
    np.testing.assert_array_equal(np.isfinite(run.pose).all(axis=(1, 2)), np.arange(31) < sample)
