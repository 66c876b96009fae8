"""The table of released versions, with an entry for each scene, method and version, and the changes of versions."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from statistics import median
from typing import Any

from reports.gate.change import WORSE
from reports.model.outcomes import Outcome
from reports.model.quantities import DIGITS, agrees, quantity
from reports.model.tasks import Answer
from reports.run.installed import numbers
from reports.versions.column import VersionColumn
from reports.versions.trees import Trees
from reports.write.csv_files import read_records, records_csv
from reports.write.unmeasured import UNMEASURED

DATA = Path(__file__).parents[1] / "results" / "versions.csv"
ACCELERATION = "acceleration"
WRONG_TREE = 0.01  # A tree counts as wrong if its relative error of accelerations is larger.
# Smaller relative errors of accelerations may be due to the finite difference and the solver.
ACCELERATION_ROUNDING = 1e-3
SAME_COST = 0.1  # A smaller relative difference of two CPU times counts as noise.
LONGEST_SENTENCE = 200  # characters.
# Engine -> version -> "changed" and "source" of a known change, if there is one.
RELEASES: Mapping[str, Mapping[str, Mapping[str, str]]] = tomllib.loads(
    Path(__file__).with_name("releases.toml").read_text(encoding="utf-8")
)
COST_ROSE_IN = "3.3.1"  # Since this release of MuJoCo a step with default settings needs more CPU time than in 3.3.0.


def changes_between(engine: str, before: str, after: str) -> list[Mapping[str, str]]:
    """The known changes after the version `before`, up to and including `after`."""
    releases = RELEASES.get(engine, {}).items()
    return [known for version, known in releases if known and numbers(before) < numbers(version) <= numbers(after)]


@dataclass(frozen=True)
class Entry:
    engine: str
    version: str
    scene: str
    variant: str
    step: float  # s
    quantity: str
    error: float  # Largest error of `quantity`, or NaN without a motion. In random trees the error is relative.
    outcome: str
    cpu: float  # CPU seconds per simulated second, or NaN for random trees.
    sentence: str  # The reason for a missing error, or the number of wrong trees.

    @property
    def comparable(self) -> bool:
        return Outcome(self.outcome).comparable and not math.isnan(self.error)

    @property
    def is_supported(self) -> bool:
        return Outcome(self.outcome) not in (Outcome.UNSUPPORTED, Outcome.LOST)

    @property
    def unit(self) -> str:
        return "1" if self.quantity == ACCELERATION else quantity(self.quantity).unit

    @property
    def size(self) -> float:
        """The larger one of the error and the rounding error of the quantity, or infinity without an error."""
        rounding = ACCELERATION_ROUNDING if self.quantity == ACCELERATION else quantity(self.quantity).rounding
        return max(self.error, rounding) if self.comparable else math.inf

    @property
    def identity(self) -> tuple[Any, ...]:
        return self.engine, self.scene, self.variant, numbers(self.version)


@dataclass(frozen=True)
class ReleaseTable:
    entries: tuple[Entry, ...]
    marks: Mapping[tuple[str, str], str]  # (engine, version) -> why the version is wrong or can't be used.

    @property
    def engines(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(entry.engine for entry in self.entries))

    def versions(self, engine: str) -> tuple[str, ...]:
        return tuple(sorted({entry.version for entry in self.of(engine)}, key=numbers))

    def of(self, engine: str) -> list[Entry]:
        return [entry for entry in self.entries if entry.engine == engine]


def entries(engine: str, column: VersionColumn, quantities: Mapping[str, str]) -> list[Entry]:
    """The entries of a version. quantities: scene -> compared quantity. For other scenes the angle is compared."""
    out = []
    for row in column.rows:
        name = quantities.get(row.scene, "angle")
        usable = Outcome(row.outcome).comparable
        error, sentence = (getattr(row, name), "") if usable else (math.nan, _shortened(row.sentence))
        method = (row.scene, row.variant, row.step, name)
        out.append(Entry(engine, column.version, *method, error, row.outcome, row.cpu, sentence))
    return out + [_entry_of_trees(engine, column.version, trees, answer) for trees, answer in column.trees]


def _shortened(sentence: str) -> str:
    return " ".join(sentence.split())[:LONGEST_SENTENCE]


def _entry_of_trees(engine: str, version: str, trees: Trees, answer: Answer) -> Entry:
    error, sentence = math.nan, _shortened(answer.sentence)
    if answer.finished:
        misses = answer.array("miss")
        wrong = sum(not miss <= WRONG_TREE for miss in misses)
        error = max((math.inf if math.isnan(miss) else float(miss) for miss in misses), default=math.nan)
        sentence = f"{wrong} of {len(misses)} by more than {WRONG_TREE:g}"
    scene = f"random trees ({trees.bodies} bodies, {trees.loops} loops)"
    method = (scene, trees.method.variant, math.nan, ACCELERATION)
    return Entry(engine, version, *method, error, answer.outcome, math.nan, sentence)


def wrong_trees(entry: Entry) -> tuple[int, int]:
    """The numbers of wrong and of all random trees, which the sentence states; zeros without motions."""
    words = entry.sentence.split()
    return (int(words[0]), int(words[2])) if entry.comparable else (0, 0)


def as_csv(table: ReleaseTable) -> str:
    """The table as CSV. The marks are comments, and the sorted entries follow."""
    marks = (f"{engine} {version}: {mark}" for (engine, version), mark in table.marks.items())
    return records_csv(Entry, sorted(table.entries, key=lambda entry: entry.identity), marks)


def read(path: Path) -> ReleaseTable:
    """Read the output of `as_csv`. If the file does not exist, the table is empty. Raises ValueError."""
    if not path.is_file():
        return ReleaseTable((), {})
    try:
        comments, rows = read_records(Entry, path.read_text(encoding="utf-8"))
    except ValueError:
        raise ValueError(f"{path}: it is no table of versions; `crosscheck versions --all` writes one") from None
    heads = [comment.partition(": ") for comment in comments]
    return ReleaseTable(rows, {(name.split(" ")[0], name.split(" ")[-1]): mark for name, _, mark in heads})


@cache
def released(path: Path = DATA) -> ReleaseTable:
    """The table in a file, by default the published table. Versions that are not in RELEASES are left out."""
    table = read(path)

    def is_listed(engine: str, version: str) -> bool:
        return version in RELEASES.get(engine, (version,))

    listed = tuple(entry for entry in table.entries if is_listed(entry.engine, entry.version))
    return ReleaseTable(listed, {key: mark for key, mark in table.marks.items() if is_listed(*key)})


def error_before_term() -> float:
    """The error of MuJoCo's documented settings in 3.6.0, the last release that omits the velocity term of loops, or
    UNMEASURED."""
    wanted = ("3.6.0", "free_four_bar", "tuned")
    entries = released().of("mujoco")
    return next((e.error for e in entries if (e.version, e.scene, e.variant) == wanted), UNMEASURED)


def merged(old: ReleaseTable, new: ReleaseTable) -> ReleaseTable:
    """The new entries, and the old entries of versions without new entries."""
    renewed = {(entry.engine, entry.version) for entry in new.entries}
    remaining = tuple(entry for entry in old.entries if (entry.engine, entry.version) not in renewed)
    marks = {key: mark for key, mark in old.marks.items() if key not in renewed}
    return ReleaseTable((*remaining, *new.entries), {**marks, **new.marks})


def as_published(table: ReleaseTable, before: ReleaseTable) -> ReleaseTable:
    """The entries of `table`. A number that differs from `before` only by rounding or noise is taken from `before`."""
    published = {(*entry.identity, entry.outcome, f"{entry.step:.{DIGITS}g}"): entry for entry in before.entries}

    def kept(now: Entry) -> Entry:
        earlier = published.get((*now.identity, now.outcome, f"{now.step:.{DIGITS}g}"), now)
        same = f"{now.error:.{DIGITS}g}" == f"{earlier.error:.{DIGITS}g}"
        same = same if now.quantity == ACCELERATION else agrees(now.quantity, now.error, earlier.error)
        cpu = earlier.cpu if abs(now.cpu - earlier.cpu) < SAME_COST * earlier.cpu else now.cpu
        return replace(now, error=earlier.error if same else now.error, cpu=cpu)

    return ReleaseTable(tuple(map(kept, table.entries)), table.marks)


def change(before: Entry, after: Entry) -> str:
    """The change between two versions, or an empty text. "better" and "WORSE" mean a factor of more than three. "other"
    means two different outcomes without an error."""
    small, large = sorted((before.size, after.size))
    if small < large and (math.isinf(large) or large > WORSE * small):
        return "WORSE" if after.size > before.size else "better"
    return "" if before.comparable or before.outcome == after.outcome else "other"


def changes(entries: Iterable[Entry]) -> list[tuple[Entry, Entry, str]]:
    """(before, after, `change`) of successive versions that differ, for each scene and method. A version that does not
    support the scene is left out."""
    lines: dict[tuple[Any, ...], list[Entry]] = {}
    for entry in sorted(entries, key=lambda entry: entry.identity):
        if entry.is_supported:
            lines.setdefault(entry.identity[:3], []).append(entry)
    pairs = [pair for line in lines.values() for pair in pairwise(line)]
    return [(earlier, later, text) for earlier, later in pairs if (text := change(earlier, later))]


def relative_cost(entries: Iterable[Entry], versions: Sequence[str], variant: str) -> dict[str, float]:
    """Version -> median ratio of CPU times to the newest version, in scenes that both versions have completed."""
    timed = [entry for entry in entries if entry.variant == variant and entry.comparable and entry.cpu > 0]
    newest = {entry.scene: entry.cpu for entry in timed if entry.version == versions[-1]}
    ratios: dict[str, list[float]] = {version: [] for version in versions}
    for entry in timed:
        if entry.scene in newest:
            ratios[entry.version].append(entry.cpu / newest[entry.scene])
    return {version: median(values) for version, values in ratios.items() if values}
