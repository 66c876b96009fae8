"""What is published again: a number that says the same as the published one keeps its text, so that a diff shows what
changed and nothing else. Pages are rendered from numbers as they are printed here."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from engines import Promise
from reports.model.cells import Cell, mechanism_of
from reports.model.ending import BadInput
from reports.model.measure import Measurement
from reports.model.quantities import DIGITS, OF, QUANTITIES, agrees
from reports.write.csv_files import IDENTITY, read_lines, told
from reports.write.provenance import machine

ERRORS = (*(quantity.name for quantity in QUANTITIES), *OF)
# Times agree within these factors on one machine: 95 of 100 rows did in two full runs of it, one after the other
# (1.17 of stepping, the least of several runs; 1.74 of building, which is done once).
NOISE = {"cpu": 1.2, "build": 1.8}


@dataclass(frozen=True)
class Published:
    """Rows of errors.csv and timings.csv as texts by column, by what identifies a row; nothing where no file is."""

    rows: Mapping[tuple[str, ...], Mapping[str, str]] = field(default_factory=dict)
    machine: str = ""

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines with rows, in the files' order."""
        return tuple(dict.fromkeys(row["engine"] for row in self.rows.values()))


def read(folder: Path) -> Published:
    """What is published in a folder. Raises BadInput for files that are none of a report."""
    found: dict[tuple[str, ...], dict[str, str]] = {}
    comments: list[str] = []
    for name in ("errors.csv", "timings.csv"):
        if not (folder / name).is_file():
            continue
        remarks, lines = read_lines((folder / name).read_text(encoding="utf-8"))
        comments += remarks
        for row in lines:
            try:
                found.setdefault(tuple(row[each] for each in IDENTITY), {}).update(row)
            except KeyError as column:
                raise BadInput(f"{folder / name} has no column {column}: restore it with git") from None
    return Published(found, comments[1] if len(comments) > 1 else "")


def as_published(rows: Mapping[Cell, Measurement], before: Published) -> dict[Cell, Measurement]:
    """The rows with their numbers as they are printed: those of `before` unless more than rounding or noise differs."""
    same_machine = before.machine == machine()
    return {
        cell: kept(
            row, before.rows.get(tuple(told(row, each) for each in IDENTITY), {}), same_machine, _amplified(cell)
        )
        for cell, row in rows.items()
    }


def kept(row: Measurement, before: Mapping[str, str], same_machine: bool, amplified: float = 1.0) -> Measurement:
    """One row; `before`: the published texts of its columns. Another outcome is another row, of which nothing is kept.

    Times are kept of one machine alone. `amplified` is that of `reports.model.quantities.agrees`.
    """
    if before.get("outcome") != row.outcome:
        before = {}
    same = {
        name: name in before and agrees(name, getattr(row, name), float(before[name]), amplified) for name in ERRORS
    }
    for name, noise in NOISE.items():
        same[name] = same_machine and name in before and near(getattr(row, name), float(before[name]), noise)
    numbers = {name: float(before[name] if yes else f"{getattr(row, name):.{DIGITS}g}") for name, yes in same.items()}
    return replace(row, **numbers, runs=int(before["runs"]) if same["cpu"] else row.runs)


def near(now: float, before: float, factor: float) -> bool:
    """Whether two times are within a factor of each other; no number is near no number."""
    return before / factor <= now <= before * factor or (now != now and before != before)


def _amplified(cell: Cell) -> float:
    order = cell.engine.order(mechanism_of(cell.scene))
    return order.amplified if isinstance(order, Promise) else 1.0
