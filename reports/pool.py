"""Supervised work: each item in a worker process with a time limit, so that a crash in native code is a result too."""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, TimeoutError, wait
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from pebble import ProcessExpired, ProcessPool

from reports.cells import Cell
from reports.measure import Measurement, blank, measure
from reports.outcomes import Outcome, describe_exit

WORKERS = 2
TIME_LIMIT = 60.0  # s for one cell: far above the cost limit of the grid, so only a hang meets it

Watch = Callable[[list[Any]], None]


@dataclass(frozen=True)
class Loss:
    """Why an item has no result."""

    outcome: Outcome
    sentence: str


def _prepare(folder: str) -> None:
    """In a worker: engines write logs into the working folder and to stderr; both go where the parent can look."""
    os.chdir(folder)
    log = os.open(f"{os.getpid()}.log", os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
    os.dup2(log, 1)
    os.dup2(log, 2)


def _limited(function: Callable[[Any], Any], limit: float, item: Any) -> Any:
    """In a worker: an alarm ends the process, even inside native code, should the parent be killed meanwhile."""
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.setitimer(signal.ITIMER_REAL, limit + 10)
    try:
        return function(item)
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def supervise(
    function: Callable[[Any], Any],
    items: Iterable[Any],
    limit: float = TIME_LIMIT,
    workers: int = WORKERS,
    watch: Watch | None = None,
) -> Iterator[tuple[Any, Any]]:
    """Yield (item, result or Loss) as they are done, in no order. `function` must be importable by its name.

    `watch` is told a few times a second which items are running. Leaving the iterator ends the workers.
    """
    # CPU time is counted over all threads of a process: a threaded BLAS would be charged for waiting.
    for name in ("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"):
        os.environ.setdefault(name, "1")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["reports.measure", "engines.registry"])
    with tempfile.TemporaryDirectory(prefix="crosscheck-") as folder:
        pool = ProcessPool(max_workers=workers, context=context, initializer=_prepare, initargs=(folder,))
        try:
            job = partial(_limited, function, limit)
            waiting: dict[Future[Any], Any] = {pool.schedule(job, (item,), timeout=limit): item for item in items}
            while waiting:
                done, _ = wait(waiting, timeout=0.2, return_when=FIRST_COMPLETED)
                for future in done:
                    yield waiting.pop(future), _result(future, limit, Path(folder))
                if watch is not None:
                    watch([item for future, item in waiting.items() if future.running()])
        finally:
            pool.stop()
            pool.join()


def _result(future: Future[Any], limit: float, folder: Path) -> Any:
    try:
        return future.result()
    except ProcessExpired as error:
        words = filter(None, (describe_exit(error.exitcode), _last_words(folder / f"{error.pid}.log")))
        return Loss(Outcome.ABORTED, ": ".join(words))
    except (TimeoutError, CancelledError):
        return Loss(Outcome.TIMED_OUT, f"did not end within {limit:g} s")
    except Exception as error:  # what an engine raises is a result, whatever it is
        return Loss(Outcome.FAILED, f"{type(error).__name__}: {error}")


def _last_words(log: Path) -> str:
    """The line in which native code said why it aborts, if it did."""
    with contextlib.suppress(OSError):
        lines = [line.strip() for line in log.read_text(errors="replace").splitlines() if line.strip()]
        telling = [line for line in lines if "abort" in line.lower() or "error" in line.lower()]
        for line in (telling or lines)[:1]:
            return line[:200]
    return ""


def run_cells(
    cells: Iterable[Cell],
    limit: float = TIME_LIMIT,
    workers: int = WORKERS,
    watch: Watch | None = None,
    timed: bool = True,
) -> Iterator[Measurement]:
    """Yield the measurement of every cell as it is done; a lost cell gives a row with its outcome and no numbers.

    `timed`: whether a cell is run again for the least of several times.
    """
    for cell, result in supervise(partial(measure, repeat=timed), cells, limit, workers, watch):
        yield blank(cell, result.outcome, result.sentence) if isinstance(result, Loss) else result
