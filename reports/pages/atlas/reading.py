"""From the answers to a column to a line of the atlas's file."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from engines import Engine
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Task, Values
from reports.pages.atlas.column import Column
from reports.pages.atlas.subjects import Subject
from reports.pages.atlas.table import LIKE_THE_LAST, Line, power

SAMPLE = 300  # chunks and answers of nothing, by which the rates of a client are measured


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
