"""The maps of the atlas, their columns, and their file.

A map varies one parameter of a scene; its texts and ranges are in `maps.toml`. A column has the runs of one method at
one parameter value.
"""

from __future__ import annotations

import csv
import io
import math
import tomllib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from engines import Engine
from engines.pymunk.convergence import convergence_factor
from reference.mechanism import Mechanism
from reference.scene import Scene
from reference.scenes.four_bar.scenes import DrivenFourBar, FreeFourBar
from reference.scenes.n_four_bar import NFourBar
from reference.scenes.pendulum.link import PointPendulum
from reference.scenes.pendulum.scenes import LinkPendulum
from reference.scenes.rolling.scenes import RollingEllipse
from reference.scenes.skates import ChaplyginSleigh
from reference.scenes.slider_crank import DrivenSliderCrank
from reference.scenes.wheels.vehicles import CarAndTrailer
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.model.outcomes import TORN, Outcome
from reports.write.csv_files import read_lines

FILE = "atlas.csv"
FORCE_SAMPLES = 20
# Letter of a cell that was not run, because its neighbours at larger and smaller steps have the same outcome.
NOT_RUN = "="
# If two outcomes have the same letter, the letter is read as the first outcome.
BY_LETTER = {outcome.letter: outcome for outcome in reversed(Outcome)}
RunCells = Callable[[list[Cell]], Mapping[Cell, Measurement]]
MIN_STEPS = 10  # number of steps of a run at the largest step


@dataclass(frozen=True)
class StabilityMap:
    """A map of outcomes over step and parameter. `maps.toml` explains the fields that are missing here. make:
    parameter value -> scene. frequency: scene -> frequency of the fastest motion [rad/s], which predicts the step of
    failure."""

    name: str
    title: str
    parameter: str
    make: Callable[[float], Scene]
    values: tuple[float, float]
    frequency: Callable[[Any], float]
    fastest: str
    whole: bool = False
    doublings: float = 6.6
    page: str = ""
    remark: str = ""

    def at(self, points: int) -> tuple[float, ...]:
        """The parameter values: a geometric sequence, or for integers an arithmetic sequence without repetitions."""
        low, high = self.values
        if self.whole:
            return tuple(map(float, dict.fromkeys(np.linspace(low, high, points).round().tolist())))
        return tuple(float(f"{value:.4g}") for value in np.geomspace(low, high, points))

    def steps(self, points: int) -> tuple[tuple[int, int], ...]:
        """Pairs (samples, steps between samples) of at most `points` runs with decreasing steps [s]. A run has 10 to 20
        samples, so that the reference motion is evaluated at few instants."""
        by_count: dict[int, tuple[int, int]] = {}
        for doubling in np.linspace(0.0, self.doublings, points):
            every = 2 ** int(doubling)
            samples = round(MIN_STEPS * 2 ** (doubling - int(doubling)))
            by_count[samples * every] = (samples, every)
        return tuple(by_count[count] for count in sorted(by_count))


def near_the_largest_offset(gap: float) -> DrivenSliderCrank:
    """A driven slider-crank with the offset (1 - gap) times the largest possible offset."""
    plain = DrivenSliderCrank()
    return replace(plain, offset=(1 - gap) * (plain.rod - plain.crank), angle=math.pi / 2)


def rod_rate(scene: DrivenSliderCrank) -> float:
    """The largest rate of the rod during a turn of the crank [rad/s]. Sampled angles are dense near the upright rod."""
    angles = np.concatenate([np.linspace(0, 2 * math.pi, 721), math.pi / 2 * 3 + np.geomspace(1e-7, 0.1, 200)])
    return float(scene.rate * np.abs(scene.shape.rates(angles)[0]).max())


def short_trailer(length: float) -> CarAndTrailer:
    """A car and a trailer; the trailer has a drawbar of this length [m] and its centre of mass on the axle."""
    plain = CarAndTrailer()
    return replace(plain, length=length, centres=(plain.centres[0], 0.0), duration=2.0, horizon=2.0)


def ellipse(ratio: float) -> RollingEllipse:
    """An ellipse that starts on its flat side and is so slow that it keeps contact."""
    plain = RollingEllipse()
    return replace(plain, along_y=plain.along_x * ratio, start_rate=1.0, duration=1.0)


def rocking(scene: RollingEllipse) -> float:
    """The frequency of small oscillations about the flat side [rad/s]."""
    return scene.motion_law.small_frequency(scene.motion_law.rolling.theta)


def stiffest_hanging(scene: LinkPendulum) -> float:
    """The highest frequency of small oscillations about the hanging equilibrium [rad/s]."""
    return float(scene.chain.modes()[0][-1])


# Map -> (function that makes a scene from a parameter value, function that returns a scene's frequency). Motions of
# chains last 0.5 s, because chaos amplifies errors in longer motions.
SCENES_AND_FREQUENCIES: Mapping[str, tuple[Callable[[float], Scene], Callable[[Any], float]]] = {
    "coupler": (lambda x: FreeFourBar(density=(1.0, x, 1.0)), lambda scene: 1 / scene.mechanism().time_scale),
    "rate": (lambda x: DrivenFourBar(rate=x, revolutions=x * 0.5 / (2 * math.pi)), lambda scene: scene.rate),
    "tip": (lambda x: LinkPendulum(links=3, tip=x, duration=0.5, horizon=0.5), stiffest_hanging),
    "links": (lambda x: LinkPendulum(links=round(x), length=1 / round(x), duration=0.5, horizon=0.5), stiffest_hanging),
    "length": (
        lambda x: PointPendulum(length=x, duration=1.0, horizon=1.0),
        lambda scene: math.sqrt(9.81 / scene.length),
    ),
    "offset": (near_the_largest_offset, rod_rate),
    "sleigh": (lambda x: ChaplyginSleigh(offset=x, duration=1.0, horizon=1.0), lambda scene: abs(scene.turning_rate)),
    "drawbar": (short_trailer, lambda scene: scene.speed / scene.length),
    "ellipse": (ellipse, rocking),
    "loops": (lambda x: NFourBar(loops=round(x), duration=1.2, horizon=1.2), lambda scene: scene.pendulum.frequency),
}


def _read() -> Iterator[StabilityMap]:
    plans = tomllib.loads(Path(__file__).with_suffix(".toml").read_text(encoding="utf-8"))
    for name, plan in plans.items():
        make, frequency = SCENES_AND_FREQUENCIES[name]
        plan |= {"values": tuple(plan["values"]), "remark": " ".join(plan.get("remark", "").split())}
        yield StabilityMap(name, make=make, frequency=frequency, **plan)


MAPS: tuple[StabilityMap, ...] = tuple(_read())


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
