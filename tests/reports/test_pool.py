"""Tests of the pool: a failure gives a row, no row is lost when workers are killed, and a run can be continued."""

from __future__ import annotations

import contextlib
import os
import random
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

from reports.cli import conform as conform_command
from reports.cli.conform import Named, asked
from reports.model.cells import Cell
from reports.model.outcomes import Loss, Outcome, describe_exit, from_outside
from reports.model.tasks import Motion
from reports.run import supervisor, worker
from reports.run.running import longest_first, missing, run_cells, run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from tests import ROOT
from tests.reports.rough_toys import RoughToy, act, dies, fork_server, is_free, wait_until
from tests.toys import Disc, FailingToy, Toy, in_process

pytest.importorskip("fcntl", reason="signals and locks of Unix are the subject here")

# The engine of a job -> the outcome of the job, and a part of the sentence that describes the outcome.
ENDS = {
    RoughToy("segfault"): ("aborted", "aborted with signal 11 (SIGSEGV)"),
    RoughToy("closes files"): ("aborted", "exit status 1"),
    RoughToy("kill"): ("lost", "signal 9 (SIGKILL), perhaps for want of memory; before that: killed"),
    RoughToy("native spin"): ("timed out", "did not end within 0.5 s of CPU time"),
    RoughToy("needs two"): ("failed", "NeedsTwo: 1 and 2"),
    RoughToy("unprintable"): ("failed", "Unprintable: (it can't be printed)"),
    RoughToy("system exit"): ("failed", "SystemExit: 3"),
    FailingToy("exit"): ("aborted", "exit status 3"),
    FailingToy("abort"): ("aborted", "Aborting due to Toy error: no such thing"),
}
# Jobs that succeed but change their process.
LEAVES = (
    *("blocks signals", "changes environment", "changes folder"),
    *("closes streams", "installs handlers", "leaves threads"),
)


def test_each_failure_has_its_own_outcome_and_does_not_change_other_cells():
    sound = {Toy(factor=float(index)): index for index in range(1, 6)}
    cells = [Cell(Disc(), toy, 1) for toy in (*ENDS, *sound)]
    rows = {row.settings: row for row in run_cells(cells, limit=0.5, workers=2)}
    for toy, (outcome, sentence) in ENDS.items():
        assert rows[repr(toy)].outcome == outcome, toy
        assert sentence in rows[repr(toy)].sentence
    for toy, index in sound.items():
        assert rows[repr(toy)].angle == pytest.approx(float(index) * cells[0].step ** 2, rel=1e-9)
    # "native sleep" is run separately, since its limit of the wall time would be too short for other actions.
    (row,) = run_cells([Cell(Disc(), RoughToy("native sleep"), 1)], wall=1.0)
    assert (row.outcome, row.sentence) == ("timed out", "did not end within 1 s, and used less than 60 s of CPU time")


def test_a_job_that_changes_its_process_does_not_affect_the_next_job(capfd):
    items = ["process", "process", *(name for action in LEAVES for name in (action, "process"))]
    answers = list(supervise(act, items, limit=60.0, workers=1))
    assert [item for item, *_ in answers] == items
    first, *numbers = [result for item, result, _ in answers if item == "process"]
    assert numbers[0] == first  # the process of a successful job is used again
    assert len(set(numbers)) == 1 + len(LEAVES)
    assert capfd.readouterr() == ("", "")


def test_a_value_that_can_not_be_pickled_is_a_failure_with_a_reason():
    items = ["process", threading.Lock(), "unreadable", "process"]
    results = [result for _, result, _ in supervise(act, items, limit=60.0, workers=1)]
    assert isinstance(results[0], int)
    assert all(loss.outcome == Outcome.FAILED for loss in results[1:3])
    assert results[1].sentence.startswith("can't be sent to a worker: TypeError")
    assert results[2].sentence.startswith("its result can't be read: TypeError")


def test_a_cell_whose_worker_was_killed_is_tried_once_more_in_a_new_worker(tmp_path):
    names = ("kill once", "segfault once")
    for name in names:
        (tmp_path / name).mkdir()
    rows = {
        row.variant: row
        for row in run_cells(Cell(Disc(), RoughToy(name, folder=str(tmp_path / name)), 1) for name in names)
    }
    assert {row.outcome for row in rows.values()} == {Outcome.FINISHED}
    # A crash is reported even if it does not repeat, since the engine causes it. A SIGKILL comes from outside.
    crash = "the first try aborted with signal 11 (SIGSEGV), the second went through"
    assert [rows[name].sentence for name in names] == ["", crash]
    # If one item has damaged native memory, the next item must not crash.
    answers = supervise(act, ["damage", "damage", "crash where damaged"], limit=60.0, workers=2)
    assert {item: result for item, result, _ in answers} == {"damage": None, "crash where damaged": "sound"}


def test_time_in_which_the_parent_was_stopped_is_not_counted(monkeypatch):
    clock, looks = time.monotonic, iter(range(10**9))
    monkeypatch.setattr(supervisor, "time", SimpleNamespace(monotonic=lambda: clock() + 100.0 * next(looks)))
    (row,) = run_cells([Cell(Disc(), RoughToy("short sleep"), 1)], limit=5.0, wall=60.0, timed=False)
    assert row.outcome == Outcome.FINISHED


def test_workers_that_end_while_they_start_are_replaced_or_reported_in_one_line(monkeypatch):
    start, starts = supervisor.start_worker, iter(range(100))

    def start_or_fail(*arguments):
        if next(starts) < 2:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        return start(*arguments)

    monkeypatch.setattr(supervisor, "start_worker", start_or_fail)
    assert [type(result) for _, result, _ in supervise(act, ["process"], limit=60.0, workers=1)] == [int]
    monkeypatch.setattr(worker, "work", dies)
    with pytest.raises(WorkersLost, match=r"5 worker processes in a row ended while they started: .*SIGKILL"):
        list(supervise(act, ["process"], limit=60.0, workers=1))


def test_exit_codes_are_distinguished():
    for code, outside, text in (
        (-signal.SIGKILL, True, "killed from outside with signal 9 (SIGKILL)"),
        (-signal.SIGFPE, False, "aborted with signal 8 (SIGFPE)"),
        (-200, False, "aborted with signal 200 (unknown)"),
        (0xC0000005, False, "aborted with status 0xC0000005"),
        (None, True, "the process ended with an unknown exit status"),
    ):
        assert (from_outside(code), describe_exit(code)) == (outside, text)


class Killer:
    """Kills workers and the fork server at random times with random signals."""

    def __init__(self, kills: int, monkeypatch: pytest.MonkeyPatch) -> None:
        self.kills = self.lost_workers = 0
        self._random, self._planned, self._timers = random.Random(1), kills, []
        self._pools: list[supervisor.Pool] = []
        create = supervisor.Pool
        monkeypatch.setattr(supervisor, "Pool", lambda *terms: self._pools.append(create(*terms)) or self._pools[-1])

    def arm(self) -> None:
        if len(self._timers) < self._planned:
            way = self._random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV, None])
            timer = threading.Timer(self._random.uniform(0.0, 0.1), self._kill, (way, self._random.random()))
            timer.start()
            self._timers.append(timer)

    def _kill(self, how: int | None, which: float) -> None:
        with contextlib.suppress(ProcessLookupError, ValueError, IndexError):  # the process may have ended already
            workers = self._pools[0]._workers
            number = fork_server() if how is None else workers[int(which * len(workers))].process.pid
            if number is not None:
                os.kill(number, signal.SIGKILL if how is None else how)
                self.kills += 1
                # The pool loses every worker of a killed fork server, since it no longer knows their exit status.
                self.lost_workers += len(workers) if how is None else 1

    def wait(self) -> None:
        for timer in self._timers:
            timer.join()


def test_with_killed_workers_every_row_is_returned_once_and_correct(monkeypatch):
    killer = Killer(5, monkeypatch)
    cells = [Cell(Disc(), RoughToy("short sleep", factor=float(index)), 1) for index in range(16)]
    rows = []
    for row in run_cells(cells, workers=2, timed=False):
        rows.append(row)
        killer.arm()
    killer.wait()
    assert sorted(row.settings for row in rows) == sorted(repr(cell.engine) for cell in cells)
    factors = {repr(cell.engine): vars(cell.engine)["factor"] for cell in cells}
    done = [row for row in rows if row.outcome == Outcome.FINISHED]
    for row in done:
        assert row.angle == pytest.approx(factors[row.settings] * row.step**2, rel=1e-9)
    # Only a cell that was killed twice has no answer, and its sentence states that.
    assert all(row.outcome in (Outcome.LOST, Outcome.ABORTED) for row in rows if row not in done)
    assert len(rows) - len(done) <= killer.lost_workers // 2
    assert killer.kills > 2


ORPHANS = """
import sys
from pathlib import Path
from reports.model.cells import Cell
from reports.run.running import run_into
from reports.run.store import Store
from tests.reports.rough_toys import RoughToy
from tests.toys import Disc, Toy

if __name__ == "__main__":
    folder = Path(sys.argv[1])
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2)]
    cells += [Cell(Disc(), RoughToy(kind, folder=sys.argv[1]), 1) for kind in ("held sleep", "held native spin")]
    with Store(folder / "cells.sqlite") as store:
        run_into(store, cells, done=lambda row: (folder / f"{row.every} is there").touch(), workers=2)
"""


@pytest.fixture(scope="module")
def folder_of_killed_run(tmp_path_factory):
    """The folder of a run that was killed after it had stored two rows. At that time one worker slept, and native code
    of the other worker held the interpreter lock."""
    folder = tmp_path_factory.mktemp("killed")
    script = folder / "script.py"
    script.write_text(ORPHANS, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, script, folder], env=environment, stderr=subprocess.DEVNULL)
    try:
        marks = [folder / f"{name} is there" for name in (1, 2, "sleep", "native spin")]
        wait_until(lambda: all(mark.exists() for mark in marks))
    finally:
        process.kill()
        process.wait()
    return folder


def test_workers_end_when_their_parent_is_gone(folder_of_killed_run):
    for kind in ("sleep", "native spin"):
        with (folder_of_killed_run / kind).open("w", encoding="utf-8") as file:
            wait_until(lambda file=file: is_free(file))


def test_rows_survive_a_kill_and_the_next_run_computes_only_the_missing_ones(folder_of_killed_run):
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2, 3)]
    with Store(folder_of_killed_run / "cells.sqlite") as store:
        assert missing(cells, store) == (cells[2],)
        assert run_into(store, cells, supervised=in_process) == 1


def test_only_missing_cells_are_run_and_timed_out_ones_only_with_a_larger_limit(tmp_path):
    cells = [Cell(Disc(), Toy(), every) for every in (1, 2)]
    items = [cells[0], Motion(cells[0])]
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        assert run_into(store, items, limit=1e-9) == 2
        assert {row.outcome for row in (*store.get(cells).values(), *store.answers(items[1:]).values())} == {
            Outcome.TIMED_OUT
        }
        assert run_into(store, items, limit=5e-10) == 0
        assert missing(items, store, limit=2e-9) == tuple(items)
    with Store(path) as store:
        assert run_into(store, [*items, cells[1]], supervised=in_process) == 3
        assert {row.outcome for row in store.get(cells).values()} == {Outcome.FINISHED}
        assert run_into(store, [*items, cells[1]], limit=1e-9, supervised=in_process) == 0
        assert run_into(store, cells, fresh=True, supervised=in_process) == 2


def test_cells_of_a_scene_are_run_together_and_the_longest_first():
    cells = [Cell(Disc(rate=rate), Toy(), every) for every in (1, 30, 3) for rate in (2.0, 3.0)]
    ordered = longest_first([*cells, Cell(Disc(rate=3.0), Toy(), 300)])
    assert [(vars(cell.scene)["rate"], cell.every) for cell in ordered] == [
        *((3.0, 300), (3.0, 30), (3.0, 3), (3.0, 1), (2.0, 30), (2.0, 3), (2.0, 1)),
    ]


def test_a_cell_whose_worker_is_killed_twice_from_outside_is_reported_and_not_stored(tmp_path):
    cells = [Cell(Disc(), RoughToy("kill"), 1), Cell(Disc(), Toy(), 1)]
    with Store(tmp_path / "cells.sqlite") as store:
        with pytest.raises(WorkersLost, match=r"1 of 2 cells are lost, the others are stored.*SIGKILL"):
            run_into(store, cells)
        assert list(store.get(cells)) == [cells[1]]


def test_a_check_of_conform_that_never_ends_fails_with_the_name_of_its_mechanism(monkeypatch):
    def hanging(function, questions, limit, workers):
        for question in questions:
            Path(question.notes, question.check).write_text("0", encoding="utf-8")
            yield question, Loss(Outcome.TIMED_OUT, "did not end within 60 s of CPU time"), ""

    monkeypatch.setattr(conform_command, "supervise", hanging)
    ((_, results),) = asked(Named("pymunk", "leapfrog"))
    failed = [result for _, result in results if result.status == "fails"]
    assert failed
    assert all("did not end within 60 s of CPU time" in result.sentence for result in failed)
