"""Tests without features that Windows and macOS lack, and tests of lower bounds and of the allowed imports."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

from tests import ROOT
from tests.tools.lower_bounds import PYPROJECT, lower_bounds

# This program, which worker processes import too, removes features that Windows lacks.
SCRIPT_WITHOUT_UNIX = """
import multiprocessing
import os
import signal
import sys
import time
from pathlib import Path

# The signals of Windows (documentation of the module `signal`), and SIGKILL, which multiprocessing needs here.
WINDOWS_SIGNALS = {"SIGKILL", "SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM", "SIG_DFL", "SIG_IGN"}
for name in dir(signal):
    if name.startswith(("SIG", "ITIMER")) and name not in WINDOWS_SIGNALS:
        delattr(signal, name)
for name in ("setitimer", "getitimer", "alarm", "pthread_sigmask", "pthread_kill"):
    delattr(signal, name)
for name in ("fork", "forkpty", "sched_getaffinity", "getuid", "setsid"):
    delattr(os, name)
del time.clock_gettime
sys.modules["resource"] = sys.modules["fcntl"] = None
multiprocessing.get_all_start_methods = lambda: ["spawn"]

from reports.model.cells import Cell
from reports.run.running import run_into
from reports.run.store import Store
from tests.reports.rough_toys import RoughToy
from tests.toys import Disc, FailingToy, Toy

if __name__ == "__main__":
    cells = [Cell(Disc(), engine, 1) for engine in (Toy(), FailingToy("exit"), RoughToy("spin"))]
    with Store(Path(sys.argv[1]) / "cells.sqlite") as store:
        print(run_into(store, cells, limit=2.0))
        for row in store.get(cells).values():
            print(f"{row.variant}: {row.outcome}, {row.sentence}")
"""


def test_cells_have_the_same_outcomes_without_fork_timers_and_most_signals(tmp_path):
    folder = tmp_path / "Ergebnisse mit Größe"
    folder.mkdir()
    (folder / "script.py").write_text(SCRIPT_WITHOUT_UNIX, encoding="utf-8")
    # The folder for temporary files has an unusual name, and the locale is "C".
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder), "LC_ALL": "C", "PYTHONUTF8": "0"}
    environment |= {"PYTHONCOERCECLOCALE": "0", "PYTHONWARNINGS": "error"}
    command = [sys.executable, folder / "script.py", folder]
    ended = subprocess.run(command, env=environment, capture_output=True, timeout=300)
    assert ended.stderr == b""
    assert ended.stdout.decode().splitlines() == [
        "3",
        "default: finished, ",
        "exit: aborted, the process ended by itself with exit status 3",
        "spin: timed out, did not end within 2 s of CPU time",
    ]
    assert sorted(path.name for path in folder.iterdir()) == ["cells.sqlite", "script.py", "truths"]


def test_every_dependency_has_a_lower_bound():
    bounds = lower_bounds(PYPROJECT.read_text(encoding="utf-8"))
    assert "numpy==2.0" in bounds
    assert len(bounds) == len(set(bounds)) > 10
    with pytest.raises(ValueError, match="'loose' has no lower bound"):
        lower_bounds('[project]\ndependencies = ["loose"]\noptional-dependencies = {test = []}')


READS = ("engines.own", "library.joints"), ("engines.own", "library.curves.circle")


@pytest.mark.parametrize(
    ("imports", "kept"),
    [
        (READS, True),
        ((*READS, ("engines.own", "library.scenes")), False),
        ((*READS, ("library.joints", "library.scenes")), False),  # indirectly
        (READS[:1], False),  # an allowed package that is not imported
    ],
)
def test_an_engine_imports_only_what_the_list_allows(imports, kept):
    pytest.importorskip("importlinter", reason="import-linter comes with the extra `develop`")
    from grimp import ImportGraph

    from tests.tools.import_contract import AllowListContract

    graph = ImportGraph()
    for name in ("engines", "engines.own", "library", "library.joints", "library.curves", "library.scenes"):
        graph.add_module(name)
    for importer, imported in imports:
        graph.add_import(importer=importer, imported=imported)
    allowed = ["library.joints", "library.curves.*"]
    terms = {"source": "engines", "within": "library", "allowed": allowed}
    assert AllowListContract("a list", {"root_packages": ["engines"]}, terms).check(graph, False).kept == kept
