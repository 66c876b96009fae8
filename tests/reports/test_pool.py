"""The pool: every way to fail is a row, nothing is lost when workers are killed, and a run can be resumed."""

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

from reports.__main__ import main
from reports.cli import supervised_checks
from reports.cli.supervised_checks import Named, asked
from reports.model.cells import Cell
from reports.model.outcomes import Loss, Outcome, describe_exit, from_outside
from reports.model.tasks import Motion
from reports.run import supervisor, worker
from reports.run.running import longest_first, missing, run_cells, run_grid, run_into
from reports.run.store import Store
from reports.run.supervisor import WorkersLost, supervise
from tests import ROOT
from tests.reports.rough_toys import RoughToy, act, dies, helpers, is_free, spoiled, wait_until
from tests.toys import FAILURES, Disc, FailingToy, Toy, in_process
from tests.wrong.adapters import Wrong

pytest.importorskip("fcntl", reason="signals and locks of Unix are the subject here")

# The outcome of each action of a RoughToy, and a part of its sentence.
ENDS = {
    "segfault": ("aborted", "aborted with signal 11 (SIGSEGV)"),
    "abort": ("aborted", "aborted with signal 6 (SIGABRT)"),
    "exit 255": ("aborted", "exit status 255"),
    "closes files": ("aborted", "exit status 1"),
    "kill": ("lost", "killed from outside with signal 9 (SIGKILL), perhaps for want of memory; before that: killed"),
    "spin": ("timed out", "did not end within 0.5 s of CPU time"),
    "native spin": ("timed out", "did not end within 0.5 s of CPU time"),
    "sleep": ("timed out", "did not end within 1 s, and used less than 60 s of CPU time"),
    "native sleep": ("timed out", "did not end within 1 s, and used less than 60 s of CPU time"),
    "needs two": ("failed", "NeedsTwo: 1 and 2"),
    "unprintable": ("failed", "Unprintable: (it can't be printed)"),
    "system exit": ("failed", "SystemExit: 3"),
    "interrupt": ("failed", "KeyboardInterrupt: "),
    "long words": ("failed", "RuntimeError: xxx"),
    "endless recursion": ("failed", "RecursionError: "),
}
SLEEPERS = ("sleep", "native sleep")  # apart: a busy machine needs more wall time for all others
BUSY = [name for name in ENDS if name not in SLEEPERS]
LEAVES = {  # what ends well and leaves its process changed: what the probe then sees
    "blocks signals": ["blocked signals"],
    "changes environment": ["environment"],
    "changes folder": ["folder", "streams"],
    "closes streams": ["streams"],
    "installs handlers": ["handlers"],
    "leaves threads": ["threads"],
}


def test_each_way_to_fail_is_an_outcome_of_its_own_and_sound_cells_keep_their_numbers():
    toys = [FailingToy(name) for name in FAILURES if name != "hang"]
    cells = [Cell(Disc(), toy, 1) for toy in (*map(RoughToy, BUSY), *toys)]
    sound = {f"{place}": Cell(Disc(), Toy(factor=float(place)), 1) for place in range(1, 10)}
    rows = [*run_cells([*cells, *sound.values()], limit=0.5, workers=2)]
    rows += run_cells([Cell(Disc(), RoughToy(name), 1) for name in SLEEPERS], wall=1.0, workers=2)
    by_variant = {row.variant: row for row in rows if row.variant != "default"}
    for name, (outcome, sentence) in ENDS.items():
        assert by_variant[name].outcome == outcome, name
        assert sentence in by_variant[name].sentence
        assert len(by_variant[name].sentence) <= 500
    for toy in toys:
        assert by_variant[toy.variant].outcome == FAILURES[toy.variant]
        assert by_variant[toy.variant].sentence
    done = {row.settings: row for row in rows if row.variant == "default"}
    for place, cell in sound.items():
        assert done[repr(cell.engine)].angle == pytest.approx(float(place) * cell.step**2, rel=1e-9)


def test_nothing_that_a_job_leaves_behind_meets_the_next_one(capfd):
    items = ["probe"]
    for name in LEAVES:
        items += [name, "probe"]
    answers = list(supervise(act, items, limit=60.0, workers=1))
    assert [item for item, *_ in answers] == items
    assert [result for item, result, _ in answers if item == "probe"] == [[]] * (1 + len(LEAVES))
    assert capfd.readouterr() == ("", "")
    # The probe sees it, else this test could not fail.
    assert {name: left for name, left, _ in supervise(spoiled, [*LEAVES], limit=60.0, workers=2)} == LEAVES


def test_what_cannot_travel_is_a_failure_with_a_sentence():
    items = ["process", threading.Lock(), "unreadable", "huge", "process"]
    results = [result for _, result, _ in supervise(act, items, limit=60.0, workers=1)]
    assert isinstance(results[0], int)
    assert all(loss.outcome == Outcome.FAILED for loss in results[1:4])
    assert results[1].sentence.startswith("can't be sent to a worker: TypeError")
    assert results[2].sentence.startswith("its result can't be read: TypeError")
    assert results[3].sentence.startswith("OverflowError: a result of 2684")


def test_a_cell_whose_worker_was_killed_is_tried_once_more_in_a_new_worker(tmp_path):
    names = ("kill once", "segfault once")
    for name in names:
        (tmp_path / name).mkdir()
    rows = {
        row.variant: row
        for row in run_cells(Cell(Disc(), RoughToy(name, folder=str(tmp_path / name)), 1) for name in names)
    }
    assert {row.outcome for row in rows.values()} == {Outcome.FINISHED}
    # A crash that does not come back is a finding about the engine; that somebody kills processes is none.
    crash = "the first try aborted with signal 11 (SIGSEGV), the second went through"
    assert [rows[name].sentence for name in names] == ["", crash]
    # The damage that one item leaves in native memory is not the next one's crash.
    items = ["damage", "damage", "crash where damaged"]
    found = {item: result for item, result, _ in supervise(act, items, limit=60.0, workers=2)}
    assert found == {"damage": None, "crash where damaged": "sound"}


def test_time_in_which_the_parent_was_stopped_is_not_counted(monkeypatch):
    real, looks = time.monotonic, iter(range(10**9))
    monkeypatch.setattr(supervisor, "time", SimpleNamespace(monotonic=lambda: real() + 100.0 * next(looks)))
    (row,) = run_cells([Cell(Disc(), RoughToy("nap"), 1)], limit=5.0, wall=60.0, timed=False)
    assert row.outcome == Outcome.FINISHED


def test_workers_that_end_while_they_start_are_replaced_or_reported_in_one_line(monkeypatch, tmp_path, capsys):
    real, starts = worker.work, iter(range(100))
    start = supervisor.start_worker

    def mostly_dies(*arguments):
        monkeypatch.setattr(worker, "work", dies if next(starts) % 5 < 4 else real)
        return start(*arguments)

    monkeypatch.setattr(supervisor, "start_worker", mostly_dies)
    # Each exception makes another worker necessary: twelve die, never five in a row.
    results = [result.sentence for _, result, _ in supervise(act, ["needs two"] * 3, limit=60.0, workers=1)]
    assert results == ["NeedsTwo: 1 and 2"] * 3
    assert next(starts) == 15
    monkeypatch.setattr(supervisor, "start_worker", start)
    monkeypatch.setattr(worker, "work", dies)
    with pytest.raises(SystemExit) as end:
        main(["run", "free_four_bar", "--every", "1", "--engine", "lagrange", "--results", str(tmp_path)])
    assert end.value.code == 1
    line = capsys.readouterr().err.splitlines()[-1]
    assert line.startswith("crosscheck: 5 worker processes in a row ended while they started: ")


@pytest.mark.parametrize("seconds", [0.25, 1e6])
def test_a_system_without_room_for_processes_is_waited_for_and_reported(monkeypatch, seconds):
    start, again = supervisor.start_worker, time.monotonic() + seconds

    def full(*arguments):
        if time.monotonic() < again:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        return start(*arguments)

    monkeypatch.setattr(supervisor, "start_worker", full)
    lost = pytest.raises(WorkersLost, match="Resource temporarily unavailable")
    with lost if seconds > 1 else contextlib.nullcontext():
        assert [type(result) for _, result, _ in supervise(act, ["process"], limit=60.0, workers=1)] == [int]


@pytest.mark.parametrize(
    ("code", "outside", "words"),
    [
        (-signal.SIGKILL, True, "killed from outside with signal 9 (SIGKILL)"),
        (-signal.SIGFPE, False, "aborted with signal 8 (SIGFPE)"),
        (-200, False, "aborted with signal 200 (unknown)"),
        (3, False, "the process ended by itself with exit status 3"),
        (0xC0000005, False, "aborted with status 0xC0000005"),
        (None, True, "the process ended, nobody knows how"),
    ],
)
def test_exit_codes_are_distinguished(code, outside, words):
    assert from_outside(code) == outside
    assert describe_exit(code) == words


class Killer:
    """Kills workers, the fork server and the resource tracker, at moments and with signals that follow from a seed."""

    def __init__(self, seed: int, kills: int, monkeypatch: pytest.MonkeyPatch) -> None:
        self.kills = 0
        self._random, self._wanted, self._timers = random.Random(seed), kills, []
        self._pool: supervisor.Pool | None = None
        made = supervisor.Pool

        def remember(*arguments):
            self._pool = made(*arguments)
            return self._pool

        monkeypatch.setattr(supervisor, "Pool", remember)

    def arm(self) -> None:
        """One kill, after a tenth of a second at most."""
        if len(self._timers) < self._wanted:
            target = self._random.choice(["worker"] * 8 + ["fork server", "resource tracker"])
            how = self._random.choice([signal.SIGKILL, signal.SIGTERM, signal.SIGSEGV])
            timer = threading.Timer(self._random.uniform(0.0, 0.1), self._kill, (target, how, self._random.random()))
            timer.start()
            self._timers.append(timer)

    def _kill(self, target: str, how: int, which: float) -> None:
        with contextlib.suppress(ProcessLookupError, ValueError, IndexError):  # any of them may have ended by now
            workers = self._pool._workers if self._pool else []
            number = {"fork server": helpers()[0], "resource tracker": helpers()[1]}.get(target)
            if target == "worker":
                number = workers[int(which * len(workers))].process.pid
            if number is not None:
                os.kill(number, how if target == "worker" else signal.SIGKILL)
                self.kills += 1

    def wait(self) -> None:
        for timer in self._timers:
            timer.join()


@pytest.mark.parametrize(("seed", "kills"), [(1, 12), pytest.param(2, 200, marks=pytest.mark.slow)])
def test_among_kills_every_row_is_there_once_and_right(monkeypatch, seed, kills):
    killer = Killer(seed, kills, monkeypatch)
    cells = [Cell(Disc(), RoughToy("short sleep", factor=float(place)), 1) for place in range(2 * kills)]
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
    # Without an answer is only what was hit twice, and it says so.
    assert all(row.outcome in (Outcome.LOST, Outcome.ABORTED) for row in rows if row not in done)
    assert len(rows) - len(done) <= killer.kills // 2
    assert killer.kills > kills // 2


ORPHANS = """
import sys
import threading
from reports.model.cells import Cell
from reports.run.running import run_cells
from tests.reports.rough_toys import RoughToy
from tests.toys import Disc

def run(wall, kinds):
    list(run_cells([Cell(Disc(), RoughToy(kind, folder=sys.argv[1]), 1) for kind in kinds], limit=2.0, wall=wall))

if __name__ == "__main__":
    threading.Thread(target=run, args=(4.0, ["held native sleep"])).start()
    run(1000.0, ["held sleep", "held native spin"])
"""


def test_workers_end_when_their_parent_is_gone(tmp_path):
    """What sleeps ends at once; native code that holds the interpreter with the fork server, or by the timer."""
    (tmp_path / "script.py").write_text(ORPHANS, encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    process = subprocess.Popen([sys.executable, tmp_path / "script.py", tmp_path], env=environment)
    kinds = ("sleep", "native spin", "native sleep")
    try:
        wait_until(lambda: all((tmp_path / f"{kind} is there").exists() for kind in kinds))
    finally:
        process.kill()
        process.wait()
    for kind in kinds:
        with (tmp_path / kind).open("w", encoding="utf-8") as file:
            wait_until(lambda file=file: is_free(file))


def test_only_what_is_not_stored_is_run_and_a_timeout_again_with_more_time_alone(tmp_path):
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
    results = run_grid(path, [*items, cells[1]], supervised=in_process)
    assert {result.outcome for result in results.values()} == {Outcome.FINISHED}
    with Store(path) as store:
        assert run_into(store, [*items, cells[1]], limit=1e-9, supervised=in_process) == 0
        assert run_into(store, cells, fresh=True, supervised=in_process) == 2


def test_cells_of_a_scene_are_run_together_and_the_longest_first():
    cells = [Cell(Disc(rate=rate), Toy(), every) for every in (1, 30, 3) for rate in (2.0, 3.0)]
    ordered = longest_first([*cells, Cell(Disc(rate=3.0), Toy(), 300)])
    assert [(vars(cell.scene)["rate"], cell.every) for cell in ordered] == [
        *((3.0, 300), (3.0, 30), (3.0, 3), (3.0, 1), (2.0, 30), (2.0, 3), (2.0, 1)),
    ]


def test_what_is_killed_from_outside_twice_is_reported_and_not_stored(tmp_path):
    cells = [Cell(Disc(), RoughToy("kill"), 1), Cell(Disc(), Toy(), 1)]
    with Store(tmp_path / "cells.sqlite") as store:
        with pytest.raises(WorkersLost, match=r"2 of 3 cells are lost, the others are stored.*SIGKILL"):
            run_into(store, [*cells, Motion(cells[0])])
        assert list(store.get(cells)) == [cells[1]]


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
        run_into(store, cells, done=lambda row: print(row.every, flush=True), workers=2)
"""


@pytest.mark.parametrize("how", [signal.SIGKILL, signal.SIGINT])
def test_after_a_kill_the_next_run_continues_where_it_stopped(tmp_path, how):
    (tmp_path / "script.py").write_text(SCRIPT, encoding="utf-8")
    path = tmp_path / "cells.sqlite"
    process = subprocess.Popen(
        [sys.executable, tmp_path / "script.py", path],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    assert process.stdout is not None
    with process.stdout:
        for _ in range(4):
            assert process.stdout.readline().strip()
    process.send_signal(how)
    # A hang in a worker must not hold up the end: its wall limit alone would take eleven minutes.
    assert process.wait(timeout=60) != 0
    with Store(path) as store:
        assert missing([Cell(Disc(), Toy(), every) for every in (1, 2, 3, 4)], store) == ()


class Aborting(Wrong):
    """As native code does for a step that it can't divide by."""

    def build(self, mechanism, dt):
        if dt == 0:
            os.write(2, b"Aborting due to Wrong error: dt is zero\n")
            os.abort()
        return self.engine.build(mechanism, dt)


ABORTING = Aborting("aborts where a step is zero")


def test_an_abort_ends_one_check_of_conform_and_not_the_program(capfd):
    with pytest.raises(SystemExit) as ended:
        main(["conform", "tests.reports.test_pool:ABORTING"])
    captured = capfd.readouterr()
    assert ended.value.code == 1
    (failed,) = [line for line in captured.out.splitlines() if line.startswith("  fails")]
    assert "signal 6 (SIGABRT): Aborting due to Wrong error: dt is zero" in failed


def test_a_check_of_conform_that_never_ends_fails_in_the_mechanism_in_which_it_was(monkeypatch):
    def hanging(function, questions, limit, workers):
        for question in questions:
            Path(question.notes, question.check).write_text("0", encoding="utf-8")
            yield question, Loss(Outcome.TIMED_OUT, "did not end within 60 s of CPU time"), ""

    monkeypatch.setattr(supervised_checks, "supervise", hanging)
    ((_, results),) = asked(Named.here("pymunk", "leapfrog"))
    found = [result for _, result in results if result.status == "fails"]
    assert found
    assert all("did not end within 60 s of CPU time" in result.sentence for result in found)
