"""Pictures that move: what they show is what was computed, they stand alone, and bad words are refused in a line."""

from __future__ import annotations

import re
import sys
from types import ModuleType
from xml.etree import ElementTree

import numpy as np
import pytest

from engines import mujoco, pymunk
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli.commands import invoke
from reports.model.ending import BadInput, FileTrouble
from reports.model.tasks import answered
from reports.site.animated import PAUSE, animation, decades, ffmpeg, film
from reports.site.embed import Shown, shown
from reports.site.lessons import LESSONS, take_like
from tests import ROOT

ENGINES = (("pymunk default", pymunk.DEFAULT, 1), ("mujoco tuned", mujoco.TUNED, 1))


@pytest.fixture(scope="module")
def falling() -> Shown:
    take = take_like(FreeFourBar(), ENGINES)
    return shown(take, {motion: answered(motion) for motion in take.motions().values()})


def keys(text: str, label: str) -> np.ndarray:
    """(instants, 4): share of the round, x, y [m], angle [degrees] of a body."""
    rule = re.search(rf"@keyframes {label}{{(.*?)}}}}", text)
    assert rule is not None
    pattern = r"([\d.]+)%{transform:translate\(([-\d.]+)px,([-\d.]+)px\) rotate\(([-\d.]+)deg\)"
    return np.array(re.findall(pattern, rule[1] + "}"), dtype=float)


def test_the_truth_and_each_method_pass_through_their_poses(falling):
    text = animation(falling, "A title")
    for index, pose in enumerate([*falling.motions.values(), falling.truth.pose]):
        for body in range(3):
            found = keys(text, f"m{index}b{body}")[:-1]
            frames = np.interp(found[:, 0] / 100 / (1 - PAUSE) * falling.t[-1], falling.t, np.arange(len(falling.t)))
            exact = pose[frames.round().astype(int), body] * (1, 1, 180 / np.pi)
            # Instants are told to a hundredth of a percent, half a frame at worst: what moves in it is small.
            assert np.abs(found[:, 1:] - exact).max() < 2.0
            assert np.abs(found[:, 1:3] - exact[:, :2]).max() < 0.02


def test_a_picture_is_xml_without_script_and_the_same_every_time(falling):
    text = animation(falling, 'A <title> & "more"')
    ElementTree.fromstring(text)
    assert "<script" not in text
    assert "http" not in text.replace("http://www.w3.org/2000/svg", "")
    assert "prefers-reduced-motion" in text
    assert text == animation(falling, 'A <title> & "more"')


def test_a_method_that_gave_up_stays_where_it_was(falling):
    pose = falling.motions["pymunk default"].copy()
    pose[40:] = np.nan
    text = animation(Shown(falling.take, falling.mechanism, falling.t, falling.truth, {"one": pose}, {}, {}), "Lost")
    assert "nan" not in text
    found = keys(text, "m0b0")
    assert np.all(found[-5:, 1:] == found[-1, 1:])


def test_errors_are_drawn_over_the_decades_that_they_have():
    assert decades([np.array([1e-5, 2e-5, 3e-5]), np.array([0.0, 0.2, 0.3])]) == (-5, 0)
    assert decades([np.array([np.nan, 0.0])]) == (-1, 0)


def test_a_film_is_written(falling, tmp_path, monkeypatch):
    monkeypatch.setattr("reports.site.animated.FRAMES", 4)
    film(falling, "A title", tmp_path / "one.gif")
    from PIL import Image

    with Image.open(tmp_path / "one.gif") as image:
        assert getattr(image, "n_frames", 1) == 4
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)  # as if it were not installed
    with pytest.raises(BadInput, match="needs the program ffmpeg"):
        film(falling, "A title", tmp_path / "one.mp4")


def test_the_picture_of_the_readme_is_small_and_moves():
    (name,) = re.findall(r"!\[[^]]+\]\(([^)]+\.svg)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    text = (ROOT / name).read_text(encoding="utf-8")
    assert len(text.encode()) < 500_000
    ElementTree.fromstring(text)
    take = take_like(FreeFourBar(), (("pymunk default", pymunk.DEFAULT, 1),))
    again = animation(shown(take, {motion: answered(motion) for motion in take.motions().values()}), "")
    # The truth is the last of its motions: it stands there as it would be drawn today.
    last = len(re.findall(r"@keyframes m\d+b0{", text)) - 1
    assert np.abs(keys(text, f"m{last}b0") - keys(again, "m1b0")).max() < 1e-2
    assert np.abs(keys(text, "m0b0") - keys(again, "m0b0")).max() < 1e-2


def test_a_scene_of_a_lesson_is_drawn_as_there():
    take = next(take for lesson in LESSONS for take in lesson.takes.values() if take.ends)
    assert take_like(take.scene, ()).ends == take.ends


@pytest.mark.parametrize(
    ("words", "refusal", "told"),
    [
        (["free_four_bar", "--to", "bmp"], BadInput, "--to is 'bmp'; there are svg, gif, mp4"),
        (["free_four_bar", "--engines", "pymunk defautl"], BadInput, "did you mean 'pymunk default'"),
        (["four_bar"], BadInput, "'four_bar' names 3 scenes; give one of"),
        (["free_four_bar", "--output", "mine.svg"], FileTrouble, "is there already"),
        (["free_four_bar", "--output", "mine.svg/x.svg"], FileTrouble, "give another --output"),
    ],
)
def test_bad_words_are_refused_in_a_line_before_anything_is_run(words, refusal, told, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.svg").write_text("mine")
    with pytest.raises(refusal, match=re.escape(told)):
        invoke(["animate", *words])
    assert [(path.name, path.read_text()) for path in tmp_path.iterdir()] == [("mine.svg", "mine")]


def test_mp4_is_written_by_the_program_of_a_package_where_none_is_installed(monkeypatch, tmp_path):
    program = ModuleType("imageio_ffmpeg")
    program.get_ffmpeg_exe = lambda: "/some/ffmpeg"  # pyright: ignore[reportAttributeAccessIssue]
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", program)
    assert ffmpeg() == "/some/ffmpeg"
