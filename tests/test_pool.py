"""Supervised cells: every way to fail is a row, every row is kept, and a killed run goes on."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest

from reports.cells import Cell
from reports.measure import measure
from reports.outcomes import Outcome, describe_exit
from reports.pool import run_cells
from reports.running import missing, run_into
from reports.store import Store
from tests.toys import FAILURES, Disc, FailingToy, ImpossibleDisc, Toy

ROOT = Path(__file__).resolve().parent.parent


@pytest.fixture(scope="module")
def failed_rows():
    """Every failing toy and a sound one, through the pool."""
    cells = [Cell(Disc(), FailingToy(variant), 1) for variant in FAILURES] + [Cell(Disc(), Toy(), 1)]
    return {row.variant: row for row in run_cells(cells, limit=2.0)}


@pytest.mark.parametrize(("variant", "outcome"), FAILURES.items())
def test_each_way_to_fail_is_an_outcome_of_its_own(failed_rows, variant, outcome):
    assert failed_rows[variant].outcome == outcome
    assert failed_rows[variant].sentence


def test_a_sound_cell_among_crashing_ones_is_measured(failed_rows):
    row = failed_rows["default"]
    assert row.outcome == Outcome.FINISHED
    assert row.angle == pytest.approx(row.step**2, rel=1e-9)


def test_an_abort_tells_its_signal_and_its_last_words(failed_rows):
    assert "signal 6 (SIGABRT)" in failed_rows["abort"].sentence
    assert "Aborting due to Toy error: no such thing" in failed_rows["abort"].sentence
    assert failed_rows["exit"].sentence == describe_exit(3)


def test_the_sentence_of_a_refusal_is_the_engine_s_own(failed_rows):
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


SCRIPT = """
import sys
from pathlib import Path
from reports.cells import Cell
from reports.running import run_into
from reports.store import Store
from tests.toys import Disc, FailingToy, Toy

if __name__ == "__main__":
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3, 4)] + [Cell(Disc(), FailingToy("hang"), 1)]
    with Store(Path(sys.argv[1])) as store:
        run_into(store, cells, limit=8.0, done=lambda row: print(row.every, flush=True))
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_after_a_kill_the_next_run_goes_on_where_it_stopped(tmp_path, how):
    (tmp_path / "script.py").write_text(SCRIPT)
    path = tmp_path / "cells.sqlite"
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    with (tmp_path / "stderr").open("wb") as stderr:
        process = subprocess.Popen(
            [sys.executable, tmp_path / "script.py", path],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=stderr,
        )
    assert process.stdout is not None
    with process.stdout:
        for _ in range(4):
            assert process.stdout.readline().strip(), (tmp_path / "stderr").read_text()
    started = time.monotonic()
    process.send_signal(how)
    assert process.wait(timeout=20) != 0
    if how == signal.SIGINT:
        # A hang in a worker must not hold up the end: its limit alone would take 8 s.
        assert time.monotonic() - started < 7
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3, 4)]
    with Store(path) as store:
        assert missing(cells, store) == ()
        assert run_into(store, [*cells, Cell(Disc(), Toy(), 5)]) == 1
