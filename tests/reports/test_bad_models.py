"""`crosscheck check` and what it can't check: each bad model is refused in one sentence, with what to do."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import re

import mujoco
import pytest
from pymunk import Space

from engines import Unsupported
from engines.mujoco.reading.settings import switch_off as of_mujoco
from engines.pymunk.reading.own_model import switch_off as of_pymunk
from reports.check.request import CheckReport, CheckRequest, Refused, answered
from reports.cli.check import SWITCHED_OFF
from tests.reports.test_check import FOUR_BAR, found_in


@pytest.fixture(autouse=True)
def _quick(monkeypatch):
    """Few settings are tried: what is asked here is whether a model is refused."""
    monkeypatch.setattr("reports.check.checked.PATIENCE", 0.4)


BODY = '<body name="{0}" pos="{1} 0 0"><joint axis="0 1 0"/><geom size=".1" contype="0" conaffinity="0"/></body>'
BAD = {
    "not_planar.xml": (
        '<mujoco><worldbody><body name="a"><joint name="one" axis="0 1 0"/><geom size=".1"/><body><joint name="two" '
        'axis="1 0 0"/><geom size=".1"/></body></body></worldbody></mujoco>',
        "joint 'two': it is not parallel to joint 'one'",
    ),
    "no_inertia.xml": (
        '<mujoco><worldbody><body><joint/><inertial pos="0 0 0" mass="1" diaginertia="0 0 0"/></body></worldbody>'
        "</mujoco>",
        "MuJoCo can't compile it",
    ),
    "open_loop.xml": (
        FOUR_BAR.replace("</mujoco>", '<keyframe><key qpos=".3 0 0"/></keyframe></mujoco>'),
        "row 'C y' is open by 0.263 m",
    ),
    "malformed.xml": ("<mujoco><worldbody><body></mujoco>", "MuJoCo can't compile it"),
    "empty.xml": ("", "MuJoCo can't compile it"),
    "no_robot.urdf": ("<robot name='x'/>", ""),
    "many.xml": (
        f"<mujoco><worldbody>{''.join(BODY.format(f'b{i}', i) for i in range(1_000))}</worldbody></mujoco>",
        "it has 1000 moving bodies; the judge takes up to 200",
    ),
    "hits.xml": (
        '<mujoco><worldbody><geom name="floor" type="plane" size="1 1 1"/><body pos="0 0 .15"><joint type="slide" '
        'axis="0 0 1"/><geom name="ball" size=".1"/></body></worldbody></mujoco>',
        "geom 'floor' touches geom 'ball' at 0.1",
    ),
    "raises.py:space": ("raise RuntimeError('no\\nspace')", "raises.py raised RuntimeError: no space"),
    "ends.py:space": ("import sys\nsys.exit(3)", "ends.py raised SystemExit: 3"),
    "nothing.py:space": ("x = 1", "it has no 'space'"),
    "other.py:space": ("space = 3", "it is int; it must be a pymunk.Space"),
    "unnamed.py": ("x = 1", "give the name of the space"),
    "drives.py:space": (
        "import pymunk\nspace = pymunk.Space()\nbody = pymunk.Body(1, 1)\nbody.angular_velocity = 1\n"
        "space.add(body, *[pymunk.SimpleMotor(space.static_body, body, rate) for rate in (1, 2)])",
        "is moving apart at",
    ),
    "prints.py:space": ("print('hello')\nspace = 'text'", "it is str; it must be a pymunk.Space"),
    "leaves.py:space": ("import sys\nsys.exit('enough')", "leaves.py raised SystemExit: enough"),
    "stops.py:space": ("raise KeyboardInterrupt", "stops.py raised KeyboardInterrupt"),
    "binary.xml": (bytes(range(256)) * 40, "MuJoCo can't compile it"),
    "binary.mjb": (b"\x00\xff" * 300, "MuJoCo can't compile it"),
    "binary.py:space": (b"\x00\x01\x02", "binary.py raised"),
    "folder.xml": ("/", "it is a folder"),
    "folder.py:space": ("/", "it is a folder"),
    "mesh.xml": (
        '<mujoco><asset><mesh name="m" file="nowhere.stl"/></asset><worldbody><body><joint/><geom type="mesh" '
        'mesh="m"/></body></worldbody></mujoco>',
        "nowhere.stl",
    ),
    "includes.xml": ('<mujoco><include file="nowhere.xml"/></mujoco>', "nowhere.xml"),
    "not_a_number.xml": (
        '<mujoco><worldbody><body><joint/><geom size=".1" pos=".2 0 0"/></body></worldbody>'
        '<keyframe><key qpos="nan"/></keyframe></mujoco>',
        "qpos of joint 0 is nan at the start; it must be a finite number",
    ),
    "still.py:space": ("import pymunk\nspace = pymunk.Space()", "nothing in it can move"),
    "missing.xml": (None, "there is no such file"),
    "picture.png": (None, "is no model; give"),
}


@pytest.mark.parametrize("word", BAD)
def test_a_bad_model_is_one_sentence(tmp_path, word):
    text, sentence = BAD[word]
    file = tmp_path / word.split(":")[0]
    if text == "/":
        file.mkdir()
    elif isinstance(text, bytes):
        file.write_bytes(text)
    elif text is not None:
        file.write_text(text)
    answer = answered(CheckRequest(word, str(tmp_path), 0.5, 1e-4, pictures=False))
    assert isinstance(answer, Refused)
    assert sentence in answer.sentence
    assert "\n" not in answer.sentence
    assert len(answer.sentence) < 600
    assert word.split(":")[0] in answer.sentence


@pytest.mark.parametrize(("element", "sentence"), [("rain", "--without is 'rain'"), ("contact", "")])
def test_what_is_left_out_is_known_by_its_word(tmp_path, element, sentence):
    (tmp_path / "hits.xml").write_text(BAD["hits.xml"][0])
    answer = answered(CheckRequest("hits.xml", str(tmp_path), 0.3, 1e-1, (element,), pictures=False))
    if sentence:
        assert isinstance(answer, Refused)
        assert sentence in answer.sentence
    else:
        assert isinstance(answer, CheckReport)
        assert answer.met


def test_a_motion_that_meets_a_contact_is_refused_with_a_duration_that_does_not(tmp_path):
    (tmp_path / "hits.xml").write_text(BAD["hits.xml"][0])
    refused = answered(CheckRequest("hits.xml", str(tmp_path), 0.5, 1e-1, pictures=False))
    assert isinstance(refused, Refused)
    duration = float(re.search(r"--duration ([\d.]+)", refused.sentence)[1])  # type: ignore[index]
    shorter = answered(CheckRequest("hits.xml", str(tmp_path), duration, 1e-1, pictures=False))
    assert isinstance(shorter, CheckReport)


def test_a_step_longer_than_the_motion_is_refused(tmp_path):
    with pytest.raises((ValueError, Unsupported), match="give a longer one"):
        found_in(tmp_path, FOUR_BAR, duration=0.0004)


@pytest.mark.parametrize(
    ("switch_off", "model"), [(of_mujoco, lambda: mujoco.MjModel.from_xml_string("<mujoco/>")), (of_pymunk, Space)]
)
def test_the_help_names_all_that_can_be_switched_off(switch_off, model):
    with pytest.raises(ValueError, match="--without is 'rain'") as told:
        switch_off(model(), "rain")
    words = str(told.value).split("must be one of ")[1].split(", ")
    assert [word for word in words if word not in re.findall(r"\w+", SWITCHED_OFF)] == []
