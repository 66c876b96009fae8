"""Make each deliberate mistake in a copy of the tree, and run the test that the mistake's entry names.
The exit status is 0 if every mistake is noticed or has a reason to survive, else 1.
"""

from __future__ import annotations

import argparse
import compileall
import os
import py_compile
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from tests import ROOT
from tests.tools.mutants.mistakes import BadList, Mutation, read_mistakes

EXCLUDED_FROM_COPY = (".git", ".venv*", "__pycache__", "*.egg-info", ".*_cache", "*.sqlite*", "crosscheck-results")
PYTEST_OPTIONS = ("-q", "-x", "--no-header", "--tb=no", "-rfE", "-p", "no:cacheprovider")
FAST_TESTS = ("-m", "not slow and not crosscheck")
NO_TEST = (4, 5)  # Exit statuses of pytest if no test is collected.
TEST_TIMEOUT = 300.0  # Timeout [s] of one run of pytest.


def copy_tree(folder: Path) -> Path:
    """A copy of the tree with bytecode checked by contents, since a mistake may keep a file's date and size."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*EXCLUDED_FROM_COPY))
    compileall.compile_dir(folder, quiet=2, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    return folder


def run_tests(tree: Path, tests: str) -> tuple[bool, str]:
    """Whether a test failed, and the name of the first failed test, or the reason why no test ran."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    environment["NUMBA_CACHE_DIR"] = str(tree.parent / "numba")
    command = [sys.executable, "-m", "pytest", *PYTEST_OPTIONS, *FAST_TESTS, tests]
    try:
        run = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, timeout=TEST_TIMEOUT)
    except subprocess.TimeoutExpired:
        return True, f"{tests} (not finished within {TEST_TIMEOUT:g} s)"
    if run.returncode in NO_TEST:
        return False, f"{tests}: no such test"
    failed = re.search(r"^(?:FAILED|ERROR) (\S+?)(?:\[.*|$| - .*)", run.stdout, re.MULTILINE)
    return run.returncode != 0, failed[1] if failed else tests


def run_mistake(tree: Path, mistake: Mutation, test: str) -> tuple[bool, str]:
    """Make the mistake in the tree, run the entry's test or file of tests, and restore the source."""
    if not test:
        return False, "no test is named"
    file, wrong = mistake.locate()
    right = (tree / file).read_bytes()
    (tree / file).write_bytes(wrong)
    try:
        return run_tests(tree, test)
    finally:
        (tree / file).write_bytes(right)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.tools.mutants", description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of files, functions or sentences; all without one")
    options = parser.parse_args()
    alive = 0
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        tree = copy_tree(Path(folder) / "tree")
        for mistake in read_mistakes():
            try:
                names = (mistake.locate()[0], mistake.function, mistake.mistake)
            except BadList as reason:
                names = (str(reason),) if not options.only else ()
                alive += bool(names)
                print(*names, sep="\n", flush=True)
                continue
            if mistake.survives or (options.only and not any(n.startswith(w) for n in names for w in options.only)):
                continue
            detected, test = run_mistake(tree, mistake, mistake.noticed_by)
            alive += not detected
            print(f"{'noticed' if detected else 'ALIVE  '} {mistake.mistake} ({names[0]}): {test}", flush=True)
    print(f"{alive} not noticed")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
