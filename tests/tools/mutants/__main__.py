"""Make each deliberate mistake in a copy of the tree, and run the test that its entry names.

`--renew` looks for a failing test where the entry names none, or one that does not fail: it runs the test files that
use the function's and the module's names, most uses first, and writes the name into physics.toml.
The status is 0 if each mistake was noticed, or survives with a reason; else 1.
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
from tests.tools.mutants.mistakes import LIST, BadList, Mistake, read_mistakes

NOT_COPIED = (".git", ".venv*", "__pycache__", "*.egg-info", ".*_cache", "*.sqlite*", "crosscheck-results")
OPTIONS = ("-q", "-x", "--no-header", "--tb=no", "-rfE", "-p", "no:cacheprovider", "-m", "not slow and not crosscheck")
NO_TEST = (4, 5)  # pytest's status where the name stands for no test
LIMIT = 300.0  # s, for the tests of one file
MOST_FILES = 8  # that --renew runs for a mistake


def copy_tree(folder: Path) -> Path:
    """A copy of the tree whose bytecode is checked by contents, since a mistake may keep the date and the size."""
    shutil.copytree(ROOT, folder, ignore=shutil.ignore_patterns(*NOT_COPIED))
    compileall.compile_dir(folder, quiet=2, invalidation_mode=py_compile.PycInvalidationMode.CHECKED_HASH)
    return folder


def run_tests(tree: Path, tests: str) -> tuple[bool, str]:
    """Whether a test failed, and the first failed test, or the reason for which none ran."""
    environment = {**os.environ, "PYTHONPATH": str(tree), "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    environment["NUMBA_CACHE_DIR"] = str(tree.parent / "numba")
    command = [sys.executable, "-m", "pytest", *OPTIONS, tests]
    try:
        run = subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True, timeout=LIMIT)
    except subprocess.TimeoutExpired:
        return True, f"{tests} (no end within {LIMIT:g} s)"
    if run.returncode in NO_TEST:
        return False, f"{tests}: no such test"
    failed = re.search(r"^(?:FAILED|ERROR) (\S+?)(?:\[.*|$| - .*)", run.stdout, re.MULTILINE)
    return run.returncode != 0, failed[1] if failed else tests


def run_mistake(tree: Path, mistake: Mistake, test: str) -> tuple[bool, str]:
    """Make the mistake in the tree, run the test or the file of tests, and restore the source."""
    if not test:
        return False, "no test is named"
    file, wrong = mistake.locate()
    right = (tree / file).read_bytes()
    (tree / file).write_bytes(wrong)
    try:
        return run_tests(tree, test)
    finally:
        (tree / file).write_bytes(right)


def rank_test_files(mistake: Mistake) -> list[str]:
    """The test files that use the names of the function and of its module, most uses first."""
    file, _ = mistake.locate()
    path = Path(file)
    names = {path.stem, path.parent.name, *mistake.function.rpartition(":")[2].split(".")} - {"", "__init__"}
    counts = {}
    for test in sorted((ROOT / "tests").rglob("test_*.py")):
        text = test.read_text(encoding="utf-8") + test.stem.replace("test_", " ").replace("_", " ")
        hits = sum(min(len(re.findall(rf"\b{re.escape(name.strip('_'))}\b", text)), 9) for name in names)
        counts[test.relative_to(ROOT).as_posix()] = hits + 3 * (path.parts[0] == test.parent.name)
    return sorted(counts, key=lambda name: -counts[name])[:MOST_FILES]


def write_name(mistake: Mistake, test: str) -> None:
    """Write the test's name below the entry's sentence in the list."""
    sentence = f'mistake = "{mistake.mistake}"\n'
    text = LIST.read_text(encoding="utf-8")
    before, _, after = text.partition(sentence)
    after = re.sub(r'\Anoticed_by = ".*"\n', "", after)
    LIST.write_text(f'{before}{sentence}noticed_by = "{test}"\n{after}', encoding="utf-8")


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.tools.mutants", description=__doc__)
    parser.add_argument("only", nargs="*", help="beginnings of files, functions or sentences; all without one")
    parser.add_argument("--renew", action="store_true", help="look for tests where the named one does not fail")
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
            noticed, test = run_mistake(tree, mistake, mistake.noticed_by)
            if not noticed and options.renew:
                for file in rank_test_files(mistake):
                    noticed, test = run_mistake(tree, mistake, file)
                    if noticed and not run_tests(tree, test)[0]:  # the test passes without the mistake
                        write_name(mistake, test)
                        break
                    noticed = False
            alive += not noticed
            print(f"{'noticed' if noticed else 'ALIVE  '} {mistake.mistake} ({names[0]}): {test}", flush=True)
    print(f"{alive} not noticed")
    return 1 if alive else 0


if __name__ == "__main__":
    sys.exit(main())
