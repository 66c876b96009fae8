"""The checks of `engines.conformance` in supervised processes: one that native code ends, or that hangs, is told too.

An engine travels as the words that name it on a command line, since not every object that is checked can be pickled:
whether it can is one of the questions.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from itertools import groupby
from pathlib import Path

from engines import Engine
from engines.conformance import Case, Result, cases
from engines.loading import is_reference
from engines.registry import ENGINES, INSTALLED, load
from reports.cli.selection import choose_engines
from reports.model.ending import BadInput
from reports.model.outcomes import Loss, Outcome
from reports.run.files import temporary_folder
from reports.run.running import TIME_LIMIT
from reports.run.supervisor import supervise

MODELS = 20  # that a check may build, where each takes seconds: every mechanism of the checks once


@dataclass(frozen=True)
class Named:
    """What `crosscheck conform` is given: an engine's name or a reference, counted from `folder`; and a variant."""

    word: str
    variant: str | None
    folder: str

    @staticmethod
    def here(word: str, variant: str | None) -> Named:
        return Named(word, variant, os.getcwd())

    def engines(self) -> tuple[Engine, ...]:
        """Raises BadInput where nothing has this name."""
        if not is_reference(self.word):
            return choose_engines(self.word, self.variant, (*ENGINES, *INSTALLED))
        try:
            return choose_engines(None, self.variant, load(self.word, Path(self.folder)))
        except ValueError as error:
            raise BadInput(str(error)) from None


@dataclass(frozen=True)
class Question:
    """A check, by its name, of the engine at this place among those that are named.

    `notes`: a folder for a file of the check's name, in which stands the number of the mechanism that it is asked in.
    """

    named: Named
    place: int
    check: str
    notes: str


@cache
def _cases(named: Named, place: int) -> tuple[Case, ...]:
    """Once in a process: what an engine has run for one check is there for the next."""
    return tuple(cases(named.engines()[place]))


def ask(question: Question) -> tuple[Result, ...]:
    """In a worker: what comes of the check, in each of its mechanisms."""
    results = []
    for number, case in enumerate(_of_check(_cases(question.named, question.place), question.check)):
        Path(question.notes, question.check).write_text(str(number), encoding="utf-8")
        results.append(case.result())
    return tuple(results)


def asked(named: Named, limit: float = TIME_LIMIT) -> Iterator[tuple[Engine, Iterator[tuple[Case, Result]]]]:
    """Every engine that is named, and what comes of its checks, in their order. `limit`: CPU seconds of a check, and
    more where an engine says that its models take long to build.

    One worker at a time, so that what an engine has run is kept. Raises BadInput, and WorkersLost (`supervise`).
    """
    for place, engine in enumerate(named.engines()):
        building = MODELS * engine.building
        yield engine, _answers(named, place, engine, limit + building)


def _answers(named: Named, place: int, engine: Engine, limit: float) -> Iterator[tuple[Case, Result]]:
    every = tuple(cases(engine))
    names = [name for name, _ in groupby(case.check.name for case in every)]
    with temporary_folder() as notes:
        questions = [Question(named, place, name, str(notes)) for name in names]
        found: dict[str, list[tuple[Case, Result]]] = {}
        for question, results, earlier in supervise(ask, questions, limit, workers=1):
            own = _of_check(every, question.check)
            if isinstance(results, Loss):
                found[question.check] = [_lost(own, results, Path(notes, question.check))]
            elif earlier:
                words = f"It ended its process at the first try: {earlier}; the second went through"
                found[question.check] = [(own[0], _failed(own[0], words))]
            else:
                found[question.check] = list(zip(own, results, strict=True))
            while names and names[0] in found:  # a check that is tried again is answered late
                yield from found[names.pop(0)]


def _lost(own: list[Case], loss: Loss, note: Path) -> tuple[Case, Result]:
    """A failure of the case that was asked last."""
    case = own[int(note.read_text(encoding="utf-8"))] if note.is_file() else own[0]
    told = "It" if loss.outcome == Outcome.TIMED_OUT else "Its process was lost:"
    return case, _failed(case, f"{told} {loss.sentence}")


def _failed(case: Case, words: str) -> Result:
    return Result("fails", f"{case.check.name}: {case.check.asks} {words}")


def _of_check(every: tuple[Case, ...], name: str) -> list[Case]:
    return [case for case in every if case.check.name == name]
