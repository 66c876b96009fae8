"""`crosscheck conform` of an engine that ends its own process: the check is told by its name, and the others go on."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from engines.conformance import CHECKS, Case, Result, cases
from engines.pymunk import LEAPFROG
from reference.mechanism import Mechanism
from reports.__main__ import main
from reports.cli import supervised_checks
from reports.cli.conform import verdicts
from reports.cli.supervised_checks import Named, Question, ask, asked
from reports.model.outcomes import Loss, Outcome
from tests.wrong.adapters import Wrong


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
        main(["conform", "tests.reports.test_supervised_checks:ABORTING"])
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
        Path(question.notes, question.check).write_text(str(number))
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
