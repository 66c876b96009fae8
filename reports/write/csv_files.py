"""The CSV files of a report: errors, timings, and the descriptions that both replace by digests; and published rows.

A number that agrees with the published one within rounding keeps its published text, so that a diff shows real changes
only. Pages are rendered from the numbers as these files have them.
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

# The columns that identify a row.
IDENTITY_COLUMNS = ("scene", "engine", "variant", "purpose", "parameters", "settings", "samples", "every", "step")


def as_csv(
    rows: Iterable[Measurement], timings: bool, header: str = "", made_with: Mapping[str, str] | None = None
) -> str:
    """Sorted rows as CSV: the errors without timings, or the timings alone; `header` lines become comments.

    Parameters and settings are digests (see `descriptions_csv`). Numbers have DIGITS digits: further ones depend on the
    machine's rounding. `made_with`: the versions of all packages that a row depends on, by the row's key; their digests
    become a last column.
    """
    rest = [f.name for f in fields(Measurement) if f.name not in (*IDENTITY_COLUMNS, *TIMINGS, "key", "limit")]
    names = [*IDENTITY_COLUMNS, *(TIMINGS if timings else rest)]
    out = io.StringIO()
    out.writelines(f"# {line}\n" for line in header.splitlines())
    writer = csv.writer(out, lineterminator="\n")
    last = [] if made_with is None else ["versions"]
    writer.writerow([*names, *last])
    ordered = sorted(rows, key=lambda row: tuple(getattr(row, name) for name in IDENTITY_COLUMNS))
    for row in ordered:
        cells = [cell_text(row, name) for name in names]
        writer.writerow([*cells, *([] if made_with is None else [digest(made_with[row.key], SHORT)])])
    return out.getvalue()


def cell_text(row: Measurement, name: str) -> str:
    """The text of a row in a column."""
    value = getattr(row, name)
    if name in DESCRIPTION_COLUMNS:
        return digest(value, SHORT)
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else no_formula(str(value))


def no_formula(text: str) -> str:
    """The text with an apostrophe before a sign by which a spreadsheet would take it for a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def read_lines(text: str) -> tuple[list[str], list[dict[str, str]]]:
    """(comments, without their sign; rows by column) from the text of such a file."""
    lines = text.splitlines()
    comments = [line.removeprefix("# ") for line in lines if line.startswith("#")]
    return comments, list(csv.DictReader(line for line in lines if not line.startswith("#")))


# Long texts that many rows share; the files have their digests.
DESCRIPTION_COLUMNS = ("parameters", "settings")


def descriptions_csv(rows: Iterable[Measurement], made_with: Mapping[str, str] | None = None) -> str:
    """The text of each digest."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["digest", "of", "description"])
    described = {(name, getattr(row, name)) for row in rows for name in DESCRIPTION_COLUMNS}
    described |= {("versions", versions) for versions in (made_with or {}).values()}
    writer.writerows([digest(text, SHORT), name, no_formula(text)] for name, text in sorted(described))
    return out.getvalue()


# The file with the digests of all tables and pages that one report wrote.
DIGESTS = "digests.csv"


def digests_csv(files: Mapping[str, str]) -> str:
    """The digest of each table and page of a report.

    Pictures are left out, because no number is read from them; timings too, because those of an earlier run may remain.
    """
    names = sorted(name for name in files if name.endswith((".csv", ".md")) and name not in (DIGESTS, "timings.csv"))
    return "".join(["file,digest\n", *(f"{name},{digest(files[name], SHORT)}\n" for name in names)])


def not_as_written(folder: Path) -> tuple[str, ...] | None:
    """The tables and pages of a folder that changed since one report wrote them; None without a file of digests."""
    try:
        lines = (folder / DIGESTS).read_text(encoding="utf-8").splitlines()[1:]
    except (OSError, UnicodeDecodeError):
        return None
    written = (line.rpartition(",") for line in lines)
    return tuple(name for name, _, value in written if _digest_of(folder / name) != value)


def _digest_of(path: Path) -> str:
    try:
        return digest(path.read_text(encoding="utf-8"), SHORT)
    except (OSError, UnicodeDecodeError):
        return ""


ERROR_COLUMNS = (*(quantity.name for quantity in QUANTITIES), *OF)
# Factors within which times agree on one machine. In two full runs one after the other, 95 of 100 rows agreed within
# 1.17 (stepping: the least of several runs) and 1.74 (building, which is done once).
TIMING_NOISE = {"cpu": 1.2, "build": 1.8}


@dataclass(frozen=True)
class Published:
    """The texts of errors.csv and timings.csv: column -> text, by the row's identity; empty without files."""

    rows: Mapping[tuple[str, ...], Mapping[str, str]] = field(default_factory=dict)
    machine: str = ""

    @property
    def engines(self) -> tuple[str, ...]:
        """The engines with rows, in the order of the files."""
        return tuple(dict.fromkeys(row["engine"] for row in self.rows.values()))


def read_published(folder: Path) -> Published:
    """The published rows of a folder. Raises BadInput for files that no report wrote."""
    rows: dict[tuple[str, ...], dict[str, str]] = {}
    comments: list[str] = []
    for name in ("errors.csv", "timings.csv"):
        if not (folder / name).is_file():
            continue
        file_comments, lines = read_lines((folder / name).read_text(encoding="utf-8"))
        comments += file_comments
        for row in lines:
            try:
                rows.setdefault(tuple(row[column] for column in IDENTITY_COLUMNS), {}).update(row)
            except KeyError as missing:
                raise BadInput(f"{folder / name} has no column {missing}: restore it with git") from None
    return Published(rows, comments[1] if len(comments) > 1 else "")


def as_published(rows: Mapping[Cell, Measurement], before: Published) -> dict[Cell, Measurement]:
    """The rows with their numbers as printed: the published ones, unless more than rounding or timing noise differs."""
    same_machine = before.machine == machine()
    published: dict[Cell, Measurement] = {}
    for cell, row in rows.items():
        identity = tuple(cell_text(row, column) for column in IDENTITY_COLUMNS)
        published[cell] = with_published_numbers(row, before.rows.get(identity, {}), same_machine, _amplified(cell))
    return published


def with_published_numbers(
    row: Measurement, before: Mapping[str, str], same_machine: bool, amplified: float = 1.0
) -> Measurement:
    """One row with the published numbers that it confirms.

    Args:
        before: the published texts by column; they are ignored if the outcome differs.
        same_machine: whether times can be compared.
        amplified: rounding of the method, relative to usual rounding (`reports.model.quantities.agrees`).
    """
    if before.get("outcome") != row.outcome:
        before = {}
    same = {
        name: name in before and agrees(name, getattr(row, name), float(before[name]), amplified)
        for name in ERROR_COLUMNS
    }
    for name, noise in TIMING_NOISE.items():
        same[name] = same_machine and name in before and within_factor(getattr(row, name), float(before[name]), noise)
    numbers = {name: float(before[name] if yes else f"{getattr(row, name):.{DIGITS}g}") for name, yes in same.items()}
    return replace(row, **numbers, runs=int(before["runs"]) if same["cpu"] else row.runs)


def within_factor(now: float, before: float, factor: float) -> bool:
    """Whether two times agree within a factor; NaN agrees with NaN."""
    return before / factor <= now <= before * factor or (now != now and before != before)


def _amplified(cell: Cell) -> float:
    order = cell.engine.order(mechanism_of(cell.scene))
    return order.amplified if isinstance(order, ConvergenceOrder) else 1.0
