"""Verdicts of `crosscheck check` on users' models, compared with integrations that share no code with the judge.

The models in `inputs` follow public reports of users; the first line of a model names the report. The engine runs the
file itself; the ideal motion is integrated with multipliers, in MuJoCo's joint coordinates or in absolute coordinates.
"""

# pyright: reportAttributeAccessIssue=false
# (MuJoCo's bindings are compiled and carry no types.)

from __future__ import annotations

import re
import runpy
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from numpy.typing import NDArray
from pymunk import Body as MunkBody
from pymunk import Space
from pymunk.constraints import GearJoint, PinJoint, PivotJoint, RotaryLimitJoint, SlideJoint
from scipy.integrate import solve_ivp

from engines.mujoco.reading import read as read_model
from engines.pymunk.reading import read as read_space
from engines.reading import ReadingTerms
from reference.forces import Damper, Spring
from reference.joints import Drive, Pin, Slot, bodies_of
from reference.mechanism import Body, Mechanism
from reports.check.checked import CheckResult, SweepPlan, check, read_user_model
from reports.check.judging import pose_distance, reference_motion, refuse_disagreement, soft_motion
from reports.check.telling import answer_section
from tests import independent
from tests.independent import Equations
from tests.reports.test_check import FOUR_BAR, INPUTS

STEP = 1e-3  # s, of pymunk
QUICK = SweepPlan(5.0, quick=True)
G = 9.81
# The errors of the judge are 1e-10, and the errors of both integrations are 1e-11. The motions amplify these errors up
# to 200 times, and the smallest compared error is 1e-4. The measured difference was 2e-7.
CLOSE = 1e-6


def own_errors(poses: NDArray[Any], truth: NDArray[Any]) -> tuple[float, float]:
    """The largest errors of angles [rad] and positions [m]. Poses have two or three coordinates, then the angle."""
    off = np.abs(poses - truth)
    return off[..., -1].max(), np.linalg.norm(off[..., :-1], axis=-1).max()


def of_mujoco(path: Path, t: NDArray[Any]) -> tuple[float, float, int]:
    """The angle error, the position error and the degrees of freedom of the user's model at times t."""
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

    stored = independent.equalities(model)
    runs = poses(np.array(run))
    coordinates, forces = independent.motion(model, begin(), stored, t)
    return *own_errors(runs, poses(coordinates)), model.nv - forces.shape[1]


def of_pymunk(path: Path, t: NDArray[Any]) -> tuple[float, float]:
    """The angle error and the position error of the space in the user's script."""
    truth = Equations(runpy.run_path(str(path))["space"]).motion(t)
    space, run = runpy.run_path(str(path))["space"], []
    for _ in t:
        run.append([(*body.position, body.angle) for body in space.bodies])
        for _ in range(round(t[1] / STEP)):
            space.step(STEP)
    return own_errors(np.array(run), truth)


def checked(path: Path, duration: float) -> CheckResult:
    """The result of a check that tries no other settings."""
    step = STEP if path.suffix == ".py" else None
    reading = read_user_model(path.name, path.parent, ReadingTerms(step=step))
    return check(reading, path.name, duration, 1e-4, plan=SweepPlan(0.0))


# Models as (name, duration [s], degrees of freedom, expected length scale [m] or None).
MUJOCO_MODELS = [
    ("fast_motor", 1.0, 1, None),
    ("jansen_leg", 1.0, 1, None),
    ("excavator", 1.0, 2, None),
    ("leg_with_crank", 1.0, 2, None),
    ("five_bar", 1.0, 2, None),
    ("sliding_fingers", 1.0, 1, None),
    ("differential", 0.5, 2, None),
    ("steering_rack", 1.0, 1, None),
    ("b05_mimic_ring", 1.0, 1, None),
    ("b19_rack", 1.0, 1, None),
    ("b40_slide_spring", 1.0, 2, 0.45),
    ("b40_tendon_spring", 1.0, 2, 0.45),
    ("b02b_cylinder_spring", 1.0, 1, np.hypot(3, 0.8) / 2),
]


@pytest.mark.parametrize(("name", "duration", "freedoms", "length"), MUJOCO_MODELS)
def test_the_error_of_a_mujoco_model_is_that_of_an_independent_integration(name, duration, freedoms, length):
    result = checked(INPUTS / f"{name}.xml", duration)
    angle_error, position_error, free = of_mujoco(INPUTS / f"{name}.xml", result.own_errors.t)
    assert free == freedoms
    assert result.facts.freedoms == (freedoms, freedoms)
    assert length is None or result.facts.length == pytest.approx(length, rel=1e-3)
    assert result.own_errors.worst["angle"] == pytest.approx(angle_error, rel=CLOSE, abs=1e-12)
    assert result.own_errors.worst["position"] == pytest.approx(position_error, rel=CLOSE)
    assert result.own_errors.largest == pytest.approx(max(angle_error, position_error / result.facts.length), rel=0.02)


@pytest.mark.parametrize(
    ("name", "duration"),
    [
        ("spider_legs", 0.2),
        ("klann_leg", 0.5),
        ("belt", 0.4),
        ("chain_with_load", 0.2),
        ("steam_piston", 0.3),
        ("desk_lamp", 0.5),
    ],
)
def test_the_error_of_a_pymunk_script_is_that_of_an_independent_integration(name, duration):
    result = checked(INPUTS / f"{name}.py", duration)
    angle_error, position_error = of_pymunk(INPUTS / f"{name}.py", result.own_errors.t)
    assert result.own_errors.worst["angle"] == pytest.approx(angle_error, rel=CLOSE)
    assert result.own_errors.worst["position"] == pytest.approx(position_error, rel=CLOSE)


def test_the_error_does_not_depend_on_the_plane_or_on_the_order_of_bodies(tmp_path):
    """The excavator is rotated to an oblique plane, and its bodies are listed in reverse order."""
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


@pytest.mark.parametrize("scale", [1e-3, 1e3])
def test_a_parallelogram_stays_on_its_branch_at_dead_centres(scale):
    """At a dead centre two branches cross and a multiplier is undefined, but velocities are continuous."""
    crank, start = 0.2 * scale, np.arctan2(0.16, 0.12)
    names, at = ("left", "rod", "right"), (0.0, 1.0 * scale)
    pin = [np.array([x, 0.0]) for x in at]
    tip = crank * np.array([np.cos(start), np.sin(start)])
    rate = -2.0
    speed = crank * rate * np.array([-np.sin(start), np.cos(start)])
    centres = [pin[0] + tip / 2, pin[0] + tip + [scale / 2, 0.0], pin[1] + tip / 2]
    poses = [(*centre, angle) for centre, angle in zip(centres, (start, 0.0, start), strict=True)]
    twists = [(*speed / 2, rate), (*speed, 0.0), (*speed / 2, rate)]
    masses = np.array([1.0, 2.0, 1.0])
    linkage = Mechanism(
        bodies_of(names, masses, 0.01 * masses * scale**2, poses, twists),
        (
            Pin("A", None, "left", (0.0, 0.0), (-crank / 2, 0.0)),
            Pin("B", "left", "rod", (crank / 2, 0.0), (-scale / 2, 0.0)),
            Pin("C", "rod", "right", (scale / 2, 0.0), (crank / 2, 0.0)),
            Pin("D", None, "right", (scale, 0.0), (-crank / 2, 0.0)),
        ),
        (0.0, -G * scale),
    )
    inertia = 2 * (0.01 * scale**2 + crank**2 / 4) + 2 * crank**2

    def rates(at, state):
        return [state[1], -G * scale * (crank + 2 * crank) * np.cos(state[0]) / inertia]

    judge = reference_motion(linkage, 200, 0.01, 1e-4)
    t = judge.trajectory.t
    turned = solve_ivp(rates, (0, t[-1]), [start, rate], "DOP853", t_eval=t, rtol=1e-11, atol=1e-12).y[0]
    assert np.count_nonzero(np.diff(np.floor(turned / np.pi))) >= 2  # dead centres
    assert np.abs(judge.trajectory.pose[:, 0, 2] - turned).max() < 1e-7
    assert judge.horizon == judge.trajectory.t[-1]
    assert not judge.cut
    # Forces and accelerations satisfy M a = f + J^T F.
    assert np.isfinite(judge.trajectory.reaction).all()


def test_the_verdict_on_a_loop_that_a_weld_locks_suggests_a_connect():
    result = check(read_user_model("b23_weld_locks.xml", INPUTS), "b23_weld_locks", 0.5, 1e-4, plan=QUICK)
    assert re.search(
        r"^b23_weld_locks in MuJoCo can't move, .* \(weld C holds .*; connect, .* was perhaps meant\)", result.verdict
    )
    assert np.isnan(result.own_errors.worst["energy"])
    facts = dict(answer_section(result).facts)
    assert "energy" not in facts["forces"]
    assert "nothing can move" in facts["motion"]


@pytest.mark.parametrize(("scale", "far"), [(1.0, 0.0), (1e-6, 1e3), (1e6, 1e3)])
def test_the_far_end_of_a_spring_along_a_slide_does_not_change_length_and_time_scale(scale, far):
    """A block slides in a groove of a swinging bar; the other end of its spring and its damper is near or far away."""
    bar, block = (
        Body("bar", 1.0, 0.1 * scale**2, (0, 0, 0.3)),
        Body("block", 0.5, 1e-3 * scale**2, (0.4 * scale * np.cos(0.3), 0.4 * scale * np.sin(0.3), 0.3)),
    )
    slot = Slot("groove", "bar", "block", (0.1 * scale, 0.0), 0.0, (0.0, 0.0))
    ends = ("bar", "block", (-far * scale, 0.0), (0.0, 0.0))
    spring = Spring("spring", *ends, 200.0, (far + 0.5) * scale)
    linkage = Mechanism(
        (bar, block),
        (slot, Drive("straight", "bar", "block", 0.0, 0.0)),
        (0.0, -G * scale),
        (spring, Damper("damper", *ends, 2.0)),
    )
    assert linkage.length_scale == pytest.approx(0.1 * scale)
    # At the slot's point the bar has the inverse inertia 1 / m + r^2 / I, and the block has 1 / m.
    assert linkage.time_scale == pytest.approx(1 / np.sqrt(200 * (1 + 0.1**2 / 0.1 + 2)))
    # A single block on the ground has only one length, the extension of the spring.
    groove = Slot("groove", None, "block", (-far * scale, 0.0), 0.0, (0.0, 0.0))
    stored = Spring("spring", None, "block", (-far * scale, 0.0), (0.0, 0.0), 20.0, (far + 0.5) * scale)
    alone = Mechanism((Body("block", 0.5, 1.0, (0.2 * scale, 0.0, 0.0)),), (groove,), (0.0, 0.0), (stored,))
    assert alone.length_scale == pytest.approx(0.3 * scale)


LIMITED = {
    "weld": (lambda a, b: RotaryLimitJoint(a, b, 0, 0), lambda a, b: GearJoint(a, b, 0, 1)),
    "rod": (
        lambda a, b: SlideJoint(a, b, (0, 0), (0, 0), 0.41**0.5, 0.41**0.5),
        lambda a, b: PinJoint(a, b, (0, 0), (0, 0)),
    ),
    "turned ground": (
        lambda a, b: RotaryLimitJoint(b.space.static_body, b, 0.3, 0.3),
        lambda a, b: GearJoint(a.space.static_body, b, 0.3, 1),
    ),
}


def limited(kind: str, both_sided: bool) -> Space:
    space = Space()
    space.gravity = (0, -G)
    upper, lower = MunkBody(2, 0.2), MunkBody(1, 0.1)
    upper.position, lower.position = (0.5, 0), (1.0, -0.4)
    space.add(upper, lower)
    if kind == "turned ground":
        lower.angle = 0.5
        lower.position = (1.0 + 0.4 * np.sin(0.5), -0.4 * np.cos(0.5))
        space.static_body.angle = 0.2
    hinge = PivotJoint(space.static_body, upper, space.static_body.world_to_local((0, 0)), (-0.5, 0))
    space.add(hinge, PivotJoint(upper, lower, (0.5, 0), (0, 0.4)), LIMITED[kind][both_sided](upper, lower))
    return space


@pytest.mark.parametrize("kind", LIMITED)
def test_a_limit_with_equal_ends_is_read_as_a_joint(kind):
    result = check(read_space(limited(kind, False), 1e-3), kind, 0.5, 1e-4, plan=QUICK)
    same = read_space(limited(kind, True), 1e-3).mechanism
    mechanism = result.reading.mechanism
    assert mechanism.degrees_of_freedom() == same.degrees_of_freedom() == (1, 1)
    truth = reference_motion(same, 20, 0.025).trajectory
    np.testing.assert_allclose(reference_motion(mechanism, 20, 0.025).trajectory.pose, truth.pose, rtol=0, atol=1e-10)
    assert any("its min and max are equal" in note.reason for note in result.reading.notes)
    assert result.own_errors.largest < 0.02  # pymunk has a joint error of first order


CONNECT = '<connect name="C" body1="coupler" body2="rocker" anchor="0.8 0 0.3"'
STIFF = 'solref="0.01 1" solimp="0.9999 0.9999 0.001 0.5 1"'
LOOPS = {
    "connect": f"{CONNECT}/>",
    "stiff connect": f"{CONNECT} {STIFF}/>",
    "weld": '<weld name="C" body1="coupler" body2="rocker"/>',
    "coupling": '<joint joint1="A" joint2="D" polycoef="0 .5 0 0 0"/>',
}


@pytest.mark.parametrize("loop", LOOPS)
def test_the_declared_softness_of_a_loop_follows_the_diagonal_that_the_flag_selects(loop):
    """The rows in MuJoCo have the directions of the world's axes, so the compliance of a loop in a rotated plane is a
    matrix."""
    run, soft = {}, {}
    turned = "20 35 10" if "connect" in loop else "0 0 0"
    for flag in ("enable", "disable"):
        option = f'<option timestep="1e-4" integrator="RK4"><flag diagexact="{flag}"/></option>'
        text = re.sub(r"<connect.*?/>", LOOPS[loop], FOUR_BAR.replace('<option timestep="0.002"/>', option))
        text = text.replace("<worldbody>", f'<worldbody><body euler="{turned}">')
        text = text.replace("</worldbody>", "</body></worldbody>")
        reading = read_model(mujoco.MjModel.from_xml_string(text))
        assert refuse_disagreement(reading) < 1e-7
        run[flag] = reading.model.run(5, 200)
        soft[flag] = soft_motion(reading.mechanism, reading.model.regularisation, run[flag].t)
        bound = 1e-8 if "connect" in loop else 1e-7
        assert pose_distance(reading.mechanism, soft[flag], run[flag].pose).max() < bound
    if "connect" in loop:
        assert pose_distance(reading.mechanism, soft["enable"], run["disable"].pose).max() > 1e-7  # the flag matters
