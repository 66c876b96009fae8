"""Tests of the commands `check`, `export` and `view`: files, exit statuses, and messages for bad models."""

# pyright: reportAttributeAccessIssue=false
# MuJoCo's module has no list of its names.
from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
import types
import xml.etree.ElementTree as xml
from pathlib import Path
from typing import Any, ClassVar

import mujoco
import numpy as np
import pytest

from reports.check.request import CheckReport, CheckRequest, Refused, run_check
from tests.reports.test_check import FOUR_BAR, PENDULUM
from tests.reports.test_command_line import call, here

__all__ = ["here"]


def test_a_missed_tolerance_gives_exit_status_1_and_report_files(here, capfd):
    (here / "four_bar.xml").write_text(FOUR_BAR)
    text = ("check", "four_bar.xml", "--duration", 0.2, "--html", "out.html", "--markdown", "sub/out.md", "--json")
    assert call(*text, "--tolerance", 1e-4) == 1
    out, err = capfd.readouterr()
    assert json.loads(out)["met"] is False
    assert err.splitlines()[-1].endswith("the tolerance of 1e-4 is missed.")
    assert re.search(r"^ +\d+\.\d s  \w+", err, re.MULTILINE)  # progress
    assert "data:image/svg+xml" in (here / "out.html").read_text()
    page = (here / "sub/out.md").read_text()
    for name in ("out_1.svg", "out_2.svg"):
        assert f"]({name})" in page
        xml.parse(here / "sub" / name)


@pytest.mark.parametrize(
    ("text", "limit", "sentence"),
    [
        ("while True:\n    pass", 1, "CPU"),
        (
            "import pymunk\nfrom pymunk._chipmunk_cffi import lib\nspace, body = pymunk.Space(), pymunk.Body(1, 1)\n"
            "space.add(body)\nlib.cpSpaceAddBody(space._space, body._body)",
            60,
            "its process was lost: aborted with signal 6 ... a second time. Failed condition: body->space != space",
        ),
    ],
    ids=["endless", "aborted by Chipmunk"],
)
def test_a_script_that_exits_or_never_ends_is_reported_in_one_line(here, capfd, text, limit, sentence):
    (here / "script.py").write_text(text)
    assert call("check", "script.py:space", "--limit", limit) == 2
    out, err = capfd.readouterr()
    assert out == ""
    (line,) = [line for line in err.splitlines() if line.startswith("crosscheck: ")]
    assert all(part in line for part in (*sentence.split(" ... "), "script.py:space"))
    assert "Traceback" not in err


def test_an_exported_script_runs_without_the_suite_and_follows_the_exact_motion_in_its_comments(here):
    assert call("export", "free_four_bar", "--to", "pymunk", "--step", 1e-4, "--out", "alone.py") == 0
    text = (here / "alone.py").read_text()
    assert "crosscheck" not in text
    reported = subprocess.run([sys.executable, "-I", "alone.py"], cwd=here, capture_output=True, text=True, check=True)
    last = reported.stdout.splitlines()[-1]
    assert last.startswith("1.0000 s")
    poses = eval(last.split("s ", 1)[1])
    truth = {}
    for line in text.split("# t = 1 s")[1].splitlines()[1:4]:
        name, numbers = line.lstrip("# ").split(": ")
        truth[name] = [float(part.split()[1]) for part in numbers.split(", ")]
    # With default settings and a step of 0.1 ms the angle error is 2e-2 rad after 1 s.
    for (x, y, angle), true_pose in zip(poses, truth.values(), strict=True):
        assert abs(x - true_pose[0]) < 0.05
        assert abs(y - true_pose[1]) < 0.05
        assert abs(angle - true_pose[2]) < 0.1


def test_a_view_without_a_display_is_an_animation_in_a_file(here, capfd, monkeypatch):
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    assert call("view", "pendulum_2") == 0
    assert "no viewer: there is no display" in capfd.readouterr().out
    xml.parse(here / "pendulum_2.svg")
    assert len(re.findall(r"@keyframes m0b\d", (here / "pendulum_2.svg").read_text())) == 2  # of each body
    assert call("view", "pendulum_2") == 2
    assert "--force" in capfd.readouterr().err


class Window:
    """A substitute for the viewer's window, which closes after three steps."""

    last: ClassVar[Window]

    def __init__(self, model, data, **look):
        self.model, self.data, self.look, self.seen = model, data, look, []
        Window.last = self

    def __enter__(self):
        return self

    def __exit__(self, *reasons):
        return None

    def is_running(self):
        return len(self.seen) < 3

    def sync(self):
        self.seen.append(float(self.data.time))


def test_a_view_with_a_display_steps_the_scene_in_mujocos_window(here, monkeypatch):
    viewer = types.ModuleType("mujoco.viewer")
    viewer.launch_passive = Window  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "mujoco.viewer", viewer)
    monkeypatch.setattr(mujoco, "viewer", viewer, raising=False)
    monkeypatch.setenv("DISPLAY", ":7")
    assert call("view", "driven_four_bar") == 0
    window = Window.last
    np.testing.assert_allclose(window.seen, [1e-3, 2e-3, 3e-3])
    assert window.model.ngeom >= 5
    assert window.look == {"show_left_ui": False, "show_right_ui": False}
    assert not list(here.iterdir())


BAD: dict[str, dict[str, Any]] = tomllib.loads(Path(__file__).with_name("bad_models.toml").read_text(encoding="utf-8"))


@pytest.mark.parametrize("word", BAD)
def test_a_bad_model_is_refused_in_one_sentence(tmp_path, word):
    bad, name = BAD[word], word.split(":")[0]
    if "text" in bad:
        text = str({"FOUR_BAR": FOUR_BAR, "PENDULUM": PENDULUM}.get(bad["text"], bad["text"]))
        (tmp_path / name).write_text(text.replace(*bad.get("replaced", ("", ""))))
    answer = run_check(CheckRequest(word, str(tmp_path), 0.5, 1e-4))
    assert isinstance(answer, Refused)
    assert bad["sentence"] in answer.sentence
    assert "\n" not in answer.sentence
    assert len(answer.sentence) < 600
    assert name in answer.sentence


def test_a_script_can_use_files_and_modules_in_its_folder(tmp_path):
    home, paths = Path.cwd(), list(sys.path)
    (tmp_path / "length.txt").write_text("0.5")
    # the names are those of a Python module, of a package of this suite, and of no other module
    for name in ("csv", "reference", "local"):
        (tmp_path / f"{name}.py").write_text("MINE = True")
    (tmp_path / "swing.py").write_text(
        "import csv, local, pymunk, reference, sys\nassert csv.MINE and local.MINE and reference.MINE\n"
        "assert sys.argv == [__file__] and sys.path[0] + '/swing.py' == __file__\n"
        "with open('length.txt') as file:\n    length = float(file.read())\n"
        "space, body = pymunk.Space(), pymunk.Body(1, 0.1)\n"
        "space.gravity, body.position = (0, -9.81), (length, 0)\n"
        "space.add(body, pymunk.PivotJoint(space.static_body, body, (0, 0), (-length, 0)))\n"
    )
    answer = run_check(CheckRequest("swing.py", str(tmp_path), 0.1))
    assert isinstance(answer, CheckReport)
    assert answer.data["facts"]["length"] == 0.5
    assert (Path.cwd(), sys.path) == (home, paths)
    assert "local" not in sys.modules
    assert not hasattr(sys.modules["reference"], "MINE")


@pytest.mark.parametrize(("element", "sentence"), [("rain", "--without is 'rain'"), ("contact", "")])
def test_elements_are_switched_off_by_their_kind_and_an_unknown_kind_is_refused(tmp_path, element, sentence):
    (tmp_path / "hits.xml").write_text(BAD["hits.xml"]["text"])
    answer = run_check(CheckRequest("hits.xml", str(tmp_path), 0.3, 1e-1, (element,)))
    if sentence:
        assert isinstance(answer, Refused)
        assert sentence in answer.sentence
    else:
        assert isinstance(answer, CheckReport)
        assert answer.fine


def test_the_process_that_waits_for_a_check_imports_neither_numpy_nor_scipy():
    program = "import sys, reports.cli.check, reports.check.rendering; print({'numpy', 'scipy'} & {*sys.modules})"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
