"""Functions that run cells and tasks in supervised workers, and store each result as soon as it arrives."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

from reports.model.cells import Cell, estimated_cost
from reports.model.measure import TRUTHS, Measurement, blank, measure
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Answer, Task, answered
from reports.run.files import folder_for
from reports.run.store import ELSEWHERE, Store
from reports.run.supervisor import Supervise, Watch, WorkersLost, supervise
from reports.run.worker import worker_count

TIME_LIMIT = 60.0  # Limit of CPU time for one cell [s], which only a hang reaches.
LEAST = 3e-3  # Time that a cell takes in addition to stepping [s].

Item = TypeVar("Item", bound=Cell | Task)


def work(timed: bool, truths: Path | None, item: Cell | Task) -> Measurement | Answer:
    return measure(item, timed, truths) if isinstance(item, Cell) else answered(item)


def expected_seconds(item: Any) -> float:
    """CPU seconds of one run, estimated by the engine or the task."""
    return LEAST + (estimated_cost(item) if isinstance(item, Cell) else float(getattr(item, "cost", 0.0)))


def longest_first(items: Iterable[Item]) -> list[Item]:
    """Sort the scenes, and the items of each scene, by their expected time in descending order. The items of a scene
    stay together, since a worker caches exact motions. The last items are short, so all workers end at about the same
    time."""
    groups: dict[Any, list[Item]] = {}
    for item in items:
        groups.setdefault(getattr(item, "scene", item), []).append(item)
    ordered = sorted(groups.values(), key=lambda group: -sum(map(expected_seconds, group)))
    return [item for group in ordered for item in sorted(group, key=expected_seconds, reverse=True)]


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
    """Yield (cell, Measurement) and (task, Answer). Items start in the order of `longest_first`. A lost item has an
    outcome and no numbers. `supervise` describes `limit`, `wall` and WorkersLost. workers: by default `worker_count()`.
    timed: whether a cell is repeated to measure the smallest CPU time. supervised: the function that runs the items.
    truths: a folder of exact motions that workers share."""
    items = tuple(items)
    for item in items:  # The keys are cached, since every worker would need half a second to read all sources.
        _ = item.key, isinstance(item, Cell) and item.truth
    function, count = partial(work, timed, truths), workers or worker_count()
    for item, result, note in supervised(function, longest_first(items), limit, count, watch, wall):
        yield item, _result(item, result, note, limit)


def _result(item: Cell | Task, result: Any, note: str, limit: float) -> Measurement | Answer:
    if not isinstance(result, Loss):
        retried = f"the first try {note}, the second went through" if note else ""
        return replace(result, sentence="; ".join(filter(None, (result.sentence, retried))))
    spent = limit if result.outcome == Outcome.TIMED_OUT else float("nan")
    if isinstance(item, Cell):
        return replace(blank(item, result.outcome, result.sentence), limit=spent)
    return Answer(result.outcome, result.sentence, limit=spent)


def run_cells(cells: Iterable[Cell], **terms: Any) -> Iterator[Measurement]:
    """Yield the measurement of each cell. terms: keyword arguments of `run_items`."""
    for _, row in run_items(cells, **terms):
        yield row


def missing(items: Iterable[Item], store: Store, limit: float = TIME_LIMIT) -> tuple[Item, ...]:
    """The cells and tasks that are not stored, or that have timed out with a smaller limit [s]."""
    items = tuple(items)
    cells = [item for item in items if isinstance(item, Cell)]
    tasks = [item for item in items if isinstance(item, Task)]
    known = {**store.get(cells), **store.answers(tasks)}
    return tuple(item for item in items if item not in known or not holds(known[item], limit))


def holds(result: Measurement | Answer, limit: float) -> bool:
    """Whether a run with this limit [s] would have the stored result."""
    return result.outcome != Outcome.LOST and (result.outcome != Outcome.TIMED_OUT or result.limit >= limit)


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
    """Run the missing items, or all items if `fresh` is true. Store the results and return the number of items run.
    Results are stored as they arrive, also before an interruption. If another program kills the process of an item, the
    item is not stored, and WorkersLost is raised after all other items."""
    waiting = tuple(items) if fresh else missing(items, store, limit)  # Old rows stay until new rows arrive.
    lost: list[str] = []
    # The path is absolute, since workers run in other folders.
    truths = folder_for(store.path.parent.resolve() / TRUTHS, ELSEWHERE) if waiting else None
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
    """The engine's reason why it can't build a scene's mechanism, or an empty text."""
    from engines import Unsupported

    try:
        cell.engine.build(cell.scene.mechanism(), cell.step)
    except Unsupported as reason:
        return str(reason)
    return ""


def support(cells: Sequence[Cell]) -> dict[Cell, str]:
    """Cell -> `support_of`, computed in supervised processes. Raises WorkersLost."""
    reasons: dict[Cell, str] = {}
    for cell, result, _ in supervise(support_of, cells, TIME_LIMIT, worker_count()):
        if isinstance(result, Loss) and result.outcome == Outcome.LOST:
            raise WorkersLost(f"{cell.label}: {result.sentence}")
        reasons[cell] = result.sentence if isinstance(result, Loss) else result
    return reasons
