"""Scenes and engines that exit, hang or lie, and wrong command lines: an outcome or one line, never a traceback."""

from __future__ import annotations

import os
import random
import re
import time
from dataclasses import dataclass, replace
from typing import Any

import pytest

from engines.loading import load
from reports.cli import commands, known
from reports.model import catalogue
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BROKEN, FINE, REFUSED, BadInput
from reports.model.measure import blank, measure
from reports.model.page import Material
from reports.pages.rendering import render_page
from reports.run.supervisor import supervise
from reports.site.markdown import render_html
from reports.write.csv_files import as_csv
from reports.write.templates import inert_page
from tests.reports.rough_toys import is_free, wait_until
from tests.reports.test_command_line import call, here, one_line
from tests.toys import Disc, Toy

__all__ = ["here"]
SCENE = """
import os, signal, time
from dataclasses import dataclass
from typing import ClassVar
import numpy as np
from tests.toys import Disc, turning

@dataclass(frozen=True)
class Odd(Disc):
    name: ClassVar[str] = "odd"

"""
DEEDS = {
    "raises": "raise RuntimeError('no such thing')",
    "refuses": "raise ValueError('no such thing')",
    "exits": "os._exit(0)",
    "leaves": "raise SystemExit(0)",
    "interrupts": "raise KeyboardInterrupt",
    "traps": "os.kill(os.getpid(), signal.SIGILL)",
    "sleeps": "time.sleep(1e6)",
}
OF_SCENES = {
    "mechanism": "def mechanism(self):",
    "__eq__": "__hash__ = Disc.__hash__\n    def __eq__(self, other):",
    "__hash__": "def __hash__(self):",
    "__repr__": "def __repr__(self):",
    "samples": "@property\n    def samples(self):",
    "__post_init__": "def __post_init__(self):",
}


def member(text, head, deed):
    return f"{text}    {head}\n        {DEEDS[deed]}\n"


def told_in_a_line(capfd):
    told = one_line(capfd.readouterr().err)
    assert "Traceback" not in told
    return told


SAID = {
    "raises": "RuntimeError: no such thing",
    "refuses": "ValueError: no such thing",
    "exits": "the process ended by itself with exit status 0",
    "leaves": "SystemExit: 0",
    "interrupts": "KeyboardInterrupt",
    "traps": "aborted with signal 4 (SIGILL)",
    "sleeps": "did not end within 10 s",
}


@pytest.mark.parametrize(
    ("name", "deed"),
    [("mechanism", "exits"), ("__eq__", "raises"), pytest.param("mechanism", "sleeps", marks=pytest.mark.slow)],
)
def test_what_a_scene_s_own_code_does_is_one_line(here, monkeypatch, capfd, name, deed):
    if deed == "sleeps":  # a loaded machine imports for seconds
        monkeypatch.setattr(known, "SLEEPING", 10.0)
    (here / "odd_scene.py").write_text(member(SCENE, OF_SCENES[name], deed))
    assert call("run", "odd_scene.py") == REFUSED
    told = told_in_a_line(capfd)
    assert told.startswith("crosscheck: odd_scene.py: ")
    assert name == "__post_init__" or SAID[deed] in told
    assert not (here / "crosscheck-results").exists()


@pytest.mark.parametrize(
    ("text", "telling"),
    [
        ("duration: ClassVar[float] = float('inf')", "duration is inf"),
        ("horizon: ClassVar[float] = 0.0", "horizon is 0.0"),
        ("samples: ClassVar[int] = 0", "samples is 0"),
        ("samples: ClassVar[int] = 2**40", "samples is 1099511627776"),
        ("samples = property(lambda self: 0)", "samples is 0"),
    ],
)
def test_a_scene_of_no_duration_or_samples_is_refused(here, text, telling):
    path = here / f"odd_{abs(hash(text))}.py"  # a name of its own: modules stay
    path.write_text(f"{SCENE}    {text}\n")
    with pytest.raises(ValueError, match=r"\w") as told:
        load(str(path), catalogue.SCENE)
    assert telling in str(told.value)


@pytest.mark.parametrize("deed", ["raise RuntimeError('no')", "return float('nan')", "return 'long'"])
def test_a_step_cost_that_is_none_names_the_engine_and_the_scene(deed):
    @dataclass(frozen=True)
    class Odd(Toy):
        def step_cost(self, mechanism) -> Any:
            if "raise" in deed:
                raise RuntimeError("no")
            return float("nan") if "nan" in deed else "long"

    with pytest.raises(BadInput, match="toy default: step_cost of disc"):
        estimated_cost(Cell(Disc(), Odd(), 1))


def forks(file):
    """In the child too it returns its file, as an engine does that forks and forgets; the child's is a lock on it."""
    import fcntl

    held = os.open(file, os.O_CREAT | os.O_WRONLY)
    fcntl.flock(held, fcntl.LOCK_EX)
    if os.fork():
        os.close(held)
    elif file.name == "1":
        time.sleep(1e4)
    return file


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_job_that_forks_is_answered_once_and_its_child_is_ended(tmp_path):
    files = [tmp_path / str(number) for number in range(3)]
    told = list(supervise(forks, files, 20.0, workers=2))
    assert sorted((item, result) for item, result, _ in told) == [(file, file) for file in files]
    for path in files:
        with path.open("w") as file:
            wait_until(lambda file=file: is_free(file))


def test_names_are_words_on_pages_and_no_formula_is_one_in_a_table():
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


def test_names_are_words_on_the_site():
    pytest.importorskip("mdit_py_plugins", reason="MyST is not installed: pip install '.[site]'")
    site = render_html("# <script>x</script>\n\n| <img src=x onerror=y> |\n|--|\n| <!--><iframe> `<b>` |\n")
    assert set(re.findall(r"<[/!]?[\w-]+", site)) == {"<h1", "</h1", "<table", "</table", "<!--"} | {
        f"<{slash}{tag}" for slash in ("", "/") for tag in ("thead", "tbody", "tr", "th", "td", "code")
    }


def test_a_page_of_a_scene_with_tags_in_its_name_has_none():
    odd = replace(Disc(), rate=3.0)
    vars(odd)["name"] = "<script>alert(1)</script>"
    page = catalogue.generic_page(odd, (Toy(),))
    cells = [Cell(odd, Toy(), every) for every in (1, 3, 10)]
    files = render_page(page, Material({cell: measure(cell, repeat=False) for cell in cells}, {}), "crosscheck report")
    assert not [name for name, text in files.items() if "<script" in text and not name.endswith(".py")]


COMMANDS = {
    name: [option for each in commands.command(name).params for option in each.opts if option.startswith("--")]
    for name in sorted(commands.COMMANDS)
}
FREE = ("", " ", "\x1b[31m", "\udcff", "file\nname", "x" * 5000, "é" * 300)  # and what a shell would split
SEVERAL = """
. .. / /dev/null /dev/zero - -- -1 0 1e400 nan -inf 1e-320 free_four_bar FREE pymunk lagrange default nope a=b = crank=
crank=0 x.py x.py:A a:b:c reference:SCENES os:path model.xml <b> [bold] * ' " %s {0} tcp://127.0.0.1:1 local:0 pymunk==0
CON
"""
WORDS = (*FREE, *SEVERAL.split(), "9" * 30, "mujoco tuned")
# A command that is right would do its work: each has something that no command takes, or that is nothing.
WRONG = ("nope_nope", "nope_nope", "nope_nope", "--nonsense")


def wrong_line(chance: random.Random) -> list[str]:
    name = chance.choice([*COMMANDS])
    words = [name]
    for _ in range(chance.randint(0, 3)):
        words += [chance.choice(COMMANDS[name]), chance.choice(WORDS)] if chance.random() < 0.7 else []
        words += [chance.choice(WORDS)] if chance.random() < 0.3 else []
    words.insert(1 if chance.random() < 0.5 else len(words), chance.choice(WRONG))
    return words


def one_end(words, capfd):
    status = call(*words)
    out, err = capfd.readouterr()
    assert status in (FINE, BROKEN, REFUSED), words
    assert "Traceback" not in out + err, words
    assert (out + err).replace("\n", "").isprintable(), words
    if status == REFUSED:  # above the line there may be one of progress
        told = [line.startswith("crosscheck: ") for line in err.splitlines()]
        assert sum(told) == 1, (words, err)
        assert told[-1], (words, err)


def test_a_wrong_command_line_is_one_line(here, capfd):
    chance = random.Random(22)
    for _ in range(40):
        one_end(wrong_line(chance), capfd)


@pytest.mark.parametrize(
    "words",
    [
        ("run", "free_four_bar", "--every", "3000000000"),
        ("run", "free_four_bar", "--step", "1e-320"),
        ("view", "free_four_bar", "--variant", "nope"),
        ("animate", "free_four_bar", "--every", "1" + 20 * "0"),
        ("check", "one.xml", "--markdown", ""),
        ("shapes", "/dev/zero"),
        ("shapes", "red\x1b[31m\x07\u202e.csv"),
        ("check", "one.xml", "--html", "-"),
        ("check", "one.xml", "--apply", "-"),
        ("report", "--results", "/dev/null/folder"),
    ],
)
def test_what_once_ended_in_a_traceback_is_one_line(words, here, capfd):
    assert call(*words) == REFUSED
    err = capfd.readouterr().err
    assert err.startswith("crosscheck: ")
    assert err.count("\n") == 1
    assert err[:-1].isprintable()
    assert list(here.iterdir()) == []


def test_a_file_called_minus_is_standard_output(here, capfd):
    assert call("export", "free_four_bar", "--out", "-") == FINE
    written = capfd.readouterr().out
    assert call("export", "free_four_bar") == FINE
    assert capfd.readouterr().out == written
    assert list(here.iterdir()) == []


def test_results_in_a_file_are_refused_without_advice_to_write_there(here, capfd):
    (here / "file").write_text("mine")
    for words in (("report",), ("show", "free_four_bar")):
        assert call(*words, "--results", "file") == REFUSED
        assert "'file', and file is a file; give a folder" in capfd.readouterr().err
