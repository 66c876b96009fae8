"""Tests of the data that a page loads: models, exact motions, forces and controls."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from engines import Unsupported
from engines import mujoco as mujoco_engine
from engines import pymunk as pymunk_engine
from engines.pymunk.methods import SKATE_CENTRE, SKATE_GROOVE
from reference.plane import rotated
from reference.rolling.curves import Circle
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.rolling.elliptic_gears import EllipticGears
from reference.scenes.rolling.scenes import RollingDisc, RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reports.site.build import DRAGGED
from reports.site.drawn import between, place_of, required_friction
from reports.site.lessons import LESSONS
from reports.site.live import sliders
from reports.site.live.data import data as live_data
from reports.site.live.data import forces
from reports.site.live.models import RecordKind, mujoco_text, space_of
from reports.site.live.sliders import Live
from reports.site.markdown import render_html

LIVE = {f"{lesson.name}: {live.word}": live for lesson in LESSONS for live in lesson.scenes}


def test_the_scene_of_a_live_is_a_position_of_its_sliders_and_invalid_lives_are_refused():
    for live in LIVE.values():
        assert live.scene in live.places()
        assert live.steps[live.start] % live.frames == 0
        assert all(len(control.texts) == len(control.values) for control in live.controls().values())
    slider = sliders.Slider("crank", "crank", tuple(0.3 + 0.001 * i for i in range(126)))
    with pytest.raises(ValueError, match="7 steps don't fit 60 frames"):
        Live("x", DrivenFourBar(), (7,), 60, 0)
    with pytest.raises(ValueError, match="more than 125 positions"):
        Live("x", DrivenFourBar(), (60,), 60, 0, (slider,))


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_a_change_of_settings_answers_a_question_and_has_claims(lesson):
    for experiment in lesson.experiments:
        live = lesson.scene(experiment.scene)
        assert experiment.question or not experiment.after, experiment.heading
        assert len(experiment.guesses) == (len(experiment.answers) if experiment.after else 0)
        for (words, is_right), guess in zip(experiment.answers, experiment.guesses, strict=False):
            # A wrong answer proposes a run, or predicts a number, or is answered by a quantity.
            assert is_right or guess.change is not None or guess.times or experiment.quantities, words
            assert not guess.change or guess.claims, words
        # Every experiment that changes settings of an engine has a claim on the error.
        fields = {slider.field for slider in live.sliders}
        assert experiment.claims or not set(experiment.after) - fields, experiment.heading


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_numbers_to_drag_in_the_text_are_controls(lesson):
    pytest.importorskip("mdit_py_plugins", reason="the extra site is not installed: pip install '.[site]'")
    for experiment in lesson.experiments:
        numbers = DRAGGED.findall(render_html(experiment.text + experiment.after_words))  # formulas have braces, too
        assert set(numbers) <= set(lesson.scene(experiment.scene).controls()), experiment.heading


def test_polygons_have_the_corners_that_lessons_state():
    gears = dict(LIVE["gears: two gears"].munk)
    labels = {label: int(label.split()[3]) for label in gears if label.startswith("a polygon of")}
    corners = {sliders.SHIPPED: 64, sliders.DOCUMENTED: 512, **labels}
    vertices = {label: method.contact.vertices for label, method in gears.items() if not isinstance(method, str)}
    assert vertices == corners


def test_a_method_with_python_code_in_every_step_is_refused():
    sleigh = ChaplyginSleigh().mechanism()
    with pytest.raises(Unsupported, match="runs in Python only"):
        mujoco_text(mujoco_engine.TUNED, sleigh, 1e-3)
    with pytest.raises(Unsupported, match="runs in Python only"):
        space_of(replace(pymunk_engine.DEFAULT, roll="pivot"), RollingDisc().mechanism(), 1.0)


def records(engine: Any, scene: Any) -> tuple[tuple[float, ...], np.ndarray, list[tuple[float, ...]]]:
    """The global numbers of a space, its bodies (bodies, 11) and its records."""
    plan = space_of(engine, scene.mechanism(), scene.duration).numbers
    position, out = 8 + 11 * int(plan[4]), []
    while position < len(plan):
        out.append((plan[position], *plan[position + 2 : position + 2 + int(plan[position + 1])]))
        position += 2 + int(plan[position + 1])
    assert position == len(plan)
    return plan[:8], np.reshape(plan[8 : 8 + 11 * int(plan[4])], (-1, 11)), out


def test_the_space_for_munk2d_equals_that_of_pymunk():
    scene = DrivenFourBar()
    mechanism = scene.mechanism()
    head, bodies, parts = records(pymunk_engine.DEFAULT, scene)
    assert (head[:2], head[4:]) == (mechanism.gravity, (3, 10, pymunk_engine.SHIPPED_ERROR_BIAS, 0))
    assert bodies[:, 0].tolist() == [1, 0, 0]  # the crank is kinematic
    expected = [*mechanism.inertias[1:, 1:].T, *mechanism.pose[1:].T, *mechanism.twist[1:].T]
    free = bodies[1:, 1:9].T
    assert free == pytest.approx(np.array(expected))
    assert [record[:3] for record in parts] == [
        (RecordKind.PIVOT, 0, 1),
        (RecordKind.PIVOT, 1, 2),
        (RecordKind.PIVOT, -1, 2),
    ]
    space = space_of(pymunk_engine.DEFAULT, mechanism, scene.duration)
    assert (space.impulses, space.idle) == ((-1, 0, 1, 2), ())


@pytest.mark.parametrize(
    ("engine", "scene", "parts"),
    [
        (pymunk_engine.DEFAULT, RollingDisc(), [RecordKind.SEGMENT, RecordKind.CIRCLE]),
        (pymunk_engine.DEFAULT, RollingEllipse(), [RecordKind.SEGMENT, RecordKind.POLYGON]),
        (SKATE_CENTRE, ChaplyginSleigh(), [RecordKind.ZEROED]),
        (SKATE_GROOVE, ChaplyginSleigh(), [RecordKind.GROOVE, RecordKind.AIMED]),
        (pymunk_engine.DEFAULT, DrivenSliderCrank(), [RecordKind.PIVOT, RecordKind.PIVOT, RecordKind.GROOVE]),
    ],
)
def test_a_space_has_a_record_for_each_constraint_shape_and_code_around_a_step(engine, scene, parts):
    assert [record[0] for record in records(engine, scene)[2]] == parts


def test_a_live_scene_has_the_exact_motion_at_every_position_of_its_sliders():
    sleigh = LIVE["skate: the sleigh"]
    live = replace(sleigh, sliders=sleigh.sliders[-1:])  # fewer positions take less time
    loaded = json.loads(json.dumps(live_data(live, {}), allow_nan=False))
    frames = np.arange(live.frames + 1)
    for index, scene in enumerate(live.places()):
        truth = np.frombuffer(base64.b64decode(loaded["places"][index]["truth"]), dtype="<f8").reshape(-1, 1, 6)
        motion = scene.motion(frames * (scene.duration / live.frames))
        assert np.array_equal(truth, np.concatenate([motion.pose, motion.twist], axis=-1))
    assert loaded["native"]["munk"] == [None] * len(live.munk)
    assert loaded["munk"][0]["why"] == "pymunk as shipped has no joint for a skate"
    assert loaded["measure"] == "position"


@pytest.mark.parametrize("name", ["pendulum: one link", "four_bar: two assemblies"])
def test_the_picture_contains_the_exact_motion_at_every_position_of_the_sliders(name):
    live = LIVE[name]
    places = live_data(live, {})["places"]
    for place, scene in zip(places, live.places(), strict=True):
        left, top, width, height = map(float, place["drawing"]["box"].split())  # the y axis of the box points down
        pose = scene.motion(np.linspace(0.0, scene.duration, live.frames + 1)).pose
        ends = [pose[..., :2]]
        ends += [place_of(joint, *between(scene.mechanism(), joint, pose)) for joint in scene.mechanism().joints]
        for points in ends:
            assert np.abs(points[..., 0] - left - width / 2).max() < width / 2
            assert np.abs(points[..., 1] + top + height / 2).max() < height / 2


@pytest.mark.parametrize(
    ("name", "reason"),
    [("rolling: a cam", "our adapter builds no cam"), ("skate: the sleigh", "our code for it runs in Python only")],
)
def test_a_reason_in_the_legend_is_a_short_sentence(name, reason):
    loaded = live_data(replace(LIVE[name], sliders=()), {})
    assert reason in [method.get("why") for method in loaded["mujoco"]]


def test_forces_and_friction_are_returned_only_where_the_motion_determines_them():
    gears = EllipticGears()
    truth = gears.motion(np.linspace(0, 1, 5))
    first, second, mesh = forces(gears.mechanism(), truth)
    assert first["partly"]
    assert np.reshape(second["force"], (-1, 2)) == pytest.approx(np.nan_to_num(truth.reaction[:, 2:4]), abs=1e-6)
    assert (mesh["contact"], "friction" in mesh) == (True, False)
    scene = RollingEllipse()
    t = np.linspace(0, scene.duration, 50)
    (contact,) = [force for force in forces(scene.mechanism(), scene.motion(t)) if "friction" in force]
    assert np.array(contact["friction"]) == pytest.approx(scene.motion_law.required_friction(t), rel=1e-5, abs=1e-6)
    assert required_friction(np.array([[1.0, 2.0], [1.0, -1.0]])) == pytest.approx([0.5, np.nan], nan_ok=True)


def test_a_contact_turns_with_the_body_on_which_something_rolls():
    joint = Roll("roll", "first", "second", Rolling.at_arcs(Circle(0.3), Circle(0.5)))
    first, second = np.array([[0.0, 0.0, 0.0]]), np.array([[0.8, 0.0, 0.4]])
    contact, turn, shift = place_of(joint, first, second), 0.7, np.array([1.0, 2.0])
    second_turned = [*(shift + rotated(turn, second[0, :2])), 0.4 + turn]
    turned = place_of(joint, np.array([[*shift, turn]]), np.array([second_turned]))
    assert turned[0] == pytest.approx(shift + rotated(turn, contact[0]), abs=1e-14)
