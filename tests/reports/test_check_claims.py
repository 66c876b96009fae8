"""Tests of the advice, the parts of the error, the facts and the text in the report of `crosscheck check`."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from pymunk import Body as MunkBody
from pymunk import Space
from pymunk.constraints import PinJoint, PivotJoint, SimpleMotor

from engines import Unsupported
from engines.lagrange import TRUTH
from engines.pymunk import DEFAULT
from engines.pymunk.reading import read as read_space
from engines.reading import Reading, ReadingTerms
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.trajectory import Trajectory
from reports.check.checked import CheckResult, SweepPlan, check, read_user_model, split_error
from reports.check.document import check_data
from reports.check.facts import compute_facts
from reports.check.judging import find_opening, measure_errors, reference_motion, refuse_disagreement
from reports.check.rendering import plain
from reports.check.settings import with_costs
from reports.check.telling import answer_section, report_sections
from tests.reports.test_check import FOUR_BAR, INPUTS, PENDULUM, found_in


@pytest.fixture(scope="module")
def soft(tmp_path_factory):
    """The result of a check of a four-bar with MuJoCo's default settings."""
    return found_in(tmp_path_factory.mktemp("soft"), FOUR_BAR, duration=0.2)


@pytest.fixture(scope="module")
def swing(tmp_path_factory):
    """The result of a check of a pymunk pendulum without a given step."""
    return found_in(tmp_path_factory.mktemp("swing"), PENDULUM, "swing.py", "swing.py:make", tolerance=1e-2)


def with_settings(found: CheckResult, *rows: tuple[float, float], tolerance: float) -> CheckResult:
    """A copy of a result with these (error, cost) in its table; the first row has the user's settings."""
    first = found.table[0]
    table = [
        replace(
            first,
            change=replace(first.change, words=f"setting {index}"),
            errors=replace(
                first.errors,
                of={name: np.full_like(first.errors.t, error) for name in first.errors.of},
                whole=np.full_like(first.errors.t, error),
            ),
            cost=cost,
            front=True,
        )
        for index, (error, cost) in enumerate(rows)
    ]
    return replace(found, table=table, tolerance=tolerance)


# ---------------------------------------------------------------------------------------------------------- advice


@pytest.mark.parametrize(
    ("rows", "advised", "tenth"),
    [
        # Pairs (error, cost) of the settings; the user's settings come first. `tenth` is the setting with a tenth of
        # the advised error.
        ([(1e-5, 1.0), (1e-6, 2.0)], 0, 1),
        ([(1e-5, 1.0), (2e-5, 0.5)], 1, None),
        ([(1e-3, 1.0), (2e-5, 0.5), (1e-5, 3.0)], 1, None),
        ([(1e-3, 1.0), (2e-5, 4.0)], 1, None),
        ([(1e-3, 1.0), (2e-3, 0.5)], None, None),
        ([(1e-3, 1.0), (3e-5, 2.0), (9e-6, 4.0), (3e-6, 6.0)], 1, 3),
        ([(1e-3, 1.0), (3e-5, 2.0), (2e-5, 2.4), (1e-5, 2.6), (1e-6, 4.0)], 2, 4),  # 2.0 and 2.4 are equal costs
    ],
)
def test_the_advice_is_the_cheapest_setting_within_the_tolerance(soft, rows, advised, tenth):
    result = with_settings(soft, *rows, tolerance=1e-4)
    assert result.met == (rows[0][0] <= 1e-4)
    for setting, index in ((result.advised, advised), (result.decade, tenth)):
        assert (setting is None and index is None) or setting is result.table[index]
    assert bool(answer_section(result).code) == (advised is not None and not result.met)


def test_a_cost_is_the_number_of_steps_times_the_least_time_of_a_step_of_a_finished_run_with_the_same_options(soft):
    first = soft.table[0]
    runs = [  # options, step [s], measured CPU time [s], whether the run finished, expected cost [s]
        ("a", 1e-3, 9.0, True, 2.0),
        ("a", 5e-4, 4.0, True, 4.0),
        ("a", 2.5e-4, 0.1, False, 8.0),
        ("b", 1e-3, 3.0, False, 3.0),
    ]
    table = [
        replace(
            first,
            change=replace(first.change, options=((name, 1),), dt=dt),
            errors=replace(first.errors, finished=finished),
            run=replace(first.run, stepping=seconds),
        )
        for name, dt, seconds, finished, _ in runs
    ]
    assert [setting.cost for setting in with_costs(table)] == pytest.approx([cost for *_, cost in runs], rel=1e-12)


def test_an_error_equal_to_the_tolerance_meets_it_and_a_larger_one_does_not(soft):
    for error, met in ((1e-4, True), (1.001e-4, False)):
        assert with_settings(soft, (error, 1.0), tolerance=1e-4).met == met
    diverged = replace(soft.table[0], errors=replace(soft.own_errors, finished=False))
    assert check_data(replace(soft, table=[diverged]))["error"] is None  # JSON has no infinity


def test_the_text_of_the_report(soft, golden):
    """Errors and costs are fixed numbers, since measured costs depend on the machine."""
    errors_of_judge = replace(soft.judge_errors, of=dict.fromkeys(soft.own_errors.of, 1e-12 + 0 * soft.judge_errors.t))
    rows = [(1e-3, 1.0), (3e-5, 2.0), (3e-6, 6.0)]
    parts = replace(soft.parts, softness=8e-4, step=2e-4, rest=5e-5, smallest=1e-4, falling=True)
    result = replace(
        with_settings(soft, *rows, tolerance=1e-4), agreement=1e-15, judge_errors=errors_of_judge, parts=parts
    )
    wild = replace(result, judge=replace(result.judge, horizon=0.1, growth=np.linspace(1.0, 1e4, len(result.own.t))))
    texts = {
        "a missed tolerance": report_sections(result),
        "a tolerance that is met": [answer_section(replace(result, tolerance=1e-2))],
        "no tolerance": [answer_section(replace(result, has_tolerance=False))],
        "no setting is enough": [answer_section(replace(result, tolerance=1e-9))],
        "exponential growth": [answer_section(wild)],
        "neither softness nor step": [answer_section(replace(result, parts=replace(parts, falling=False)))],
        "more than a radian": [answer_section(replace(result, parts=replace(parts, rest=1.5)))],
        "no declared softness": [answer_section(replace(result, parts=replace(parts, divided=False)))],
    }
    golden("check.txt", "\n".join(f"==== {title}\n{plain(reported)}" for title, reported in texts.items()))


# ----------------------------------------------------------------------------------------------------------- parts


def off_by(found: CheckResult, size: float, step: float):
    """The user's settings with the step `step` [s] and a run whose angles have the error `size` [rad]."""
    truth = found.judge.trajectory
    run = replace(truth, pose=truth.pose + size * np.array([0.0, 0.0, 1.0]))
    return replace(found.table[0], run=run, change=replace(found.table[0].change, dt=step))


@pytest.mark.parametrize(
    # The error counts as falling if the smallest step reduces it by more than a quarter.
    ("sizes", "falls"),
    [([4e-3, 2e-3, 1.4e-3], True), ([4e-3, 2e-3, 1.6e-3], False), ([1e-3, 2e-3], False), ([7e-3], False)],
)
def test_an_error_that_still_decreases_is_distinguished_from_a_plateau(swing, sizes, falls):
    smaller = [off_by(swing, size, 0.01 / 2**halvings) for halvings, size in enumerate(sizes)]
    parts = split_error(swing.reading, swing.judge.trajectory, off_by(swing, 8e-3, 0.02).run, smaller)
    assert (parts.step, parts.rest, parts.falling) == (pytest.approx(8e-3), pytest.approx(sizes[-1]), falls)


# ----------------------------------------------------------------------------------------------------------- facts


def four_bar(crank: float, coupler: float, rocker: float, ground: float, start: float, rate: float, drive: bool):
    """A four-bar without gravity whose crank turns at a constant rate, and its motion over 3 s."""
    lengths = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": (ground, 0.0)}
    scene = DrivenFourBar(**lengths, start=start, rate=rate, gravity=(0.0, 0.0))
    mechanism, motion = scene.mechanism(), scene.motion(np.linspace(0.0, 3.0, 301))
    if not drive:
        mechanism = replace(mechanism, joints=mechanism.joints[:-1])
        motion = replace(motion, reaction=motion.reaction[:, :-1])
    return mechanism, motion


@pytest.mark.parametrize("drive", [True, False])
def test_dead_centres_are_where_crank_and_coupler_are_in_line(drive):
    """At a dead centre the distance from the crank's pivot to the rocker's end is coupler length plus or minus crank
    length."""
    a, b, c, d, start, rate = 0.2, 0.8, 0.5, 0.9, 0.3, 2.0
    facts = compute_facts(*four_bar(a, b, c, d, start, rate, drive))
    wanted = []
    for reach, turn in ((b + a, 0.0), (b - a, np.pi)):
        line = np.arccos((reach**2 + d**2 - c**2) / (2 * reach * d))
        wanted.append(((line + turn - start) % (2 * np.pi)) / rate)
    result = facts.dead_centres
    assert {name for _, name in result} == {"rocker"}
    # The times are interpolated linearly between samples 10 ms apart.
    assert [t for t, _ in result] == pytest.approx(sorted(t for t in wanted if t <= 3.0), abs=1e-3)
    assert len(result) >= 1
    assert facts.singular == ()


def test_singular_positions_of_a_motion_are_reported_with_their_times():
    scene = NFourBar(loops=1)
    passed = scene.singular_times(1.5)
    facts = compute_facts(scene.mechanism(), scene.motion(np.union1d(np.linspace(0.0, 1.5, 151), passed)))
    assert facts.freedoms == (1, 1)
    assert [t for t, _ in facts.singular] == pytest.approx(passed, abs=1e-9)
    assert len(passed) >= 1
    assert max(ratio for _, ratio in facts.singular) < 1e-9


@pytest.mark.parametrize("rate", [1e-3, 1e3])
def test_accelerations_that_should_be_zero_are_compared_with_those_of_the_mechanisms_own_size(rate):
    """A wheel turns at a constant rate. The relative error 1e-3 must not depend on the unit of time."""
    wheel = Body("wheel", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, rate))
    mechanism = Mechanism((wheel,), (Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0)),), (0.0, 0.0))
    off = np.array([[0.0, 0.0, 1e-3 * mechanism.time_scale**-2]])
    model = SimpleNamespace(engine="toy", has_soft_joints=False, elements=(), suspects={}, start=lambda: off)
    with pytest.raises(Unsupported, match=r"differ from those of the ideal mechanism by 0\.001 of"):
        refuse_disagreement(Reading(mechanism, cast(Any, model), ()))


def test_a_violation_of_an_angle_is_reported_in_radians():
    body = Body("wheel", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    joints = (Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0)), Drive("motor", None, "wheel", 0.0, 0.0))
    mechanism = Mechanism((body,), joints, (0.0, 0.0))
    pose = np.zeros((3, 1, 3))
    pose[1, 0] = [1e-3, 0.0, 0.2]
    run = Trajectory(np.arange(3.0), pose, np.zeros((3, 1, 3)), np.zeros((3, 3)), 0.0)
    opening = find_opening(mechanism, run)
    assert opening is not None
    assert (opening.gap, opening.unit, opening.t) == (pytest.approx(0.2), "rad", 1.0)
    # In a mechanism of 1 km the relative gap of 1 m is smaller than an angle of 0.2 rad.
    bodies = (replace(body, name="cabin", pose=(1e3, 0.0, 0.0)), body)
    joints = (*joints, Pin("cable", None, "cabin", (0.0, 0.0), (-1e3, 0.0)))
    pose = np.array([[[1e3, 0.0, 0.0], [0.0, 0.0, 0.0]], [[1001.0, 0.0, 0.0], [0.0, 0.0, 0.2]]])
    run = Trajectory(np.arange(2.0), pose, np.zeros_like(pose), np.zeros((2, 5)), 0.0)
    opening = find_opening(Mechanism(bodies, joints, (0.0, 0.0)), run)
    assert opening is not None
    assert (opening.gap, opening.unit) == (pytest.approx(0.2), "rad")


# ------------------------------------------------------------------------------------------------------- reactions


def test_reactions_that_rigid_bodies_do_not_determine_are_not_compared():
    """The axial force of a beam between two pins is indeterminate; the transverse force on each pin is unique."""
    beam = Body("beam", 2.0, 0.2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    other = Body("bob", 1.0, 0.1, (2.0, -1.0, 0.0), (0.0, 0.0, 0.0))
    joints = (
        Pin("left", None, "beam", (-1.0, 0.0), (-1.0, 0.0)),
        Pin("right", None, "beam", (1.0, 0.0), (1.0, 0.0)),
        Pin("swing", None, "bob", (2.0, 0.0), (0.0, 1.0)),
    )
    mechanism = Mechanism((beam, other), joints, (0.0, -9.81))
    names = mechanism.row_names
    t = np.array([0.0, 1.0])
    pose, twist = np.tile(mechanism.pose, (2, 1, 1)), np.zeros((2, 2, 3))
    true = np.tile([3.0, 9.81, -3.0, 9.81, 0.0, 9.81], (2, 1))
    truth = Trajectory(t, pose, twist, true, 0.0)
    facts = compute_facts(mechanism, truth)
    assert facts.undetermined == (names[0], names[2])
    assert facts.redundant == 1

    def worst(change):
        return measure_errors(mechanism, truth, replace(truth, reaction=true + change)).worst["reaction"]

    assert worst([50.0, 0, 50.0, 0, 0, 0]) == 0
    assert worst([0, 0.981, 0, 0, 0, 0]) == pytest.approx(0.1)
    assert worst([50.0, 0, 50.0, 0, 0, 0.0981]) == pytest.approx(0.01)


def test_the_error_of_the_energy_is_relative_to_the_largest_kinetic_energy(soft):
    truth, mechanism = soft.judge.trajectory, soft.reading.mechanism
    # Lifting all bodies by 1 mm changes the energy by m g h, relative to the largest kinetic energy.
    lifted = replace(truth, pose=truth.pose + np.array([0.0, 1e-3, 0.0]))
    weight = sum(body.mass for body in mechanism.bodies) * 9.81 * 1e-3
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1)).max()
    assert measure_errors(mechanism, truth, lifted).worst["energy"] == pytest.approx(weight / kinetic, rel=1e-6)


def test_a_torque_that_is_zero_by_symmetry_is_not_the_scale_of_reaction_errors():
    reading = read_user_model("b04_gripper.xml", INPUTS, ReadingTerms(("actuation", "limit")))
    result = check(reading, "gripper", 0.3, 1e-4, plan=SweepPlan(5.0, quick=True))
    mechanism, truth = result.reading.mechanism, result.judge.trajectory
    forces, torques = (np.abs(truth.reaction[:, rows]) for rows in (~mechanism.is_angular, mechanism.is_angular))
    assert torques.max() < 1e-9 * forces.max() * result.facts.length
    assert result.own_errors.worst["reaction"] < 0.01
    assert result.advised is not None
    off = np.abs(result.advised.run.reaction - truth.reaction)[:, ~mechanism.is_angular].max()
    assert off < 1e-5 * forces.max()  # The difference is the compliance of the stiffest loop.
    # The measured error is the error of vectors with two components, and `off` is the error of single components.
    assert off / forces.max() / 2 < result.advised.reaction < 2 * off / forces.max()
    wrong = truth.reaction + 0.1 * mechanism.is_angular * np.abs(truth.reaction).max() * result.facts.length
    run = type(truth)(truth.t, truth.pose, truth.twist, wrong, 0.0)
    assert measure_errors(mechanism, truth, run).worst["reaction"] > 0.05


def test_the_error_of_a_force_does_not_depend_on_the_axes():
    scene = FreeFourBar(duration=0.3)
    mechanism = scene.mechanism()
    truth = TRUTH.build(mechanism, 1e-3)(30, 10)
    run = DEFAULT.build(mechanism, 1e-3)(30, 10)
    measured = measure_errors(mechanism, truth, run).worst["reaction"]
    sine, cosine = np.sin(0.7), np.cos(0.7)
    turn = np.kron(np.eye(mechanism.row_count // 2), [[cosine, -sine], [sine, cosine]])  # all joints are pins
    ideal, stepped = (replace(motion, reaction=motion.reaction @ turn.T) for motion in (truth, run))
    assert measure_errors(mechanism, ideal, stepped).worst["reaction"] == pytest.approx(measured, rel=1e-9)


def test_the_initial_impulse_of_a_motor_is_not_an_error_of_forces_or_energy():
    space = Space()
    space.gravity = (0, -9.81)
    crank, rod = MunkBody(1.0, 0.02), MunkBody(1.0, 0.05)
    crank.position, rod.position = (0.1, 0), (0.5, 0)
    space.add(crank, rod, PivotJoint(space.static_body, crank, (0, 0), (-0.1, 0)))
    space.add(PivotJoint(crank, rod, (0.1, 0), (-0.3, 0)), SimpleMotor(space.static_body, crank, -3.0))
    result = check(read_space(space, step=1e-3), "motor", 0.2, 1e-4, plan=SweepPlan(1.0, quick=True))
    error = result.own_errors
    assert result.reading.jumps
    assert all(
        np.isnan(error.of[name][:2]).all() and np.isfinite(error.of[name][2:]).all() for name in ("energy", "reaction")
    )
    counted = measure_errors(result.reading.mechanism, result.judge.trajectory, result.own)
    assert counted.worst["reaction"] > 10 * error.worst["reaction"]


def test_a_mechanism_that_only_second_order_terms_lock_is_refused():
    """The joints allow no motion, although the rod is in line with the hinge and can't bear a transverse force."""
    space = Space()
    space.gravity = (0, -9.81)
    body = MunkBody(2, 0.2)
    body.position = (0.5, 0)
    rod = PinJoint(space.static_body, body, (2.5, 0), (1.0, 0))
    space.add(body, PivotJoint(space.static_body, body, (0, 0), (-0.5, 0)), rod)
    with pytest.raises(Exception, match="singular position"):
        reference_motion(read_space(space, 0.01).mechanism, 20, 0.01, 1e-4)
