"""Tests of versions and cache keys: a result is stale if its source files or its packages have changed."""

from __future__ import annotations

import importlib
import platform
import sys
from dataclasses import dataclass, replace
from importlib import metadata
from typing import Any

import pytest

from engines.lagrange import loading
from engines.pymunk import DEFAULT
from engines.registry import VARIANTS
from reports.gate.change import Altered, Nudge
from reports.model import fingerprint
from reports.model.cells import Cell
from reports.model.fingerprint import MEASURING, OURS, versions_of
from reports.model.tasks import Motion
from reports.pages.index import foot
from reports.write import provenance
from reports.write.provenance import machine, still_installed, versions
from tests.toys import Disc, Toy

LAGRANGE = next(engine for engine in VARIANTS if engine.name == "lagrange")


def forget() -> None:
    for name in ("_versions", "_our_files", "_required"):
        getattr(fingerprint, name).cache_clear()
    provenance._version.cache_clear()


def key(*values: Any, folders: tuple[str, ...] = MEASURING) -> str:
    """The fingerprint, computed without cached values."""
    forget()
    return fingerprint.fingerprint(*values, folders=folders)


@pytest.fixture(autouse=True)
def _fresh():
    yield
    forget()


@pytest.mark.parametrize(
    ("path", "rows", "tasks"),
    [
        ("reports/model/errors.py", True, True),
        ("reports/pages/four_bar/page.py", False, True),
        ("reports/pages/four_bar/page.md", False, False),
    ],
)
def test_a_changed_source_file_makes_rows_stale_unless_it_belongs_to_a_page(tmp_path, monkeypatch, path, rows, tasks):
    monkeypatch.setattr(fingerprint, "ROOT", tmp_path)
    file = tmp_path / path
    file.parent.mkdir(parents=True)
    file.write_text("a = 1\n")
    earlier = key(Disc(), Toy()), key(Disc(), folders=OURS)
    file.write_text("a = 2\n")
    later = key(Disc(), Toy()), key(Disc(), folders=OURS)
    assert tuple(a != b for a, b in zip(earlier, later, strict=True)) == (rows, tasks)


ENGINE = """
from dataclasses import dataclass
from pathlib import Path
from helping import number
from tests.toys import Toy

DATA = Path(__file__).with_name("numbers.txt")

@dataclass(frozen=True)
class Theirs(Toy):
    pass
"""


@pytest.fixture
def theirs(tmp_path, monkeypatch):
    """A user's engine that uses a module and a data file in its folder; the folder has another, unused file."""
    files = {"their_engine.py": ENGINE, "helping.py": "number = 1\n", "numbers.txt": "7\n", "notes.txt": "x\n"}
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("their_engine")
    yield module.Theirs()
    for name in ("their_engine", "helping"):
        sys.modules.pop(name, None)


@pytest.mark.parametrize(("name", "counts"), [("helping.py", True), ("numbers.txt", True), ("notes.txt", False)])
def test_a_changed_file_of_a_user_s_engine_makes_its_rows_stale(theirs, tmp_path, name, counts):
    @dataclass(frozen=True)
    class EngineInTuple:
        parts: tuple[Any, ...]

    # an engine, its wrapper, and an engine with a tuple of engines
    engines = (theirs, Altered(theirs, Nudge(1)), EngineInTuple((theirs,)))
    earlier = [key(Disc(), engine) for engine in engines]
    other = key(Disc(), DEFAULT)
    (tmp_path / name).write_text((tmp_path / name).read_text() + "# more\n")
    assert [key(Disc(), engine) != old for engine, old in zip(engines, earlier, strict=True)] == [counts] * 3
    assert key(Disc(), DEFAULT) == other


def test_an_installed_package_counts_by_its_version_and_not_by_its_files(tmp_path, monkeypatch):
    folder = tmp_path / "site-packages"
    info = folder / "theirs-1.0.dist-info"
    info.mkdir(parents=True)
    (folder / "installed_theirs.py").write_text(ENGINE.replace("from helping import number", ""))
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.0\n")
    (info / "top_level.txt").write_text("installed_theirs\n")
    monkeypatch.syspath_prepend(folder)
    engine = importlib.import_module("installed_theirs").Theirs()
    expected = {**fingerprint._distributions(), "installed_theirs": ["theirs"]}
    monkeypatch.setattr(fingerprint, "_distributions", lambda: expected)
    earlier = key(engine)
    (folder / "installed_theirs.py").write_text("# another text\n")
    assert key(engine) == earlier
    assert versions_of(engine)["theirs"] == "1.0"
    info.rename(folder / "theirs-1.1.dist-info")
    (folder / "theirs-1.1.dist-info" / "METADATA").write_text("Metadata-Version: 2.1\nName: theirs\nVersion: 1.1\n")
    assert key(engine) != earlier
    sys.modules.pop("installed_theirs")


@pytest.mark.parametrize(
    ("engine", "distribution", "counts"),
    [
        (DEFAULT, "pymunk", True),
        (DEFAULT, "cffi", True),  # which pymunk requires
        (DEFAULT, "mujoco-core", False),
        (LAGRANGE, "numpy", True),
    ],
)
def test_a_packages_version_counts_for_the_rows_that_use_it(monkeypatch, engine, distribution, counts):
    earlier, real = key(Disc(), engine), metadata.version
    monkeypatch.setattr(metadata, "version", lambda name: "99" if name == distribution else real(name))
    assert (key(Disc(), engine) != earlier) == counts


def test_every_number_of_a_cell_is_in_its_key():
    cell = Cell(Disc(), Toy(), 3)
    others = [
        Cell(Disc(rate=3.0), Toy(), 3),
        Cell(Disc(), Toy(factor=2.0), 3),
        Cell(Disc(), Toy("other"), 3),
        Cell(Disc(), Toy(), 4),
        Cell(Disc(), Toy(), 3, samples=7),
    ]
    assert len({cell.key, *(other.key for other in others)}) == 6
    assert replace(cell, purpose="failure").key == cell.key  # an experiment uses the row of the sweep
    assert Motion(cell).key != Motion(others[0]).key


def test_a_release_under_another_distribution_name_changes_the_key_of_rows(monkeypatch):
    """MuJoCo 3.6 is installed by the distribution mujoco, and MuJoCo 4.0 by mujoco-core."""
    expected = dict(fingerprint._distributions())
    assert "pytest" not in versions_of(Disc(), DEFAULT)
    monkeypatch.setattr(fingerprint, "_distributions", lambda: {**expected, "pymunk": ["pymunk", "pytest"]})
    forget()
    assert "pytest" in versions_of(Disc(), DEFAULT)
    assert fingerprint._rivals(["nothing"]) == set()


def test_versions_are_those_of_the_named_packages(monkeypatch):
    forget()
    numbers = {"numpy": "1.1", "scipy": "2.2", "pymunk": "3.3"}

    def version(name):
        if name not in numbers:
            raise metadata.PackageNotFoundError(name)
        return numbers[name]

    monkeypatch.setattr(metadata, "version", version)
    monkeypatch.setattr(platform, "python_version", lambda: "3.99")
    compiled = ", numba not installed" if loading.installed() else ""
    assert versions() == f"Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed{compiled}"
    assert still_installed("Python 3.99, numpy 1.1, scipy 2.2, pymunk 3.3, mujoco-core not installed")
    assert not still_installed("Python 3.99, scipy 2.3")
    assert still_installed("Python 3.99.2, scipy 2.2")
    assert not still_installed("Python 3.98, scipy 2.2")
    assert not still_installed("Python 3.99, scipy 2.2, another 1.0")
    assert foot("a command") == f"Made by `a command` with {versions()}; timings on {machine()}."
