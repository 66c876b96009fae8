"""Make every mistake of the lists, several at a time, and tell which got through.

The status is 0 if every mistake was caught by a test named beside it, or survived with a reason, and no more than a
twentieth did; 1 if not; 2 if the tests fail already without any mistake; 130 after an interruption.
"""

from __future__ import annotations

import argparse
import queue
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor, as_completed
from pathlib import Path
from typing import TypeVar

from tests.mutants.catalogue import ROOT, Mutant, faults, read
from tests.mutants.trial import GOOD, Fate, Verdict, ask, copy_tree, stop, trial

ALLOWED = 0.05  # of the mistakes that were made may survive, each with its reason
BASELINE_LIMIT = 1800.0  # s
TABLE = Path("crosscheck-results") / "mutants.md"

Item = TypeVar("Item")
Result = TypeVar("Result")


def chosen(mutants: Iterable[Mutant], only: Sequence[str]) -> tuple[Mutant, ...]:
    """Those whose name is, or whose file begins with, one of these words; all of them for no word."""
    return tuple(m for m in mutants if not only or any(m.name == word or m.file.startswith(word) for word in only))


def in_trees(
    function: Callable[[Item, Path], Result],
    items: Sequence[Item],
    trees: Sequence[Path],
    done: Callable[[Result], None] = lambda result: None,
) -> list[Result]:
    """The results for all items in their order, each worked on in a tree of its own."""
    free: queue.SimpleQueue[Path] = queue.SimpleQueue()
    for tree in trees:
        free.put(tree)

    def work(item: Item) -> Result:
        tree = free.get()
        try:
            return function(item, tree)
        finally:
            free.put(tree)

    with ThreadPoolExecutor(len(trees)) as pool:
        futures = [pool.submit(work, item) for item in items]
        try:
            for future in as_completed(futures):
                done(future.result())
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            stop()
            raise
    return [future.result() for future in futures]


def table(verdicts: Sequence[Verdict], seconds: float) -> str:
    """All verdicts as a Markdown document: the counts, what is not as it should be, then every mistake."""
    counts = {fate: sum(v.fate is fate for v in verdicts) for fate in Fate}
    lines = ["# Deliberate mistakes", "", f"{len(verdicts)} mistakes in {seconds / 60:.1f} minutes.", ""]
    lines += [f"* {fate}: {count}" for fate, count in counts.items() if count]
    for title, part in (
        ("Not as it should be", [v for v in verdicts if v.fate not in GOOD]),
        ("All", verdicts),
    ):
        if part:
            lines += ["", f"## {title}", "", "| name | file | mistake | fate | by | s |", "| --- " * 5 + "| --: |"]
            lines += [
                f"| {v.mutant.name} | {v.mutant.file} | {v.mutant.mistake} | {v.fate} | {v.by} | {v.seconds:.0f} |"
                for v in part
            ]
    return "\n".join(lines) + "\n"


def main(words: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutants", description=__doc__)
    parser.add_argument("only", nargs="*", help="names of mistakes, or how their files begin; all without one")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument(
        "--skip-baseline", action="store_true", help="don't run the named tests without a mistake first"
    )
    given = parser.parse_args(words)
    mutants = chosen(read(), given.only)
    if not mutants:
        print(f"no mistake is called, and no file begins with, {' or '.join(given.only)}", file=sys.stderr)
        return 2
    began = time.monotonic()
    with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
        trees = [copy_tree(ROOT, Path(folder) / str(number)) for number in range(max(1, given.workers))]
        if not given.skip_baseline:
            tests = sorted({test for mutant in mutants if not faults(mutant, ROOT) for test in mutant.tests})
            parts = [part for part in (tests[n :: len(trees)] for n in range(len(trees))) if part]
            for answer in in_trees(lambda part, tree: ask(tree, part, BASELINE_LIMIT), parts, trees):
                if not answer.passed:
                    print(f"without any mistake, {answer.by} fails already", file=sys.stderr)
                    return 2
            print(f"{len(tests)} named tests pass without a mistake, {time.monotonic() - began:.0f} s", flush=True)

        def tell(verdict: Verdict) -> None:
            print(f"{verdict.fate}: {verdict.mutant.name} ({verdict.seconds:.0f} s) {verdict.by}", flush=True)

        verdicts = in_trees(trial, mutants, trees, tell)
    TABLE.parent.mkdir(exist_ok=True)
    TABLE.write_text(table(verdicts, time.monotonic() - began), encoding="utf-8")
    stale = [v.by for v in verdicts if v.fate is Fate.STALE]
    if stale:
        print("\nnot applicable, as the code has moved:", *stale, sep="\n  ")
    known = sum(v.fate is Fate.KNOWN for v in verdicts)
    wrong = [v for v in verdicts if v.fate not in GOOD]
    print(
        f"\n{len(verdicts)} mistakes, {len(wrong)} not as they should be, {known} survived with a reason; see {TABLE}"
    )
    return 1 if wrong or (known > ALLOWED * len(verdicts) and not given.only) else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
