"""Supervised workers: whatever a job, a check of an engine or somebody else does to a process is told as what it is."""

from __future__ import annotations

import os
import signal
import threading
import time
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from engines.conformance import CHECKS, Case, Result, cases
from engines.pymunk import LEAPFROG
from reference.mechanism import Mechanism
from reports.__main__ import main
from reports.cli import supervised_checks
from reports.cli.conform import verdicts
from reports.cli.supervised_checks import Named, Question, ask, asked
from reports.model.cells import Cell
from reports.model.outcomes import Loss, Outcome, describe_exit, from_outside
from reports.run import supervisor, worker
from reports.run.running import run_cells
from reports.run.supervisor import WorkersLost, supervise
from tests.reports.rough_toys import RoughToy, act, dies, helpers, spoiled
from tests.toys import Disc, Toy
from tests.wrong.adapters import Wrong

pytest.importorskip("fcntl", reason="signals and locks of Unix are the subject here")

# What becomes of each, and a part of its sentence.
ENDS = {
    "segfault": ("aborted", "aborted with signal 11 (SIGSEGV)"),
    "abort": ("aborted", "aborted with signal 6 (SIGABRT)"),
    "exit 255": ("aborted", "exit status 255"),
    "closes files": ("aborted", "exit status 1"),
    "kill": ("lost", "killed from outside with signal 9 (SIGKILL), perhaps for want of memory; before that: killed"),
    "terminate": ("lost", "killed from outside with signal 15 (SIGTERM)"),
    "spin": ("timed out", "did not end within 0.5 s of CPU time"),
    "native spin": ("timed out", "did not end within 0.5 s of CPU time"),
    "sleep": ("timed out", "did not end within 1 s, and used less than 60 s of CPU time"),
    "native sleep": ("timed out", "did not end within 1 s, and used less than 60 s of CPU time"),
    "needs two": ("failed", "NeedsTwo: 1 and 2"),
    "holds a lock": ("failed", "HoldsALock: it holds a lock"),
    "unprintable": ("failed", "Unprintable: (it can't be printed)"),
    "system exit": ("failed", "SystemExit: 3"),
    "interrupt": ("failed", "KeyboardInterrupt: "),
    "long words": ("failed", "RuntimeError: xxx"),
    "endless recursion": ("failed", "RecursionError: "),
}
SLEEPERS = ("sleep", "native sleep")  # apart: a busy machine needs more wall time for all others
BUSY = [name for name in ENDS if name not in SLEEPERS]
# What ends well and leaves its process changed.
LEAVES = {
    "prints",
    "closes streams",
    "changes folder",
    "changes environment",
    "leaves threads",
    "installs handlers",
    "blocks signals",
}


@pytest.fixture(scope="module")
def ends():
    """Each bad end, then a sound cell with a number of its own, two at a time."""
    cells = []
    for place, name in enumerate(BUSY, start=1):
        cells += [Cell(Disc(), RoughToy(name), 1), Cell(Disc(), Toy(factor=float(place)), 1)]
    asleep = [Cell(Disc(), RoughToy(name), 1) for name in SLEEPERS]
    rows = [*run_cells(cells, limit=0.5, workers=2), *run_cells(asleep, wall=1.0, workers=2)]
    assert len(rows) == len(cells) + len(asleep)
    return {row.variant if row.variant in ENDS else row.settings: row for row in rows}


@pytest.mark.parametrize("name", ENDS)
def test_a_bad_end_is_told_as_what_it_is(ends, name):
    outcome, sentence = ENDS[name]
    assert ends[name].outcome == outcome
    assert sentence in ends[name].sentence
    assert len(ends[name].sentence) <= 500


def test_sound_cells_among_bad_ends_keep_their_numbers(ends):
    for place in range(1, len(BUSY) + 1):
        row = ends[repr(Toy(factor=float(place)))]
        assert row.outcome == Outcome.FINISHED
        assert row.angle == pytest.approx(place * row.step**2, rel=1e-9)
        assert row.sentence == ""


def test_nothing_that_a_job_leaves_behind_meets_the_next_one(capfd):
    items = ["probe"]
    for name in sorted(LEAVES):
        items += [name, "probe"]
    answers = list(supervise(act, items, limit=60.0, workers=1))
    assert [item for item, *_ in answers] == items
    assert {(item, str(result)) for item, result, _ in answers if isinstance(result, Loss)} == set()
    assert [result for item, result, _ in answers if item == "probe"] == [[]] * (1 + len(LEAVES))
    assert capfd.readouterr() == ("", "")


def test_the_probe_sees_what_is_left_behind():
    """Else the test above could not fail."""
    told = {name: result for name, result, _ in supervise(spoiled, sorted(LEAVES - {"prints"}), limit=60.0, workers=2)}
    assert told == {
        "blocks signals": ["blocked signals"],
        "changes environment": ["environment"],
        "changes folder": ["folder", "streams"],
        "closes streams": ["streams"],
        "installs handlers": ["handlers"],
        "leaves threads": ["threads"],
    }


def test_what_cannot_travel_is_a_failure_with_a_sentence_and_its_worker_goes_on_after_what_leaves_nothing():
    items = [*["process"] * 3, threading.Lock(), "unreadable", "unsendable", "huge", "large"]
    told = [result for _, result, _ in supervise(act, items, limit=60.0, workers=1)]
    assert len({*told[:3]}) == 1
    assert told.pop() == bytes(10**7)
    assert all(loss.outcome == Outcome.FAILED for loss in told[3:])
    assert told[3].sentence.startswith("can't be sent to a worker: TypeError")
    assert told[4].sentence.startswith("its result can't be read: TypeError")
    assert told[5].sentence == "TypeError: it stays here"
    assert told[6].sentence.startswith("OverflowError: a result of 2684")


def test_a_cell_whose_worker_was_killed_is_tried_once_more(tmp_path):
    for name in ("kill once", "segfault once"):
        (tmp_path / name).mkdir()
    cells = [Cell(Disc(), RoughToy(name, folder=str(tmp_path / name)), 1) for name in ("kill once", "segfault once")]
    rows = {row.variant: row for row in run_cells(cells)}
    assert {row.outcome for row in rows.values()} == {Outcome.FINISHED}
    assert all(row.angle == pytest.approx(row.step**2, rel=1e-9) for row in rows.values())
    # A crash that does not come back is a finding about the engine; that somebody kills processes is none.
    crash = "the first try aborted with signal 11 (SIGSEGV), the second went through"
    assert [rows[cell.engine.variant].sentence for cell in cells] == ["", crash]


def test_waiting_for_a_busy_machine_is_no_time_of_the_cell():
    (row,) = run_cells([Cell(Disc(), RoughToy("nap"), 1)], limit=0.5, wall=30.0, timed=False)
    assert row.outcome == Outcome.FINISHED


def test_time_in_which_the_parent_was_stopped_is_not_counted(monkeypatch):
    real, looks = time.monotonic, iter(range(10**9))
    monkeypatch.setattr(supervisor, "time", SimpleNamespace(monotonic=lambda: real() + 100.0 * next(looks)))
    (row,) = run_cells([Cell(Disc(), RoughToy("nap"), 1)], limit=5.0, wall=60.0, timed=False)
    assert row.outcome == Outcome.FINISHED


def test_workers_that_end_while_they_start_are_replaced(monkeypatch):
    real, starts = worker.work, iter(range(100))
    start = supervisor.start_worker

    def mostly_dies(*arguments):
        monkeypatch.setattr(worker, "work", dies if next(starts) % 5 < 4 else real)
        return start(*arguments)

    monkeypatch.setattr(supervisor, "start_worker", mostly_dies)
    # Each exception makes another worker necessary: twelve die, never five in a row.
    told = [result.sentence for _, result, _ in supervise(act, ["needs two"] * 3, limit=60.0, workers=1)]
    assert told == ["NeedsTwo: 1 and 2"] * 3
    assert next(starts) == 15


def test_without_fork_server_and_resource_tracker_others_are_started_and_nothing_is_printed(monkeypatch, capfd):
    start, starts = supervisor.start_worker, iter(range(100))

    def after_a_kill(*arguments):
        if next(starts) < 2:
            for number in helpers():
                if number is not None:
                    os.kill(number, signal.SIGKILL)
        return start(*arguments)

    list(supervise(act, ["process"], limit=60.0, workers=1))
    monkeypatch.setattr(supervisor, "start_worker", after_a_kill)
    told = [result for _, result, _ in supervise(act, ["process", "nap"], limit=60.0, workers=2)]
    assert not any(isinstance(result, Loss) for result in told)
    assert capfd.readouterr() == ("", "")


def test_a_second_try_is_in_a_worker_that_has_run_nothing_else():
    """Else the damage that one item leaves in native memory would be told as the next one's crash."""
    items = ["damage", "damage", "crash where damaged"]
    told = {item: result for item, result, _ in supervise(act, items, limit=60.0, workers=2)}
    assert told == {"damage": None, "crash where damaged": "sound"}


def test_a_pool_whose_workers_never_start_is_told_in_one_line(monkeypatch):
    monkeypatch.setattr(worker, "work", dies)
    with pytest.raises(WorkersLost, match=r"^5 worker processes in a row ended while they started: .*SIGKILL.$"):
        list(run_cells([Cell(Disc(), Toy(), 1)]))


@pytest.mark.parametrize("seconds", [0.25, 1e6])
def test_a_system_without_room_for_processes_is_waited_for_and_told_in_one_line(monkeypatch, seconds):
    start, again = supervisor.start_worker, time.monotonic() + seconds

    def full(*arguments):
        if time.monotonic() < again:
            raise BlockingIOError(11, "Resource temporarily unavailable")
        return start(*arguments)

    monkeypatch.setattr(supervisor, "start_worker", full)
    lost = pytest.raises(WorkersLost, match="Resource temporarily unavailable")
    with lost if seconds > 1 else nullcontext():
        assert [type(result) for _, result, _ in supervise(act, ["process"], limit=60.0, workers=1)] == [int]


@pytest.mark.parametrize(
    ("code", "outside", "words"),
    [
        (-signal.SIGKILL, True, f"killed from outside with signal {signal.SIGKILL:d} (SIGKILL)"),
        (-signal.SIGHUP, True, f"killed from outside with signal {signal.SIGHUP:d} (SIGHUP)"),
        (-signal.SIGINT, True, f"killed from outside with signal {signal.SIGINT:d} (SIGINT)"),
        (-signal.SIGFPE, False, f"aborted with signal {signal.SIGFPE:d} (SIGFPE)"),
        (-200, False, "aborted with signal 200 (unknown)"),
        (3, False, "the process ended by itself with exit status 3"),
        (0xC0000005, False, "aborted with status 0xC0000005"),
        (None, True, "the process ended, nobody knows how"),
    ],
)
def test_exit_codes_are_told_from_each_other(code, outside, words):
    assert from_outside(code) == outside
    assert describe_exit(code) == words


def finest_tick(_):
    """The smallest step of the process's CPU clock that is seen within a few milliseconds of work [s]."""
    seen = set()
    before = start = time.process_time()
    while time.process_time() - start < 0.02 and len(seen) < 100:
        now = time.process_time()
        if now != before:
            seen.add(now - before)
        before = now
    return min(seen)


def test_a_limit_does_not_make_the_clock_coarse_by_which_stepping_is_timed():
    # A timer for the CPU time makes Linux count it in ticks of 4 ms; without one it is well below a microsecond's tenth
    # of a thousand. Ten microseconds lie between.
    if finest_tick(0) >= 1e-5:
        pytest.skip("this system's clock of CPU time is coarse without a limit too")
    [(_, tick, _)] = supervise(finest_tick, [0], limit=60.0, workers=1)
    assert tick < 1e-5


@dataclass(frozen=True)
class Aborting(Wrong):
    """As native code does for a step that it can't divide by."""

    def build(self, mechanism: Mechanism, dt: Any) -> Any:
        if dt == 0:
            os.write(2, b"Aborting due to Wrong error: dt is zero\n")
            os.abort()
        return self.engine.build(mechanism, dt)


ABORTING = Aborting("aborts where a step is zero")


def test_an_abort_ends_one_check_and_not_the_program(capfd):
    with pytest.raises(SystemExit) as ended:
        main(["conform", "tests.reports.test_supervisor:ABORTING"])
    captured = capfd.readouterr()
    assert ended.value.code == 1
    assert captured.err == "crosscheck: wrong aborts where a step is zero: not as the contract of an engine says\n"
    lines = captured.out.splitlines()
    (failed,) = [line for line in lines if line.startswith("  fails")]
    assert "refuses_bad_steps: " in failed
    assert "signal 6 (SIGABRT): Aborting due to Wrong error: dt is zero" in failed
    told = [line.split()[1].rstrip(":") for line in lines if line.startswith(("  holds", "  fails"))]
    assert told == [check.name for check in CHECKS]  # in their order, though this one was tried twice
    assert lines[-1] == "  1 checks fail"


def answered(monkeypatch, change) -> list[tuple[Case, Result]]:
    """What is told of LEAPFROG's checks when every answer of a worker is what `change` makes of the question."""

    def supervised(function, questions, limit, workers):
        assert function is ask
        yield from reversed([(question, *change(question)) for question in questions])

    monkeypatch.setattr(supervised_checks, "supervise", supervised)
    ((engine, results),) = asked(Named.here("pymunk", "leapfrog"))
    assert engine == LEAPFROG
    return list(results)


def test_answers_are_told_in_the_order_of_the_checks_whenever_they_come(monkeypatch):
    def right(question: Question):
        return tuple(Result("holds") for case in cases(LEAPFROG) if case.check.name == question.check), ""

    found = answered(monkeypatch, right)
    every = list(cases(LEAPFROG))
    assert [(case.check, case.world) for case, _ in found] == [(case.check, case.world) for case in every]


def test_a_check_that_never_ends_fails_in_the_mechanism_in_which_it_was(monkeypatch):
    def hanging(question: Question):
        if question.check == "does_not_wrap_angles":
            return Loss(Outcome.LOST, "killed from outside with signal 9 (SIGKILL)"), ""
        number = min(1, sum(case.check.name == question.check for case in cases(LEAPFROG)) - 1)
        Path(question.notes, question.check).write_text(str(number), encoding="utf-8")
        return Loss(Outcome.TIMED_OUT, "did not end within 60 s of CPU time"), ""

    found = answered(monkeypatch, hanging)
    assert [case.check for case, _ in found] == list(CHECKS)
    assert {case.world for case, _ in found} >= {check.worlds[1] for check in CHECKS if len(check.worlds) > 1}
    lines = dict.fromkeys(line for status, line in verdicts(iter(found)) if status == "fails")
    ends = [line.rpartition(" It")[2] for line in lines]
    assert ends.count(" did not end within 60 s of CPU time") == len(CHECKS) - 1
    assert ends.count("s process was lost: killed from outside with signal 9 (SIGKILL)") == 1


def test_an_abort_that_does_not_come_again_is_told_too(monkeypatch):
    found = answered(monkeypatch, lambda question: ((), "aborted with signal 11 (SIGSEGV)"))
    assert {result.status for _, result in found} == {"fails"}
    assert "at the first try: aborted with signal 11 (SIGSEGV)" in found[0][1].sentence


def test_a_worker_tells_in_which_mechanism_it_is(tmp_path):
    question = Question(Named.here("pymunk", "leapfrog"), 0, "first_pose_is_the_start", str(tmp_path))
    results = ask(question)
    assert {result.status for result in results} == {"holds"}
    assert (tmp_path / "first_pose_is_the_start").read_text() == str(len(results) - 1)
