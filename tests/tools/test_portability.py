"""Tests without features that Windows and macOS lack, and tests of lower bounds and of the layers of imports."""

from __future__ import annotations

import os
import shutil
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


# A mapping from files to an import that a contract forbids in the file.
FORBIDDEN = {
    "engines/extrapolated.py": "from reference.scenes.catalogue import SCENES",
    "reference/rolling/roll.py": "import reference.scenes.rolling.body",  # indirectly
    "reference/mechanism.py": "import reports.model.page",
}


def test_a_closed_form_in_an_adapter_and_a_report_in_the_reference_break_the_contracts(tmp_path):
    pytest.importorskip("importlinter", reason="import-linter comes with the extra `develop`")
    for package in ("reference", "engines", "reports"):
        shutil.copytree(ROOT / package, tmp_path / package, ignore=shutil.ignore_patterns("results", "__pycache__"))
    for name in ("pyproject.toml", "tests/__init__.py", "tests/tools/__init__.py", "tests/tools/import_contract.py"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    for file, line in FORBIDDEN.items():
        (tmp_path / file).write_text(f"{line}\n{(ROOT / file).read_text(encoding='utf-8')}", encoding="utf-8")
    command = "import sys; from importlinter.cli import lint_imports_command; sys.exit(lint_imports_command())"
    text = [sys.executable, "-c", command, "--no-cache"]
    environment = {"PYTHONPATH": str(tmp_path), "PATH": ""}
    linted = subprocess.run(text, cwd=tmp_path, capture_output=True, text=True, timeout=300, env=environment)
    assert linted.returncode == 1
    for line in FORBIDDEN.values():
        assert line.split()[1] in linted.stdout
