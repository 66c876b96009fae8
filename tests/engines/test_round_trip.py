"""Scenes exported to MJCF, to a pymunk script and to URDF, and read back: the same mechanisms, to rounding."""

from __future__ import annotations

import runpy
from dataclasses import replace

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
from reports.check.judging import accelerations
from reports.search.mechanisms import mechanism as random_mechanism
from tests.all_elements import ALONE
from tests.engines.test_matrix import rod_in_a_slot

# Numbers are written with all their digits. What is left is the rounding of two ways to the same place, times the
# condition of the rows: largest, 2e-13, for ten four-bars in line, which stand 0.05 rad from a singular position.
SAME = 1e-12
# Neither engine has a joint for a skate or a roll: what stands for them is code of ours before every step, or a
# contact, which gives way and slips. A contact is read as no ideal joint, and so refused.
WITHOUT_JOINT = (Skate, Roll)
IDEAL = [scene for scene in SCENES if not any(isinstance(joint, WITHOUT_JOINT) for joint in scene.mechanism().joints)]
OTHERS = [scene for scene in SCENES if scene not in IDEAL]
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
    model = mujoco.MjModel.from_xml_string(text)  # type: ignore[attr-defined]
    data = mujoco.MjData(model)  # type: ignore[attr-defined]
    mujoco.mj_resetDataKeyframe(model, data, 0)  # type: ignore[attr-defined]
    return read_mujoco(model, data).mechanism


def from_script(text: str, folder) -> Mechanism:
    (folder / "exported.py").write_text(text)
    return read_pymunk(runpy.run_path(str(folder / "exported.py"))["make"]()).mechanism


@pytest.mark.parametrize("scene", IDEAL, ids=lambda scene: scene.name)
def test_a_scene_comes_back_from_mjcf(scene):
    engine = (DEFAULT, TUNED)[IDEAL.index(scene) % 2]
    mechanism = scene.mechanism()
    same(mechanism, from_mjcf(engine.text(mechanism, 1e-3)))


@pytest.mark.parametrize("scene", IDEAL, ids=lambda scene: scene.name)
def test_a_scene_comes_back_from_a_pymunk_script(scene, tmp_path):
    mechanism = scene.mechanism()
    same(mechanism, from_script(script(PYMUNK, mechanism, 1e-3), tmp_path), but=tuple(find_cranks(mechanism)))


@pytest.mark.parametrize("scene", OTHERS, ids=lambda scene: scene.name)
def test_a_scene_with_a_skate_or_a_roll_has_no_file_or_one_that_is_refused(scene):
    mechanism = scene.mechanism()
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


def test_a_constant_force_off_the_centre_of_mass_has_no_script():
    body = Body("plate", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    pushed = Mechanism((body,), (), (0.0, 0.0), (Force("push", "plate", (0.1, 0.0), (0.0, 1.0)),))
    with pytest.raises(Unsupported, match="'push' acts off the centre of mass"):
        script(PYMUNK, pushed, 1e-3)


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


def test_a_slot_that_no_groove_joint_is_has_no_script():
    with pytest.raises(Unsupported, match="code of ours"):
        script(PYMUNK, rod_in_a_slot(), 1e-3)


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
    model = mujoco.MjModel.from_xml_string(urdf(still))  # type: ignore[attr-defined]
    assert "starts at rest" not in urdf(still)
    assert ("starts at rest" in urdf(mechanism)) == mechanism.twist.any()
    same(still, read_mujoco(model).mechanism)


def test_a_weld_is_a_fixed_joint_of_urdf_and_the_file_moves_as_the_mechanism():
    mechanism = ALONE["weld"]
    model = mujoco.MjModel.from_xml_string(urdf(mechanism))  # type: ignore[attr-defined]
    data = mujoco.MjData(model)  # type: ignore[attr-defined]
    model.opt.timestep, model.opt.integrator = 1e-3, mujoco.mjtIntegrator.mjINT_RK4  # type: ignore[attr-defined]
    for _ in range(500):
        mujoco.mj_step(model, data)  # type: ignore[attr-defined]
    turned = TRUTH.build(mechanism, 0.1)(5, 1).pose[-1, :, 2] - mechanism.pose[:, 2]
    # Fourth order at 1 ms: what was seen is 1e-9; a hinge in the place of the weld is 1 rad off.
    np.testing.assert_allclose(data.qpos, [turned[0], turned[1] - turned[0]], rtol=0, atol=1e-7)


IN_HALVES = random_mechanism(3, 2, ("pin", "slot"))  # a loop, in which half a body and a weld hold a slot
BY_CONTACT = ("sleigh", "cart", "rolling_ellipse")


@pytest.mark.parametrize("name", ["in halves", "free_four_bar", "driven_slider_crank", "n_four_bar_2", *BY_CONTACT])
def test_an_exported_model_moves_as_the_engines_and_its_bars_go_through_the_joints(name):
    mechanism = IN_HALVES if name == "in halves" else scene(name).mechanism()
    own = DEFAULT.model(mechanism, 1e-3)
    shown = mujoco.MjModel.from_xml_string(DEFAULT.text(mechanism, 1e-3))  # type: ignore[attr-defined]
    data, start = mujoco.MjData(shown), own.start()  # type: ignore[attr-defined]
    mujoco.mj_resetDataKeyframe(shown, data, 0)  # type: ignore[attr-defined]
    for _ in range(60):
        mujoco.mj_step(shown, data)  # type: ignore[attr-defined]
        mujoco.mj_step(own.compiled, start)  # type: ignore[attr-defined]
    # The engine counts masses in a power of two of its own; a tolerance of the solver is told apart from rounding. A
    # blade's shape is pressed into the plane after the model is compiled, and one that is not is 3e-7 m and more off.
    np.testing.assert_allclose(data.qpos, start.qpos, rtol=0, atol=1e-8)
    assert bool(own.halves) == (name == "in halves")
    if name in BY_CONTACT:
        return
    assert own.compiled.ngeom == 0  # bars are in the file alone
    assert not shown.geom_contype.any()
    assert not shown.geom_conaffinity.any()
    if name == "free_four_bar":
        mujoco.mj_resetDataKeyframe(shown, data, 0)  # type: ignore[attr-defined]
        mujoco.mj_kinematics(shown, data)  # type: ignore[attr-defined]
        for body, wanted in outlines.body_points(mechanism, mechanism.pose).items():
            geom = int(shown.body(body).geomadr[0])
            along = shown.geom_size[geom][1] * data.geom_xmat[geom].reshape(3, 3)[:, 2]
            ends = sorted((data.geom_xpos[geom] + side * along)[:2].tolist() for side in (1, -1))
            np.testing.assert_allclose(ends, sorted(wanted.tolist()), rtol=0, atol=1e-12)
