"""What a word brings does in a worker first what a command will ask of it: somebody else's code may end a process."""

from __future__ import annotations

import multiprocessing
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

import numpy as np

from engines import Engine
from engines.registry import VARIANTS
from reference.scene import Scene
from reports.cli.known import Given, values_of
from reports.model.catalogue import SCENES
from reports.model.cells import Cell, estimated_cost
from reports.model.ending import BadInput
from reports.model.outcomes import Loss
from reports.run.pool import TIME_LIMIT
from reports.run.supervisor import supervise

SLEEPING = 2 * TIME_LIMIT  # s of one that does not use its CPU time


@dataclass(frozen=True)
class Trial:
    """What a worker does: read what is given, and ask its members. `motion`: the motion at the samples too."""

    motion: bool

    def __call__(self, given: Given) -> str:
        """Why it can't be used, a sentence; empty if it can."""
        try:
            values = values_of(given)
        except ValueError as reason:
            return str(reason)
        for value in values:
            _touch(value)
            if isinstance(value, Scene):
                _ask(value, self.motion)
            else:
                _ask_costs(SCENES, (value,))
        return ""


def _touch(value: Any) -> None:
    """As the tables, dictionaries and lists of a command do."""
    if not (isinstance(hash(value), int) and value == value and isinstance(repr(value), str)):
        raise ValueError("it is not equal to itself")


def _ask(scene: Scene, motion: bool) -> None:
    scene.mechanism()
    _ask_costs((scene,), VARIANTS)
    if motion:
        with suppress(ValueError):  # the textbook refuses, which pages can tell
            scene.motion(np.linspace(0.0, scene.duration, scene.samples + 1))


def _ask_costs(scenes: Sequence[Scene], engines: Sequence[Engine]) -> None:
    for scene in scenes:
        for engine in engines:
            with suppress(BadInput):  # that is told where the cost is needed
                estimated_cost(Cell(scene, engine, 1))


def refused(given: Sequence[Given], motion: bool = False) -> dict[Given, str]:
    """Why some of what is given can't be used, a sentence each. Raises WorkersLost."""
    if not given or multiprocessing.parent_process() is not None:  # a worker asks for itself
        return {}
    found = {}
    for each, result, _ in supervise(Trial(motion), given, TIME_LIMIT, workers=1, wall=SLEEPING):
        if isinstance(result, Loss):
            found[each] = f"{each.word}: its own code can't be used: {result.sentence}"
        elif result:
            found[each] = result
    return found
