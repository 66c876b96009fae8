"""`--scheduler`: who runs the cells, this machine's pool or a Dask cluster."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol

from reports.run.supervisor import Supervise


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
    supervise: Supervise


def pool(workers: int | None) -> Pool:
    """So many workers; as many as processors for None."""
    from reports.run.pool import worker_count
    from reports.run.supervisor import supervise

    return Pool(workers or worker_count(timed=False), supervise)


@contextmanager
def elsewhere(scheduler: str | None) -> Iterator[Workforce | None]:
    """A cluster; None without a scheduler. Raises BadInput where there is none."""
    if scheduler is None:
        yield None
        return
    from reports.run.cluster import cluster

    with cluster(scheduler) as own:
        yield own
