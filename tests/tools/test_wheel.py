"""An installation from a wheel, in an environment of its own and started elsewhere: it runs, reports and tests."""

from __future__ import annotations

import zipfile

import numpy as np
import pytest

from tests.tools.installations import ROOT, environment_with, our_wheel, run

ONE_CELL = ("driven_four_bar", "--engine", "pymunk", "--variant", "tuned", "--every", "1")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    return our_wheel(tmp_path_factory)


@pytest.fixture(scope="module")
def programs(wheel, tmp_path_factory):
    return environment_with(tmp_path_factory.mktemp("environment"), wheel)


@pytest.fixture
def crosscheck(programs, tmp_path):
    """Starts the installed program in an empty folder; what it said, and its status."""

    def call(*words):
        ended = run(programs / "crosscheck", *words, folder=tmp_path)
        return ended.returncode, ended.stdout, ended.stderr

    return call


PACKAGES = ("engines", "reference", "reports")
# The gate's baseline, and what the pages of versions and of the atlas are written from.
SHIPPED = ("errors", "timings", "versions", "atlas", "atlas_timings")


def test_every_template_snippet_and_baseline_of_the_checkout_is_in_the_wheel(wheel):
    names = set(zipfile.ZipFile(wheel).namelist())
    files = [path.relative_to(ROOT) for path in (ROOT / "reports" / "pages").rglob("*") if path.is_file()]
    wanted = [path.as_posix() for path in files if "__pycache__" not in path.parts]
    assert len([name for name in wanted if name.endswith("page.md")]) > 10
    assert set(wanted) <= names
    # What numba would compile is not run from an installation here: that it is there is all there is to ask.
    modules = [path.relative_to(ROOT) for part in PACKAGES for path in (ROOT / part).rglob("*.py")]
    assert {path.as_posix() for path in modules} <= names
    assert "engines/lagrange/compiled/entry.py" in names
    results = {name for name in names if name.startswith("reports/results/")}
    assert results == {f"reports/results/{name}.csv" for name in SHIPPED}
    assert "reports/search/page.md" in names
    assert {name.split("/")[0] for name in names if ".dist-info" not in name} == {*PACKAGES, "planar_crosscheck.py"}


def test_an_installation_has_all_that_the_checkout_registers_in_the_same_order(programs, tmp_path):
    from engines.registry import ENGINES, VARIANTS, method
    from reports.model.catalogue import PAGES, SCENES

    asked = (
        "from engines.registry import ENGINES, VARIANTS, method; from reports.model.catalogue import *;"
        "print([method(e) for e in VARIANTS], [method(e) for e in ENGINES], [s.name for s in SCENES],"
        "[p.name for p in PAGES], TROUBLES, sep='\\n'); import reports; print(reports.__file__)"
    )
    ended = run(programs / "python", "-c", asked, folder=tmp_path)
    assert ended.stderr == ""
    *told, place = ended.stdout.splitlines()
    assert not place.startswith(str(ROOT / "reports"))
    here = ([method(e) for e in VARIANTS], [method(e) for e in ENGINES], [s.name for s in SCENES])
    assert told == [*map(str, (*here, [page.name for page in PAGES])), "()"]


def test_results_go_below_the_current_folder(crosscheck, tmp_path):
    """That every page is written by an installation is asked in test_third_party.py."""
    status, out, err = crosscheck("run", *ONE_CELL)
    assert (status, err) == (0, "")
    assert "1 of 1 cells run" in out
    assert crosscheck("show", ONE_CELL[0])[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"crosscheck-results"}


def test_nothing_is_published_from_an_installation(crosscheck, tmp_path):
    status, out, err = crosscheck("report", "--publish")
    assert (status, out) == (2, "")
    assert err.startswith("crosscheck: --publish is for a checkout")
    assert len(err.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_slips_and_shapes_are_told_by_an_installation(crosscheck, tmp_path):
    status, out, err = crosscheck("errata", "1")
    assert (status, err) == (0, "")
    assert "Printed slips" in out
    angle = np.linspace(0.0, 2.0, 60)
    rows = np.column_stack([angle, 0.4 * angle, np.full_like(angle, 0.4), -angle])
    np.savetxt(tmp_path / "rolling.csv", rows, delimiter=",", header="t,x,y,angle", comments="")
    status, out, err = crosscheck("shapes", "rolling.csv")
    assert (status, err) == (0, "")
    assert (tmp_path / "rolling_shapes.svg").is_file()


@pytest.mark.slow
def test_an_installation_is_timed(crosscheck):
    status, out, err = crosscheck("bench", "driven_four_bar")
    assert (status, err) == (0, "")
    assert "bare loop [us/step]" in out


def test_the_grid_is_tested_in_an_installation_against_the_baseline_in_the_wheel(programs, tmp_path):
    options = ("-p", "reports.gate.pytest_plugin", "-p", "no:cacheprovider", "-W", "error", "-m", "crosscheck")
    chosen = (
        "--pyargs",
        "reports.gate.grid_tests",
        "--scene",
        "driven_four_bar",
        "--engine",
        "pymunk tuned",
    )
    ended = run(programs / "python", "-m", "pytest", "-q", *options, *chosen, folder=tmp_path)
    assert ended.returncode == 0, ended.stdout + ended.stderr
    assert "3 passed" in ended.stdout  # of theory, of change, and that no cell is missing
    assert "driven_four_bar  pymunk tuned" in ended.stdout


@pytest.mark.parametrize("name", ["engines", "reports"])
def test_another_package_of_one_of_our_names_is_told_in_one_line(programs, tmp_path, name):
    (tmp_path / name).mkdir()
    (tmp_path / name / "__init__.py").write_text("", encoding="utf-8")
    ended = run(programs / "python", "-m", "planar_crosscheck", "--help", folder=tmp_path)
    assert (ended.returncode, ended.stdout) == (2, "")
    (line,) = ended.stderr.splitlines()
    assert line.startswith(f"crosscheck: the package {name!r} is another one, at {tmp_path / name}, and ours is at ")
    assert run(programs / "crosscheck", "--help", folder=tmp_path).returncode == 0  # it does not look here
