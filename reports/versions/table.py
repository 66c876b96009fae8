"""What is kept of columns: one line a scene, method and version, as CSV; the page is written from it alone."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping
from dataclasses import astuple, dataclass, fields, replace
from pathlib import Path
from typing import Any

from reports.model.outcomes import Outcome
from reports.model.quantities import DIGITS, agrees, quantity
from reports.run.installed import numbers
from reports.versions.catalogue import compared_versions
from reports.versions.column import TreesRow, VersionColumn

TREES = "random trees"
ACCELERATION = "acceleration"
WRONG = 0.01  # of the largest acceleration: a tree that is further off is counted
ROUNDING = 1e-3  # of accelerations by a difference over a step: below this are that difference and the solver
TENTH = 0.1  # of a time: what differs by less says nothing, since the machine did other work too
LONGEST = 200  # letters of a sentence


@dataclass(frozen=True)
class Entry:
    """`error` is the largest of the page's quantity (rad or m), of trees that of accelerations (relative)."""

    engine: str
    version: str
    scene: str
    variant: str
    step: float  # s
    quantity: str
    error: float
    outcome: str
    cpu: float  # s per simulated second; NaN of trees
    sentence: str  # why there is no error; of trees how many are wrong

    @property
    def comparable(self) -> bool:
        return Outcome(self.outcome).comparable and not math.isnan(self.error)

    @property
    def rounding(self) -> float:
        """Errors below it are as good as none."""
        return ROUNDING if self.quantity == ACCELERATION else quantity(self.quantity).rounding


def unit(entry: Entry) -> str:
    """Of its error."""
    return "1" if entry.quantity == ACCELERATION else quantity(entry.quantity).unit


@dataclass(frozen=True)
class Table:
    """All entries, and by (engine, version) why its numbers are known to be wrong, or why it can't be used."""

    entries: tuple[Entry, ...]
    marks: Mapping[tuple[str, str], str]

    def versions(self, engine: str) -> tuple[str, ...]:
        """An engine's versions, oldest first."""
        return tuple(sorted({e.version for e in self.entries if e.engine == engine}, key=numbers))

    @property
    def engines(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(entry.engine for entry in self.entries))


def entries(engine: str, column: VersionColumn, quantities: Mapping[str, str]) -> list[Entry]:
    """A column's lines; `quantities`: by which error a scene is compared, the angle's unless it is given."""
    out = []
    for row in column.rows:
        name = quantities.get(row.scene, "angle")
        usable = Outcome(row.outcome).comparable
        error = getattr(row, name) if usable else math.nan
        sentence = "" if usable else _short(row.sentence)
        out.append(
            Entry(engine, column.version, row.scene, row.variant, row.step, name, error, row.outcome, row.cpu, sentence)
        )
    for trees in column.trees:
        out.append(_of_trees(engine, column.version, trees))
    return out


def _short(sentence: str) -> str:
    return " ".join(sentence.split())[:LONGEST]


def _of_trees(engine: str, version: str, trees: TreesRow) -> Entry:
    scene = f"{TREES} ({trees.bodies} bodies, {trees.loops} loops)"
    wrong = sum(not miss <= WRONG for miss in trees.miss)
    told = (
        f"{wrong} of {len(trees.miss)} by more than {WRONG:g}"
        if trees.miss
        else " ".join(trees.sentence.split())[:LONGEST]
    )
    outcome = Outcome.UNSUPPORTED if "Error: " in trees.sentence else trees.outcome
    largest = max((math.inf if math.isnan(miss) else miss for miss in trees.miss), default=math.nan)
    return Entry(engine, version, scene, trees.variant, math.nan, ACCELERATION, largest, outcome, math.nan, told)


def as_csv(table: Table) -> str:
    """The file: marks as comments on top, then a line an entry, sorted."""
    out = io.StringIO()
    for (engine, version), mark in table.marks.items():
        out.write(f"# {engine} {version}: {mark}\n")
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Entry)])
    for entry in sorted(table.entries, key=_place):
        writer.writerow([_cell(value) for value in astuple(entry)])
    return out.getvalue()


def _place(entry: Entry) -> tuple[object, ...]:
    return entry.engine, entry.scene, entry.variant, numbers(entry.version)


def _cell(value: object) -> str:
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else str(value)


def read(path: Path) -> Table:
    """Read such a file; an empty table where there is none. Raises ValueError for a file that is none of these."""
    if not path.is_file():
        return Table((), {})
    lines = path.read_text(encoding="utf-8").splitlines()
    marks: dict[tuple[str, str], str] = {}
    for line in lines:
        if line.startswith("# "):
            engine, version, mark = line[2:].split(" ", 2)
            marks[engine, version.removesuffix(":")] = mark
    rows = csv.DictReader(line for line in lines if not line.startswith("#"))
    try:
        found = tuple(
            Entry(**{field.name: _value(row[field.name], field.type) for field in fields(Entry)}) for row in rows
        )
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path}: it is no table of versions; `crosscheck versions --all` writes one") from None
    return Table(found, marks)


def as_published(table: Table, before: Table) -> Table:
    """The lines, with the numbers of `before` where the new ones differ by rounding, or a time by less than TENTH."""
    known = {_place(entry): entry for entry in before.entries}
    return Table(tuple(_as_published(entry, known.get(_place(entry), entry)) for entry in table.entries), table.marks)


def _as_published(now: Entry, before: Entry) -> Entry:
    if (now.outcome, _cell(now.step)) != (before.outcome, _cell(before.step)):
        return now
    if now.quantity == ACCELERATION:
        same = _cell(now.error) == _cell(before.error)
    else:
        same = agrees(now.quantity, now.error, before.error)
    cpu = before.cpu if abs(now.cpu - before.cpu) < TENTH * before.cpu else now.cpu
    return replace(now, error=before.error if same else now.error, cpu=cpu)


def _value(text: str, kind: object) -> Any:
    return float(text) if kind == "float" else text


def catalogued(table: Table) -> Table:
    """The lines of releases that are compared by now, and of engines of which none is named."""
    known = compared_versions()

    def there(engine: str, version: str) -> bool:
        return version in known.get(engine, (version,))

    marks = {key: mark for key, mark in table.marks.items() if there(*key)}
    return Table(tuple(entry for entry in table.entries if there(entry.engine, entry.version)), marks)


def merged(old: Table, new: Table) -> Table:
    """The new lines, and the old ones of other versions."""
    renewed = {(entry.engine, entry.version) for entry in new.entries}
    kept = tuple(entry for entry in old.entries if (entry.engine, entry.version) not in renewed)
    marks = {key: mark for key, mark in old.marks.items() if key not in renewed}
    return Table((*kept, *new.entries), {**marks, **new.marks})
