"""Lines of a table that an engine's motion gives while a page is written: what is read from it, or why it has none."""

from __future__ import annotations

from collections.abc import Callable

from engines import Unsupported
from reference.trajectory import Trajectory
from reports.grid.cells import Cell
from reports.grid.running import trajectory_of
from reports.pages.page import Observation


def observe(cell: Cell, setting: str, say: Callable[[Trajectory], str]) -> tuple[Observation, ...]:
    """The line of one engine, with what `say` reads from its motion; none where it has no such joint.

    Whatever else an engine raises is what happened, and stands in its line: one engine's fault must not cost the page.
    """
    method = f"{cell.engine.name} {cell.engine.variant}"
    try:
        told = say(trajectory_of(cell))
    except Unsupported:
        return ()
    except Exception as reason:
        told = f"failed: {type(reason).__name__}: {reason}"
    return (Observation(method, setting, told),)
