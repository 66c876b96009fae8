"""Which of our files and which versions a stored row depends on."""

from __future__ import annotations

import importlib
import importlib.metadata
import platform
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from engines import lagrange, mujoco, pymunk
from engines.extrapolated import Extrapolated
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.grid.cells import Cell
from reports.grid.fingerprint import fingerprint
from reports.grid.measure import blank
from reports.grid.store import Store
from tests.test_fingerprint import ROOT, _fresh, changed, forget, needed  # noqa: F401, a fixture of every test
from tests.toys import Disc, FailingToy, Toy


class Bytes:
    """`Path.read_bytes` as if one of our own files had a byte more."""

    def __init__(self, monkeypatch):
        self.path: Path | None = None
        self.read = Path.read_bytes
        monkeypatch.setattr(Path, "read_bytes", lambda path: self.read(path) + (b"\n" if path == self.path else b""))

    def touching(self, path: Path | None) -> None:
        self.path = path
        forget()


@pytest.fixture
def touch(monkeypatch):
    return Bytes(monkeypatch).touching


@pytest.mark.parametrize(
    ("engine", "own", "others"),
    [
        # Its package makes the extended variant by extrapolation, so that file is run with it.
        (pymunk.TUNED, "engines/pymunk", ("engines/mujoco",)),
        (mujoco.TUNED, "engines/mujoco", ("engines/pymunk", "engines/lagrange", "engines/extrapolated")),
        (lagrange.Lagrange("rk4", "projection"), "engines/lagrange", ("engines/pymunk", "engines/mujoco")),
        (Extrapolated(pymunk.TUNED, "x", (1, 2), (2,)), "engines/pymunk", ("engines/mujoco",)),
    ],
    ids=("pymunk", "mujoco", "lagrange", "extrapolated pymunk"),
)
def test_rows_depend_on_their_engine_their_scene_and_the_measuring_and_on_nothing_else(engine, own, others):
    files = needed(FreeFourBar(), engine)
    assert any(name.startswith(own) for name in files)
    assert {
        "reference/scenes/four_bar/scenes",
        "reference/scenes/four_bar/linkage",
        "reference/mechanism",
        "engines/__init__",
    } <= files
    assert not [name for name in files if name.startswith(others)]
    # Compiled code is imported by name, and only to step.
    assert ("engines/lagrange/compiled/rows" in files) == (own == "engines/lagrange")
    assert not [
        name
        for name in files
        if name.startswith(tuple(f"reference/scenes/{part}" for part in ("pendulum", "skates", "wheels")))
    ]
    # What only prints or draws can't change a row.
    assert {name for name in files if name.startswith("reports/")} == {
        f"reports/{name}"
        for name in (
            "__init__",
            *(f"grid/{name}" for name in ("__init__", "cells", "errors", "fingerprint", "measure", "outcomes", "pool")),
            *(
                f"grid/{name}"
                for name in ("ending", "expected", "imports", "processors", "requirements", "spending", "supervisor")
            ),
            *(
                f"grid/{name}"
                for name in ("tasks", "temporary", "timing", "truths", "waiting", "worker", "worker_process")
            ),
        )
    }


def test_the_file_of_a_wrapped_engine_counts():
    inner = mujoco.TUNED
    around = needed(Disc(), Extrapolated(inner, "x", (1, 2), (2,)))
    assert needed(Disc(), inner) < around
    assert around - needed(Disc(), inner) == {"engines/extrapolated"}


@pytest.mark.parametrize(
    ("name", "scene", "engine"),
    [
        ("reports/grid/measure.py", Disc(), Toy()),
        ("reports/grid/errors.py", Disc(), Toy()),
        ("reports/grid/pool.py", Disc(), Toy()),
        ("reference/joints.py", Disc(), Toy()),
        ("tests/toys.py", Disc(), Toy()),
        ("engines/mujoco/model.py", Disc(), mujoco.TUNED),
        ("engines/pymunk/model.py", Disc(), Extrapolated(pymunk.TUNED, "x", (1, 2), (2,))),
        ("reference/scenes/four_bar/free_motion.py", FreeFourBar(), Toy()),
    ],
)
def test_a_changed_source_makes_a_stored_cell_run_again(tmp_path, touch, name, scene, engine):
    assert (ROOT / name).is_file()
    with Store(tmp_path / "cells.sqlite") as store:
        cell = Cell(scene, engine, 1)
        store.put(blank(cell))
        assert list(store.get([Cell(scene, engine, 1)])) == [cell]
        touch(ROOT / name)
        assert not store.get([Cell(scene, engine, 1)])
        touch(None)
        assert store.get([Cell(scene, engine, 1)])


@pytest.mark.parametrize(
    "name", ["reports/text/tables.py", "reports/charts/work_precision.py", "engines/mujoco/model.py", "tests/rows.py"]
)
def test_a_change_elsewhere_leaves_a_stored_cell_alone(tmp_path, touch, name):
    assert (ROOT / name).is_file()
    with Store(tmp_path / "cells.sqlite") as store:
        store.put(blank(Cell(Disc(), Toy(), 1)))
        touch(ROOT / name)
        assert store.get([Cell(Disc(), Toy(), 1)])


@pytest.mark.parametrize(
    ("engine", "distribution", "counts"),
    [
        (pymunk.TUNED, "pymunk", True),
        (pymunk.TUNED, "mujoco-core", False),
        (mujoco.TUNED, "mujoco-core", True),
        (mujoco.TUNED, "pymunk", False),
        (Extrapolated(pymunk.TUNED, "x", (1, 2), (2,)), "pymunk", True),
        (Toy(), "numpy", True),
        (Toy(), "matplotlib", False),
    ],
)
def test_a_packages_version_counts_for_the_rows_that_use_it(monkeypatch, engine, distribution, counts):
    before = fingerprint(Disc(), engine)
    original = importlib.metadata.version
    monkeypatch.setattr(importlib.metadata, "version", lambda name: "0.0.1" if name == distribution else original(name))
    forget()
    assert (fingerprint(Disc(), engine) != before) == counts


def test_pythons_own_version_counts(monkeypatch):
    before = fingerprint(Toy())
    monkeypatch.setattr(platform, "python_version", lambda: "3.99.0")
    forget()
    assert fingerprint(Toy()) != before


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
        replace(cell, purpose="map"),
    ]
    assert len({cell.key, *(other.key for other in others)}) == 1 + len(others)
    assert Cell(Disc(), Toy(), 1).key == cell.key == Cell(Disc(), Toy(), 1, samples=Disc().samples).key
