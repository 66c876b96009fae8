"""The pages of skates, wheels, rolling and centrodes: their experiments' reference, their code, what breaks how."""

from __future__ import annotations

import math
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import reports.pages
from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from reference.checks import InvalidMechanism
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import DiscInHole, RollingDisc, RollingEllipse, RollingOnCircle, SquareOnCatenaries
from reference.scenes.skates.sleigh import ChaplyginSleigh, SleighBackwards
from reference.scenes.skates.slopes import HeldBySkates, SkateOnSlope
from reports.model.cells import Cell
from reports.model.measure import measure, stopped_where_it_ends
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Motion, trajectory_of
from reports.pages.centrodes import page as centrodes_page
from reports.pages.rolling.experiments import absent_contact, parting
from reports.pages.skate import experiments
from reports.pages.skate.experiments import counting
from reports.pages.wheels import experiments as wheels_failures
from reports.pages.wheels import page as wheels
from tests.committed_rows import answer_to
from tests.present import present

TEMPLATE = Path(reports.pages.__file__).parent / "skate" / "page.md"
BLOCKS = re.findall(r"```python\n(.*?)```", TEMPLATE.read_text(encoding="utf-8"), re.DOTALL)

# What each block's method promises at its step of 1e-3 s: of second order its square, of fourth its fourth power; times
# the 3 s and 2.6 J / 2 kg of the motion, and room for constants. Exact ones end in rounding.
PROMISED = (1e-6, 1e-10)


def kept(tasks):
    """What there is when these tasks were run."""
    return Material({}, {task: answer_to(task) for task in tasks})


@pytest.mark.parametrize(("block", "bound"), tuple(zip(BLOCKS, PROMISED, strict=True)))
def test_the_pages_lines_run_and_are_as_exact_as_the_page_says(block, bound):
    names: dict = {}
    exec(compile(block, "skate.md", "exec"), names)
    truth = ChaplyginSleigh().motion([3.0]).pose[0, 0]
    pose = names["data"].qpos + np.array([0.5, 0.0, 0.0])  # coordinates count from where the body starts
    error = np.abs(pose - truth).max()
    assert error < 3 * bound
    # A bound that ten times the order's error would pass proves nothing.
    assert error > bound / 100 or bound == PROMISED[-1]


@pytest.mark.parametrize(
    "scene",
    [
        SkateOnSlope(),
        SkateOnSlope(turning_rate=2.0),
        SkateOnSlope(turning_rate=-0.3, heading=1.0, speed=0.4),
        SkateOnSlope(turning_rate=1e-9, heading=0.7),
        HeldBySkates(),
    ],
)
def test_skates_on_a_slope_agree_with_multipliers(scene):
    row = measure(Cell(scene, Lagrange("dop853", "projection", tolerance=1e-13), 1, samples=50), repeat=False)
    # Rounding of an integration to 1e-13 over some metres.
    assert row.position < 1e-11
    assert row.angle < 1e-11
    assert row.reaction < 1e-10


def test_bad_skates_on_a_slope_are_refused():
    with pytest.raises(InvalidMechanism, match="skate_on_slope"):
        SkateOnSlope().motion([-1.0])
    with pytest.raises(InvalidMechanism, match="2 points and 3 angles"):
        HeldBySkates(points=((0.5, 0.0), (-0.5, 0.0)))
    # Two skates never hold a body, and three do not whose axles all go through the centre of mass: it turns about it.
    for points, angles in (
        (((0.5, 0.0), (-0.5, 0.0)), (0.5, -0.5)),
        (((0.5, 0.0), (-0.5, 0.0), (0.0, 0.4)), (math.pi / 2, math.pi / 2, 0.0)),
    ):
        with pytest.raises(InvalidMechanism, match="leave 1 freedom"):
            HeldBySkates(points=points, angles=angles)


def test_the_exact_sleigh_grows_at_its_linear_rate_and_a_wrong_rate_is_told_apart():
    scene = SleighBackwards()
    t = np.linspace(0, scene.duration, scene.samples + 1)
    rate = scene.motion(t).twist[:, 0, 2]
    # The square of 0.04 over the largest rate 1.6 is what the linear motion leaves out.
    assert experiments.growth_of(t, rate) == pytest.approx(scene.growth_rate(), rel=1e-3)
    assert experiments.growth_of(t, rate) != pytest.approx(1.01 * scene.growth_rate(), rel=1e-3)
    assert math.isnan(experiments.growth_of(t, np.full_like(t, 1e-3)))


def test_the_lateral_force_passes_a_limit_when_the_reference_says():
    scene, limit = experiments.BACKWARDS, list(experiments.LIMITED)[1]
    when = experiments.first_beyond(scene, limit)
    assert when is not None
    before, after = np.abs(scene.lateral_force([when - 2e-3, when]))
    assert before < limit <= after
    assert experiments.first_beyond(scene, 1.01 * experiments.PEAK) is None


def test_friction_slips_soon_after_the_exact_force_passes_its_limit_and_not_before():
    cells = [cell for own in experiments.LIMITED.values() for cell in own]
    told = {(o.method, o.setting): o.outcome for o in experiments.slipping(kept(map(Motion, cells)))}
    for limit in experiments.LIMITED:
        exact = told["exact lateral force", f"{limit:g} N"]
        for method in ("pymunk groove with max_force", "mujoco tendon with friction loss"):
            outcome = told[method, f"{limit:g} N"]
            if "never" in exact:
                assert outcome == "holds"
                continue
            times = [float(present(re.search(r"at ([\d.]+) s", words)).group(1)) for words in (exact, outcome)]
            # Slip starts from zero with the force's excess: a few tenths of a second until it shows.
            assert 0 <= times[1] - times[0] < 0.3


def test_the_trailer_folds_in_the_kinematics_when_the_closed_form_says():
    told = {o.method: o.outcome for o in wheels_failures.folding(kept([wheels_failures.REFERENCE])) if not o.setting}
    closed, driven = told["closed form, at an even speed"], told["the reference, driven at an even speed"]
    assert closed == driven
    assert told["the drawbar pushed along by that way"] == f"bent by {math.pi / 2:.4f} rad"
    # A coasting car gives speed to the trailer's turning, or gets some from it: another instant.
    assert told["the reference, coasting"] != closed


def test_counting_tells_what_the_rows_leave():
    told = {o.method: o.outcome for o in counting(Material({}))}
    assert told["pinned body (18.62)"].startswith("(1, 1); integrable")
    assert told["one skate (18.64)"].startswith("(3, 2); not integrable")
    assert told["two skates on one axle"] == told["one skate (18.64)"]
    assert told["two skates in one line"] == "(3, 1); integrable: of 3 it can reach 1"
    assert told["three skates"].startswith("(3, 0)")
    assert "| car_and_trailer | 5 | (4, 1) | 1 | integrable |" in wheels.counted(wheels.SCENES)


def row(scene, engine, every, samples=None):
    return measure(Cell(scene, engine, every, samples=samples), repeat=False)


def motion_of(cell):
    return trajectory_of(answer_to(Motion(cell)))


def run_of(measured, scene, engine, every):
    """What a function of a cell and its whole motion makes of a run."""
    cell = Cell(scene, engine, every)
    return measured(cell, motion_of(cell))


@pytest.mark.parametrize("engine", [pymunk.TUNED, mujoco.TUNED], ids=lambda engine: engine.name)
def test_real_contact_parts_from_the_ideal_motion_where_it_must_slip_or_hop_and_only_there(engine):
    scene = RollingOnCircle()
    coarse, fine = (run_of(parting, scene, engine, every) for every in (10, 100))
    # Up to that instant the error is the method's, of first order: a tenth of the step, about a tenth of the error.
    assert fine[0] < 0.3 * coarse[0]
    assert fine[0] < 1e-3
    # After it, it is not the step's any more: the body flies, a good part of its radius away.
    assert fine[1] > 0.5 * coarse[1] > 0.1 * scene.radius
    # Where it never must, they never part; and a constraint holds where no contact could.
    assert RollingDisc().comparable_until == math.inf
    assert run_of(parting, RollingDisc(), engine, 100)[1] < 1e-2
    assert max(run_of(parting, scene, mujoco.EXTENDED, 10)) < 1e-8


def test_a_comparison_stops_where_it_is_no_longer_valid_and_says_so():
    scene = RollingOnCircle()
    found = row(scene, mujoco.TUNED, 100)
    assert Outcome(found.outcome).comparable
    assert f"compared until {scene.comparable_until:.4g} s only" in found.sentence
    # Without the stop the same run is a joint torn open, which no method by contact deserves.
    cell = Cell(scene, mujoco.TUNED, 100)
    whole = motion_of(cell)
    kept, note = stopped_where_it_ends(scene, whole)
    assert kept.t[-1] <= scene.comparable_until < whole.t[len(kept.t)]
    assert note
    gap = np.abs(scene.mechanism().gap(whole.pose, whole.t))
    assert gap.max() > 0.05 * scene.mechanism().length_scale > 10 * gap[: len(kept.t)].max()


def test_a_reset_after_the_stop_is_no_part_of_the_comparison():
    scene, flat = RollingOnCircle(), RollingEllipse()
    whole, other = (motion_of(Cell(each, mujoco.EXTENDED, 1)) for each in (scene, flat))
    for reset, kept in ((1.1, None), (0.5, 0.5)):
        assert stopped_where_it_ends(scene, replace(whole, reset_at=reset))[0].reset_at == kept
    assert stopped_where_it_ends(flat, other) == (other, "")


def test_nearly_conformal_rolling_that_breaks_in_mujoco_is_told():
    scene = DiscInHole(clearance=1e-2)
    warned = row(scene, mujoco.EXTENDED, 1)
    assert "turns by" in warned.sentence


def test_a_disc_in_a_hole_is_the_motion_that_exact_multipliers_give():
    scene = DiscInHole(clearance=0.2)
    found = row(scene, Lagrange("rk4", "projection"), 3)
    # Fourth order: the contact turns 5 rad/s * 3.3 ms = 0.017 rad in a step; that to the fourth power is 8e-8.
    assert found.angle < 1e-6
    assert found.position < 1e-6
    t = np.linspace(0, 1, 11)
    truth = scene.motion(t)
    # The centre runs round a circle of the clearance at w r / clearance: centripetal force m v^2 / clearance.
    speed = scene.start_rate * scene.radius
    np.testing.assert_allclose(truth.reaction[:, 1], scene.mass * speed**2 / (scene.clearance * scene.hole), rtol=1e-12)
    np.testing.assert_allclose(truth.reaction[:, 0], 0.0, atol=1e-12)


def test_a_square_stands_on_its_corner_when_energy_says_and_the_reference_stops_there():
    scene = SquareOnCatenaries()
    # A stage of the last step lies beyond the corner: that step is taken shorter.
    corner = scene.motion([scene.corner * (1 - 1e-9)])
    assert corner.pose[0, 0, 2] == pytest.approx(math.pi / 4, abs=1e-8)
    np.testing.assert_allclose(corner.pose[0, 0, 1], 0.0, atol=1e-12)
    assert abs(corner.reaction[0, 0]) < corner.reaction[0, 1]  # what `comparable_until` of the scene relies on
    with pytest.raises(ValueError, match="can't turn to"):
        scene.motion([scene.corner * 1.01])


def test_every_method_stops_at_the_corner_and_was_right_until_there():
    scene = SquareOnCatenaries()
    for engine in (
        pymunk_methods.ROLL_PIVOT,
        mujoco.EXTENDED,
        Lagrange("rk4", "projection"),
    ):
        found = row(scene, engine, 1)
        assert not Outcome(found.outcome).comparable
        assert found.sentence
        assert math.isnan(found.angle) or found.angle < 1e-3


def test_contact_on_a_hill_is_let_go_and_caught_again():
    stiff = next(method for method in mujoco_methods.ROLLS if "stiff" in method.variant)
    assert run_of(absent_contact, RollingOnCircle(), stiff, 100) > 0.02
    assert run_of(absent_contact, RollingOnCircle(), mujoco.EXTENDED, 10) == 0.0


def test_forces_that_motion_does_not_determine_are_left_out_of_the_gears_errors():
    found = row(EllipticGears(), mujoco.EXTENDED, 10)
    assert found.reaction < 1e-2
    truth = EllipticGears().motion([0.0])
    assert np.isnan(truth.reaction).any()


def test_the_round_trip_and_the_rate_of_the_page_are_as_exact_as_it_says():
    _, curves = centrodes_page.exact()
    # Splines of degree 7 at 400 points over 2 rad: 1e-10 in the curves, less in what they give back (asked: 1e-8).
    assert centrodes_page.round_trip(curves) < 1e-8
    assert centrodes_page.agreement(curves) < 1e-8
    wrong = replace(curves, body=curves.body * 1.001)
    assert centrodes_page.round_trip(wrong) > 1e-5
    assert centrodes_page.agreement(wrong) > 1e-5
