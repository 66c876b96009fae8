"""Windows and macOS, as far as they can be had here: what they lack is hidden, what they do otherwise is forced."""

from __future__ import annotations

import ast
import os
import subprocess
import sys
import warnings

import pytest

from tests import ROOT
from tests.tools.lower_bounds import PYPROJECT, lower_bounds

SOURCES = [path for folder in ("reference", "engines", "reports") for path in sorted((ROOT / folder).rglob("*.py"))]

# A script whose workers import it again before anything else, so that the same is hidden there.
WITHOUT = """
import multiprocessing
import os
import signal
import sys
import time
from pathlib import Path

# What Windows has of signals, see the documentation of the module; with SIGKILL multiprocessing ends processes here.
KEPT = {"SIGKILL", "SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM", "SIG_DFL", "SIG_IGN"}
for name in dir(signal):
    if name.startswith(("SIG", "ITIMER")) and name not in KEPT:
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


def test_without_fork_server_timers_and_most_signals_cells_end_in_the_same_outcomes(tmp_path):
    folder = tmp_path / "Ergebnisse mit Größe"
    folder.mkdir()
    (folder / "script.py").write_text(WITHOUT, encoding="utf-8")
    # Neither the folder of the logs nor the locale is what everybody has.
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder), "LC_ALL": "C", "PYTHONUTF8": "0"}
    environment |= {"PYTHONCOERCECLOCALE": "0", "PYTHONWARNINGS": "error"}
    command = [sys.executable, folder / "script.py", folder]
    told = subprocess.run(command, env=environment, capture_output=True, timeout=300)
    assert told.stderr == b""
    assert told.stdout.decode().splitlines() == [
        "3",
        "default: finished, ",
        "exit: aborted, the process ended by itself with exit status 3",
        "spin: timed out, did not end within 2 s of CPU time",
    ]
    assert sorted(path.name for path in folder.iterdir()) == ["cells.sqlite", "script.py", "truths"]


def test_text_files_are_opened_with_their_encoding():
    found = {path: unnamed_encodings(path.read_text(encoding="utf-8")) for path in SOURCES}
    assert {path: lines for path, lines in found.items() if lines} == {}
    assert len(found) > 100


def unnamed_encodings(source: str) -> list[int]:
    """The lines that read or write a text in whatever encoding the machine has."""
    lines = []
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Call):
            name = getattr(node.func, "attr", getattr(node.func, "id", ""))
            words = {word.arg for word in node.keywords}
            given = (*node.args, *(word.value for word in node.keywords))
            binary = any("b" in ast.literal_eval(argument) for argument in given if is_mode(argument))
            of_system = isinstance(node.func, ast.Attribute) and getattr(node.func.value, "id", "") == "os"
            if name in ("open", "fdopen", "read_text", "write_text") and not (
                binary or of_system or "encoding" in words
            ):
                lines.append(node.lineno)
    return lines


def is_mode(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str) and set(node.value) <= set("rwxabt+")


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("path.read_text()", [1]),
        ("path.write_text(text, newline='')", [1]),
        ("open(path, 'w')", [1]),
        ("path.open()", [1]),
        ("path.read_text(encoding='utf-8')", []),
        ("open(path, 'rb')", []),
        ("path.open(mode='wb')", []),
        ("os.open(path, os.O_RDONLY)", []),
    ],
)
def test_a_text_file_of_the_machine_s_encoding_is_found(line, found):
    assert unnamed_encodings(line) == found


@pytest.mark.parametrize("kind", [DeprecationWarning, PendingDeprecationWarning, FutureWarning, UserWarning])
def test_what_will_be_gone_is_an_error_in_our_own_code_alone_and_any_other_warning_everywhere(kind):
    for module in ("engines.mujoco.engine", "reference.plane", "reports.cli.run", "tests.tools.test_portability"):
        with pytest.raises(kind):
            warnings.warn_explicit("it will be gone", kind, "file.py", 1, module)
    with warnings.catch_warnings(record=True) as told:
        if kind is UserWarning:
            with pytest.raises(kind):
                warnings.warn_explicit("it is odd", kind, "file.py", 1, "numpy")
        else:
            warnings.warn_explicit("it will be gone", kind, "file.py", 1, "numpy.random")
    assert len(told) == (kind is not UserWarning)


def test_every_dependency_has_a_lower_bound_that_can_be_tried():
    bounds = lower_bounds(PYPROJECT.read_text(encoding="utf-8"))
    assert "numpy==2.0" in bounds
    assert len(bounds) == len(set(bounds)) > 10
    with pytest.raises(ValueError, match="'loose' has no lower bound"):
        lower_bounds('[project]\ndependencies = ["loose"]\noptional-dependencies = {test = []}')
