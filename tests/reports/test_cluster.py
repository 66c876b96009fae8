"""Cells on a cluster: the same rows as the pool's, each once, whatever becomes of workers; none of other versions."""

from __future__ import annotations

import gc
import os
import pickle
import random
import signal
import subprocess
import sys
import threading
from collections import Counter
from dataclasses import asdict, replace
from importlib.metadata import version
from typing import Any

import pytest

from engines.registry import VARIANTS
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import Cell
from reports.model.ending import REFUSED, BadInput
from reports.model.measure import TIMINGS
from reports.model.outcomes import Loss, Outcome
from reports.model.tasks import Motion
from reports.run import cluster as clusters
from reports.run.cluster import Job, Refusal, chunks, cluster
from reports.run.running import run_cells, run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost
from tests import ROOT
from tests.reports.rough_toys import end_the_supervisor, wait_until
from tests.reports.test_command_line import call, one_line
from tests.toys import Disc, FailingToy, SlowToy, Toy

distributed = pytest.importorskip(
    "distributed", reason="Dask comes with the extra `cluster`: pip install -e '.[cluster]'"
)
psutil = pytest.importorskip("psutil", reason="it comes with Dask")
NOWHERE = "127.0.0.1:0"  # any free port, seen from this machine alone
# Dask leaves sockets to the garbage collector.
pytestmark = [
    pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


@pytest.fixture(scope="module", autouse=True)
def swept_up():
    """So that no other module's test is told of them."""
    yield
    gc.collect()


def local_cluster(workers: int) -> Any:
    start: Any = distributed.LocalCluster
    return start(n_workers=workers, threads_per_worker=1, dashboard_address=NOWHERE, memory_limit=None, silence_logs=50)


@pytest.fixture(scope="module")
def workers():
    """A scheduler with two workers, which come back when they are killed."""
    with local_cluster(2) as own:
        yield own


@pytest.fixture
def two_workers(workers):
    workers.scale(2)  # Dask gives one up that is killed while it starts
    return workers


@pytest.fixture
def no_workers():
    with local_cluster(0) as own:
        yield own


def untimed(row):
    return {name: repr(value) for name, value in asdict(row).items() if name not in TIMINGS}


def test_a_local_cluster_gives_the_same_rows_as_the_pool():
    cells = [Cell(FreeFourBar(), engine, 1, samples=20) for engine in VARIANTS[::3]]
    cells += [Cell(Disc(), toy, 1) for toy in (Toy(), *map(FailingToy, ("abort", "refuse", "raise")))]
    with cluster("local:2") as own:
        there = {row.key: untimed(row) for row in run_cells(cells, supervised=own.supervise)}
        assert own.threads == 2
    assert there == {row.key: untimed(row) for row in run_cells(cells)}
    assert {row["outcome"] for row in there.values()} >= {repr(Outcome.ABORTED), repr(Outcome.FINISHED)}


def test_an_abort_ends_a_cell_and_no_worker_and_tasks_go_the_same_way(two_workers, tmp_path):
    before = two_workers.scheduler_info["workers"].keys()
    items = [Cell(Disc(), FailingToy("abort"), 1), Cell(Disc(), Toy(), 1), Motion(Cell(Disc(), Toy(), 2))]
    with cluster(two_workers.scheduler_address) as own, Store(tmp_path / "cells.sqlite") as store:
        assert run_into(store, items, supervised=own.supervise) == 3
        assert run_into(store, items, supervised=own.supervise) == 0
        outcomes = {cell.engine.variant: row.outcome for cell, row in store.get(items[:2]).items()}
        [motion] = store.answers(items[2:]).values()
    assert outcomes == {"abort": Outcome.ABORTED, "default": Outcome.FINISHED}
    assert motion.array("pose").shape == (Disc().samples + 1, 1, 3)
    assert two_workers.scheduler_info["workers"].keys() == before


def test_what_a_worker_has_not_done_of_a_chunk_in_time_is_sent_again(two_workers):
    cells = [Cell(Disc(), SlowToy(seconds=0.3, factor=float(number)), 1) for number in range(9)]  # all in one chunk
    with cluster(two_workers.scheduler_address) as own:
        rows = list(run_cells(cells, timed=False, supervised=own.supervise))
    assert Counter(row.key for row in rows) == Counter(cell.key for cell in cells)


def test_an_item_that_ends_every_worker_is_lost_and_the_others_are_not(two_workers, monkeypatch):
    # Each takes a worker that has to start.
    monkeypatch.setattr(two_workers.scheduler, "allowed_failures", 1)
    monkeypatch.setattr(clusters, "MOST_TRIES", 2)
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 901)]
    with cluster(two_workers.scheduler_address) as own:
        told = {cell.every: result for cell, result, _ in own.supervise(end_the_supervisor, cells, 60.0)}
    lost = told.pop(901)
    assert isinstance(lost, Loss)
    assert lost.outcome == Outcome.LOST
    assert lost.sentence.startswith("every worker ended that ran it: KilledWorker")
    assert told == {1: "fine", 2: "fine"}


@pytest.mark.parametrize("kills", [2, pytest.param(20, marks=pytest.mark.slow)])
def test_workers_killed_at_random_times_lose_no_row_and_double_none(two_workers, tmp_path, kills):
    cells = [Cell(Disc(), SlowToy(seconds=0.05), every) for every in range(1, 1 + 30 * kills)]
    chance, killed, rows, over = random.Random(kills), [], [], threading.Event()

    def kill() -> None:
        while len(killed) < kills and not over.wait(chance.uniform(0.2, 2.0)):
            # Dask gives a worker up that is killed while it starts: then another takes its place.
            two_workers.scale(2)
            if there := [each.pid for each in list(two_workers.workers.values()) if each.pid]:
                killed.append(chance.choice(there))
                os.kill(killed[-1], signal.SIGKILL)

    killer = threading.Thread(target=kill)
    with cluster(two_workers.scheduler_address) as own, Store(tmp_path / "cells.sqlite") as store:
        killer.start()
        try:
            while not rows or len(killed) < kills:
                rows.clear()
                run_into(store, cells, fresh=True, done=rows.append, timed=False, supervised=own.supervise)
                assert Counter(row.key for row in rows) == Counter(cell.key for cell in cells)
        finally:
            over.set()
            killer.join()
        assert set(store.get(cells)) == set(cells)
    assert {row.outcome for row in rows} == {Outcome.FINISHED}
    assert len(killed) == kills


def test_a_worker_with_another_version_is_refused_and_both_are_named(no_workers, tmp_path, monkeypatch, capsys):
    fake = tmp_path / "elsewhere" / "pymunk-99.0.dist-info"
    fake.mkdir(parents=True)
    (fake / "METADATA").write_text("Metadata-Version: 2.1\nName: pymunk\nVersion: 99.0\n")
    (fake / "top_level.txt").write_text("pymunk\n")
    command = [sys.executable, "-m", "distributed.cli.dask_worker", no_workers.scheduler_address]
    worker = subprocess.Popen(
        [*command, "--no-nanny", "--nthreads", "1", "--no-dashboard", "--local-directory", str(tmp_path)],
        env={**os.environ, "PYTHONPATH": os.pathsep.join([str(fake.parent), str(ROOT)])},
        stderr=subprocess.DEVNULL,
    )
    monkeypatch.chdir(tmp_path)
    try:
        words = ("--every", "1", "--engine", "pymunk", "--variant", "tuned")
        assert call("run", "free_four_bar", *words, "--scheduler", no_workers.scheduler_address) == REFUSED
    finally:
        worker.kill()
        worker.wait()
    assert f"pymunk 99.0 there, {version('pymunk')} here" in one_line(capsys.readouterr().err)


def every_of(cell: Cell) -> int:
    return cell.every


def test_an_item_with_other_source_files_behind_it_or_none_is_not_run(tmp_path, monkeypatch):
    cell = Cell(Disc(), Toy(), 3)
    job = Job(pickle.dumps(every_of), ())
    assert job((0, pickle.dumps((cell, cell.key)))) == 3
    told = job((0, pickle.dumps((cell, "of other files"))))
    assert isinstance(told, Refusal)
    assert told.versions.keys() >= {"Python", "numpy", "our source files"}
    (tmp_path / "a_file_of_somebody.py").write_text("def f(item): return 'found'\n")
    theirs = b"\x80\x04\x8c\x12a_file_of_somebody\x8c\x01f\x93."  # what pickle makes of a function in it
    missing = job((0, b"(" + theirs[2:-1] + b"Nt."))
    assert isinstance(missing, Refusal)
    assert "a_file_of_somebody" in missing.versions["what it would run"]
    monkeypatch.setattr(sys, "path", [*sys.path])
    there = replace(job, function=theirs, paths=(str(tmp_path),))  # on the same machine it is found
    assert there((0, pickle.dumps((1, None)))) == "found"


def test_without_workers_a_run_ends_after_a_while_in_a_sentence(no_workers, monkeypatch):
    monkeypatch.setattr(clusters, "WORKERS_WITHIN", 0.5)
    with cluster(no_workers.scheduler_address) as own, pytest.raises(WorkersLost, match=r"no worker.*dask worker"):
        list(own.supervise(end_the_supervisor, [Cell(Disc(), Toy(), 1)], 60.0))


@pytest.mark.parametrize("command", ["run", "search"])
def test_no_scheduler_at_the_address_is_one_line(command, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(clusters, "ANSWERS_WITHIN", 0.3)
    assert call(command, "--scheduler", "tcp://127.0.0.1:1") == REFUSED
    assert "'tcp://127.0.0.1:1': no Dask scheduler answers there" in one_line(capsys.readouterr().err)


@pytest.mark.parametrize("words", ["local:0", "local:two", "127.0.0.1:8786", ""])
def test_words_that_name_no_scheduler_are_refused(words):
    with pytest.raises(BadInput, match=r"tcp://HOST:PORT .* or local:N"), cluster(words):
        pass


def test_without_dask_the_line_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(BadInput, match=r"pip install '\.\[cluster\]'"), cluster("local:2"):
        pass


def test_a_chunk_has_what_takes_its_time_together(monkeypatch):
    monkeypatch.setattr(clusters, "expected_seconds", float)
    assert [chunk.items for chunk in chunks([1.0, 0.1, 0.1, 0.2, 0.25])] == [(1.0,), (0.1, 0.1), (0.2,), (0.25,)]
    assert [len(chunk.items) for chunk in chunks([0.0] * 450)] == [200, 200, 50]


def test_no_worker_is_left_when_a_local_cluster_is_closed_at_work(monkeypatch):
    monkeypatch.setattr(clusters, "LONGEST", 0.0)  # the first is told before the others are begun
    before = set(psutil.pids())
    slow = [Cell(Disc(), SlowToy(seconds=1e4, factor=float(number)), 1) for number in range(4)]
    with cluster("local:2") as own:
        rows = run_cells([Cell(Disc(), Toy(), 1), *slow], timed=False, supervised=own.supervise)
        assert next(rows).settings == repr(Toy())  # the others are at work, or wait
        assert _workers(before)
    wait_until(lambda: not _workers(before))
    with cluster("local:1") as own:  # and the next one begins anew
        [row] = run_cells([Cell(Disc(), Toy(), 2)], timed=False, supervised=own.supervise)
    assert row.outcome == Outcome.FINISHED


def _workers(before: set[int]) -> list[int]:
    """Of this process's new processes those that a fork server has started."""
    servers = [child for child in psutil.Process().children() if "forkserver" in " ".join(child.cmdline())]
    return [worker.pid for server in servers for worker in server.children() if worker.pid not in before]
