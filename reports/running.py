"""Running cells into a store: only those that are missing, each kept as soon as it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence

from reference.trajectory import Trajectory
from reports.cells import Cell
from reports.measure import Measurement
from reports.pool import TIME_LIMIT, WORKERS, Loss, run_cells, supervise
from reports.store import Store


def missing(cells: Iterable[Cell], store: Store) -> tuple[Cell, ...]:
    """The cells without a stored row."""
    cells = tuple(cells)
    known = store.get(cells)
    return tuple(cell for cell in cells if cell not in known)


def run_into(
    store: Store,
    cells: Sequence[Cell],
    fresh: bool = False,
    limit: float = TIME_LIMIT,
    workers: int = WORKERS,
    done: Callable[[Measurement], None] = lambda row: None,
    watch: Callable[[list[Cell]], None] | None = None,
    timed: bool = True,
) -> int:
    """Run what is missing (everything if fresh), store each row as it arrives; how many were run.

    An interruption passes through, with the rows so far stored.
    """
    if fresh:
        store.forget(cells)
    waiting = missing(cells, store)
    for row in run_cells(waiting, limit, workers, watch, timed):
        store.put(row)
        done(row)
    return len(waiting)


def trajectory_of(cell: Cell) -> Trajectory:
    """One cell's motion, for a picture."""
    return cell.engine.build(cell.scene.mechanism(), cell.step)(cell.sample_count, cell.every)


def trajectories(cells: Sequence[Cell]) -> Mapping[Cell, Trajectory]:
    """The motions of cells, made in supervised processes; cells that fail are left out."""
    return {cell: result for cell, result in supervise(trajectory_of, cells) if not isinstance(result, Loss)}


def support_of(cell: Cell) -> str:
    """Why an engine can't build a scene's mechanism, in its own words; empty if it can."""
    from engines import Unsupported

    try:
        cell.engine.build(cell.scene.mechanism(), cell.step)
    except Unsupported as reason:
        return str(reason)
    return ""


def support(cells: Sequence[Cell]) -> Mapping[Cell, str]:
    """Cell -> why it can't be built, in supervised processes; empty if it can."""
    return {
        cell: result.sentence if isinstance(result, Loss) else result for cell, result in supervise(support_of, cells)
    }
