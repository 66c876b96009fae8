"""Tests of animations, as SVG files and as films."""

from __future__ import annotations

import re
import sys
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest

from engines import mujoco, pymunk
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli.commands import invoke
from reports.model.ending import BadInput
from reports.model.tasks import answered
from reports.site.animated import PAUSE, Shown, animation, film, shown
from reports.site.live.scenes import take_like

ENGINES = (("pymunk default", pymunk.DEFAULT, 1), ("mujoco tuned", mujoco.TUNED, 1))


@pytest.fixture(scope="module")
def falling() -> Shown:
    take = take_like(FreeFourBar(), ENGINES)
    return shown(take, {motion: answered(motion) for motion in take.motions().values()})


def keys(text: str, label: str) -> np.ndarray:
    """Key frames (n, 4): time [% of a repetition], displacements to the right and downwards [pt], rotation
    [degrees]."""
    rule = re.search(rf"@keyframes {label}{{(.*?)}}}}", text)
    assert rule is not None
    pattern = r"([\d.]+)%{transform:translate\(([-\d.]+)px,([-\d.]+)px\) rotate\(([-\d.]+)deg\)"
    return np.array(re.findall(pattern, rule[1] + "}"), dtype=float)


def test_key_frames_of_the_exact_motion_and_of_each_method_are_their_poses(falling):
    text = animation(falling, "A title")
    scales = []
    for index, pose in enumerate([*falling.motions.values(), falling.truth.pose]):
        for body in range(3):
            places = keys(text, f"m{index}b{body}")[:-1]
            frames = np.interp(places[:, 0] / 100 / (1 - PAUSE) * falling.t[-1], falling.t, np.arange(len(falling.t)))
            expected = (pose[frames.round().astype(int), body] - pose[0, body]) * (1, -1, -180 / np.pi)
            # Times are rounded to 0.01 %, and the expected pose is that of the nearest frame.
            assert np.abs(places[:, 3] - expected[:, 2]).max() < 2.0
            scales.append(np.vdot(places[:, 1:3], expected[:, :2]) / np.vdot(expected[:, :2], expected[:, :2]))
            assert np.abs(places[:, 1:3] / scales[-1] - expected[:, :2]).max() < 0.02
    assert np.ptp(scales) < 1e-3 * min(scales)  # points per metre


def test_an_animation_is_deterministic_xml_without_scripts_and_external_files(falling):
    text = animation(falling, 'A <title> & "more"')
    ElementTree.fromstring(text)
    assert "<script" not in text
    assert not re.search(r'href="(?!#)|url\((?!#)|@import', text)
    assert "prefers-reduced-motion" in text
    assert text == animation(falling, 'A <title> & "more"')


def test_a_method_that_fails_keeps_its_last_pose(falling):
    pose = falling.motions["pymunk default"].copy()
    pose[40:] = np.nan
    text = animation(replace(falling, motions={"pymunk default": pose}), "Lost")
    assert "nan" not in text
    places = keys(text, "m0b0")
    assert np.all(places[-5:, 1:] == places[-1, 1:])


def test_a_gif_has_its_frames_and_an_mp4_without_ffmpeg_is_refused(falling, tmp_path, monkeypatch):
    monkeypatch.setattr("reports.site.animated.SECONDS", 0.16)
    film(falling, "A title", tmp_path / "one.gif")
    from PIL import Image

    with Image.open(tmp_path / "one.gif") as image:
        assert (getattr(image, "n_frames", 1), image.size, image.info["duration"]) == (4, (1280, 560), 40)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(BadInput, match="needs the program ffmpeg"):
        film(falling, "A title", tmp_path / "one.mp4")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match="needs the program ffmpeg"):  # before any run
        invoke(["animate", "free_four_bar", "--to", "mp4"])
    assert [path.name for path in tmp_path.iterdir()] == ["one.gif"]
