"""Tests asked in copies of the tree, each time in a process of its own, forked with other people's packages loaded."""

from __future__ import annotations

import compileall
import importlib
import json
import os
import py_compile
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from tests.tools.mutants import tracing
from tests.tools.mutants.sources import Mistake

LEFT_OUT = (".git", ".venv*", "__pycache__", "*.egg-info", ".*_cache", "*.sqlite*", "crosscheck-results")
# What takes seconds to import, and is not ours.
OTHERS = ("numpy", "scipy.integrate", "scipy.optimize", "scipy.sparse.linalg", "scipy.special", "mujoco", "pymunk")
OTHERS += ("matplotlib.figure", "matplotlib.backends.backend_agg", "numba", "rich.table", "rich.progress", "typer")
OTHERS += ("jinja2", "pytest", "ezdxf", "markdown_it")
ONE_THREAD: dict[str, str] = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
OPTIONS = ("-q", "--no-header", "--tb=no", "-p", "no:cacheprovider", "-m", "not slow and not crosscheck")


@dataclass(frozen=True)
class Question:
    """Tests to run, with a mistake or none, until the first fails or all of them, for `limit` seconds at most.

    `traced`: the folder that a trace of them goes into.
    """

    tests: tuple[str, ...]
    mistake: Mistake | None = None
    first: bool = True
    limit: float = 120.0
    traced: Path | None = None


@dataclass(frozen=True)
class Answer:
    """Which tests failed, of how many that ran; `end`: what happened where pytest did not end by itself."""

    noticed: tuple[str, ...]
    ran: int
    seconds: float
    end: str = ""


def copy_tree(root: Path, folder: Path) -> Path:
    """A copy in which a changed file is always compiled again: its bytecode goes by contents, not by date and size."""
    shutil.copytree(root, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))
    compileall.compile_dir(folder, quiet=2, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    return folder


class _Writer:
    """A plugin of pytest: tells at once which tests ran and which failed."""

    def __init__(self, path: Path) -> None:
        self.file = path.open("a", encoding="utf-8", buffering=1)

    def pytest_runtest_logreport(self, report: Any) -> None:
        if report.when == "call" or report.failed:
            print(json.dumps([report.nodeid, report.failed]), file=self.file)

    def pytest_collectreport(self, report: Any) -> None:
        if report.failed:
            print(json.dumps([report.nodeid, True]), file=self.file)


def _run(question: Question, tree: Path, told: Path) -> int:
    """In the new process: make the mistake, run the tests, take it back."""
    silent = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(silent, stream)
    os.chdir(tree)
    # Folders of tests in one of their own: pytest clears away what others have left in the one that all share.
    os.environ.update(ONE_THREAD, PYTHONPATH=str(tree), PYTEST_DEBUG_TEMPROOT=str(told.parent))
    # What is compiled is kept by a digest of its sources, beside the trees: to compile takes a minute.
    os.environ.setdefault("NUMBA_CACHE_DIR", str(tree.parent / "numba"))
    sys.path.insert(0, str(tree))
    plugins: list[object] = [_Writer(told)]
    if question.traced is not None:
        inject = question.traced / "inject"
        for folder in (inject, question.traced / "hits"):
            folder.mkdir(parents=True, exist_ok=True)
        (inject / "sitecustomize.py").write_text(tracing.INJECTED)
        os.environ.update({tracing.FOLDER: str(question.traced / "hits"), "PYTHONPATH": f"{tree}{os.pathsep}{inject}"})
    for name in [name for name in sys.modules if name.partition(".")[0] == "tests"]:
        del sys.modules[name]
    sys.modules["__main__"] = ModuleType("__main__")  # else processes that tests spawn import that of the mutants
    if question.traced is not None:
        plugins.append(importlib.import_module("tests.tools.mutants.tracing").start())
    import pytest

    status = pytest.main([*OPTIONS, *(["-x"] if question.first else []), *question.tests], plugins)
    return int(status)


def load_others() -> None:
    """Import what every question would import again."""
    for name in OTHERS:
        with suppress(ImportError):
            importlib.import_module(name)


def asked(
    questions: Iterable[Question], trees: Sequence[Path], done: Callable[[Question, Answer], None] = lambda *_: None
) -> list[Answer]:
    """The answers in the order of the questions, one process a question and tree; `done` is called as each comes."""
    free, running = list(trees), {}
    answers: dict[int, Answer] = {}
    waiting = list(enumerate(questions))[::-1]
    try:
        while waiting or running:
            while waiting and free:
                number, question = waiting.pop()
                tree = free.pop()
                told = Path(tempfile.mkdtemp(prefix="mutants-")) / "told"
                told.touch()
                right = None
                if question.mistake is not None:
                    right = (tree / question.mistake.file).read_bytes()
                    (tree / question.mistake.file).write_bytes(question.mistake.text(tree))
                process = os.fork()
                if process == 0:
                    os.setsid()
                    status = 70
                    with suppress(BaseException):
                        status = _run(question, tree, told)
                    os._exit(status)
                running[process] = number, question, tree, told, right, time.monotonic()
            for process, (number, question, tree, told, right, began) in list(running.items()):
                ended, status = os.waitpid(process, os.WNOHANG)
                late = time.monotonic() - began > question.limit
                if not ended and not late:
                    continue
                _kill(process, wait=not ended)
                if right is not None and question.mistake is not None:
                    (tree / question.mistake.file).write_bytes(right)
                answers[number] = _answer(told, status if ended else None, question, time.monotonic() - began)
                del running[process]
                free.append(tree)
                done(question, answers[number])
            time.sleep(0.02)
    finally:
        for process in running:
            _kill(process, wait=True)
    return [answers[number] for number in sorted(answers)]


def _kill(process: int, wait: bool) -> None:
    """End a process and what it has started, which are a session."""
    with suppress(ProcessLookupError):
        os.killpg(process, signal.SIGKILL)
    if wait:
        os.waitpid(process, 0)


def _answer(told: Path, status: int | None, question: Question, seconds: float) -> Answer:
    rows = [json.loads(row) for row in told.read_text(encoding="utf-8").splitlines()]
    shutil.rmtree(told.parent, ignore_errors=True)
    end = f"no end within {question.limit:g} s" if status is None else ""
    if status is not None and os.waitstatus_to_exitcode(status) not in (0, 1, 5) and not any(row[1] for row in rows):
        end = f"pytest ended with {os.waitstatus_to_exitcode(status)}"
    return Answer(tuple(dict.fromkeys(test for test, failed in rows if failed)), len(rows), round(seconds, 1), end)
