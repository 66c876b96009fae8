"""Running cells and tasks into a store: only those without an answer, each kept as soon as it is done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, TypeVar

from reports.model.cells import Cell
from reports.model.imports import keep, recall
from reports.model.measure import Measurement
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Answer, Task
from reports.model.truths import FOLDER
from reports.run.files import folder_for
from reports.run.pool import TIME_LIMIT, run_items, worker_count
from reports.run.store import ELSEWHERE, Store
from reports.run.supervisor import Supervise, WorkersLost, supervise

Item = TypeVar("Item", bound=Cell | Task)


def missing(items: Iterable[Item], store: Store, limit: float = TIME_LIMIT) -> tuple[Item, ...]:
    """The cells and tasks without an answer to a run with this limit [s]: not stored, or timed out within a smaller."""
    items = tuple(items)
    recall(store.path.parent / FOLDER)
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
    if truths is not None:
        keep(truths)
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
