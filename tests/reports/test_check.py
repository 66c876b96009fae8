"""Tests of `crosscheck check`: verdicts on models with known answers, and advice that can be copied."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np
import pytest

from engines.lagrange import JUDGE_CLAIM, loading
from engines.mujoco.reading import read as read_model
from engines.mujoco.writers import urdf
from engines.pymunk import DEFAULT as PYMUNK
from engines.pymunk.written_script import script
from engines.reading import ReadingTerms, RowRegularisation
from reference.checks import InvalidMechanism
from reference.joints import Drive, Pin
from reference.mechanism import Body, Mechanism
from reference.scenes.catalogue import SCENES
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.trajectory import Trajectory
from reports.check import first_use, rendering
from reports.check.checked import check, read_user_model, resample
from reports.check.document import check_data, schema
from reports.check.facts import compute_facts
from reports.check.judging import accelerations, reference_motion
from reports.check.pictures import picture_data_from_text, picture_data_of, render_pictures
from reports.check.telling import answer_section, report_sections
from tests.present import present
from tests.toys import Disc

INPUTS = Path(__file__).parent / "inputs"
FOUR_BAR = """<mujoco model="four bar"><option timestep="0.002"/>
<default><geom contype="0" conaffinity="0" size="0.02" type="capsule"/><joint axis="0 1 0"/></default>
<worldbody>
<body name="crank"><joint name="A"/><geom fromto="0 0 0 0 0 0.3"/>
 <body name="coupler" pos="0 0 0.3"><joint name="B"/><geom fromto="0 0 0 0.8 0 0.3"/></body></body>
<body name="rocker" pos="0.7 0 0"><joint name="D"/><geom fromto="0 0 0 0.1 0 0.6"/></body>
</worldbody>
<equality><connect name="C" body1="coupler" body2="rocker" anchor="0.8 0 0.3"/></equality>
</mujoco>"""
PENDULUM_1, PENDULUM_2 = (
    next(scene for scene in SCENES if scene.name == name) for name in ("pendulum_1", "pendulum_2")
)
PENDULUM = """
import pymunk

def make():
    space = pymunk.Space()
    space.gravity = (0, -9.81)
    bob = pymunk.Body(1, 0.08)
    bob.position = (0.5, 0)
    space.add(bob, pymunk.PivotJoint(space.static_body, bob, (0, 0), (-0.5, 0)))
    return space
"""


def found_in(folder, text, name="model.xml", word="model.xml", duration=0.4, tolerance=1e-4, step=None):
    (folder / name).write_text(text)
    return check(read_user_model(word, folder, ReadingTerms(step=step)), name, duration, tolerance)


@pytest.fixture(scope="module")
def shipped(tmp_path_factory):
    """The result of a check of the four-bar with MuJoCo's default settings."""
    return found_in(tmp_path_factory.mktemp("shipped"), FOUR_BAR)


def test_softness_is_the_main_error_of_a_default_mujoco_four_bar_and_the_advice_can_be_pasted(tmp_path, shipped):
    result = shipped
    assert not result.met
    # The declared softness of the loop explains most of the error, and the step the remaining error.
    parts = result.parts
    assert parts.softness > result.tolerance
    assert parts.rest < 0.3 * parts.step
    assert parts.falling
    assert result.opens is not None
    assert result.opens.row.startswith("C ")
    assert result.advised is not None
    assert result.advised.error <= result.tolerance
    reported = answer_section(result)
    assert reported.sentences[0].endswith("the tolerance of 1e-4 is missed.")
    option, default = reported.code
    mended = re.sub(r"<option [^/]*/>", option, FOUR_BAR).replace("<worldbody>", f"{default}<worldbody>", 1)
    again = found_in(tmp_path, mended)
    assert again.met
    assert again.own_errors.largest == pytest.approx(result.advised.error, rel=1e-6)
    assert again.verdict.endswith("the tolerance of 1e-4 is met.")


def test_the_declared_motion_with_a_very_fast_damper_is_integrated(tmp_path):
    """The rate of the damper is d / I = 1e6 / s, for which an explicit method overflows."""
    damped = FOUR_BAR.replace('axis="0 1 0"', 'axis="0 1 0" damping="5"').replace('size="0.02"', 'size="0.002"')
    result = found_in(tmp_path, damped)
    assert 0 < result.parts.softness < 1e-3
    assert result.parts.step < 1e-2


def test_the_lines_for_a_urdf_file_are_in_a_mujoco_element_and_can_be_pasted(tmp_path):
    text = re.sub(r"<mujoco>.*?</mujoco>", "", urdf(PENDULUM_2.mechanism()), flags=re.DOTALL)
    result = found_in(tmp_path, text, "chain.urdf", "chain.urdf", tolerance=1e-6)
    (line,) = answer_section(result).code
    assert line.startswith("<mujoco><option ")
    again = found_in(tmp_path, text.replace("</robot>", f"{line}</robot>"), "chain.urdf", "chain.urdf", tolerance=1e-6)
    assert again.met
    # MuJoCo refuses a second element <mujoco>, so only the option is printed if the file has this element.
    assert again.table[0].change.lines[0].startswith("<option ")


CLASSES = '<default><default class="own"><joint damping="0"/></default></default><worldbody>'


@pytest.mark.parametrize(
    ("place", "words"), [("", 'solref="0.04 1"'), (CLASSES, 'class="own"')], ids=["values of its own", "of a class"]
)
def test_an_equality_that_a_default_does_not_reach_is_named_in_the_advice(tmp_path, place, words):
    """If a default class is defined before the advised lines, its values apply, so the model would remain soft."""
    model_text = FOUR_BAR.replace("<worldbody>", place or "<worldbody>", 1).replace("<connect", f"<connect {words}")
    lines = answer_section(found_in(tmp_path, model_text)).code
    assert "an equality of a class, or with its own values, needs these values there" in lines[-1]
    if place:
        assert not found_in(tmp_path, model_text.replace("</mujoco>", f"{''.join(lines[:2])}</mujoco>")).met
        return
    values = re.search(r"(solref=.*)/></default>", lines[1])[1]  # type: ignore[index]
    assert found_in(tmp_path, model_text.replace(words, values).replace("</mujoco>", f"{lines[0]}</mujoco>")).met


def test_a_driven_pymunk_linkage_is_compared_in_all_forces_except_those_of_the_crank(tmp_path):
    scene = next(scene for scene in SCENES if scene.name == "driven_four_bar")
    result = found_in(tmp_path, script(PYMUNK, scene.mechanism(), 1e-3), "made.py", "made.py:make", step=1e-3)
    # The relative error of the forces is about the step times the rate of 10 rad/s. The forces of the crank are
    # unknown.
    assert 0 < result.own_errors.worst["reaction"] < 0.1
    assert (
        "motion",
        "all of it is prescribed, so a small error of the start has nothing to grow in",
    ) in answer_section(result).facts
    assert "0 freedoms by the rank" in report_sections(result)[1].sentences[0]


def test_the_damping_of_a_soft_drive_is_relative_to_its_prescribed_rate():
    joints = (Pin("hinge", None, "wheel", (0.0, 0.0), (0.0, 0.0)), Drive("motor", None, "wheel", 3.0, 0.0))
    at_rate = Mechanism((Body("wheel", 1.0, 0.1, (0.0, 0.0, 0.0), (0.0, 0.0, 3.0)),), joints)
    none = np.zeros(3)
    give = RowRegularisation(none, np.full(3, 10.0), np.diag(none), np.full(3, np.nan))
    for rate in (3.0, 2.0):
        twist = np.array([[0.0, 0.0, rate]])
        result = accelerations(at_rate, at_rate.pose, twist, 0.0, give)
        # The row of a prescribed rate has no compliance, so its acceleration is exactly -damping times the slip.
        assert result[0] == pytest.approx([0.0, 0.0, 10.0 * (3.0 - rate)], abs=1e-12)


def test_a_motion_that_is_cubic_in_time_is_resampled_exactly():
    """The obstacles of a model are looked for between the samples of the ideal motion, also after the last sample but
    one."""
    factors = np.random.default_rng(1).uniform(-1, 1, (4, 2, 3))

    def cubic(t: np.ndarray) -> np.ndarray:
        return np.einsum("tp,pbc->tbc", t[:, None] ** np.arange(4), factors)

    def rate(t: np.ndarray) -> np.ndarray:
        return np.einsum("tp,pbc->tbc", t[:, None] ** np.arange(3), factors[1:] * np.array([1, 2, 3])[:, None, None])

    t = np.array([0.0, 0.4, 1.0, 1.2])
    finer, pose, twist = resample(Trajectory(t, cubic(t), rate(t), np.zeros((4, 0))), 2)
    assert finer == pytest.approx([0.0, 0.2, 0.4, 0.7, 1.0, 1.1, 1.2])
    assert pose == pytest.approx(cubic(finer), abs=1e-14)
    assert twist == pytest.approx(rate(finer), abs=1e-13)


# the equation is x'' = -d/2 x' - 100 x
@pytest.mark.parametrize(("damping", "rate"), [(0.0, 10.0), (80.0, 20.0 + 300.0**0.5)])
def test_the_stiffest_mode_is_that_of_a_spring_and_a_damper(damping, rate):
    text = (
        '<mujoco><option gravity="0 0 0"/><worldbody><body><joint type="slide" axis="1 0 0" stiffness="200" '
        f'damping="{damping}"/>'
        '<inertial pos="0 0 0" mass="2" diaginertia=".1 .1 .1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model := mujoco.MjModel.from_xml_string(text))  # type: ignore[attr-defined]
    data.qvel[0] = 0.1
    mechanism = read_model(model, data).mechanism
    facts = compute_facts(mechanism, reference_motion(mechanism, 5, 0.01).trajectory)
    assert facts.stiffest_mode == pytest.approx(rate, rel=1e-4)


def test_exponential_growth_of_a_disturbance_ends_the_horizon_and_linear_growth_does_not():
    regular = reference_motion(PENDULUM_1.mechanism(), 200, 0.01)
    assert regular.horizon == regular.trajectory.t[-1]
    # After 3,000 radians an initial error of the rate has grown by a factor of more than 500, but only linearly.
    spinning = reference_motion(Disc(rate=1000.0).mechanism(), 300, 0.01)
    assert spinning.growth[-1] > 500
    assert spinning.horizon == pytest.approx(3.0, rel=1e-12)
    links = PENDULUM_2.mechanism()
    wild = replace(links, bodies=tuple(replace(body, twist=(0.0, 0.0, 0.0)) for body in links.bodies))
    chaotic, expected = reference_motion(wild, 1000, 0.015), reference_motion(wild, 1000, 0.015, tolerance=1e-10)
    # The time scale of the mechanism is 0.3 s; the motion is regular for a few time scales.
    t = chaotic.trajectory.t
    assert 1.0 < chaotic.horizon < t[-1]
    is_before_horizon = t < chaotic.horizon
    assert np.all(chaotic.growth[is_before_horizon] <= 100 * (1 + t[is_before_horizon] / wild.time_scale))
    # The motion ends where the judge's own error exceeds a tenth of the tolerance.
    assert expected.cut
    assert not chaotic.cut
    assert 0 < expected.trajectory.t[-1] < t[-1]
    assert np.max(present(expected.trajectory.estimate)) < 1e-11 * max(1.0, wild.length_scale)
    with pytest.raises(InvalidMechanism, match="does not know the ideal motion to a tenth of the tolerance"):
        reference_motion(wild, 10, 0.1, tolerance=1e-20)


def test_the_report_is_rendered_as_text_html_and_markdown(shipped):
    displayed = picture_data_from_text(picture_data_of(shipped).as_text())
    pictures = render_pictures(displayed)
    without_error = replace(displayed, found=replace(displayed.found, bars=displayed.ideal.bars))
    assert render_pictures(without_error)["worst"] != pictures["worst"]
    reported = report_sections(shipped, pictures)
    screen = rendering.plain([answer_section(shipped)]).splitlines()
    assert len(screen) <= 30
    assert max(map(len, screen)) <= 120
    page = rendering.html("four bar", reported)
    # Pictures are not inline SVG, since the frame of the first picture would clip the second picture.
    assert page.count("data:image/svg+xml;base64,") == page.count("<img ") == 2
    assert "<svg" not in page
    files = {title: f"{key}.svg" for key, (title, _) in pictures.items()}
    assert "](errors.svg)" in rendering.markdown("four bar", reported, files)
    foreign = rendering.Section("", ("<i>",), (("why", "<i>"),), ("<i>",), header=("<i>",), rows=(("<i>",),))
    assert "<i>" not in rendering.html("<i>", [foreign])
    assert rendering.markdown("four bar", [foreign], {}).count("<i>") == 1  # the code block contains "<i>"
    numbers = json.loads(json.dumps(check_data(shipped), allow_nan=False))
    assert set(numbers) == set(schema()["$defs"]["MODEL"]["required"])
    for name, setting in (("advised", shipped.advised), ("next_decade", shipped.decade)):
        assert numbers[name] == (setting and next(t for t in numbers["tried"] if t["words"] == setting.change.words))


SAMPLES, SPACING = 20, 0.01
NUMPY_NOTE = "following the ideal motion"


@pytest.fixture
def new_installation(monkeypatch, tmp_path):
    """An installation without machine code, in which compilation is slower than numpy. The value is the list of the
    reported stages."""
    monkeypatch.setattr(first_use, "COMPILE_SECONDS", math.inf)
    monkeypatch.setattr(first_use, "is_cold", lambda: True)
    monkeypatch.setattr(loading, "code_file", lambda: tmp_path / "judge.code")
    return list[str]()


def test_the_first_motion_from_numpy_has_the_accuracy_that_the_judge_claims(new_installation):
    mechanism = FreeFourBar().mechanism()
    motion = first_use.ideal_motion(mechanism, SAMPLES, SPACING, 1e-4, new_installation.append)
    expected = reference_motion(mechanism, SAMPLES, SPACING, 1e-4)
    difference = np.abs(motion.trajectory.pose - expected.trajectory.pose) / mechanism.pose_unit
    assert difference.max() < JUDGE_CLAIM
    assert new_installation == [NUMPY_NOTE]
    assert loading.numpy_seconds() > 0


@pytest.mark.parametrize(
    ("limit", "spent", "claim"), [(0.0, 0.0, JUDGE_CLAIM), (1e9, 2e9, JUDGE_CLAIM), (math.inf, 0.0, 0.0)]
)
def test_the_code_is_compiled_if_numpy_takes_longer_or_misses_its_claim(
    new_installation, limit, spent, claim, monkeypatch
):
    """Numpy is not used if it would run, or has already run, longer than a compilation takes."""
    monkeypatch.setattr(first_use, "COMPILE_SECONDS", limit)
    monkeypatch.setattr("engines.lagrange.judge.JUDGE_CLAIM", claim)
    loading.add_numpy_seconds(spent)
    first_use.ideal_motion(FreeFourBar().mechanism(), SAMPLES, SPACING, 1e-4, new_installation.append)
    assert new_installation[0] == NUMPY_NOTE
    assert new_installation[1].startswith(loading.COMPILING_NOTE)
