"""Somebody else's distribution, an engine in two variants and a scene with its page, has its place everywhere.

Not a line is changed here for it: both are installed from wheels, in an environment of their own.
"""

from __future__ import annotations

import csv

import pytest

from tests.tools.installations import ROOT, environment_with, our_wheel, run, wheel_of
from tests.tools.third_party import distribution

STEPS = ("--every", "1", "--every", "3", "--every", "10")
METHODS = ("impulses default", "impulses closed")


@pytest.fixture(scope="module")
def programs(tmp_path_factory):
    ours = our_wheel(tmp_path_factory)
    folder = tmp_path_factory.mktemp("wheels")
    theirs = wheel_of(distribution(folder / "their source"), folder / "theirs")
    return environment_with(tmp_path_factory.mktemp("environment"), ours, theirs)


@pytest.fixture(scope="module")
def folder(programs, tmp_path_factory):
    """Where their engine was run in their scene and in ours, and one of ours in theirs."""
    folder = tmp_path_factory.mktemp("results")
    for words in (
        ("flywheel", "spare_wheel", "free_four_bar", "--engine", "impulses", *STEPS),
        ("flywheel", "--engine", "lagrange", "--every", "1"),
    ):
        ended = run(programs / "crosscheck", "run", *words, folder=folder)
        assert (ended.returncode, ended.stderr) == (0, "")
    return folder


@pytest.fixture(scope="module")
def pages(programs, folder):
    """The files of the report by name."""
    ended = run(programs / "crosscheck", "report", folder=folder)
    assert (ended.returncode, ended.stderr) == (0, "")
    return {path.name: path for path in (folder / "crosscheck-results").iterdir()}


def text_of(path):
    return path.read_text(encoding="utf-8")


def test_engine_and_scenes_are_listed(programs, tmp_path):
    ended = run(programs / "crosscheck", "list", "flywheel", "spare_wheel", folder=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    lines = [" ".join(line.replace("│", " ").split()) for line in ended.stdout.splitlines()]
    assert "flywheel flywheel their own invention 0.2" in lines
    assert "spare_wheel spare_wheel their own invention 0.2" in lines
    assert "impulses default Impulses(variant='default', share=0.2)" in lines
    assert "impulses closed Impulses(variant='closed', share=1.0)" in lines


def test_both_are_run_and_shown(programs, folder):
    for scene in ("flywheel", "free_four_bar"):
        ended = run(programs / "crosscheck", "show", scene, "--engine", "impulses", folder=folder)
        assert (ended.returncode, ended.stderr) == (0, "")
        assert ended.stdout.count("impulses") >= 2 * 3
    rows = list(csv.DictReader(text_of(folder / "crosscheck-results" / "errors.csv").splitlines()))
    found = {(row["scene"], row["variant"], int(row["every"])) for row in rows if row["engine"] == "impulses"}
    scenes = ("flywheel", "spare_wheel", "free_four_bar")
    assert found == {(s, v, e) for s in scenes for v in ("default", "closed") for e in (1, 3, 10)}
    outcomes = {(row["scene"], row["outcome"]) for row in rows if row["engine"] == "impulses"}
    assert {outcome for scene, outcome in outcomes if scene != "free_four_bar"} <= {"finished", "converged"}


@pytest.fixture(autouse=True)
def _reported(request):
    """Every test that looks at the stored rows as CSV needs the report first."""
    if "folder" in request.fixturenames:
        request.getfixturevalue("pages")


def test_their_page_is_written_from_their_template(pages):
    text = text_of(pages["flywheel.md"])
    assert text.startswith("# Their flywheel\n")
    assert "Closed impulses reach " in text
    assert "not measured" not in text
    for method in (*METHODS, "lagrange rk4 projection"):
        assert f"| {method} |" in text
    assert {"flywheel_steps.svg", "flywheel_work.svg"} & set(pages)


def test_a_scene_without_a_page_has_a_generic_one(pages):
    text = text_of(pages["spare_wheel.md"])
    assert text.startswith("# spare_wheel\n")
    data = text_of(pages["spare_wheel_data.md"])
    for heading in ("## Work and precision", "## Order and plateau", "## Reactions", "## What was modelled"):
        assert heading in data
    assert "mass=3" in text_of(pages["descriptions.csv"])
    for method in METHODS:
        assert f"| {method} |" in data


def test_every_page_of_ours_is_written_by_an_installation(pages, folder):
    published = {path.name for path in (ROOT / "reports" / "results").glob("*.md")}
    assert len(published) > 10
    # A page of searches is written where a search is stored.
    assert published - {"search.md"} <= set(pages)
    assert "search.md" not in pages
    assert {path.name for path in folder.iterdir()} == {"crosscheck-results"}


def test_our_page_compares_their_engine(pages):
    text = text_of(pages["four_bar.md"])
    for method in METHODS:
        assert f"| {method} |" in text


def test_the_index_leads_to_their_pages(pages):
    text = text_of(pages["index.md"])
    assert "- [Their flywheel](flywheel.md). A disc on an axle, which every engine should hold." in text
    assert "[flywheel](flywheel.md)" in text
    assert "[spare wheel](spare_wheel.md)" in text


def test_their_engine_and_one_in_a_file_are_held_to_their_own_promises(programs, tmp_path):
    text = "from their_suite.impulses import Impulses\n\nOWN = Impulses('half', 0.5)\n"
    (tmp_path / "own_engine.py").write_text(text, encoding="utf-8")
    options = ("-p", "reports.gate.pytest_plugin", "-p", "no:cacheprovider", "-W", "error", "-m", "crosscheck")
    engines = ("--engine", "impulses", "--engine", "own_engine.py:OWN")
    chosen = (*engines, "--scene", "flywheel", "--scene", "spare_wheel", "--scene", "free_four_bar")
    words = ("-m", "pytest", "-q", *options, "--pyargs", "reports.gate.grid_tests", *chosen)
    ended = run(programs / "python", *words, folder=tmp_path)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    # Scenes, methods, tests of each; and that no cell of the baseline is missing.
    assert f"{3 * 3 * 2 + 1} passed" in ended.stdout
    assert "impulses half" in ended.stdout


# Of every family: its colour in light pictures, and its mark.
LOOKS = """
from engines.registry import ENGINES
from reports.plots.looks import colour, mark
from reports.plots.theme import LIGHT

for family in dict.fromkeys(engine.family for engine in ENGINES):
    print(family, colour(family, LIGHT), mark(family))
"""


def test_their_engine_has_a_colour_and_a_mark_of_its_own(programs, pages, tmp_path):
    ended = run(programs / "python", "-c", LOOKS, folder=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, "")
    looks = {family: (colour, mark) for family, colour, mark in map(str.split, ended.stdout.splitlines())}
    assert set(looks) >= {"pymunk", "mujoco", "lagrange", "impulses"}
    for part in zip(*looks.values(), strict=True):
        assert len(set(part)) == len(looks)
    drawn = text_of(pages["flywheel_work.svg"]) + text_of(pages["flywheel_steps.svg"])
    assert looks["impulses"][0].lower() in drawn.lower()
    assert looks["pymunk"][0].lower() not in drawn.lower()  # it was not run in this scene


def test_their_engine_has_its_table_in_the_overview(pages):
    lines = text_of(pages["index.md"]).splitlines()
    place = lines.index("| scene | impulses default |")  # of variants the overview has those by the usual names
    table = [line for line in lines[place : place + 9] if line.startswith("| [")]
    (line,) = [each for each in table if each.startswith("| [flywheel](flywheel.md), rad |")][:1]
    assert line.endswith("; to rounding; engine |")
    assert "e-" in line.split("|")[2]  # its error at one of the usual steps


def test_their_engine_conforms_to_the_contract(programs, tmp_path):
    ended = run(programs / "crosscheck", "conform", "impulses", "--variant", "closed", folder=tmp_path)
    assert (ended.returncode, ended.stderr) == (0, ""), ended.stdout
    assert ended.stdout.splitlines()[0] == "impulses closed"
    assert ended.stdout.splitlines()[-1].strip() == "every check holds"
