"""Chunks of cases. A chunk contains some cases of one subject; it is a task of a worker and has one stored answer.

The cases of a chunk that crashes or times out are run again one by one. So the failing case is identified, and the
results of other cases are kept.
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

CHUNK_SIZE = 10  # cases in a chunk, which take some seconds


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
        return self.subject.draw(self.seed, number, self.kinds, self.decades)

    def run(self) -> Values:
        """The results of the cases as a JSON list."""
        results = []
        for number in range(self.first, self.first + self.count):
            case = self.draw(number)
            result = self.subject.ask(case, number, self.oracles)
            errors = {check: [float(value) for value in pair] for check, pair in result.errors.items()}
            results.append([case.kinds, errors, result.skipped, result.words])
        return {"results": json.dumps(results)}


@dataclass(frozen=True)
class CaseResult:
    chunk: Chunk
    number: int
    kinds: tuple[str, ...]
    result: OracleResult


def iter_case_results(answers: Mapping[Chunk, Answer]) -> Iterator[CaseResult]:
    """Yield the results of all cases in these chunks. A chunk of one case that crashed or timed out is a fault with an
    infinite error. An unfinished chunk of several cases yields nothing, since its cases are run again one by one."""
    for chunk, answer in answers.items():
        if answer.finished:
            rows = json.loads(str(answer.values["results"]))
            for number, (kinds, pairs, skipped, text) in enumerate(rows, chunk.first):
                errors = {check: (error, bound) for check, (error, bound) in pairs.items()}
                yield CaseResult(chunk, number, tuple(kinds), OracleResult(errors, tuple(skipped), text))
        elif chunk.count == 1:
            fault = answer.outcome in (Outcome.ABORTED, Outcome.TIMED_OUT, Outcome.FAILED)
            errors = {str(answer.outcome): (np.inf, 0.0)} if fault else {}
            yield CaseResult(chunk, chunk.first, chunk.kinds, OracleResult(errors, words=answer.sentence))


def make_chunks(
    subjects: Sequence[Subject], seed: int, cases: int, kinds: Sequence[str], decades: int, oracles: tuple[str, ...]
) -> list[Chunk]:
    """Chunks of the first cases of a seed; the subjects alternate. If a subject supports no kind in `kinds`, its cases
    have all kinds that it supports."""
    out = []
    for first in range(0, cases, CHUNK_SIZE):
        count = min(CHUNK_SIZE, cases - first)
        for subject in subjects:
            taken = tuple(kind for kind in (*subject.kinds, *SINGULAR_KINDS) if kind in kinds) or subject.kinds
            out.append(Chunk(subject, seed, first, count, taken, decades, oracles))
    return out


def unfinished_cases(answers: Mapping[Chunk, Answer]) -> list[Chunk]:
    """Chunks with a single case for each case of the chunks that crashed or timed out."""
    ended = [chunk for chunk, answer in answers.items() if not answer.finished and chunk.count > 1]
    return [replace(chunk, first=chunk.first + n, count=1) for chunk in ended for n in range(chunk.count)]


def stored_answers(store: Store, chunks: Sequence[Chunk]) -> dict[Chunk, Answer]:
    """The stored answers of these chunks, and of their cases that were run separately."""

    def stored(wanted: Sequence[Chunk]) -> dict[Chunk, Answer]:
        found = store.answers(wanted)
        return {chunk: found[chunk] for chunk in wanted if chunk in found}

    answers = stored(chunks)
    return answers | stored(unfinished_cases(answers))


def chunk_to_json(chunk: Chunk) -> str:
    numbers = [chunk.seed, chunk.first, chunk.count, list(chunk.kinds), chunk.decades, list(chunk.oracles)]
    return json.dumps([chunk.subject.name, *numbers])


def chunk_from_json(text: str, subjects: Sequence[Subject]) -> Chunk | None:
    """The inverse of `chunk_to_json`, or None if the subject is not among `subjects`."""
    name, seed, first, count, kinds, decades, oracles = json.loads(text)
    subject = next((subject for subject in subjects if subject.name == name), None)
    return Chunk(subject, seed, first, count, tuple(kinds), decades, tuple(oracles)) if subject else None


def case_label(case: CaseResult) -> str:
    """The subject's name, followed by the kinds of joints if the chunk does not have all kinds of the subject."""
    chunk = case.chunk
    kinds = "" if chunk.kinds == chunk.subject.kinds else f" ({', '.join(chunk.kinds)})"
    return f"{chunk.subject.name}{kinds}"


CHECKS_HEADER = ("subject", "check", "judged", "median", "99 %", "worst", "faults")


def summary_rows(cases: Sequence[CaseResult]) -> list[list[str]]:
    """Rows under CHECKS_HEADER. The table ends with the number of refused cases by subject."""
    checks: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for case in cases:
        for check, pair in case.result.errors.items():
            checks.setdefault((case_label(case), check), []).append(pair)
    out, reported = [], []
    for (subject, check), pairs in checks.items():
        errors = np.sort([error for error, _ in pairs])
        if check == NEEDLESS_REPORT:
            if errors.any():
                count = f"{errors.sum():.0f} reported, though right"
                reported.append([subject, count, str(len(pairs)), "", "", "", ""])
            continue
        quantiles = [_short(errors[math.ceil(share * (len(errors) - 1))]) for share in (0.5, 0.99, 1.0)]
        out.append([subject, check, str(len(pairs)), *quantiles, str(sum(not error <= most for error, most in pairs))])
    refusals = [[subject, "refused", str(count), "", "", "", ""] for subject, count in count_refusals(cases).items()]
    return [*out, *reported, *refusals]


def count_refusals(cases: Iterable[CaseResult]) -> Mapping[str, int]:
    """Subject -> number of cases that it refused as unsupported."""
    return Counter(
        case_label(case) for case in cases if any(reason.startswith("unsupported") for reason in case.result.skipped)
    )


def _short(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "lost"


FINDINGS_HEADER = ("subject", "check", "error", "may be", "seed", "decades", "case", "kinds")


def finding_rows(cases: Iterable[CaseResult]) -> list[list[str]]:
    out = []
    for case in cases:
        case_columns = [str(case.chunk.seed), str(case.chunk.decades), str(case.number), ",".join(case.kinds)]
        for check in case.result.faults:
            out.append([case.chunk.subject.name, check, *map(_short, case.result.errors[check]), *case_columns])
    return out


def count_skip_reasons(cases: Iterable[CaseResult]) -> list[tuple[str, str, int]]:
    """Triples (oracle, skip reason, number of cases); frequent reasons come first. Numbers in reasons become "..."."""
    reasons: Counter[tuple[str, str]] = Counter()
    for case in cases:
        for reason in case.result.skipped:
            oracle, _, text = reason.partition(": ")
            if oracle != "unsupported":
                reasons[oracle, re.sub(r"\d[\d.e+-]*", "...", text)] += 1
    return [(oracle, text, count) for (oracle, text), count in reasons.most_common()]
