"""Columns of stability maps, and their file. A column has the runs of one method at one parameter value."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from pathlib import Path

import numpy as np

from engines import Engine
from engines.pymunk.convergence import convergence_factor
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import TORN, Outcome
from reports.pages.atlas.subjects import StabilityMap
from reports.write.csv_files import read_lines

FILE = "atlas.csv"
FORCE_SAMPLES = 20
# Letter of a cell that was not run, because its neighbours at larger and smaller steps have the same outcome.
NOT_RUN = "="
# If two outcomes have the same letter, the letter is read as the first outcome.
BY_LETTER = {outcome.letter: outcome for outcome in reversed(Outcome)}
RunCells = Callable[[list[Cell]], Mapping[Cell, Measurement]]


@dataclass(frozen=True)
class StoredColumn:
    """A column of a map as the file stores it; the largest step is first.

    subject: the map's name.
    longest: the largest step [s].
    counts: the number of steps of each run.
    outcomes: for each step `Outcome.letter` or NOT_RUN.
    errors: the decimal logarithm of the angle error [rad], or NaN for cells that were not run or did not finish.
    gives: the step at which a joint tears, from `tearing_step` [s].
    left: the remaining fraction of the slowest mode, from `residual_of_sweeps`.
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
    def outcome_of_steps(self) -> tuple[Outcome, ...]:
        """The outcome at each step; a cell that was not run has the outcome at the next larger step."""
        outcomes: list[Outcome] = []
        for letter in self.outcomes:
            outcomes.append(outcomes[-1] if letter == NOT_RUN and outcomes else BY_LETTER[letter])
        return tuple(outcomes)

    @property
    def run_count(self) -> int:
        return len(self.outcomes) - self.outcomes.count(NOT_RUN)


@dataclass(frozen=True)
class MapColumn:
    """The cells of a column. `steps` has (samples, steps between samples) of each run; the largest step is first."""

    stability_map: StabilityMap
    value: float
    scene: Scene
    engine: Engine
    steps: tuple[tuple[int, int], ...]

    @property
    def cells(self) -> tuple[Cell, ...]:
        return tuple(Cell(self.scene, self.engine, every, "map", samples) for samples, every in self.steps)


def columns_of(stability_map: StabilityMap, engines: Iterable[Engine], points: int) -> list[MapColumn]:
    """All columns of a map, for `points` parameter values and at most `points` steps."""
    steps, values = stability_map.steps(points), stability_map.at(points)
    scenes = {value: stability_map.make(value) for value in values}
    return [MapColumn(stability_map, value, scenes[value], engine, steps) for value in values for engine in engines]


def run_columns(columns: Sequence[MapColumn], run: RunCells, stride: int) -> list[dict[int, Measurement]]:
    """For each column, the rows by the index of the step. Every `stride`-th step is run, and bisection finds the border
    between two steps with different outcomes. A region that is narrower than the stride may be missed. `run` is called
    once for each round of bisection."""
    rows: list[dict[int, Measurement]] = [{} for _ in columns]
    wanted = [sorted({*range(0, len(column.steps), stride), len(column.steps) - 1}) for column in columns]
    while any(wanted):
        cells = [[column.cells[index] for index in indices] for column, indices in zip(columns, wanted, strict=True)]
        measured = run([cell for of_column in cells for cell in of_column])
        for by_index, indices, of_column in zip(rows, wanted, cells, strict=True):
            by_index |= {index: measured[cell] for index, cell in zip(indices, of_column, strict=True)}
        wanted = [
            [
                (low + high) // 2
                for low, high in pairwise(sorted(by_index))
                if high - low > 1 and by_index[low].outcome != by_index[high].outcome
            ]
            for by_index in rows
        ]
    return rows


def stored_column(column: MapColumn, rows: Mapping[int, Measurement]) -> StoredColumn:
    """The column for the file, with two predictions of the step at which runs begin to fail."""
    mechanism, engine = column.scene.mechanism(), column.engine
    counts = tuple(samples * every for samples, every in column.steps)
    longest, shortest = column.scene.duration / counts[0], column.scene.duration / counts[-1]
    indices = range(len(counts))
    return StoredColumn(
        column.stability_map.name,
        engine.name,
        engine.variant,
        column.value,
        longest,
        counts,
        "".join(Outcome(rows[index].outcome).letter if index in rows else NOT_RUN for index in indices),
        tuple(_power(rows[index]) if index in rows else math.nan for index in indices),
        tearing_step(column.scene, mechanism, engine, shortest, longest),
        residual_of_sweeps(mechanism, engine),
    )


def _power(row: Measurement) -> float:
    """The decimal logarithm of the angle error [rad], rounded to tenths, or NaN for a run that can't be compared."""
    usable = Outcome(row.outcome).comparable and math.isfinite(row.angle) and row.angle > 0
    return round(math.log10(row.angle), 1) if usable else math.nan


def tearing_step(scene: Scene, mechanism: Mechanism, engine: Engine, least: float, largest: float) -> float:
    """The smallest step [s] at which a joint with the engine's declared regularisation opens so far that it counts as
    torn.

    With `engines.Regularisation`, J a = bias - damping slip - stiffness gap - compliance A reaction, where A is the
    diagonal of J M^-1 J^T. The steady gap is therefore (compliance A reaction) / stiffness. In an engine that omits the
    bias, the steady gap is (compliance A reaction + bias) / stiffness. Reactions are computed from the ideal motion.

    Steps from `least` to `largest` [s] are searched. The result is 0 if the step `least` tears a joint, inf if no step
    does, and NaN without a reference motion.
    """
    try:
        motion = scene.motion(np.linspace(0, min(scene.duration, scene.comparable_until), FORCE_SAMPLES))
    except ValueError:
        return math.nan
    weights, gravity = 1 / mechanism.inertias.ravel(), np.tile([*mechanism.gravity, 0.0], len(mechanism.bodies))
    yields, biases = [], []
    for pose, reaction in zip(motion.pose, motion.reaction, strict=True):
        rows = mechanism.rows(pose)
        yields.append(np.abs((rows**2 @ weights) * reaction))
        # In the ideal motion the bias equals J a.
        biases.append(np.abs((rows * weights) @ (rows.T @ reaction) + rows @ gravity))
    yielding, bias = np.nanmax(yields, axis=0), np.nanmax(biases, axis=0)
    for step in np.geomspace(least, largest, 81):
        soft = engine.regularisation(mechanism, float(step))
        if soft is None:
            continue
        gap = (soft.compliance * yielding + (0.0 if soft.complete else bias)) / soft.stiffness
        if np.any(gap[np.array(soft.rows) & mechanism.holonomic] > TORN * mechanism.length_scale):
            return 0.0 if step == least else float(step)
    return math.inf


def residual_of_sweeps(mechanism: Mechanism, engine: Engine) -> float:
    """The fraction of the slowest mode's error that remains after the iterations of a step [1]. The result is NaN for
    an engine without a fixed number of Gauss-Seidel iterations. If each step should close the whole gap, gaps grow when
    this fraction is above 1/2 (`engines.pymunk.convergence`)."""
    count = engine.iterations_of(mechanism)
    return math.nan if count is None else float(convergence_factor(mechanism) ** count)


def as_csv(columns: Iterable[StoredColumn]) -> str:
    """The file's text, with sorted columns. `counts` is empty in a line if the line above has the same counts."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(StoredColumn)])
    previous: tuple[int, ...] = ()
    for column in sorted(columns, key=lambda column: (column.subject, column.engine, column.variant, column.value)):
        counts = "" if column.counts == previous else " ".join(map(str, column.counts))
        previous = column.counts
        errors = " ".join("-" if math.isnan(error) else f"{error:g}" for error in column.errors)
        numbers = (column.value, column.longest, column.gives, column.left)
        value, longest, tearing, residual = (f"{number:.4g}" for number in numbers)
        identity = (column.subject, column.engine, column.variant)
        writer.writerow([*identity, value, longest, counts, column.outcomes, errors, tearing, residual])
    return out.getvalue()


def read(path: Path) -> tuple[StoredColumn, ...]:
    """The columns of an atlas file; empty if the file does not exist. Raises ValueError if the file is not an atlas
    file."""
    if not path.is_file():
        return ()
    columns: list[StoredColumn] = []
    counts: tuple[int, ...] = ()
    try:
        for row in read_lines(path.read_text(encoding="utf-8"))[1]:
            counts = tuple(map(int, row["counts"].split())) or counts
            errors = tuple(math.nan if text == "-" else float(text) for text in row["errors"].split())
            numbers = {name: float(row[name]) for name in ("value", "longest", "gives", "left")}
            columns.append(StoredColumn(**{**row, **numbers, "counts": counts, "errors": errors}))  # type: ignore[arg-type]
            if not len(columns[-1].outcome_of_steps) == len(counts) == len(errors):
                raise ValueError("the counts, outcomes and errors of a line differ in number")
    except (KeyError, TypeError, ValueError, AttributeError):
        raise ValueError(f"{path}: not a file of the atlas; `crosscheck atlas` writes one") from None
    return tuple(columns)
