"""Tasks through supervised workers: an answer to every task, whatever becomes of its process."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

from reports.grid.outcomes import Loss, Outcome
from reports.grid.pool import TIME_LIMIT, worker_count
from reports.grid.supervisor import Supervise, Watch, supervise
from reports.grid.tasks import Answer, Task, answered


def run_tasks(
    tasks: Iterable[Task],
    limit: float = TIME_LIMIT,
    workers: int | None = None,
    watch: Watch | None = None,
    supervised: Supervise = supervise,
) -> Iterator[tuple[Task, Answer]]:
    """Yield every task with its answer as it is done; a lost one has its outcome, and no values.

    `limit`: CPU seconds for one task. `workers`: as many as there are processors if None, since nobody looks at what a
    task takes. `supervised`: by whom. Raises WorkersLost (`supervise`).
    """
    workers = worker_count(timed=False) if workers is None else workers
    for task, result, note in supervised(answered, tasks, limit, workers, watch):
        if not isinstance(result, Loss):
            told = f"the first try {note}, the second went through" if note else ""
            yield task, replace(result, sentence="; ".join(filter(None, (result.sentence, told))))
        else:
            spent = limit if result.outcome == Outcome.TIMED_OUT else float("nan")
            yield task, Answer(result.outcome, result.sentence, limit=spent)
