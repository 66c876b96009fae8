"""A baseline: the errors.csv of an earlier run, with the versions that it was made with."""

from __future__ import annotations

import csv
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from reports.grid.measure import Measurement
from reports.grid.outcomes import Outcome
from reports.grid.quantities import QUANTITIES
from reports.text.provenance import still_installed

# scene, method, samples, steps a sample: the same cell in every run, whatever its settings are by now.
Identity = tuple[str, str, int, int]
# The file beside errors.csv in whose comments the versions stand, in the words of `reports.text.provenance.versions`.
BESIDE = "timings.csv"


class BadBaseline(ValueError):
    """A file that is no errors.csv; the message is one line that says what is wrong with it."""


@dataclass(frozen=True)
class Old:
    """What a baseline knows of a cell: its outcome, and errors by quantity."""

    outcome: Outcome
    errors: Mapping[str, float]


@dataclass(frozen=True)
class Baseline:
    """The cells of an earlier run, and the versions it was made with ("" where nobody says)."""

    cells: Mapping[Identity, Old]
    versions: str = ""

    @property
    def same_versions(self) -> bool:
        """Whether numbers have to be the same: a file whose versions nobody says is taken at its word."""
        return self.versions == "" or still_installed(self.versions)


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


def read_baseline(path: Path) -> Baseline:
    """Read an errors.csv. Raises BadBaseline, in one line, for a file that is not there or is none."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise BadBaseline(f"baseline {path}: {reason}; give the errors.csv of a run") from None
    rows = list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))
    needed = {"scene", "engine", "variant", "purpose", "samples", "every", "outcome", *(q.name for q in QUANTITIES)}
    missing = sorted(needed - set(rows[0] if rows else ()))
    if missing:
        raise BadBaseline(f"baseline {path}: it has no column {missing[0]!r}; give the errors.csv of a run")
    cells: dict[Identity, Old] = {}
    for number, row in enumerate(rows, start=1):
        if row["purpose"] != "sweep":
            continue
        try:
            key = (row["scene"], f"{row['engine']} {row['variant']}", int(row["samples"]), int(row["every"]))
            cells[key] = Old(Outcome(row["outcome"]), {q.name: float(row[q.name]) for q in QUANTITIES})
        except (ValueError, TypeError):
            raise BadBaseline(
                f"baseline {path}: row {number} is damaged ({row['scene']}); give an errors.csv"
            ) from None
    return Baseline(cells, versions_beside(path))
