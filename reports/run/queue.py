"""In what order items are worked on, by which worker, and on which processors.

Cells of one scene share what is dear to make: the exact motion, the tables of a rolling contact. Each worker makes its
own, so items that are akin go to one worker, while there is other work for the others.
"""

from __future__ import annotations

import csv
import math
import os
import warnings
from collections import deque
from collections.abc import Hashable, Iterable, Sequence
from contextlib import suppress
from functools import cache
from itertools import count
from pathlib import Path
from typing import Any, TypeVar

from reports.model.cells import Cell, estimated_cost
from reports.model.tasks import Task

PUBLISHED = Path(__file__).parents[1] / "results" / "timings.csv"
LEAST = 3e-3  # s that a cell takes besides stepping, before anything is known
TOPOLOGY = Path("/sys/devices/system/cpu")

Item = TypeVar("Item", bound=Cell | Task)
_numbers = count()


def kin_of(item: Any) -> Hashable:
    """What an item has in common with others (its attribute `kin`); a number of its own if it says nothing."""
    found = getattr(item, "kin", None)
    return next(_numbers) if found is None else found


class Waiting:
    """Jobs by kin: the kin that came first is given out first, and in each the job that came first."""

    def __init__(self) -> None:
        self._jobs: dict[Hashable, deque[Any]] = {}
        self._count = 0

    def __len__(self) -> int:
        return self._count

    def add(self, jobs: Iterable[Any]) -> None:
        """Jobs, each with an `item`."""
        for job in jobs:
            self._jobs.setdefault(kin_of(job.item), deque()).append(job)
            self._count += 1

    def take(self, own: Hashable, others: Iterable[Hashable]) -> tuple[Any, Hashable]:
        """(the next job for a worker, its kin). `own`: the kin of the worker's last job; `others`: of other workers'.

        Akin to its last job; else of a kin that no other worker has; else the first there is. Raises LookupError
        where none waits.
        """
        if not self._jobs:
            raise LookupError("nothing waits")
        kin = own
        if own not in self._jobs:
            taken = set(others)
            kin = next((one for one in self._jobs if one not in taken), next(iter(self._jobs)))
        queue = self._jobs[kin]
        job = queue.popleft()
        if not queue:
            del self._jobs[kin]
        self._count -= 1
        return job, kin


def expected_seconds(item: Any) -> float:
    """CPU seconds of one run: of a cell as published if it is, else by the engine's own formula; of a task by its own.

    It orders work and nothing else, so that a cell of other settings may stand for this one.
    """
    if not isinstance(item, Cell):
        return LEAST + float(getattr(item, "cost", 0.0))
    known = _published().get(_name(item))
    return LEAST + (estimated_cost(item) if known is None else known)


def dearest_first(items: Iterable[Item]) -> list[Item]:
    """Items that are akin together, the kin that takes longest first, and so in each.

    So that what begins last is short, and no worker runs long after the others have ended.
    """
    found: dict[Hashable, list[tuple[float, Item]]] = {}
    for item in items:
        found.setdefault(kin_of(item), []).append((expected_seconds(item), item))

    def seconds(pair: tuple[float, Item]) -> float:
        return pair[0]

    groups = sorted(found.values(), key=lambda group: -sum(map(seconds, group)))
    return [item for group in groups for _, item in sorted(group, key=seconds, reverse=True)]


def _name(cell: Cell) -> tuple[str, ...]:
    named = (cell.scene.name, cell.engine.name, cell.engine.variant, cell.purpose, cell.sample_count, cell.every)
    return tuple(map(str, named))


@cache
def _published(path: Path = PUBLISHED) -> dict[tuple[str, ...], float]:
    """Seconds of stepping and building by scene, engine, variant, purpose, samples and steps a sample.

    Where cells of several settings have these in common, the longest. Nothing where there is no such file, nor, with a
    warning, of a damaged one: work is then ordered by formulas.
    """
    found: dict[tuple[str, ...], float] = {}
    if not path.is_file():
        return found
    try:
        lines: Sequence[str] = [line for line in path.read_text(encoding="utf-8").splitlines() if line[:1] != "#"]
        for row in csv.DictReader(lines):
            name = tuple(row[part] for part in ("scene", "engine", "variant", "purpose", "samples", "every"))
            duration = float(row["step"]) * int(row["every"]) * int(row["samples"])
            seconds = float(row["cpu"]) * duration + float(row["build"])
            if math.isfinite(seconds):
                found[name] = max(seconds, found.get(name, 0.0))
    except (OSError, KeyError, ValueError, TypeError) as reason:
        warnings.warn(
            f"{path} can't be read ({type(reason).__name__}: {reason}): work is ordered by formulas", stacklevel=2
        )
        return {}
    return found


def usable() -> tuple[int, ...]:
    """The numbers of the processors that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return tuple(sorted(os.sched_getaffinity(0)))
    return tuple(range(os.cpu_count() or 1))


def apart() -> tuple[int, ...]:
    """Of the processors that this process may use one of each core: two of one core share its units and caches.

    All of them where the system does not tell which ones are of one core.
    """
    cores: dict[str, int] = {}
    for number in usable():
        core = str(number)
        with suppress(OSError):
            core = (TOPOLOGY / f"cpu{number}/topology/thread_siblings_list").read_text(encoding="ascii").strip()
        cores.setdefault(core, number)
    return tuple(cores.values())
