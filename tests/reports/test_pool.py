"""Supervised cells: every way to fail is a row, a killed run goes on, and the dearest begin, akin in one process."""

from __future__ import annotations

import os
import random
import signal
import subprocess
import sys
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from engines.registry import VARIANTS
from reference.scenes.catalogue import SCENES
from reports.__main__ import main
from reports.cli.selection import choose_cells
from reports.model.catalogue import PAGES
from reports.model.cells import Cell
from reports.model.outcomes import Outcome, describe_exit
from reports.model.tasks import Motion, Task, Values
from reports.run import queue
from reports.run.queue import Waiting, dearest_first, expected_seconds, kin_of
from reports.run.running import missing, run_cells, run_into, run_items
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from tests import ROOT
from tests.reports.rough_toys import RoughToy, wait_until
from tests.toys import FAILURES, Disc, FailingToy, Toy, in_process


@pytest.fixture(scope="module")
def failed_rows():
    """Every failing toy and a sound one, through the pool."""
    cells = [Cell(Disc(), FailingToy(variant), 1) for variant in FAILURES if variant != "hang"]
    hang = [Cell(Disc(), FailingToy("hang"), 1)]  # apart: a busy machine needs more wall time for all others
    rows = [*run_cells([*cells, Cell(Disc(), Toy(), 1)]), *run_cells(hang, wall=1.0)]
    return {row.variant: row for row in rows}


@pytest.mark.parametrize(("variant", "outcome"), FAILURES.items())
def test_each_way_to_fail_is_an_outcome_of_its_own(failed_rows, variant, outcome):
    assert failed_rows[variant].outcome == outcome
    assert failed_rows[variant].sentence


def test_a_sentence_is_the_engines_own_or_tells_the_signal_and_the_last_words(failed_rows):
    assert failed_rows["default"].angle == pytest.approx(failed_rows["default"].step ** 2, rel=1e-9)
    assert "signal 6 (SIGABRT)" in failed_rows["abort"].sentence
    assert "Aborting due to Toy error: no such thing" in failed_rows["abort"].sentence
    assert failed_rows["exit"].sentence == describe_exit(3)
    assert failed_rows["refuse"].sentence == "mass is -1; it must be greater than zero"
    assert failed_rows["unsupported"].sentence == "it has no pins"


def test_stored_cells_are_not_run_again_unless_asked(tmp_path):
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2)]
    with Store(tmp_path / "cells.sqlite") as store:
        assert run_into(store, cells[:1], supervised=in_process) == 1
        assert run_into(store, cells, supervised=in_process) == 1
        assert run_into(store, cells, supervised=in_process) == 0
        assert run_into(store, cells, fresh=True, supervised=in_process) == 2
        rows = store.get(cells)
    assert [rows[cell].every for cell in cells] == [1, 2]


def test_what_was_timed_out_is_run_again_with_more_time_and_never_with_less(tmp_path):
    cell = Cell(Disc(), Toy(), 1)
    items = [cell, Motion(cell)]

    def outcomes(store):
        return {result.outcome for result in (store.get(items[:1])[cell], store.answers(items[1:])[items[1]])}

    with Store(tmp_path / "cells.sqlite") as store:
        assert run_into(store, items, limit=1e-9) == 2
        assert outcomes(store) == {Outcome.TIMED_OUT}
        assert store.get(items[:1])[cell].sentence == "did not end within 1e-09 s of CPU time"
        assert run_into(store, items, limit=1e-9) == run_into(store, items, limit=5e-10) == 0
        assert missing(items, store, limit=2e-9) == tuple(items)
        assert run_into(store, items) == 2
        assert outcomes(store) == {Outcome.FINISHED}
        assert run_into(store, items, limit=1e-9) == 0
        assert outcomes(store) == {Outcome.FINISHED}


def test_what_is_killed_from_outside_twice_is_told_and_not_stored(tmp_path):
    cells = [Cell(Disc(), RoughToy("kill"), 1), Cell(Disc(), Toy(), 1)]
    task = Motion(cells[0])
    done = []
    with Store(tmp_path / "cells.sqlite") as store:
        with pytest.raises(WorkersLost, match=r"2 of 3 cells are lost, the others are stored.*SIGKILL"):
            run_into(store, [*cells, task], done=done.append)
        assert set(missing([*cells, task], store)) == {cells[0], task}
        assert list(store.get(cells)) == [cells[1]]
    assert sorted(result.outcome for result in done) == [Outcome.FINISHED, Outcome.LOST, Outcome.LOST]


def test_lost_workers_are_one_line_and_status_1_at_the_command_line(monkeypatch, tmp_path, capsys):
    def lost(*_: object, **__: object) -> int:
        raise WorkersLost("5 worker processes in a row ended while they started: why")

    monkeypatch.setattr("reports.run.running.run_into", lost)
    with pytest.raises(SystemExit) as end:
        main(["run", "free_four_bar", "--every", "1", "--results", str(tmp_path)])
    assert end.value.code == 1
    assert capsys.readouterr().err == "crosscheck: 5 worker processes in a row ended while they started: why\n"


SCRIPT = """
import signal
import sys
from pathlib import Path
from reports.model.cells import Cell
from reports.run.running import run_into
from reports.run.store import Store
from tests.toys import Disc, FailingToy, Toy

if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3, 4)] + [Cell(Disc(), FailingToy("hang"), 1)]
    with Store(Path(sys.argv[1])) as store:
        run_into(store, cells, done=lambda row: print(row.every, flush=True))
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_after_a_kill_the_next_run_goes_on_where_it_stopped(tmp_path, how):
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    path = tmp_path / "cells.sqlite"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    # What a shell starts in the background ignores Ctrl-C, and so do its children, unless they ask for it.
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        with (tmp_path / "stderr").open("wb") as stderr:
            process = subprocess.Popen(
                [sys.executable, tmp_path / "script.py", path],
                env=environment,
                stdout=subprocess.PIPE,
                stderr=stderr,
            )
    finally:
        signal.signal(signal.SIGINT, before)
    assert process.stdout is not None
    with process.stdout:
        for _ in range(4):
            assert process.stdout.readline().strip(), (tmp_path / "stderr").read_text(encoding="utf-8")
    process.send_signal(how)
    # A hang in a worker must not hold up the end: its wall limit alone would take eleven minutes.
    assert process.wait(timeout=60) != 0
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3, 4)]
    with Store(path) as store:
        assert missing(cells, store) == ()
        assert run_into(store, [*cells, Cell(Disc(), Toy(), 5)]) == 1


@dataclass(frozen=True)
class Kindred:
    kin: str
    number: int


def jobs(*names: str) -> list[SimpleNamespace]:
    return [SimpleNamespace(item=Kindred(name, number)) for number, name in enumerate(names)]


def test_a_worker_stays_with_its_kin_then_takes_one_that_nobody_has_and_at_last_helps_others():
    waiting = Waiting()
    waiting.add(jobs("a", "b", "a", "b", "c"))
    assert len(waiting) == 5
    first, kin = waiting.take(None, [])
    assert (first.item.number, kin) == (0, "a")
    second, other = waiting.take(None, ["a"])
    assert (second.item.number, other) == (1, "b")
    assert waiting.take("a", ["b"])[0].item.number == 2
    assert waiting.take("a", ["b"])[0].item.number == 4  # c, which nobody has
    assert waiting.take("c", ["b"])[0].item.number == 3  # nothing else is left
    with pytest.raises(LookupError):
        waiting.take("c", [])


def test_cells_and_motions_of_a_scene_are_akin_and_those_of_another_are_not():
    cell = Cell(Disc(), Toy(), 1)
    assert kin_of(cell) == kin_of(Cell(Disc(), Toy(), 7)) == kin_of(Motion(cell))
    assert kin_of(cell) != kin_of(Cell(Disc(rate=3.0), Toy(), 1))


def test_the_dearest_kin_comes_first_and_in_it_the_dearest_cell(monkeypatch):
    costs = {(2.0, 1): 1.0, (2.0, 2): 3.0, (5.0, 1): 2.5, (7.0, 1): 2.0, (7.0, 3): 2.5}
    cells = {Cell(Disc(rate=rate), Toy(), every): (rate, every) for rate, every in costs}
    monkeypatch.setattr(queue, "expected_seconds", lambda cell: costs[cells[cell]])
    mixed = random.Random(1).sample(list(cells), len(cells))
    assert [cells[cell] for cell in dearest_first(mixed)] == [(7.0, 3), (7.0, 1), (2.0, 2), (2.0, 1), (5.0, 1)]


def test_what_a_cell_took_when_it_was_published_counts_more_than_a_formula(tmp_path, monkeypatch):
    cell = Cell(Disc(), Toy(), 2)
    named = f"{cell.scene.name},toy,default,sweep,x,y,{cell.sample_count},2"
    (tmp_path / "timings.csv").write_text(
        "# of a run\nscene,engine,variant,purpose,parameters,settings,samples,every,step,cpu,runs,build\n"
        f"{named},{cell.step},10.0,1,0.5\n{named},{cell.step},5.0,1,0.25\n"
        f"{named.replace('sweep', 'map')},{cell.step},nan,0,nan\n",
        encoding="utf-8",
    )
    assert expected_seconds(cell) < 1.0
    published = queue._published(tmp_path / "timings.csv")
    assert queue._published(tmp_path / "none.csv") == {}
    monkeypatch.setattr(queue, "_published", lambda: published)
    assert expected_seconds(cell) == pytest.approx(10.0 * cell.scene.duration + 0.5 + queue.LEAST, rel=1e-9)
    assert expected_seconds(replace(cell, purpose="map")) < 1.0  # it has no number there


def test_published_timings_that_are_damaged_are_told_and_change_no_cell_of_a_quick_run(tmp_path, monkeypatch):
    quick = choose_cells(SCENES[:3], VARIANTS, PAGES, False)
    (tmp_path / "timings.csv").write_text("scene,engine\ndisc,toy\n", encoding="utf-8")
    with pytest.warns(UserWarning, match="can't be read"):
        assert queue._published(tmp_path / "timings.csv") == {}
    monkeypatch.setattr(queue, "_published", lambda: {})
    assert choose_cells(SCENES[:3], VARIANTS, PAGES, False) == quick
    named = {queue._name(cell): 100.0 for cell in quick}
    monkeypatch.setattr(queue, "_published", lambda: named)
    assert choose_cells(SCENES[:3], VARIANTS, PAGES, False) == quick


def process_of(folder: Path, item: Kindred) -> int:
    """Once the other worker is there too."""
    (folder / str(os.getpid())).touch()
    wait_until(lambda: len([*folder.iterdir()]) >= 2)
    return os.getpid()


def test_each_kin_is_worked_on_in_one_process_while_there_is_other_work(tmp_path):
    items = [Kindred(name, number) for number in range(6) for name in ("a", "b")]
    where: dict[str, set[int]] = {"a": set(), "b": set()}
    for item, process, _ in supervise(partial(process_of, tmp_path), items, 60.0, 2):
        where[item.kin].add(process)
    # The one that is done first helps the other.
    assert min(len(found) for found in where.values()) == 1
    assert len(set.union(*where.values())) == 2


def where_it_stays(item: int) -> tuple[int, ...]:
    return tuple(sorted(os.sched_getaffinity(0)))


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system keeps no process on a processor")
def test_a_worker_that_times_stays_on_a_processor_of_its_own_and_others_on_none():
    own = queue.apart()
    told = {found for _, found, _ in supervise(where_it_stays, range(4), 60.0, len(own), None, None, True)}
    assert told <= {(one,) for one in own}
    assert [found for _, found, _ in supervise(where_it_stays, [0], 60.0, 1)] == [queue.usable()]


def test_of_processors_that_share_a_core_one_is_taken(tmp_path, monkeypatch):
    monkeypatch.setattr(queue, "usable", lambda: (0, 1, 2, 3, 4))
    monkeypatch.setattr(queue, "TOPOLOGY", tmp_path)
    assert queue.apart() == (0, 1, 2, 3, 4)  # the system does not tell
    for number, siblings in enumerate(("0,2", "1,3", "0,2", "1,3")):
        (tmp_path / f"cpu{number}/topology").mkdir(parents=True)
        (tmp_path / f"cpu{number}/topology/thread_siblings_list").write_text(siblings + "\n", encoding="ascii")
    assert queue.apart() == (0, 1, 4)


@dataclass(frozen=True)
class Where(Task):
    """Where it runs."""

    number: int

    @property
    def cost(self) -> float:
        return 0.0

    @property
    def label(self) -> str:
        return "where"

    def run(self) -> Values:
        return {"process": np.array(float(os.getpid()))}


def test_more_workers_than_cores_run_what_is_timed_first_and_alone(monkeypatch):
    monkeypatch.setattr("reports.run.running.worker_count", lambda timed: 1 if timed else 2)
    rounds = []

    def told(function, items, limit, workers, watch, wall, alone):
        rounds.append(([type(item).__name__ for item in items], workers, alone))
        return in_process(function, items)

    items = [Cell(Disc(), Toy(), 1), Where(1), Cell(Disc(), Toy(), 2, "map")]
    assert {item for item, _ in run_items(items, workers=3, supervised=told)} == set(items)
    assert [(sorted(names), *rest) for names, *rest in rounds] == [(["Cell"], 1, True), (["Cell", "Where"], 3, False)]
    rounds.clear()
    assert len(list(run_items(items, workers=3, timed=False, supervised=told))) == 3
    assert [each[1:] for each in rounds] == [(3, False)]
