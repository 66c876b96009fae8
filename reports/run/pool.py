"""Cells and tasks through supervised workers: one answer for every one, whatever becomes of its process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from reports.model.cells import Cell
from reports.model.measure import TIMED, Measurement, blank, measure
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Answer, Task, answered
from reports.run.expected import dearest_first
from reports.run.processors import apart, usable_cores
from reports.run.supervisor import Supervise, Watch, supervise

TIME_LIMIT = 60.0  # s of CPU time for one cell: far above the cost limit of the grid, so only a hang meets it

Item = TypeVar("Item", bound=Cell | Task)


@dataclass(frozen=True)
class Working:
    """What a worker does with a cell or a task: see `run_items`."""

    timed: bool
    truths: Path | None

    def __call__(self, item: Cell | Task) -> Measurement | Answer:
        return measure(item, self.timed, self.truths) if isinstance(item, Cell) else answered(item)


def worker_count(timed: bool) -> int:
    """How many workers run at the same time: one on each processor; of those that time, one on each core."""
    return len(apart()) if timed else usable_cores()


def run_items(
    items: Iterable[Item],
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    watch: Watch | None = None,
    timed: bool = True,
    wall: float | None = None,
    supervised: Supervise = supervise,
    truths: Path | None = None,
) -> Iterator[tuple[Item, Any]]:
    """Yield every cell with its Measurement and every task with its Answer as they are done, the dearest begun first.

    A lost one has its outcome and no numbers. `limit`: CPU seconds for one; `wall`: seconds for one that sleeps.
    `workers`: `worker_count` if None. `timed`: whether a cell is run again for the least of several times; cells that
    are timed have a core each, so where more workers are asked for, the others run afterwards. `supervised`: by whom.
    `truths`: a folder of exact motions that workers share (`reports.model.truths`). Raises WorkersLost (`supervise`).
    """
    items = tuple(items)
    for item in items:  # these travel with it: each new worker would read all sources for them, half a second long
        _ = item.key, isinstance(item, Cell) and item.truth
    most = worker_count(timed=False) if workers is None else workers
    clocked = {item for item in items if timed and isinstance(item, Cell) and item.purpose in TIMED}
    own = min(most, worker_count(timed=True)) if clocked else most
    rounds = [(items, own, bool(clocked))]
    if own < most:
        rounds = [(tuple(clocked), own, True), (tuple(item for item in items if item not in clocked), most, False)]
    work = Working(timed, truths)
    for some, count, alone in rounds:
        for item, result, note in supervised(work, dearest_first(some), limit, count, watch, wall, alone):
            yield item, _told(item, result, note, limit)


def _told(item: Cell | Task, result: Any, note: str, limit: float) -> Measurement | Answer:
    """What is kept of what a worker answered, or of what became of it."""
    if not isinstance(result, Loss):
        told = f"the first try {note}, the second went through" if note else ""
        return replace(result, sentence="; ".join(filter(None, (result.sentence, told))))
    spent = limit if result.outcome == Outcome.TIMED_OUT else float("nan")
    if isinstance(item, Cell):
        return replace(blank(item, result.outcome, result.sentence), limit=spent)
    return Answer(result.outcome, result.sentence, limit=spent)


def run_cells(cells: Iterable[Cell], **terms: Any) -> Iterator[Measurement]:
    """Yield the measurement of every cell as it is done; terms: those of `run_items`, by their names."""
    for _, row in run_items(cells, **terms):
        yield row
