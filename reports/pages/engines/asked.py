"""What is asked of one engine apart from a cell: its cost, and how it is called in the line of progress."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from engines import Engine
from reports.grid.tasks import Task


@dataclass(frozen=True)
class Asked(Task):
    """Subclasses say in a few words `what` is asked of the engine `of`."""

    what: ClassVar[str]

    of: Engine

    @property
    def cost(self) -> float:
        return 0.1 + self.of.building

    @property
    def label(self) -> str:
        return f"{self.of.name} {self.of.variant}: {self.what}"

    @property
    def engine(self) -> Engine:
        return self.of
