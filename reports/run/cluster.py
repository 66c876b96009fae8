"""Functions that run items on a Dask cluster. The results are the same as those of `supervise` on this machine.

A Dask task is a chunk of items. A Dask worker runs the items in supervised processes, so an engine that aborts does not
end the Dask worker. Items are sent pickled, so the scheduler does not import engines. An item is sent with the versions
that affect its result. A process with other versions or files does not run the item.
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
from dataclasses import dataclass
from functools import partial
from itertools import accumulate, groupby
from pathlib import Path
from typing import Any

from reports.model.ending import BadInput, describe
from reports.model.fingerprint import OURS, versions_of
from reports.model.outcomes import Loss, Outcome
from reports.run.files import temporary_folder
from reports.run.running import expected_seconds
from reports.run.supervisor import TICK, Answer, Supervise, Watch, WorkersLost, supervise
from reports.run.worker import process_start, worker_count

WORDS = re.compile(r"(?:tcp|tls)://\S+:\d+|local:([1-9]\d{0,2})")
ANSWERS_WITHIN = 10.0  # Longest time until a scheduler answers [s].
WORKERS_WITHIN = 120.0  # Longest time without a worker [s].
CHUNK = 2.0  # Expected time of a chunk [s], which is much longer than the time to send it and to start processes.
_closing = threading.Event()  # Set when the client has ended, so that local workers end their processes.


@dataclass(frozen=True)
class Refusal:
    reason: str  # Why a worker does not run an item.


@dataclass(frozen=True)
class Workforce:
    """The function that runs items, and the number of items that run at the same time."""

    threads: int
    supervise: Supervise = supervise


def pool(workers: int | None) -> Workforce:
    """Workers on this machine, by default one per processor."""
    return Workforce(workers or worker_count())


def chunks(items: Iterable[Any]) -> list[list[Any]]:
    """Divide the items, in their order, into chunks with an expected time of about CHUNK seconds."""
    items = tuple(items)
    ends = zip(items, accumulate(map(expected_seconds, items)), strict=True)
    return [[item for item, _ in part] for _, part in groupby(ends, lambda pair: pair[1] // CHUNK)]


def run_item(function: Callable[[Any], Any], paths: tuple[str, ...], item_and_versions: bytes) -> Any:
    """The result of a pickled (item, versions), or a Refusal. paths: sys.path of the client."""
    sys.path += [path for path in paths if path not in sys.path and Path(path).exists()]
    try:
        item, local = pickle.loads(item_and_versions)
    except (ImportError, AttributeError) as error:
        return Refusal(describe(error))
    remote = versions_of(item, folders=OURS)
    different = sorted(name for name in {*local, *remote} if local.get(name) != remote.get(name))
    if different:
        pairs = ((name, remote.get(name, "missing"), local.get(name, "missing")) for name in different)
        return Refusal("; ".join("{} {} there, {} here".format(*pair) for pair in pairs))
    return function(item)


def run_chunk(data: bytes) -> bytes:
    """The pickled answers (index of the item, result or Loss, note) to a pickled chunk, in a Dask worker."""

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
def connect_cluster(scheduler: str | None, workers: int | None = None) -> Iterator[Workforce]:
    """The cluster that `--scheduler` names, or without a name the `pool` of this machine. Raises BadInput."""
    if scheduler is None:
        yield pool(workers)
        return
    refused = f"--scheduler is {scheduler!r}"
    if not (words := WORDS.fullmatch(scheduler)):
        raise BadInput(f"{refused}; it must be tcp://HOST:PORT of a Dask scheduler, or local:N for N workers here")
    try:
        import distributed
    except ImportError:
        raise BadInput(f"{refused}, which needs Dask, and it is not installed: pip install '.[cluster]'") from None
    for name in ("distributed", "tornado"):  # Rows report errors of workers.
        logging.getLogger(name).setLevel(logging.CRITICAL)
    with ExitStack() as stack:
        try:
            with process_start():  # Started processes ignore Ctrl-C, which this process handles.
                where: Any = scheduler
                if words[1]:  # Dask uses threads, since cells run in further processes.
                    folder = str(stack.enter_context(temporary_folder()))
                    options: dict[str, Any] = {"processes": False, "threads_per_worker": 1, "memory_limit": None}
                    options |= {"local_directory": folder, "dashboard_address": "127.0.0.1:0"}
                    where = stack.enter_context(distributed.LocalCluster(n_workers=int(words[1]), **options))
                    _closing.clear()
                    stack.callback(_closing.set)
                client = stack.enter_context(distributed.Client(where, timeout=ANSWERS_WITHIN, set_as_default=False))
                client.wait_for_workers(1, timeout=WORKERS_WITHIN)
        except OSError as error:  # This includes timeouts.
            raise BadInput(
                f"{refused}: no scheduler with workers answers there ({describe(error)[:200]}); start them with: dask "
                "scheduler, dask worker"
            ) from None
        yield Workforce(_threads(client), partial(_supervise, client, scheduler))


def _threads(client: Any) -> int:
    with suppress(OSError, ValueError):
        return sum(client.nthreads().values()) if client.status == "running" else 0
    return 0


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
    """Yield (item, result or Loss, note) like `supervise`. The number of workers is ignored. Raises BadInput if a
    worker has other versions. Raises WorkersLost if no worker connects for WORKERS_WITHIN seconds."""
    parts, job = chunks(items), partial(run_item, function, tuple(filter(None, sys.path)))
    packed = [
        (job, [pickle.dumps((item, versions_of(item, folders=OURS))) for item in part], limit, wall) for part in parts
    ]
    futures = client.map(run_chunk, [pickle.dumps(chunk) for chunk in packed], pure=False, retries=2)
    remaining = dict(zip(futures, parts, strict=True))
    seen = time.monotonic()
    try:
        while remaining:
            done = [future for future in remaining if future.done()]
            for future in done:
                part = remaining.pop(future)
                for index, result, note in _answers(future, len(part)):
                    if isinstance(result, Refusal):
                        raise BadInput(
                            f"a worker at {scheduler} would give other rows ({result.reason}): nothing was run there; "
                            "install the same"
                        )
                    yield part[index], result, note
            threads = _threads(client)
            seen = time.monotonic() if threads else seen
            if time.monotonic() - seen > WORKERS_WITHIN:
                raise WorkersLost(f"no worker is at {scheduler}: what is done is stored; start some with: dask worker")
            if watch is not None:
                watch([part[0] for part in list(remaining.values())[:threads]])
            time.sleep(0.0 if done else TICK)
    finally:
        with suppress(Exception):  # Errors of the scheduler do not matter any more.
            client.cancel(futures, force=True)


def _answers(future: Any, count: int) -> list[tuple[int, Any, str]]:
    try:
        return pickle.loads(future.result(timeout=ANSWERS_WITHIN))
    except (ImportError, AttributeError) as error:  # This program is not installed on the worker.
        return [(0, Refusal(describe(error)), "")]
    except Exception as error:
        loss = Loss(Outcome.LOST, f"every worker ended that ran it: {describe(error)}")
        return [(index, loss, "") for index in range(count)]
