"""Cells and tasks through supervised workers: one answer for every one, kept in a store as soon as it is there."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from reports.model.cells import Cell
from reports.model.measure import TIMED, Measurement, blank, measure
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Answer, Task, answered
from reports.model.truths import FOLDER
from reports.run.files import folder_for
from reports.run.queue import apart, dearest_first, usable
from reports.run.store import ELSEWHERE, Store
from reports.run.supervisor import Supervise, Watch, WorkersLost, supervise

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
    return len(apart()) if timed else len(usable())


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


def missing(items: Iterable[Item], store: Store, limit: float = TIME_LIMIT) -> tuple[Item, ...]:
    """The cells and tasks without an answer to a run with this limit [s]: not stored, or timed out within a smaller."""
    items = tuple(items)
    known = {**store.get(_cells(items)), **store.answers(_tasks(items))}
    return tuple(item for item in items if item not in known or not holds(known[item], limit))


def holds(result: Measurement | Answer, limit: float) -> bool:
    """Whether a run with this limit [s] would say the same as what is stored."""
    return result.outcome != Outcome.LOST and (result.outcome != Outcome.TIMED_OUT or result.limit >= limit)


def _cells(items: Iterable[Cell | Task]) -> tuple[Cell, ...]:
    return tuple(item for item in items if isinstance(item, Cell))


def _tasks(items: Iterable[Cell | Task]) -> tuple[Task, ...]:
    return tuple(item for item in items if isinstance(item, Task))


def run_into(
    store: Store,
    items: Sequence[Cell | Task],
    fresh: bool = False,
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    done: Callable[[Measurement | Answer], None] = lambda result: None,
    watch: Callable[[list[Any]], None] | None = None,
    timed: bool = True,
    supervised: Supervise = supervise,
) -> int:
    """Run what is missing (everything if fresh), the dearest first; store each result as it arrives; how many were run.

    An interruption passes through, with the results so far stored. What was killed from outside is not stored; when all
    others are done, WorkersLost is raised, with one line about it.
    """
    waiting = tuple(items) if fresh else missing(items, store, limit)  # an old row stays until the new one replaces it
    lost: list[str] = []
    # Its whole path: workers have folders of their own.
    truths = folder_for(store.path.parent.resolve() / FOLDER, ELSEWHERE) if waiting else None
    for item, result in run_items(waiting, limit, workers, watch, timed, None, supervised, truths):
        if result.outcome == Outcome.LOST:
            lost.append(f"{item.label}: {result.sentence}")
        elif isinstance(item, Cell):
            store.put(result)
        else:
            store.put_answer(item, result)
        done(result)
    if lost:
        raise WorkersLost(f"{len(lost)} of {len(waiting)} cells are lost, the others are stored; the first: {lost[0]}")
    return len(waiting)


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
    reasons: dict[Cell, str] = {}
    for cell, result, _ in supervise(support_of, cells, TIME_LIMIT, worker_count(timed=False)):
        if isinstance(result, Loss) and result.outcome == Outcome.LOST:
            raise WorkersLost(f"{cell.label}: {result.sentence}")
        reasons[cell] = result.sentence if isinstance(result, Loss) else result
    return reasons
