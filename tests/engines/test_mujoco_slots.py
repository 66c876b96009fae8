"""Slots and chains in MuJoCo: a slide of the tree where there is one, else a row; free coordinates beside trees."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines import lagrange
from engines.mujoco import DEFAULT, EXTENDED, TUNED, MuJoCo
from engines.mujoco.methods import SLOTS
from reference.joints import Drive, Joint, Pin, Slot
from reference.mechanism import Body, Mechanism
from reference.scenes.n_four_bar import FortyFourBars, NFourBar, TenFourBars
from reference.scenes.pendulum.link import BarPendulum, PointPendulum
from reference.scenes.pendulum.scenes import HundredLinks, LinkPendulum, TenLinks
from reference.scenes.person import OneFoot, TwoFeet
from reference.scenes.slider_crank.scenes import DrivenSliderCrank, FreeSliderCrank
from reference.scenes.slider_crank.slotted_lever import SlottedLever
from reference.trajectory import energy

FREE_COORDINATES = replace(EXTENDED, coordinates="free")


def error(engine: MuJoCo, scene: Any, dt: float, samples: int = 20) -> float:
    every = max(1, round(scene.duration / samples / dt))
    motion = engine.build(scene.mechanism(), scene.duration / samples / every)(samples, every)
    assert motion.warnings == ()
    return float(np.abs(motion.pose - scene.motion(motion.t).pose).max())


def slotted_arm(keeps_angle: bool) -> Mechanism:
    """An arm pinned to the ground and a block off its centre in the arm's slanted slot, as it slides outwards."""
    angle, rate, own_rate = 0.4, 2.0, 2.0 if keeps_angle else -1.0

    def across(point: np.ndarray) -> np.ndarray:
        return np.array([-point[1], point[0]])

    def turned(by: float, x: float, y: float) -> np.ndarray:
        return np.array([math.cos(by) * x - math.sin(by) * y, math.sin(by) * x + math.cos(by) * y])

    centre, offset = turned(angle, 0.5, 0.0), turned(angle + 0.5, 0.2, 0.1)
    along = turned(angle + 0.3, 1.0, 0.0)
    point = centre + turned(angle, 0.1, 0.05) + 0.7 * along
    velocity = rate * across(point) + 0.3 * along - own_rate * across(offset)
    arm = Body("arm", 1.0, 0.1, (*centre.tolist(), angle), (*(rate * across(centre)).tolist(), rate))
    block = Body("block", 0.7, 0.05, (*(point - offset).tolist(), angle + 0.5), (*velocity.tolist(), own_rate))
    joints: list[Joint] = [
        Pin("O", None, "arm", (0.0, 0.0), (-0.5, 0.0)),
        Slot("slot", "arm", "block", (0.1, 0.05), 0.3, (0.2, 0.1)),
    ]
    if keeps_angle:
        joints.append(Drive("keep", "arm", "block", 0.0, 0.5))
    return Mechanism((arm, block), tuple(joints), (0.0, -9.81))


def test_the_driven_slider_crank_is_exact_to_1e_10() -> None:
    for scene in (DrivenSliderCrank(), DrivenSliderCrank(offset=0.1)):
        assert error(EXTENDED, scene, 4e-4) < 1e-10


def test_the_slider_cranks_forces_are_those_of_the_truth() -> None:
    for scene in (DrivenSliderCrank(), FreeSliderCrank(duration=0.5)):
        motion = EXTENDED.build(scene.mechanism(), scene.duration / 2000)(20, 100)
        truth = scene.motion(motion.t)
        # The guide's torque is read from the tree, in which the slider can't turn.
        assert np.abs(motion.reaction - truth.reaction).max() < 1e-8 * np.abs(truth.reaction).max()


def test_a_slider_that_keeps_its_angle_is_one_coordinate_of_the_tree() -> None:
    size = EXTENDED.build(FreeSliderCrank().mechanism(), 1e-3).size
    assert (size.bodies, size.coordinates, size.rows, size.solver_rows) == (3, 3, 2, 3)
    # Free bodies: four pins and the slot of the slider's centre as rows, and the level as an inertia that can't turn.
    size = FREE_COORDINATES.build(FreeSliderCrank().mechanism(), 1e-3).size
    assert (size.coordinates, size.rows, size.solver_rows) == (9, 8, 10)


def test_free_coordinates_move_the_slider_crank_as_the_tree_does() -> None:
    assert error(FREE_COORDINATES, DrivenSliderCrank(), 1e-3) < 1e-8
    assert error(replace(TUNED, coordinates="free"), DrivenSliderCrank(), 1e-3) < 1e-4


@pytest.mark.parametrize("keeps_angle", [False, True])
def test_a_slot_in_a_moving_body_is_a_slide_and_a_hinge_or_a_slide_alone(keeps_angle: bool) -> None:
    mechanism = slotted_arm(keeps_angle)
    truth = lagrange.TRUTH.build(mechanism, 1e-2)(20, 1)
    built = TUNED.build(mechanism, 1e-3)
    assert built.size.coordinates == (2 if keeps_angle else 3)
    assert built.size.solver_rows == 0
    motion = built(20, 10)
    # RK4 without any constraint: its own error at a millisecond.
    assert np.abs(motion.pose - truth.pose).max() < 1e-11
    assert np.abs(motion.twist - truth.twist).max() < 1e-10
    assert np.abs(motion.reaction - truth.reaction).max() < 1e-9 * np.abs(truth.reaction).max()


def test_a_resting_line_at_any_angle_holds_the_centre_of_a_free_body() -> None:
    angle, along = 0.6, np.array([np.cos(0.6), np.sin(0.6)])
    bead = Body("bead", 2.0, 0.1, (0.2, 0.3, 0.0), (0.5 * along[0], 0.5 * along[1], 3.0))
    slot = Slot("wire", None, "bead", (0.2, 0.3), angle, (0.0, 0.0))
    mechanism = Mechanism((bead,), (slot,), (0.0, -9.81))
    motion = replace(EXTENDED, coordinates="free").build(mechanism, 1e-3)(20, 10)
    way = 0.5 * motion.t - 9.81 * along[1] * motion.t**2 / 2
    # What is left of the compliance: the weight across the wire over the hardened spring's stiffness.
    assert np.abs(motion.pose[:, 0, :2] - [0.2, 0.3] - way[:, None] * along).max() < 1e-7
    assert np.abs(motion.pose[:, 0, 2] - 3.0 * motion.t).max() < 1e-9


def test_a_slot_that_no_slide_stands_for_is_a_written_row() -> None:
    mechanism = slotted_arm(False)
    truth = lagrange.TRUTH.build(mechanism, 1e-2)(20, 1)
    motion = FREE_COORDINATES.build(mechanism, 1e-3)(20, 10)
    assert np.abs(motion.pose - truth.pose).max() < 1e-9
    assert np.abs(mechanism.gap(motion.pose, motion.t)).max() < 1e-10


@pytest.mark.parametrize("keeps_angle", [False, True])
def test_by_public_settings_half_of_the_body_slides_and_is_welded_to_the_other(keeps_angle: bool) -> None:
    mechanism = slotted_arm(keeps_angle)
    truth = lagrange.TRUTH.build(mechanism, 1e-2)(20, 1)
    hard = replace(FREE_COORDINATES, slots="halves").build(mechanism, 1e-3)(20, 10)
    assert np.abs(hard.pose - truth.pose).max() < 1e-9
    assert np.abs(hard.reaction - truth.reaction).max() < 1e-7 * np.abs(truth.reaction).max()
    tuned = replace(TUNED, coordinates="free")
    errors = [np.abs(tuned.build(mechanism, dt)(20, every).pose - truth.pose).max() for dt, every in HALVED]
    # A weld's gap falls as the square of the step.
    assert 3.5 < errors[0] / errors[1] < 4.5
    assert errors[1] < 1e-6
    model = tuned.model(mechanism, 1e-3)
    assert np.allclose(model.loads()[0], mechanism.inertias, rtol=1e-14, atol=0)


HALVED = ((1e-3, 10), (5e-4, 20))


def test_a_row_of_ours_needs_one_row_where_halves_need_six_and_two_coordinates_and_misses_less() -> None:
    scene, found = SlottedLever(), {}
    for engine in (TUNED, *SLOTS):
        size = engine.build(scene.mechanism(), 1e-3).size
        found[engine.variant] = (size.bodies, size.coordinates, size.solver_rows)
    assert found == {"tuned": (3, 4, 6), "tuned, slots as rows": (2, 2, 1)}
    coarse, fine = (error(SLOTS[0], scene, dt) for dt in (1e-3, 5e-4))
    assert 3 < coarse / fine < 5  # the spring is tied to the step, as that of the weld
    assert coarse < 0.6 * error(TUNED, scene, 1e-3)
    slot = next(joint for joint in scene.mechanism().joints if isinstance(joint, Slot))
    assert [each.holder(slot, scene.mechanism()) for each in (TUNED, *SLOTS)] == ["engine", "engine, our rows"]


def test_two_slots_of_one_body_are_two_of_its_quarters_and_a_slot_may_carry_a_point_of_the_ground() -> None:
    # The trammel of Archimedes: two points of a bar in two slots of the ground, that cross at an angle of 1 rad.
    first, second, rate = np.array([0.6, 0.0]), 0.8 * np.array([math.cos(1.0), math.sin(1.0)]), 1.5
    along = second - first
    length, angle = float(np.hypot(*along)), float(np.arctan2(along[1], along[0]))
    across = np.array([-along[1], along[0]])
    # v_first = s (1, 0) and v_first + rate across = u (cos 1, sin 1)
    s = -(rate * (across[0] * math.sin(1.0) - across[1] * math.cos(1.0))) / math.sin(1.0)
    centre = (first + second) / 2
    velocity = np.array([s, 0.0]) + rate * across / 2
    bar = Body("bar", 1.3, 0.07, (*centre.tolist(), angle), (*velocity.tolist(), rate))
    points = ((-length / 2, 0.0), (length / 2, 0.0))
    slots = (Slot("a", None, "bar", (0.0, 0.0), 0.0, points[0]), Slot("b", None, "bar", (0.0, 0.0), 1.0, points[1]))
    mechanism = Mechanism((bar,), slots, (0.0, -9.81))
    truth = lagrange.TRUTH.build(mechanism, 1e-2)(20, 1)
    for engine, allowed in ((TUNED, 1e-6), (replace(EXTENDED, slots="halves"), 1e-9), (EXTENDED, 1e-9)):
        motion = engine.build(mechanism, 1e-3)(20, 10)
        assert np.abs(motion.pose - truth.pose).max() < allowed


def test_a_point_of_the_ground_slides_in_a_body() -> None:
    # A plate that turns about the ground's point (0.3, 0.1) and slides past it, pulled by gravity.
    angle, rate, speed, line = 0.5, 2.0, 0.4, 0.7
    point, own = np.array([0.3, 0.1]), np.array([0.25, -0.1])
    way = np.array([math.cos(angle + line), math.sin(angle + line)])
    offset = np.array(
        [math.cos(angle) * own[0] - math.sin(angle) * own[1], math.sin(angle) * own[0] + math.cos(angle) * own[1]]
    )
    centre = point - offset
    velocity = speed * way + rate * np.array([offset[1], -offset[0]])
    plate = Body("plate", 0.8, 0.03, (*centre.tolist(), angle), (*velocity.tolist(), rate))
    slot = Slot("slot", "plate", None, (float(own[0]), float(own[1])), line, (0.3, 0.1))
    mechanism = Mechanism((plate,), (slot,), (0.0, -9.81))
    truth = lagrange.TRUTH.build(mechanism, 1e-2)(20, 1)
    for engine, allowed in ((TUNED, 1e-5), (replace(EXTENDED, slots="halves"), 1e-8), (EXTENDED, 1e-8)):
        motion = engine.build(mechanism, 1e-3)(20, 10)
        assert np.abs(motion.pose - truth.pose).max() < allowed
        assert np.abs(motion.reaction - truth.reaction).max() < 1e-2 * np.abs(truth.reaction).max()


@pytest.mark.parametrize(
    "scene",
    [BarPendulum(duration=3.0), LinkPendulum(duration=3.0), TenLinks(duration=1.0)],
    ids=lambda scene: f"{scene.name}",
)
def test_an_open_chain_as_a_tree_is_exact_to_1e_12(scene: Any) -> None:
    assert error(EXTENDED, scene, 1e-4) < 1e-12


def test_a_hundred_links_keep_their_energy() -> None:
    scene = HundredLinks(duration=0.5)
    mechanism = scene.mechanism()
    motion = EXTENDED.build(mechanism, 5e-4)(5, 200)
    total = energy(mechanism, motion)
    # Of 5e4 J that could be turned: (m g L) times the sum of heights.
    assert np.abs(total - total[0]).max() < 2e-8


@pytest.mark.parametrize("scene", [LinkPendulum(duration=1.0), TenLinks(duration=0.5)], ids=lambda scene: scene.name)
def test_every_pin_as_a_constraint_gives_the_same_motion_less_exactly_and_is_larger(scene: Any) -> None:
    tree, free = (engine.build(scene.mechanism(), 1e-3).size for engine in (EXTENDED, FREE_COORDINATES))
    assert (tree.coordinates, tree.rows) == (scene.links, 0)
    assert (free.coordinates, free.rows) == (3 * scene.links, 2 * scene.links)
    # Order four in both; the constraints' time constant adds its own error.
    assert error(FREE_COORDINATES, scene, 1e-3) < 1e-7


@pytest.mark.parametrize("engine", [DEFAULT, TUNED, EXTENDED, FREE_COORDINATES], ids=lambda engine: engine.variant)
@pytest.mark.parametrize(
    "scene",
    [
        *(BarPendulum(), PointPendulum(), LinkPendulum(), TenLinks(), HundredLinks()),
        *(NFourBar(), TenFourBars(), FortyFourBars(), OneFoot(), TwoFeet(), DrivenSliderCrank(), FreeSliderCrank()),
    ],
    ids=lambda scene: scene.name,
)
def test_every_chain_runs_in_every_variant(engine: MuJoCo, scene: Any) -> None:
    motion = engine.build(scene.mechanism(), 1e-3)(2, 5)
    truth = scene.motion(motion.t)
    # Ten milliseconds: first order errs by about a dt^2 / 2 per step, and the shipped loops by their softness.
    allowed = 5e-3 if engine is DEFAULT else 1e-5
    assert np.abs(motion.pose - truth.pose).max() < allowed


@pytest.mark.parametrize("scene", [NFourBar(duration=5.0), TenFourBars(duration=1.5)], ids=lambda scene: scene.name)
def test_many_loops_pass_their_singular_positions_in_the_extended_variant(scene: Any) -> None:
    # Flat at about 1.2 s: the rows lose rank there, and what stands for the missing ones is rounding.
    assert error(EXTENDED, scene, 1e-3) < 1e-6


def test_the_tree_of_a_mechanism_is_built_once_however_often_a_joint_is_asked_for() -> None:
    mechanism = NFourBar(300).mechanism()
    engine = TUNED
    tree = engine._tree(mechanism)
    assert all(engine.holder(joint, mechanism) == "engine" for joint in mechanism.joints)
    assert engine._tree(mechanism) is tree
    # Another mechanism of the same numbers, and the other coordinates, have trees of their own.
    assert engine._tree(NFourBar(300).mechanism()) is not tree
    assert FREE_COORDINATES._tree(mechanism).coordinates == 3 * len(mechanism.bodies)
