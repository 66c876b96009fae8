"""The table of the judge's cost against that of other engines, as `crosscheck bench peers` stores it."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from reports.model.ending import BadInput
from reports.write.csv_files import read_records, records_csv
from reports.write.tables import DASH, number

FILE = "speed.csv"
RESULTS = Path(__file__).parents[2] / "results"
JUDGE = "lagrange"
ONE_COORDINATE = "one coordinate"
# UNSUPPORTED is a word of stored files. A page says that the adapter does not build the scene.
REACHED, UNREACHED, UNSUPPORTED, ABSENT = "reached", "not reached", "no such joint", "not installed"
SAME_FACTS = ("machine", "versions", "budget")  # of rows that may be in one table
NOT_MEASURED = "not measured"  # the fact with the scenes that are missing
# The judge should be this many times cheaper than engines, and within this factor of the solution in one coordinate.
WANTED_AHEAD, WANTED_WITHIN = 5.0, 2.0


@dataclass(frozen=True)
class SpeedRow:
    """The cheapest setting of an engine that reaches an error in a scene.

    target: the largest allowed error of an angle [rad].
    outcome: REACHED, UNREACHED, UNSUPPORTED or ABSENT.
    setting: the method with its step or tolerance. If the outcome is UNREACHED, it is the setting with the least error.
    error: the largest angle error [rad] of this setting.
    seconds: CPU time [s] of the motion. If the outcome is UNREACHED, it is that of the most expensive run.
    judge_seconds: CPU time [s] of the judge, timed in turn with the engine; NaN if the judge does not reach the error.
    note: why there is no number.
    """

    scene: str
    engine: str
    target: float
    outcome: str
    setting: str = ""
    error: float = math.nan
    seconds: float = math.nan
    judge_seconds: float = math.nan
    note: str = ""

    @property
    def ratio(self) -> float:
        """The CPU time of the engine over that of the judge, which is a lower bound if the error is not reached."""
        return self.seconds / self.judge_seconds

    @property
    def words(self) -> str:
        """The ratio as text, such as '12', or '> 300' if the engine does not reach the error within its budget."""
        if self.outcome in (UNSUPPORTED, ABSENT):
            return "not built" if self.outcome == UNSUPPORTED else ABSENT
        if math.isnan(self.ratio):
            return DASH
        return ("> " if self.outcome == UNREACHED else "") + number(self.ratio)

    @property
    def is_behind(self) -> bool:
        """Whether the judge misses its aim in this cell."""
        if self.engine == ONE_COORDINATE:
            return self.outcome == REACHED and self.ratio < 1 / WANTED_WITHIN
        is_bounded = self.outcome in (REACHED, UNREACHED)
        return self.engine != JUDGE and is_bounded and self.ratio < WANTED_AHEAD


@dataclass(frozen=True)
class SpeedTable:
    """Rows, and `facts`: name -> text about the run, such as the date, the processor and the roofline's numbers."""

    rows: tuple[SpeedRow, ...]
    facts: Mapping[str, str] = field(default_factory=dict)

    @property
    def scenes(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.scene for row in self.rows))

    @property
    def engines(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row.engine for row in self.rows if row.engine != JUDGE))

    @property
    def targets(self) -> tuple[float, ...]:
        return tuple(sorted({row.target for row in self.rows}, reverse=True))

    def at(self, scene: str, engine: str, target: float) -> SpeedRow | None:
        by_place = {(row.scene, row.engine, row.target): row for row in self.rows}
        return by_place.get((scene, engine, target))

    def lines(self, target: float) -> list[list[str]]:
        """For each scene its name, the judge's CPU time [ms], and the ratio of each engine."""
        body = []
        for scene in self.scenes:
            judge = self.at(scene, JUDGE, target)
            reached = judge is not None and judge.outcome == REACHED
            cost = number(1e3 * judge.seconds) if judge is not None and reached else UNREACHED
            found = [self.at(scene, engine, target) for engine in self.engines]
            body.append([scene, cost, *(DASH if row is None else row.words for row in found)])
        return body

    @property
    def header(self) -> Sequence[str]:
        return "scene", "judge [ms]", *self.engines

    def with_rows_of(self, other: SpeedTable) -> SpeedTable:
        """The table with the rows of a table that has the same processor, versions and budget."""
        same = all(other.facts.get(name) == self.facts.get(name) for name in SAME_FACTS)
        return replace(self, rows=other.rows) if same else self

    def with_new(self, rows: Sequence[SpeedRow], scenes: Sequence[str], engines: Sequence[str]) -> SpeedTable:
        """The table with rows in the place of those of the same scene and engine, in the order of `scenes` and
        `engines`."""
        replaced = {(row.scene, row.engine) for row in rows}
        kept = [row for row in self.rows if (row.scene, row.engine) not in replaced]

        def place(row: SpeedRow) -> tuple[int, int]:
            return scenes.index(row.scene), engines.index(row.engine)

        found = tuple(sorted([*kept, *rows], key=place))
        missing = ", ".join(scene for scene in scenes if scene not in {row.scene for row in found})
        facts = {name: text for name, text in self.facts.items() if name != NOT_MEASURED}
        return SpeedTable(found, facts | ({NOT_MEASURED: missing} if missing else {}))

    def number(self, name: str) -> float:
        """A fact as a number, or NaN if it is missing."""
        return float(self.facts.get(name, "nan"))


def as_csv(table: SpeedTable) -> str:
    """The text of the file: comments with the facts, then the rows."""
    return records_csv(SpeedRow, table.rows, (f"{name}: {text}" for name, text in table.facts.items()))


def read(path: Path = RESULTS / FILE) -> SpeedTable:
    """The stored table, which is empty if the file does not exist. Raises BadInput for another file."""
    if not path.is_file():
        return SpeedTable(())
    try:
        comments, rows = read_records(SpeedRow, path.read_text(encoding="utf-8"))
    except ValueError:  # also for bytes that are no text
        raise BadInput(f"{path}: not a file {FILE}: `crosscheck bench peers` writes one") from None
    return SpeedTable(rows, dict(comment.split(": ", 1) for comment in comments if ": " in comment))
