"""Tests with scenes and engines that exit, hang or return wrong data, with wrong command lines, and with extreme
numbers.

Each case gives an outcome or a one-line message without a traceback.
"""

from __future__ import annotations

import os
import re
import time
from dataclasses import dataclass, fields, replace
from typing import ClassVar

import numpy as np
import pytest

from engines.loading import load
from reference.checks import InvalidMechanism
from reference.numerics.integration import IntegrationFailed
from reference.scene import NoMotion, Scene, with_settings
from reference.trajectory import Trajectory
from reports.cli import known
from reports.model import catalogue
from reports.model.catalogue import SCENES
from reports.model.cells import Cell
from reports.model.ending import FINE, REFUSED
from reports.model.measure import blank, measure
from reports.run.supervisor import supervise
from reports.site.markdown import render_html
from reports.write.csv_files import as_csv
from reports.write.templates import inert_page
from tests.reports.rough_toys import is_free, wait_until
from tests.reports.test_command_line import call, here, one_line
from tests.reports.test_measure import Given, disc
from tests.toys import Disc, Toy

__all__ = ["here"]
SCENE = """
import os, time
from dataclasses import dataclass
from typing import ClassVar
from tests.toys import Disc

@dataclass(frozen=True)
class Odd(Disc):
    name: ClassVar[str] = "odd"

"""


@pytest.mark.parametrize(
    ("head", "deed", "sentence"),
    [
        ("mechanism(self):", "os._exit(0)", "the process ended by itself with exit status 0"),
        ("__eq__(self, other):", "raise RuntimeError('no such thing')", "RuntimeError: no such thing"),
        pytest.param("mechanism(self):", "time.sleep(1e6)", "did not end within 10 s", marks=pytest.mark.slow),
    ],
)
def test_errors_of_a_users_scene_are_reported_in_one_line(here, monkeypatch, capfd, head, deed, sentence):
    if "sleep" in deed:  # on a loaded machine an import takes seconds
        monkeypatch.setattr(known, "SLEEPING", 10.0)
    (here / "odd_scene.py").write_text(f"{SCENE}    __hash__ = Disc.__hash__\n    def {head}\n        {deed}\n")
    assert call("run", "odd_scene.py") == REFUSED
    reported = one_line(capfd.readouterr().err)
    assert reported.startswith("crosscheck: odd_scene.py: ")
    assert sentence in reported
    assert not (here / "crosscheck-results").exists()


@pytest.mark.parametrize(
    ("text", "telling"),
    [
        ("duration: ClassVar[float] = float('inf')", "duration is inf"),
        ("horizon: ClassVar[float] = 0.0", "horizon is 0.0"),
        ("samples: ClassVar[int] = 2**40", "samples is 1099511627776"),
        ("samples = property(lambda self: 0)", "samples is 0"),
    ],
)
def test_a_scene_without_duration_or_samples_is_refused(here, text, telling):
    path = here / f"odd_{abs(hash(text))}.py"  # the names of modules differ, since Python caches modules
    path.write_text(f"{SCENE}    {text}\n")
    with pytest.raises(ValueError, match=r"\w") as reported:
        load(str(path), catalogue.SCENE)
    assert telling in str(reported.value)


def forks(file):
    """Fork, and return in both processes like a careless engine. The child process holds a lock on the file."""
    import fcntl

    stored = os.open(file, os.O_CREAT | os.O_WRONLY)
    fcntl.flock(stored, fcntl.LOCK_EX)
    if os.fork():
        os.close(stored)
    elif file.name == "1":
        time.sleep(1e4)
    return file


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_job_that_forks_is_answered_once_and_its_child_is_ended(tmp_path):
    files = [tmp_path / str(number) for number in range(3)]
    reported = list(supervise(forks, files, 20.0, workers=2))
    assert sorted((item, result) for item, result, _ in reported) == [(file, file) for file in files]
    for path in files:
        with path.open("w") as file:
            wait_until(lambda file=file: is_free(file))


def test_names_with_markup_and_formulas_are_escaped_on_pages_and_in_tables():
    page = inert_page("# <script>x</script>\n<details>\n<summary>a</summary>\n\n`<b>` <!-- c -->\n```\n<b>\n```\n")
    assert page == "# &lt;script>x&lt;/script>\n<details>\n<summary>a</summary>\n\n`<b>` <!-- c -->\n```\n<b>\n```\n"
    row = replace(
        blank(Cell(Disc(), Toy(), 1)), engine="=cmd|' /C calc'!A0", variant="+1", sentence="@x", position=-1.0
    )
    line = as_csv([row], timings=False).splitlines()[1]
    assert "'=cmd|" in line
    assert ",'+1," in line
    assert ",'@x," in line
    assert ",-1," in line


def test_names_with_markup_are_escaped_on_the_site():
    pytest.importorskip("mdit_py_plugins", reason="MyST is not installed: pip install '.[site]'")
    site = render_html("# <script>x</script>\n\n| <img src=x onerror=y> |\n|--|\n| <!--><iframe> `<b>` |\n")
    assert set(re.findall(r"<[/!]?[\w-]+", site)) == {"<h1", "</h1", "<table", "</table", "<!--"} | {
        f"<{slash}{tag}" for slash in ("", "/") for tag in ("thead", "tbody", "tr", "th", "td", "code")
    }


def test_a_file_named_minus_is_the_standard_output(here, capfd):
    assert call("export", "free_four_bar", "--out", "-") == FINE
    written = capfd.readouterr().out
    assert call("export", "free_four_bar") == FINE
    assert capfd.readouterr().out == written
    assert list(here.iterdir()) == []


# Numbers without a motion

BY_NAME = {scene.name: scene for scene in SCENES}
EXTREMES = ("1e200", "1e-200", "-1", "nan")


# These scenes take up to 15 s, and "pendulum_2" has the same fields.
LONG_SCENES = ("pendulum_10", "pendulum_100")


@pytest.mark.parametrize("scene", [scene for scene in SCENES if scene.name not in LONG_SCENES], ids=lambda s: s.name)
def test_every_number_of_every_scene_gives_a_finite_start_or_a_refusal(scene: Scene):
    for field in fields(scene):  # type: ignore[arg-type]
        for text in EXTREMES:
            try:
                start = with_settings(scene, {field.name: text}).motion(0.0)
            except InvalidMechanism:
                continue
            assert np.isfinite([start.pose, start.twist]).all(), (field.name, text)


@pytest.mark.parametrize(
    ("name", "number", "reason"),
    [
        ("free_slider_crank", "gravity", "the motion stops"),
        ("pendulum_2", "tip", "positive definite"),
        ("cart", "trail", "the reactions that its accelerations need are not finite"),
    ],
)
def test_a_missing_exact_motion_is_not_counted_as_an_error_of_the_engine(name, number, reason):
    scene = with_settings(BY_NAME[name], {number: "1e200"})
    with pytest.raises(NoMotion, match=rf"scene '{name} {number}=1e\+200': no motion is known up to .*{reason}"):
        scene.motion(np.linspace(0.0, scene.duration, 3))


@dataclass(frozen=True)
class WrongScene(Disc):
    """A user's scene whose exact motion has the defect `how`."""

    name: ClassVar[str] = "wrong"
    how: str = ""

    def _motion(self, times: np.ndarray) -> Trajectory:
        good = super()._motion(times)
        arrays = {"pose": good.pose.copy(), "twist": good.twist.copy(), "reaction": good.reaction.copy()}
        part, _, value = self.how.partition("=")
        if part in arrays:
            arrays[part][-1] = float(value)
        elif part == "raise":
            raise {"1/0": ZeroDivisionError, "diverged": IntegrationFailed}[value](value)
        return replace(good, **arrays)


@pytest.mark.parametrize(
    "how", ["pose=nan", "pose=inf", "twist=nan", "twist=1e200", "reaction=inf", "raise=1/0", "raise=diverged"]
)
def test_a_users_truth_that_is_not_finite_is_refused_by_name_and_the_engine_is_not_graded(how):
    row = measure(Cell(WrongScene(how=how), Given(disc()), 1), repeat=False)
    assert row.outcome == "refused"
    assert row.sentence.startswith("scene 'wrong': no motion is known up to ")


def test_an_unknown_reaction_in_the_exact_motion_is_accepted():
    assert measure(Cell(WrongScene(how="reaction=nan"), Given(disc()), 1), repeat=False).outcome == "finished"
