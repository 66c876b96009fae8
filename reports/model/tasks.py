"""A task computes data of a page besides its rows: a motion, or a number by integration. Its answer is stored.

Nothing is stepped or integrated while a page is written: it reads the answers to its tasks, as it reads rows.
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
    """The result of a task: its values by name if it finished, else a sentence with the reason."""

    outcome: Outcome
    sentence: str = ""
    values: Values = field(default_factory=dict)
    limit: float = float("nan")  # CPU seconds, of a task that was timed out: with more it might have ended

    @property
    def finished(self) -> bool:
        return self.outcome == Outcome.FINISHED

    def array(self, name: str) -> Array:
        """A value that is an array. Raises KeyError for one that is not there."""
        return np.asarray(self.values[name], dtype=float)

    def number(self, name: str) -> float:
        """A value that is one number. Raises KeyError for one that is not there."""
        return float(self.array(name))

    @property
    def told(self) -> str:
        """'**aborted**: why', for a table."""
        return f"**{self.outcome}**{': ' + self.sentence if self.sentence else ''}"


class Task(ABC):
    """Subclasses are frozen dataclasses: a task can be pickled for a worker, and its fields identify it.

    An answer is stale when a source file of this suite changes.
    """

    seconds: ClassVar[float] = 1.0  # about how long it takes, where that does not depend on the fields
    words: ClassVar[str] = "{0!r}"  # the label, a format of the task

    @property
    def cost(self) -> float:
        """About how long it takes [s]; an estimate, the same on every machine."""
        return self.seconds

    @property
    def label(self) -> str:
        """A few words for the line of progress."""
        return self.words.format(self)

    @property
    def engine(self) -> Engine | None:
        """The engine that is run; None for a method that is no engine."""
        return None

    @abstractmethod
    def run(self) -> Values:
        """Numbers (float64 arrays) and words by name. Raises Unsupported, or ValueError for input that can't be."""

    @cached_property
    def key(self) -> str:
        """A digest of all that the answer depends on; equal keys mean that a stored answer still holds."""
        parts = ("task", type(self).__qualname__, repr(self), fingerprint(self, folders=OURS))
        return digest("\0".join(parts), LONG)


@dataclass(frozen=True)
class Motion(Task):
    """The whole trajectory of a cell, for a picture or an experiment."""

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
    """The trajectory in the answer to a Motion. Raises KeyError for another answer."""
    return Trajectory(answer.array("t"), answer.array("pose"), answer.array("twist"), answer.array("reaction"))


def answered(task: Task) -> Answer:
    """Run a task in this process. Refusals become outcomes; other exceptions pass (the pool records them)."""
    with np.errstate(all="ignore"):
        try:
            with spending("tasks"):
                return Answer(Outcome.FINISHED, values=task.run())
        except (Unsupported, ValueError) as reason:
            loss = refusal(reason)
            return Answer(loss.outcome, loss.sentence)
