"""Our wheel and somebody else's in an environment of their own: it runs, reports and tests; theirs has its place.

Not a line is changed here for their distribution, an engine in two variants and a scene with its page. The environment
is made once for all tests of this file.
"""

from __future__ import annotations

import csv
import re
import subprocess
import sys
import zipfile

import pytest

from tests.reports.test_check import FOUR_BAR
from tests.tools.installations import ROOT, distribution, environment_with, our_wheel, run, wheel_of

STEPS = ("--every", "1", "--every", "3", "--every", "10")
METHODS = ("impulses default", "impulses closed")
PACKAGES = ("engines", "reference", "reports")
# The gate's baseline, and what the pages of versions and of the atlas are written from.
SHIPPED = ("errors", "timings", "versions", "atlas")
MODULES = ("planar_crosscheck.py", "planar_crosscheck_pytest.py")
# As anybody starts it, with every warning an error.
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return our_wheel(tmp_path_factory.mktemp("ours"))


@pytest.fixture(scope="module")
def programs(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheels")
    theirs = wheel_of(distribution(folder / "their source"), folder / "theirs")
    return environment_with(tmp_path_factory.mktemp("environment"), wheel, theirs)


@pytest.fixture
def crosscheck(programs, tmp_path):
    """Starts the installed program in an empty folder; its status."""

    def call(*words):
        ended = run(programs / "crosscheck", *words, folder=tmp_path)
        return ended.returncode, ended.stdout, ended.stderr

    return call


@pytest.fixture(scope="module")
def folder(programs, tmp_path_factory):
    """Where their engine was run in their scenes and in ours, and one of ours in theirs, and all was reported."""
    folder = tmp_path_factory.mktemp("results")
    for words in (
        ("run", "flywheel", "spare_wheel", "free_four_bar", "--engine", "impulses", *STEPS),
        ("run", "flywheel", "--engine", "lagrange", "--every", "1"),
        ("report",),
    ):
        ended = run(programs / "crosscheck", *words, folder=folder)
        assert (ended.returncode, ended.stderr) == (0, "")
    return folder


@pytest.fixture(scope="module")
def texts(folder):
    """The files of the report by name."""
    found = (folder / "crosscheck-results").iterdir()
    return {path.name: path.read_text(encoding="utf-8") for path in found if path.suffix in (".md", ".csv", ".svg")}


def test_every_template_snippet_asset_and_baseline_of_the_checkout_is_in_the_wheel(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    folders = [ROOT / "reports" / name for name in ("pages", "site")]
    files = [path.relative_to(ROOT) for folder in folders for path in folder.rglob("*") if path.is_file()]
    wanted = [path.as_posix() for path in files if "__pycache__" not in path.parts]
    assert len([name for name in wanted if name.endswith("page.md")]) > 10
    assert set(wanted) <= names
    # What numba would compile is not run from an installation here: that it is there is all there is to ask.
    modules = [path.relative_to(ROOT) for part in PACKAGES for path in (ROOT / part).rglob("*.py")]
    assert {path.as_posix() for path in modules} <= names
    results = {name for name in names if name.startswith("reports/results/") and not name.endswith(".py")}
    assert results == {f"reports/results/{name}.csv" for name in SHIPPED}
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {*PACKAGES, *MODULES}


def test_an_installation_has_all_that_the_checkout_registers_in_the_same_order(programs, tmp_path):
    from engines.registry import ENGINES, VARIANTS, method_name
    from reports.model.catalogue import PAGES, SCENES

    asked = (
        "from engines.registry import ENGINES, VARIANTS, method_name; from reports.model.catalogue import *;"
        "words = ('impulses', 'flywheel', 'spare_wheel');"
        "ours = lambda found: [each for each in found if not any(word in each for word in words)];"
        "print(ours(map(method_name, VARIANTS)), ours(map(method_name, ENGINES)), ours(s.name for s in SCENES),"
        "ours(p.name for p in PAGES), TROUBLES, sep='\\n'); import reports; print(reports.__file__)"
    )
    ended = run(programs / "python", "-c", asked, folder=tmp_path)
    assert ended.stderr == ""
    *told, place = ended.stdout.splitlines()
    assert not place.startswith(str(ROOT / "reports"))
    here = ([method_name(e) for e in VARIANTS], [method_name(e) for e in ENGINES], [s.name for s in SCENES])
    assert told == [*map(str, (*here, [page.name for page in PAGES])), "()"]


def test_nothing_is_published_from_an_installation(crosscheck, tmp_path):
    status, out, err = crosscheck("report", "--publish")
    assert (status, out) == (2, "")
    assert err.startswith("crosscheck: --publish is for a checkout")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("name", ["engines", "reports"])
def test_another_package_of_one_of_our_names_is_told_in_one_line(programs, tmp_path, name):
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("", encoding="utf-8")
    ended = run(programs / "crosscheck", "--help", folder=programs, path=tmp_path)
    assert (ended.returncode, ended.stdout) == (2, "")
    (line,) = ended.stderr.splitlines()
    assert line.startswith(f"crosscheck: the package {name!r} is another one, at {tmp_path / name}, and ours is at ")
    for way in (["crosscheck"], ["python", "-m", "planar_crosscheck"]):  # neither looks in the current folder
        assert run(programs / way[0], *way[1:], "--help", folder=tmp_path).returncode == 0


def test_their_engine_and_scenes_are_listed_and_conform(crosscheck):
    status, out, err = crosscheck("list", "flywheel", "spare_wheel")
    assert (status, err) == (0, "")
    lines = [" ".join(line.replace("│", " ").split()) for line in out.splitlines()]
    assert "spare_wheel spare_wheel their own invention 0.2" in lines
    assert "impulses closed Impulses(variant='closed', share=1.0)" in lines
    status, out, err = crosscheck("conform", "impulses", "--variant", "closed")
    assert (status, err) == (0, ""), out
    assert out.splitlines()[-1].strip() == "every check holds"


def test_their_cells_are_run_and_shown_and_results_go_below_the_current_folder(programs, folder, texts):
    ended = run(programs / "crosscheck", "show", "free_four_bar", "--engine", "impulses", folder=folder)
    assert (ended.returncode, ended.stderr) == (0, "")
    assert ended.stdout.count("impulses") >= 2 * 3
    rows = [row for row in csv.DictReader(texts["errors.csv"].splitlines()) if row["engine"] == "impulses"]
    scenes = ("flywheel", "spare_wheel", "free_four_bar")
    found = {(row["scene"], row["variant"], int(row["every"])) for row in rows}
    assert found == {(s, v, e) for s in scenes for v in ("default", "closed") for e in (1, 3, 10)}
    assert {row["outcome"] for row in rows if row["scene"] != "free_four_bar"} <= {"finished", "converged"}
    assert {path.name for path in folder.iterdir()} == {"crosscheck-results"}


def test_pages_of_ours_and_of_theirs_and_the_index_have_their_engine(texts):
    assert "skate.md" not in texts
    for page, title in (("four_bar", ""), ("flywheel", "# Their flywheel\n"), ("spare_wheel", "# spare_wheel\n")):
        assert texts[f"{page}.md"].startswith(title)
        assert all(f"| {method} |" in texts[f"{page}.md"] for method in METHODS)
    assert re.search(r"Closed impulses reach \d", texts["flywheel.md"])  # from their template
    assert "mass=3" in texts["descriptions.csv"]
    assert "- [Their flywheel](flywheel.md). A disc on an axle, which every engine should hold." in texts["index.md"]
    assert "| scene | impulses as shipped | impulses documented settings |" in texts["index.md"]


def test_their_engine_one_in_a_file_and_ours_are_held_to_promises_and_the_baseline_in_the_wheel(programs, tmp_path):
    text = "from their_suite.impulses import Impulses\n\nOWN = Impulses('half', 0.5)\n"
    (tmp_path / "own_engine.py").write_text(text, encoding="utf-8")
    engines = ("--engine", "impulses", "--engine", "own_engine.py:OWN", "--engine", "pymunk tuned")
    scenes = ("--scene", "flywheel", "--scene", "free_four_bar")
    ended = run(programs / "python", *PYTEST, "-m", "crosscheck", *engines, *scenes, folder=tmp_path)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    # Four methods in two scenes, of theory and of change; and that no cell of the baseline is missing.
    assert f"{4 * 2 * 2 + 1} passed" in ended.stdout
    assert "impulses half" in ended.stdout
    assert "free_four_bar  pymunk tuned" in ended.stdout


OWN = """
from engines.importers import mujoco

def test_the_linkage_is_right(crosscheck):
    crosscheck.check("model.xml", tolerance=1e-4, duration=0.2)

def test_it_is_read():
    assert mujoco.read("model.xml").degrees_of_freedom() == (1, 1)
"""


def test_a_project_of_ones_own_has_the_fixture_and_keeps_an_option_of_the_grids_name(programs, tmp_path):
    (tmp_path / "test_own.py").write_text(OWN, encoding="utf-8")
    (tmp_path / "model.xml").write_text(FOUR_BAR, encoding="utf-8")
    (tmp_path / "conftest.py").write_text("def pytest_addoption(parser): parser.addoption('--engine')\n")
    ended = run(programs / "python", *PYTEST, "--engine", "mine", "-m", "not crosscheck", folder=tmp_path)
    assert ended.returncode == 1
    assert "1 failed, 1 passed" in ended.stdout
    assert "four bar in MuJoCo is off by up to" in ended.stdout
    assert '<option timestep="' in ended.stdout


# Hides what we register of some engines, then writes every page from no rows at all. Pictures are drawn and not written
# as text: by then no engine is asked for.
WITHOUT = """
import sys
from engines import loading
from reports.plots.theme import FigureCanvasSVG

FigureCanvasSVG.print_svg = lambda self, out, **settings: out.write("<svg/>")

ours, hidden = loading._ours, sys.argv[1:]
loading._ours = lambda group: [point for point in ours(group) if not any(word in point[1] for word in hidden)]
from engines.registry import ENGINES
from reports.model.catalogue import PAGES, TROUBLES
from reports.model.page import Material
from reports.pages.index import render_index
from reports.pages.rendering import render_page

assert ENGINES and not {engine.name for engine in ENGINES} & set(sys.argv[1:])
assert TROUBLES == (), TROUBLES
materials = {page: Material({}) for page in PAGES}
for page, material in materials.items():
    render_page(page, material, "a test")
render_index(materials, "a test")
print(*[page.name for page in PAGES])
"""


def test_our_pages_are_written_where_two_engines_are_not_registered():
    ended = subprocess.run(
        [sys.executable, "-c", WITHOUT, "pymunk", "mujoco"], cwd=ROOT, capture_output=True, text=True
    )
    assert ended.stderr == ""
    assert {"four_bar", "skate", "rolling", "errata"} <= set(ended.stdout.split())
