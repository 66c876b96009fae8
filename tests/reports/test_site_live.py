"""What engines in the page are given: the adapters' models to the last bit, the truth, sliders that fit."""

from __future__ import annotations

import base64
import json
from dataclasses import replace
from typing import Any

import mujoco as mujoco_package
import numpy as np
import pytest

from engines import Unsupported
from engines import mujoco as mujoco_engine
from engines import pymunk as pymunk_engine
from engines.pymunk.methods import SKATE_GROOVE
from reference.plane import rotated
from reference.rolling.curves import Circle
from reference.rolling.kinematics import Rolling
from reference.rolling.roll import Roll
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar
from reference.scenes.rolling.scenes import RollingDisc, RollingEllipse
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reference.scenes.slider_crank.scenes import DrivenSliderCrank
from reports.site.drawn import demanded, loose, measure_of, opened, place_of
from reports.site.embed import forces
from reports.site.lessons import LESSONS
from reports.site.live import sliders
from reports.site.live.data import data as live_data
from reports.site.live.data import packed, template
from reports.site.live.models import Part, changes, plan_of, text_of
from reports.site.live.sliders import Live
from reports.site.rows import stored_rows
from tests import RESULTS

compiler: Any = mujoco_package  # its bindings carry no types
LIVE = {f"{lesson.name}: {live.word}": live for lesson in LESSONS for live in lesson.live}


def ends_of(live: Live) -> list[Scene]:
    """The first and the last place of the sliders, and the scene itself."""
    places = list(live.places())
    return [places[0], places[-1], live.scene]


@pytest.mark.parametrize("name", LIVE)
def test_the_scene_itself_is_a_place_of_its_sliders(name):
    live = LIVE[name]
    index = 0
    for slider in live.sliders:
        index = index * len(slider.values) + slider.start(live.scene)
        assert len(slider.told()) == len(slider.values)
    assert list(live.places())[index] == live.scene
    assert live.steps[live.start] % live.frames == 0


@pytest.mark.parametrize("name", LIVE)
def test_buttons_move_sliders_that_are_there(name):
    live = LIVE[name]
    sizes = {slider.field: len(slider.values) for slider in live.sliders} | {"steps": len(live.steps)}
    sizes |= {"munk": len(live.munk), "mujoco": len(live.mujoco)}
    sizes |= {"iterations": len(sliders.SWEEPS), "bias": len(sliders.BIASES)}
    for trap in live.traps:
        assert all(0 <= place < sizes[slider] for slider, place in trap.places.items()), trap.words
    assert live.traps


def test_sliders_that_do_not_fit_are_refused():
    slider = sliders.Slider("crank", "crank", tuple(0.3 + 0.001 * i for i in range(126)))
    with pytest.raises(ValueError, match="7 steps don't fit 60 frames"):
        Live("x", DrivenFourBar(), (7,), 60, 0)
    with pytest.raises(ValueError, match="more than 125 places"):
        Live("x", DrivenFourBar(), (60,), 60, 0, (slider,))


@pytest.mark.parametrize("name", LIVE)
def test_the_text_of_a_model_and_its_changes_give_back_the_model_that_the_adapter_compiles(name):
    for _, engine in LIVE[name].mujoco:
        for scene in ends_of(LIVE[name]):
            mechanism = scene.mechanism()
            try:
                told = text_of(engine, mechanism, 1e-3)
            except Unsupported:
                assert name == "rolling: a cam"  # of which MuJoCo has no shape
                continue
            again, ours = compiler.MjModel.from_xml_string(told.text), engine.model(mechanism, 1e-3, as_text=True)
            for path, values in told.changes:
                *owners, field = path.split(".")
                owner = again
                for part in owners:
                    owner = getattr(owner, part)
                if isinstance(getattr(owner, field), np.ndarray):
                    getattr(owner, field)[...] = np.reshape(values, getattr(owner, field).shape)
                else:
                    setattr(owner, field, type(getattr(owner, field))(values[0]))
            assert changes(again, ours.compiled) == []


def test_a_change_of_a_compiled_model_is_found():
    engine = mujoco_engine.DEFAULT.model(DrivenFourBar().mechanism(), 1e-3, as_text=True).compiled
    other = mujoco_engine.DEFAULT.model(DrivenFourBar(coupler=0.6).mechanism(), 1e-3, as_text=True).compiled
    assert {"body_pos", "body_mass", "stat.meaninertia"} <= {path for path, _ in changes(engine, other)}


def test_a_method_that_our_code_helps_is_no_model_of_a_page():
    sleigh = ChaplyginSleigh().mechanism()
    with pytest.raises(Unsupported, match="by code of ours in Python"):
        text_of(mujoco_engine.TUNED, sleigh, 1e-3)
    with pytest.raises(Unsupported, match="by code of ours in Python"):
        plan_of(replace(pymunk_engine.DEFAULT, roll="pivot"), RollingDisc().mechanism())


def test_a_template_differs_in_numbers_alone():
    parts, numbers = template(['<a x="1.5" y="-2e-3 4"/>', '<a x="3" y="5 6"/>'])
    assert (parts, numbers) == (['<a x="', '" y="', " ", '"/>'], ["1.5,-2e-3,4", "3,5,6"])
    with pytest.raises(ValueError, match="differ in more than numbers"):
        template(['<a x="1"/>', '<b x="1"/>'])


def test_what_munk2d_is_given_is_what_pymunk_holds():
    scene = DrivenFourBar()
    plan = plan_of(pymunk_engine.DEFAULT, scene.mechanism())
    mechanism = scene.mechanism()
    bodies = np.reshape(plan[5:38], (3, 11))
    assert (plan[:2], plan[4]) == (mechanism.gravity, 3)
    assert bodies[:, 0].tolist() == [1, 0, 0]  # the crank is kinematic
    assert bodies[1:, 1:3] == pytest.approx(mechanism.inertias[1:, 1:])
    assert bodies[1:, 3:6] == pytest.approx(mechanism.pose[1:])
    assert bodies[1:, 6:9] == pytest.approx(mechanism.twist[1:])
    records = np.reshape(plan[38:], (-1, 8))
    assert records[:, :2].tolist() == [[Part.PIVOT, 6]] * 3
    assert records[:, 2:4].tolist() == [[0, 1], [1, 2], [-1, 2]]


def test_a_plan_says_what_each_shape_and_each_hand_is():
    def parts(engine: Any, scene: Any) -> list[int]:
        plan = plan_of(engine, scene.mechanism())
        place, found = 5 + 11 * int(plan[4]), []
        while place < len(plan):
            found.append(int(plan[place]))
            place += 2 + int(plan[place + 1])
        assert place == len(plan)
        return found

    assert parts(pymunk_engine.DEFAULT, RollingDisc()) == [Part.SEGMENT, Part.CIRCLE]
    assert parts(pymunk_engine.DEFAULT, RollingEllipse()) == [Part.SEGMENT, Part.POLYGON]
    assert parts(pymunk_engine.DEFAULT, ChaplyginSleigh()) == [Part.ZEROED]
    assert parts(SKATE_GROOVE, ChaplyginSleigh()) == [Part.GROOVE, Part.AIMED]
    assert parts(pymunk_engine.DEFAULT, DrivenSliderCrank()) == [Part.PIVOT, Part.PIVOT, Part.GROOVE]


def test_doubles_of_a_page_are_the_same_to_the_last_bit():
    values = np.array([[0.1, -1e-300], [np.inf, 2.0]])
    assert np.array_equal(np.frombuffer(base64.b64decode(packed(values)), dtype="<f8"), values.ravel())


def test_a_live_scene_holds_the_truth_of_every_place():
    whole = LIVE["skate: the sleigh"]
    live = replace(whole, sliders=whole.sliders[-1:])  # every place has a model of each engine, which takes its time
    held = json.loads(json.dumps(live_data(live, {}), allow_nan=False))
    frames = np.arange(live.frames + 1)
    for index, scene in enumerate(live.places()):
        truth = np.frombuffer(base64.b64decode(held["pool"][held["truth"][index]]), dtype="<f8")
        assert np.array_equal(truth, scene.motion(frames * (scene.duration / live.frames)).pose.ravel())
    assert held["native"]["munk"]["pose"] is None
    assert held["measure"] == "position"


def test_slips_and_openings_are_those_of_the_mechanism():
    sleigh = ChaplyginSleigh()
    mechanism, motion = sleigh.mechanism(), sleigh.motion([0.0, 1.0])
    (blade,) = loose(mechanism)
    assert np.abs(opened(mechanism, blade, motion.pose, motion.twist)).max() < 1e-12
    pushed = motion.twist + np.array([0.0, 0.3, 0.0])  # 0.3 m/s along y in the world
    across = np.stack([-np.sin(motion.pose[:, 0, 2]), np.cos(motion.pose[:, 0, 2])], axis=-1)
    slip = opened(mechanism, blade, motion.pose, pushed)
    assert slip == pytest.approx(0.3 * across[:, 1:] * across, abs=1e-12)
    ellipse = RollingEllipse()
    mechanism, motion = ellipse.mechanism(), ellipse.motion([0.0, 0.7])
    (contact,) = loose(mechanism)
    lifted = motion.pose + np.array([1e-3, 2e-3, 0.0])
    assert opened(mechanism, contact, lifted, motion.twist) == pytest.approx(np.array([[1e-3, 2e-3]] * 2), abs=1e-9)


def test_a_contact_turns_with_the_body_on_which_something_rolls():
    joint = Roll("roll", "first", "second", Rolling.at_arcs(Circle(0.3), Circle(0.5)))
    first, second = np.array([[0.0, 0.0, 0.0]]), np.array([[0.8, 0.0, 0.4]])
    place, turn, shift = place_of(joint, first, second), 0.7, np.array([1.0, 2.0])
    second_turned = [*(shift + rotated(turn, second[0, :2])), 0.4 + turn]
    turned = place_of(joint, np.array([[*shift, turn]]), np.array([second_turned]))
    assert turned[0] == pytest.approx(shift + rotated(turn, place[0]), abs=1e-14)


def test_friction_that_is_demanded_is_that_of_the_rolling_body():
    scene = RollingEllipse()
    t = np.linspace(0, scene.duration, 50)
    truth = scene.motion(t)
    (told,) = [each for each in forces(scene.mechanism(), truth) if "friction" in each]
    assert np.array(told["friction"]) == pytest.approx(scene.motion_law.required_friction(t), rel=1e-5, abs=1e-6)
    pulled = demanded(np.array([[1.0, 2.0], [1.0, -1.0]]))
    assert pulled[0] == 0.5
    assert np.isnan(pulled[1])


def test_the_error_of_a_mechanism_on_skates_is_that_of_its_place():
    assert measure_of(ChaplyginSleigh().mechanism()) == "position"
    assert measure_of(DrivenFourBar().mechanism()) == "angle"


def test_stored_rows_are_series_of_steps_and_errors():
    header = "scene,engine,variant,purpose,outcome,step,angle,position"
    lines = [header, "driven_four_bar,pymunk,default,sweep,finished,0.01,0.5,0.1"]
    lines += [
        "x,pymunk,default,sweep,finished,1,1,1",
        "driven_four_bar,pymunk,default,sweep,finished,0.001,0.05,0.01",
        "driven_four_bar,pymunk,default,map,finished,1,1,1",
    ]
    (series,) = stored_rows("\n".join(lines), ["driven_four_bar"])
    assert series["points"] == {"angle": [[0.01, 0.5], [0.001, 0.05]], "position": [[0.01, 0.1], [0.001, 0.01]]}
    published = (RESULTS / "errors.csv").read_text("utf-8")
    for live in LIVE.values():
        methods = {each["method"] for each in stored_rows(published, [live.scene.name])}
        assert methods & {"pymunk default", "pymunk tuned", "mujoco default"}
