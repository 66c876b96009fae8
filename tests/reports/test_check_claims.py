"""The sentences of `crosscheck check`: each says what the numbers behind it say, and the other one if they change."""

from __future__ import annotations

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from engines import Unsupported
from engines.reading import Reading
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory
from reports.check.checked import Checked, Plan, parts_of, tried
from reports.check.document import data
from reports.check.facts import facts_of
from reports.check.judging import errors, opening, refuse_disagreement
from reports.check.telling import answer, number, sections
from tests.reports.test_check import FOUR_BAR, PENDULUM, found_in


@pytest.fixture(scope="module")
def soft(tmp_path_factory):
    """What is found in a four-bar as MuJoCo is shipped."""
    return found_in(tmp_path_factory.mktemp("soft"), FOUR_BAR, duration=0.2)


@pytest.fixture(scope="module")
def swing(tmp_path_factory):
    """What is found in a pendulum of pymunk whose step nobody named."""
    return found_in(tmp_path_factory.mktemp("swing"), PENDULUM, "swing.py", "swing.py:make", tolerance=1e-2)


def priced(found: Checked, *rows: tuple[float, float], tolerance: float) -> Checked:
    """The same check with settings of these errors and costs, the user's own first."""
    own = found.table[0]
    table = [
        replace(
            own,
            change=replace(own.change, words=f"setting {index}"),
            errors=replace(own.errors, whole=np.full_like(own.errors.t, error)),
            run=replace(own.run, stepping=cost),
        )
        for index, (error, cost) in enumerate(rows)
    ]
    return replace(found, table=table, tolerance=tolerance)


def told(found: Checked, label: str) -> str:
    """What the first screen says of this."""
    return dict(answer(found).facts)[label]


# ---------------------------------------------------------------------------------------------------------- advice


@pytest.mark.parametrize(
    ("rows", "tolerance", "said"),
    [
        # (error, cost) of the user's own settings first.
        ([(1e-5, 1.0), (1e-6, 2.0)], 1e-4, "no setting that was tried meets it much cheaper."),
        ([(1e-5, 1.0), (2e-5, 0.5)], 1e-4, "setting 1: the error is 2e-5 instead of 1e-5, at 0.5 times"),
        ([(1e-3, 1.0), (2e-5, 0.5), (1e-5, 3.0)], 1e-4, "setting 1: the error is"),
        ([(1e-3, 1.0), (2e-5, 4.0)], 1e-4, "the error is 2e-5 instead of 1e-3, at 4 times your CPU time."),
        ([(1e-3, 1.0), (2e-3, 0.5)], 1e-4, "none of the 2 documented settings that were tried meets 1e-4; the"),
        ([(1e-3, 1.0), (5e-4, 9.0)], 1e-4, "the best reached 5e-4 (setting 1)."),
    ],
)
def test_the_advice_is_the_cheapest_setting_that_is_enough(soft, rows, tolerance, said):
    found = priced(soft, *rows, tolerance=tolerance)
    assert said in told(found, "advice")
    assert found.met == (rows[0][0] <= tolerance)
    assert bool(answer(found).code) == (": the error is" in told(found, "advice") and not found.met)


def test_a_tenth_is_counted_from_the_error_of_the_advised_setting(soft):
    """Not from the tolerance: 2e-5 is a tenth of 1e-4 and more, and no tenth of 3e-5."""
    rows = [(1e-3, 1.0), (3e-5, 2.0), (9e-6, 4.0), (3e-6, 6.0)]
    found = priced(soft, *rows, tolerance=1e-4)
    assert found.decade is not None
    assert "A tenth of that error costs 3 times as much: setting 3." in told(found, "advice")
    without = priced(soft, *rows[:3], tolerance=1e-4)
    assert without.decade is None
    assert "A tenth" not in told(without, "advice")


def test_the_verdict_meets_where_the_error_is_within_the_tolerance_and_misses_where_not(soft):
    for error, word in ((1e-4, "met"), (1.001e-4, "missed")):
        found = priced(soft, (error, 1.0), tolerance=1e-4)
        said = "model.xml in MuJoCo is off by up to 1e-4 in 0.2 s"
        assert found.verdict == f"{said}; the tolerance of 1e-4 is {word}."
        assert replace(found, asked=False).verdict == f"{said}."
    gone = replace(soft.table[0], errors=replace(soft.own_errors, finished=False))
    lost = replace(soft, table=[gone], asked=False)
    assert lost.verdict == "model.xml in MuJoCo gives up before 0.2 s."
    assert data(lost)["error"] is None  # infinity is no number of JSON


def test_what_is_assumed_is_said_first_and_only_where_it_is(swing, soft, tmp_path):
    first = sections(swing)[0].sentences[0]
    assert re.match(r"With a step of 0\.01667 s, since .*--step\), swing\.py in pymunk is off by", first)
    assert told(swing, "assumed") == data(swing)["assumed"]
    assert data(swing)["assumed"]
    named = found_in(tmp_path, PENDULUM, "swing.py", "swing.py:make", tolerance=1e-2, step=1 / 60)
    assert named.verdict.startswith("swing.py in pymunk")
    assert told(named, "assumed").startswith("a step of 16.67 ms, as in the model")
    assert data(soft)["assumed"] == ""
    slow = replace(soft.table[0], run=replace(soft.own, stepping=0.25))
    assert data(replace(soft, table=[slow]))["cpu"] == 0.25


def test_the_users_own_settings_are_in_the_table_however_long_they_took(soft):
    """A run of more than LONGEST leaves no time for others, and is itself one of the settings."""
    reading, slow = soft.reading, replace(soft.own, stepping=50.0)
    truth = soft.judge.trajectory
    (only,) = tried(reading, truth, 100, 1, slow, lambda number, count: None, Plan(0.0), 1e-4)
    assert only.run is slow
    assert only.error == errors(reading.mechanism, truth, slow).largest
    assert "none of the 1 documented settings" in told(replace(soft, table=[only]), "advice")


# ----------------------------------------------------------------------------------------------------------- parts


def off_by(found: Checked, size: float, step: float):
    """The user's own settings at another step, with a run that is this far off the judge's motion [m, rad]."""
    truth = found.judge.trajectory
    run = replace(truth, pose=truth.pose + size * np.array([0.0, 0.0, 1.0]))
    return replace(found.table[0], run=run, change=replace(found.table[0].change, dt=step))


@pytest.mark.parametrize(
    # It falls if the last of the steps takes a quarter of it away.
    ("sizes", "falls"),
    [
        ([4e-3, 2e-3, 1.4e-3], True),
        ([4e-3, 2e-3, 1.6e-3], False),
        ([1e-3, 2e-3], False),
        ([1e-3], True),
        ([7e-3], False),
    ],
)
def test_an_error_that_still_falls_is_told_from_one_that_no_longer_does(swing, sizes, falls):
    smaller = [off_by(swing, size, 0.01 / 2**place) for place, size in enumerate(sizes)]
    truth = swing.judge.trajectory
    parts = parts_of(swing.reading, truth, off_by(swing, 8e-3, 0.02).run, smaller)
    assert (parts.step, parts.rest, parts.falling) == (pytest.approx(8e-3), pytest.approx(sizes[-1]), falls)
    why = told(replace(swing, parts=parts), "why")
    assert ("and still falls" in why) == falls
    assert ("and no longer falls" in why) == (not falls)
    assert "the step of 16.67 ms makes 8e-3" in why
    assert f"at {10 / 2 ** (len(sizes) - 1):.3g} ms it is {number(sizes[-1])}" in why


def test_the_joint_that_opens_most_is_named_with_its_gap_and_time(soft):
    mechanism, t = soft.reading.mechanism, soft.own.t
    gap = np.abs(mechanism.gap(soft.own.pose, t))
    sample, row = np.unravel_index(int(np.nanargmax(gap)), gap.shape)
    said = re.search(r"(.*) opens most: (.*) m at (.*) s", told(soft, "joint"))
    assert said is not None
    assert said[1] == mechanism.row_names[row]
    assert float(said[2]) == pytest.approx(gap[sample, row], rel=0.05)
    assert float(said[3]) == pytest.approx(t[sample], rel=0.01)


# ----------------------------------------------------------------------------------------------------------- facts


def four_bar(crank: float, coupler: float, rocker: float, ground: float, start: float, rate: float, drive: bool):
    """A weightless one whose crank turns at a constant rate, with its motion over 3 s."""
    lengths = {"crank": crank, "coupler": coupler, "rocker": rocker, "ground": (ground, 0.0)}
    scene = DrivenFourBar(**lengths, start=start, rate=rate, gravity=(0.0, 0.0))
    mechanism, motion = scene.mechanism(), scene.motion(np.linspace(0.0, 3.0, 301))
    if not drive:
        mechanism = replace(mechanism, joints=mechanism.joints[:-1])
        motion = replace(motion, reaction=motion.reaction[:, :-1])
    return mechanism, motion


@pytest.mark.parametrize("drive", [True, False])
def test_dead_centres_are_where_crank_and_coupler_are_in_line(drive, soft):
    """There the diagonal from the crank's foot to the rocker's tip is the sum, or the difference, of the two."""
    a, b, c, d, start, rate = 0.2, 0.8, 0.5, 0.9, 0.3, 2.0
    facts = facts_of(*four_bar(a, b, c, d, start, rate, drive))
    wanted = []
    for reach, turn in ((b + a, 0.0), (b - a, np.pi)):
        line = np.arccos((reach**2 + d**2 - c**2) / (2 * reach * d))
        wanted.append(((line + turn - start) % (2 * np.pi)) / rate)
    found = facts.dead_centres
    assert {name for _, name in found} == {"rocker"}
    # Linear between samples of 10 ms: the times are good to much less than one.
    assert [t for t, _ in found] == pytest.approx(sorted(t for t in wanted if t <= 3.0), abs=1e-3)
    assert len(found) >= 1
    read = " ".join(sections(replace(soft, facts=facts))[1].sentences)
    assert f"Dead centres, where a body turns back: rocker at {found[0][0]:.3g} s" in read
    assert "No position on the way is near-singular." in read
    assert facts.singular == ()


def test_the_moment_in_which_a_parallelogram_is_flat_is_near_singular(soft):
    """Flat at half a turn of the crank, where its rows depend on one another, and at no other time in 3 s."""
    facts = facts_of(*four_bar(0.3, 0.8, 0.3, 0.8, start=0.4, rate=1.0, drive=False))
    ((at, size),) = facts.singular
    assert at == pytest.approx(np.pi - 0.4, abs=0.011)
    assert size < 1e-2
    read = " ".join(sections(replace(soft, facts=facts))[1].sentences)
    assert f"Near-singular positions on the way: 1, the nearest at {at:.3g} s" in read
    assert "No position on the way is near-singular." not in read


def test_growth_and_the_fastest_motion_are_told_as_they_are(soft):
    def read(found):
        return " ".join(sections(found)[1].sentences)

    assert re.search(r"are [\d.]+ times as far apart after 0\.2 s: not exponential", told(soft, "motion"))
    wild = replace(soft, judge=replace(soft.judge, horizon=0.1))
    before = number(float(soft.own_errors.whole[soft.own_errors.t <= 0.1].max()))
    assert "neighbouring starts part exponentially from 0.1 s on, tenfold every" in told(wild, "motion")
    assert f"until then your run is off by {before}" in told(wild, "motion")
    # At 40 rad/s a radian takes 25 ms: 12.5 of the steps of 2 ms.
    fast = replace(soft, facts=replace(soft.facts, fastest_rotation=3.0, stiffest_mode=40.0))
    assert "a radian of the fastest takes 0.025 s, 12 of your steps." in read(fast)


@pytest.mark.parametrize("rate", [1e-3, 1e3])
def test_accelerations_that_should_be_zero_are_compared_with_those_of_the_mechanisms_own_size(rate):
    """A wheel that turns steadily: a thousandth of the square of its rate is a thousandth in any unit of time."""
    wheel = Body("wheel", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, rate))
    mechanism = Mechanism((wheel,), (Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0)),), (0.0, 0.0))
    off = np.array([[0.0, 0.0, 1e-3 * mechanism.time_scale**-2]])
    model = SimpleNamespace(engine="toy", softly_held=False, elements=(), suspects={}, start=lambda: off)
    with pytest.raises(Unsupported, match=r"differ from those of the ideal mechanism by 0\.001 of"):
        refuse_disagreement(Reading(mechanism, cast(Any, model), ()))


def test_what_opens_by_an_angle_is_told_in_radians():
    body = Body("wheel", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    joints = (Pin("axle", None, "wheel", (0.0, 0.0), (0.0, 0.0)), Drive("motor", None, "wheel", 0.0, 0.0))
    mechanism = Mechanism((body,), joints, (0.0, 0.0))
    pose = np.zeros((3, 1, 3))
    pose[1, 0] = [1e-3, 0.0, 0.2]
    run = Trajectory(np.arange(3.0), pose, np.zeros((3, 1, 3)), np.zeros((3, 3)), 0.0)
    found = opening(mechanism, run)
    assert found is not None
    assert (found.gap, found.unit, found.t) == (pytest.approx(0.2), "rad", 1.0)
    # A kilometre long, 1 m of it is less than 0.2 rad.
    bodies = (replace(body, name="cabin", pose=(1e3, 0.0, 0.0)), body)
    joints = (*joints, Pin("cable", None, "cabin", (0.0, 0.0), (-1e3, 0.0)))
    pose = np.array([[[1e3, 0.0, 0.0], [0.0, 0.0, 0.0]], [[1001.0, 0.0, 0.0], [0.0, 0.0, 0.2]]])
    run = Trajectory(np.arange(2.0), pose, np.zeros_like(pose), np.zeros((2, 5)), 0.0)
    found = opening(Mechanism(bodies, joints, (0.0, 0.0)), run)
    assert found is not None
    assert (found.gap, found.unit) == (pytest.approx(0.2), "rad")


# ------------------------------------------------------------------------------------------------------- reactions


def test_reactions_that_rigid_bodies_do_not_determine_are_not_compared_and_said_so(soft):
    """A beam between two pins: how much it is pulled along itself nobody can tell; what each bears across, one can."""
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
    facts = facts_of(mechanism, truth)
    assert facts.undetermined == (names[0], names[2])
    assert facts.redundant == 1

    def worst(change):
        return errors(mechanism, truth, replace(truth, reaction=true + change)).worst["reaction"]

    assert worst([50.0, 0, 50.0, 0, 0, 0]) == 0
    assert worst([0, 0.981, 0, 0, 0, 0]) == pytest.approx(0.1)
    assert worst([50.0, 0, 50.0, 0, 0, 0.0981]) == pytest.approx(0.01)
    read = " ".join(sections(replace(soft, facts=facts))[1].sentences)
    assert f"1 rows are redundant: rigid bodies alone don't tell the reactions of {names[0]}, {names[2]}" in read
    assert "so these are not compared" in read


def test_what_the_quantities_are_is_said_where_they_are_printed(soft):
    assert "energy (kinetic, and of gravity and springs) by" in told(soft, "forces")
    assert "reactions (forces and moments of the joints) are off by" in told(soft, "forces")
    truth, mechanism = soft.judge.trajectory, soft.reading.mechanism
    # Lifting everything by 1 mm adds m g h, in the largest kinetic energy.
    lifted = replace(truth, pose=truth.pose + np.array([0.0, 1e-3, 0.0]))
    weight = sum(body.mass for body in mechanism.bodies) * 9.81 * 1e-3
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1)).max()
    assert errors(mechanism, truth, lifted).worst["energy"] == pytest.approx(weight / kinetic, rel=1e-6)


@pytest.mark.parametrize("falling", [True, False])
def test_a_third_part_is_told_where_an_error_no_longer_falls(soft, falling):
    why = told(replace(soft, parts=replace(soft.parts, falling=falling, rest=0.123)), "why")
    assert ("no sign of a fault that is neither" in why) == falling
    assert ("0.12 is neither: it stays at" in why) != falling
    assert "which only stiffer ones mend" in why


def test_what_is_off_by_more_than_a_radian_tells_no_cause(soft):
    why = told(replace(soft, parts=replace(soft.parts, rest=1.5)), "why")
    assert why.startswith("not told: ")
    assert "neither" not in why
