"""A search draws cases, which workers run and store, and reduces findings."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic
from typing import Any

from reports.model.tasks import Answer, Task
from reports.run.cluster import Workforce, pool
from reports.run.running import missing, run_into
from reports.run.store import Store
from reports.search import plan
from reports.search.chunk import (
    CaseResult,
    Chunk,
    chunk_to_json,
    iter_case_results,
    make_chunks,
    stored_answers,
    unfinished_cases,
)
from reports.search.planted import all_controls
from reports.search.shrinking import Shrink, choose_worst
from reports.search.subjects import DEFAULT_ORACLES, Subject

STORE = "cells.sqlite"
CHUNK_LIMIT = 120.0  # CPU time of a chunk [s].
PLANTED_LIMIT = 1800.0  # CPU time of a control with a planted fault [s].
WAVE_CHUNKS = 4  # Number of chunks for each worker between two checks of the time limit.
DEFAULT_CASES = 200

# Function of (store, tasks, limit, label, number of cases of a task). The result is a context with the tasks that are
# not stored, a function done(answer, count), and a watch.
Progress = Callable[..., AbstractContextManager[tuple[Sequence[Any], Callable[..., None], Any]]]


@contextmanager
def quietly(
    store: Store, tasks: Sequence[Task], limit: float, label: str, size: Callable[[Any], int] | None = None
) -> Iterator[tuple[Sequence[Any], Callable[..., None], Any]]:
    yield missing(tasks, store, limit), lambda *_: None, None


def run_search(
    folder: Path,
    subjects: Sequence[Subject],
    cases: int = DEFAULT_CASES,
    seed: int | None = None,
    seconds: float | None = None,
    workers: int | None = None,
) -> tuple[list[CaseResult], Mapping[Shrink, Answer]]:
    """Results of `cases` cases of each subject, and reduced findings. Results and findings are stored in `folder`. By
    default `seed` is the first published seed. `seconds`: time limit, after which no task is started."""
    kinds = tuple(dict.fromkeys(kind for subject in subjects for kind in subject.kinds))
    seed = plan.published_seeds()[0] if seed is None else seed
    chunks = make_chunks(subjects, seed, cases, kinds, 0, DEFAULT_ORACLES)
    with Store(folder / STORE) as store:
        search = Search(store, pool(workers), seconds)
        results = search.run([chunks])
        return results, search.shrink(results)


@dataclass
class Search:
    """A search that stores its results. `seconds`: time limit, after which no task is started."""

    store: Store
    crew: Workforce
    seconds: float | None = None
    progress: Progress = quietly
    begin: float = field(default_factory=monotonic)
    cases: int = 0  # Number of cases of this run.
    first: str = ""  # Sentence on the first finding.

    @property
    def spent(self) -> float:
        return monotonic() - self.begin

    @property
    def over(self) -> bool:
        return self.seconds is not None and self.spent >= self.seconds

    def run(self, batches: Iterable[Sequence[Chunk]]) -> list[CaseResult]:
        """Run the missing chunks until the time limit; return all results of the started batches."""
        chunks: list[Chunk] = []
        for batch in batches:
            # the time for drawing the first batch does not count, since it includes the search for supported kinds
            if not chunks:
                self.begin = monotonic()
            if self.over:
                break
            self.store.save_references(chunk_to_json(chunk) for chunk in batch)
            self._run_batch(batch)
            chunks += batch
        return list(iter_case_results(stored_answers(self.store, chunks)))

    def _run_batch(self, batch: Sequence[Chunk]) -> None:
        """Run the chunks of a batch, and the cases of crashed chunks one by one."""
        progress = self.progress(self.store, batch, CHUNK_LIMIT, "chunks", size=lambda chunk: chunk.count)
        with progress as (waiting, done, watch):

            def count(answer: Answer, single: int = 0) -> None:
                done(answer, self._count(answer, single))

            for wave in self._waves(waiting, WAVE_CHUNKS):
                self._run_tasks(wave, CHUNK_LIMIT, count, watch)
                singles = missing(unfinished_cases(stored_answers(self.store, wave)), self.store, CHUNK_LIMIT)
                self._run_tasks(singles, CHUNK_LIMIT, lambda answer: count(answer, 1), watch)

    def _waves(self, tasks: Sequence[Any], per_worker: int) -> Iterator[Sequence[Any]]:
        """Yield parts of the tasks until the time limit, or all of them, since workers are idle between two waves."""
        size = len(tasks) if self.seconds is None else per_worker * self.crew.threads
        for first in range(0, len(tasks), size or 1):
            if self.over:
                return
            yield tasks[first : first + size]

    def _run_tasks(self, tasks: Sequence[Any], limit: float, done: Callable[..., None], watch: Any) -> None:
        run_into(self.store, tasks, False, limit, self.crew.threads, done, watch, supervised=self.crew.supervise)

    def _count(self, answer: Answer, single: int) -> int:
        results = json.loads(str(answer.values["results"])) if answer.finished else []
        count = len(results) or single
        self.cases += count
        pairs = [pair for _, errors, *_ in results for pair in errors.values()]
        fault = (single and not answer.finished) or any(not error <= bound for error, bound in pairs)
        if not self.first and fault:
            self.first = f" The first finding came after {self.spent:.1f} s, within {self.cases} cases."
        return count

    @property
    def summary(self) -> str:
        return f"{self.cases} cases were asked in {self.spent:.0f} s.{self.first}"

    def run_controls(self) -> None:
        with self.progress(self.store, all_controls(), PLANTED_LIMIT, "planted faults") as (waiting, done, watch):
            self._run_tasks(waiting, PLANTED_LIMIT, done, watch)

    def shrink(self, results: Iterable[CaseResult]) -> Mapping[Shrink, Answer]:
        """Reduce some findings of each check. The reduction has the same time limit as the search."""
        tasks = [Shrink.of(check, case) for check, case in choose_worst(results)]
        if not tasks:
            return {}
        self.begin = monotonic()
        with self.progress(self.store, tasks, CHUNK_LIMIT, "findings") as (waiting, done, watch):
            for wave in self._waves(waiting, 1):
                self._run_tasks(wave, CHUNK_LIMIT, done, watch)
        answers = self.store.answers(tasks)
        return {task: answers[task] for task in tasks if task in answers}
