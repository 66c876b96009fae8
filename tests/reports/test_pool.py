"""Supervised cells: every way to fail is a row, every row is kept, and a killed run goes on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from dataclasses import replace

import pytest

from reports.__main__ import main
from reports.model.cells import Cell
from reports.model.measure import measure
from reports.model.outcomes import Outcome, describe_exit
from reports.model.tasks import Motion
from reports.run.queue import apart, usable
from reports.run.running import missing, run_cells, run_into, worker_count
from reports.run.store import Store
from reports.run.supervisor import WorkersLost
from tests import ROOT
from tests.reports.rough_toys import RoughToy
from tests.toys import FAILURES, Disc, FailingToy, ImpossibleDisc, Toy


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


def test_where_the_textbook_refuses_the_engine_is_run_and_the_refusal_told():
    row = measure(Cell(ImpossibleDisc(), Toy(), 1))
    assert row.outcome == Outcome.FINISHED
    assert "no such motion" in row.sentence
    assert row.angle != row.angle


def test_stored_cells_are_not_run_again_unless_asked(tmp_path):
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2)]
    with Store(tmp_path / "cells.sqlite") as store:
        assert run_into(store, cells[:1]) == 1
        assert run_into(store, cells) == 1
        assert run_into(store, cells) == 0
        assert run_into(store, cells, fresh=True) == 2
        rows = store.get(cells)
    assert [rows[cell].every for cell in cells] == [1, 2]


@pytest.mark.parametrize(("field", "value"), [("every", 0), ("every", 1.5), ("samples", -1)])
def test_cells_refuse_counts_that_cannot_be(field, value):
    with pytest.raises(ValueError, match=field):
        replace(Cell(Disc(), Toy(), 1), **{field: value})


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


def test_what_is_not_timed_uses_every_processor():
    assert worker_count(timed=False) == len(usable()) >= 1
    assert worker_count(timed=True) == len(apart()) >= 1


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
