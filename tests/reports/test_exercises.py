"""Tests of the exercises: the answers of the page agree with the reference and with the numbers in the solutions."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from reference.chapter.centrodes import instant_centre
from reference.chapter.errata import accelerations, velocities
from reference.chapter.skates import commutator_displacement, sidestep
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.site.lesson import exercise_of
from reports.site.lessons import LESSONS
from tests.reports.page_scripts import run_in_node

NODE = """
import { MOTIONS, asDxf, asSvg, crosses, seriesOf, shapesOf } from "./cam.js";
import { ANSWERS } from "./exercises.js";
const answers = Object.fromEntries(Object.entries(ANSWERS).map(([name, answer]) => [name, answer()]));
const shapes = shapesOf(MOTIONS.Ellipse, -1);
const drawn = [...Array(200).keys()].map((k) => [2 + Math.cos(k * Math.PI / 100), Math.sin(k * Math.PI / 100)]);
const crossing = [[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]];
console.log(JSON.stringify({ answers, shapes, dxf: asDxf(shapes), svg: asSvg(shapes), circle: seriesOf(drawn),
  crosses: [crosses(shapes.space), crosses(shapesOf(MOTIONS["Straight line"], 1).space), crosses(crossing)] }));
"""
EXERCISES = {exercise.answer: exercise for lesson in LESSONS for exercise in lesson.exercises}


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return run_in_node(tmp_path_factory.mktemp("exercises"), NODE)


@pytest.fixture(scope="module")
def answers(page):
    return page["answers"]


FOUR_BAR = DrivenFourBar().four_bar
AC = FOUR_BAR.crank + FOUR_BAR.coupler
SLIDER_PLACE = 0.15 + math.sqrt(0.81 - 0.09 * 0.75)
LINKS = (math.pi / 6, math.pi / 3)
# Answer -> expected value, from the reference or in closed form.
EXPECTED = {
    "tip_speed": float(np.hypot(*velocities(1.0, LINKS, (2.0, -1.0)).b)),
    "freedoms_with_handle": 3.0,
    "centre_above": float(instant_centre(np.zeros(3), np.array([3.0, 0.0, 2.0]))[0][1]),
    "moving_circle": 0.25,  # half of the ring's radius, by Cardan's circles
    "contact_speed": 3 / (1 / 0.25 - 1 / 0.5),
    "commutator_aside": float(commutator_displacement(math.radians(20), 0.5)[1]),
    "sidestep_turn": math.degrees(sidestep(0.4, 0.5, math.pi / 6)[0].turn),
    "velocity_from_row": (math.sin(math.pi / 6) + 2 * 0.3) / math.cos(math.pi / 6),
    "rocker_angle": float(FOUR_BAR.angles(math.pi)[1]),
    "other_assembly": float(-FOUR_BAR.rocker * math.sin(FOUR_BAR.angles(math.pi / 2, -1)[1])),
    "dead_centre": math.degrees(math.acos((AC**2 + 1.2**2 - FOUR_BAR.rocker**2) / (2 * AC * 1.2))),
    "slider_place": SLIDER_PLACE,
    "slider_speed": -3 * math.sin(math.pi / 3) * SLIDER_PLACE / (SLIDER_PLACE - 0.15),
    "rod_centre": SLIDER_PLACE * math.tan(math.pi / 3),
    "bottom_rate": math.sqrt(3 * 9.81),
    "bottom_force": 2.5 * 2 * 9.81,
    "tip_acceleration": float(np.hypot(*accelerations(1.0, LINKS, (2.0, -1.0), (1.0, 3.0)).b)),
    "speed_ahead": math.hypot(2, 0.9),
    "turning_acceleration": 6.0,
    "skated_aside": 0.5 * (1 - math.cos(2)),
    "turning_circle": 2.6 / math.tan(0.4),
    "steady_bend": math.asin(3 * math.tan(0.4) / 2.6),
    "doubling_time": 3 * math.log(2),
    "contact_on_circle": 0.5,
    "ellipse_curvature": 0.5 / 0.3**2,
    "conformal_acceleration": 2.4,
    "largest_ratio": 3.0,
    "gear_rate": 12 / 7,
    "second_angle": 2 * math.atan(1 / 3),
    "coupler_centre": 1.2,
    "coupler_speed": 5 * math.hypot(0.2, 0.6),
    "ladder_centre": 2.0,
    "rocker_rate": float(FOUR_BAR.rates(0.0, 10.0)[1]),
}


def test_the_answers_of_the_page_are_those_of_the_reference(answers):
    assert set(answers) == set(EXPECTED) == set(EXERCISES)
    assert answers == pytest.approx(EXPECTED, rel=1e-5)  # the largest rates and forces are those at the samples


@pytest.mark.parametrize("name", EXERCISES)
def test_a_solution_contains_the_answer_of_the_page(answers, name):
    numbers = re.findall(r"-?\d+(?:\.\d+)?", EXERCISES[name].solution.replace("\N{MINUS SIGN}", "-"))
    assert any(float(number) == pytest.approx(answers[name], rel=2e-3) for number in numbers)


def test_each_lesson_has_three_exercises():
    assert {lesson.name: len(lesson.exercises) for lesson in LESSONS if len(lesson.exercises) != 3} == {}


def test_an_exercise_without_a_solution_is_refused():
    with pytest.raises(ValueError, match="'Speed: `speed` \\[m\\]': an exercise has"):
        exercise_of("Speed: `speed` [m]\n\nHow fast?")


def test_the_shapes_of_the_page_are_the_centrodes_of_the_reference(page):
    shapes = {name: np.array(values) for name, values in page["shapes"].items()}
    t = np.linspace(0.0, 2 * np.pi, 361)
    twist = np.column_stack([-0.5 * np.sin(t), 0.2 * np.cos(t), np.full(361, -1.0)])
    pose = np.column_stack([0.5 * np.cos(t), 0.2 * np.sin(t), -t])
    space, body = instant_centre(pose, twist)
    assert np.abs(np.hstack([shapes["path"] - pose[:, :2], shapes["space"] - space])).max() < 1e-14
    assert np.abs(shapes["body"] - body).max() < 1e-14
    assert page["crosses"] == [False, False, True]


def test_a_drawn_circle_is_the_first_harmonic(page):
    expected = {"cosines": [[2, 0], [1, 0], [0, 0], [0, 0]], "sines": [[0, 0], [0, 1], [0, 0], [0, 0]]}
    for name, values in expected.items():
        # The drawn polygon has 200 corners and differs from the circle by 1e-4.
        assert np.array(page["circle"][name]) == pytest.approx(np.array(values), abs=2e-4)


def test_the_files_of_the_shapes_contain_both_curves(page, tmp_path):
    ezdxf = pytest.importorskip("ezdxf", reason="ezdxf is not installed: pip install '.[dxf]'")
    path = tmp_path / "shapes.dxf"
    path.write_text(page["dxf"])
    lines = {
        line.dxf.layer: np.array([(point.x, point.y) for point in line.points()])
        for line in ezdxf.readfile(path).modelspace()
    }
    for name in ("space", "body"):
        assert np.abs(lines[name.upper()] - np.array(page["shapes"][name][:-1])).max() < 1e-6
    assert [each.get("id") for each in ElementTree.fromstring(page["svg"])] == ["space", "body"]
