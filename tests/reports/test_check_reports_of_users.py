"""Models rebuilt after public reports of users: `crosscheck check` gives the error that an independent integration has.

The first line of each of these models in `inputs` names its report. The engine is run here from the file itself, and
compared with multipliers in MuJoCo's tree or in absolute coordinates: no reading and no judge enters that error.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import runpy
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray

from reports.check.checked import Checked, Plan, check, read
from tests import independent
from tests.independent_spaces import Equations

INPUTS = Path(__file__).parent / "inputs"
STEP = 1e-3  # s, of pymunk
# The judge is good to 1e-10 and both integrations to 1e-11; the motions spread that up to 200 times, and the smallest
# error here is 1e-4. Measured: 2e-7.
CLOSE = 1e-6


def own_errors(poses: NDArray[Any], truth: NDArray[Any]) -> tuple[float, float]:
    """The largest error of angles [rad] and of places [m] of poses (times, bodies, 2 or 3 places and an angle)."""
    off = np.abs(poses - truth)
    return off[..., -1].max(), np.linalg.norm(off[..., :-1], axis=-1).max()


def of_mujoco(path: Path, t: NDArray[Any]) -> tuple[float, float, int]:
    """Errors of the model as it is at instants t, and the freedoms of the ideal one."""
    model = mujoco.MjModel.from_xml_path(str(path))

    def begin() -> Any:
        data = mujoco.MjData(model)
        if model.nkey:
            mujoco.mj_resetDataKeyframe(model, data, 0)
        mujoco.mj_kinematics(model, data)
        return data

    data, run = begin(), []
    steps = round(t[1] / model.opt.timestep)
    hinges = [j for j in range(model.njnt) if model.jnt_type[j] == mujoco.mjtJoint.mjJNT_HINGE]
    axis = data.xaxis[hinges[0] if hinges else 0].copy()
    for _ in t:
        run.append(data.qpos.copy())
        mujoco.mj_step(model, data, steps)

    def poses(coordinates: NDArray[Any]) -> NDArray[Any]:
        turns = np.zeros((model.nbody, model.nv))
        for body in range(1, model.nbody):
            turns[body] = turns[model.body_parentid[body]]
            for joint in set(hinges) & set(model.body_jntadr[body] + np.arange(model.body_jntnum[body])):
                turns[body, model.jnt_dofadr[joint]] = np.round(data.xaxis[joint] @ axis)
        out = []
        for data.qpos[:] in coordinates:
            mujoco.mj_kinematics(model, data)
            mujoco.mj_comPos(model, data)
            out.append(np.column_stack([data.xipos, turns @ data.qpos])[1:])
        return np.array(out)

    held = independent.equalities(model)
    runs = poses(np.array(run))
    coordinates, forces = independent.motion(model, begin(), held, t)
    return *own_errors(runs, poses(coordinates)), model.nv - forces.shape[1]


def of_pymunk(path: Path, t: NDArray[Any]) -> tuple[float, float]:
    """Errors of the script's space, stepped as it is."""
    truth = Equations(runpy.run_path(str(path))["space"]).motion(t)
    space, run = runpy.run_path(str(path))["space"], []
    for _ in t:
        run.append([(*body.position, body.angle) for body in space.bodies])
        for _ in range(round(t[1] / STEP)):
            space.step(STEP)
    return own_errors(np.array(run), truth)


def checked(path: Path, duration: float) -> Checked:
    """Of the settings as they are; nothing else is tried."""
    step = STEP if path.suffix == ".py" else None
    return check(read(path.name, path.parent, step=step), path.name, duration, 1e-4, plan=Plan(0.0))


@pytest.mark.parametrize(
    ("name", "duration", "freedoms"),
    [
        ("fast_motor", 2.0, 1),
        ("jansen_leg", 2.0, 1),
        ("excavator", 2.0, 2),
        ("leg_with_crank", 2.0, 2),
        ("five_bar", 2.0, 2),
        ("sliding_fingers", 1.0, 1),
        ("differential", 1.0, 2),
        ("steering_rack", 1.0, 1),
        ("b05_mimic_ring", 1.0, 1),
        ("b19_rack", 1.0, 1),
    ],
)
def test_the_error_of_a_mujoco_model_is_that_of_an_independent_integration(name, duration, freedoms):
    found = checked(INPUTS / f"{name}.xml", duration)
    angle, place, free = of_mujoco(INPUTS / f"{name}.xml", found.own_errors.t)
    assert free == freedoms
    assert found.facts.freedoms == (freedoms, freedoms)
    assert found.own_errors.worst["angle"] == pytest.approx(angle, rel=CLOSE, abs=1e-12)
    assert found.own_errors.worst["position"] == pytest.approx(place, rel=CLOSE)
    assert found.own_errors.largest == pytest.approx(max(angle, place / found.facts.length), rel=0.02)


@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("spider_legs", 0.5),
        ("klann_leg", 1.0),
        ("belt", 1.0),
        ("chain_with_load", 0.2),
        ("steam_piston", 1.0),
        ("desk_lamp", 1.0),
        ("free4", 1.0),
        ("jansen_linkage", 0.5),
    ],
)
def test_the_error_of_a_pymunk_script_is_that_of_an_independent_integration(name, duration):
    found = checked(INPUTS / f"{name}.py", duration)
    angle, place = of_pymunk(INPUTS / f"{name}.py", found.own_errors.t)
    assert found.own_errors.worst["angle"] == pytest.approx(angle, rel=CLOSE)
    assert found.own_errors.worst["position"] == pytest.approx(place, rel=CLOSE)


def test_a_plane_and_an_order_of_bodies_change_no_error(tmp_path):
    """The excavator with its bodies in reverse order, in a plane across all axes."""
    tree = xml.parse(INPUTS / "excavator.xml")
    world, option = tree.find("worldbody"), tree.find("option")
    assert world is not None
    assert option is not None
    turn = np.array([0.8, 0.3, -0.4, 0.33]) / np.linalg.norm([0.8, 0.3, -0.4, 0.33])
    frame = xml.Element("frame", quat=" ".join(map(repr, turn.tolist())))
    for parent in list(world.iter("body")):
        parent[:] = [*[child for child in parent if child.tag != "body"], *reversed(parent.findall("body"))]
    frame.extend(world)
    world[:] = [frame]
    gravity = np.zeros(3)
    mujoco.mju_rotVecQuat(gravity, np.array([0, 0, -9.81]), turn)
    option.set("gravity", " ".join(map(repr, gravity.tolist())))
    tree.write(tmp_path / "turned.xml")
    straight, turned = checked(INPUTS / "excavator.xml", 1.0), checked(tmp_path / "turned.xml", 1.0)
    assert turned.facts.length == pytest.approx(straight.facts.length, rel=1e-9)
    assert turned.own_errors.worst["angle"] == pytest.approx(straight.own_errors.worst["angle"], rel=CLOSE)
    assert turned.own_errors.worst["position"] == pytest.approx(straight.own_errors.worst["position"], rel=CLOSE)
