"""Scenes exported to MJCF, to a pymunk script and to URDF, and read back: the same mechanisms, to rounding."""

from __future__ import annotations

import runpy
from dataclasses import replace

import mujoco
import numpy as np
import pytest

from engines import Unsupported
from engines.mujoco import DEFAULT, TUNED
from engines.mujoco.reading import read as read_mujoco
from engines.mujoco.written_urdf import urdf
from engines.pymunk import DEFAULT as PYMUNK
from engines.pymunk.reading import read as read_pymunk
from engines.pymunk.written_script import script
from reference.forces import Damper, Force, Spring, Torque, TorsionDamper, TorsionSpring
from reference.joints import Drive, Gear, Pin, Roll, Skate, Slot, Weld
from reference.mechanism import Body, Mechanism
from reference.scenes import SCENES
from reports.check.law import accelerations

# Numbers are written with all their digits. What is left is the rounding of two ways to the same place, times the
# condition of the rows: largest, 2e-13, for ten four-bars in line, which stand 0.05 rad from a singular position.
SAME = 1e-12
LARGE = 60
IDEAL = [
    scene
    for scene in SCENES
    if len(scene.mechanism().bodies) <= LARGE
    and not any(isinstance(joint, Drive | Skate | Roll) for joint in scene.mechanism().joints)
]


def of_forces(welded: bool = True) -> Mechanism:
    """Springs, dampers, a gear, and perhaps a weld, with everything in motion."""
    bodies = (
        Body("a", 1.0, 0.1, (0.5, 0.0, 0.3), (0.0, 0.4, 0.8)),
        Body("b", 2.0, 0.2, (2.0, 0.0, 0.0), (0.0, 0.0, 1.6)),
        Body("c", 0.5, 0.1, (2.0, 1.0, 0.2), (-1.6, 0.0, 1.6)),
    )
    cosine, sine = np.cos(0.3), np.sin(0.3)
    joints = (
        Pin("A", None, "a", (0.0, 0.0), (-0.5 * cosine, 0.5 * sine)),
        Pin("B", None, "b", (2.0, 0.0), (0.0, 0.0)),
        Gear("g", "a", "b", 2.0, -0.6),
        Weld("w", "b", "c", (0.0, 1.0), (0.0, 0.0), 0.2),
    )
    forces = (
        Spring("s", "a", "c", (0.1, 0.0), (0.2, 0.1), 15.0, 0.7),
        Damper("d", None, "a", (0.0, 3.0), (0.2, 0.1), 0.6),
        TorsionSpring("t", "a", "b", 2.0, 0.4),
        TorsionDamper("u", None, "b", 0.3),
    )
    if not welded:
        return Mechanism(bodies[:2], joints[:3], (0.3, -9.81), (replace(forces[0], second="b"), *forces[1:]))
    return Mechanism(bodies, joints, (0.3, -9.81), forces)


def same(mechanism: Mechanism, again: Mechanism) -> None:
    """Equal accelerations, forces of all joints together on every body, and freedoms."""
    order = [again.body_index(body.name) for body in mechanism.bodies]
    found, loads = [], []
    for each in (mechanism, again):
        change = accelerations(each, each.pose, each.twist, 0.0)
        reaction = each.reaction(each.pose, change, twist=each.twist)
        found.append(change)
        loads.append((each.rows(each.pose).T @ reaction).reshape(-1, 3))
    found[1], loads[1] = found[1][order], loads[1][order]
    for first, second in (found, loads):
        assert np.abs(first - second).max() <= SAME * max(np.abs(first).max(), 1e-300)
    assert mechanism.degrees_of_freedom() == again.degrees_of_freedom()


def from_mjcf(text: str) -> Mechanism:
    model = mujoco.MjModel.from_xml_string(text)  # type: ignore[attr-defined]
    data = mujoco.MjData(model)  # type: ignore[attr-defined]
    mujoco.mj_resetDataKeyframe(model, data, 0)  # type: ignore[attr-defined]
    return read_mujoco(model, data).mechanism


def from_script(text: str, folder) -> Mechanism:
    (folder / "exported.py").write_text(text)
    return read_pymunk(runpy.run_path(str(folder / "exported.py"))["make"]()).mechanism


def test_nearly_all_scenes_of_pins_and_slots_are_here():
    assert len(IDEAL) >= 10


@pytest.mark.parametrize("scene", IDEAL, ids=lambda scene: scene.name)
@pytest.mark.parametrize("engine", [DEFAULT, TUNED], ids=lambda engine: engine.variant)
def test_a_scene_comes_back_from_mjcf(scene, engine):
    mechanism = scene.mechanism()
    same(mechanism, from_mjcf(engine.text(mechanism, 1e-3)))


def steadily_pushed(scene) -> bool:
    """pymunk forgets a constant force after every step, so that a script of its own can't have one."""
    return any(isinstance(force, Force | Torque) for force in scene.mechanism().forces)


@pytest.mark.parametrize("scene", [scene for scene in IDEAL if steadily_pushed(scene)], ids=lambda scene: scene.name)
def test_a_scene_with_a_constant_force_has_no_pymunk_script(scene):
    with pytest.raises(Unsupported, match="code of ours"):
        script(PYMUNK, scene.mechanism(), 1e-3)


@pytest.mark.parametrize(
    "scene", [scene for scene in IDEAL if not steadily_pushed(scene)], ids=lambda scene: scene.name
)
def test_a_scene_comes_back_from_a_pymunk_script(scene, tmp_path):
    mechanism = scene.mechanism()
    same(mechanism, from_script(script(PYMUNK, mechanism, 1e-3), tmp_path))


def test_a_slot_that_no_groove_joint_is_has_no_script():
    mechanism = next(scene for scene in SCENES if scene.name == "free_slider_crank").mechanism()
    turning = replace(mechanism, joints=tuple(joint for joint in mechanism.joints if not isinstance(joint, Drive)))
    moved = replace(turning, joints=(*turning.joints, Slot("beside", None, "rod", *beside(turning))))
    with pytest.raises(Unsupported, match="code of ours"):
        script(PYMUNK, moved, 1e-3)


def beside(mechanism: Mechanism) -> tuple[tuple[float, float], float, tuple[float, float]]:
    """A line through a point of the rod that is not its centre of mass, along which that point moves now."""
    rod = mechanism.bodies[mechanism.body_index("rod")]
    cosine, sine = np.cos(rod.pose[2]), np.sin(rod.pose[2])
    point = (0.1, 0.05)
    arm = np.array([cosine * point[0] - sine * point[1], sine * point[0] + cosine * point[1]])
    velocity = np.array(rod.twist[:2]) + rod.twist[2] * np.array([-arm[1], arm[0]])
    x, y = np.array(rod.pose[:2]) + arm
    return (float(x), float(y)), float(np.arctan2(velocity[1], velocity[0])), point


def test_springs_dampers_gears_and_welds_come_back(tmp_path):
    mechanism = of_forces()
    same(mechanism, from_script(script(PYMUNK, mechanism, 1e-3), tmp_path))
    # In MuJoCo a welded body is one with its parent: there is no third body to come back.
    assert len(from_mjcf(TUNED.text(mechanism, 1e-3)).bodies) == 2
    mechanism = of_forces(welded=False)
    same(mechanism, from_mjcf(TUNED.text(mechanism, 1e-3)))


def test_a_mechanism_that_differs_a_little_does_not_pass_for_the_same():
    mechanism = of_forces()
    heavier = replace(mechanism.bodies[1], inertia=mechanism.bodies[1].inertia * (1 + 1e-9))
    with pytest.raises(AssertionError):
        same(mechanism, replace(mechanism, bodies=(mechanism.bodies[0], heavier, mechanism.bodies[2])))


@pytest.mark.parametrize("name", ["pinned_body_free", "pendulum_1", "pendulum_2", "pendulum_10", "person_one_foot"])
def test_a_tree_comes_back_from_urdf_at_rest(name):
    mechanism = next(scene for scene in SCENES if scene.name == name).mechanism()
    still = replace(mechanism, bodies=tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in mechanism.bodies))
    model = mujoco.MjModel.from_xml_string(urdf(still))  # type: ignore[attr-defined]
    model.opt.gravity[:] = [*still.gravity, 0.0]
    same(still, read_mujoco(model).mechanism)
