"""The atlas as two small files: what became of every cell, and beside it what that cost on which machine."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Iterable
from dataclasses import astuple, dataclass, fields
from pathlib import Path

from reports.model.outcomes import Outcome
from reports.write.csv_files import read_lines

CELLS, COSTS = "atlas.csv", "atlas_timings.csv"
LIKE_THE_LAST = "="  # instead of a letter: it was not run, and lies between two that ended alike
BY_LETTER = {outcome.letter: outcome for outcome in reversed(Outcome)}  # of two that share one, finished


@dataclass(frozen=True)
class Line:
    """A column of a map: one value of a subject's parameter in one method, the largest step first.

    outcomes: a letter a step (`Outcome.letter`, or LIKE_THE_LAST). errors: the power of ten of the angle's error [rad],
    of a cell that was run and finished; NaN else. longest [s]: the largest step; counts: steps of each run. gives [s],
    left: see `column`.
    """

    subject: str
    engine: str
    variant: str
    value: float
    longest: float
    counts: tuple[int, ...]
    outcomes: str
    errors: tuple[float, ...]
    gives: float
    left: float

    @property
    def method(self) -> str:
        return f"{self.engine} {self.variant}"

    @property
    def steps(self) -> tuple[float, ...]:
        """[s]"""
        return tuple(self.longest * self.counts[0] / count for count in self.counts)

    @property
    def told(self) -> tuple[Outcome, ...]:
        found: list[Outcome] = []
        for letter in self.outcomes:
            found.append(found[-1] if letter == LIKE_THE_LAST and found else BY_LETTER[letter])
        return tuple(found)

    @property
    def run(self) -> int:
        """How many of its steps were run."""
        return len(self.outcomes) - self.outcomes.count(LIKE_THE_LAST)


@dataclass(frozen=True)
class Cost:
    """What a subject took in a method: cells, and CPU seconds of all of them."""

    subject: str
    method: str
    cells: int
    seconds: float


@dataclass(frozen=True)
class Costs:
    """Of a whole atlas. made_with: machine and versions. wall [s] and workers of the run; 0 if parts were stored.

    chunks and puts: chunks of a cluster, and stored answers, that the client gets through in a second; NaN where that
    was not measured.
    """

    made_with: str
    wall: float
    workers: int
    chunks: float
    puts: float
    lines: tuple[Cost, ...]

    @property
    def cells(self) -> int:
        return sum(line.cells for line in self.lines)

    @property
    def seconds(self) -> float:
        return sum(line.seconds for line in self.lines)


def power(error: float) -> float:
    """The power of ten of an error, to a tenth; NaN for none."""
    return round(math.log10(error), 1) if math.isfinite(error) and error > 0 else math.nan


def as_csv(lines: Iterable[Line]) -> str:
    """A line a column, sorted; the counts of steps only where they change."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Line)])
    before: tuple[int, ...] = ()
    for line in sorted(lines, key=lambda each: (each.subject, each.engine, each.variant, each.value)):
        counts = "" if line.counts == before else " ".join(map(str, line.counts))
        before = line.counts
        errors = " ".join("-" if math.isnan(each) else f"{each:g}" for each in line.errors)
        numbers = [f"{each:.4g}" for each in (line.value, line.longest, line.gives, line.left)]
        writer.writerow(
            [line.subject, line.engine, line.variant, *numbers[:2], counts, line.outcomes, errors, *numbers[2:]]
        )
    return out.getvalue()


def read(path: Path) -> tuple[Line, ...]:
    """Read such a file; nothing where there is none. Raises ValueError for a file that is none of these."""
    if not path.is_file():
        return ()
    found: list[Line] = []
    before: tuple[int, ...] = ()
    try:
        for row in read_lines(path.read_text(encoding="utf-8"))[1]:
            before = tuple(map(int, row["counts"].split())) or before
            errors = tuple(math.nan if each == "-" else float(each) for each in row["errors"].split())
            line = Line(
                row["subject"],
                row["engine"],
                row["variant"],
                float(row["value"]),
                float(row["longest"]),
                before,
                row["outcomes"],
                errors,
                float(row["gives"]),
                float(row["left"]),
            )
            if not len(line.told) == len(line.counts) == len(errors):
                raise ValueError("a line of another length")
            found.append(line)
    except (KeyError, TypeError, ValueError, AttributeError):
        raise ValueError(f"{path}: it is no atlas; `crosscheck atlas` writes one") from None
    return tuple(found)


def costs_as_csv(costs: Costs) -> str:
    """What was measured once, on top as comments; then a line a subject and method."""
    out = io.StringIO()
    once = {name: getattr(costs, name) for name in ("made_with", "wall", "workers", "chunks", "puts")}
    out.writelines(f"# {name}: {json.dumps(value)}\n" for name, value in once.items())
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Cost)])
    for line in costs.lines:
        writer.writerow([f"{each:.4g}" if isinstance(each, float) else each for each in astuple(line)])
    return out.getvalue()


def read_costs(path: Path) -> Costs | None:
    """Read such a file; None where there is none. Raises ValueError for a file that is none of these."""
    if not path.is_file():
        return None
    try:
        remarks, rows = read_lines(path.read_text(encoding="utf-8"))
        once = dict(remark.split(": ", 1) for remark in remarks)
        lines = tuple(Cost(row["subject"], row["method"], int(row["cells"]), float(row["seconds"])) for row in rows)
        return Costs(**{name: json.loads(value) for name, value in once.items()}, lines=lines)
    except (KeyError, TypeError, ValueError):
        raise ValueError(f"{path}: it is no list of an atlas's costs; `crosscheck atlas` writes one") from None
