"""A task computes further data of a page, such as a motion. The answer is stored like a row.

So a page is written from stored data alone, without stepping or integration.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from engines import Engine, Unsupported
from engines.trajectory_check import flaw
from reference.trajectory import Trajectory
from reports.model.cells import Cell, estimated_cost
from reports.model.fingerprint import LONG, OURS, digest, fingerprint
from reports.model.outcomes import Outcome, refusal
from reports.model.spending import spending

Array = NDArray[np.float64]
Values = Mapping[str, Array | str]


@dataclass(frozen=True, eq=False)
class Answer:
    """The result of a task, with values by name, or a sentence with the reason why there are no values."""

    outcome: Outcome
    sentence: str = ""
    values: Values = field(default_factory=dict)
    limit: float = float("nan")  # Limit [CPU seconds] at which a task timed out.

    @property
    def finished(self) -> bool:
        return self.outcome == Outcome.FINISHED

    def array(self, name: str) -> Array:
        """The array with this name. Raises KeyError if it is missing."""
        return np.asarray(self.values[name], dtype=float)

    def number(self, name: str) -> float:
        """The number with this name. Raises KeyError if it is missing."""
        return float(self.array(name))

    @property
    def told(self) -> str:
        return f"**{self.outcome}**{': ' + self.sentence if self.sentence else ''}"


class Task(ABC):
    """The base of tasks, which are frozen dataclasses. A task can be pickled for a worker. The fields of a task
    identify its answer. An answer is stale when a source file of this suite changes."""

    seconds: ClassVar[float] = 1.0  # Estimated CPU time if it does not depend on the fields.
    words: ClassVar[str] = "{0!r}"  # Format string of the label, in which {0} is the task.

    @property
    def cost(self) -> float:
        """Estimated CPU time [s]. The estimate does not depend on the machine."""
        return self.seconds

    @property
    def label(self) -> str:
        return self.words.format(self)

    @property
    def engine(self) -> Engine | None:
        return None

    @abstractmethod
    def run(self) -> Values:
        """Name -> float64 array or text. Raises Unsupported and ValueError."""

    @cached_property
    def key(self) -> str:
        """A digest of everything that affects the answer. A stored answer with the same key is valid."""
        parts = ("task", type(self).__qualname__, repr(self), fingerprint(self, folders=OURS))
        return digest("\0".join(parts), LONG)


@dataclass(frozen=True)
class Motion(Task):
    cell: Cell

    @property
    def cost(self) -> float:
        return estimated_cost(self.cell)

    @property
    def label(self) -> str:
        return f"motion: {self.cell.label}"

    @property
    def engine(self) -> Engine:
        return self.cell.engine

    def run(self) -> Values:
        cell, mechanism = self.cell, self.cell.scene.mechanism()
        run = cell.engine.build(mechanism, cell.step)(cell.sample_count, cell.every)
        if reason := flaw(run, mechanism, cell.step, cell.sample_count, cell.every):
            raise ValueError(reason)
        return {"t": run.t, "pose": run.pose, "twist": run.twist, "reaction": run.reaction}


def trajectory_of(answer: Answer) -> Trajectory:
    """The trajectory in the answer to a Motion. Raises KeyError for any other answer."""
    return Trajectory(answer.array("t"), answer.array("pose"), answer.array("twist"), answer.array("reaction"))


def answered(task: Task) -> Answer:
    """Run a task in this process. Refusals become outcomes. Other exceptions are raised."""
    with np.errstate(all="ignore"):
        try:
            with spending("tasks"):
                return Answer(Outcome.FINISHED, values=task.run())
        except (Unsupported, ValueError) as reason:
            loss = refusal(reason)
            return Answer(loss.outcome, loss.sentence)
