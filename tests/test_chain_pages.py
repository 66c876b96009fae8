"""The pages of pendulums, slider-crank, N-four-bar and person: scenes made for failures, pictures, words, and traps."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from engines import mujoco, pymunk
from engines.lagrange import Lagrange
from reference.checks import InvalidMechanism
from reference.scenes.many_links import SpinningRing
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.person import TwoFeet
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, RodEndInSlot, SliderAtDeadCentre
from reference.scenes.slider_crank.slotted_lever import SlottedLever
from reference.trajectory import energy, joint_gap, slip
from reports.gate.prediction import all_tasks
from reports.model.cells import Cell, sweep_cells
from reports.model.measure import measure
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import answered
from reports.pages.n_four_bar import page as n_four_bar
from reports.pages.pendulum import page as pendulum
from reports.pages.pendulum.experiments import hardened
from reports.pages.person import page as person
from reports.pages.rendering import render_page
from reports.pages.slider_crank import page as slider_crank
from reports.pages.slider_crank.experiments import GROOVE, LEVER
from reports.plots.mechanisms import Strip, outline, stroboscope
from reports.plots.theme import svg
from tests import test_any_rows as rendering
from tests.present import present
from tests.toys import Disc, Toy

undrawn = rendering.undrawn  # pytest finds a fixture by its name in the module

PAGES = (pendulum.PAGE, slider_crank.PAGE, n_four_bar.PAGE, person.PAGE)
LIMITS = (SpinningRing(links=7), RodEndInSlot(), RodEndInSlot(offset=0.3, branch=-1), SliderAtDeadCentre(angle=1e-2))
LIMITS = (*LIMITS, SlottedLever(), SlottedLever(slant=-2.0, crank=0.79))


def show(error: float) -> str:
    return f"{error:.2g}"


@pytest.mark.parametrize("scene", LIMITS, ids=lambda scene: scene.name)
def test_a_scene_made_for_failure_has_a_truth_that_satisfies_its_joints_and_newton(scene):
    mechanism = scene.mechanism()
    t = np.linspace(0, scene.duration, 12)
    truth = scene.motion(t)
    assert np.nanmax(np.abs(joint_gap(mechanism, truth))) < 1e-13
    assert np.abs(slip(mechanism, truth)).max() < 1e-12
    # Exact multipliers know no scene. At tight tolerance they agree but for their own tolerance and how both grow.
    run = Lagrange("dop853", "projection", tolerance=1e-13).build(mechanism, t[1])(11, 1)
    assert np.abs(run.pose - truth.pose).max() < 1e-9, show(np.abs(run.pose - truth.pose).max())
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
    scene = RodEndInSlot()
    trap = [measure(Cell(scene, GROOVE[0], every, "failure"), repeat=False) for every in (10, 100)]
    # A tenth of the step leaves the error where it is: it is no error of discretisation.
    assert trap[1].angle == pytest.approx(trap[0].angle, rel=0.05)
    assert trap[1].angle > 0.1
    right = [measure(Cell(scene, pymunk.DEFAULT, every, "failure"), repeat=False) for every in (10, 100)]
    assert right[1].angle < 0.15 * right[0].angle


def test_a_groove_in_a_moving_lever_opens_at_every_step_and_is_right_with_the_centre_of_mass_on_its_line():
    def measured(scene, engine, every):
        return measure(Cell(scene, engine, every, "failure"), repeat=False)

    trap = [measured(SlottedLever(), LEVER[0], every) for every in (10, 100)]
    assert [row.outcome for row in trap] == ["torn", "torn"]
    assert trap[1].gap == pytest.approx(trap[0].gap, rel=0.05)
    shut = [measured(SlottedLever(), LEVER[1], every).angle for every in (10, 100)]
    assert math.log10(shut[0] / shut[1]) == pytest.approx(1, abs=0.1)
    right = [measured(SlottedLever(), pymunk.TUNED, every).angle for every in (10, 100)]
    assert math.log10(right[0] / right[1]) == pytest.approx(2, abs=0.1)
    # Then the arm from the lever's centre of mass lies along the groove, and both constructions are one.
    straight = [measured(SlottedLever(slant=0.0), engine, 100).angle for engine in (LEVER[0], pymunk.DEFAULT)]
    assert straight[0] == pytest.approx(straight[1], rel=1e-3)


def test_a_ring_hardened_too_far_goes_wrong_with_its_joints_closed_and_without_a_word_of_the_engine():
    scene = SpinningRing(duration=0.5, horizon=0.5)
    wrong = measure(Cell(scene, hardened("too far", 1e-8, "dense"), 1, "failure"), repeat=False)
    right = measure(Cell(scene, hardened("far enough", 1e-6, "dense"), 1, "failure"), repeat=False)
    assert right.energy < 1e-9
    # The energy is wrong by a large part of itself, the joint open by less than a thousandth of a link.
    assert wrong.energy > 0.1
    assert wrong.gap < 1e-3 * scene.length
    said = [part for part in wrong.sentence.split("; ") if part]
    assert all(part.startswith(("ours:", "its own estimate")) for part in said)
    chosen = measure(Cell(scene, mujoco.EXTENDED, 1, "failure"), repeat=False)
    assert chosen.energy < 1e-6


def test_through_the_singular_position_the_shipped_error_does_not_fall_with_the_step():
    scene = NFourBar(duration=1.2, horizon=1.2)
    soft = [measure(Cell(scene, mujoco.DEFAULT, every, "failure"), repeat=False).angle for every in (10, 100)]
    assert soft[1] == pytest.approx(soft[0], rel=0.1)
    stiff = [measure(Cell(scene, mujoco.TUNED, every, "failure"), repeat=False).angle for every in (10, 100)]
    assert stiff[1] < 0.1 * stiff[0]


@pytest.mark.parametrize(
    ("make", "word"),
    [
        (lambda: LinkPendulum(links=0), "links is 0"),
        (lambda: LinkPendulum(length=0.0), "length is 0.0"),
        (lambda: NFourBar(loops=0), "loops is 0"),
        (lambda: SpinningRing(links=2), "links is 2"),
        (lambda: DrivenSliderCrank(offset=0.7), "offset is 0.7"),
        (lambda: TwoFeet(stance=2.0), "stance is 2.0"),
    ],
)
def test_chains_that_can_not_be_are_refused_with_a_sentence(make, word):
    with pytest.raises(InvalidMechanism, match=re.escape(word)):
        make()


def test_an_outline_has_the_free_end_of_a_chain_and_the_joints_between():
    scene = LinkPendulum(links=3)
    motion = scene.motion([0.7])
    bodies = outline(scene.mechanism(), motion.pose[0], {"link 3": ((scene.length / 2, 0.0),)})
    angle, _ = scene.states([0.7])
    steps = scene.length * np.stack([np.sin(angle[0]), -np.cos(angle[0])], axis=-1)
    corners = np.concatenate([np.zeros((1, 2)), np.cumsum(steps, axis=0)])
    for index in range(3):
        assert np.abs(bodies[f"link {index + 1}"] - corners[index : index + 2]).max() < 1e-13


def test_a_stroboscope_fades_the_past_draws_a_film_side_by_side_and_is_the_same_twice():
    tip = {"link 2": ((0.5, 0.0),)}
    strips = (
        Strip(LinkPendulum(), "fading", 5, end=0.5, ends=tip, trace=("link 2", (0.5, 0.0))),
        Strip(LinkPendulum(), "film", 3, end=0.5, ends=tip, spread=2.5, floor=True),
    )
    fading, film = (len(stroboscope([strip]).axes[0].lines) for strip in strips)
    assert (fading, film) == (2 + 5, 1 + 3)  # the ground or floor, the path, a line a pose
    lines = [line for line in stroboscope(strips[:1]).axes[0].lines if line.get_alpha() is not None]
    strengths = [present(line.get_alpha()) for line in lines]
    assert strengths == sorted(strengths)
    assert strengths[0] < 0.2 < strengths[-1] == 1
    starts = [np.asarray(line.get_xdata())[0] for line in stroboscope(strips[1:]).axes[0].lines[1:]]
    assert np.allclose(np.diff(starts), 2.5)  # the pin stays, so what moves is the film
    assert strips[0].caption == "fading: every 0.125 s"
    assert svg(stroboscope(strips), "twice") == svg(stroboscope(strips), "twice")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_can_be_written_from_nothing_and_from_a_few_rows(page, undrawn):
    empty = render_page(page, Material({}), "the command")
    assert "Nothing was run yet" in empty[f"{page.name}.md"]
    few = [
        replace(scene, duration=0.1, horizon=0.1) if scene.duration > 3 else scene
        for scene in page.scenes
        if len(scene.mechanism().bodies) < 10
    ]
    cells = [Cell(scene, engine, every) for scene in few for engine in page.engines[:6] for every in (1, 10)]
    rows = {cell: measure(cell, repeat=False) for cell in cells}
    files = render_page(page, Material(rows), "the command")
    text = files[f"{page.name}.md"]
    assert page.title in text
    assert "stroboscope" in text
    assert re.search(r"^\| mujoco \| [^|]* \| \*\*\w+\*\* \| engine \| [\d.e-]+ \|", text, re.MULTILINE)  # what to set
    shown = set(re.findall(r"\]\((\w+\.svg)\)", text))
    assert shown == {name for name in files if name.endswith(".svg")}
    assert " - rad" not in text.split("## Errors and costs")[0]  # a dash is what an unknown number is printed as


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_pages_observations_are_computed_and_say_something(page):
    material = Material({}, {task: answered(task) for task in all_tasks(page)})
    told = [seen for failure in page.failures if failure.observations for seen in failure.observations(material)]
    assert all(seen.outcome and "nan" not in seen.outcome for seen in told)
    assert told


@pytest.mark.parametrize(
    ("step_cost", "kept"),
    [(1e-6, [1, 3, 10, 30]), (1e-2, [1, 3, 10]), (1.0, [1])],  # s; a run of 20 samples takes 20 steps and more
    ids=["cheap", "dear", "very dear"],
)
def test_very_dear_quick_steps_are_left_out_but_never_the_coarsest(step_cost, kept, monkeypatch):
    monkeypatch.setattr(Toy, "step_cost", lambda *_: step_cost)
    assert Disc().samples == 20
    assert [cell.every for cell in sweep_cells((Disc(),), (Toy(variant=f"of {step_cost} s"),), (1, 3, 10, 30))] == kept


def test_the_hundred_links_of_a_tree_and_of_free_bodies_agree():
    scene = next(scene for scene in pendulum.PAGE.scenes if scene.name == "pendulum_100")
    tree, free = (measure(Cell(scene, engine, 1), repeat=False) for engine in (mujoco.EXTENDED, pendulum.FREE[1]))
    assert Outcome(free.outcome) == Outcome(tree.outcome) == Outcome.UNRESOLVED  # 4e-4 rad, as both say
    assert tree.angle < 2 * tree.estimate
    # The same integrator at the same step: what differs is the coordinates, and errors of one size.
    assert free.angle < 10 * tree.angle
    assert (tree.coordinates, tree.rows) == (100, 0)
    assert (free.coordinates, free.rows) == (300, 200)
