"""Supervision of worker processes. A crash in native code affects only the result of one item.

In pebble, loky and concurrent.futures the workers share a queue with a lock. A worker that is killed while it holds the
lock stops all workers. In those packages limits apply only to wall time. In this module each worker has a separate
connection, and a job counts as run only if its complete answer has arrived.

* If a worker ends while it starts, no item is affected. After several such failures in a row `WorkersLost` is raised.
* If a worker ends during an item, a new worker runs the item again, and the second outcome counts. So damage by an
  earlier item in the same process does not affect the outcome.
* This process ends an item that exceeds its CPU time, by the clock of the worker. If the system does not provide that
  clock, a thread in the worker ends the item. An item that sleeps is ended after a much longer wall time. Wall time
  counts only while this process is awake. So neither a loaded machine nor a stopped terminal changes a result.
"""

from __future__ import annotations

import contextlib
import pickle
import time
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from multiprocessing.connection import wait
from pathlib import Path
from typing import Any

from reports.model.ending import Broken, describe
from reports.model.outcomes import Loss, Outcome, describe_exit, failure, from_outside, out_of_time
from reports.run.files import temporary_folder
from reports.run.worker import (
    READY,
    SPENT,
    Worker,
    cpu_time,
    last_words,
    one_thread_each,
    process_start,
    start_method,
    start_worker,
)

TICK = 0.2  # Time between two readings of the clock [s].
IMPORTS = 2.0  # CPU time for the import of an engine [s], which a worker needs for its first job.
START_LIMIT = 120.0  # Longest wall time until a worker is ready [s].
MOST_FAILED_STARTS = 5  # Largest number of failed starts in a row.
PAUSE = 0.1  # Pause [s] after a failed start, multiplied by the number of failed starts in a row.
MOST_WORKERS = 60  # Windows can wait for at most 63 handles.

Watch = Callable[[list[Any]], None]
Answer = tuple[Any, Any, str]
Supervise = Callable[..., Iterator[Answer]]  # `supervise`, or a function with the same result on a cluster.


class WorkersLost(Broken):
    """Another program has killed the workers. The remaining items can be run later."""


@dataclass
class Job:
    item: Any
    earlier: str = ""  # How the worker of the first try ended, or an empty text during the first try.
    earlier_outside: bool = False  # Whether another program killed the worker of the first try.


def supervise(
    function: Callable[[Any], Any],
    items: Iterable[Any],
    limit: float,
    workers: int,
    watch: Watch | None = None,
    wall: float | None = None,
) -> Iterator[Answer]:
    """Yield (item, result or Loss, note) in the order of completion. The note says how a first try has aborted.
    `function` must be importable. limit: CPU seconds of all threads for an item. wall: seconds for an item that sleeps,
    by default ten times `limit` and a minute. `watch` is called a few times a second with the running items. Raises
    WorkersLost if no worker can be started. The workers end when the iterator is closed."""
    one_thread_each()
    with temporary_folder() as folder:
        wall = 10 * limit + 60 if wall is None else wall  # The machine may be overloaded ten times.
        pool = Pool(function, items, (str(folder), limit, wall), min(workers, MOST_WORKERS))
        try:
            yield from pool.results(watch)
        finally:
            pool.close()


class Pool:
    """The workers and the jobs without an answer. terms: folder, CPU seconds and wall seconds of a job."""

    def __init__(
        self, function: Callable[[Any], Any], items: Iterable[Any], terms: tuple[str, float, float], most: int
    ) -> None:
        self._function, self._terms, self._most = function, terms, most
        self._waiting = deque(Job(item) for item in items)
        self._retries: deque[Job] = deque()  # jobs for new workers
        self._workers: list[Worker] = []
        self._failed_starts = 0
        self._context = start_method()

    def results(self, watch: Watch | None) -> Iterator[Answer]:
        before = time.monotonic()
        while self._waiting or self._retries or self._busy():
            self._start_workers()
            for worker in list(self._workers):
                if worker.ready and worker.job is None:
                    yield from self._assign_job(worker)
            readable = wait([worker.connection for worker in self._workers], TICK)
            now = time.monotonic()
            awake, before = min(now - before, 5 * TICK), now
            for worker in list(self._workers):
                if worker.connection in readable:
                    yield from self._on_message(worker)
                else:
                    worker.awake += awake
                    yield from self._end_overdue(worker)
            if watch is not None:
                watch([worker.job.item for worker in self._busy() if worker.job])

    def close(self) -> None:
        for worker in list(self._workers):
            self._terminate(worker)

    def _busy(self) -> list[Worker]:
        return [worker for worker in self._workers if worker.job is not None]

    def _start_workers(self) -> None:
        wanted = min(self._most, len(self._waiting) + len(self._retries) + len(self._busy()))
        while len(self._workers) < wanted:
            try:
                with process_start():
                    self._workers.append(start_worker(self._context, *self._terms))
            except (OSError, EOFError) as error:  # The system could not start a process.
                self._on_failed_start(describe(error))

    def _on_failed_start(self, words: str) -> None:
        self._failed_starts += 1
        if self._failed_starts >= MOST_FAILED_STARTS:
            raise WorkersLost(f"{self._failed_starts} worker processes in a row ended while they started: {words}")
        # A killed fork server is replaced only after its process has ended. A full system may start a process later.
        time.sleep(PAUSE * self._failed_starts)

    def _assign_job(self, worker: Worker) -> Iterator[Answer]:
        if self._retries and not worker.used:
            job = self._retries.popleft()
        elif self._waiting:
            job = self._waiting.popleft()
        else:
            self._terminate(worker)
            return
        try:
            data = pickle.dumps((self._function, job.item))
        except Exception as error:
            yield job.item, Loss(Outcome.FAILED, f"can't be sent to a worker: {describe(error)}"), ""
            return
        worker.job, worker.used, worker.awake = job, True, 0.0
        worker.cpu = cpu_time(worker.process.pid or 0)
        with contextlib.suppress(OSError):  # If the worker has ended, `_on_message` handles it.
            worker.connection.send_bytes(data)

    def _on_message(self, worker: Worker) -> Iterator[Answer]:
        try:
            message = worker.connection.recv_bytes()
        except (EOFError, OSError):
            yield from self._on_exit(worker)
            return
        if message == READY:
            worker.ready, self._failed_starts = True, 0
            return
        job, worker.job = worker.job, None
        assert job is not None
        stays, answer = pickle.loads(message)
        if not stays:
            self._terminate(worker)
        try:
            result = pickle.loads(answer)
        except Exception as error:
            result = Loss(failure(error).outcome, f"its result can't be read: {describe(error)}")
        yield job.item, result, "" if job.earlier_outside else job.earlier

    def _on_exit(self, worker: Worker) -> Iterator[Answer]:
        """Handle the end of a worker. After a first try the job is tried again unless the CPU time is used up."""
        code, pid, job = worker.exit_code(), worker.process.pid, worker.job
        self._terminate(worker)
        folder, limit, _ = self._terms
        words = ": ".join(filter(None, (describe_exit(code), last_words(Path(folder), pid))))
        if not worker.ready:
            self._on_failed_start(words)
        if job is None:
            return
        if code == SPENT:
            yield job.item, out_of_time(limit), ""
        elif not job.earlier:
            self._retries.append(Job(job.item, words, from_outside(code)))
        elif from_outside(code):
            yield job.item, Loss(Outcome.LOST, f"{words}, perhaps for want of memory; before that: {job.earlier}"), ""
        else:
            yield job.item, Loss(Outcome.ABORTED, words), ""

    def _end_overdue(self, worker: Worker) -> Iterator[Answer]:
        _, limit, wall = self._terms
        if not worker.ready and worker.awake > START_LIMIT:
            self._terminate(worker)
            self._on_failed_start(f"not ready after {START_LIMIT:g} s")
        elif (job := worker.job) is not None and worker.used_cpu() > limit + IMPORTS:
            self._terminate(worker)
            yield job.item, out_of_time(limit), ""
        elif job is not None and worker.awake > wall:
            self._terminate(worker)
            yield job.item, out_of_time(limit, wall), ""

    def _terminate(self, worker: Worker) -> None:
        self._workers.remove(worker)
        worker.stop()
