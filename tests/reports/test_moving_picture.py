"""The picture of README that moves: made by `report`, small, without a script, for dark paper and for still readers."""

from __future__ import annotations

import re
from xml.etree import ElementTree

import numpy as np
import pytest

from reports.cli.report import moving_picture
from reports.model.outcomes import Outcome
from reports.model.page import Material
from reports.model.tasks import Answer
from reports.pages.four_bar.page import MOVED, MOVING, MOVING_PICTURE, PAGE

LARGEST = 300_000  # bytes


@pytest.fixture(scope="module")
def answers():
    return {task: Answer(Outcome.FINISHED, "", task.run()) for task in MOVED}


def test_the_picture_is_small_moves_by_style_alone_and_stands_still_for_who_asks(answers):
    (text,) = moving_picture([Material({}), Material({}, answers)]).values()
    assert len(text.encode()) < LARGEST
    root = ElementTree.fromstring(text)
    assert not [element for element in root.iter() if element.tag.endswith(("script", "foreignObject", "image"))]
    still, moves = text.split("@media (prefers-reduced-motion: no-preference) {")
    assert "@keyframes" not in still
    assert "(prefers-color-scheme: dark)" in still
    # Three engines and the truth, three bars each, and the errors that grow.
    assert len(re.findall(r"@keyframes m\d+b\d+\{", moves)) == 3 * (len(MOVING) + 1)
    assert all(f">{word}<" in text for word in (*MOVING, "the exact motion"))
    assert text == moving_picture([Material({}, answers)])[MOVING_PICTURE]


def test_the_picture_tells_the_story_of_its_description(answers):
    """pymunk as shipped visibly behind, MuJoCo as shipped a little, with the lines below not at all."""
    scene = MOVED[0].cell.scene
    truth = scene.motion(np.arange(scene.samples + 1) * scene.spacing).pose
    pymunk, mujoco, lines = (np.abs(answers[task].array("pose") - truth)[..., 2].max() for task in MOVED)
    assert 0.1 < pymunk < 0.5
    assert 3e-3 < mujoco < 0.03
    assert lines < 1e-5


def test_without_all_of_its_motions_there_is_no_picture_and_the_page_asks_for_them(answers):
    assert moving_picture([Material({}, dict(list(answers.items())[1:]))]) == {}
    assert set(MOVED) <= set(PAGE.tasks)
