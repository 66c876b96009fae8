"""One mistake made in a copy of the tree, and what the tests say to it."""

from __future__ import annotations

import compileall
import os
import py_compile
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

from tests.mutants.catalogue import Mutant, faults, wider_tests

LIMIT = 240.0  # s of wall time for the named tests: they take seconds, so what needs more hangs
WIDER_LIMIT = 1200.0  # s for the whole files of a package
LEFT_OUT = (".git", ".venv", "__pycache__", "*.egg-info", ".*_cache", "*.sqlite*", "crosscheck-results")


class Fate(StrEnum):
    """What became of a mistake."""

    CAUGHT = "caught"
    ELSEWHERE = "caught by another test than those named"
    KNOWN = "survived, with a reason"
    SURVIVED = "survived"
    NEEDLESS = "caught, though a reason says that it survives"
    STALE = "not applicable"


GOOD = (Fate.CAUGHT, Fate.KNOWN)


@dataclass(frozen=True)
class Verdict:
    """A mistake's fate, by which test or why, and after how long [s]."""

    mutant: Mutant
    fate: Fate
    by: str
    seconds: float


@dataclass(frozen=True)
class Answer:
    """Whether pytest was content with a run, and if not, which test failed or what happened instead."""

    passed: bool
    by: str = ""


def copy_tree(root: Path, folder: Path) -> Path:
    """A copy in which a changed file is always compiled again: its bytecode goes by contents, not by date and size."""
    shutil.copytree(root, folder, ignore=shutil.ignore_patterns(*LEFT_OUT))
    compileall.compile_dir(folder, quiet=2, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    return folder


_running: set[subprocess.Popen[str]] = set()


def stop() -> None:
    """End the tests that are running: they are in sessions of their own, where an interruption doesn't reach them."""
    for process in tuple(_running):
        os.killpg(process.pid, signal.SIGKILL)


def ask(tree: Path, tests: Sequence[str], limit: float) -> Answer:
    """Run tests in a tree until the first fails; what is not done after `limit` seconds counts as failed."""
    command = [sys.executable, "-m", "pytest", "-x", "-q", "--no-header", "--tb=no", "-rfE", "-p", "no:cacheprovider"]
    one = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    with subprocess.Popen(
        [*command, *tests],
        cwd=tree,
        env={**os.environ, **one, "PYTHONPATH": str(tree)},
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    ) as process:
        _running.add(process)
        try:
            said, _ = process.communicate(timeout=limit)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            return Answer(False, f"no end within {limit:g} s")
        finally:
            _running.discard(process)
    if process.returncode == 0:
        return Answer(True)
    if failed := re.search(r"^(?:FAILED|ERROR) (tests/.+?)(?: - .*)?$", said, re.M):
        return Answer(False, failed[1])
    lines = said.strip().splitlines() or ["it said nothing"]
    return Answer(False, f"pytest ended with {process.returncode}: {lines[-1]}")


def trial(mutant: Mutant, tree: Path) -> Verdict:
    """Make the mistake, ask its tests and, if they are content, the other tests of its package; then take it back."""
    began = time.monotonic()
    path = tree / mutant.file
    if wrong := faults(mutant, tree):
        return Verdict(mutant, Fate.STALE, "; ".join(wrong), 0.0)
    right = path.read_text(encoding="utf-8")
    try:
        path.write_text(mutant.applied(tree), encoding="utf-8")
        answer, fate = ask(tree, mutant.tests, LIMIT), Fate.CAUGHT
        others = [test for test in wider_tests(mutant, tree) if test not in mutant.tests]
        if answer.passed and others and not mutant.survives:
            answer, fate = ask(tree, others, WIDER_LIMIT), Fate.ELSEWHERE
    finally:
        path.write_text(right, encoding="utf-8")
    if answer.passed:
        fate = Fate.KNOWN if mutant.survives else Fate.SURVIVED
    elif mutant.survives:
        fate = Fate.NEEDLESS
    return Verdict(mutant, fate, answer.by or mutant.survives, time.monotonic() - began)
