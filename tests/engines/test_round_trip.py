"""Tests that scenes exported to MJCF, pymunk scripts and URDF are read back as equal mechanisms, to rounding.

A file with rounded digits is read as a planar model with a note about the effect.
"""

from __future__ import annotations

import re
import runpy
from dataclasses import replace
from math import pi

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco import DEFAULT, TUNED
from engines.mujoco.reading import read as read_mujoco
from engines.mujoco.writers import urdf
from engines.pymunk import DEFAULT as PYMUNK
from engines.pymunk.joints.drive import find_cranks
from engines.pymunk.reading import read as read_pymunk
from engines.pymunk.written_script import script
from engines.reading import Reading
from reference import trajectory as outlines
from reference.checks import InvalidMechanism
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Roll, Skate, Weld
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import SCENES, scene
from reports.check.checked import SweepPlan, check
from reports.check.judging import accelerations, refuse_disagreement
from reports.search.mechanisms import mechanism as random_mechanism
from tests import independent
from tests.engines.test_matrix import rod_in_a_slot
from tests.mechanisms import ALONE

# The difference is rounding times the condition number of the rows. The largest difference is 2e-13, for ten four-bars
# in line, which are 0.05 rad from a singular position.
ROUND_TRIP_ROUNDING = 1e-12
# Neither engine has a joint for a skate or a roll. Readers can't recognise our constructions of these joints.
WITHOUT_JOINT = (Skate, Roll)
EXPORTABLE = [
    scene for scene in SCENES if not any(isinstance(joint, WITHOUT_JOINT) for joint in scene.mechanism().joints)
]
assert len(EXPORTABLE) >= 18
ELASTIC = ("pin", "gear", "spring", "damper", "torsion-spring", "torsion-damper")


def assert_equal(mechanism: Mechanism, other: Mechanism, driven: tuple[str, ...] = ()) -> None:
    """Assert that accelerations, total joint forces on every body, and degrees of freedom are equal.

    driven: bodies with a prescribed motion. An engine does not store the mass and centre of mass of these bodies, so
    only their rotations are compared.
    """
    is_free = np.array([body.name not in driven for body in mechanism.bodies])
    order = [other.body_index(body.name) for body in mechanism.bodies]
    changes, loads = [], []
    for item in (mechanism, other):
        change = accelerations(item, item.pose, item.twist, 0.0)
        reaction = item.reaction(item.pose, change, twist=item.twist)
        changes.append(change)
        loads.append((item.rows(item.pose).T @ reaction).reshape(-1, 3))
    changes[1], loads[1] = changes[1][order], loads[1][order]
    rates = np.abs(mechanism.twist[:, 2])
    assert (np.abs(mechanism.twist - other.twist[order])[:, 2] <= ROUND_TRIP_ROUNDING * rates.max()).all()
    assert (np.abs(changes[0] - changes[1])[:, 2] <= ROUND_TRIP_ROUNDING * np.abs(changes[0]).max()).all()
    for first, second in (changes, loads):
        allowed = ROUND_TRIP_ROUNDING * max(np.abs(first[is_free]).max(initial=0), 1e-300)
        assert np.abs(first[is_free] - second[is_free]).max(initial=0) <= allowed
    assert mechanism.degrees_of_freedom() == other.degrees_of_freedom()


def from_mjcf(text: str) -> Mechanism:
    return reading_of_mjcf(text).mechanism


def reading_of_mjcf(text: str) -> Reading:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return read_mujoco(model, data)


def from_script(text: str, folder) -> Mechanism:
    (folder / "exported.py").write_text(text)
    return read_pymunk(runpy.run_path(str(folder / "exported.py"))["make"]()).mechanism


# Scenes without long chains, which take seconds and have the same elements as short chains.
SHORT_SCENES = [scene for scene in SCENES if len(scene.mechanism().bodies) < 50]


@pytest.mark.parametrize("scene", SHORT_SCENES, ids=lambda scene: scene.name)
def test_a_scene_is_read_back_from_mjcf_and_a_script_or_refused(scene, tmp_path):
    mechanism = scene.mechanism()
    if scene in EXPORTABLE:
        engine = (DEFAULT, TUNED)[EXPORTABLE.index(scene) % 2]
        assert_equal(mechanism, from_mjcf(engine.text(mechanism, 1e-3)))
        again = from_script(script(PYMUNK, mechanism, 1e-3), tmp_path)
        assert_equal(mechanism, again, driven=tuple(find_cranks(mechanism)))
        return
    with pytest.raises(Unsupported, match="pymunk has no such joint"):
        script(PYMUNK, mechanism, 1e-3)
    with pytest.raises((Unsupported, InvalidMechanism)) as reason:
        from_mjcf(DEFAULT.text(mechanism, 1e-3))
    assert "\n" not in str(reason.value)


def test_only_the_armature_of_an_exported_drive_is_read_as_a_drive():
    mechanism = scene("driven_four_bar").mechanism()
    reading = reading_of_mjcf(DEFAULT.text(mechanism, 1e-3))
    assert any("taken as driven at 10 rad/s" in note.reason for note in reading.notes)
    again = reading.mechanism
    drives, again_drives = (
        [(joint.first, joint.second, joint.turning_rate) for joint in side.joints if isinstance(joint, Drive)]
        for side in (mechanism, again)
    )
    assert drives == again_drives
    assert len(drives) == 1
    text = replace(DEFAULT, armature=1e5).text(mechanism, 1e-3)
    assert not any(isinstance(joint, Drive) for joint in from_mjcf(text).joints)


def test_mechanisms_without_a_constraint_of_pymunk_have_no_script():
    body = Body("plate", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pushed = Mechanism((body,), (), (0.0, 0.0), (Force("push", "plate", (0.1, 0.0), (0.0, 1.0)),))
    for mechanism, reason in ((pushed, "'push' acts off the centre of mass"), (rod_in_a_slot(), "our code")):
        with pytest.raises(Unsupported, match=reason):
            script(PYMUNK, mechanism, 1e-3)


def test_constant_forces_and_torques_are_read_back_from_a_script(tmp_path):
    mechanism = random_mechanism(31, 6, (*ELASTIC, "weld"))
    first, second = (body.name for body in mechanism.bodies[:2])
    pushes = (Force("push", first, (0.0, 0.0), (0.3, -1 / 3)), Torque("twist", first, second, 0.7))
    pushed = replace(mechanism, forces=(*mechanism.forces, *pushes))
    again = from_script(script(PYMUNK, pushed, 1e-3), tmp_path)
    assert_equal(pushed, again)
    with pytest.raises(AssertionError):
        assert_equal(mechanism, again)


def test_an_exported_script_with_a_constant_torque_has_the_engines_motion(tmp_path):
    mechanism = scene("andrews").mechanism()
    text = script(PYMUNK, mechanism, 1e-5)
    (tmp_path / "andrews.py").write_text(text)
    program = runpy.run_path(str(tmp_path / "andrews.py"))
    space = program["make"]()
    for _ in range(200):
        program["push"](space)
        space.step(1e-5)
    run = PYMUNK.build(mechanism, 1e-5)(1, 200)
    read_back = read_pymunk(program["make"](), 1e-5).model.run(1, 200)
    angles = [body.angle for body in space.bodies]
    # The engine takes the same steps in all three runs.
    np.testing.assert_allclose(angles, run.pose[-1, :, 2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(angles, read_back.pose[-1, :, 2], rtol=0, atol=1e-12)


def test_springs_dampers_gears_and_welds_are_read_back(tmp_path):
    kinds = set()
    for number in range(5, 14):
        mechanism = random_mechanism(31, number, (*ELASTIC, "weld"))
        assert_equal(mechanism, from_script(script(PYMUNK, mechanism, 1e-3), tmp_path))
        kinds |= {type(part) for part in (*mechanism.joints, *mechanism.forces)}
        # MuJoCo merges a welded body with its parent.
        mechanism = random_mechanism(31, number, ELASTIC)
        assert_equal(mechanism, from_mjcf(TUNED.text(mechanism, 1e-3)))
        kinds |= {type(part) for part in (*mechanism.joints, *mechanism.forces)}
    assert kinds == {Pin, Gear, Weld, Spring, Damper, TorsionSpring, TorsionDamper}


@pytest.mark.parametrize("name", ["pinned_body_free", "pendulum_1", "pendulum_2", "pendulum_10", "person_one_foot"])
def test_a_tree_is_read_back_from_urdf_at_rest(name):
    mechanism = scene(name).mechanism()
    resting = tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in mechanism.bodies)
    at_rest = replace(mechanism, bodies=resting, gravity=(0.5, -2.0))
    model = mujoco.MjModel.from_xml_string(urdf(at_rest))
    assert "starts at rest" not in urdf(at_rest)
    assert ("starts at rest" in urdf(mechanism)) == mechanism.twist.any()
    assert_equal(at_rest, read_mujoco(model).mechanism)


def test_a_weld_is_exported_as_a_fixed_joint_of_urdf():
    mechanism = ALONE["weld"]
    model = mujoco.MjModel.from_xml_string(urdf(mechanism))
    data = mujoco.MjData(model)
    model.opt.timestep, model.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4
    for _ in range(500):
        mujoco.mj_step(model, data)
    turned = TRUTH.build(mechanism, 0.1)(5, 1).pose[-1, :, 2] - mechanism.pose[:, 2]
    # The error of RK4 at 1 ms is 1e-9. With a hinge instead of the weld the difference is 1 rad.
    np.testing.assert_allclose(data.qpos, [turned[0], turned[1] - turned[0]], rtol=0, atol=1e-7)


IN_HALVES = random_mechanism(3, 2, ("pin", "slot"))  # A loop with a slot, whose body is split and welded.
BY_CONTACT = ("sleigh", "cart", "rolling_ellipse")


@pytest.mark.parametrize("name", ["in halves", "free_four_bar", "driven_slider_crank", "n_four_bar_2", *BY_CONTACT])
def test_an_exported_model_has_the_engines_motion_and_bars_through_the_joints(name):
    mechanism = IN_HALVES if name == "in halves" else scene(name).mechanism()
    model = DEFAULT.model(mechanism, 1e-3)
    exported = mujoco.MjModel.from_xml_string(DEFAULT.text(mechanism, 1e-3))
    data, engine_data = mujoco.MjData(exported), model.start()
    mujoco.mj_resetDataKeyframe(exported, data, 0)
    for _ in range(60):
        mujoco.mj_step(exported, data)
        mujoco.mj_step(model.compiled, engine_data)
    # The difference comes from the tolerance of the solver, since the engine uses another unit of mass. The difference
    # would be at least 3e-7 m if the exported plane below a blade did not have the height that is set after
    # compilation.
    np.testing.assert_allclose(data.qpos, engine_data.qpos, rtol=0, atol=1e-8)
    assert bool(model.split_bodies) == (name == "in halves")
    if name in BY_CONTACT:
        return
    assert model.compiled.ngeom == 0  # Only the file has bars.
    assert not exported.geom_contype.any()
    assert not exported.geom_conaffinity.any()
    if name == "free_four_bar":
        mujoco.mj_resetDataKeyframe(exported, data, 0)
        mujoco.mj_kinematics(exported, data)
        for body, wanted in outlines.body_points(mechanism, mechanism.pose).items():
            geom = int(exported.body(body).geomadr[0])
            along = exported.geom_size[geom][1] * data.geom_xmat[geom].reshape(3, 3)[:, 2]
            ends = sorted((data.geom_xpos[geom] + side * along)[:2].tolist() for side in (1, -1))
            np.testing.assert_allclose(ends, sorted(wanted.tolist()), rtol=0, atol=1e-12)


# A four-bar linkage in the x-z plane. The placeholders are rounded right angles, the axis of a hinge, and the distance
# of the coupler from the plane [m].
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


ROUNDED_FILES = {
    "six digits of quaternions": ('quat="0.707105 0.707108 0 0"', 0.0, 0.0, 'quat="0.707108 0.707105 0 0"'),
    "1.5708 in one body": ('euler="1.5708 0 0"', 0.0, -0.1, QUARTER_TURN),
}


@pytest.mark.parametrize("name", ROUNDED_FILES)
def test_a_rounded_file_has_the_exact_motion_and_a_note_of_the_effect(name):
    t, exact = np.linspace(0.0, 1.0, 21), rounded_model()
    coordinates = independent.motion(exact, mujoco.MjData(exact), [independent.connected("C")], t)[0]
    reading = read_mujoco(rounded_model(*ROUNDED_FILES[name]))
    motion = TRUTH.build(reading.mechanism, t[1])(len(t) - 1, 1)
    angles = motion.pose[..., 2] - motion.pose[:1, :, 2]
    ours = np.column_stack([angles[:, 0], angles[:, 1] - angles[:, 0], angles[:, 2]])
    tilt = getattr(reading.model, "tilt")  # noqa: B009
    # Initial differences grow 30-fold in a second. The tilt displaces bodies that are not in the plane.
    assert np.abs(np.abs(ours) - np.abs(coordinates)).max() < 30 * tilt + 1e-8
    assert refuse_disagreement(reading) < 1e-9
    judged = check(reading, name, 0.5, 1e-2, plan=SweepPlan(0.0))
    (reason,) = (note.reason for note in judged.reading.notes if note.element == "the directions of joints")
    off, *moved = (float(number) for number in re.findall(r"(\d[\d.]*e-\d+|0\.\d+) (?:m|rad)", reason))
    assert off == pytest.approx(tilt, rel=0.05)
    assert 4e-8 < tilt < 1e-5
    assert max(moved[:2]) < 100 * tilt
    assert "with stiff loops by" in reason


@pytest.mark.parametrize(("angle", "remedy"), [("1.57", True), ("1.3", False)])
def test_a_larger_tilt_is_refused(angle, remedy):
    with pytest.raises(Unsupported, match="joint 'D': it is not parallel to joint 'A', but") as refused:
        read_mujoco(rounded_model(rocker=f'euler="{angle} 0 0"'))
    assert ("with six digits or more" in str(refused.value)) is remedy
