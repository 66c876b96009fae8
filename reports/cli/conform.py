"""`crosscheck conform` checks whether an engine keeps the contract of `engines`, and prints a line for each check.

Checks run in supervised processes, so a check that crashes or hangs is reported too. A worker loads the engine by its
name, since the engine may not be picklable.
"""

from __future__ import annotations

import os
from collections import defaultdict
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import Annotated

import typer

from engines import Engine
from engines.conformance import ConformanceCase, ConformanceResult, Status, cases
from engines.registry import ENGINES, INSTALLED, method_name, mislabelled
from reports.cli.known import engines_named
from reports.cli.options import REFERENCES, AsJson, AsMarkdown
from reports.cli.terminal import print_table, telling
from reports.model.ending import BadInput, Broken
from reports.model.outcomes import Loss, Outcome
from reports.run.files import temporary_folder
from reports.run.running import TIME_LIMIT
from reports.run.supervisor import supervise

MODELS = 20  # Largest number of models that a check may build, about one for each mechanism.
Answers = Sequence[tuple[ConformanceCase, ConformanceResult]]


def conform(
    engine: Annotated[str, typer.Argument(help=f"An engine's name, or {REFERENCES}.")],
    variant: Annotated[str | None, typer.Option("--variant", help="Only this variant.")] = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
) -> None:
    """Check that an engine keeps the contract: signs, instants, orders, refusals, and equivalent descriptions."""
    if sentence := mislabelled():
        raise BadInput(sentence)
    with telling(150, as_json, as_markdown) as screen:
        broken = []
        for method, results in asked(Named(engine, variant)):
            name = method_name(method)
            screen.say(name)
            lines = []
            for status, line in verdicts(results):
                screen.say(f"  {status:<14} {line}")  # The line is printed immediately, since some checks take seconds.
                lines.append((status, line))
            count = sum(status == "fails" for status, _ in lines)
            summary = "every check holds" if not count else f"{count} checks fail"
            if screen.form == "text":
                screen.say(f"  {summary}")
            else:
                print_table(screen, f"{name}: {summary}", ("answer", "check"), lines, 2)
            broken += [name] if count else []
        if broken:
            raise Broken(f"{', '.join(broken)}: not as the contract of an engine says")


def verdicts(results: Iterator[tuple[ConformanceCase, ConformanceResult]]) -> Iterator[tuple[Status, str]]:
    """Yield (status, line) for each check, and for each distinct reason why a check did not apply."""
    printed: set[str] = set()
    for check, group in groupby(results, key=lambda pair: pair[0].check):
        by_status: dict[Status, list[tuple[ConformanceCase, ConformanceResult]]] = defaultdict(list)
        for pair in group:
            by_status[pair[1].status].append(pair)
        failed, holding, count = by_status["fails"], by_status["holds"], sum(map(len, by_status.values()))
        if failed:
            yield "fails", f"{_places(failed)}{failed[0][1].sentence}"
        elif holding:
            yield "holds", check.name + (f" ({len(holding)} of {count} mechanisms)" if check.worlds else "")
        for status in ("not supported", "not asked"):
            for case, result in by_status[status]:
                line = f"{_places([(case, result)])}{result.sentence}"
                if line not in printed:
                    yield status, line if holding or failed or case.world is None else f"{check.name}: {line}"
                printed.add(line)


def _places(answers: Answers) -> str:
    names = [f"{case.world.name} ({', '.join(case.world.kinds)})" for case, _ in answers if case.world is not None]
    return f"in {'; '.join(names)}: " if names else ""


@dataclass(frozen=True)
class Named:
    """An engine's name or a reference, and a variant. The path of a reference is relative to `folder`."""

    engine: str
    variant: str | None
    folder: str = field(default_factory=os.getcwd)

    def engines(self) -> tuple[Engine, ...]:
        """The engines with this name. Raises BadInput if there are none."""
        return engines_named(self.engine, self.variant, (*ENGINES, *INSTALLED), Path(self.folder))


@dataclass(frozen=True)
class Question:
    named: Named
    index: int  # Index of the engine in `named.engines()`.
    check: str  # Name of the check.
    notes: str  # A folder. The file with the name of the check contains the number of the current mechanism.


@cache
def _cases(named: Named, index: int) -> tuple[ConformanceCase, ...]:
    return tuple(cases(named.engines()[index]))


def ask(question: Question) -> tuple[ConformanceResult, ...]:
    """The results of a check in each mechanism. A worker calls this function."""
    results = []
    members = (case for case in _cases(question.named, question.index) if case.check.name == question.check)
    for number, case in enumerate(members):
        Path(question.notes, question.check).write_text(str(number), encoding="utf-8")
        results.append(case.result())
    return tuple(results)


def asked(
    named: Named, limit: float = TIME_LIMIT
) -> Iterator[tuple[Engine, Iterator[tuple[ConformanceCase, ConformanceResult]]]]:
    """Yield each named engine with the results of its checks in order. Raises BadInput and WorkersLost. limit: CPU
    seconds of a check without the time to build models. One worker runs all checks, which share their runs."""
    for index, engine in enumerate(named.engines()):
        yield engine, _answers(named, index, tuple(cases(engine)), limit + MODELS * engine.build_time)


def _answers(
    named: Named, index: int, every: Sequence[ConformanceCase], limit: float
) -> Iterator[tuple[ConformanceCase, ConformanceResult]]:
    by_check = {name: tuple(members) for name, members in groupby(every, key=lambda case: case.check.name)}
    waiting, answers = list(by_check), dict[str, Answers]()
    with temporary_folder() as notes:
        questions = [Question(named, index, name, str(notes)) for name in by_check]
        for question, results, earlier in supervise(ask, questions, limit, workers=1):
            members = by_check[question.check]
            if isinstance(results, Loss):
                note = Path(notes, question.check)  # The case that ran when the worker ended.
                case = members[int(note.read_text(encoding="utf-8"))] if note.is_file() else members[0]
                start = "It" if results.outcome == Outcome.TIMED_OUT else "Its process was lost:"
                answers[question.check] = [_failed(case, f"{start} {results.sentence}")]
            elif earlier:
                sentence = f"It ended its process at the first try: {earlier}; the second went through"
                answers[question.check] = [_failed(members[0], sentence)]
            else:
                answers[question.check] = list(zip(members, results, strict=True))
            while waiting and waiting[0] in answers:  # A repeated check answers later than the checks after it.
                yield from answers[waiting.pop(0)]


def _failed(case: ConformanceCase, words: str) -> tuple[ConformanceCase, ConformanceResult]:
    return case, ConformanceResult("fails", f"{case.check.name}: {case.check.requirement} {words}")
