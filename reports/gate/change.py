"""The gate of change: a row against the same cell of a baseline, an errors.csv of an earlier run with its versions.

What rounding may do to a run is measured: the same engine of a mechanism whose numbers are rounded otherwise. A start
alone does not tell it: where a motion is prescribed, or a projection puts the start back, no bit of a result depends on
the start's last one. So masses, gravity and the points where joints and forces act are rounded otherwise too: all that
enters a step. No order of summation is tried: another order of bodies is another tree of joints in MuJoCo, and another
order of sweeps in pymunk, which are other methods with other errors.
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
from reports.model.quantities import QUANTITIES, room
from reports.write.csv_files import DIGESTS, not_as_written, read_lines
from reports.write.provenance import still_installed

# scene, method, samples, steps a sample: the same cell in every run, whatever its settings are by now.
Identity = tuple[str, str, int, int]
IDENTITY = ("scene", "engine", "variant", "samples", "every")  # the columns that give it
# The file beside errors.csv whose comments have the versions, as `reports.write.provenance.versions` writes them.
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
    """The cells of an earlier run, the versions it was made with ("" if unknown), the folder of the file, and the
    quantities for which the file has no column, since the suite measured fewer quantities then."""

    cells: Mapping[Identity, Old]
    versions: str = ""
    folder: Path | None = None
    unmeasured: tuple[str, ...] = ()

    @property
    def same_versions(self) -> bool:
        """Whether `change` checks the rows; `drift` does where the version of a package differs.

        A file without versions is compared as one with the same versions.
        """
        return self.versions == "" or still_installed(self.versions)


def mixed(baseline: Baseline) -> str:
    """One sentence if the baseline's file and the pages beside it were not written together; empty if they were, and
    where there are none, as in an installed copy."""
    if baseline.folder is None or not (baseline.folder / "index.md").exists():
        return ""
    others = not_as_written(baseline.folder)
    if others is None:
        return f"{baseline.folder} has no {DIGESTS}, so it may be of several reports; write the report anew."
    more = f" and {len(others) - MOST} more" if len(others) > MOST else ""
    names = ", ".join(others[:MOST]) + more
    return f"Not as the report in {baseline.folder} wrote them: {names}; write it anew." if others else ""


def identity(row: Measurement) -> Identity:
    """Which cell a row is of."""
    return row.scene, row.method, row.samples, row.every


def _identity(row: Mapping[str, str]) -> Identity:
    """Of a row of a file. Raises ValueError or TypeError for a damaged one."""
    return row["scene"], f"{row['engine']} {row['variant']}", int(row["samples"]), int(row["every"])


def _read_timings(path: Path) -> tuple[str, dict[Identity, float]]:
    """From the timings.csv beside an errors.csv, as far as it can be read: the versions that both were made with, ""
    without them, and CPU seconds a simulated second."""
    seconds: dict[Identity, float] = {}
    remarks: list[str] = []
    with contextlib.suppress(OSError, ValueError, TypeError, KeyError):
        remarks, rows = read_lines(path.with_name(BESIDE).read_text(encoding="utf-8"))
        for row in rows:
            if row["purpose"] == "sweep":
                seconds[_identity(row)] = float(row["cpu"])
    return next((line for line in remarks if line.startswith("Python ")), ""), seconds


def read_baseline(path: Path) -> Baseline:
    """Read an errors.csv. Raises BadBaseline, in one line, for a missing file or one of another kind.

    A quantity without a column is not compared; `Baseline.unmeasured` names it.
    """
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


# Roundings that are tried.
SEEDS = (1, 2, 3)
EPSILON = float(np.finfo(float).eps)

Part = TypeVar("Part")


@dataclass(frozen=True)
class Altered(EngineWrapper):
    """An engine in the sense of `engines.Engine`: another one, which builds `change(mechanism)`.

    It goes by the name of the engine inside and is held to what that one promises of the mechanism as it is. `change`
    is itself a frozen dataclass that can be called, so that it is data: compared, printed, and sent to other processes.
    """

    engine: Engine
    change: Callable[[Mechanism], Mechanism]

    @property
    def variant(self) -> str:  # pyright: ignore[reportIncompatibleVariableOverride]
        return self.engine.variant

    def stepped(self, mechanism: Mechanism) -> Engine:
        """Itself: what is inside is not stepped as it is."""
        return self

    def instants(
        self, mechanism: Mechanism, dt: float, steps: int, built: Mechanism | None = None
    ) -> tuple[Instant, ...] | NotDeclared:
        """What the engine that is stepped computes with a model of the changed mechanism, beside the right law."""
        return self.engine.stepped(mechanism).instants(mechanism, dt, steps, self.change(mechanism))

    def build(self, mechanism: Mechanism, dt: float) -> Run:
        """Raises whatever the change and the engine raise."""
        return self.engine.build(self.change(mechanism), dt)


@dataclass(frozen=True)
class Nudge:
    """Masses, inertias and all vectors of a mechanism moved by one rounding up or down, or left; the same for a seed.

    Lone numbers of joints and forces (a gear's ratio, an angle) stay: engines treat some of them, such as 1, in a way
    of their own. So do zeros.
    """

    seed: int

    def __call__(self, mechanism: Mechanism) -> Mechanism:
        """The mechanism in other roundings."""
        random = np.random.default_rng([self.seed, zlib.crc32(repr(mechanism.row_names).encode())])
        return replace(
            mechanism,
            bodies=tuple(_moved(body, random, ("mass", "inertia")) for body in mechanism.bodies),
            joints=tuple(_moved(joint, random) for joint in mechanism.joints),
            gravity=_rounded(mechanism.gravity, random),
            forces=tuple(_moved(force, random) for force in mechanism.forces),
        )


def _moved(part: Part, random: np.random.Generator, lone: tuple[str, ...] = ()) -> Part:
    """A body, joint or force with its vectors, and these lone numbers, rounded otherwise."""
    changed: dict[str, Any] = {}
    for field in fields(part):  # type: ignore[arg-type]
        value = getattr(part, field.name)
        if field.name in lone:
            (changed[field.name],) = _rounded((value,), random)
        elif isinstance(value, tuple) and value and all(isinstance(number, float) for number in value):
            changed[field.name] = _rounded(value, random)
    return replace(part, **changed)  # type: ignore[type-var]


def _rounded(values: tuple[Any, ...], random: np.random.Generator) -> Any:
    signs = random.integers(-1, 2, len(values))
    return tuple(float(value * (1 + EPSILON * sign)) for value, sign in zip(values, signs, strict=True))


def nudged_cells(cell: Cell) -> tuple[Cell, ...]:
    """The same cell in other roundings of all that enters it."""
    return tuple(replace(cell, engine=Altered(cell.engine, Nudge(seed))) for seed in SEEDS)


# With other versions an error may become this many times as large: by luck, as where two errors no longer cancel.
WORSE = 3.0
# The median of n draws scatters 1.25 / sqrt(n) times as much as one draw does (of a normal distribution).
SCATTER = 1.2533
# What a few other roundings do is this much short of the most that rounding may do.
ROOM = 10.0
# A method is dear where it takes this many times the CPU time of the baseline: told always, since no other machine and
# no load of this one makes as much.
DEAR = 10.0


def change(row: Measurement, old: Old, nudged: Sequence[Measurement] = (), amplified: float = 1.0) -> tuple[Check, ...]:
    """The checks of a row that was made with the baseline's versions: the same numbers, to rounding.

    The bound is the `room` of the quantity (`reports.model.quantities`), which is never zero, and what `nudged`, the
    same cell in other roundings, differ by: where the motion amplifies rounding. `amplified`: see `ConvergenceOrder`.
    """
    if not _has_numbers(row.outcome, old.outcome):
        same = row.outcome == old.outcome or any(other.outcome == old.outcome for other in nudged)
        return (_outcome(row, old, same),)
    others = [other for other in nudged if _has_numbers(other.outcome, old.outcome)]
    out = []
    for name, before in old.errors.items():
        now = getattr(row, name)
        if not (math.isnan(now) and math.isnan(before)):
            known = [value for other in others if math.isfinite(value := getattr(other, name))]
            spread = max((abs(value - now) for value in known), default=0.0)
            digits, rounding = room(name, before, amplified)
            terms = (("printed digits", digits), ("rounding", rounding), ("as other roundings", ROOM * spread))
            bound = sum(value for _, value in terms)
            out.append(Check(CHANGE, name, abs(now - before), bound, terms, f", {now:.4g}; it was {before:.4g}"))
    return (*out, *_reactions(row, old))


def _has_numbers(now: str, before: str) -> bool:
    """Whether the numbers of two runs that ended so have to be the same: both can be compared, or both say of
    themselves that they are not resolved. Those of a run that is torn or lost are as large as chance has it."""
    if now == before == Outcome.UNRESOLVED:
        return True
    return Outcome(now).comparable and Outcome(before).comparable


def drift(row: Measurement, old: Old) -> tuple[Check, ...]:
    """The checks of a row that was made with other versions.

    No error is more than WORSE times as large, no number has become NaN, and the outcome is the same one, unless the
    run can be compared now and could not before: that is an improvement, which `known_by_now` reports.
    """
    if not (Outcome(row.outcome).comparable and old.outcome.comparable):
        return (_outcome(row, old, row.outcome == old.outcome or Outcome(row.outcome).comparable),)
    out = []
    for name, before in old.errors.items():
        now = getattr(row, name)
        if not math.isnan(before):
            rounding = room(name, before)[1]
            told = f", {now:.4g}; it was {before:.4g}"
            terms = (("baseline", before), ("rounding", rounding))
            out.append(Check(CHANGE, name, now, WORSE * (before + rounding), terms, told))
    return (*out, *_reactions(row, old))


def _outcome(row: Measurement, old: Old, same: bool) -> Check:
    told = f", {row.outcome}; it was {old.outcome}"
    return Check(CHANGE, "outcome", 0.0 if same else math.inf, 1.0, sentence=told)


def _reactions(row: Measurement, old: Old) -> tuple[Check, ...]:
    """A reaction's error is of the rows that an engine tells: none of them may fall silent."""
    silent = old.reaction_rows - row.reaction_rows
    told = f", rows without a reaction; it told {old.reaction_rows} of them"
    return (Check(CHANGE, "reaction_rows", float(silent), 0.0, sentence=told),) if silent > 0 else ()


def known_by_now(row: Measurement, old: Old) -> tuple[str, ...]:
    """Sentences on what a baseline of other versions has no number for, and the row has."""
    if not Outcome(row.outcome).comparable:
        return ()
    if not old.outcome.comparable:
        return (f"outcome: {row.outcome}; it was {old.outcome}",)
    found = ((name, getattr(row, name)) for name, before in old.errors.items() if math.isnan(before))
    return tuple(f"{name}: {now:.4g}; it was not known" for name, now in found if not math.isnan(now))


def growth(pairs: Iterable[tuple[Measurement, Old]]) -> tuple[Check, ...]:
    """Whether a method's errors grew with other versions over all its scenes: one check a method and quantity.

    In one scene luck may make an error WORSE times as large or small. Luck of n scenes has no common sign: the median
    of the logarithms of their factors scatters SCATTER / sqrt(n) times as much as one of them, so the median factor is
    held below WORSE to that power. The cells of a scene share its luck, so they count as one, by the median of their
    own factors. Errors below rounding have the factor 1.
    """
    factors: dict[tuple[str, str], dict[str, list[float]]] = {}
    for row, old in pairs:
        if not (Outcome(row.outcome).comparable and old.outcome.comparable):
            continue
        for name, before in old.errors.items():
            now, rounding = getattr(row, name), room(name, before)[1]
            if math.isfinite(now) and math.isfinite(before):
                of_scenes = factors.setdefault((row.method, name), {})
                of_scenes.setdefault(row.scene, []).append((now + rounding) / (before + rounding))
    out = []
    for (method, name), of_scenes in factors.items():
        measured = median(median(own) for own in of_scenes.values())
        bound = WORSE ** min(1.0, SCATTER / math.sqrt(len(of_scenes)))
        told = f", {method}: the median factor of its error over {len(of_scenes)} scenes"
        out.append(Check(CHANGE, name, measured, bound, sentence=told))
    return tuple(out)


def cost(pairs: Iterable[tuple[Measurement, Old]]) -> float:
    """How many times the baseline's CPU time a method takes, over the cells that both have timed; NaN without one.

    The sum counts, which is that of the longest runs: a run of a millisecond is timed badly.
    """
    timed = [
        (row.cpu, old.cpu)
        for row, old in pairs
        if Outcome(row.outcome).comparable and old.outcome.comparable and row.cpu > 0 and old.cpu > 0
    ]
    return sum(now for now, _ in timed) / sum(before for _, before in timed) if timed else math.nan


def moved(row: Measurement, old: Old, amplified: float = 1.0) -> bool:
    """Whether a row differs from its baseline by more than printing and rounding may change."""
    return any(not check.passed for check in change(row, old, amplified=amplified))
