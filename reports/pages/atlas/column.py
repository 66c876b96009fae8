"""A column of the atlas, one scene at one value of its parameter, in some engines at every step; and its line."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from engines import Engine
from engines.pymunk.contraction import contraction
from reference.mechanism import Mechanism
from reference.scene import Scene
from reports.model.cells import Cell, estimated_cost
from reports.model.measure import Measurement, measure
from reports.model.outcomes import TORN, Outcome
from reports.model.tasks import Answer, Task, Values
from reports.pages.atlas.subjects import Subject
from reports.pages.atlas.table import LIKE_THE_LAST, Line, power

LOOKS = 20  # instants of the truth at which the forces are taken
SAMPLE = 300  # chunks and answers of nothing, by which the rates of a client are measured
NOT_RUN = ""  # instead of an outcome: the point lies between two of one outcome, and is drawn like them


@dataclass(frozen=True)
class Column(Task):
    """`steps` are (samples, steps a sample); every cell of a column is measured as any other cell of the grid is.

    Of `stride` steps one is run first, and others only where two that were run have different outcomes, until those are
    neighbours: a border is as sharp as if all had been run, and what is narrower than the stride may be missed. All
    engines of a value are one task, since they share its truth. A column whose process ends is asked again cell by cell
    (`singles`), so that an abort costs one cell.
    """

    scene: Scene
    engines: tuple[Engine, ...]
    steps: tuple[tuple[int, int], ...]
    stride: int = 1

    @property
    def cost(self) -> float:
        return sum(estimated_cost(cell) + 2e-3 for engine in self.engines for cell in self.cells(engine))

    @property
    def label(self) -> str:
        return f"{self.scene.name}, {len(self.engines) * len(self.steps)} cells"

    def cells(self, engine: Engine) -> tuple[Cell, ...]:
        return tuple(Cell(self.scene, engine, every, "map", samples) for samples, every in self.steps)

    @property
    def singles(self) -> tuple[Column, ...]:
        """Its cells, each a column of its own."""
        return tuple(
            replace(self, engines=(engine,), steps=(one,), stride=1) for engine in self.engines for one in self.steps
        )

    def run(self) -> Values:
        """outcomes: words of all steps, engine by engine, with commas between, NOT_RUN of those that were not run;
        errors (engines, steps) [rad].

        seconds (engines,): CPU time of the cells, the first engine's with that of the truth. gives (engines,) [s] and
        left (engines,): see `gives_from` and `left_by_sweeps`.
        """
        outcomes: list[str] = []
        errors, seconds = [], []
        for engine in self.engines:
            begin = time.process_time()
            cells = self.cells(engine)
            rows = bisected(lambda place, cells=cells: measure(cells[place], repeat=False), len(cells), self.stride)
            seconds.append(time.process_time() - begin)
            outcomes += [str(rows[place].outcome) if place in rows else NOT_RUN for place in range(len(cells))]
            errors.append([rows[place].angle if place in rows else math.nan for place in range(len(cells))])
        mechanism = self.scene.mechanism()
        times = sorted(cell.step for cell in self.cells(self.engines[0]))
        return {
            "outcomes": ",".join(outcomes),
            "errors": np.array(errors),
            "seconds": np.array(seconds),
            "gives": np.array(gives_from(self.scene, mechanism, self.engines, times[0], times[-1])),
            "left": np.array([left_by_sweeps(mechanism, engine) for engine in self.engines]),
        }


def bisected(row_at: Callable[[int], Measurement], count: int, stride: int) -> dict[int, Measurement]:
    """The rows of some of `count` places: one of `stride`, the first and the last, and more between unlike outcomes."""
    places = sorted({*range(0, count, stride), count - 1})
    rows = {place: row_at(place) for place in places}
    unlike = list(pairwise(places))
    while unlike:
        low, high = unlike.pop()
        if high - low > 1 and rows[low].outcome != rows[high].outcome:
            middle = (low + high) // 2
            rows[middle] = row_at(middle)
            unlike += [(low, middle), (middle, high)]
    return rows


def gives_from(
    scene: Scene, mechanism: Mechanism, engines: Sequence[Engine], least: float, largest: float
) -> list[float]:
    """The step [s] from which on a joint opens so far by its own softness that a cell counts as torn, of each engine.

    What an engine declares (`engines.Softness`) is J a = bias - damping slip - stiffness gap - compliance A reaction, A
    each row's own inverse inertia. Where the gap no longer changes it is (compliance A reaction, and bias where the
    engine leaves that out) over stiffness; the forces are those of the ideal motion. Looked for from `least` to
    `largest` [s]: 0 and inf stand for all and for no step; NaN where no truth is known.
    """
    try:
        motion = scene.motion(np.linspace(0, min(scene.duration, scene.comparable_until), LOOKS))
    except ValueError:
        return [math.nan] * len(engines)
    weights, gravity = 1 / mechanism.inertias.ravel(), np.tile([*mechanism.gravity, 0.0], len(mechanism.bodies))
    pushed, wanted = [], []
    for pose, reaction in zip(motion.pose, motion.reaction, strict=True):
        rows = mechanism.rows(pose)
        pushed.append(np.abs((rows**2 @ weights) * reaction))
        # J a of the ideal motion is the bias.
        wanted.append(np.abs((rows * weights) @ (rows.T @ reaction) + rows @ gravity))
    push, bias = np.nanmax(pushed, axis=0), np.nanmax(wanted, axis=0)
    found = []
    for engine in engines:
        place = math.inf
        for step in np.geomspace(least, largest, 81):
            softness = engine.softness(mechanism, float(step))
            if softness is None:
                continue
            gap = (softness.compliance * push + (0.0 if softness.complete else bias)) / softness.stiffness
            if np.any(gap[np.array(softness.rows) & mechanism.holonomic] > TORN * mechanism.length_scale):
                place = 0.0 if step == least else float(step)
                break
        found.append(place)
    return found


def left_by_sweeps(mechanism: Mechanism, engine: Engine) -> float:
    """What a step's sweeps leave of the slowest mode [1]; NaN for an engine whose solver does not sweep by a number.

    From half on, a gap that is closed in one step grows from step to step (`engines.pymunk.contraction`).
    """
    count = engine.iterations_of(mechanism)
    return math.nan if count is None else float(contraction(mechanism) ** count)


@dataclass(frozen=True)
class Nothing(Task):
    """Takes no time but that of its way to a worker and back; so long by its own word that it is a chunk alone."""

    number: int

    @property
    def cost(self) -> float:
        return 10.0

    @property
    def label(self) -> str:
        return "nothing"

    def run(self) -> Values:
        return {"number": np.array(float(self.number))}


def line_of(
    subject: Subject, value: float, column: Column, engine: Engine, answers: Mapping[Any, Answer]
) -> tuple[Line, float]:
    """(an engine's line, CPU seconds of its cells), from a column's own answer or from those of its cells."""
    outcomes, errors, seconds = [], [], 0.0
    gives = left = math.nan
    index, count = column.engines.index(engine), len(column.steps)
    if column in answers:
        answer = answers[column]
        outcomes = str(answer.values["outcomes"]).split(",")[index * count : (index + 1) * count]
        errors, seconds = list(answer.array("errors")[index]), float(answer.array("seconds")[index])
        gives, left = float(answer.array("gives")[index]), float(answer.array("left")[index])
    else:
        for single in column.singles[index * count : (index + 1) * count]:
            answer = answers.get(single, Answer(Outcome.LOST))
            outcomes.append(str(answer.values["outcomes"]) if answer.finished else str(answer.outcome))
            errors.append(float(answer.array("errors")[0, 0]) if answer.finished else math.nan)
            seconds += float(answer.array("seconds")[0]) if answer.finished else 0.0
            left = float(answer.array("left")[0]) if answer.finished else left
    told = [Outcome(word) if word else None for word in outcomes]
    counts = tuple(samples * every for samples, every in column.steps)
    line = Line(
        subject.name,
        engine.name,
        engine.variant,
        value,
        column.scene.duration / counts[0],
        counts,
        "".join(outcome.letter if outcome else LIKE_THE_LAST for outcome in told),
        tuple(power(error) if one and one.comparable else math.nan for one, error in zip(told, errors, strict=True)),
        gives,
        left,
    )
    return line, seconds
