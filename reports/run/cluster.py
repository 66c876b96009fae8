"""Running items on a Dask cluster, with the same results as `supervise` on this machine.

A Dask task is a chunk of items, which a Dask worker runs in supervised processes, so that an engine that aborts does
not end the Dask worker. Items are sent pickled, so that the scheduler does not import engines. Each item is sent with
its key: a process that computes another key has other versions or files, and does not run the item.
"""

from __future__ import annotations

import logging
import multiprocessing
import pickle
import re
import sys
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from reports.model.ending import BadInput, describe
from reports.model.fingerprint import versions_of
from reports.model.outcomes import Loss, Outcome
from reports.run.files import temporary_folder
from reports.run.running import expected_seconds, worker_count
from reports.run.supervisor import TICK, Answer, Supervise, Watch, WorkersLost, supervise
from reports.run.worker import process_start

WORDS = re.compile(r"(?:tcp|tls)://\S+:\d+|local:([1-9]\d{0,2})")
FORMS = "tcp://HOST:PORT of a Dask scheduler, or local:N for N workers here"
ANSWERS_WITHIN = 10.0  # s for a scheduler to answer.
WORKERS_WITHIN = 120.0  # s for the first worker to connect.
CHUNK = 2.0  # Expected time of a chunk [s], much longer than sending it and starting its processes.
_closing = threading.Event()  # Set when the client has ended: threads of local workers then end their processes.


@dataclass(frozen=True)
class Refusal:
    """An item that was not run, since the worker computes another key; `versions`: the worker's `versions_of`."""

    versions: dict[str, str]


@dataclass(frozen=True)
class Workforce:
    """The function that runs items, here or on a cluster, and the number of items that run at the same time."""

    threads: int
    supervise: Supervise = supervise


def pool(workers: int | None) -> Workforce:
    """Workers on this machine, one per processor if None."""
    return Workforce(workers or worker_count())


def chunks(items: Iterable[Any]) -> list[list[Any]]:
    """Items in their order, as many together as are expected to take CHUNK seconds."""
    out: list[list[Any]] = []
    remaining = 0.0
    for item in items:
        seconds = expected_seconds(item)
        if seconds > remaining or not out:
            out.append([])
            remaining = CHUNK
        out[-1].append(item)
        remaining -= seconds
    return out


def run_item(function: Callable[[Any], Any], paths: tuple[str, ...], item_and_key: bytes) -> Any:
    """In a worker process: the result of a pickled (item, key), or a Refusal; `paths`: the client's sys.path."""
    sys.path += [path for path in paths if path not in sys.path and Path(path).exists()]
    try:
        item, key = pickle.loads(item_and_key)
    except (ImportError, AttributeError) as error:
        return Refusal({"what it would run": describe(error)})
    if key is not None and replace(item).key != key:  # a copy has no key yet
        return Refusal(versions_of(item))
    return function(item)


def run_chunk(data: bytes) -> bytes:
    """In a Dask worker: the pickled answers (index of the item, result or Loss, note) to a pickled chunk."""

    def end_when_closing(running: list[Any]) -> None:
        if _closing.is_set():
            raise WorkersLost("the client is gone")

    job, items, limit, wall = pickle.loads(data)
    # By default Dask starts workers as daemon processes, which may not have children.
    vars(multiprocessing.current_process())["_config"]["daemon"] = False
    places = {item: index for index, item in enumerate(items)}
    answers = supervise(job, items, limit, 1, watch=end_when_closing, wall=wall)
    return pickle.dumps([(places[item], result, note) for item, result, note in answers])


@contextmanager
def connect_cluster(scheduler: str | None) -> Iterator[Workforce | None]:
    """Connect to the cluster that `--scheduler` names, or None without one. Raises BadInput."""
    if scheduler is None:
        yield None
        return
    local_cluster = WORDS.fullmatch(scheduler)
    if not local_cluster:
        raise BadInput(f"--scheduler is {scheduler!r}; it must be {FORMS}")
    try:
        import distributed
    except ImportError:
        raise BadInput(
            f"--scheduler is {scheduler!r}, which needs Dask, and it is not installed: pip install '.[cluster]'"
        ) from None
    for name in ("distributed", "tornado"):  # errors of workers are reported in rows, so their logs are not needed
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        try:
            with process_start():  # the started processes ignore Ctrl-C; this process handles it
                where: Any = scheduler
                if local_cluster[1]:  # threads: cells have processes of their own, all by one fork server
                    folder = str(stack.enter_context(temporary_folder()))
                    options: dict[str, Any] = {"processes": False, "threads_per_worker": 1, "memory_limit": None}
                    options |= {"local_directory": folder, "dashboard_address": "127.0.0.1:0"}
                    where = stack.enter_context(distributed.LocalCluster(n_workers=int(local_cluster[1]), **options))
                    _closing.clear()
                    stack.callback(_closing.set)
                client = stack.enter_context(distributed.Client(where, timeout=ANSWERS_WITHIN, set_as_default=False))
                client.wait_for_workers(1, timeout=WORKERS_WITHIN)
        except OSError as error:  # a timeout is one too
            raise BadInput(
                f"--scheduler is {scheduler!r}: no scheduler with workers answers there ({describe(error)[:200]}); "
                "start them with: dask scheduler, dask worker"
            ) from None
        yield Workforce(_threads(client), partial(_supervise, client, scheduler))


def _supervise(
    client: Any,
    scheduler: str,
    function: Callable[[Any], Any],
    items: Iterable[Any],
    limit: float,
    workers: int | None = None,
    watch: Watch | None = None,
    wall: float | None = None,
) -> Iterator[Answer]:
    """Yield (item, result or Loss, note) as `supervise` does; the cluster has its own `workers`.

    Raises BadInput if a worker has other versions, WorkersLost if no worker is connected for WORKERS_WITHIN seconds.
    """
    parts = chunks(items)
    job = partial(run_item, function, tuple(filter(None, sys.path)))
    packed = [(job, [pickle.dumps((i, getattr(i, "key", None))) for i in part], limit, wall) for part in parts]
    futures = client.map(run_chunk, [pickle.dumps(chunk) for chunk in packed], pure=False, retries=2)
    remaining = dict(zip(futures, parts, strict=True))
    seen = time.monotonic()
    try:
        while remaining:
            done = [future for future in remaining if future.done()]
            for future in done:
                part = remaining.pop(future)
                for index, result, note in _answers(future, len(part), scheduler):
                    if isinstance(result, Refusal):
                        raise _refused(result, part[index], scheduler)
                    yield part[index], result, note
            threads = _threads(client)
            seen = time.monotonic() if threads else seen
            if time.monotonic() - seen > WORKERS_WITHIN:
                raise WorkersLost(f"no worker is at {scheduler}: what is done is stored; start some with: dask worker")
            if watch is not None:
                watch([part[0] for part in list(remaining.values())[:threads]])
            if not done:
                time.sleep(TICK)
    finally:
        with suppress(Exception):  # nothing more is needed from the scheduler, so its errors do not matter
            client.cancel(futures, force=True)


def _threads(client: Any) -> int:
    with suppress(OSError, ValueError):
        return sum(client.nthreads().values()) if client.status == "running" else 0
    return 0


def _answers(future: Any, count: int, scheduler: str) -> list[tuple[int, Any, str]]:
    """The answers to a chunk of `count` items. Raises BadInput if a worker lacks this program."""
    try:
        return pickle.loads(future.result(timeout=ANSWERS_WITHIN))
    except (ImportError, AttributeError) as error:
        raise BadInput(
            f"a worker at {scheduler} can't run cells ({describe(error)}): install this program there"
        ) from None
    except Exception as error:
        loss = Loss(Outcome.LOST, f"every worker ended that ran it: {describe(error)}")
        return [(index, loss, "") for index in range(count)]


def _refused(refusal: Refusal, item: Any, scheduler: str) -> BadInput:
    local, remote = versions_of(item), refusal.versions
    names = sorted(name for name in {*local, *remote} if local.get(name) != remote.get(name))
    differences = "; ".join(
        f"{name} {remote.get(name, 'missing')} there, {local.get(name, 'missing')} here" for name in names
    )
    return BadInput(
        f"a worker at {scheduler} would give other rows ({differences}): nothing was run there; install the same"
    )
