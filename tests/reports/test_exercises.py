"""Tests of the exercises: the page's answers are those of the reference, and are the numbers of the solutions."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess

import numpy as np
import pytest

from reference.chapter.errata import velocities
from reference.chapter.skates import commutator_displacement, sidestep
from reference.scenes.four_bar.scenes import DrivenFourBar
from reports.site.lesson import exercise_of
from reports.site.lessons import LESSONS
from reports.site.munk2d import SHIM

NODE = 'import { ANSWERS } from "./exercises.js"; console.log(JSON.stringify(Object.fromEntries(' + (
    "Object.entries(ANSWERS).map(([name, answer]) => [name, answer()]))));"
)
EXERCISES = {exercise.answer: exercise for lesson in LESSONS for exercise in lesson.exercises}


@pytest.fixture(scope="module")
def answers(tmp_path_factory):
    if shutil.which("node") is None:
        pytest.skip("no Node.js is installed")
    folder = tmp_path_factory.mktemp("exercises")
    for path in (SHIM.parent / "assets").glob("*.js"):
        shutil.copy(path, folder)
    (folder / "package.json").write_text('{"type": "module"}')
    (folder / "run.js").write_text(NODE)
    ended = subprocess.run(["node", "run.js"], cwd=folder, capture_output=True, encoding="utf-8", check=False)
    assert ended.returncode == 0, ended.stderr
    return json.loads(ended.stdout)


# The answers by the reference.
EXPECTED = {
    "tip_speed": float(np.hypot(*velocities(1.0, (math.pi / 6, math.pi / 3), (2.0, -1.0)).b)),
    "freedoms_with_handle": 3.0,
    "commutator_aside": float(commutator_displacement(math.radians(20), 0.5)[1]),
    "sidestep_turn": math.degrees(sidestep(0.4, 0.5, math.pi / 6)[0].turn),
    "velocity_from_row": (math.sin(math.pi / 6) + 2 * 0.3) / math.cos(math.pi / 6),
    "rocker_rate": float(DrivenFourBar().four_bar.rates(0.0, 10.0)[1]),
}


def test_the_answers_of_the_page_are_those_of_the_reference(answers):
    assert set(answers) == set(EXPECTED) == set(EXERCISES)
    assert answers == pytest.approx(EXPECTED, rel=1e-9)


@pytest.mark.parametrize("name", EXERCISES)
def test_a_solution_contains_the_answer_of_the_page(answers, name):
    numbers = re.findall(r"-?\d+(?:\.\d+)?", EXERCISES[name].solution.replace("\N{MINUS SIGN}", "-"))
    assert any(float(number) == pytest.approx(answers[name], rel=2e-3) for number in numbers)


def test_each_lesson_with_exercises_has_three():
    assert {lesson.name: len(lesson.exercises) for lesson in LESSONS if len(lesson.exercises) not in (0, 3)} == {}


def test_an_exercise_without_a_solution_is_refused():
    with pytest.raises(ValueError, match="'Speed: `speed` \\[m\\]': an exercise has"):
        exercise_of("Speed: `speed` [m]\n\nHow fast?")
