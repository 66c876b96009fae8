"""The matrix of mistakes by tests: which tests noticed which mistake, and what that says of the tests."""

from __future__ import annotations

import json
from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tests.tools.mutants.sources import Mistake
from tests.tools.mutants.tracing import Traced
from tests.tools.mutants.trial import Answer, Question, asked

LAYERS = ("reference", "engines", "reports")


@dataclass(frozen=True)
class Row:
    """One mistake: the files of the tests that were asked, how many tests, and those that noticed it."""

    mistake: str
    file: str
    line: int
    files: tuple[str, ...]
    tests: int
    noticed: tuple[str, ...]
    seconds: float
    end: str

    @property
    def caught(self) -> bool:
        return bool(self.noticed or self.end)

    @property
    def by(self) -> set[str]:
        """The files of the tests that noticed it."""
        return {test.partition("::")[0] for test in self.noticed}


def read(path: Path) -> list[Row]:
    """The rows of a file of JSON lines; none if there is no file. The last row of a mistake counts."""
    lines = path.read_text(encoding="utf-8").splitlines() if path.is_file() else []
    rows: dict[str, Row] = {}
    for line in lines:
        fields: dict[str, Any] = json.loads(line)
        fields.update(files=tuple(fields["files"]), noticed=tuple(fields["noticed"]))
        row = Row(**fields)
        rows[row.mistake] = row
    return list(rows.values())


def filled(
    mistakes: Iterable[Mistake],
    traced: Traced,
    path: Path,
    trees: Sequence[Path],
    budget: float,
    first: bool,
    each: int = 3,
) -> None:
    """Ask the likely tests of each mistake, until the first fails or all of them, and append what they said to a file.

    `budget`: for how many seconds of tests, and of a function with parameters `each`. May be interrupted at any time.
    """
    path.parent.mkdir(parents=True, exist_ok=True)

    def keep(question: Question, answer: Answer) -> None:
        mistake = question.mistake
        assert mistake is not None
        files = tuple(dict.fromkeys(test.partition("::")[0] for test in question.tests))
        said = answer.noticed, answer.seconds, answer.end
        row = Row(mistake.name, mistake.file, mistake.line, files, len(question.tests), *said)
        with path.open("a", encoding="utf-8") as file:
            print(json.dumps(asdict(row)), file=file)
        told = f"{len(row.noticed)} of {row.tests}" if row.caught else "GOT THROUGH"
        print(f"{told} ({row.seconds:.0f} s) {row.mistake} {row.end}", flush=True)

    questions = [Question(traced.likely(one, budget, each), one, first, limit=60 + 10 * budget) for one in mistakes]
    for question in questions:
        if not question.tests:
            keep(question, Answer((), 0, 0.0))
    asked([question for question in questions if question.tests], trees, keep)


def functions(tests: Iterable[str]) -> frozenset[str]:
    """Tests without their parameters."""
    return frozenset(test.partition("[")[0] for test in tests)


def alone(rows: Sequence[Row]) -> Mapping[str, list[str]]:
    """Test functions that noticed what no other test did, with those mistakes."""
    out: dict[str, list[str]] = defaultdict(list)
    for row in rows:
        if len(names := functions(row.noticed)) == 1:
            out[next(iter(names))].append(row.mistake)
    return out


def cover(rows: Sequence[Row]) -> list[str]:
    """Few test functions that notice everything that is noticed, the one with most mistakes first."""
    left, out = [functions(row.noticed) for row in rows if row.noticed], []
    while left:
        counts = Counter(name for names in left for name in names)
        out.append(min(counts, key=lambda name: (-counts[name], name)))
        left = [names for names in left if out[-1] not in names]
    return out


def shares(rows: Sequence[Row]) -> list[str]:
    """By layer how many mistakes were caught, then those that got through, as lines of Markdown."""
    lines = ["| layer | mistakes | caught | share |", "| --- | --: | --: | --: |"]
    for layer in LAYERS:
        of = [row for row in rows if row.file.startswith(layer + "/")]
        caught = sum(row.caught for row in of)
        lines.append(f"| {layer} | {len(of)} | {caught} | {caught / len(of) if of else 1:.0%} |")
    through = [f"* {row.mistake} ({row.file}:{row.line}; {row.tests} tests)" for row in rows if not row.caught]
    return [*lines, "", "## Got through", "", *through, ""]


def reading(rows: Sequence[Row], traced: Traced | None = None) -> str:
    """A Markdown document: what was caught, which test functions must stay, and which files have no mistake alone."""
    only, kept = alone(rows), cover(rows)
    lines = ["# Mistakes by tests", "", *shares(rows), "## Test functions that alone notice something: they stay", ""]
    lines += [f"* {name}: {len(what)}, such as {what[0]}" for name, what in sorted(only.items())]
    lines += ["", "## Test files", "", "alone: mistakes that no test of another file noticed.", ""]
    lines += ["| file | asked | noticed | alone |", "| --- | --: | --: | --: |"]
    for file in sorted({file for row in rows for file in row.files}):
        asks, noticed = sum(file in row.files for row in rows), sum(file in row.by for row in rows)
        lines.append(f"| {file} | {asks} | {noticed} | {sum(row.by == {file} for row in rows)} |")
    lines += ["", f"## {len(kept)} test functions notice all that is noticed", "", *(f"* {name}" for name in kept)]
    if traced is not None:
        lines += ["", "## Test functions that run no block which tests of other files don't run", ""]
        lines += [f"* {name}" for name in needless(traced) if name not in only]
    return "\n".join(lines) + "\n"


def needless(traced: Traced) -> list[str]:
    """Test functions of which every block is run by tests of another file too: mistakes there have other witnesses."""
    needed = set()
    for places in traced.runs.values():
        for tests in places.values():
            if len({test.partition("::")[0] for test in tests}) == 1:
                needed |= functions(tests)
    return sorted(functions(traced.seconds) - needed)
