"""Cells through supervised workers: one row for every cell, whatever becomes of its process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

from reports.grid.cells import Cell
from reports.grid.measure import Measurement, blank, measure
from reports.grid.outcomes import Loss, Outcome
from reports.grid.supervisor import Supervise, Watch, supervise, usable_cores

TIME_LIMIT = 60.0  # s of CPU time for one cell: far above the cost limit of the grid, so only a hang meets it
TIMED_WORKERS = 2


def worker_count(timed: bool) -> int:
    """How many workers run at the same time. Cells that are timed share a processor's caches with few others."""
    return TIMED_WORKERS if timed else usable_cores()


def run_cells(
    cells: Iterable[Cell],
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    watch: Watch | None = None,
    timed: bool = True,
    wall: float | None = None,
    supervised: Supervise = supervise,
) -> Iterator[Measurement]:
    """Yield the measurement of every cell as it is done; a lost cell gives a row with its outcome and no numbers.

    `limit`: CPU seconds for one cell; `wall`: seconds for one that sleeps. `workers`: `worker_count` if None.
    `timed`: whether a cell is run again for the least of several times. `supervised`: by whom. Raises
    WorkersLost (`supervise`).
    """
    workers = worker_count(timed) if workers is None else workers
    cells = tuple(cells)
    for cell in cells:
        _ = cell.key  # travels with the cell: each new worker would read all sources for it, half a second long
    for cell, result, note in supervised(partial(measure, repeat=timed), cells, limit, workers, watch, wall):
        if not isinstance(result, Loss):
            told = f"the first try {note}, the second went through" if note else ""
            yield replace(result, sentence="; ".join(filter(None, (result.sentence, told))))
        elif result.outcome == Outcome.TIMED_OUT:
            yield replace(blank(cell, result.outcome, result.sentence), limit=limit)
        else:
            yield blank(cell, result.outcome, result.sentence)
