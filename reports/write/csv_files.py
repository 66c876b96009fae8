"""Rows to the CSV files of a report: errors, timings, and the descriptions that both shorten; and published rows.

What is published again: a number that says the same as the published one keeps its text, so that a diff shows what
changed and nothing else. Pages are rendered from numbers as they are printed here.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, fields, replace
from pathlib import Path

from engines import ConvergenceOrder
from reports.model.cells import Cell, mechanism_of
from reports.model.ending import BadInput
from reports.model.fingerprint import SHORT, digest
from reports.model.measure import TIMINGS, Measurement
from reports.model.quantities import DIGITS, OF, QUANTITIES, agrees
from reports.write.provenance import machine

# The columns that say which row it is.
IDENTITY = ("scene", "engine", "variant", "purpose", "parameters", "settings", "samples", "every", "step")


def as_csv(
    rows: Iterable[Measurement], timings: bool, header: str = "", made_with: Mapping[str, str] | None = None
) -> str:
    """Rows as CSV, sorted: the errors without any timing, or the timings alone; `header` lines become comments.

    Parameters and settings stand as digests, see `descriptions_csv`. Numbers have four digits: what remains after that
    differs with the machine's rounding. `made_with`: by a row's key the versions of all that its numbers depend on,
    which become a last column of digests.
    """
    rest = [f.name for f in fields(Measurement) if f.name not in (*IDENTITY, *TIMINGS, "key", "limit")]
    names = [*IDENTITY, *(TIMINGS if timings else rest)]
    out = io.StringIO()
    out.writelines(f"# {line}\n" for line in header.splitlines())
    writer = csv.writer(out, lineterminator="\n")
    last = [] if made_with is None else ["versions"]
    writer.writerow([*names, *last])
    ordered = sorted(rows, key=lambda row: tuple(getattr(row, name) for name in IDENTITY))
    for row in ordered:
        cells = [told(row, name) for name in names]
        writer.writerow([*cells, *([] if made_with is None else [digest(made_with[row.key], SHORT)])])
    return out.getvalue()


def told(row: Measurement, name: str) -> str:
    """A column of a row as its text."""
    value = getattr(row, name)
    if name in DESCRIPTIONS:
        return digest(value, SHORT)
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else no_formula(str(value))


def no_formula(word: str) -> str:
    """A word as a cell that no spreadsheet works out: with an apostrophe before the sign that begins a formula."""
    return f"'{word}" if word.startswith(("=", "+", "-", "@", "\t", "\r")) else word


def read_lines(text: str) -> tuple[list[str], list[dict[str, str]]]:
    """(the remarks on top, without their sign; the rows by column) of such a file's text."""
    lines = text.splitlines()
    remarks = [line.removeprefix("# ") for line in lines if line.startswith("#")]
    return remarks, list(csv.DictReader(line for line in lines if not line.startswith("#")))


# A scene with its numbers and an engine with its settings are long, and stand in many rows: these give their digests.
DESCRIPTIONS = ("parameters", "settings")


def descriptions_csv(rows: Iterable[Measurement], made_with: Mapping[str, str] | None = None) -> str:
    """What the digests stand for, each once."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["digest", "of", "description"])
    found = {(name, getattr(row, name)) for row in rows for name in DESCRIPTIONS}
    found |= {("versions", told) for told in (made_with or {}).values()}
    writer.writerows([digest(text, SHORT), name, no_formula(text)] for name, text in sorted(found))
    return out.getvalue()


# What tells that the tables and pages of a folder were written together.
DIGESTS = "digests.csv"


def digests_csv(files: Mapping[str, str]) -> str:
    """The digest of each table and page of a report, by its name.

    Pictures are left out, as no number is read from one, and times, as those of an earlier run may stay.
    """
    held = (name for name in files if name.endswith((".csv", ".md")) and name not in (DIGESTS, "timings.csv"))
    told = {name: digest(files[name], SHORT) for name in held}
    return "".join(f"{name},{value}\n" for name, value in [("file", "digest"), *sorted(told.items())])


def not_as_written(folder: Path) -> tuple[str, ...] | None:
    """The tables and pages of a folder that are not, or no longer, those that one report wrote; None if none says."""
    try:
        lines = (folder / DIGESTS).read_text(encoding="utf-8").splitlines()[1:]
    except (OSError, UnicodeDecodeError):
        return None
    told = (line.rpartition(",") for line in lines)
    return tuple(name for name, _, value in told if _digest_of(folder / name) != value)


def _digest_of(path: Path) -> str:
    try:
        return digest(path.read_text(encoding="utf-8"), SHORT)
    except (OSError, UnicodeDecodeError):
        return ""


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


def read_published(folder: Path) -> Published:
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
    return order.amplified if isinstance(order, ConvergenceOrder) else 1.0
