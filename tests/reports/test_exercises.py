"""Tests of the exercises: the answers of the page agree with the reference and with the numbers in the solutions."""

from __future__ import annotations

import math
import re
from xml.etree import ElementTree

import numpy as np
import pytest

from reference.chapter.centrodes import instant_centre
from reference.chapter.errata import acceleration_of_g, accelerations, velocities
from reference.chapter.skates import commutator_displacement, sidestep
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.pages.errata.page import ERRATA as SLIPS
from reports.site.lessons import LESSONS
from tests.reports.page_scripts import run_in_node

NODE = """
import { readFileSync } from "node:fs";
import { MOTIONS, asDxf, asSvg, crosses, once, seriesOf, shapesOf } from "./cam.js";
import { ERRATA } from "./errata.js";
import { ANSWERS, verdict } from "./exercises.js";
const answers = Object.fromEntries(Object.entries(ANSWERS).map(([name, answer]) => [name, answer()]));
const verdicts = JSON.parse(readFileSync(0, "utf-8")).map(([name, text]) => verdict(name, text));
const errata = Object.fromEntries(Object.entries(ERRATA).map(([number, { start, of }]) => [number, of(start)]));
const shapes = shapesOf(MOTIONS.Ellipse, -1);
const drawn = [...Array(200).keys()].map((k) => [2 + Math.cos(k * Math.PI / 100), Math.sin(k * Math.PI / 100)]);
const crossing = [[0, 0], [1, 1], [1, 0], [0, 1], [0, 0]];
const files = { dxf: asDxf(shapes), svg: asSvg(shapes) };
const ellipses = [1, -1].map((turn) => shapesOf(MOTIONS.Ellipse, turn)).flatMap(({ space, body }) => [space, body]);
console.log(JSON.stringify({ answers, verdicts, errata, shapes, ...files, circle: seriesOf(drawn),
  crosses: [...ellipses, crossing].map(crosses),
  rounds: [shapes.space, shapes.body, crossing].map((points) => once(points).length) }));
"""
EXERCISES = {exercise.answer: exercise for lesson in LESSONS for exercise in lesson.exercises}


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
    "ring_contact": 3 / (1 / 0.2 - 1 / 0.5),
    "terms_apart": float(np.hypot(*np.subtract(*acceleration_of_g(0.0, 2.0, 0.0, 3.0, 0.0, (0.0, 0.0))))),
    "bar_up": float(accelerations(1.0, (0.0, math.pi / 3), (0.0, -1.0), (0.0, 3.0)).b_relative_to_a[1]),
}
DEGREES = (30.0, 60.0)  # taken as radians
# Answer -> results of usual mistakes: another sign, an angle in degrees, a missing term, sine and cosine exchanged.
WRONG = {
    "tip_speed": (*(np.hypot(*velocities(1.0, *at).b) for at in ((LINKS, (2.0, 1.0)), (DEGREES, (2.0, -1.0)))), 3, 1),
    "freedoms_with_handle": (21 - 2 * 8, 21 - 9, 4, 2),
    "centre_above": (3 * 2, 2 / 3),
    "moving_circle": (0.5, 0.125),
    "contact_speed": (3 / (1 / 0.25 + 1 / 0.5), 3 * 0.25, 3),
    "commutator_aside": (0.5 * math.sin(20), 0.5 * math.radians(20), 0.5 * (1 - math.cos(math.radians(20))), 0.47),
    "sidestep_turn": (math.degrees(math.asin(0.8)), 0.4115, 47.16),
    "velocity_from_row": ((0.5 - 0.6) / math.cos(math.pi / 6), 1.1, (math.sin(30) + 0.6) / math.cos(30)),
    "rocker_angle": (math.pi - FOUR_BAR.angles(math.pi)[1], FOUR_BAR.angles(math.pi, -1)[1], 166.5),
    "other_assembly": (0.8, 0.08, 0.4),
    "dead_centre": (90 - 61.87, 1.0799, 180 - 61.87),
    "slider_place": (0.15 - 0.8617, 0.15 + 0.9, 0.3 * math.sin(math.pi / 3) + math.sqrt(0.81 - 0.0225)),
    "slider_speed": (-2.598, -3.0, -2.598 + 0.452),
    "rod_centre": (SLIDER_PLACE / math.sqrt(3), SLIDER_PLACE, 2 * SLIDER_PLACE),
    "bottom_rate": (math.sqrt(9.81), math.sqrt(2 * 9.81), math.sqrt(6 * 9.81)),
    "bottom_force": (2 * 9.81, 1.5 * 2 * 9.81, 3 * 2 * 9.81),
    "tip_acceleration": (
        *(
            np.hypot(*accelerations(1.0, LINKS, *at).b)
            for at in (((2, -1), (0, 0)), ((0, 0), (1, 3)), ((2, 1), (1, 4)))
        ),
        np.hypot(*accelerations(1.0, DEGREES, (2.0, -1.0), (1.0, 3.0)).b),
    ),
    "speed_ahead": (2.9, 2.0, 0.9),
    "turning_acceleration": (12, 2 * 9, 4 * 3),
    "skated_aside": (0.5 * math.sin(2), 0.5 * (1 - math.cos(math.radians(2))), math.sin(2)),
    "turning_circle": (2.6 * math.tan(0.4), 2.6 / math.sin(0.4), 2.6 / math.tan(math.radians(0.4))),
    "steady_bend": (math.atan(3 / 6.15), 3 / 6.15, 29.2),
    "doubling_time": (2 * math.log(2), math.log(2) / 3, 3, 6),
    "contact_on_circle": (3.5 / (5 - 2), 3.5 * 0.2, 3.5 * 0.5),
    "ellipse_curvature": (0.3 / 0.5**2, 1 / 0.5, 1 / 0.3),
    "conformal_acceleration": (4 / (5 + 1 / 0.3), 2 / (5 - 1 / 0.3), 4 * 0.2),
    "largest_ratio": (1.5, 1 / 3, 2),
    "gear_rate": (4 * 0.7 / 0.3, 4 * 0.3),
    "second_angle": (math.pi / 6, 2 * math.atan(3), 36.87),
    "coupler_centre": (0.8, 0.4, 1.6),
    "coupler_speed": (4.0, 2.0, 10 * math.hypot(0.2, 0.6)),
    "ladder_centre": (1.0, math.sqrt(3)),
    "rocker_rate": (5, -10, -10 * FOUR_BAR.rocker / FOUR_BAR.crank),
    "ring_contact": (3 / 7, 3 * 0.2, 3 * 0.5),
    "terms_apart": (0, 6, 12),
    "bar_up": (2.366, 0.5, 2.598, 0.5 - 2.598),
}
FACTORS = {-1: "sign", 2: "twice", 0.5: "half", 180 / math.pi: "degrees", math.pi / 180: "radians"}
GIVEN = [
    *((name, f"{value:.4g}") for name, value in EXPECTED.items()),
    *((name, f"{value:.4g}") for name, values in WRONG.items() for value in values),
    *((name, f"{factor * value:.4g}") for name, value in EXPECTED.items() for factor in FACTORS),
    ("rocker_angle", " 2,906 "),
    ("rocker_angle", "\N{MINUS SIGN}2.906"),
    ("rocker_angle", "pi"),
    ("rocker_angle", ""),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    return run_in_node(tmp_path_factory.mktemp("exercises"), NODE, GIVEN)


@pytest.fixture(scope="module")
def answers(page):
    return page["answers"]


def test_the_answers_of_the_page_are_those_of_the_reference(answers):
    assert set(answers) == set(EXPECTED) == set(EXERCISES)
    assert answers == pytest.approx(EXPECTED, rel=1e-5)  # the largest rates and forces are those at the samples


def test_the_page_accepts_the_answers_of_the_reference_and_refuses_usual_mistakes(page):
    verdicts = list(zip(GIVEN, page["verdicts"], strict=True))
    right, wrong = verdicts[: len(EXPECTED)], verdicts[len(EXPECTED) : -4]
    assert [each for each in right if not each[1].startswith("Right. ")] == []
    assert {*WRONG} == {*EXPECTED}
    assert [each for each in wrong if each[1].startswith("Right. ")] == []
    factors = [words for _ in EXPECTED for words in FACTORS.values()]
    told = verdicts[-4 - len(factors) : -4]
    assert [each for each, words in zip(told, factors, strict=True) if words not in each[1]] == []
    assert [words.partition(" ")[0] for _, words in verdicts[-4:]] == ["Right.", "The", "Give", "Give"]


def test_the_page_computes_the_errata_of_the_reference(page):
    errata = page["errata"]
    for slip in SLIPS:
        values = errata[str(slip.number)]
        # differences of order eight with a spacing of 0.02 s have errors of 1e-10 in a second derivative of 5 rad/s^2
        assert values["decides"] == pytest.approx(slip.values.decides, abs=1e-9), slip.number
        assert values["right"] == pytest.approx(slip.values.right, abs=1e-12), slip.number
        if slip.number == 19:  # the page integrates by Euler's method
            assert values["printed"] != pytest.approx(slip.values.printed, abs=1e-3)
        else:
            assert values["printed"] == pytest.approx(slip.values.printed, abs=1e-12), slip.number
    both = [FOUR_BAR.angles(math.pi / 2, side)[1] for side in (1, -1)]
    assert np.exp(1j * np.array(errata["all angles"]["right"])) == pytest.approx(np.exp(1j * np.array(both)))
    contact = 1.7 / (1 / 0.3 - 1 / 0.8)
    assert (*errata["4"]["right"], *errata["4"]["decides"]) == pytest.approx((contact, contact), abs=1e-9)
    assert all(values["right"] == pytest.approx(values["decides"], abs=1e-9) for values in errata.values())
    assert all(values["printed"] != pytest.approx(values["decides"], abs=1e-3) for values in errata.values())


def test_the_tables_of_the_lessons_have_the_numbers_that_the_page_computes(page):
    rows = [
        (row[1], re.findall("`(.+?)`", row[0]))
        for lesson in LESSONS
        for part in lesson.experiments
        for row in re.finditer(r"^\| ([^|]+) \| .*`.*$", part.after_words, re.MULTILINE)
    ]
    assert {number for number, _ in rows} == {*page["errata"]}
    for number, cells in rows:
        values = page["errata"][number]
        written = [[float(each) for each in cell.strip("()").split(", ")] for cell in cells]
        for name, found in zip(("printed", "right", "decides"), written, strict=True):
            assert found == pytest.approx(values[name], abs=6e-4), number


@pytest.mark.parametrize("name", EXERCISES)
def test_a_solution_contains_the_answer_of_the_page(answers, name):
    numbers = re.findall(r"-?\d+(?:\.\d+)?", EXERCISES[name].solution.replace("\N{MINUS SIGN}", "-"))
    assert any(float(number) == pytest.approx(answers[name], rel=2e-3) for number in numbers)


def test_each_lesson_has_three_exercises():
    assert {lesson.name: len(lesson.exercises) for lesson in LESSONS if len(lesson.exercises) != 3} == {}


def test_the_shapes_of_the_page_are_the_centrodes_of_the_reference(page):
    shapes = {name: np.array(values) for name, values in page["shapes"].items()}
    t = np.linspace(0.0, 2 * np.pi, 361)
    twist = np.column_stack([-0.5 * np.sin(t), 0.2 * np.cos(t), np.full(361, -1.0)])
    pose = np.column_stack([0.5 * np.cos(t), 0.2 * np.sin(t), -t])
    space, body = instant_centre(pose, twist)
    assert np.abs(np.hstack([shapes["path"] - pose[:, :2], shapes["space"] - space])).max() < 1e-14
    assert np.abs(shapes["body"] - body).max() < 1e-14
    # The body curve is a circle that is traced twice in a turn, and touches itself.
    assert page["crosses"] == [False, False, False, False, True]
    assert page["rounds"] == [361, 181, 5]


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
        points = np.array(page["shapes"][name][:-1])[: len(lines[name.upper()])]
        assert np.abs(lines[name.upper()] - points).max() < 1e-6
    assert {name: len(points) for name, points in lines.items()} == {"SPACE": 360, "BODY": 180}
    assert [each.get("id") for each in ElementTree.fromstring(page["svg"])] == ["space", "body"]
