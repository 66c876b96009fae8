"""Tests of a cluster: it returns the same rows as the pool even if workers are killed, and refuses other versions."""

from __future__ import annotations

import gc
import pickle
import sys
from dataclasses import asdict
from importlib.metadata import version
from typing import Any

import pytest

from reports.model.cells import Cell
from reports.model.ending import BadInput
from reports.model.fingerprint import OURS, versions_of
from reports.model.measure import TIMINGS
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Motion
from reports.run import cluster as clusters
from reports.run.cluster import Refusal, chunks, connect_cluster, run_item
from reports.run.running import run_cells, run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost
from tests.reports.rough_toys import end_the_supervisor
from tests.toys import Disc, FailingToy, SlowToy, Toy

distributed = pytest.importorskip(
    "distributed", reason="Dask comes with the extra `cluster`: pip install -e '.[cluster]'"
)
# Dask leaves sockets open until garbage collection.
pytestmark = [
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture
def workers():
    """A scheduler with two workers, which are restarted when they are killed."""
    start: Any = distributed.LocalCluster
    options = {"threads_per_worker": 1, "dashboard_address": "127.0.0.1:0", "memory_limit": None, "silence_logs": 50}
    with start(n_workers=2, **options) as cluster:
        yield cluster
    gc.collect()


def untimed(row):
    return {name: repr(value) for name, value in asdict(row).items() if name not in TIMINGS}


def test_a_local_cluster_gives_the_same_rows_and_answers_as_the_pool(tmp_path):
    cells = [Cell(Disc(), toy, 1) for toy in (Toy(), *map(FailingToy, ("abort", "refuse", "raise")))]
    items = [*cells, Motion(Cell(Disc(), Toy(), 2))]
    with connect_cluster("local:2") as cluster, Store(tmp_path / "cells.sqlite") as store:
        assert run_into(store, items, supervised=cluster.supervise) == 5
        assert run_into(store, items, supervised=cluster.supervise) == 0
        on_cluster = {row.key: untimed(row) for row in store.get(cells).values()}
        assert store.answers(items[4:])
    assert on_cluster == {row.key: untimed(row) for row in run_cells(cells)}


def test_an_item_that_ends_every_worker_is_lost_and_the_others_are_not(workers, monkeypatch):
    monkeypatch.setattr(workers.scheduler, "allowed_failures", 1)
    monkeypatch.setattr(clusters, "CHUNK", 1e-9)
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 901)]
    with connect_cluster(workers.scheduler_address) as cluster:
        results = {cell.every: result for cell, result, _ in cluster.supervise(end_the_supervisor, cells, 60.0)}
    missing = results.pop(901)
    assert isinstance(missing, Loss)
    assert missing.outcome == Outcome.LOST
    assert missing.sentence.startswith("every worker ended that ran it: KilledWorker")
    assert results == {1: "fine", 2: "fine"}


def test_without_workers_a_run_ends_after_a_timeout_with_a_reason(workers, monkeypatch):
    monkeypatch.setattr(clusters, "WORKERS_WITHIN", 5.0)
    with connect_cluster(workers.scheduler_address) as cluster:
        workers.scale(0)
        with pytest.raises(WorkersLost, match=r"no worker.*dask worker"):
            list(cluster.supervise(end_the_supervisor, [Cell(Disc(), SlowToy(seconds=1e4), 1)], 60.0))


def every_of(cell: Cell) -> int:
    return cell.every


def test_an_item_with_other_source_files_or_none_is_not_run(tmp_path, monkeypatch):
    cell = Cell(Disc(), Toy(), 3)
    versions = versions_of(cell, folders=OURS)
    assert versions.keys() >= {"Python", "numpy", "our source files"}
    assert run_item(every_of, (), pickle.dumps((cell, versions))) == 3
    refused = run_item(every_of, (), pickle.dumps((cell, {**versions, "numpy": "99.0", "another": "1"})))
    assert refused == Refusal(f"another missing there, 1 here; numpy {version('numpy')} there, 99.0 here")
    theirs = b"(\x8c\x12a_file_of_somebody\x8c\x01f\x93}t."  # a pickled function of the module `a_file_of_somebody`
    assert "a_file_of_somebody" in run_item(str, (), theirs).reason
    (tmp_path / "a_file_of_somebody.py").write_text("def f(item): return 'found'\n")
    monkeypatch.setattr(sys, "path", [*sys.path])
    assert "files of a_file_of_somebody" in run_item(str, (str(tmp_path),), theirs).reason  # it is in the given folder


def test_a_missing_scheduler_or_dask_is_reported_in_one_line(monkeypatch):
    with pytest.raises(BadInput, match=r"tcp://HOST:PORT .* or local:N"), connect_cluster("local:0"):
        pass
    monkeypatch.setattr(clusters, "ANSWERS_WITHIN", 0.3)
    with pytest.raises(BadInput, match="no scheduler with workers answers there"), connect_cluster("tcp://127.0.0.1:1"):
        pass
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadInput, match=r"pip install '\.\[cluster\]'"), connect_cluster("local:2"):
        pass


def test_items_are_grouped_into_chunks_by_their_expected_time(monkeypatch):
    monkeypatch.setattr(clusters, "expected_seconds", float)
    assert chunks([3.0, 1.0, 1.0, 0.5, 2.0]) == [[3.0], [1.0, 1.0, 0.5], [2.0]]
