"""What engines in the page are given: the adapters' models to the last bit, the truth, sliders that fit."""

from __future__ import annotations

import base64
import json
import re
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
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reports.site.drawn import demanded, place_of
from reports.site.lessons import LESSONS
from reports.site.live import sliders
from reports.site.live.data import data as live_data
from reports.site.live.data import forces
from reports.site.live.models import Part, plan_of, text_of
from reports.site.live.sliders import Live

LIVE = {f"{lesson.name}: {live.word}": live for lesson in LESSONS for live in lesson.scenes}


@pytest.mark.parametrize("name", LIVE)
def test_the_scene_itself_is_a_place_of_its_sliders(name):
    live = LIVE[name]
    index = 0
    for slider in live.sliders:
        control = slider.control(live.scene)
        index = index * len(slider.values) + control.start
        assert len(control.texts) == len(slider.values)
    assert list(live.places())[index] == live.scene
    assert live.steps[live.start] % live.frames == 0


@pytest.mark.parametrize("lesson", LESSONS, ids=lambda lesson: lesson.name)
def test_experiments_set_controls_that_are_there_and_have_their_words(lesson):
    for part, each in zip(lesson.parts, lesson.experiments, strict=True):
        live = lesson.scene(each.scene)
        for given in (each.before, each.after, *(change for change, _ in each.causes)):
            assert len(live.located(given)) == len(given)
        assert bool(part.question) == bool(each.after), part.heading  # what changes is guessed first
        # A change has a claim that is measured, but where it is the exact motion that changes.
        assert each.claims or not set(each.after) - {slider.field for slider in live.sliders}, part.heading
        numbers = re.findall(r"{(\w+)}", part.text + part.after)
        assert set(numbers) <= set(live.controls()), part.heading


def test_sliders_that_do_not_fit_are_refused():
    slider = sliders.Slider("crank", "crank", tuple(0.3 + 0.001 * i for i in range(126)))
    with pytest.raises(ValueError, match="7 steps don't fit 60 frames"):
        Live("x", DrivenFourBar(), (7,), 60, 0)
    with pytest.raises(ValueError, match="more than 125 places"):
        Live("x", DrivenFourBar(), (60,), 60, 0, (slider,))


def test_a_method_that_our_code_helps_is_no_model_of_a_page():
    sleigh = ChaplyginSleigh().mechanism()
    with pytest.raises(Unsupported, match="writes rows while it steps"):
        text_of(mujoco_engine.TUNED, sleigh, 1e-3)
    with pytest.raises(Unsupported, match="by code of ours in Python"):
        plan_of(replace(pymunk_engine.DEFAULT, roll="pivot"), RollingDisc().mechanism(), 1.0)


def test_what_munk2d_is_given_is_what_pymunk_holds():
    scene = DrivenFourBar()
    told = plan_of(pymunk_engine.DEFAULT, scene.mechanism(), scene.duration)
    plan = told.numbers
    mechanism = scene.mechanism()
    assert plan[5:8] == (10, pymunk_engine.SHIPPED_ERROR_BIAS, 0)
    bodies = np.reshape(plan[8:41], (3, 11))
    assert (plan[:2], plan[4]) == (mechanism.gravity, 3)
    assert bodies[:, 0].tolist() == [1, 0, 0]  # the crank is kinematic
    assert bodies[1:, 1:3] == pytest.approx(mechanism.inertias[1:, 1:])
    assert bodies[1:, 3:6] == pytest.approx(mechanism.pose[1:])
    assert bodies[1:, 6:9] == pytest.approx(mechanism.twist[1:])
    records = np.reshape(plan[41:], (-1, 8))
    assert records[:, :2].tolist() == [[Part.PIVOT, 6]] * 3
    assert records[:, 2:4].tolist() == [[0, 1], [1, 2], [-1, 2]]
    assert (told.impulses, told.idle) == ((-1, 0, 1, 2), ())


def test_a_plan_says_what_each_shape_and_each_hand_is():
    def parts(engine: Any, scene: Any) -> list[int]:
        plan = plan_of(engine, scene.mechanism(), scene.duration).numbers
        place, found = 8 + 11 * int(plan[4]), []
        while place < len(plan):
            found.append(int(plan[place]))
            place += 2 + int(plan[place + 1])
        assert place == len(plan)
        return found

    assert parts(pymunk_engine.DEFAULT, RollingDisc()) == [Part.SEGMENT, Part.CIRCLE]
    assert parts(pymunk_engine.DEFAULT, RollingEllipse()) == [Part.SEGMENT, Part.POLYGON]
    assert parts(SKATE_CENTRE, ChaplyginSleigh()) == [Part.ZEROED]
    assert parts(SKATE_GROOVE, ChaplyginSleigh()) == [Part.GROOVE, Part.AIMED]
    assert parts(pymunk_engine.DEFAULT, DrivenSliderCrank()) == [Part.PIVOT, Part.PIVOT, Part.GROOVE]


def test_a_live_scene_holds_the_truth_of_every_place():
    whole = LIVE["skate: the sleigh"]
    live = replace(whole, sliders=whole.sliders[-1:])  # every place has a model of each engine, which takes its time
    held = json.loads(json.dumps(live_data(live, {}), allow_nan=False))
    frames = np.arange(live.frames + 1)
    for index, scene in enumerate(live.places()):
        truth = np.frombuffer(base64.b64decode(held["places"][index]["truth"]), dtype="<f8").reshape(-1, 1, 6)
        motion = scene.motion(frames * (scene.duration / live.frames))
        assert np.array_equal(truth, np.concatenate([motion.pose, motion.twist], axis=-1))
    assert held["native"]["munk"] == [None] * len(live.munk)
    assert held["munk"][0]["why"] == "pymunk as shipped has no joint for a skate"
    assert held["measure"] == "position"


def test_of_a_force_that_the_motion_leaves_open_the_rest_is_told():
    gears = EllipticGears()
    truth = gears.motion(np.linspace(0, 1, 5))
    first, second, mesh = forces(gears.mechanism(), truth)
    assert first["partly"]
    assert np.reshape(second["force"], (-1, 2)) == pytest.approx(np.nan_to_num(truth.reaction[:, 2:4]), abs=1e-6)
    assert mesh["contact"]
    assert "friction" not in mesh


def test_friction_that_is_demanded_is_that_of_the_rolling_body():
    scene = RollingEllipse()
    t = np.linspace(0, scene.duration, 50)
    truth = scene.motion(t)
    (told,) = [each for each in forces(scene.mechanism(), truth) if "friction" in each]
    assert np.array(told["friction"]) == pytest.approx(scene.motion_law.required_friction(t), rel=1e-5, abs=1e-6)
    pulled = demanded(np.array([[1.0, 2.0], [1.0, -1.0]]))
    assert pulled[0] == 0.5
    assert np.isnan(pulled[1])


def test_a_contact_turns_with_the_body_on_which_something_rolls():
    joint = Roll("roll", "first", "second", Rolling.at_arcs(Circle(0.3), Circle(0.5)))
    first, second = np.array([[0.0, 0.0, 0.0]]), np.array([[0.8, 0.0, 0.4]])
    place, turn, shift = place_of(joint, first, second), 0.7, np.array([1.0, 2.0])
    second_turned = [*(shift + rotated(turn, second[0, :2])), 0.4 + turn]
    turned = place_of(joint, np.array([[*shift, turn]]), np.array([second_turned]))
    assert turned[0] == pytest.approx(shift + rotated(turn, place[0]), abs=1e-14)
