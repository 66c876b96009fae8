"""Columns of the atlas: one scene at one value of its parameter in one method, at every step; and the file of them."""

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
from engines.pymunk.contraction import contraction
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import TORN, Outcome
from reports.pages.atlas.subjects import Subject
from reports.write.csv_files import read_lines

FILE = "atlas.csv"
LOOKS = 20  # instants of the truth at which the forces are taken
NOT_RUN = "="  # instead of a letter: the cell lies between two of one outcome, and counts as the one before it
BY_LETTER = {outcome.letter: outcome for outcome in reversed(Outcome)}  # of two that share one, finished
Run = Callable[[list[Cell]], Mapping[Cell, Measurement]]


@dataclass(frozen=True)
class Line:
    """A column of a map as it is stored, the largest step first.

    outcomes: a letter a step (`Outcome.letter`, or NOT_RUN). errors: the power of ten of the angle's error [rad] of a
    cell that was run and finished; NaN else. longest [s]: the largest step; counts: steps of each run. gives [s]: of
    `gives_from`; left: of `left_by_sweeps`.
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
        """The outcome of each step, of one that was not run that of the step before it."""
        outcomes: list[Outcome] = []
        for letter in self.outcomes:
            outcomes.append(outcomes[-1] if letter == NOT_RUN and outcomes else BY_LETTER[letter])
        return tuple(outcomes)

    @property
    def run(self) -> int:
        """How many of its steps were run."""
        return len(self.outcomes) - self.outcomes.count(NOT_RUN)


@dataclass(frozen=True)
class Column:
    """A value of a map in one method; `steps` are (samples, steps a sample), the largest step first."""

    subject: Subject
    value: float
    scene: Scene
    engine: Engine
    steps: tuple[tuple[int, int], ...]

    @property
    def cells(self) -> tuple[Cell, ...]:
        return tuple(Cell(self.scene, self.engine, every, "map", samples) for samples, every in self.steps)


def columns_of(subject: Subject, engines: Iterable[Engine], points: int) -> list[Column]:
    """All columns of a map with so many points along each side."""
    steps, values = subject.steps(points), subject.at(points)
    scenes = {value: subject.make(value) for value in values}
    return [Column(subject, value, scenes[value], engine, steps) for value in values for engine in engines]


def run_columns(columns: Sequence[Column], run: Run, stride: int) -> list[dict[int, Measurement]]:
    """The rows of each column by the step's place: one step of `stride`, and the others only near a border.

    Between two that have different outcomes the middle one is run, until those are neighbours: a border is as sharp as
    if all had been run, and what is narrower than the stride may be missed. `run` is called once a round.
    """
    rows: list[dict[int, Measurement]] = [{} for _ in columns]
    wanted = [sorted({*range(0, len(column.steps), stride), len(column.steps) - 1}) for column in columns]
    while any(wanted):
        cells = [[column.cells[place] for place in places] for column, places in zip(columns, wanted, strict=True)]
        answers = run([cell for some in cells for cell in some])
        for by_place, places, some in zip(rows, wanted, cells, strict=True):
            by_place |= {place: answers[cell] for place, cell in zip(places, some, strict=True)}
        wanted = [
            [
                (low + high) // 2
                for low, high in pairwise(sorted(by_place))
                if high - low > 1 and by_place[low].outcome != by_place[high].outcome
            ]
            for by_place in rows
        ]
    return rows


def line_of(column: Column, rows: Mapping[int, Measurement]) -> Line:
    """A column as it is kept, with the two predictions of where its runs begin to fail."""
    mechanism, engine = column.scene.mechanism(), column.engine
    counts = tuple(samples * every for samples, every in column.steps)
    longest, shortest = column.scene.duration / counts[0], column.scene.duration / counts[-1]
    places = range(len(counts))
    return Line(
        column.subject.name,
        engine.name,
        engine.variant,
        column.value,
        longest,
        counts,
        "".join(Outcome(rows[place].outcome).letter if place in rows else NOT_RUN for place in places),
        tuple(_power(rows[place]) if place in rows else math.nan for place in places),
        gives_from(column.scene, mechanism, engine, shortest, longest),
        left_by_sweeps(mechanism, engine),
    )


def _power(row: Measurement) -> float:
    """The power of ten of an angle's error, to a tenth; NaN where it can't be compared."""
    usable = Outcome(row.outcome).comparable and math.isfinite(row.angle) and row.angle > 0
    return round(math.log10(row.angle), 1) if usable else math.nan


def gives_from(scene: Scene, mechanism: Mechanism, engine: Engine, least: float, largest: float) -> float:
    """The step [s] from which on a joint opens so far by the engine's own softness that a cell counts as torn.

    An engine declares (`engines.Regularisation`) J a = bias - damping slip - stiffness gap - compliance A reaction, A
    each row's own inverse inertia. Where the gap no longer changes it is (compliance A reaction, and bias where the
    engine leaves that out) over stiffness; the forces are those of the ideal motion. Looked for from `least` to
    `largest` [s]: 0 and inf stand for all and for no step; NaN where no truth is known.
    """
    try:
        motion = scene.motion(np.linspace(0, min(scene.duration, scene.comparable_until), LOOKS))
    except ValueError:
        return math.nan
    weights, gravity = 1 / mechanism.inertias.ravel(), np.tile([*mechanism.gravity, 0.0], len(mechanism.bodies))
    pushed, wanted = [], []
    for pose, reaction in zip(motion.pose, motion.reaction, strict=True):
        rows = mechanism.rows(pose)
        pushed.append(np.abs((rows**2 @ weights) * reaction))
        # J a of the ideal motion is the bias.
        wanted.append(np.abs((rows * weights) @ (rows.T @ reaction) + rows @ gravity))
    push, bias = np.nanmax(pushed, axis=0), np.nanmax(wanted, axis=0)
    for step in np.geomspace(least, largest, 81):
        softness = engine.regularisation(mechanism, float(step))
        if softness is None:
            continue
        gap = (softness.compliance * push + (0.0 if softness.complete else bias)) / softness.stiffness
        if np.any(gap[np.array(softness.rows) & mechanism.holonomic] > TORN * mechanism.length_scale):
            return 0.0 if step == least else float(step)
    return math.inf


def left_by_sweeps(mechanism: Mechanism, engine: Engine) -> float:
    """What a step's sweeps leave of the slowest mode [1]; NaN for an engine whose solver does not sweep by a number.

    From half on, a gap that is closed in one step grows from step to step (`engines.pymunk.contraction`).
    """
    count = engine.iterations_of(mechanism)
    return math.nan if count is None else float(contraction(mechanism) ** count)


def as_csv(lines: Iterable[Line]) -> str:
    """A line a column, sorted; the counts of steps only where they change."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow([field.name for field in fields(Line)])
    before: tuple[int, ...] = ()
    for line in sorted(lines, key=lambda line: (line.subject, line.engine, line.variant, line.value)):
        counts = "" if line.counts == before else " ".join(map(str, line.counts))
        before = line.counts
        errors = " ".join("-" if math.isnan(error) else f"{error:g}" for error in line.errors)
        value, longest, gives, left = (f"{x:.4g}" for x in (line.value, line.longest, line.gives, line.left))
        identity = (line.subject, line.engine, line.variant)
        writer.writerow([*identity, value, longest, counts, line.outcomes, errors, gives, left])
    return out.getvalue()


def read(path: Path) -> tuple[Line, ...]:
    """Read such a file; nothing where there is none. Raises ValueError for a file that is none of these."""
    if not path.is_file():
        return ()
    lines: list[Line] = []
    counts: tuple[int, ...] = ()
    try:
        for row in read_lines(path.read_text(encoding="utf-8"))[1]:
            counts = tuple(map(int, row["counts"].split())) or counts
            errors = tuple(math.nan if word == "-" else float(word) for word in row["errors"].split())
            numbers = {name: float(row[name]) for name in ("value", "longest", "gives", "left")}
            lines.append(Line(**{**row, **numbers, "counts": counts, "errors": errors}))  # type: ignore[arg-type]
            if not len(lines[-1].told) == len(counts) == len(errors):
                raise ValueError("the counts, outcomes and errors of a line differ in number")
    except (KeyError, TypeError, ValueError, AttributeError):
        raise ValueError(f"{path}: it is no atlas; `crosscheck atlas` writes one") from None
    return tuple(lines)
