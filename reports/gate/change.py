"""The regression gate compares each row with a baseline. The baseline is the errors.csv of an earlier run.

The effect of rounding is measured in runs whose masses, inertias, gravity and points are changed by one rounding. A
change of the initial state alone does not suffice, since a prescribed or projected motion does not depend on the last
bit of this state. The bodies keep their order. Another order would change MuJoCo's tree and pymunk's solver iterations,
and so the errors.
"""

from __future__ import annotations

import contextlib
import math
import zlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from statistics import median
from typing import Any, TypeVar

import numpy as np

from engines import Engine, EngineWrapper, Instant, NotDeclared, Run
from reference.mechanism import Mechanism
from reports.model.cells import Cell
from reports.model.checks import CHANGE, Check
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES, rounding_tolerance
from reports.write.csv_files import DIGESTS, not_as_written, read_lines
from reports.write.provenance import still_installed

# (scene, method, samples, steps per sample) identifies a cell in all runs, even if its settings have changed.
Identity = tuple[str, str, int, int]
IDENTITY = ("scene", "engine", "variant", "samples", "every")  # Columns of errors.csv that define a cell.
TIMINGS_FILE = "timings.csv"  # A file beside errors.csv whose comments contain the versions.
MOST_FILES_NAMED = 5  # Largest number of files that a message names.


class BadBaseline(ValueError):
    """The error that a baseline file is not a valid errors.csv. The message is one line with the reason."""


@dataclass(frozen=True)
class Old:
    """A cell of a baseline. reaction_rows: constraint rows with a reported reaction. cpu: CPU seconds per simulated
    second, or NaN if unknown."""

    outcome: Outcome
    errors: Mapping[str, float]
    reaction_rows: int = 0
    cpu: float = math.nan


@dataclass(frozen=True)
class Baseline:
    """The cells of an earlier run. versions: "" if unknown. unmeasured: quantities for which the file has no column."""

    cells: Mapping[Identity, Old]
    versions: str = ""
    folder: Path | None = None
    unmeasured: tuple[str, ...] = ()

    @property
    def same_versions(self) -> bool:
        """Whether the installed packages have the versions of the baseline, or these versions are unknown. Rows with
        the same versions are checked by `change`, and other rows by `drift`."""
        return self.versions == "" or still_installed(self.versions)


def mixed(baseline: Baseline) -> str:
    """An error message if the baseline and the pages in its folder belong to different reports, else empty."""
    if baseline.folder is None or not (baseline.folder / "index.md").exists():
        return ""
    others = not_as_written(baseline.folder)
    if others is None:
        return f"{baseline.folder} has no {DIGESTS}, so its files may be of several reports; write the report again."
    remainder = f" and {len(others) - MOST_FILES_NAMED} more" if len(others) > MOST_FILES_NAMED else ""
    names = ", ".join(others[:MOST_FILES_NAMED]) + remainder
    return (
        f"Changed since the report in {baseline.folder} was written: {names}; write the report again." if others else ""
    )


def identity(row: Measurement) -> Identity:
    return row.scene, row.method, row.samples, row.every


def _identity(row: Mapping[str, str]) -> Identity:
    return row["scene"], f"{row['engine']} {row['variant']}", int(row["samples"]), int(row["every"])


def _read_timings(path: Path) -> tuple[str, dict[Identity, float]]:
    """(versions, cell -> CPU seconds per simulated second) from the timings.csv beside an errors.csv. If the file
    cannot be read, the versions are empty and cells are missing."""
    seconds: dict[Identity, float] = {}
    remarks: list[str] = []
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError):
        remarks, rows = read_lines(path.with_name(TIMINGS_FILE).read_text(encoding="utf-8"))
        for row in rows:
            if row["purpose"] == "sweep":
                seconds[_identity(row)] = float(row["cpu"])
    return next((line for line in remarks if line.startswith("Python ")), ""), seconds


def read_baseline(path: Path) -> Baseline:
    """Read an errors.csv. Raises BadBaseline if the file is missing or is not a valid errors.csv."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not text"
        raise BadBaseline(f"baseline {path}: {reason}; give the errors.csv of a run") from None
    _, rows = read_lines(text)
    columns = set(rows[0] if rows else ())
    missing = sorted({*IDENTITY, "purpose", "outcome", "reaction_rows"} - columns)
    if missing:
        raise BadBaseline(f"baseline {path}: it has no column {missing[0]!r}; give the errors.csv of a run")
    names = [q.name for q in QUANTITIES]
    versions, seconds = _read_timings(path)
    cells: dict[Identity, Old] = {}
    for number, row in enumerate(rows, start=1):
        try:
            if row["purpose"] == "sweep":
                key, errors = _identity(row), {name: float(row[name]) for name in names if name in columns}
                cpu = seconds.get(key, math.nan)
                cells[key] = Old(Outcome(row["outcome"]), errors, int(row["reaction_rows"]), cpu)
        except (ValueError, TypeError):
            reason = f"row {number} is damaged ({row['scene']}); give an errors.csv"
            raise BadBaseline(f"baseline {path}: {reason}") from None
    return Baseline(cells, versions, path.parent, tuple(name for name in names if name not in columns))


SEEDS = (1, 2, 3)  # Seeds of the changes by one rounding.
EPSILON = float(np.finfo(float).eps)

Part = TypeVar("Part")


@dataclass(frozen=True)
class Altered(EngineWrapper):
    """An engine that builds `change(mechanism)` with the wrapped engine. The name and the declarations, for the
    unchanged mechanism, are those of the wrapped engine. `change` is a callable frozen dataclass, so it can be
    compared, printed and sent to other processes."""

    engine: Engine
    change: Callable[[Mechanism], Mechanism]

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.engine.variant

    def stepped(self, mechanism: Mechanism) -> Engine:
        """Return this engine, since it builds the changed mechanism."""
        return self

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """The instants at which the wrapped engine evaluates the changed mechanism."""
        return self.engine.stepped(mechanism).instants(mechanism, dt, steps, self.change(mechanism))

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        """Build the changed mechanism. Exceptions of `change` and of the engine are raised."""
        return self.engine.build(self.change(mechanism), dt)


@dataclass(frozen=True)
class Nudge:
    """A random change of masses, inertias and vectors of a mechanism by -1, 0 or 1 rounding. Scalars of joints and
    forces, such as a gear's ratio or an angle, are not changed. Engines treat some values, such as 1, specially. Zeros
    remain zero."""

    seed: int

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        random = np.random.default_rng([self.seed, zlib.crc32(repr(mechanism.row_names).encode())])
        return replace(
            mechanism,
            bodies=tuple(_nudge_part(body, random, ("mass", "inertia")) for body in mechanism.bodies),
            joints=tuple(_nudge_part(joint, random) for joint in mechanism.joints),
            gravity=_rounded(mechanism.gravity, random),
            forces=tuple(_nudge_part(force, random) for force in mechanism.forces),
        )


def _nudge_part(part: Part, random: np.random.Generator, scalars: tuple[str, ...] = ()) -> Part:
    changed: dict[str, Any] = {}
    for field in fields(part):  # type: ignore[arg-type]
        value = getattr(part, field.name)
        if field.name in scalars:
            (changed[field.name],) = _rounded((value,), random)
        elif isinstance(value, tuple) and value and all(isinstance(number, float) for number in value):
            changed[field.name] = _rounded(value, random)
    return replace(part, **changed)  # type: ignore[type-var]


def _rounded(values: tuple[Any, ...], random: np.random.Generator) -> Any:
    signs = random.integers(-1, 2, len(values))
    return tuple(float(value * (1 + EPSILON * sign)) for value, sign in zip(values, signs, strict=True))


def nudged_cells(cell: Cell) -> tuple[Cell, ...]:
    """For each seed, a cell whose mechanism is changed by one rounding."""
    return tuple(replace(cell, engine=Altered(cell.engine, Nudge(seed))) for seed in SEEDS)


# With other versions an error may grow by this factor. For example, two errors may no longer cancel.
WORSE = 3.0
# The median of n normal samples has SCATTER / sqrt(n) times the standard deviation of one sample.
SCATTER = 1.2533
# Safety factor on the differences of the nudged runs, which are too few to show the largest effect of rounding.
NUDGE_ROOM = 10.0
# If the CPU time has grown by this factor, a remark is made. Another machine or load has a smaller effect.
DEAR = 10.0


def change(row: Measurement, old: Old, nudged: Sequence[Measurement] = (), amplified: float = 1.0) -> tuple[Check, ...]:
    """The checks that a row with the baseline's versions has equal numbers within rounding. nudged: rows of the cell
    with mechanisms changed by one rounding. The bound is the sum of `rounding_tolerance` and of the largest difference
    to these rows times NUDGE_ROOM. amplified: see `ConvergenceOrder`."""
    if not _has_numbers(row.outcome, old.outcome):
        same = row.outcome == old.outcome or any(other.outcome == old.outcome for other in nudged)
        return (_outcome(row, old, same),)
    others = [other for other in nudged if _has_numbers(other.outcome, old.outcome)]
    out = []
    for name, earlier in old.errors.items():
        now = getattr(row, name)
        if not (math.isnan(now) and math.isnan(earlier)):
            finite = [value for other in others if math.isfinite(value := getattr(other, name))]
            spread = max((abs(value - now) for value in finite), default=0.0)
            digits, rounding = rounding_tolerance(name, earlier, amplified)
            parts = (("printed digits", digits), ("rounding", rounding), ("nudged runs", NUDGE_ROOM * spread))
            bound = sum(value for _, value in parts)
            out.append(Check(CHANGE, name, abs(now - earlier), bound, parts, f", {now:.4g}; it was {earlier:.4g}"))
    return (*out, *_reactions(row, old))


def _has_numbers(now: str, before: str) -> bool:
    """Whether runs with these outcomes must have equal numbers. The numbers of all other runs are arbitrary."""
    if now == before == Outcome.UNRESOLVED:
        return True
    return Outcome(now).comparable and Outcome(before).comparable


def drift(row: Measurement, old: Old) -> tuple[Check, ...]:
    """The checks of a row with versions other than the baseline's. An error may not become NaN or exceed WORSE times
    the baseline's error. The outcome must be equal or become comparable."""
    if not (Outcome(row.outcome).comparable and old.outcome.comparable):
        return (_outcome(row, old, row.outcome == old.outcome or Outcome(row.outcome).comparable),)
    out = []
    for name, earlier in old.errors.items():
        now = getattr(row, name)
        if not math.isnan(earlier):
            rounding = rounding_tolerance(name, earlier)[1]
            parts = (("baseline", earlier), ("rounding", rounding))
            sentence = f", {now:.4g}; it was {earlier:.4g}"
            out.append(Check(CHANGE, name, now, WORSE * (earlier + rounding), parts, sentence))
    return (*out, *_reactions(row, old))


def _outcome(row: Measurement, old: Old, same: bool) -> Check:
    return Check(CHANGE, "outcome", 0.0 if same else math.inf, 1.0, sentence=f", {row.outcome}; it was {old.outcome}")


def _reactions(row: Measurement, old: Old) -> tuple[Check, ...]:
    missing = old.reaction_rows - row.reaction_rows
    sentence = f" constraint rows without a reaction; {old.reaction_rows} had one"
    return (Check(CHANGE, "reaction_rows", float(missing), 0.0, sentence=sentence),) if missing > 0 else ()


def describe_improvements(row: Measurement, old: Old) -> tuple[str, ...]:
    """Sentences about numbers that are in the row and not in the baseline."""
    if not Outcome(row.outcome).comparable:
        return ()
    if not old.outcome.comparable:
        return (f"outcome: {row.outcome}; it was {old.outcome}",)
    errors = ((name, getattr(row, name)) for name, earlier in old.errors.items() if math.isnan(earlier))
    return tuple(f"{name}: {now:.4g}; it was not known" for name, now in errors if not math.isnan(now))


def growth(pairs: Iterable[tuple[Measurement, Old]]) -> tuple[Check, ...]:
    """Checks, for each method and quantity, that the errors of all scenes together have not grown with other versions.
    In one scene an error may change by a factor of WORSE by chance. The median factor of n scenes varies less, so its
    bound is WORSE ** (SCATTER / sqrt(n)). The cells of a scene are not independent, so each scene contributes the
    median of its factors. Errors below rounding have the factor 1."""
    factors: dict[tuple[str, str], dict[str, list[float]]] = {}
    for row, old in pairs:
        if not (Outcome(row.outcome).comparable and old.outcome.comparable):
            continue
        for name, earlier in old.errors.items():
            now, rounding = getattr(row, name), rounding_tolerance(name, earlier)[1]
            if math.isfinite(now) and math.isfinite(earlier):
                of_scenes = factors.setdefault((row.method, name), {})
                of_scenes.setdefault(row.scene, []).append((now + rounding) / (earlier + rounding))
    out = []
    for (method, name), of_scenes in factors.items():
        measured = median(median(cells) for cells in of_scenes.values())
        bound = WORSE ** min(1.0, SCATTER / math.sqrt(len(of_scenes)))
        sentence = f", {method}: the median factor of its error over {len(of_scenes)} scenes"
        out.append(Check(CHANGE, name, measured, bound, sentence=sentence))
    return tuple(out)


def cost(pairs: Iterable[tuple[Measurement, Old]]) -> float:
    """The total CPU time divided by that of the baseline, or NaN if no cell has both times. Long runs dominate the
    total, since a run of a millisecond cannot be timed well."""
    timed = [
        (row.cpu, old.cpu)
        for row, old in pairs
        if Outcome(row.outcome).comparable and old.outcome.comparable and row.cpu > 0 and old.cpu > 0
    ]
    return sum(now for now, _ in timed) / sum(earlier for _, earlier in timed) if timed else math.nan


def moved(row: Measurement, old: Old, amplified: float = 1.0) -> bool:
    """Whether a row differs from its baseline by more than printed digits and rounding."""
    return any(not check.passed for check in change(row, old, amplified=amplified))
