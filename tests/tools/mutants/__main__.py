"""The commands.

The status of `run` is 0 if every mistake by hand was caught, or survives with a reason, and nineteen of twenty drawn
ones were; else 1. It is 2 for bad words, and 130 after an interruption.
"""

from __future__ import annotations

import argparse
import itertools
import json
import shutil
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from tests.tools.mutants import by_hand, generated, matrix, trial
from tests.tools.mutants.sources import ROOT, SOURCES, Mistake
from tests.tools.mutants.tracing import SEEN, Traced, digest
from tests.tools.mutants.trial import Answer, Question, asked

KEPT = Path("crosscheck-results") / "mutants"
ALLOWED = 0.05  # of the drawn mistakes may get through: some change nothing that can be seen
FIRST, MORE = 15.0, 150.0  # s of tests that are asked at first, and again by those who notice nothing
APART = ("test_crosscheck.py", "test_mutants.py", "test_site_in_browser.py")  # the grid, this, and what needs a browser


def chosen(words: Sequence[str], drawn: int, seed: str) -> list[tuple[Mistake, str]]:
    """The mistakes by hand, each with its reason to survive, then so many drawn ones; those that the words choose."""
    files = [file for file in SOURCES if not words or any(file.startswith(word) for word in words)]
    hand = [(by_hand.found(entry), entry.survives) for entry in by_hand.read()]
    named = [pair for pair in hand if not words or pair[0].file in files or any(w in pair[0].name for w in words)]
    exact = [m for m in generated.drawn(seed) if m.name in words] if any(":" in word for word in words) else []
    return named + [(mistake, "") for mistake in (*exact, *itertools.islice(generated.drawn(seed, files), drawn))]


def traced(trees: Sequence[Path], anew: bool = False) -> Traced:
    """The trace that is kept; else, or anew, all fast tests are run for one."""
    folder = KEPT / "trace"
    if anew:
        shutil.rmtree(folder, ignore_errors=True)
    if not (folder / "whole").exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / SEEN).write_text(json.dumps({file: digest(file) for file in SOURCES}))
        paths = [path for path in sorted((ROOT / "tests").rglob("test_*.py")) if path.name not in APART]
        files = [path.relative_to(ROOT).as_posix() for path in paths]
        questions = [Question((file,), first=False, limit=900, traced=folder.resolve()) for file in files]

        def tell(question: Question, answer: Answer) -> None:
            print(f"traced {question.tests[0]}: {answer.ran} tests, {answer.seconds:.0f} s {answer.end}", flush=True)

        asked(questions, trees, tell)
        (folder / "whole").touch()
    return Traced(folder)


def tried(mistakes: Sequence[tuple[Mistake, str]], trace: Traced, trees: Sequence[Path]) -> int:
    """Ask about every mistake, twice where nothing is noticed; write the report, and give the status."""
    fates = KEPT / "fates.jsonl"
    fates.unlink(missing_ok=True)
    reasons = {mistake.name: reason for mistake, reason in mistakes if reason}
    matrix.filled([mistake for mistake, _ in mistakes], trace, fates, trees, FIRST, first=True)
    through = {row.mistake for row in matrix.read(fates) if not row.caught and row.tests} - set(reasons)
    matrix.filled([m for m, _ in mistakes if m.name in through], trace, fates, trees, MORE, first=True, each=1000)
    rows = matrix.read(fates)
    by_rule = {row.mistake: not row.caught for row in rows if ":" in row.mistake}
    wrong = [row for row in rows if not row.caught and row.mistake not in {*by_rule, *reasons}]
    text = "\n".join(["# Deliberate mistakes", "", *matrix.shares(rows)])
    (KEPT / "fates.md").write_text(text, encoding="utf-8")
    told = f"{len(wrong)} by hand and {sum(by_rule.values())} of {len(by_rule)} drawn got through"
    print(f"\n{told}; see {KEPT / 'fates.md'}")
    return 1 if wrong or sum(by_rule.values()) > ALLOWED * len(by_rule) else 0


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.tools.mutants", description=__doc__)
    parser.add_argument("command", choices=("run", "matrix", "read", "list", "trace"))
    parser.add_argument("only", nargs="*", help="names of mistakes, or how their files begin; all without one")
    parser.add_argument("--drawn", type=int, default=300, help="how many generated mistakes")
    parser.add_argument("--seed", default="0", help="what draws them")
    parser.add_argument("--workers", type=int, default=2)
    given = parser.parse_args(words)
    rows = KEPT / "matrix.jsonl"
    if given.command == "read":
        trace = Traced(KEPT / "trace") if (KEPT / "trace" / "whole").exists() else None
        print(matrix.reading(matrix.read(rows), trace))
        return 0
    mistakes = chosen(given.only, given.drawn, given.seed)
    if not mistakes:
        print(f"no mistake is called, and no file begins with, {' or '.join(given.only)}", file=sys.stderr)
        return 2
    if given.command == "list":
        print(*(mistake for mistake, _ in mistakes), sep="\n")
        return 0
    trial.load_others()
    with tempfile.TemporaryDirectory(prefix="mutants-", ignore_cleanup_errors=True) as folder:
        trees = [trial.copy_tree(ROOT, Path(folder) / str(number)) for number in range(max(1, given.workers))]
        trace = traced(trees, anew=given.command == "trace")
        if given.command == "trace":
            return 0
        if given.command == "run":
            return tried(mistakes, trace, trees)
        known = {row.mistake for row in matrix.read(rows)}
        left = [mistake for mistake, _ in mistakes if mistake.name not in known]
        matrix.filled(left, trace, rows, trees, FIRST, first=False)
        return 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
