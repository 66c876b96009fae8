"""The sentences of `crosscheck check`: each says what the numbers behind it say, and the other one if they change."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.trajectory import Trajectory
from reports.check.checked import Checked, parts_of, tried
from reports.check.facts import facts_of
from reports.check.judging import Errors, errors, opening
from reports.check.telling import data, sections, verdict
from tests.reports.test_check import FOUR_BAR, PENDULUM, found_in


@pytest.fixture(scope="module", autouse=True)
def _quick():
    """Few settings are tried: what is asked here is what is said of them."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("reports.check.checked.PATIENCE", 0.3)
        yield


@pytest.fixture(scope="module")
def soft(tmp_path_factory):
    """What is found in a four-bar as MuJoCo is shipped."""
    return found_in(tmp_path_factory.mktemp("soft"), FOUR_BAR, duration=0.2)


@pytest.fixture(scope="module")
def swing(tmp_path_factory):
    """What is found in a pendulum of pymunk whose step nobody named."""
    return found_in(tmp_path_factory.mktemp("swing"), PENDULUM, "swing.py", "swing.py:make", tolerance=1e-2)


def priced(found: Checked, *rows: tuple[float, float], tolerance: float, own: int = 0) -> Checked:
    """The same check with settings of these errors and costs; the user's own are those of the row `own`."""
    table = [replace(found.table[0], error=error, cost=cost) for error, cost in rows]
    table = [replace(each, change=replace(each.change, words=f"setting {i}")) for i, each in enumerate(table)]
    whole = np.full_like(found.own_errors.t, rows[own][0])
    errors = Errors(found.own_errors.t, found.own_errors.of, whole, finished=True)
    return replace(found, table=table, own_errors=errors, cost=rows[own][1], tolerance=tolerance)


def answer(found: Checked) -> str:
    return " ".join(sections(found)[0].sentences)


def source(found: Checked) -> str:
    (told,) = [each for each in sections(found) if each.title == "Where the error comes from"]
    return " ".join(told.sentences)


def rows_of(found: Checked) -> dict[str, str]:
    """The marks of the table of settings, by what is tried."""
    (told,) = [each for each in sections(found) if each.title == "What to change"]
    return {row[0]: row[-1] for row in told.rows}


# ---------------------------------------------------------------------------------------------------------- advice


@pytest.mark.parametrize(
    ("rows", "tolerance", "said"),
    [
        # (error, cost) of the user's own settings first.
        ([(1e-5, 1.0), (1e-6, 2.0)], 1e-4, "No setting that was tried meets it much cheaper."),
        ([(1e-5, 1.0), (2e-5, 0.5)], 1e-4, "The cheapest documented setting that meets it: setting 1."),
        ([(1e-3, 1.0), (2e-5, 0.5), (1e-5, 3.0)], 1e-4, "The cheapest documented setting that meets it: setting 1."),
        ([(1e-3, 1.0), (2e-5, 4.0)], 1e-4, "Its error is 2e-05 instead of 0.001, at 4 times your CPU time."),
        ([(1e-3, 1.0), (2e-3, 0.5)], 1e-4, "None of the 2 documented settings that were tried meets it; the best"),
        ([(1e-3, 1.0), (5e-4, 9.0)], 1e-4, "the best reached 0.0005 (setting 1)."),
    ],
)
def test_the_advice_is_the_cheapest_setting_that_is_enough(soft, rows, tolerance, said):
    found = priced(soft, *rows, tolerance=tolerance)
    assert said in answer(found)
    assert found.met == (rows[0][0] <= tolerance)
    assert bool(sections(found)[0].code) == ("that meets it: " in answer(found) and not found.met)


def test_a_tenth_is_counted_from_the_error_of_the_advised_setting(soft):
    """Not from the tolerance: 2e-5 is a tenth of 1e-4 and more, and no tenth of 3e-5."""
    rows = [(1e-3, 1.0), (3e-5, 2.0), (9e-6, 4.0), (3e-6, 6.0)]
    found = priced(soft, *rows, tolerance=1e-4)
    assert found.decade is not None
    assert "A tenth of that error costs 3 times as much: setting 3." in answer(found)
    without = priced(soft, *rows[:3], tolerance=1e-4)
    assert without.decade is None
    assert "A tenth of that error was not reached by any setting that was tried." in answer(without)


def test_the_verdict_meets_where_the_error_is_within_the_tolerance_and_misses_where_not(soft):
    for error, word in ((1e-4, "meet"), (1.001e-4, "miss")):
        found = priced(soft, (error, 1.0), tolerance=1e-4)
        assert verdict(found).startswith(f"Your settings {word} the tolerance: the largest error in 0.2 s is 0.0001")
    gone = replace(soft, own_errors=replace(soft.own_errors, finished=False))
    assert verdict(gone) == "Your settings miss the tolerance: MuJoCo gave up before 0.2 s."


def test_what_is_assumed_is_said_first_and_only_where_it_is(swing, soft, tmp_path):
    first = sections(swing)[0].sentences[0]
    assert re.match(r"Assumed: a step of 0\.01667 s, .*--step\)\. With it, the settings m..[ts] the tolerance", first)
    assert data(swing)["assumed"]
    named = found_in(tmp_path, PENDULUM, "swing.py", "swing.py:make", tolerance=1e-2, step=1 / 60)
    assert verdict(named).startswith("Your settings")
    assert data(soft)["assumed"] == ""
    assert data(soft)["cpu"] == soft.own.stepping > 0


def test_settings_with_the_same_errors_are_listed_once_by_the_cheapest_or_the_users_own(soft):
    errors = [(1e-3, 2.0), (1e-3, 1.0), (1e-5, 6.0), (1e-5, 5.0), (1e-5, 7.0), (1e-6, 9.0)]
    marks = rows_of(priced(soft, *errors, tolerance=1e-4))
    assert marks == {
        "setting 0": "1 more alike",
        "setting 3": "none is both cheaper and better; meets the tolerance; 2 more alike",
        "setting 5": "none is both cheaper and better; meets the tolerance",
    }


def test_the_users_own_settings_are_in_the_table_however_long_they_took(soft):
    """A run of more than LONGEST leaves no time for others, and is itself one of the settings."""
    reading, slow = soft.reading, replace(soft.own, stepping=50.0)
    truth = soft.judge.trajectory
    (only,) = tried(reading, truth, 100, 1, slow, lambda number, count: None, patience=0.0)
    assert only.run is slow
    assert only.error == errors(reading.mechanism, truth, slow).largest
    assert "None of the 1 documented settings" in answer(replace(soft, table=[only]))


# ----------------------------------------------------------------------------------------------------------- parts


def off_by(found: Checked, size: float, step: float):
    """The user's own settings at another step, with a run that is this far off the judge's motion [m, rad]."""
    truth = found.judge.trajectory
    run = replace(truth, pose=truth.pose + size * np.array([0.0, 0.0, 1.0]))
    return replace(found.table[0], run=run, error=size, change=replace(found.table[0].change, dt=step))


@pytest.mark.parametrize(
    # It falls if the last of the steps takes a quarter of it away.
    ("sizes", "falls"),
    [([4e-3, 2e-3, 1.4e-3], True), ([4e-3, 2e-3, 1.6e-3], False), ([1e-3, 2e-3], False), ([1e-3], False)],
)
def test_an_error_that_still_falls_is_told_from_one_that_no_longer_does(swing, sizes, falls):
    smaller = [off_by(swing, size, 0.01 / 2**place) for place, size in enumerate(sizes)]
    truth = swing.judge.trajectory
    parts = parts_of(swing.reading, truth, off_by(swing, 8e-3, 0.02).run, smaller)
    assert (parts.step, parts.rest, parts.falling) == (pytest.approx(8e-3), sizes[-1], falls)
    told = source(replace(swing, parts=parts))
    assert ("it still falls: the step explains it" in told) == falls
    assert ("it no longer falls: a smaller step is no help" in told) == (not falls)
    assert f"off the ideal motion by 0.008; at a step of {10 / 2 ** (len(sizes) - 1):.3g} ms" in told


@pytest.mark.parametrize("falling", [True, False])
def test_a_third_part_is_told_where_an_error_no_longer_falls(soft, falling):
    told = source(replace(soft, parts=replace(soft.parts, falling=falling, rest=0.123)))
    assert ("0.12 is left, and it still falls: there is no sign of a third part." in told) == falling
    assert ("0.12 is left, and it no longer falls: this much neither softness nor step explains." in told) != falling
    assert "No smaller step removes this; stiffer joints do." in told


def test_joints_that_are_coordinates_are_not_called_soft(tmp_path):
    hinged = re.sub(r"<equality>.*</equality>", "", FOUR_BAR)
    found = found_in(tmp_path, hinged, duration=0.1)
    assert "Softness: none. The joints are coordinates here, which can't part." in source(found)
    assert found.parts.softness == 0


def test_the_joint_that_opens_most_is_named_with_its_gap_and_time(soft):
    mechanism, t = soft.reading.mechanism, soft.own.t
    gap = np.abs(mechanism.gap(soft.own.pose, t))
    sample, row = np.unravel_index(int(np.nanargmax(gap)), gap.shape)
    told = re.search(r"The joint that opens most is (.*): (.*) m at (.*) s\.", source(soft))
    assert told is not None
    assert told[1] == mechanism.row_names[row]
    assert float(told[2]) == pytest.approx(gap[sample, row], rel=0.05)
    assert float(told[3]) == pytest.approx(t[sample], rel=0.01)


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
    told = facts.dead_centres
    assert {name for _, name in told} == {"rocker"}
    # Linear between samples of 10 ms: the times are good to much less than one.
    assert [t for t, _ in told] == pytest.approx(sorted(t for t in wanted if t <= 3.0), abs=1e-3)
    assert len(told) >= 1
    read = " ".join(sections(replace(soft, facts=facts))[1].sentences)
    assert f"Dead centres, where a body turns back: rocker at {told[0][0]:.3g} s" in read
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

    assert "which is not exponential" in read(soft)
    wild = replace(soft, judge=replace(soft.judge, horizon=0.1))
    assert "From about 0.1 s on, small errors grow exponentially" in read(wild)
    assert "which is not exponential" not in read(wild)
    # At 40 rad/s a radian takes 25 ms: 12.5 of the steps of 2 ms.
    fast = replace(soft, facts=replace(soft.facts, fastest_rotation=3.0, stiffest_mode=40.0))
    assert "a radian of the fastest takes 0.025 s, 12 of your steps." in read(fast)


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
        return errors(mechanism, truth, replace(truth, reaction=true + change)).worst("reaction")

    assert worst([50.0, 0, 50.0, 0, 0, 0]) == 0
    assert worst([0, 0.981, 0, 0, 0, 0]) == pytest.approx(0.1)
    assert worst([50.0, 0, 50.0, 0, 0, 0.0981]) == pytest.approx(0.01)
    read = " ".join(sections(replace(soft, facts=facts))[1].sentences)
    assert f"1 rows are redundant: rigid bodies alone don't tell the reactions of {names[0]}, {names[2]}" in read
    assert "so these are not compared" in read


def test_what_the_quantities_are_is_said_where_they_are_printed(soft):
    (own,) = [each for each in sections(soft) if each.title == "Your own settings"]
    assert "Energy is the kinetic energy and the potentials of gravity and springs together" in " ".join(own.sentences)
    truth, mechanism = soft.judge.trajectory, soft.reading.mechanism
    # Lifting everything by 1 mm adds m g h, in the largest kinetic energy.
    lifted = replace(truth, pose=truth.pose + np.array([0.0, 1e-3, 0.0]))
    weight = sum(body.mass for body in mechanism.bodies) * 9.81 * 1e-3
    kinetic = 0.5 * np.sum(mechanism.inertias * truth.twist**2, axis=(-2, -1)).max()
    assert errors(mechanism, truth, lifted).worst("energy") == pytest.approx(weight / kinetic, rel=1e-6)
