"""Running cells into a store: only those without an answer, each kept as soon as it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

from reference.trajectory import Trajectory
from reports.grid.cells import Cell
from reports.grid.measure import Measurement
from reports.grid.outcomes import Loss, Outcome
from reports.grid.pool import TIME_LIMIT, run_cells, worker_count
from reports.grid.store import Store
from reports.grid.supervisor import WorkersLost, supervise


def missing(cells: Iterable[Cell], store: Store, limit: float = TIME_LIMIT) -> tuple[Cell, ...]:
    """The cells without an answer to a run with this limit [s]: not stored, or timed out within a smaller limit."""
    cells = tuple(cells)
    known = store.get(cells)
    return tuple(cell for cell in cells if cell not in known or not answers(known[cell], limit))


def answers(row: Measurement, limit: float) -> bool:
    """Whether a run with this limit [s] would say the same as a stored row."""
    return row.outcome != Outcome.LOST and (row.outcome != Outcome.TIMED_OUT or row.limit >= limit)


def run_into(
    store: Store,
    cells: Sequence[Cell],
    fresh: bool = False,
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    done: Callable[[Measurement], None] = lambda row: None,
    watch: Callable[[list[Cell]], None] | None = None,
    timed: bool = True,
) -> int:
    """Run what is missing (everything if fresh), store each row as it arrives; how many were run.

    An interruption passes through, with the rows so far stored. Cells whose processes were killed from outside are not
    stored; when all others are done, WorkersLost is raised, with one line about them.
    """
    waiting = tuple(cells) if fresh else missing(cells, store, limit)  # an old row stays until the new one replaces it
    lost: list[Measurement] = []
    for row in run_cells(waiting, limit, workers, watch, timed):
        if row.outcome == Outcome.LOST:
            lost.append(row)
        else:
            store.put(row)
        done(row)
    if lost:
        first = f"{lost[0].scene} in {lost[0].method} at {lost[0].step:.1e} s: {lost[0].sentence}"
        raise WorkersLost(f"{len(lost)} of {len(waiting)} cells are lost, the others are stored; the first: {first}")
    return len(waiting)


def trajectory_of(cell: Cell) -> Trajectory:
    """One cell's motion, for a picture."""
    return cell.engine.build(cell.scene.mechanism(), cell.step)(cell.sample_count, cell.every)


def trajectories(cells: Sequence[Cell]) -> Mapping[Cell, Trajectory]:
    """The motions of cells, made in supervised processes; cells that fail are left out. Raises WorkersLost."""
    return {cell: result for cell, result in _untimed(trajectory_of, cells) if not isinstance(result, Loss)}


def support_of(cell: Cell) -> str:
    """Why an engine can't build a scene's mechanism, in its own words; empty if it can."""
    from engines import Unsupported

    try:
        cell.engine.build(cell.scene.mechanism(), cell.step)
    except Unsupported as reason:
        return str(reason)
    return ""


def support(cells: Sequence[Cell]) -> Mapping[Cell, str]:
    """Cell -> why it can't be built, in supervised processes; empty if it can. Raises WorkersLost."""
    return {
        cell: result.sentence if isinstance(result, Loss) else result for cell, result in _untimed(support_of, cells)
    }


def _untimed(function: Callable[[Cell], Any], cells: Sequence[Cell]) -> Iterator[tuple[Cell, Any]]:
    """(cell, result or Loss) of work whose CPU time nobody looks at; a lost cell would be a silent gap in a page."""
    for cell, result, _ in supervise(function, cells, TIME_LIMIT, worker_count(timed=False)):
        if isinstance(result, Loss) and result.outcome == Outcome.LOST:
            raise WorkersLost(f"{cell.label}: {result.sentence}")
        yield cell, result
