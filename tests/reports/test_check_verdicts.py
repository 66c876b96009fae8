"""Verdicts of `crosscheck check` on models of other people, against integrations in a few coordinates of their own."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from pymunk import Body as MunkBody
from pymunk import Space
from pymunk.constraints import GearJoint, GrooveJoint, PinJoint, PivotJoint, RotaryLimitJoint, SimpleMotor, SlideJoint
from scipy.integrate import solve_ivp

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.mujoco.reading import read as read_model
from engines.pymunk import DEFAULT
from engines.pymunk.reading import read as read_space
from reference.forces import Damper, Spring
from reference.joints import Drive, Pin, Slot, bodies_of
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.check.checked import Checked, Plan, check, read
from reports.check.judging import apart, errors, judged, refuse_disagreement, soft_motion
from reports.check.request import CheckRequest, Refused, answered
from reports.check.telling import answer, sections
from tests.reports.test_check import FOUR_BAR

INPUTS = Path(__file__).parent / "inputs"
QUICK = Plan(5.0, quick=True)
G = 9.81


@cache
def checked(name: str, duration: float, tolerance: float = 1e-4, without: tuple[str, ...] = ()) -> Checked:
    return check(read(f"{name}.xml", INPUTS, without), name, duration, tolerance, plan=QUICK)


def told(found: Checked, label: str) -> str:
    return dict(answer(found).facts)[label]


def solved(rates, start, t):
    return solve_ivp(rates, (0, t[-1]), start, "DOP853", t_eval=t, rtol=1e-11, atol=1e-12).y


def one_coordinate(places, masses, inertias, force, start, t):
    """A coordinate (times,) whose places(q) are the poses (bodies, 3); force(q, rate): what acts along it."""
    weights = np.array([masses, masses, inertias]).T

    def inertia(q):
        along = np.imag(places(q + 1e-30j)) / 1e-30
        return np.sum(weights * along**2)

    def rates(at, state):
        q, rate = state
        slope = (inertia(q + 1e-5) - inertia(q - 1e-5)) / 2e-5
        return [rate, (force(q, rate) - slope * rate**2 / 2) / inertia(q)]

    return solved(rates, start, t)[0]


def along(angle, length):
    return np.array([length * np.cos(angle), length * np.sin(angle)])


def in_mujoco(name: str, t: np.ndarray) -> np.ndarray:
    """qpos (times, nq) of the model as it is, from its first keyframe."""
    model = mujoco.MjModel.from_xml_path(str(INPUTS / f"{name}.xml"))
    data = mujoco.MjData(model)
    if model.nkey:
        mujoco.mj_resetDataKeyframe(model, data, 0)
    steps, out = round(t[1] / model.opt.timestep), [data.qpos.copy()]
    for _ in t[1:]:
        mujoco.mj_step(model, data, steps)
        out.append(data.qpos.copy())
    return np.array(out)


@pytest.mark.parametrize("name", ["b40_slide_spring", "b40_tendon_spring"])
def test_a_spring_on_a_slide_is_measured_by_the_mechanism_and_not_by_its_far_end(name):
    found = checked(name, 2.0, 1e-3)

    def rates(at, state):  # angle of the sleeve, extension of the spring
        angle, q, rate, speed = state
        r, inertia = 0.4 + q, 0.2 * 0.1**2 + 2e-3 + (0.4 + q) ** 2
        turning = (-(0.2 * 0.1 + r) * G * np.sin(angle) - 2 * r * speed * rate) / inertia
        return [rate, speed, turning, r * rate**2 + G * np.cos(angle) - 60 * q]

    angle, q, *_ = solved(rates, [0.002, 0.05, 0.0, 0.0], found.own.t)
    r = 0.4 + q
    run = in_mujoco(name, found.own.t)
    # Of the sense of MuJoCo's hinge only the sign is unknown here, and the motion is symmetric.
    off = np.hypot(
        (0.4 + run[:, 1]) * np.sin(run[:, 0]) - r * np.sin(angle),
        (0.4 + run[:, 1]) * np.cos(run[:, 0]) - r * np.cos(angle),
    )
    assert found.facts.length == pytest.approx(0.45)
    assert off.max() == pytest.approx(4.80e-3, rel=2e-3)
    assert found.own_errors.largest == pytest.approx(off.max() / 0.45, rel=1e-3)
    assert not found.met
    assert not found.chaotic


def test_a_cylinder_with_spring_and_damper_is_measured_by_its_boom():
    found = checked("b02b_cylinder_spring", 2.0)
    foot, line = np.array([0.5, 0.2]), np.arctan2(0.8, 3)
    rise, reach = np.arctan2(0.25, 1.2), np.hypot(1.2, 0.25)  # the eye, seen from the boom's pin at (0, 1)
    (boom, tube, rod) = found.reading.mechanism.bodies
    tube_at = np.hypot(tube.pose[0] - foot[0], tube.pose[1] - foot[1])
    rod_at = np.hypot(rod.pose[0] - foot[0], rod.pose[1] - foot[1])

    def cylinder(q):
        to = np.array([0.0, 1.0]) + along(rise + q, reach) - foot
        return np.sqrt(to[0] ** 2 + to[1] ** 2), np.arctan(to[1] / to[0])

    begin, angle = cylinder(0.0)

    def places(q):
        length, turned = cylinder(q)
        centre = np.array([0.0, 1.0]) + along(line + q, np.hypot(3, 0.8) / 2)
        return np.array(
            [
                [*centre, q],
                [*(foot + along(turned, tube_at)), turned - angle],
                [*(foot + along(turned, rod_at + length - begin)), turned - angle],
            ]
        )

    masses, inertias = ([getattr(body, field) for body in (boom, tube, rod)] for field in ("mass", "inertia"))

    def force(q, rate):
        slope = np.imag(cylinder(q + 1e-30j)[0]) / 1e-30
        way = cylinder(q)[0] - begin
        falls = np.imag(places(q + 1e-30j))[:, 1] / 1e-30
        return -np.dot(masses, falls) * G - (9000 * (way - 0.05) + 400 * slope * rate) * slope

    t = found.own.t
    q = one_coordinate(places, masses, inertias, force, [0.0, 0.0], t)
    judge = found.judge.trajectory.pose[:, 0, 2]
    assert np.abs((judge - judge[0]) - q).max() < 1e-8
    assert found.facts.length == pytest.approx(np.hypot(3, 0.8) / 2, rel=1e-3)
    assert np.abs(np.abs(in_mujoco("b02b_cylinder_spring", t)[:, 0]) - np.abs(q)).max() <= found.own_errors.largest
    assert found.own_errors.largest == pytest.approx(5.5e-3, rel=0.02)
    assert found.judge.grown < 100


def test_one_freedom_goes_on_through_a_dead_centre_and_is_judged_to_the_end():
    found = checked("b21_coupling_rod", 1.0, 0.01)
    # Three equal cranks, and a rod that only moves in parallel: one angle.
    begin, inertia = (
        np.arctan2(0.16, 0.12),
        sum(body.inertia + 0.01 for body in found.reading.mechanism.bodies if body.name != "rod"),
    )

    def rates(at, state):
        return [state[1], -G * (3 * 0.1 + 2 * 0.2) * np.cos(state[0]) / (inertia + 2 * 0.2**2)]

    turned = solved(rates, [begin, -2.0], found.own.t)[0] - begin
    judge = found.judge.trajectory.pose[:, 0, 2]
    assert np.abs(judge - judge[0] - turned).max() < 1e-9
    run = in_mujoco("b21_coupling_rod", found.own.t)  # its hinges turn the other way; the wheels are 0, 2 and 3
    off = np.abs(-run[:, [0, 2, 3]] - turned[:, None]).max()
    assert off == pytest.approx(0.656, rel=1e-3)
    assert found.own_errors.largest == pytest.approx(off, rel=1e-6)
    assert found.duration == 1.0
    assert "not exponential" in told(found, "motion")
    assert found.advised is not None
    assert found.advised.error == pytest.approx(5.4e-4, rel=0.02)


@pytest.mark.parametrize("scale", [1e-3, 1.0, 1e3])
def test_a_parallelogram_passes_its_dead_centres_on_the_branch_on_which_it_arrives(scale):
    """Where two curves cross: there the multipliers of one row are lost, and velocities go on."""
    crank, start = 0.2 * scale, np.arctan2(0.16, 0.12)
    names, at = ("left", "rod", "right"), (0.0, 1.0 * scale)
    pin = [np.array([x, 0.0]) for x in at]
    tip = along(start, crank)
    rate = -2.0
    speed = crank * rate * np.array([-np.sin(start), np.cos(start)])
    centres = [pin[0] + tip / 2, pin[0] + tip + [scale / 2, 0.0], pin[1] + tip / 2]
    poses = [(*centre, angle) for centre, angle in zip(centres, (start, 0.0, start), strict=True)]
    twists = [(*speed / 2, rate), (*speed, 0.0), (*speed / 2, rate)]
    masses = np.array([1.0, 2.0, 1.0])
    own = Mechanism(
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

    judge = judged(own, 200, 0.01, 1e-4)
    turned = solved(rates, [start, rate], judge.trajectory.t)[0]
    assert np.count_nonzero(np.diff(np.floor(turned / np.pi))) >= 2  # dead centres
    assert np.abs(judge.trajectory.pose[:, 0, 2] - turned).max() < 1e-7
    assert judge.horizon == judge.trajectory.t[-1]
    assert not judge.cut
    # Forces and accelerations belong to the motion: M a = f + J^T F.
    assert np.isfinite(judge.trajectory.reaction).all()


def test_a_torque_that_is_zero_by_symmetry_is_no_measure_of_an_error():
    found = checked("b04_gripper", 0.3, 1e-4, ("actuation", "limit"))
    mechanism, truth = found.reading.mechanism, found.judge.trajectory
    forces, torques = (np.abs(truth.reaction[:, rows]) for rows in (~mechanism.turning, mechanism.turning))
    assert torques.max() < 1e-9 * forces.max() * found.facts.length
    assert found.own_errors.worst["reaction"] < 0.01
    assert found.advised is not None
    off = np.abs(found.advised.run.reaction - truth.reaction)[:, ~mechanism.turning].max()
    assert off < 1e-5 * forces.max()  # the compliance that the stiffest loop keeps
    # The measure compares vectors of two components, and here single components.
    assert off / forces.max() / 2 < found.advised.reaction < 2 * off / forces.max()


def test_the_error_of_a_force_does_not_depend_on_the_axes_in_which_it_is_counted():
    scene = FreeFourBar(duration=0.3)
    mechanism = scene.mechanism()
    truth = TRUTH.build(mechanism, 1e-3)(30, 10)
    run = DEFAULT.build(mechanism, 1e-3)(30, 10)
    measured = errors(mechanism, truth, run).worst["reaction"]
    sine, cosine = np.sin(0.7), np.cos(0.7)
    turn = np.kron(np.eye(mechanism.row_count // 2), [[cosine, -sine], [sine, cosine]])  # all rows are those of pins
    ideal, stepped = (replace(motion, reaction=motion.reaction @ turn.T) for motion in (truth, run))
    assert errors(mechanism, ideal, stepped).worst["reaction"] == pytest.approx(measured, rel=1e-9)


def test_the_impulse_that_starts_a_motor_is_no_error_of_forces_or_energy():
    space = Space()
    space.gravity = (0, -9.81)
    crank, rod = MunkBody(1.0, 0.02), MunkBody(1.0, 0.05)
    crank.position, rod.position = (0.1, 0), (0.5, 0)
    space.add(crank, rod, PivotJoint(space.static_body, crank, (0, 0), (-0.1, 0)))
    space.add(PivotJoint(crank, rod, (0.1, 0), (-0.3, 0)), SimpleMotor(space.static_body, crank, -3.0))
    found = check(read_space(space, step=1e-3), "motor", 0.2, 1e-4, plan=Plan(1.0, quick=True))
    error = found.own_errors
    assert found.reading.jumps
    assert all(
        np.isnan(error.of[name][:2]).all() and np.isfinite(error.of[name][2:]).all() for name in ("energy", "reaction")
    )
    counted = errors(found.reading.mechanism, found.judge.trajectory, found.own)
    assert counted.worst["reaction"] > 10 * error.worst["reaction"]


def test_a_torque_that_an_engine_invents_is_no_less_wrong_where_the_true_one_is_zero():
    found = checked("b04_gripper", 0.3, 1e-4, ("actuation", "limit"))
    mechanism, truth = found.reading.mechanism, found.judge.trajectory
    wrong = truth.reaction + 0.1 * mechanism.turning * np.abs(truth.reaction).max() * found.facts.length
    run = type(truth)(truth.t, truth.pose, truth.twist, wrong, 0.0)
    assert errors(mechanism, truth, run).worst["reaction"] > 0.05


def test_a_loop_that_a_weld_locks_is_said_to_be_locked_first_and_that_a_connect_was_perhaps_meant():
    found = checked("b23_weld_locks", 0.5)
    assert re.search(
        r"^b23_weld_locks in MuJoCo can't move, .* \(weld C holds .*; connect, .* was perhaps meant\)", found.verdict
    )
    assert np.isnan(found.own_errors.worst["energy"])
    assert "energy" not in told(found, "forces")
    assert "nothing can move" in told(found, "motion")


@pytest.mark.parametrize("gravity", [0.0, -9.81])
@pytest.mark.parametrize("second", ["pivot", "gear", "motor"])
def test_a_locked_space_is_said_to_be_locked(gravity, second):
    space = Space()
    space.gravity = (0, gravity)
    body = MunkBody(2, 0.2)
    body.position = (0.5, 0)
    more = {
        "pivot": PivotJoint(space.static_body, body, (1, 0), (0.5, 0)),
        "gear": GearJoint(space.static_body, body, 0, 1),
        "motor": SimpleMotor(space.static_body, body, 0),
    }
    space.add(body, PivotJoint(space.static_body, body, (0, 0), (-0.5, 0)), more[second])
    found = check(read_space(space, 0.01), "gate", 0.5, 1e-4, plan=QUICK)
    assert "gate in pymunk can't move, since its joints leave no freedom" in found.verdict
    assert sections(found)
    assert found.judge.grown == 1


def test_a_rod_that_only_the_second_order_locks_is_refused():
    """In line with the hinge and pushed across: no force of a rigid rod holds it, and no motion is allowed."""
    space = Space()
    space.gravity = (0, -9.81)
    body = MunkBody(2, 0.2)
    body.position = (0.5, 0)
    rod = PinJoint(space.static_body, body, (2.5, 0), (1.0, 0))
    space.add(body, PivotJoint(space.static_body, body, (0, 0), (-0.5, 0)), rod)
    with pytest.raises(Exception, match="singular position"):
        judged(read_space(space, 0.01).mechanism, 20, 0.01, 1e-4)


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("far", [0.0, 1e3])
def test_no_far_point_of_a_line_enters_the_length_or_the_time(scale, far):
    """A block in a groove of a swinging bar, with spring and damper along it: from the near end and from far away."""
    bar, block = (
        Body("bar", 1.0, 0.1 * scale**2, (0, 0, 0.3)),
        Body("block", 0.5, 1e-3 * scale**2, (*(0.4 * scale * along(0.3, 1)), 0.3)),
    )
    slot = Slot("groove", "bar", "block", (0.1 * scale, 0.0), 0.0, (0.0, 0.0))
    ends = ("bar", "block", (-far * scale, 0.0), (0.0, 0.0))
    spring = Spring("spring", *ends, 200.0, (far + 0.5) * scale)
    own = Mechanism(
        (bar, block),
        (slot, Drive("straight", "bar", "block", 0.0, 0.0)),
        (0.0, -G * scale),
        (spring, Damper("damper", *ends, 2.0)),
    )
    assert own.length_scale == pytest.approx(0.1 * scale)
    # At the slot's point the bar feels a force as 1 / m + r^2 / I, and the block as 1 / m.
    assert own.time_scale == pytest.approx(1 / np.sqrt(200 * (1 + 0.1**2 / 0.1 + 2)))
    # Alone on the ground the extension is all that has a length.
    groove = Slot("groove", None, "block", (-far * scale, 0.0), 0.0, (0.0, 0.0))
    held = Spring("spring", None, "block", (-far * scale, 0.0), (0.0, 0.0), 20.0, (far + 0.5) * scale)
    alone = Mechanism((Body("block", 0.5, 1.0, (0.2 * scale, 0.0, 0.0)),), (groove,), (0.0, 0.0), (held,))
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
    if kind == "turned ground":  # the angle of a body that stands still counts as it does in pymunk
        lower.angle = 0.5
        lower.position = (1.0 + 0.4 * np.sin(0.5), -0.4 * np.cos(0.5))
        space.static_body.angle = 0.2
    hinge = PivotJoint(space.static_body, upper, space.static_body.world_to_local((0, 0)), (-0.5, 0))
    space.add(hinge, PivotJoint(upper, lower, (0.5, 0), (0, 0.4)), LIMITED[kind][both_sided](upper, lower))
    return space


@pytest.mark.parametrize("kind", LIMITED)
def test_a_limit_whose_ends_are_one_is_the_joint_that_holds_it(kind):
    found = check(read_space(limited(kind, False), 1e-3), kind, 0.5, 1e-4, plan=QUICK)
    same = read_space(limited(kind, True), 1e-3).mechanism
    own = found.reading.mechanism
    assert own.degrees_of_freedom() == same.degrees_of_freedom() == (1, 1)
    truth = judged(same, 20, 0.025).trajectory
    np.testing.assert_allclose(judged(own, 20, 0.025).trajectory.pose, truth.pose, rtol=0, atol=1e-10)
    assert any("its min and max are equal" in note.reason for note in found.reading.notes)
    assert found.own_errors.largest < 0.02  # pymunk follows the joint, to the first order of its step
    # It is no limit, so leaving limits out leaves it in.
    assert read_space(limited(kind, False), 1e-3, ("limit",)).mechanism.degrees_of_freedom() == (1, 1)


def test_a_distance_of_zero_is_refused_with_the_joint_that_holds_it():
    space = limited("weld", True)
    upper, lower = space.bodies
    space.add(SlideJoint(upper, lower, (0.5, 0), (0, 0.4), 0, 0))
    with pytest.raises(Unsupported, match="its min and max are zero, which has no direction; give a PivotJoint"):
        read_space(space, 1e-3)


def test_a_range_without_a_width_limits_nothing_in_mujoco_and_check_says_so():
    text = (
        '<mujoco><worldbody><body><joint name="j" axis="0 1 0" range="30 30"/><geom size=".1" pos=".3 0 0"/></body>'
        "</worldbody></mujoco>"
    )
    reading = read_model(mujoco.MjModel.from_xml_string(text))
    assert [note.element for note in reading.notes] == ["joint 'j'"]
    assert reading.notes[0].reason.startswith("MuJoCo does not limit it")
    assert reading.mechanism.degrees_of_freedom() == (1, 1)


ACTING = {
    "limit": 'range="-5 5"',
    "frictionloss": 'frictionloss="0.1"',
}


@pytest.mark.parametrize("element", [*ACTING, "contact", "fluid", "sleep"])
def test_nothing_that_acts_in_the_motion_is_advised_to_be_left_out(tmp_path, element):
    option = {"fluid": 'viscosity="1"'}.get(element, "")
    flag = '<flag sleep="enable"/>' if element == "sleep" else ""
    floor = '<geom type="plane" size="1 1 1" pos="0 0 -.2"/>' if element == "contact" else ""
    (tmp_path / "model.xml").write_text(
        f"<mujoco><option {option}>{flag}</option><worldbody>{floor}<body>"
        f'<joint axis="0 1 0" {ACTING.get(element, "")}/><geom size=".1" pos=".3 0 0"/></body></worldbody></mujoco>'
    )
    refused = answered(CheckRequest("model.xml", str(tmp_path), 1.0, 1e-2, quick=True))
    assert isinstance(refused, Refused)
    assert refused.sentence.endswith(f"--without {element} judges your model without it, which moves otherwise")
    assert "give --without" not in refused.sentence
    assert "or --without" not in refused.sentence


LOOPS = {
    "as shipped": "",
    "stiff": 'solref="0.01 1" solimp="0.9999 0.9999 0.001 0.5 1"',
}
CONNECT = '<connect name="C" body1="coupler" body2="rocker" anchor="0.8 0 0.3"'


@pytest.mark.parametrize("turned", ["0 0 0", "20 35 10"])
@pytest.mark.parametrize("values", LOOPS)
def test_the_declared_softness_of_a_loop_follows_the_diagonal_that_the_flag_selects(values, turned):
    """In MuJoCo's rows, the world's axes: in a turned plane the compliance of a loop is no multiple of one number."""
    run, soft = {}, {}
    for flag in ("enable", "disable"):
        text = FOUR_BAR.replace(
            '<option timestep="0.002"/>',
            f'<option timestep="1e-4" integrator="RK4"><flag diagexact="{flag}"/></option>',
        )
        text = text.replace(CONNECT, f"{CONNECT} {LOOPS[values]}")
        text = text.replace("<worldbody>", f'<worldbody><body euler="{turned}">').replace(
            "</worldbody>", "</body></worldbody>"
        )
        reading = read_model(mujoco.MjModel.from_xml_string(text))
        assert refuse_disagreement(reading) < 1e-7
        run[flag] = reading.model.run(10, 200)
        soft[flag] = soft_motion(reading.mechanism, reading.model.give, run[flag].t)
        assert apart(reading.mechanism, soft[flag], run[flag].pose).max() < 1e-8
    assert apart(reading.mechanism, soft["enable"], run["disable"].pose).max() > 1e-7  # the flag matters


@pytest.mark.parametrize(
    "loop", ['<weld name="C" body1="coupler" body2="rocker"/>', '<joint joint1="A" joint2="D" polycoef="0 .5 0 0 0"/>']
)
def test_the_exact_diagonal_of_a_weld_and_of_a_coupling_is_read_too(loop):
    text = re.sub(r"<connect.*?/>", loop, FOUR_BAR).replace(
        '<option timestep="0.002"/>', '<option timestep="1e-4" integrator="RK4"><flag diagexact="enable"/></option>'
    )
    reading = read_model(mujoco.MjModel.from_xml_string(text))
    assert refuse_disagreement(reading) < 1e-7
    run = reading.model.run(5, 200)
    soft = soft_motion(reading.mechanism, reading.model.give, run.t)
    assert apart(reading.mechanism, soft, run.pose).max() < 1e-7


@pytest.mark.parametrize("reach", [1.0, 1e4])
def test_no_end_of_a_groove_enters_the_length_of_a_space(reach):
    space = Space()
    bar, block = MunkBody(1, 0.2), MunkBody(0.5, 0.1)
    bar.position, block.position = (0.5, 0), (0.9, 0.1)
    space.add(bar, block, PivotJoint(space.static_body, bar, (0, 0), (-0.5, 0)))
    space.add(GrooveJoint(bar, block, (-reach, 0.1), (reach, 0.1), (0, 0)))
    mechanism = read_space(space, 0.01).mechanism
    assert mechanism.length_scale == pytest.approx(np.hypot(0.9, 0.1))
    assert np.abs(mechanism.gap(mechanism.pose, 0.0)).max() < 1e-12 * reach
