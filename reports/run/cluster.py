"""Cells and tasks on a Dask cluster, in chunks; to those who ask, the same as `supervise` with workers elsewhere.

The client keeps some chunks ahead for every thread of every worker and hands out the next as answers arrive, so that
workers may come, go and be killed: Dask runs a chunk again whose worker has vanished, and an item is answered once. A
worker runs cells through a foreman (`reports.run.foreman`), and before that it compares the digest of what is behind
every item with its own: rows of other versions of an engine, or of other files of ours, are never mixed.
"""

from __future__ import annotations

import logging
import pickle
import queue
import re
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

from reports.model.cells import Cell
from reports.model.ending import BadInput, describe
from reports.model.fingerprint import digest_of, modules_of, versions_of
from reports.model.outcomes import Loss, Outcome
from reports.run import foreman
from reports.run.expected import expected_seconds
from reports.run.supervisor import TICK, Answer, Watch, WorkersLost, wall_limit
from reports.run.temporary import temporary_folder
from reports.run.worker_process import interrupts_held

ADDRESS = re.compile(r"(?:tcp|tls)://\S+:\d+")
LOCAL = re.compile(r"local:([1-9]\d{0,2})")
FORMS = "tcp://HOST:PORT of a Dask scheduler, or local:N for N workers here"
ANSWERS_WITHIN = 10.0  # s for a scheduler to answer
WORKERS_WITHIN = 120.0  # s for a worker to be there
CHUNK = 0.3  # s that a chunk should take: much more than sending one, much less than waiting for the last
MOST_ITEMS = 200  # of a chunk
# What Dask measures of itself, a hundred times a second, in the process that hands out chunks: nobody looks there.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
AHEAD = 2  # chunks for each thread: one runs, one waits beside it
MOST_TRIES = 5  # of a chunk of which a foreman, or several workers one after the other, ended


@dataclass
class Chunk:
    """Items that are sent together, and how often they were sent before."""

    items: tuple[Any, ...]
    estimate: float
    tries: int = 0


@contextmanager
def cluster(scheduler: str) -> Iterator[Cluster]:
    """A cluster by the words of a command line. Raises BadInput: wrong words, no Dask, no scheduler there."""
    local = LOCAL.fullmatch(scheduler)
    if not (local or ADDRESS.fullmatch(scheduler)):
        raise BadInput(f"--scheduler is {scheduler!r}; it must be {FORMS}")
    try:
        import dask
        import distributed
    except ImportError:
        raise BadInput(
            f"--scheduler is {scheduler!r}, which needs Dask, and it is not installed: pip install '.[cluster]'"
        ) from None
    for name in ("distributed", "tornado"):  # what becomes of workers is told by rows, not by their logs
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        # Ctrl-C reaches every process of a terminal; threads and processes that start here leave it to this one.
        with interrupts_held(), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of its versions; ours are compared by `foreman`
            try:
                where: Any = scheduler
                if local:
                    # The scheduler, and not its workers alone, keeps a folder where this says.
                    scratch = str(stack.enter_context(temporary_folder()))
                    own = {**QUIET, "temporary-directory": scratch}
                    stack.enter_context(dask.config.set(own))  # pyright: ignore[reportPrivateImportUsage]
                    where = stack.enter_context(
                        distributed.LocalCluster(
                            n_workers=int(local[1]),
                            processes=False,  # cells have processes of their own (`foreman.Inside`)
                            threads_per_worker=1,
                            local_directory=scratch,
                            dashboard_address="127.0.0.1:0",  # any free port, seen from this machine alone
                            memory_limit=None,  # cells have processes of their own, which it would not see
                            silence_logs=logging.CRITICAL,
                        )
                    )
                client = stack.enter_context(distributed.Client(where, timeout=ANSWERS_WITHIN, set_as_default=False))
            except OSError as error:  # a timeout is one too
                said = " ".join(str(error).split())[:200]
                raise BadInput(
                    f"--scheduler is {scheduler!r}: no Dask scheduler answers there within {ANSWERS_WITHIN:g} s "
                    f"({said}); start one with: dask scheduler"
                ) from None
        foreman.admit()
        stack.callback(foreman.dismiss)  # those of workers in this process
        yield Cluster(client, scheduler, inside=bool(local))


class Cluster:
    """A client of a scheduler."""

    def __init__(self, client: Any, name: str, inside: bool = False) -> None:
        self._client, self._name, self._inside = client, name, inside
        self._looked, self._threads, self._seen = -1.0, 0, time.monotonic()
        self._numbers = count()

    @property
    def threads(self) -> int:
        """How many chunks run at a time, on the workers that are there. Raises WorkersLost after long without any."""
        now = time.monotonic()
        if now - self._looked > 1.0:
            self._looked = now
            if self._client.status == "running":
                with suppress(OSError):
                    self._threads = sum(self._client.nthreads().values())
            else:
                self._threads = 0
            if self._threads:
                self._seen = now
            elif self._client.status in ("closed", "closing") or now - self._seen > WORKERS_WITHIN:
                what = "no worker" if self._client.status == "running" else "no scheduler"
                raise WorkersLost(
                    f"{what} has been at {self._name} for {now - self._seen:.0f} s: what is done is stored; "
                    "start some with: dask worker ADDRESS"
                )
        return self._threads

    def supervise(
        self,
        function: Callable[[Any], Any],
        items: Iterable[Any],
        limit: float,
        workers: int | None = None,
        watch: Watch | None = None,
        wall: float | None = None,
        alone: bool = False,
    ) -> Iterator[Answer]:
        """Yield (item, result or Loss, note), each once, in no order, as `reports.run.supervisor.supervise` does.

        `workers` and `alone` are not used: the cluster has its own workers. Raises WorkersLost if there are none
        for long, and BadInput if one has other versions.
        """
        wall = wall_limit(limit) if wall is None else wall
        paths = tuple(path for path in sys.path if path)
        terms = foreman.Request(pickle.dumps(function), (), frozenset(), limit, wall, paths, self._inside)
        send = _Sender(self._client, terms, self._numbers)
        waiting = deque(items)
        costs = deque(expected_seconds(item) for item in waiting)
        left, slowness = sum(costs), 1.0  # seconds by estimate; what one of them takes
        again: deque[Chunk] = deque()
        try:
            while waiting or again or send.running:
                most = AHEAD * self.threads
                while (waiting or again) and len(send.running) < most:
                    if again:
                        send(again.popleft())
                        continue
                    # The last chunks are small, so that no thread waits long for another.
                    wanted = min(CHUNK / slowness, left / (2 * most))
                    taken, estimate = [waiting.popleft()], costs.popleft()
                    while waiting and estimate + costs[0] <= wanted and len(taken) < MOST_ITEMS:
                        taken.append(waiting.popleft())
                        estimate += costs.popleft()
                    left -= estimate
                    send(Chunk(tuple(taken), estimate))
                for chunk, told in send.heard():
                    if isinstance(told, foreman.Refusal):
                        raise _refused(told, self._name)
                    if isinstance(told, Exception):
                        yield from self._lost(chunk, told, again)
                        continue
                    # Ten at most: the first chunk of a worker has its imports in it.
                    slowness += 0.2 * (min(max(told.seconds / chunk.estimate, 1e-2), 10.0) - slowness)
                    for index, result, note in told.told:
                        yield chunk.items[index], result, note
                if watch is not None:
                    watch([chunk.items[0] for chunk in list(send.running.values())[: self._threads]])
        finally:
            send.cancel()

    def _lost(self, chunk: Chunk, error: Exception, again: deque[Chunk]) -> Iterator[Answer]:
        """A chunk without a reply: sent again one by one, so that an item that ends foremen is told apart."""
        if isinstance(error, ImportError | AttributeError):
            raise BadInput(f"a worker at {self._name} can't run cells ({describe(error)}): install this program there")
        if chunk.tries + 1 < MOST_TRIES:
            each = chunk.estimate / len(chunk.items)
            again.extend(Chunk((item,), each, chunk.tries + 1) for item in chunk.items)
            return
        for item in chunk.items:
            yield item, Loss(Outcome.LOST, f"{MOST_TRIES} times its worker ended: {describe(error)}"), ""


class _Sender:
    """Chunks on their way, by the future of each."""

    def __init__(self, client: Any, terms: foreman.Request, numbers: Iterator[int]) -> None:
        self._client, self._terms, self._numbers = client, terms, numbers
        self._ready: queue.SimpleQueue[Any] = queue.SimpleQueue()
        self.running: dict[Any, Chunk] = {}

    def __call__(self, chunk: Chunk) -> None:
        packed = tuple(pickle.dumps(item) for item in chunk.items)
        behind = {
            modules_of(item.scene, item.engine) if isinstance(item, Cell) else modules_of(item) for item in chunk.items
        }
        sources = frozenset((modules, digest_of(modules)) for modules in behind)
        request = replace(self._terms, items=packed, sources=sources)
        # A number in the key: the same chunk sent again is another task, not the answer that was lost.
        key = f"chunk-{id(self)}-{next(self._numbers)}-{time.time_ns()}"
        future = self._client.submit(foreman.answered, pickle.dumps(request), key=key, pure=False)
        self.running[future] = chunk
        future.add_done_callback(self._ready.put)

    def heard(self) -> Iterator[tuple[Chunk, Any]]:
        """Chunks that ended, each with its reply or with an exception; waits a moment for the first."""
        futures = []
        with suppress(queue.Empty):
            futures.append(self._ready.get(timeout=TICK))
            while True:
                futures.append(self._ready.get_nowait())
        for future in futures:
            if future not in self.running:
                continue
            told: Any
            try:
                told = pickle.loads(future.result(timeout=10.0))
            except TimeoutError:  # its worker ended before it handed the reply over: Dask runs it again
                self._ready.put(future)
                continue
            except Exception as error:
                told = error
            yield self.running.pop(future), told
            future.release()

    def cancel(self) -> None:
        if self.running and self._client.status == "running":
            with suppress(Exception):  # whatever it makes of that, this side is done
                self._client.cancel(list(self.running), force=True)
        self.running.clear()


def _refused(refusal: foreman.Refusal, name: str) -> BadInput:
    """The line about a worker that would run something else."""
    own, theirs = versions_of(refusal.modules), refusal.versions
    told = [
        f"{each} {theirs.get(each, 'missing')} there, {own.get(each, 'missing')} here"
        for each in sorted({*own, *theirs})
        if own.get(each) != theirs.get(each)
    ]
    return BadInput(
        f"a worker at {name} would give other rows ({'; '.join(told)}): nothing was run there; install the same"
    )
