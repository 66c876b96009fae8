"""Scenes exported to MJCF, to a pymunk script and to URDF, and read back: the same mechanisms, to rounding.

A model in a file that was rounded to some digits is read as the exact plane, with a note of the effect.
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
from reference import trajectory as outlines
from reference.checks import InvalidMechanism
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Roll, Skate, Weld
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import SCENES, scene
from reports.check.checked import Plan, check
from reports.check.judging import accelerations, refuse_disagreement
from reports.search.mechanisms import mechanism as random_mechanism
from tests import independent
from tests.engines.test_matrix import rod_in_a_slot
from tests.mechanisms import ALONE

# Numbers are written with all their digits. What is left is the rounding of two ways to the same place, times the
# condition of the rows: largest, 2e-13, for ten four-bars in line, which stand 0.05 rad from a singular position.
SAME = 1e-12
# Neither engine has a joint for a skate or a roll: what stands for them is code of ours before every step, or a
# contact, which gives way and slips. A contact is read as no ideal joint, and so refused.
WITHOUT_JOINT = (Skate, Roll)
IDEAL = [scene for scene in SCENES if not any(isinstance(joint, WITHOUT_JOINT) for joint in scene.mechanism().joints)]
assert len(IDEAL) >= 18
ELASTIC = ("pin", "gear", "spring", "damper", "torsion-spring", "torsion-damper")


def same(mechanism: Mechanism, again: Mechanism, but: tuple[str, ...] = ()) -> None:
    """Equal accelerations, forces of all joints together on every body, and freedoms.

    `but`: bodies of a known motion, of which an engine keeps no mass and no centre of mass: only their turning is
    compared, and the forces on all others.
    """
    whole = np.array([body.name not in but for body in mechanism.bodies])
    order = [again.body_index(body.name) for body in mechanism.bodies]
    found, loads = [], []
    for each in (mechanism, again):
        change = accelerations(each, each.pose, each.twist, 0.0)
        reaction = each.reaction(each.pose, change, twist=each.twist)
        found.append(change)
        loads.append((each.rows(each.pose).T @ reaction).reshape(-1, 3))
    found[1], loads[1] = found[1][order], loads[1][order]
    rates = np.abs(mechanism.twist[:, 2])
    assert (np.abs(mechanism.twist - again.twist[order])[:, 2] <= SAME * rates.max()).all()
    assert (np.abs(found[0] - found[1])[:, 2] <= SAME * np.abs(found[0]).max()).all()
    for first, second in (found, loads):
        first, second = first[whole], second[whole]
        assert np.abs(first - second).max(initial=0) <= SAME * max(np.abs(first).max(initial=0), 1e-300)
    assert mechanism.degrees_of_freedom() == again.degrees_of_freedom()


def from_mjcf(text: str) -> Mechanism:
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    return read_mujoco(model, data).mechanism


def from_script(text: str, folder) -> Mechanism:
    (folder / "exported.py").write_text(text)
    return read_pymunk(runpy.run_path(str(folder / "exported.py"))["make"]()).mechanism


# Long chains take seconds, and have no other element than short ones.
@pytest.mark.parametrize("scene", [one for one in SCENES if len(one.mechanism().bodies) < 50], ids=lambda one: one.name)
def test_a_scene_comes_back_from_mjcf_and_from_a_script_or_is_refused(scene, tmp_path):
    mechanism = scene.mechanism()
    if scene in IDEAL:
        engine = (DEFAULT, TUNED)[IDEAL.index(scene) % 2]
        same(mechanism, from_mjcf(engine.text(mechanism, 1e-3)))
        again = from_script(script(PYMUNK, mechanism, 1e-3), tmp_path)
        same(mechanism, again, but=tuple(find_cranks(mechanism)))
        return
    with pytest.raises(Unsupported, match="pymunk has no such joint"):
        script(PYMUNK, mechanism, 1e-3)
    with pytest.raises((Unsupported, InvalidMechanism)) as reason:
        from_mjcf(DEFAULT.text(mechanism, 1e-3))
    assert "\n" not in str(reason.value)


def test_a_drive_comes_back_from_mjcf_as_a_drive_and_an_armature_that_is_only_large_as_an_inertia():
    mechanism = scene("driven_four_bar").mechanism()
    again = from_mjcf(DEFAULT.text(mechanism, 1e-3))
    ours, found = ([joint for joint in each.joints if isinstance(joint, Drive)] for each in (mechanism, again))
    told = [[(joint.first, joint.second, joint.turning_rate) for joint in each] for each in (ours, found)]
    assert told[0] == told[1]
    assert len(ours) == 1
    text = replace(DEFAULT, armature=1e5).text(mechanism, 1e-3)
    assert not any(isinstance(joint, Drive) for joint in from_mjcf(text).joints)


def test_what_no_constraint_of_pymunk_stands_for_has_no_script():
    body = Body("plate", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pushed = Mechanism((body,), (), (0.0, 0.0), (Force("push", "plate", (0.1, 0.0), (0.0, 1.0)),))
    for mechanism, words in ((pushed, "'push' acts off the centre of mass"), (rod_in_a_slot(), "code of ours")):
        with pytest.raises(Unsupported, match=words):
            script(PYMUNK, mechanism, 1e-3)


def test_a_constant_force_at_the_centre_and_a_torque_between_two_bodies_come_back_from_a_script(tmp_path):
    mechanism = random_mechanism(31, 6, (*ELASTIC, "weld"))
    first, second = (body.name for body in mechanism.bodies[:2])
    pushes = (Force("push", first, (0.0, 0.0), (0.3, -1 / 3)), Torque("twist", first, second, 0.7))
    pushed = replace(mechanism, forces=(*mechanism.forces, *pushes))
    again = from_script(script(PYMUNK, pushed, 1e-3), tmp_path)
    same(pushed, again)
    with pytest.raises(AssertionError):
        same(mechanism, again)


def test_an_exported_script_with_a_constant_torque_moves_as_the_engine_does(tmp_path):
    mechanism = scene("andrews").mechanism()
    text = script(PYMUNK, mechanism, 1e-5)
    (tmp_path / "andrews.py").write_text(text)
    made = runpy.run_path(str(tmp_path / "andrews.py"))
    space = made["make"]()
    for _ in range(200):
        made["push"](space)
        space.step(1e-5)
    run = PYMUNK.build(mechanism, 1e-5)(1, 200)
    own = read_pymunk(made["make"](), 1e-5).model.run(1, 200)
    angles = [body.angle for body in space.bodies]
    # The same steps of the same engine; the run turns half-step velocities into poses of whole steps by no rounding.
    np.testing.assert_allclose(angles, run.pose[-1, :, 2], rtol=0, atol=1e-12)
    np.testing.assert_allclose(angles, own.pose[-1, :, 2], rtol=0, atol=1e-12)


def test_springs_dampers_gears_and_welds_come_back(tmp_path):
    kinds = set()
    for number in range(5, 14):
        mechanism = random_mechanism(31, number, (*ELASTIC, "weld"))
        same(mechanism, from_script(script(PYMUNK, mechanism, 1e-3), tmp_path))
        kinds |= {type(part) for part in (*mechanism.joints, *mechanism.forces)}
        # In MuJoCo a welded body is one with its parent: there is no other body to come back.
        mechanism = random_mechanism(31, number, ELASTIC)
        same(mechanism, from_mjcf(TUNED.text(mechanism, 1e-3)))
        kinds |= {type(part) for part in (*mechanism.joints, *mechanism.forces)}
    assert kinds == {Pin, Gear, Weld, Spring, Damper, TorsionSpring, TorsionDamper}


@pytest.mark.parametrize("name", ["pinned_body_free", "pendulum_1", "pendulum_2", "pendulum_10", "person_one_foot"])
def test_a_tree_comes_back_from_urdf_at_rest(name):
    mechanism = scene(name).mechanism()
    resting = tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in mechanism.bodies)
    still = replace(mechanism, bodies=resting, gravity=(0.5, -2.0))
    model = mujoco.MjModel.from_xml_string(urdf(still))
    assert "starts at rest" not in urdf(still)
    assert ("starts at rest" in urdf(mechanism)) == mechanism.twist.any()
    same(still, read_mujoco(model).mechanism)


def test_a_weld_is_a_fixed_joint_of_urdf_and_the_file_moves_as_the_mechanism():
    mechanism = ALONE["weld"]
    model = mujoco.MjModel.from_xml_string(urdf(mechanism))
    data = mujoco.MjData(model)
    model.opt.timestep, model.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4
    for _ in range(500):
        mujoco.mj_step(model, data)
    turned = TRUTH.build(mechanism, 0.1)(5, 1).pose[-1, :, 2] - mechanism.pose[:, 2]
    # Fourth order at 1 ms: what was seen is 1e-9; a hinge in the place of the weld is 1 rad off.
    np.testing.assert_allclose(data.qpos, [turned[0], turned[1] - turned[0]], rtol=0, atol=1e-7)


IN_HALVES = random_mechanism(3, 2, ("pin", "slot"))  # a loop, in which half a body and a weld hold a slot
BY_CONTACT = ("sleigh", "cart", "rolling_ellipse")


@pytest.mark.parametrize("name", ["in halves", "free_four_bar", "driven_slider_crank", "n_four_bar_2", *BY_CONTACT])
def test_an_exported_model_moves_as_the_engines_and_its_bars_go_through_the_joints(name):
    mechanism = IN_HALVES if name == "in halves" else scene(name).mechanism()
    own = DEFAULT.model(mechanism, 1e-3)
    shown = mujoco.MjModel.from_xml_string(DEFAULT.text(mechanism, 1e-3))
    data, start = mujoco.MjData(shown), own.start()
    mujoco.mj_resetDataKeyframe(shown, data, 0)
    for _ in range(60):
        mujoco.mj_step(shown, data)
        mujoco.mj_step(own.compiled, start)
    # The engine counts masses in a power of two of its own; a tolerance of the solver is told apart from rounding. A
    # blade's shape is pressed into the plane after the model is compiled, and one that is not is 3e-7 m and more off.
    np.testing.assert_allclose(data.qpos, start.qpos, rtol=0, atol=1e-8)
    assert bool(own.split_bodies) == (name == "in halves")
    if name in BY_CONTACT:
        return
    assert own.compiled.ngeom == 0  # bars are in the file alone
    assert not shown.geom_contype.any()
    assert not shown.geom_conaffinity.any()
    if name == "free_four_bar":
        mujoco.mj_resetDataKeyframe(shown, data, 0)
        mujoco.mj_kinematics(shown, data)
        for body, wanted in outlines.body_points(mechanism, mechanism.pose).items():
            geom = int(shown.body(body).geomadr[0])
            along = shown.geom_size[geom][1] * data.geom_xmat[geom].reshape(3, 3)[:, 2]
            ends = sorted((data.geom_xpos[geom] + side * along)[:2].tolist() for side in (1, -1))
            np.testing.assert_allclose(ends, sorted(wanted.tolist()), rtol=0, atol=1e-12)


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


ROUNDED = {
    "six digits of quaternions": ('quat="0.707105 0.707108 0 0"', 0.0, 0.0, 'quat="0.707108 0.707105 0 0"'),
    "1.5708 in one body": ('euler="1.5708 0 0"', 0.0, -0.1, QUARTER_TURN),
}


@pytest.mark.parametrize("name", ROUNDED)
def test_a_rounded_file_moves_as_the_exact_one_and_its_effect_is_told(name):
    t, exact = np.linspace(0.0, 1.0, 21), rounded_model()
    coordinates = independent.motion(exact, mujoco.MjData(exact), [independent.connected("C")], t)[0]
    reading = read_mujoco(rounded_model(*ROUNDED[name]))
    motion = TRUTH.build(reading.mechanism, t[1])(len(t) - 1, 1)
    angles = motion.pose[..., 2] - motion.pose[:1, :, 2]
    ours = np.column_stack([angles[:, 0], angles[:, 1] - angles[:, 0], angles[:, 2]])
    tilt = getattr(reading.model, "tilt")  # noqa: B009
    # Neighbouring starts are 30 times as far apart after a second, and what is beside the plane moves by the tilt.
    assert np.abs(np.abs(ours) - np.abs(coordinates)).max() < 30 * tilt + 1e-8
    assert refuse_disagreement(reading) < 1e-9
    judged = check(reading, name, 0.5, 1e-2, plan=Plan(0.0))
    (words,) = (note.reason for note in judged.reading.notes if note.element == "the directions of joints")
    off, *moved = (float(number) for number in re.findall(r"(\d[\d.]*e-\d+|0\.\d+) (?:m|rad)", words))
    assert off == pytest.approx(tilt, rel=0.05)
    assert 4e-8 < tilt < 1e-5
    assert max(moved[:2]) < 100 * tilt
    assert "with stiff loops by" in words


@pytest.mark.parametrize(("angle", "remedy"), [("1.57", True), ("1.3", False)])
def test_what_is_tilted_by_more_is_no_plane(angle, remedy):
    with pytest.raises(Unsupported, match="joint 'D': it is not parallel to joint 'A', but") as refused:
        read_mujoco(rounded_model(rocker=f'euler="{angle} 0 0"'))
    assert ("with six digits or more" in str(refused.value)) is remedy
