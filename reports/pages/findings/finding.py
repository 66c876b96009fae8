"""A finding: a sentence with its numbers from the rows, and what has to hold for it."""

from __future__ import annotations

from dataclasses import dataclass

from reports.pages.findings.pictures import Line, axis_label
from reports.write.unmeasured import MARK

MILLISECOND = 1e-3  # s, the step at which findings compare: the grid of nearly every scene has it
TENTH = 1e-4  # s


@dataclass(frozen=True)
class Finding:
    """name: of the picture; title and text: Markdown, without the link to the page; lines: what the picture shows."""

    name: str
    title: str
    text: str
    page: str
    holds: bool
    lines: tuple[Line, ...]
    quantity: str  # of the picture, a name in `reports.model.quantities`

    @property
    def picture(self) -> str:
        """The name of its file."""
        return f"finding_{self.name}.svg"

    @property
    def alternative(self) -> str:
        """The picture in words, for who can't see it."""
        shown = "; ".join(line.label for line in self.lines)
        return f"{axis_label(self.quantity)} against step [ms]: {shown}"

    @property
    def told(self) -> bool:
        """Whether the rows have its numbers and bear its claims out."""
        return self.holds and MARK not in self.title + self.text
