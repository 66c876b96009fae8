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
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from tests.mutants import by_hand, generated, matrix, trial
from tests.mutants.sources import ROOT, SOURCES, Mistake
from tests.mutants.tracing import SEEN, Traced, digest
from tests.mutants.trial import Answer, Question, asked

KEPT = Path("crosscheck-results") / "mutants"
ALLOWED = 0.05  # of the drawn mistakes may get through: some change nothing that can be seen
FIRST, MORE = 15.0, 150.0  # s of tests that are asked at first, and again by those who notice nothing
APART = ("test_crosscheck.py", "test_mutants.py", "test_site_in_browser.py")  # the grid, this, and what needs a browser


@dataclass(frozen=True)
class Fate:
    """What became of a mistake: "caught", "survived", or "survived, as" with the reason that is written beside it."""

    mistake: Mistake
    fate: str
    by: str
    drawn: bool

    @property
    def wrong(self) -> bool:
        return self.fate == "survived"


def chosen(words: Sequence[str], drawn: int, seed: str) -> list[tuple[Mistake, str]]:
    """The mistakes by hand, each with its reason to survive, then so many drawn ones; those that the words choose."""
    files = [file for file in SOURCES if not words or any(file.startswith(word) for word in words)]
    hand = [(by_hand.found(entry), entry.survives) for entry in by_hand.read()]
    named = [pair for pair in hand if not words or pair[0].file in files or any(w in pair[0].name for w in words)]
    exact = [m for m in generated.drawn(seed) if m.name in words] if any(":" in word for word in words) else []
    return named + [(mistake, "") for mistake in (*exact, *itertools.islice(generated.drawn(seed, files), drawn))]


def traced(workers: int, trees: Sequence[Path], anew: bool = False) -> Traced:
    """The trace that is kept; else, or anew, all fast tests are run for one."""
    folder = KEPT / "trace"
    if anew:
        shutil.rmtree(folder, ignore_errors=True)
    if not (folder / "whole").exists():
        folder.mkdir(parents=True, exist_ok=True)
        (folder / SEEN).write_text(json.dumps({file: digest(file) for file in SOURCES}))
        files = [path.name for path in sorted((ROOT / "tests").glob("test_*.py")) if path.name not in APART]
        questions = [Question((f"tests/{f}",), first=False, limit=900, traced=folder.resolve()) for f in files]

        def tell(question: Question, answer: Answer) -> None:
            print(f"traced {question.tests[0]}: {answer.ran} tests, {answer.seconds:.0f} s {answer.end}", flush=True)

        asked(questions, trees, tell)
        (folder / "whole").touch()
    return Traced(folder)


def tried(mistakes: Sequence[tuple[Mistake, str]], trace: Traced, trees: Sequence[Path]) -> list[Fate]:
    """The fate of each mistake, told as it is known."""
    fates: dict[str, Fate] = {}
    reasons = {mistake.name: reason for mistake, reason in mistakes}

    def tell(question: Question, answer: Answer) -> None:
        mistake = question.mistake
        assert mistake is not None
        reason, by = reasons[mistake.name], next(iter(answer.noticed), answer.end)
        fate = "caught" if by else f"survived, as {reason}" if reason else "survived"
        fates[mistake.name] = Fate(mistake, fate, by, drawn=":" in mistake.name)
        print(f"{fate}: {mistake.name} ({answer.seconds:.0f} s) {by}", flush=True)

    for budget in (FIRST, MORE):
        questions = []
        for mistake, reason in mistakes:
            tests = trace.likely(mistake, budget)
            known = fates.get(mistake.name)
            if tests and (known is None or (known.wrong and not reason)):
                questions.append(Question(tests, mistake, limit=60 + 4 * budget))
            elif not tests and known is None:
                tell(Question((), mistake), Answer((), 0, 0.0))
        asked(questions, trees, tell)
    return list(fates.values())


def report(fates: Sequence[Fate], seconds: float) -> str:
    """All fates as a Markdown document, the survivors first."""
    lines = ["# Deliberate mistakes", "", f"{len(fates)} mistakes in {seconds / 60:.1f} minutes.", ""]
    for title, drawn in (("by hand", False), ("drawn", True)):
        of = [fate for fate in fates if fate.drawn is drawn]
        lines.append(f"* {title}: {len(of)}, of which {sum(fate.fate == 'caught' for fate in of)} caught")
    lines += ["", "| mistake | file | fate | by |", "| --- | --- | --- | --- |"]
    for fate in sorted(fates, key=lambda fate: not fate.wrong):
        lines.append(f"| {fate.mistake.name} | {fate.mistake.file} | {fate.fate} | {fate.by} |")
    return "\n".join(lines) + "\n"


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
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
    began = time.monotonic()
    trial.load_others()
    with tempfile.TemporaryDirectory(prefix="mutants-", ignore_cleanup_errors=True) as folder:
        trees = [trial.copy_tree(ROOT, Path(folder) / str(number)) for number in range(max(1, given.workers))]
        trace = traced(given.workers, trees, anew=given.command == "trace")
        if given.command == "trace":
            return 0
        if given.command == "matrix":
            matrix.filled([mistake for mistake, _ in mistakes], trace, rows, trees, FIRST)
            return 0
        fates = tried(mistakes, trace, trees)
    text = report(fates, time.monotonic() - began)
    KEPT.mkdir(parents=True, exist_ok=True)
    (KEPT / "fates.md").write_text(text, encoding="utf-8")
    drawn = [fate for fate in fates if fate.drawn]
    through = sum(fate.wrong for fate in drawn)
    wrong = [fate for fate in fates if fate.wrong and not fate.drawn]
    print(f"\n{len(wrong)} by hand and {through} of {len(drawn)} drawn got through; see {KEPT / 'fates.md'}")
    return 1 if wrong or through > ALLOWED * len(drawn) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
