"""A baseline: the errors.csv of an earlier run, with the versions that it was made with."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES
from reports.write.csv_files import DIGESTS, not_as_written, read_lines
from reports.write.provenance import still_installed

# scene, method, samples, steps a sample: the same cell in every run, whatever its settings are by now.
Identity = tuple[str, str, int, int]
IDENTITY = ("scene", "engine", "variant", "samples", "every")  # the columns that tell it
# The file beside errors.csv in whose comments the versions stand, in the words of `reports.write.provenance.versions`.
BESIDE = "timings.csv"

MOST = 5  # files that a sentence names


class BadBaseline(ValueError):
    """A file that is no errors.csv; the message is one line that says what is wrong with it."""


@dataclass(frozen=True)
class Old:
    """What a baseline knows of a cell: its outcome, errors by quantity, how many rows' reactions the engine told, and
    `cpu`, seconds a simulated second (NaN where nobody has timed it)."""

    outcome: Outcome
    errors: Mapping[str, float]
    reaction_rows: int = 0
    cpu: float = math.nan


@dataclass(frozen=True)
class Baseline:
    """The cells of an earlier run, the versions it was made with ("" where nobody says), and the folder it lies in."""

    cells: Mapping[Identity, Old]
    versions: str = ""
    folder: Path | None = None

    @property
    def same_versions(self) -> bool:
        """Whether numbers have to be the same: a file whose versions nobody says is taken at its word."""
        return self.versions == "" or still_installed(self.versions)


def mixed(baseline: Baseline) -> str:
    """One sentence if the baseline's file and the pages beside it were not written together; empty if they were, and
    where there are none, as in an installed copy."""
    if baseline.folder is None or not (baseline.folder / "index.md").exists():
        return ""
    found = not_as_written(baseline.folder)
    if found is None:
        return (
            f"Nothing says whether {baseline.folder} was written at once: it has no {DIGESTS}; write the report anew."
        )
    if not found:
        return ""
    more = f" and {len(found) - MOST} more" if len(found) > MOST else ""
    return f"Not as the report in {baseline.folder} wrote them: {', '.join(found[:MOST])}{more}; write it anew."


def identity(row: Measurement) -> Identity:
    """Which cell a row is of."""
    return row.scene, row.method, row.samples, row.every


def versions_beside(path: Path) -> str:
    """What an errors.csv was made with, from the timings.csv that is written with it; "" without one."""
    try:
        lines = path.with_name(BESIDE).read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError):
        return ""
    return next((line.removeprefix("# ") for line in lines if line.startswith("# Python ")), "")


def _identity(row: Mapping[str, str]) -> Identity:
    """Of a row of a file. Raises ValueError or TypeError for a damaged one."""
    return row["scene"], f"{row['engine']} {row['variant']}", int(row["samples"]), int(row["every"])


def _seconds_beside(path: Path) -> dict[Identity, float]:
    """CPU seconds a simulated second, from the timings.csv beside an errors.csv, as far as it can be read."""
    found: dict[Identity, float] = {}
    try:
        for row in read_lines(path.with_name(BESIDE).read_text(encoding="utf-8"))[1]:
            if row["purpose"] == "sweep":
                found[_identity(row)] = float(row["cpu"])
    except (OSError, ValueError, TypeError, KeyError):
        return found
    return found


def read_baseline(path: Path) -> Baseline:
    """Read an errors.csv. Raises BadBaseline, in one line, for a file that is not there or is none."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise BadBaseline(f"baseline {path}: {reason}; give the errors.csv of a run") from None
    _, rows = read_lines(text)
    errors = tuple(q.name for q in QUANTITIES)
    needed = {*IDENTITY, "purpose", "outcome", "reaction_rows", *errors}
    missing = sorted(needed - set(rows[0] if rows else ()))
    if missing:
        raise BadBaseline(f"baseline {path}: it has no column {missing[0]!r}; give the errors.csv of a run")
    seconds = _seconds_beside(path)
    cells: dict[Identity, Old] = {}
    for number, row in enumerate(rows, start=1):
        if row["purpose"] != "sweep":
            continue
        try:
            key = _identity(row)
            told = {name: float(row[name]) for name in errors}
            cpu = seconds.get(key, math.nan)
            cells[key] = Old(Outcome(row["outcome"]), told, int(row["reaction_rows"]), cpu)
        except (ValueError, TypeError):
            raise BadBaseline(
                f"baseline {path}: row {number} is damaged ({row['scene']}); give an errors.csv"
            ) from None
    return Baseline(cells, versions_beside(path), path.parent)
