"""Tests of scenes and engines that are not registered, with other parameters, and with invalid names."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path

import pytest

from engines import loading, method_name, registry
from engines.loading import load
from reference.scene import with_settings
from reference.scenes.catalogue import scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.cli.terminal import PULSE, Terminal, progress
from reports.model import catalogue
from reports.model.ending import FINE, REFUSED
from tests.reports.test_command_line import call, one_line
from tests.toys import Toy

# The file of a user with a scene and an engine that inherit from classes of this project.
FALLING = """
from dataclasses import dataclass
from typing import ClassVar

from reference.scenes.pendulum.link import BarPendulum
from engines.lagrange import Lagrange

@dataclass(frozen=True)
class Falling(BarPendulum):
    name: ClassVar[str] = "falling"
    source: ClassVar[str] = "nowhere"
    duration: float = 0.5
    horizon: float = 0.5

@dataclass(frozen=True)
class Mine(Lagrange):
    @property
    def name(self) -> str:
        return "mine"

ENGINES = [Mine("euler", "projection"), Mine("rk4", "projection")]
"""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """An empty current folder. Afterwards sys.path and the imported modules are restored."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))
    loaded = set(sys.modules)
    yield tmp_path
    for name in set(sys.modules) - loaded:
        if str(getattr(sys.modules[name], "__file__", None) or "").startswith(str(tmp_path)):
            del sys.modules[name]


def written(folder: Path, name: str, text: str) -> Path:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text, encoding="utf-8")
    return folder / name


def methods(engines):
    return [method_name(engine) for engine in engines]


def test_an_engine_is_found_by_module_by_file_and_in_a_list(here):
    written(here, "mine_1.py", FALLING)
    written(here, "package/__init__.py", "")
    written(here, "package/mine_2.py", FALLING + "ONE = ENGINES[0]")
    assert methods(registry.load("mine_1:ENGINES")) == ["mine euler projection", "mine rk4 projection"]
    assert methods(registry.load("package.mine_2:ONE")) == ["mine euler projection"]
    assert methods(registry.load("package/mine_2.py")) == ["mine euler projection"]
    assert methods(registry.load(f"{here}/package/mine_2.py:ENGINES")) == [
        "mine euler projection",
        "mine rk4 projection",
    ]
    assert registry.load("package/mine_2.py:ONE")[0] is sys.modules["package.mine_2"].ONE


@pytest.mark.parametrize("word", ["", "  ", "two\nlines", None])
def test_a_name_that_can_not_be_printed_in_a_table_is_no_engines_name(word):
    for field in ("name", "variant"):
        wrong = replace(Toy(), **{field: word})
        assert registry.trouble(wrong).startswith(f"its {field} is {word!r}; it must be a string that is not empty")
    assert registry.trouble(Toy()) == ""


@pytest.mark.parametrize(
    ("text", "reference", "telling"),
    [
        ("", "broken.py", "nothing at the top level of this file is one"),
        ("ENGINES = ()", "broken:ENGINES", "it is empty"),
        ("ENGINE = 'pymunk'", "broken:ENGINE", "the type str is no engine: it does not inherit from engines.Engine"),
        ("from engines.lagrange import Lagrange", "broken:Lagrange", "it is a class; give an engine made of it"),
        ("", "broken:ENGINE", "broken has no ENGINE"),
        ("", "absent.py", "absent.py: there is no such file"),
        ("", "absent:ENGINE", "absent can't be imported: ModuleNotFoundError: No module named 'absent'"),
        ("a = 1\nb = a +\n", "broken.py", "broken.py:2: SyntaxError: invalid syntax"),
        ("import math\n\nmath.sqrt(None)\n", "broken.py", "broken.py:3: TypeError: must be real number, not NoneType"),
        ("raise SystemExit(3)", "broken.py", "broken.py:1: SystemExit: 3"),
        ("", "json.py", "another module is called 'json'"),
    ],
)
def test_the_message_for_an_invalid_engine_has_its_place(here, text, reference, telling):
    written(here, "broken.py", text)
    written(here, "json.py", FALLING)
    with pytest.raises(ValueError, match=r"\w") as refused:
        registry.load(reference)
    assert telling in str(refused.value)
    assert "\n" not in str(refused.value)


def test_a_file_gives_all_scenes_of_its_top_level_once(here):
    # A class without an instance in the file gives a scene with default parameters. Imported classes give no scene.
    path = written(
        here, "several.py", FALLING + "\nclass Other(Falling):\n    name = 'other'\n\nSHORT = Other(length=0.5)"
    )
    assert [(entry.name, entry.length) for entry in load(str(path), catalogue.SCENE)] == [
        ("falling", 1.0),
        ("other", 0.5),
    ]


def test_parameters_are_set_by_name_and_listed_in_the_order_of_the_fields():
    changed = with_settings(scene("free_four_bar"), {"rate": "3", "crank": "0.45", "gravity": "(0, -1.5)"})
    other = with_settings(scene("free_four_bar"), {"gravity": "[0, -1.5]", "crank": "4.5e-1", "rate": "3.0"})
    assert changed == other == FreeFourBar(crank=0.45, rate=3.0, gravity=(0.0, -1.5))
    assert changed.name == other.name == "free_four_bar crank=0.45 rate=3 gravity=(0,-1.5)"
    assert FreeFourBar.name == scene("free_four_bar").name == "free_four_bar"
    assert with_settings(scene("car_and_trailer"), {"redundant": "True"}).name == "car_and_trailer redundant=True"
    unchanged = scene("free_four_bar")
    assert with_settings(unchanged, {"crank": "0.4"}) is unchanged


@pytest.mark.parametrize(
    ("name", "text", "telling"),
    [
        ("crnk", "1", "free_four_bar has no number called 'crnk'; did you mean 'crank'?"),
        ("crank", "-1", "crank is -1; it must be a finite number greater than zero"),
        ("crank", "long", "crank is 'long'; it must be a finite number"),
        ("crank", "inf", "crank is 'inf'; it must be a finite number"),
        ("gravity", "9.81", "gravity is 9.81; it must be a tuple of 2 values"),
        ("crank", "50", "can't be assembled"),
    ],
)
def test_an_invalid_parameter_is_refused_in_one_sentence(name, text, telling):
    with pytest.raises(ValueError, match=r"\w") as refused:
        with_settings(scene("free_four_bar"), {name: text})
    assert telling in str(refused.value)


RUN = ("--engine", "lagrange", "--variant", "rk4 projection", "--every", "1")
PAGE_OF_IT = "pendulum_1_length_0.5_rate_2"


@pytest.fixture
def no_pages(monkeypatch):
    monkeypatch.setattr(catalogue, "PAGES", ())


def test_a_scene_of_other_numbers_is_run_stored_shown_and_reported(here, no_pages, at_home, capfd):
    settings = ("--set", "rate=2", "--set", "length=0.5")
    assert call("run", "pendulum_1", *settings, *RUN) == FINE
    assert "pendulum_1 length=0.5 rate=2" in capfd.readouterr().out
    assert call("run", "pendulum_1", *RUN) == FINE
    assert "1 of 1 cells run" in capfd.readouterr().out
    assert call("show", "pendulum_1 length=0.5 rate=2") == FINE
    capfd.readouterr()
    assert call("show", "pendulum_1", *settings[2:], *settings[:2]) == FINE
    assert "pendulum_1 length=0.5 rate=2, " in capfd.readouterr().out
    assert call("report") == FINE
    pages = {path.name: path.read_text(encoding="utf-8") for path in (here / "crosscheck-results").glob("*.md")}
    assert pages[f"{PAGE_OF_IT}.md"].startswith("# pendulum_1 length=0.5 rate=2\n")
    assert "length=0.5" in (here / "crosscheck-results" / "descriptions.csv").read_text(encoding="utf-8")
    assert f"]({PAGE_OF_IT}.md)" in pages["index.md"]
    errors = (here / "crosscheck-results" / "errors.csv").read_text(encoding="utf-8")
    assert errors.count("pendulum_1 length=0.5 rate=2,lagrange") == 1


def test_a_scene_and_an_engine_of_a_file_are_run_and_reported_until_the_file_is_gone(here, no_pages, at_home, capfd):
    path = written(here, "below/mine_3.py", FALLING)
    assert call("run", "below/mine_3.py", "--engine", "below/mine_3.py:ENGINES", "--every", "1") == FINE
    assert "2 of 2 cells run" in capfd.readouterr().out
    assert call("show", "falling", "--engine", "mine", "--variant", "rk4 projection") == FINE
    output = capfd.readouterr().out
    assert "mine rk4" in output
    assert "mine euler" not in output
    assert call("report") == FINE
    assert capfd.readouterr().err == ""
    assert "| mine rk4 projection |" in (here / "crosscheck-results" / "falling.md").read_text(encoding="utf-8")
    path.unlink()
    assert call("report") == REFUSED  # No other results are stored.
    lines = capfd.readouterr().err.splitlines()
    assert [line.startswith("crosscheck: left out, since it is not as it was") for line in lines] == [True, True, False]
    assert "mine_3.py: there is no such file" in lines[0]


@pytest.mark.parametrize(
    ("words", "telling"),
    [
        (("--set", "crank=1"), "name a scene before it"),
        (("free_four_bar", "--set", "crank"), "give NAME=VALUE"),
        (("free_four_bar", "--set", "crank=1", "--set", "crank=2"), "gives crank twice"),
        (("free_four_bra", "--set", "crank=1"), "did you mean 'free_four_bar'?"),
        (("--engine", "absent:X"), "No module named 'absent'"),
        (("taken.py",), "another scene is called 'pendulum_1'; give this one another name"),
    ],
)
def test_unknown_names_are_refused_in_one_line(here, words, telling, capfd):
    written(here, "taken.py", FALLING.replace('"falling"', '"pendulum_1"'))
    assert call("run", *words) == REFUSED
    assert telling in one_line(capfd.readouterr().err)


class ToyEntryPoint:
    """A replacement for an entry point of importlib.metadata."""

    def __init__(self, distribution: str, name: str, value: str) -> None:
        self.dist, self.name, self.value = type("Distribution", (), {"name": distribution}), name, value


@pytest.mark.parametrize(
    ("value", "telling"),
    [
        ("absent_module:ENGINE", "absent_module can't be imported: ModuleNotFoundError"),
        ("theirs_4:NOTHING", "theirs_4 has no NOTHING"),
        ("theirs_4:FALLING", "is no engine: it does not inherit"),
        ("theirs_4:OURS", "'pymunk default' is left out, since planar-crosscheck has one of this name"),
        ("theirs_4:TWICE", "'mine rk4 projection' is left out, since theirs has one of this name"),
    ],
)
def test_an_entry_point_that_can_not_be_used_is_one_line_and_the_others_stay(here, monkeypatch, value, telling):
    extra = (
        "\nfrom dataclasses import replace\nfrom engines import pymunk\nFALLING = Falling()"
        "\nOURS = replace(pymunk.DEFAULT, iterations=11)\nclass Other(Mine): ..."
        "\nTWICE = [ENGINES[0], Other('rk4', 'projection')]"
    )
    written(here, "theirs_4.py", FALLING + extra)
    monkeypatch.syspath_prepend(here)
    points = [ToyEntryPoint("theirs", "good", "theirs_4:ENGINES"), ToyEntryPoint("theirs", "other", value)]
    monkeypatch.setattr(loading.metadata, "entry_points", lambda group: points)
    entries = loading.registered("crosscheck.engines", registry.ENGINE, method_name)
    assert methods(entries.values) == [*methods(registry.VARIANTS), "mine euler projection", "mine rk4 projection"]
    (line,) = entries.troubles
    assert line.startswith("crosscheck.engines: 'other' of the distribution theirs")
    assert telling in line


def test_a_run_into_a_file_prints_its_progress(monkeypatch, capsys):
    now = [100.0]
    monkeypatch.setattr("reports.cli.terminal.monotonic", lambda: now[0])
    checked = []
    with progress(Terminal(140), 7, lambda: checked.append(1)) as (done, watch):
        for _ in range(3):
            now[0] += 0.4 * PULSE
            done(object())
            watch([])
        now[0] += PULSE
        watch([])
    assert capsys.readouterr().out.splitlines() == ["3 of 7 cells run after 12 s", "3 of 7 cells run after 22 s"]
    assert len(checked) == 7  # Every call checks whether Ctrl-C was pressed.
