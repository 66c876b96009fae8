"""The pages of pendulums, slider-crank, N-four-bar and person: scenes made for failures, pictures, words, and traps."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from reference.checks import InvalidMechanism
from reference.scenes.many_links import SpinningRing
from reference.scenes.slider_crank.scenes import RodEndInSlot, SliderAtDeadCentre
from reference.scenes.slider_crank.slotted_lever import SlottedLever
from reference.trajectory import energy, joint_gap, slip
from reports.gate.prediction import all_tasks
from reports.model.cells import Cell
from reports.model.measure import measure
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.n_four_bar import page as n_four_bar
from reports.pages.pendulum import page as pendulum
from reports.pages.pendulum.experiments import hardened
from reports.pages.person import page as person
from reports.pages.slider_crank import page as slider_crank
from reports.pages.slider_crank.experiments import GROOVE, LEVER
from tests.committed_rows import committed_rows

PAGES = (pendulum.PAGE, slider_crank.PAGE, n_four_bar.PAGE, person.PAGE)
LIMITS = (SpinningRing(links=7), RodEndInSlot(), RodEndInSlot(offset=0.3, branch=-1), SliderAtDeadCentre(angle=1e-2))
LIMITS = (*LIMITS, SlottedLever(), SlottedLever(slant=-2.0, crank=0.79))


def measured(scene, engine, every):
    return measure(Cell(scene, engine, every, "failure"), repeat=False)


@pytest.mark.parametrize("scene", LIMITS, ids=lambda scene: scene.name)
def test_a_scene_made_for_failure_has_a_truth_that_satisfies_its_joints_and_newton(scene):
    mechanism = scene.mechanism()
    t = np.linspace(0, scene.duration, 12)
    truth = scene.motion(t)
    assert np.nanmax(np.abs(joint_gap(mechanism, truth))) < 1e-13
    assert np.abs(slip(mechanism, truth)).max() < 1e-12
    # Exact multipliers know no scene. At tight tolerance they agree but for their own tolerance and how both grow.
    run = Lagrange("dop853", "projection", tolerance=1e-13).build(mechanism, t[1])(11, 1)
    assert np.abs(run.pose - truth.pose).max() < 1e-9
    largest = np.abs(truth.reaction).max()
    assert np.abs(run.reaction - truth.reaction).max() < 1e-8 * largest


def test_a_wrong_ring_is_caught():
    """The same ring with links a thousandth heavier on one side does not turn like a wheel."""
    scene = SpinningRing(links=7)
    right = scene.mechanism()
    heavy = replace(right.bodies[0], mass=1.5 * scene.mass)
    wrong = replace(right, bodies=(heavy, *right.bodies[1:]))
    t = np.linspace(0, scene.duration, 12)
    run = Lagrange("dop853", "projection", tolerance=1e-12).build(wrong, t[1])(11, 1)
    assert np.abs(run.pose - scene.motion(t).pose).max() > 1e-3


def test_the_rings_tension_is_that_of_a_rope():
    """Each link is pulled inwards by both neighbours: 2 T sin(pi / n) = m w^2 r, r to the middle of the chord."""
    scene = SpinningRing(links=9)
    inner = scene.length / (2 * math.tan(math.pi / scene.links))
    tension = scene.mass * scene.rate**2 * inner / (2 * math.sin(math.pi / scene.links))
    reaction = scene.motion([0.0, 0.3]).reaction.reshape(2, -1, 2)
    assert np.abs(np.linalg.norm(reaction, axis=-1) - tension).max() < 1e-13 * tension


def test_two_links_are_no_ring():
    with pytest.raises(InvalidMechanism, match="links is 2"):
        SpinningRing(links=2)


def test_a_ring_hardened_too_far_goes_wrong_with_its_joints_closed_and_without_a_word_of_the_engine():
    scene = SpinningRing(duration=0.5, horizon=0.5)
    wrong, right = (measured(scene, hardened("a", softening, "dense"), 1) for softening in (1e-8, 1e-6))
    assert right.energy < 1e-9
    # The energy is wrong by a large part of itself, the joint open by less than a thousandth of a link.
    assert wrong.energy > 0.1
    assert wrong.gap < 1e-3 * scene.length
    said = [part for part in wrong.sentence.split("; ") if part]
    assert all(part.startswith(("ours:", "its own estimate")) for part in said)


def test_a_pushed_slider_keeps_its_energy_and_leaves_to_the_side_where_it_stood():
    t = np.linspace(0, 1.5, 100)
    for side in (1, -1):
        scene = SliderAtDeadCentre(angle=side * 1e-3)
        truth = scene.motion(t)
        total = energy(scene.mechanism(), truth)
        assert np.ptp(total) < 1e-11 * np.abs(total).max()
        assert np.all(np.sign(truth.pose[:, 0, 2]) == side)
        assert abs(truth.pose[-1, 0, 2]) > 1
    still = SliderAtDeadCentre(angle=0.0).motion(t)
    assert np.all(still.pose == still.pose[0])


def test_a_groove_at_a_rods_end_is_wrong_by_the_same_at_every_step_and_a_link_is_not():
    coarse, fine = (measured(RodEndInSlot(), GROOVE[0], every) for every in (10, 100))
    # A tenth of the step leaves the error where it is: it is no error of discretisation.
    assert fine.angle == pytest.approx(coarse.angle, rel=0.05)
    assert fine.angle > 0.1
    assert measured(RodEndInSlot(), pymunk.DEFAULT, 100).angle < 0.01


def test_a_groove_in_a_moving_lever_opens_at_every_step_and_is_right_with_the_centre_of_mass_on_its_line():
    trap = [measured(SlottedLever(), LEVER[0], every) for every in (10, 100)]
    assert [row.outcome for row in trap] == ["torn", "torn"]
    assert trap[1].gap == pytest.approx(trap[0].gap, rel=0.05)
    for engine, order in ((LEVER[1], 1), (pymunk.TUNED, 2)):
        coarse, fine = (measured(SlottedLever(), engine, every).angle for every in (10, 100))
        assert math.log10(coarse / fine) == pytest.approx(order, abs=0.1)
    # Then the arm from the lever's centre of mass lies along the groove, and both constructions are one.
    straight = [measured(SlottedLever(slant=0.0), engine, 100).angle for engine in (LEVER[0], pymunk.DEFAULT)]
    assert straight[0] == pytest.approx(straight[1], rel=1e-3)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_pages_observations_are_computed_and_say_something(page):
    material = Material({}, {task: answered(task) for task in all_tasks(page)})
    told = [seen for failure in page.failures if failure.observations for seen in failure.observations(material)]
    assert all(seen.outcome and "nan" not in seen.outcome for seen in told)
    assert told


def test_the_hundred_links_of_a_tree_and_of_free_bodies_agree():
    scene = next(scene for scene in pendulum.PAGE.scenes if scene.name == "pendulum_100")
    cells = [Cell(scene, engine, 1) for engine in (mujoco.EXTENDED, pendulum.FREE[1])]
    rows = committed_rows(cells)
    tree, free = (rows[cell] for cell in cells)
    assert Outcome(free.outcome) == Outcome(tree.outcome) == Outcome.UNRESOLVED  # 4e-4 rad, as both say
    assert tree.angle < 2 * tree.estimate
    # The same integrator at the same step: what differs is the coordinates, and errors of one size.
    assert free.angle < 10 * tree.angle
    assert (tree.coordinates, tree.rows, free.coordinates, free.rows) == (100, 0, 300, 200)
