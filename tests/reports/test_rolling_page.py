"""The pages of rolling and of centrodes: where comparisons stop, what breaks how, and what the pages say of it."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from engines.mujoco import methods as mujoco_methods
from engines.pymunk import methods as pymunk_methods
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import DiscInHole, RollingDisc, RollingEllipse, RollingOnCircle, SquareOnCatenaries
from reports.model.cells import Cell
from reports.model.measure import measure, stopped_where_it_ends
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Motion, answered, trajectory_of
from reports.pages.centrodes import page as centrodes_page
from reports.pages.rolling.methods import absent_contact, parting


def row(scene, engine, every, samples=None):
    return measure(Cell(scene, engine, every, samples=samples), repeat=False)


def motion_of(cell):
    return trajectory_of(answered(Motion(cell)))


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


def test_the_centre_tells_engines_apart_by_their_velocities():
    engines = (mujoco.DEFAULT, mujoco.EXTENDED)
    cells = [Cell(centrodes_page.DrivenFourBar(), engine, 1) for engine in engines]
    material = Material({}, {Motion(cell): answered(Motion(cell)) for cell in cells})
    centre = {cell.engine.variant: error for cell, error, *_ in centrodes_page.measured(material)}
    assert set(centre) == {"default", "extended"}
    assert centre["extended"] < 1e-2 * centre["default"]
