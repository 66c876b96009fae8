"""Stale results: a byte or a version that a row depends on makes it run again, and nothing else does."""

from __future__ import annotations

import ast
import importlib
import importlib.metadata
import platform
import sys
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import pytest

from engines import lagrange, mujoco, pymunk
from engines.extrapolated import Extrapolated
from engines.registry import INSTALLED
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model import fingerprint as fingerprint_module
from reports.model.cells import Cell
from reports.model.fingerprint import OURS, ROOT, fingerprint, modules_behind, modules_of, with_required
from reports.model.measure import blank
from reports.run.store import Store
from tests.toys import Disc, FailingToy, Toy

# Looking through all that is installed takes half a second, and is the same in every test.
DISTRIBUTIONS = cache(importlib.metadata.packages_distributions)
AROUND = Extrapolated(pymunk.TUNED, "x", (1, 2), (2,))


def forget() -> None:
    """Files and versions are read once a process; here they change."""
    for member in vars(fingerprint_module).values():
        if hasattr(member, "cache_clear"):
            member.cache_clear()


@pytest.fixture(autouse=True)
def _fresh(monkeypatch):
    monkeypatch.setattr(importlib.metadata, "packages_distributions", DISTRIBUTIONS)
    forget()
    yield
    forget()


# An engine of somebody else in a package, and one in a file that imports others and reads data.
FILES = {
    "theirs/__init__.py": "",
    "theirs/plugin.py": """
from dataclasses import dataclass, field
from engines import Engine
from importlib import import_module
from . import near
LATE = import_module(".late", __package__)
FILES = ("table.csv", "grid.bin")

@dataclass(frozen=True)
class Plugin(Engine):
    variant: str = "default"
    name: str = "theirs"
    settings: dict = field(default_factory=dict, hash=False)
    packages = ()
    order = step_cost = holder = print

    def build(self, mechanism, dt):
        raise NotImplementedError

def helper():
    if LATE: import theirs_below
""",
    "theirs/near.py": "",
    "theirs/late.py": "",
    "theirs/table.csv": "1,2",
    "theirs/data/grid.bin": "1",
    "theirs_below.py": "TABLE = 'theirs_table.csv'\nfrom theirs_last import (\n    A,\n)",
    "theirs_table.csv": "1",
    "theirs_last.py": "A = 1",
    "theirs_too.py": "import theirs",
    "theirs/crosscheck-results/cells.sqlite": "",  # of a run that was started in the package's folder
    "notes.txt": "",
    # An engine that holds others, in every way that a field can; it imports none of them.
    "around.py": """
from dataclasses import dataclass
from typing import Any

@dataclass(frozen=True)
class Around:
    held: Any
    variant: str = "around"
    name: str = "around"
""",
}
UNRELATED = ("theirs_too.py", "theirs/crosscheck-results/cells.sqlite", "notes.txt", "around.py")


@pytest.fixture
def theirs(tmp_path, monkeypatch):
    """Their files written down and on the path; gives (folder, an engine of theirs)."""
    for name, text in FILES.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    known = set(sys.modules)
    yield tmp_path, importlib.import_module("theirs.plugin").Plugin()
    for name in set(sys.modules) - known:
        del sys.modules[name]


def changed(path: Path, *values: Any) -> bool:
    """Whether one byte more in a file changes the fingerprint of these values."""
    before = fingerprint(*values)
    text = path.read_bytes()
    path.write_bytes(text + b"\n")
    forget()
    after = fingerprint(*values)
    path.write_bytes(text)
    forget()
    assert fingerprint(*values) == before  # it is the bytes, not when they were written
    return before != after


@pytest.mark.parametrize("name", FILES)
def test_a_byte_changed_in_a_file_makes_the_rows_of_the_engines_stale_that_need_it(theirs, name):
    folder, engine = theirs
    assert changed(folder / name, engine) == (name not in UNRELATED)


def test_names_count_as_bytes_do_and_the_folder_does_not(theirs, tmp_path, monkeypatch):
    folder, engine = theirs
    before = fingerprint(engine)
    (folder / "theirs/late.py").rename(folder / "theirs/later.py")
    forget()
    assert fingerprint(engine) != before
    (folder / "theirs/later.py").rename(folder / "theirs/late.py")
    other = tmp_path / "elsewhere"
    other.mkdir()
    for name in ("theirs", "theirs_below.py", "theirs_table.csv", "theirs_last.py"):
        (folder / name).rename(other / name)
    for name in [name for name in sys.modules if name.split(".")[0] == "theirs"]:
        del sys.modules[name]
    monkeypatch.syspath_prepend(other)
    forget()
    assert fingerprint(engine) == before


def test_what_an_engine_holds_counts_wherever_it_holds_it(theirs):
    folder, inner = theirs
    path = folder / "theirs/near.py"
    Around = importlib.import_module("around").Around
    kind = type(inner)
    for held in (inner, (1, [inner]), {"inner": inner}, {kind: 1}, frozenset({inner}), kind, Around(inner)):
        assert changed(path, Around(held)), held
    assert changed(path, Around(sys.modules["theirs.plugin"].helper))
    assert changed(path, replace(inner, settings={"base": Toy(), "other": inner}))
    assert not changed(path, Around("theirs"))
    assert changed(path, Extrapolated(inner, "extended", (1, 2), (2,)))


def test_the_classes_that_an_engine_derives_from_count(theirs):
    base = type(theirs[1])
    derived = type("Derived", (base,), {"__module__": "derived"})
    assert {"derived", "theirs.plugin"} <= modules_behind(derived()) & modules_behind((derived,))


def pieces(*values: Any) -> set[str]:
    """The files and folders of ours behind these values."""
    places, _ = fingerprint_module._behind(modules_of(*values))
    return {place.relative_to(ROOT).as_posix() for place in places if place.is_relative_to(ROOT)}


@pytest.mark.parametrize(
    ("engine", "own"),
    [
        (pymunk.TUNED, {"pymunk"}),
        (mujoco.TUNED, {"mujoco"}),
        (lagrange.Lagrange("rk4", "projection"), {"lagrange"}),
        (AROUND, {"pymunk"}),
    ],
    ids=("pymunk", "mujoco", "lagrange", "extrapolated pymunk"),
)
def test_rows_depend_on_the_reference_their_engine_and_the_measuring_and_on_no_page(engine, own):
    found = pieces(FreeFourBar(), engine)
    packages = {"pymunk", "mujoco", "lagrange", "exudyn", "box2d.py", "bullet", "pinocchio", "mjx.py", "conformance"}
    assert {name for name in packages if f"engines/{name}" in found} == own
    assert {"reference", "engines/contract.py", "reports/model/measure.py", "reports/run/supervisor.py"} <= found
    assert {name.rpartition("/")[0] for name in found if name.startswith("reports/")} == {
        *("reports", "reports/model", "reports/run")
    }


def test_every_import_of_ours_is_followed():
    """By Python's own reader, which takes half a second for all files: too long for each command."""
    for path in {path for package in OURS for path in (ROOT / package).rglob("*.py")}:
        wanted: set[str] = set()
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                wanted.update(alias.name for alias in node.names)
            elif isinstance(node, ast.ImportFrom):
                assert not node.level, f"{path}: a relative import"
                wanted.update(f"{node.module}.{alias.name}" for alias in node.names if alias.name != "*")
        assert wanted <= fingerprint_module._imports(path), path


def test_a_sentence_is_no_import_and_a_folder_without_sources_no_package(tmp_path, monkeypatch):
    text = "imports a, b\nimport a model of b\nfrom it import what it has\nimport c as d, e.f  # g\nif h: import k\n"
    (tmp_path / "file.py").write_text(text + "from l import (m,  # n\n    o)\nfrom p import *\n", encoding="utf-8")
    assert fingerprint_module._imports(tmp_path / "file.py") >= {"c", "e.f", "k", "l", "l.m", "l.o", "p"}
    assert not fingerprint_module._imports(tmp_path / "file.py") & {"a", "b", "it", "d", "h"}
    (tmp_path / "results_of_mine").mkdir()
    monkeypatch.syspath_prepend(tmp_path)
    assert fingerprint_module._piece("results_of_mine") == ()


def test_every_engine_imports_another_s_package_by_an_import_alone():
    """A module that is imported by its name as a text would not be followed, unless it lies in the same package."""
    for engine in INSTALLED:
        module = type(engine).__module__
        [place] = fingerprint_module._piece(module)
        texts = [path.read_text(encoding="utf-8") for path in fingerprint_module._files(place) if path.suffix == ".py"]
        own = ".".join(module.split(".")[:2])
        assert not [text for text in texts if 'import_module("engines.' in text.replace(f'("{own}', "")], module


@pytest.fixture
def touch(monkeypatch):
    """Call it with a path: from now on `Path.read_bytes` reads that file as if it had a byte more; None for no file."""
    read = Path.read_bytes
    touched: list[Path | None] = [None]
    monkeypatch.setattr(Path, "read_bytes", lambda path: read(path) + (b"\n" if path == touched[0] else b""))

    def touching(path: Path | None) -> None:
        touched[0] = path
        forget()

    return touching


@pytest.mark.parametrize(
    ("name", "scene", "engine", "stale"),
    [
        ("reports/model/measure.py", FreeFourBar(), mujoco.TUNED, True),
        ("reports/model/errors.py", FreeFourBar(), mujoco.TUNED, True),
        ("reports/run/supervisor.py", FreeFourBar(), mujoco.TUNED, True),
        ("reference/joints.py", FreeFourBar(), mujoco.TUNED, True),
        ("tests/toys.py", Disc(), Toy(), True),
        ("engines/mujoco/model.py", FreeFourBar(), mujoco.TUNED, True),
        ("engines/pymunk/model.py", FreeFourBar(), AROUND, True),
        ("engines/extrapolated.py", FreeFourBar(), Extrapolated(mujoco.TUNED, "x", (1, 2), (2,)), True),
        ("engines/extrapolated.py", FreeFourBar(), mujoco.TUNED, False),
        ("engines/pymunk/model.py", FreeFourBar(), mujoco.TUNED, False),
        ("engines/mujoco/model.py", FreeFourBar(), lagrange.Lagrange(), False),
        ("reports/write/tables.py", FreeFourBar(), mujoco.TUNED, False),
        ("reports/plots/work_precision.py", FreeFourBar(), pymunk.TUNED, False),
        ("reports/pages/skate/page.py", FreeFourBar(), mujoco.TUNED, False),
    ],
)
def test_a_stored_cell_runs_again_where_a_source_of_it_is_changed_and_only_there(
    tmp_path, touch, name, scene, engine, stale
):
    assert (ROOT / name).is_file()
    with Store(tmp_path / "cells.sqlite") as store:
        cell = Cell(scene, engine, 1)
        store.put(blank(cell))
        assert list(store.get([Cell(scene, engine, 1)])) == [cell]
        touch(ROOT / name)
        assert (store.get([Cell(scene, engine, 1)]) == {}) == stale
        touch(None)
        assert store.get([Cell(scene, engine, 1)])


@pytest.mark.parametrize(
    ("engine", "distribution", "counts"),
    [
        (pymunk.TUNED, "pymunk", True),
        (pymunk.TUNED, "cffi", True),  # no file of ours imports it: pymunk does
        (pymunk.TUNED, "mujoco-core", False),
        (mujoco.TUNED, "mujoco-core", True),
        (mujoco.TUNED, "pymunk", False),
        (AROUND, "pymunk", True),
        (Toy(), "numpy", True),
        (mujoco.TUNED, "matplotlib", False),
        (Toy(), "Python", True),
    ],
)
def test_a_packages_version_counts_for_the_rows_that_use_it(monkeypatch, engine, distribution, counts):
    before = fingerprint(FreeFourBar(), engine)
    original = importlib.metadata.version
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "0.0.1" if name == distribution else original(name))
    if distribution == "Python":
        monkeypatch.setattr(platform, "python_version", lambda: "3.99.0")
    forget()
    assert (fingerprint(FreeFourBar(), engine) != before) == counts


def test_what_is_installed_counts_by_its_version_and_not_by_its_bytes(tmp_path, monkeypatch):
    folder = tmp_path / "site-packages"
    folder.mkdir()
    (folder / "installed_engine.py").write_text(
        "from dataclasses import dataclass\n\n\n@dataclass(frozen=True)\nclass Plugin:\n    name: str = 'x'", "utf-8"
    )
    monkeypatch.syspath_prepend(folder)
    module = importlib.import_module("installed_engine")
    monkeypatch.setitem(sys.modules, "installed_engine", module)
    monkeypatch.setattr(
        importlib.metadata, "packages_distributions", lambda: {"installed_engine": ["Installed-Engine"]}
    )
    version = {"installed-engine": "1.0"}
    monkeypatch.setattr(importlib.metadata, "requires", lambda name: [])
    monkeypatch.setattr(importlib.metadata, "version", lambda name: version.get(name, "1"))
    forget()
    assert not changed(folder / "installed_engine.py", module.Plugin())
    before = fingerprint(module.Plugin())
    version["installed-engine"] = "1.1"
    forget()
    assert fingerprint(module.Plugin()) != before


def test_every_number_of_a_cell_is_in_its_key():
    cell = Cell(Disc(), Toy(), 1)
    others = [
        replace(cell, scene=Disc(rate=3.0)),
        replace(cell, engine=Toy(factor=2.0)),
        replace(cell, engine=Toy("tuned")),
        replace(cell, engine=Toy(name="other")),
        replace(cell, engine=FailingToy()),  # its fields are the toy's
        replace(cell, every=2),
        replace(cell, samples=7),
        replace(cell, purpose="failure"),
    ]
    assert len({cell.key, *(other.key for other in others)}) == 1 + len(others)
    assert Cell(Disc(), Toy(), 1).key == cell.key == Cell(Disc(), Toy(), 1, samples=Disc().samples).key


def test_what_is_required_in_turn_is_found_without_extras_and_without_what_is_not_installed(monkeypatch):
    invented = {
        "engine": ['binding>=1.0; python_version < "9"', 'drawing; extra == "pictures"', "elsewhere; os_name == 'os2'"],
        "binding": ["Parser.Of_C (>2)"],
        "parser-of-c": ["engine"],  # a circle
        "drawing": [],
    }

    def requires(name):
        if name not in invented:
            raise importlib.metadata.PackageNotFoundError(name)
        return invented[name]

    monkeypatch.setattr(importlib.metadata, "requires", requires)
    assert with_required(["Engine"]) == {"engine", "binding", "parser-of-c"}
    assert with_required(["drawing"]) == {"drawing"}
    assert with_required(["nothing"]) == set()
