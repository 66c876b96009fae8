"""Cells and tasks through supervised workers: a row or an answer for each, whatever becomes of its process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

from reports.grid.cells import Cell
from reports.grid.measure import Measurement, blank, measure
from reports.grid.outcomes import Loss, Outcome
from reports.grid.supervisor import Watch, supervise, usable_cores
from reports.grid.tasks import Answer, Task, answered

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
) -> Iterator[Measurement]:
    """Yield the measurement of every cell as it is done; a lost cell gives a row with its outcome and no numbers.

    `limit`: CPU seconds for one cell; `wall`: seconds for one that sleeps. `workers`: `worker_count` if None.
    `timed`: whether a cell is run again for the least of several times. Raises WorkersLost (`supervise`).
    """
    workers = worker_count(timed) if workers is None else workers
    cells = tuple(cells)
    for cell in cells:
        _ = cell.key  # travels with the cell: each new worker would read all sources for it, half a second long
    for cell, result, note in supervise(partial(measure, repeat=timed), cells, limit, workers, watch, wall):
        if not isinstance(result, Loss):
            yield replace(result, sentence="; ".join(filter(None, (result.sentence, _second_try(note)))))
        elif result.outcome == Outcome.TIMED_OUT:
            yield replace(blank(cell, result.outcome, result.sentence), limit=limit)
        else:
            yield blank(cell, result.outcome, result.sentence)


def run_tasks(
    tasks: Iterable[Task],
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    watch: Watch | None = None,
) -> Iterator[tuple[Task, Answer]]:
    """Yield every task with its answer as it is done; `limit`, `workers`, `watch` and what is raised as for cells.

    Nobody looks at the CPU time of a task, so all processors are used.
    """
    workers = worker_count(timed=False) if workers is None else workers
    for task, result, note in supervise(answered, tasks, limit, workers, watch):
        if not isinstance(result, Loss):
            yield task, replace(result, sentence="; ".join(filter(None, (result.sentence, _second_try(note)))))
        else:
            spent = limit if result.outcome == Outcome.TIMED_OUT else float("nan")
            yield task, Answer(result.outcome, result.sentence, limit=spent)


def _second_try(note: str) -> str:
    return f"the first try {note}, the second went through" if note else ""
