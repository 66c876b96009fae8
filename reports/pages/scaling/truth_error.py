"""How far a truth by integration may be off, which takes a second integration to know."""

from __future__ import annotations

from dataclasses import dataclass

from reference.scenes.many_links import LongPendulum
from reports.grid.tasks import Task, Values


@dataclass(frozen=True)
class TruthError(Task):
    """The truth of a long chain at the end of its run."""

    scene: LongPendulum

    @property
    def cost(self) -> float:
        return 0.5  # measured, with 200 links

    @property
    def label(self) -> str:
        return f"error of the truth of {self.scene.links} links"

    def run(self) -> Values:
        """`error`: the largest of an angle [rad]."""
        return {"error": self.scene.truth_error([self.scene.duration])[0]}
