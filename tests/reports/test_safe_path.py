"""Tests that no file in the current folder is imported instead of a module, and that a failed import stores no row."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import dataclass

import pytest

from reference.mechanism import Mechanism
from reports.model.cells import Cell
from reports.run.installed import environment as of_a_version
from reports.run.running import run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost
from tests import ROOT
from tests.reports.test_command_line import one_line
from tests.toys import Disc, Toy

HIDDEN = ("reference", "engines", "reports", "csv", "numpy", "typing", "mujoco", "pymunk", "threading", "pickle")
RUN = ("run", "free_four_bar", "--engine", "pymunk", "--every", "10")
# Without a fork server, as on macOS and Windows, each worker imports all modules itself.
SPAWN = "import multiprocessing; multiprocessing.get_all_start_methods = lambda: ['spawn']\n"
PROGRAM = "import sys; from planar_crosscheck import main; {more}\nif __name__ == '__main__': main()"


@pytest.fixture
def hostile(tmp_path):
    """A folder with modules that write their names to the file `executed` and raise an exception when imported."""
    for name in HIDDEN:
        path = tmp_path / name / "__init__.py" if name in ("engines", "reports") else tmp_path / f"{name}.py"
        path.parent.mkdir(exist_ok=True)
        path.write_text(f"open({str(tmp_path / 'executed')!r}, 'a').write('{name} ')\nraise ValueError('hidden')\n")
    return tmp_path


def ended(folder, *words):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.run([sys.executable, *words], cwd=folder, env=environment, capture_output=True, text=True)


def test_no_process_imports_a_file_of_the_current_folder(hostile):
    done = ended(hostile, "-P", "-c", SPAWN + PROGRAM.format(more=""), *RUN)
    assert done.returncode == 0, done.stderr
    assert not (hostile / "executed").exists()


def test_python_dash_m_does_not_put_the_current_folder_on_the_path(tmp_path):
    (tmp_path / "csv.py").write_text("raise ValueError('hidden')")
    (tmp_path / "numpy.py").write_text("raise ValueError('hidden')")
    done = ended(tmp_path, "-m", "reports", "show", "free_four_bar")
    assert "crosscheck run free_four_bar" in one_line(done.stderr)


def test_a_worker_reports_another_package_with_a_name_of_ours(tmp_path):
    """The path changes after the parent has imported our package, so a new worker finds the other package first."""
    (tmp_path / "engines").mkdir()
    (tmp_path / "engines" / "__init__.py").write_text("")
    more = f"import reports.cli.commands, engines.registry; sys.path.insert(0, {str(tmp_path)!r})"
    done = ended(tmp_path, "-P", "-c", SPAWN + PROGRAM.format(more=more), *RUN)
    assert done.returncode != 0
    assert "'engines'" in done.stderr
    assert "0 of 4" not in done.stdout


@dataclass(frozen=True)
class Importing(Toy):
    def build(self, mechanism: Mechanism, dt: float):
        from nowhere import nothing  # pyright: ignore[reportMissingImports]

        return nothing


def test_the_row_of_a_failed_import_is_not_stored(tmp_path):
    cells = [Cell(Disc(), Importing("importing"), 1), Cell(Disc(), Toy(), 1)]
    with Store(tmp_path / "cells.sqlite") as store:
        with pytest.raises(WorkersLost, match=r"1 of 2 cells are lost.*No module named 'nowhere'"):
            run_into(store, cells)
        assert set(store.get(cells)) == {cells[1]}


def test_the_process_of_a_version_does_not_have_the_current_folder_on_its_path(hostile, monkeypatch):
    monkeypatch.chdir(hostile)
    assert of_a_version(hostile)["PYTHONSAFEPATH"]
