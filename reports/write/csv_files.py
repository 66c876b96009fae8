"""The CSV files of a report (errors, timings, descriptions of rows, digests of files), and the published rows.

A number that agrees with the published number within rounding keeps its published text, so that a diff shows only real
changes. Pages are rendered from the numbers in the CSV files.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Iterable, Mapping
from dataclasses import astuple, dataclass, field, fields, replace
from pathlib import Path
from typing import Any, TypeVar, cast

from engines import ConvergenceOrder
from reports.model.cells import Cell, mechanism_of
from reports.model.ending import BadInput
from reports.model.fingerprint import SHORT, digest
from reports.model.measure import TIMINGS, Measurement
from reports.model.quantities import DIGITS, OF, QUANTITIES, agrees
from reports.write.provenance import machine

Record = TypeVar("Record")
IDENTITY_COLUMNS = ("scene", "engine", "variant", "purpose", "parameters", "settings", "samples", "every", "step")


def as_csv(
    rows: Iterable[Measurement], timings: bool, header: str = "", made_with: Mapping[str, str] | None = None
) -> str:
    """Sorted rows as CSV, either with their errors or with their timings.

    Parameters and settings are digests (see `descriptions_csv`). Numbers have DIGITS digits, because more digits depend
    on the machine's rounding.

    Args:
        header: each line becomes a comment.
        made_with: key of a row -> versions on which it depends. The last column has their digests.
    """
    results = [f.name for f in fields(Measurement) if f.name not in (*IDENTITY_COLUMNS, *TIMINGS, "key", "limit")]
    names = [*IDENTITY_COLUMNS, *(TIMINGS if timings else results)]
    ordered = sorted(rows, key=lambda row: tuple(getattr(row, name) for name in IDENTITY_COLUMNS))
    lines = [names, *([cell_text(row, name) for name in names] for row in ordered)]
    if made_with is not None:
        last = ["versions", *(digest(made_with[row.key], SHORT) for row in ordered)]
        lines = [[*line, text] for line, text in zip(lines, last, strict=True)]
    return _csv(lines, header.splitlines())


def _csv(lines: Iterable[Iterable[str]], comments: Iterable[str] = ()) -> str:
    out = io.StringIO()
    out.writelines(f"# {comment}\n" for comment in comments)
    csv.writer(out, lineterminator="\n").writerows(lines)
    return out.getvalue()


def cell_text(row: Measurement, name: str) -> str:
    value = getattr(row, name)
    return digest(value, SHORT) if name in DESCRIPTION_COLUMNS else _text(value)


def _text(value: Any) -> str:
    return f"{value:.{DIGITS}g}" if isinstance(value, float) else no_formula(str(value))


def no_formula(text: str) -> str:
    """The text. An apostrophe is added in front if a spreadsheet would interpret the text as a formula."""
    return f"'{text}" if text.startswith(("=", "+", "-", "@", "\t", "\r")) else text


def read_lines(text: str) -> tuple[list[str], list[dict[str, str]]]:
    """The comments of a CSV text, and its rows as dictionaries."""
    lines = text.splitlines()
    comments = [line.removeprefix("# ") for line in lines if line.startswith("#")]
    return comments, list(csv.DictReader(line for line in lines if not line.startswith("#")))


def records_csv(kind: type, records: Iterable[Any], comments: Iterable[str] = ()) -> str:
    """Instances of a dataclass as CSV, with a column for each field. `comments` precede the header."""
    names = [column.name for column in fields(kind)]
    return _csv([names, *(map(_text, astuple(record)) for record in records)], comments)


def read_records(kind: Callable[..., Record], text: str) -> tuple[list[str], tuple[Record, ...]]:
    """The comments and the instances in a text by `records_csv`. Raises ValueError for another text."""
    comments, lines = read_lines(text)
    kinds = {column.name: float if column.type == "float" else str for column in fields(cast(Any, kind))}
    try:
        return comments, tuple(kind(**{name: read(line[name]) for name, read in kinds.items()}) for line in lines)
    except (KeyError, TypeError, ValueError):
        raise ValueError("the columns of a line are missing or have other values") from None


# Columns with long texts, which the files replace by digests.
DESCRIPTION_COLUMNS = ("parameters", "settings")


def descriptions_csv(rows: Iterable[Measurement], made_with: Mapping[str, str] | None = None) -> str:
    """A CSV with the text of each digest in the files of rows."""
    described = {(name, getattr(row, name)) for row in rows for name in DESCRIPTION_COLUMNS}
    described |= {("versions", versions) for versions in (made_with or {}).values()}
    lines = ([digest(text, SHORT), name, no_formula(text)] for name, text in sorted(described))
    return _csv([["digest", "of", "description"], *lines])


DIGESTS = "digests.csv"


def digests_csv(files: Mapping[str, str]) -> str:
    """A CSV with the digests of a report's tables and pages. Pictures are left out, because no number is read from a
    picture. Timings are left out, because a folder may contain timings of an earlier run."""
    names = sorted(name for name in files if name.endswith((".csv", ".md")) and name not in (DIGESTS, "timings.csv"))
    return "".join(["file,digest\n", *(f"{name},{digest(files[name], SHORT)}\n" for name in names)])


def not_as_written(folder: Path) -> tuple[str, ...] | None:
    """The tables and pages of a folder that differ from their digests, or None without a file of digests."""
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
# Factors within which times on one machine count as equal. In two full runs, 95 % of the rows agreed within the factors
# 1.17 for "cpu" and 1.74 for "build", which is measured only once.
TIMING_NOISE = {"cpu": 1.2, "build": 1.8}


@dataclass(frozen=True)
class Published:
    """Texts of errors.csv and timings.csv. `rows`: values of IDENTITY_COLUMNS -> column -> text."""

    rows: Mapping[tuple[str, ...], Mapping[str, str]] = field(default_factory=dict)
    machine: str = ""

    @property
    def engines(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(row["engine"] for row in self.rows.values()))


def read_published(folder: Path) -> Published:
    """The published rows of a folder. Raises BadInput if a file lacks a column."""
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
    """The rows with the numbers that the files will contain, from `with_published_numbers`."""
    same_machine = before.machine == machine()
    published: dict[Cell, Measurement] = {}
    for cell, row in rows.items():
        identity = tuple(cell_text(row, column) for column in IDENTITY_COLUMNS)
        order = cell.engine.order(mechanism_of(cell.scene))
        amplified = order.amplified if isinstance(order, ConvergenceOrder) else 1.0
        published[cell] = with_published_numbers(row, before.rows.get(identity, {}), same_machine, amplified)
    return published


def with_published_numbers(
    row: Measurement, before: Mapping[str, str], same_machine: bool, amplified: float = 1.0
) -> Measurement:
    """The row, with the published numbers if these agree with the row's numbers within rounding or timing noise.

    Args:
        before: the published texts by column; they are ignored if the outcome differs.
        same_machine: whether times can be compared.
        amplified: the method's rounding relative to usual rounding (`reports.model.quantities.agrees`).
    """
    if before.get("outcome") != row.outcome:
        before = {}
    same = {
        name: name in before and agrees(name, getattr(row, name), float(before[name]), amplified)
        for name in ERROR_COLUMNS
    }
    for name, noise in TIMING_NOISE.items():
        now, old = getattr(row, name), float(before.get(name, "nan"))
        is_near = old / noise <= now <= old * noise or (now != now and old != old)
        same[name] = same_machine and name in before and is_near
    numbers = {name: float(before[name] if yes else f"{getattr(row, name):.{DIGITS}g}") for name, yes in same.items()}
    return replace(row, **numbers, runs=int(before["runs"]) if same["cpu"] else row.runs)
