"""Items that wait for a worker: those that are akin go to the same worker, while there is other work for the others.

Cells of one scene share what is dear to make: the exact motion, the tables of a rolling contact. Each worker makes its
own.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable, Iterable
from itertools import count
from typing import Any

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
