"""Who runs cells and tasks: workers here, or a Dask cluster, which gives the same answers as `supervise`.

The client keeps some chunks ahead for every thread of every worker and hands out the next as answers arrive. Workers
may come, go and be killed: Dask runs a chunk again whose worker has vanished, as often as its `allowed-failures` says.
Each thread of a worker supervises a process in which cells are run, as everywhere, so that an engine that aborts ends a
cell and no worker. There the key of every item is made anew and compared with the client's: rows of other versions of
an engine, or of other files of ours, are never mixed. Items travel as bytes: no scheduler or worker imports an engine.
"""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import queue
import re
import sys
import threading
import time
import warnings
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Protocol

from reports.model.cells import Cell
from reports.model.ending import BadInput, describe
from reports.model.fingerprint import modules_of, versions_of
from reports.model.outcomes import Loss, Outcome
from reports.run.files import temporary_folder
from reports.run.queue import expected_seconds
from reports.run.running import worker_count
from reports.run.supervisor import TICK, Answer, Crew, Supervise, Watch, WorkersLost, crew, supervise, wall_limit
from reports.run.worker import process_start

ADDRESS = re.compile(r"(?:tcp|tls)://\S+:\d+")
LOCAL = re.compile(r"local:([1-9]\d{0,2})")
FORMS = "tcp://HOST:PORT of a Dask scheduler, or local:N for N workers here"
ANSWERS_WITHIN = 10.0  # s for a scheduler to answer
WORKERS_WITHIN = 120.0  # s for a worker to be there
CHUNK = 0.3  # s that a chunk should take: much more than sending one, much less than waiting for the last
LONGEST = 1.0  # s after which a worker hands over what it has of a chunk: more was expected of it than it can
MOST_ITEMS = 200  # of a chunk
MOST_TRIES = 5  # of an item that Dask has given up, since every worker ended that ran it
RETRIES = 2  # of a chunk that raises, by Dask: of a worker that can't start a process just now
# What Dask measures of itself, a hundred times a second, in the process that hands out chunks: nobody looks there.
QUIET = {
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
}
AHEAD = 2  # chunks for each thread: one runs, one waits beside it


@dataclass(frozen=True)
class Job:
    """What the process of a worker runs: a pickled function of a pickled (item, key), both of the client.

    paths: where the client finds modules; on the same machine a file of its user is found there too.
    """

    function: bytes
    paths: tuple[str, ...]

    def __call__(self, place_and_item: tuple[int, bytes]) -> Any:
        """The result, or Refusal where something else is behind the item here."""
        sys.path += [path for path in self.paths if path not in sys.path and Path(path).exists()]
        try:
            item, key = pickle.loads(place_and_item[1])
        except (ImportError, AttributeError) as error:
            return Refusal(frozenset(), {"what it would run": describe(error)})
        if key is not None and replace(item).key != key:  # a copy has no key yet
            return Refusal(behind(item), versions_of(behind(item)))
        return pickle.loads(self.function)(item)


@dataclass(frozen=True)
class Refusal:
    """An item that was not run: some of its `modules` have other files or `versions` there than at the client."""

    modules: frozenset[str]
    versions: dict[str, str]


def behind(item: Any) -> frozenset[str]:
    """The modules behind a cell or a task."""
    return modules_of(item.scene, item.engine) if isinstance(item, Cell) else modules_of(item)


@dataclass(frozen=True)
class Chunk:
    """Items that are sent together, and how often Dask gave them up."""

    items: tuple[Any, ...]
    tries: int = 0

    def packed(self, function: bytes, limit: float, wall: float) -> bytes:
        own = tuple(pickle.dumps((item, getattr(item, "key", None))) for item in self.items)
        return pickle.dumps((Job(function, tuple(filter(None, sys.path))), own, limit, wall))


_own = threading.local()  # a worker with several threads supervises as many processes
_crews: list[ExitStack] = []  # of all threads
_dismissed = threading.Event()  # nobody waits any more for what threads of this process do


def run_chunk(data: bytes) -> bytes:
    """What a Dask worker runs: a packed chunk; the pickled answers, (place of an item, its result or Loss, note)."""
    job, items, limit, wall = pickle.loads(data)
    # Dask starts its workers as processes that may have no children, unless its settings say so (`worker.daemon`).
    vars(multiprocessing.current_process())["_config"]["daemon"] = False
    if getattr(_own, "terms", None) != (limit, wall):
        _end(getattr(_own, "stack", None))
        _own.stack, _own.terms = ExitStack(), (limit, wall)
        _crews.append(_own.stack)
        _own.crew = _own.stack.enter_context(crew(limit, 1, wall))
    hands: Crew = _own.crew
    begin, answers = time.monotonic(), []
    try:
        for pair in enumerate(items):
            hands.give(job, [pair])
            answers += [(place, result, note) for (place, _), result, note in hands.answers(_watch)]
            if time.monotonic() - begin > LONGEST:  # the others are sent again
                break
        return pickle.dumps(answers)
    except BaseException:
        _own.terms = None  # the next chunk begins anew
        _end(_own.stack)
        raise


def _watch(running: list[Any]) -> None:
    if _dismissed.is_set():
        raise WorkersLost("nobody waits for this any more")


def _end(stack: ExitStack | None) -> None:
    if stack in _crews:
        _crews.remove(stack)
        stack.close()


def _end_all() -> None:
    for stack in list(_crews):
        _end(stack)
    _dismissed.clear()


class Workforce(Protocol):
    """Who runs items: the function that `supervise` is, and how many items it runs at a time."""

    @property
    def threads(self) -> int: ...
    @property
    def supervise(self) -> Supervise: ...


@dataclass(frozen=True)
class Pool:
    """Workers on this machine."""

    threads: int
    supervise: Supervise = supervise


def pool(workers: int | None) -> Pool:
    """So many workers; as many as processors for None."""
    return Pool(workers or worker_count(timed=False))


@contextmanager
def elsewhere(scheduler: str | None) -> Iterator[Workforce | None]:
    """A cluster; None without a scheduler. Raises BadInput where there is none."""
    with cluster(scheduler) if scheduler is not None else nullcontext() as own:
        yield own


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
        with process_start(), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of its versions; ours are compared by keys
            try:
                where: Any = scheduler
                if local:
                    # The scheduler, and not its workers alone, keeps a folder where this says.
                    scratch = str(stack.enter_context(temporary_folder()))
                    own = {**QUIET, "temporary-directory": scratch}
                    stack.enter_context(dask.config.set(own))  # pyright: ignore[reportPrivateImportUsage]
                    stack.callback(_end_all)  # when the threads of its workers have ended
                    where = stack.enter_context(
                        distributed.LocalCluster(
                            n_workers=int(local[1]),
                            processes=False,  # cells have processes of their own, all by one fork server
                            threads_per_worker=1,
                            local_directory=scratch,
                            dashboard_address="127.0.0.1:0",  # any free port, seen from this machine alone
                            memory_limit=None,  # cells have processes of their own, which it would not see
                            silence_logs=logging.CRITICAL,
                        )
                    )
                    stack.callback(_dismissed.set)
                client = stack.enter_context(distributed.Client(where, timeout=ANSWERS_WITHIN, set_as_default=False))
            except OSError as error:  # a timeout is one too
                said = " ".join(str(error).split())[:200]
                raise BadInput(
                    f"--scheduler is {scheduler!r}: no Dask scheduler answers there within {ANSWERS_WITHIN:g} s "
                    f"({said}); start one with: dask scheduler"
                ) from None
        yield Cluster(client, scheduler)


class Cluster:
    """A client of a scheduler."""

    def __init__(self, client: Any, name: str) -> None:
        self._client, self._name = client, name
        self._looked, self._threads, self._seen = -1.0, 0, time.monotonic()

    @property
    def threads(self) -> int:
        """How many chunks run at a time, on the workers that are there. Raises WorkersLost after long without any."""
        now = time.monotonic()
        if now - self._looked > 1.0:
            self._looked, self._threads = now, 0
            if self._client.status == "running":
                with suppress(OSError):
                    self._threads = sum(self._client.nthreads().values())
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
        terms = pickle.dumps(function), limit, wall_limit(limit) if wall is None else wall
        waiting = deque(chunks(items))
        running: dict[Any, Chunk] = {}
        ended: queue.SimpleQueue[Any] = queue.SimpleQueue()
        try:
            while waiting or running:
                while waiting and len(running) < AHEAD * self.threads:
                    chunk = waiting.popleft()
                    future = self._client.submit(run_chunk, chunk.packed(*terms), pure=False, retries=RETRIES)
                    running[future] = chunk
                    future.add_done_callback(ended.put)
                with suppress(queue.Empty):
                    future = ended.get(timeout=TICK)
                    try:
                        answers = pickle.loads(future.result(timeout=10.0))
                    except TimeoutError:  # its worker ended before it handed the answers over: Dask runs it again
                        ended.put(future)
                        continue
                    except Exception as error:
                        answers = self._lost(running[future], error, waiting)
                    chunk = running.pop(future)
                    future.release()
                    if 0 < len(answers) < len(chunk.items):
                        waiting.appendleft(Chunk(chunk.items[len(answers) :]))
                    for place, result, note in answers:
                        if isinstance(result, Refusal):
                            raise _refused(result, self._name)
                        yield chunk.items[place], result, note
                if watch is not None:
                    watch([chunk.items[0] for chunk in list(running.values())[: self._threads]])
        finally:
            if running and self._client.status == "running":
                with suppress(Exception):  # whatever it makes of that, this side is done
                    self._client.cancel(list(running), force=True)

    def _lost(self, chunk: Chunk, error: Exception, waiting: deque[Chunk]) -> Sequence[tuple[int, Any, str]]:
        """The answers of a chunk that Dask has given up: none before the last try, its items wait, each by itself."""
        if isinstance(error, ImportError | AttributeError):
            raise BadInput(f"a worker at {self._name} can't run cells ({describe(error)}): install this program there")
        if chunk.tries + 1 < MOST_TRIES:
            waiting.extend(Chunk((item,), chunk.tries + 1) for item in chunk.items)
            return ()
        return [(0, Loss(Outcome.LOST, f"every worker ended that ran it: {describe(error)}"), "")]


def chunks(items: Iterable[Any]) -> Iterator[Chunk]:
    """Items in their order, as many together as are expected to take CHUNK seconds."""
    own: list[Any] = []
    left = CHUNK
    for item in items:
        seconds = expected_seconds(item)
        if own and (seconds > left or len(own) == MOST_ITEMS):
            yield Chunk(tuple(own))
            own, left = [], CHUNK
        own.append(item)
        left -= seconds
    if own:
        yield Chunk(tuple(own))


def _refused(refusal: Refusal, name: str) -> BadInput:
    """The line about a worker that would run something else."""
    own, theirs = versions_of(refusal.modules) if refusal.modules else {}, refusal.versions
    told = [
        f"{each} {theirs.get(each, 'missing')} there, {own.get(each, 'missing')} here"
        for each in sorted({*own, *theirs})
        if own.get(each) != theirs.get(each)
    ]
    return BadInput(
        f"a worker at {name} would give other rows ({'; '.join(told)}): nothing was run there; install the same"
    )
