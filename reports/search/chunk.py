"""A search in pieces: some cases of one subject each, run in a supervised process and kept like any other answer.

A piece whose process ends, or whose time is used up, is asked again case by case, so that the case which does it is
known and the others are not lost.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from engines import Engine
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Task, Values
from reports.run.store import Store
from reports.search.motions import NEEDLESS_REPORT
from reports.search.parts import SINGULAR_KINDS
from reports.search.subjects import Adapted, OracleResult, Subject, is_shaped

CHUNK_SIZE = 10  # cases in a piece: a second or some


@dataclass(frozen=True)
class Chunk(Task):
    """Cases `first` to `first + count - 1` of a seed."""

    subject: Subject
    seed: int
    first: int
    count: int
    kinds: tuple[str, ...]
    decades: int = 0
    oracles: tuple[str, ...] = ("instant",)

    @property
    def cost(self) -> float:
        return (3.0 if is_shaped(self.subject) else 0.1) * self.count

    @property
    def label(self) -> str:
        return f"{self.subject.name}, case {self.first}"

    @property
    def engine(self) -> Engine | None:
        return self.subject.engine if isinstance(self.subject, Adapted) else None

    def draw(self, number: int) -> Any:
        """The case of this number."""
        return self.subject.draw(self.seed, number, self.kinds, self.decades)

    def run(self) -> Values:
        """The results as JSON, one a case."""
        results = []
        for number in range(self.first, self.first + self.count):
            case = self.draw(number)
            result = self.subject.ask(case, number, self.oracles)
            errors = {check: [float(value) for value in pair] for check, pair in result.errors.items()}
            results.append([case.kinds, errors, result.skipped, result.words])
        return {"results": json.dumps(results)}


@dataclass(frozen=True)
class CaseResult:
    """A case of a piece, and its result."""

    chunk: Chunk
    number: int
    kinds: tuple[str, ...]
    result: OracleResult


def iter_case_results(answers: Mapping[Chunk, Answer]) -> Iterator[CaseResult]:
    """The cases of these pieces. One whose process ended is a fault without a number; a piece of several cases that
    did not finish has none, since it is asked again case by case."""
    for chunk, answer in answers.items():
        if answer.finished:
            rows = json.loads(str(answer.values["results"]))
            for number, (kinds, pairs, skipped, words) in enumerate(rows, chunk.first):
                errors = {check: (error, bound) for check, (error, bound) in pairs.items()}
                yield CaseResult(chunk, number, tuple(kinds), OracleResult(errors, tuple(skipped), words))
        elif chunk.count == 1:
            fault = answer.outcome in (Outcome.ABORTED, Outcome.TIMED_OUT, Outcome.FAILED)
            errors = {str(answer.outcome): (np.inf, 0.0)} if fault else {}
            yield CaseResult(chunk, chunk.first, chunk.kinds, OracleResult(errors, words=answer.sentence))


def make_chunks(
    subjects: Sequence[Subject], seed: int, cases: int, kinds: Sequence[str], decades: int, oracles: tuple[str, ...]
) -> list[Chunk]:
    """The pieces of the first cases of a seed, those of all subjects in turn; all kinds of a subject if none."""
    out = []
    for first in range(0, cases, CHUNK_SIZE):
        count = min(CHUNK_SIZE, cases - first)
        for subject in subjects:
            taken = tuple(kind for kind in (*subject.kinds, *SINGULAR_KINDS) if kind in kinds) or subject.kinds
            out.append(Chunk(subject, seed, first, count, taken, decades, oracles))
    return out


def unfinished_cases(answers: Mapping[Chunk, Answer]) -> list[Chunk]:
    """The cases, one by one, of pieces whose process ended or whose time was used up."""
    ended = [chunk for chunk, answer in answers.items() if not answer.finished and chunk.count > 1]
    return [replace(chunk, first=chunk.first + n, count=1) for chunk in ended for n in range(chunk.count)]


def stored_answers(store: Store, pieces: Sequence[Chunk]) -> dict[Chunk, Answer]:
    """The answers to these pieces, and to those of their cases that had to be asked one by one."""
    whole = store.answers(pieces)
    answers = {piece: whole[piece] for piece in pieces if piece in whole}
    singles = unfinished_cases(answers)
    single = store.answers(singles)
    return answers | {piece: single[piece] for piece in singles if piece in single}


def chunk_to_json(chunk: Chunk) -> str:
    """What finds a piece again: its numbers, and the subject's name."""
    numbers = [chunk.seed, chunk.first, chunk.count, list(chunk.kinds), chunk.decades, list(chunk.oracles)]
    return json.dumps([chunk.subject.name, *numbers])


def chunk_from_json(text: str, subjects: Sequence[Subject]) -> Chunk | None:
    """The piece that `chunk_to_json` wrote; None where its subject is not among these."""
    name, seed, first, count, kinds, decades, oracles = json.loads(text)
    subject = next((one for one in subjects if one.name == name), None)
    return Chunk(subject, seed, first, count, tuple(kinds), decades, tuple(oracles)) if subject else None


def case_label(case: CaseResult) -> str:
    """The subject, and the kinds that were asked for where they are not all of its own."""
    chunk = case.chunk
    kinds = "" if chunk.kinds == chunk.subject.kinds else f" ({', '.join(chunk.kinds)})"
    return f"{chunk.subject.name}{kinds}"


SUMMARY_HEADER = ("subject", "check", "judged", "median", "99 %", "worst", "faults")


def summary_rows(cases: Sequence[CaseResult]) -> list[list[str]]:
    """Rows of a table under SUMMARY_HEADER; a last line a subject says how many cases it refused."""
    checks: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for case in cases:
        for check, pair in case.result.errors.items():
            checks.setdefault((case_label(case), check), []).append(pair)
    out, reported = [], []
    for (subject, check), pairs in checks.items():
        errors = np.sort([error for error, _ in pairs])
        if check == NEEDLESS_REPORT:
            if errors.any():
                words = f"{errors.sum():.0f} reported, though right"
                reported.append([subject, words, str(len(pairs)), "", "", "", ""])
            continue
        quantiles = [_short(errors[math.ceil(share * (len(errors) - 1))]) for share in (0.5, 0.99, 1.0)]
        out.append([subject, check, str(len(pairs)), *quantiles, str(sum(not error <= most for error, most in pairs))])
    refusals = [[subject, "refused", str(count), "", "", "", ""] for subject, count in count_refusals(cases).items()]
    return [*out, *reported, *refusals]


def count_refusals(cases: Iterable[CaseResult]) -> Mapping[str, int]:
    """How many cases a subject can't build, by its own word."""
    return Counter(
        case_label(case) for case in cases if any(why.startswith("unsupported") for why in case.result.skipped)
    )


def _short(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "lost"


FINDINGS_HEADER = ("subject", "check", "error", "may be", "seed", "decades", "case", "kinds")


def finding_rows(cases: Iterable[CaseResult]) -> list[list[str]]:
    """Rows of a table under FINDINGS_HEADER, one for each check that fails in a case."""
    out = []
    for case in cases:
        drawn = [str(case.chunk.seed), str(case.chunk.decades), str(case.number), ",".join(case.kinds)]
        for check in case.result.faults:
            out.append([case.chunk.subject.name, check, *map(_short, case.result.errors[check]), *drawn])
    return out


def count_skip_reasons(cases: Iterable[CaseResult]) -> list[tuple[str, str, int]]:
    """(oracle, why it did not apply, cases), the most frequent first; numbers in reasons are left out."""
    found: Counter[tuple[str, str]] = Counter()
    for case in cases:
        for reason in case.result.skipped:
            oracle, _, why = reason.partition(": ")
            if oracle != "unsupported":
                found[oracle, re.sub(r"\d[\d.e+-]*", "...", why)] += 1
    return [(oracle, why, count) for (oracle, why), count in found.most_common()]
