"""Tests of this checkout's wheel and a third party's wheel in a new environment.

The third party's distribution has the code of our how-to pages: an engine with two variants and a scene with a page.
The tests use no network and make the environment once.
"""

from __future__ import annotations

import csv
import json
import os
import re
import shutil
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pytest

from tests import ROOT
from tests.reports.test_check import FOUR_BAR

OLDEST_SETUPTOOLS = 77  # As in pyproject.toml.
# Folders that are not committed, and folders that a wheel does not contain.
LEFT_OUT_OF_CHECKOUT = (".*", "__pycache__", "build", "dist", "*.egg-info", "crosscheck-results", "tests")
BUILD = "import sys; from setuptools import build_meta; build_meta.build_wheel(sys.argv[1])"
THREE_STEPS = ("--every", "1", "--every", "3", "--every", "10")
OUR_PACKAGES = ("engines", "reference", "reports")
# Results in the wheel: the gate's baseline, and data for the pages of versions, of the atlas and of speed.
SHIPPED_RESULTS = ("errors", "timings", "versions", "atlas", "speed")
OUR_MODULES = ("planar_crosscheck.py", "planar_crosscheck_pytest.py")
# Every warning is an error.
PYTEST = ("-m", "pytest", "-q", "-p", "no:cacheprovider", "-W", "error")

THEIR_PROJECT = """
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"
[project]
name = "their-suite"
version = "1.2.3"
[project.entry-points]
"crosscheck.engines" = {multipliers = "their_suite:ENGINES"}
"crosscheck.scenes" = {wheel = "their_suite:SCENE", spare = "their_suite:SPARE"}
"crosscheck.pages" = {wheel = "their_suite.page:PAGE"}
[tool.setuptools]
packages = ["their_suite"]
package-data = {their_suite = ["*.md"]}
"""
THEIR_NAMES = """
class Spare(Turning):
    name = "spare_wheel"


ENGINES, SPARE = (MULTIPLIERS, Multipliers(variant="closed")), Spare()
"""
THEIR_PAGE = """
from pathlib import Path

from engines.registry import VARIANTS
from reports.model.page import Page
from reports.write.rows import lookups
from their_suite import SCENE

PAGE = Page(
    name="wheel",
    title="Their wheel",
    lesson="A disc on an axle, which every engine should hold.",
    scenes=(SCENE,),
    engines=VARIANTS,
    template=Path(__file__).with_name("page.md"),
    context=lambda material: lookups(material, (SCENE,)),
)
"""
THEIR_TEMPLATE = """{% extends "base.md" %}
{% block lesson %}
Their engine reaches {{ best("turning_wheel", "multipliers", "closed").angle | number }} rad.
{% endblock %}
"""
THEIR_METHODS = ("multipliers default", "multipliers closed")
# This program runs several commands, since each start takes longer than a command, and prints their statuses.
COMMANDS_IN_ONE_PROCESS = """
import json, sys
from reports.cli.commands import invoke
for words in json.loads(sys.argv[1]):
    print("status", invoke(words), "of", words[0], flush=True)
"""


def write_their_distribution(folder: Path) -> Path:
    """Write the source of the third party's distribution."""
    pages = [
        (ROOT / "reports" / "site" / "howto" / f"add_{name}.md").read_text("utf-8") for name in ("an_engine", "a_scene")
    ]
    code = [block for page in pages for block in re.findall(r"```python\n(.*?)```", page, re.DOTALL)]
    texts = {"__init__.py": "\n".join([*code, THEIR_NAMES]), "page.py": THEIR_PAGE, "page.md": THEIR_TEMPLATE}
    (folder / "their_suite").mkdir(parents=True)
    (folder / "pyproject.toml").write_text(THEIR_PROJECT, encoding="utf-8")
    for name, text in texts.items():
        (folder / "their_suite" / name).write_text(text, encoding="utf-8")
    return folder


def build_wheel(source: Path, folder: Path) -> Path:
    """Build the distribution in `source`. Skips the test if setuptools is missing or too old."""
    try:
        version = metadata.version("setuptools")
    except metadata.PackageNotFoundError:
        pytest.skip("setuptools is not installed; the extra 'test' of pyproject.toml has it")
    if int(version.split(".")[0]) < OLDEST_SETUPTOOLS:
        pytest.skip(f"setuptools {version} is older than {OLDEST_SETUPTOOLS}, which pyproject.toml requires")
    subprocess.run([sys.executable, "-c", BUILD, folder], cwd=source, check=True, capture_output=True, text=True)
    (wheel,) = folder.glob("*.whl")
    return wheel


def create_environment(folder: Path, *wheels: Path) -> Path:
    """Make an environment with these wheels and with the packages installed here; return its folder of programs.

    A .pth file names the folders of the installed packages. Python does not read the .pth files in these folders, which
    lead to this checkout. numba is hidden, because a new installation would compile its code for a quarter of a minute.
    """
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    programs = folder / ("Scripts" if os.name == "nt" else "bin")
    pip = [sys.executable, "-m", "pip", "--python", programs / "python", "install", "--quiet", "--no-index"]
    installed = subprocess.run([*pip, "--no-deps", "--no-compile", *wheels], capture_output=True, text=True)
    if installed.returncode and "No module named pip" in installed.stderr:
        pytest.skip("pip is not installed")
    assert installed.returncode == 0, installed.stderr
    (site,) = {path.parent for path in folder.rglob("reports") if path.parent.name == "site-packages"}
    first = [path for path in sys.path if Path(path).name in ("site-packages", "dist-packages")]
    (site / "below.pth").write_text(
        "\n".join([*first, 'import sys; sys.modules["numba"] = None', ""]), encoding="utf-8"
    )
    return programs


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("ours")
    checkout = shutil.copytree(ROOT, folder / "checkout", ignore=shutil.ignore_patterns(*LEFT_OUT_OF_CHECKOUT))
    return build_wheel(checkout, folder / "built")


@pytest.fixture(scope="module")
def programs(wheel, tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheels")
    theirs = build_wheel(write_their_distribution(folder / "their source"), folder / "theirs")
    return create_environment(tmp_path_factory.mktemp("environment"), wheel, theirs)


@pytest.fixture
def call(programs, tmp_path):
    """Run an installed program in an empty folder without this checkout; return status, stdout and stderr."""

    def run(program, *words, folder=tmp_path, path=None):
        variables = {name: value for name, value in os.environ.items() if not name.startswith("PYTHON")}
        variables |= {} if path is None else {"PYTHONPATH": str(path)}
        ended = subprocess.run([programs / program, *words], cwd=folder, env=variables, capture_output=True, text=True)
        return ended.returncode, ended.stdout, ended.stderr

    return run


def test_every_template_snippet_asset_and_baseline_of_the_checkout_is_in_the_wheel(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    files = [path for part in ("pages", "site") for path in (ROOT / "reports" / part).rglob("*") if path.is_file()]
    files += [path for part in OUR_PACKAGES for path in (ROOT / part).rglob("*.py")]
    assert {path.relative_to(ROOT).as_posix() for path in files if "__pycache__" not in path.parts} <= names
    results = {name for name in names if name.startswith("reports/results/") and not name.endswith(".py")}
    assert results == {f"reports/results/{name}.csv" for name in SHIPPED_RESULTS}
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {*OUR_PACKAGES, *OUR_MODULES}


def test_an_installation_registers_the_same_entries_in_the_same_order_as_the_checkout(call):
    from engines.registry import ENGINES, VARIANTS, method_name
    from reports.model.catalogue import PAGES, SCENES

    code = (
        "from engines.registry import ENGINES, VARIANTS, method_name; from reports.model.catalogue import *;"
        "ours = lambda names: [name for name in names if 'multipliers' not in name and 'wheel' not in name.split('_')];"
        "print(ours(map(method_name, VARIANTS)), ours(map(method_name, ENGINES)), ours(s.name for s in SCENES),"
        "ours(p.name for p in PAGES), TROUBLES, sep='\\n'); import reports; print(reports.__file__)"
    )
    status, out, err = call("python", "-c", code)
    assert (status, err) == (0, "")
    *registered, file = out.splitlines()
    assert not file.startswith(str(ROOT / "reports"))
    expected = ([method_name(e) for e in VARIANTS], [method_name(e) for e in ENGINES], [s.name for s in SCENES])
    assert registered == [*map(str, (*expected, [page.name for page in PAGES])), "()"]


def test_publishing_from_an_installation_and_a_foreign_package_with_one_of_our_names_are_refused(call, tmp_path):
    status, out, err = call("crosscheck", "report", "--publish")
    assert (status, out) == (2, "")
    assert err.startswith("crosscheck: --publish is for a checkout")
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "engines").mkdir()
    (tmp_path / "engines" / "__init__.py").write_text("", encoding="utf-8")
    status, out, err = call("crosscheck", "--help", folder=tmp_path.parent, path=tmp_path)
    assert (status, out) == (2, "")
    (line,) = err.splitlines()
    assert line.startswith(
        f"crosscheck: the package 'engines' is another one, at {tmp_path / 'engines'}, and ours is at "
    )
    for program in (["crosscheck"], ["python", "-m", "planar_crosscheck"]):
        assert call(*program, "--help")[0] == 0


def test_their_engine_and_scenes_are_listed_conform_are_run_and_have_rows_on_pages(call, tmp_path):
    commands = (
        ("list", "turning_wheel", "spare_wheel"),
        ("conform", "multipliers", "--variant", "closed"),
        ("run", "turning_wheel", "spare_wheel", "free_four_bar", "--engine", "multipliers", *THREE_STEPS),
        ("run", "turning_wheel", "--engine", "lagrange", "--every", "1"),
        ("report",),
        ("show", "free_four_bar", "--engine", "multipliers"),
    )
    status, out, err = call("python", "-c", COMMANDS_IN_ONE_PROCESS, json.dumps(commands))
    assert (status, err) == (0, "")
    parts = re.split(r"^status (\d+) of (\w+)\n", out, flags=re.MULTILINE)
    assert parts[1::3] == ["0"] * len(commands), out
    listed, conformed, displayed = (parts[3 * index] for index in (0, 1, 5))
    assert "Multipliers(variant='closed')" in listed
    assert conformed.splitlines()[-1].strip() == "every check holds", conformed
    assert displayed.count("multipliers") > 3
    assert {path.name for path in tmp_path.iterdir()} == {"crosscheck-results"}
    files = (tmp_path / "crosscheck-results").iterdir()
    texts = {path.name: path.read_text(encoding="utf-8") for path in files if path.suffix in (".md", ".csv")}
    rows = [row for row in csv.DictReader(texts["errors.csv"].splitlines()) if row["engine"] == "multipliers"]
    scenes = ("turning_wheel", "spare_wheel", "free_four_bar")
    cells = {(row["scene"], row["variant"], int(row["every"])) for row in rows}
    assert cells == {(s, v, e) for s in scenes for v in ("default", "closed") for e in (1, 3, 10)}
    assert {row["outcome"] for row in rows if row["scene"] != "free_four_bar"} <= {"finished", "converged"}
    assert "skate.md" not in texts
    for page, title in (("four_bar", ""), ("wheel", "# Their wheel\n"), ("spare_wheel", "# spare_wheel\n")):
        assert texts[f"{page}.md"].startswith(title)
        assert all(f"| {method} |" in texts[f"{page}.md"] for method in THEIR_METHODS)
    assert re.search(r"Their engine reaches \d", texts["wheel.md"])  # from their template
    assert "rate=3" in texts["descriptions.csv"]
    assert "- [Their wheel](wheel.md). A disc on an axle, which every engine should hold." in texts["index.md"]
    assert "| scene | multipliers as shipped |" in texts["index.md"]


def test_the_gate_of_the_wheel_tests_their_engine_one_in_a_file_and_ours(call, tmp_path):
    text = "from their_suite import Multipliers\n\nOWN = Multipliers(variant='half')\n"
    (tmp_path / "own_engine.py").write_text(text, encoding="utf-8")
    engines = ("--engine", "multipliers", "--engine", "own_engine.py:OWN", "--engine", "pymunk tuned")
    scenes = ("--scene", "turning_wheel", "--scene", "free_four_bar")
    status, out, err = call("python", *PYTEST, "-m", "crosscheck", *engines, *scenes)
    assert status == 0, out + err
    # Four methods in two scenes are compared with theory and with the baseline; one more test is for missing cells.
    assert f"{4 * 2 * 2 + 1} passed" in out
    assert "multipliers half" in out
    assert "free_four_bar  pymunk tuned" in out


OWN_TESTS = """
from engines.importers import mujoco

def test_the_linkage_is_right(crosscheck):
    crosscheck.check("model.xml", tolerance=1e-4, duration=0.2)

def test_it_is_read():
    assert mujoco.read("model.xml").degrees_of_freedom() == (1, 1)
"""


def test_another_project_has_the_fixture_and_keeps_its_option_that_has_the_name_of_one_of_ours(call, tmp_path):
    (tmp_path / "test_own.py").write_text(OWN_TESTS, encoding="utf-8")
    (tmp_path / "model.xml").write_text(FOUR_BAR, encoding="utf-8")
    (tmp_path / "conftest.py").write_text("def pytest_addoption(parser): parser.addoption('--engine')\n")
    status, out, _ = call("python", *PYTEST, "--engine", "mine", "-m", "not crosscheck")
    assert status == 1
    assert "1 failed, 1 passed" in out
    assert "four bar in MuJoCo is off by up to" in out
    assert '<option timestep="' in out
