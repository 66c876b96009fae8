"""A search in pieces: some cases of one subject each, run in a supervised process and kept like any other answer.

A piece whose process ends, or whose time is used up, is asked again case by case, so that the case which does it is
known and the others are not lost.
"""

from __future__ import annotations

import json
import math
import re
from collections import Counter
from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from engines import Engine
from reports.model.outcomes import Outcome
from reports.model.tasks import Answer, Task, Values
from reports.run.store import Store
from reports.search.claims import REPORTED
from reports.search.parts import SINGULAR
from reports.search.subjects import Adapted, Subject, Told, is_shaped

SIZE = 10  # cases in a piece: a second or some


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
    def kin(self) -> Hashable:
        """The same mechanisms, which are built and judged once for all engines; or shapes that are compiled once."""
        subject = self.subject.name if is_shaped(self.subject) else ""
        return subject, self.seed, self.decades, "" if subject else self.first

    @property
    def label(self) -> str:
        return f"{self.subject.name}, case {self.first}"

    @property
    def engine(self) -> Engine | None:
        return self.subject.engine if isinstance(self.subject, Adapted) else None

    def run(self) -> Values:
        told = []
        for number in range(self.first, self.first + self.count):
            case: Any = self.subject.draw(self.seed, number, self.kinds, self.decades)
            told.append((number, case.kinds, self.subject.ask(case, number, self.oracles)))
        checks = sorted({check for _, _, one in told for check in one.errors})
        errors = np.full((len(told), len(checks), 2), np.nan)
        for row, (_, _, one) in enumerate(told):
            for check, pair in one.errors.items():
                errors[row, checks.index(check)] = pair
        words = [[list(kinds), list(one.not_asked), one.words] for _, kinds, one in told]
        return {"checks": json.dumps(checks), "errors": errors, "words": json.dumps(words)}

    @property
    def single(self) -> tuple[Chunk, ...]:
        """Its cases, each a piece of its own."""
        numbers = range(self.first, self.first + self.count)
        return tuple(
            Chunk(self.subject, self.seed, number, 1, self.kinds, self.decades, self.oracles) for number in numbers
        )


@dataclass(frozen=True)
class Asked:
    """A case, and what was found of it."""

    chunk: Chunk
    number: int
    kinds: tuple[str, ...]
    told: Told


def asked(answers: Mapping[Chunk, Answer]) -> Iterator[Asked]:
    """The cases of these pieces. One whose process ended is a fault without a number."""
    for chunk, answer in answers.items():
        if not answer.finished:
            if chunk.count == 1:
                fault = answer.outcome in (Outcome.ABORTED, Outcome.TIMED_OUT, Outcome.FAILED)
                errors = {str(answer.outcome): (np.inf, 0.0)} if fault else {}
                yield Asked(chunk, chunk.first, chunk.kinds, Told(errors, words=answer.sentence))
            continue
        checks, pairs = json.loads(str(answer.values["checks"])), answer.array("errors")
        words = json.loads(str(answer.values["words"]))
        for row, (kinds, left, said) in enumerate(words):
            errors = {
                check: (float(pairs[row, column, 0]), float(pairs[row, column, 1]))
                for column, check in enumerate(checks)
                if not np.isnan(pairs[row, column, 1])
            }
            yield Asked(chunk, chunk.first + row, tuple(kinds), Told(errors, tuple(left), said))


def cases_in(answer: Answer) -> int:
    """How many cases a piece tells of; none of one that has to be asked case by case."""
    return len(answer.array("errors")) if answer.finished else 0


def has_fault(answer: Answer) -> bool:
    """Whether any case of a piece has one."""
    if not answer.finished:
        return False
    error, bound = np.moveaxis(answer.array("errors"), -1, 0)
    return bool(np.any(~(error <= bound) & ~np.isnan(bound)))


def chunks(
    subjects: Sequence[Subject],
    seed: int,
    cases: int,
    kinds: Sequence[str],
    decades: int,
    oracles: tuple[str, ...],
    begin: int = 0,
) -> list[Chunk]:
    """The pieces of the cases `begin` to `cases - 1`, those of all subjects in turn; all kinds of a subject if none."""
    out = []
    for first in range(begin, cases, SIZE):
        count = min(SIZE, cases - first)
        for subject in subjects:
            own = tuple(kind for kind in (*subject.kinds, *SINGULAR) if kind in kinds) or subject.kinds
            out.append(Chunk(subject, seed, first, count, own, decades, oracles))
    return out


def lost(answers: Mapping[Chunk, Answer]) -> list[Chunk]:
    """The cases, one by one, of pieces whose process ended or whose time was used up."""
    ended = [chunk for chunk, answer in answers.items() if not answer.finished and chunk.count > 1]
    return [single for chunk in ended for single in chunk.single]


def stored(store: Store, pieces: Sequence[Chunk]) -> dict[Chunk, Answer]:
    """The answers to these pieces, and to those of their cases that had to be asked one by one."""
    whole = store.answers(pieces)
    answers = {piece: whole[piece] for piece in pieces if piece in whole}
    singles = lost(answers)
    single = store.answers(singles)
    return answers | {piece: single[piece] for piece in singles if piece in single}


def as_words(chunk: Chunk) -> str:
    """What finds a piece again: its numbers, and the subject's name."""
    numbers = [chunk.seed, chunk.first, chunk.count, list(chunk.kinds), chunk.decades, list(chunk.oracles)]
    return json.dumps([chunk.subject.name, *numbers])


def from_words(words: str, subjects: Sequence[Subject]) -> Chunk | None:
    """The piece that `as_words` told; None where its subject is not among these."""
    name, seed, first, count, kinds, decades, oracles = json.loads(words)
    subject = next((one for one in subjects if one.name == name), None)
    return Chunk(subject, seed, first, count, tuple(kinds), decades, tuple(oracles)) if subject else None


HEADER = ("subject", "check", "judged", "median", "99 %", "worst", "faults")


@dataclass(frozen=True)
class Distribution:
    """One check of one subject."""

    subject: str
    check: str
    errors: tuple[float, ...]
    faults: int

    @property
    def quantiles(self) -> tuple[float, float, float]:
        """Median, 99 % and worst; infinite for what has no number."""
        ordered = np.sort(np.array(self.errors))
        places = [math.ceil(share * (len(ordered) - 1)) for share in (0.5, 0.99, 1.0)]
        median, most, worst = (float(ordered[place]) for place in places)
        return median, most, worst


def label(one: Asked) -> str:
    """The subject, and the kinds that were asked for where they are not all of its own."""
    chunk = one.chunk
    kinds = "" if chunk.kinds == chunk.subject.kinds else f" ({', '.join(chunk.kinds)})"
    return f"{chunk.subject.name}{kinds}"


def lines(told: Iterable[Asked]) -> list[Distribution]:
    """In the order in which subjects and checks first come up."""
    found: dict[tuple[str, str], list[tuple[float, bool]]] = {}
    for one in told:
        for check, (error, bound) in one.told.errors.items():
            found.setdefault((label(one), check), []).append((error, not error <= bound))
    return [
        Distribution(subject, check, tuple(error for error, _ in pairs), sum(fault for _, fault in pairs))
        for (subject, check), pairs in found.items()
    ]


def summary(told: Sequence[Asked]) -> list[list[str]]:
    """Rows of a table under HEADER; a last line a subject says how many cases it refused."""
    out = [
        [line.subject, line.check, str(len(line.errors)), *map(_short, line.quantiles), str(line.faults)]
        for line in lines(told)
        if line.check != REPORTED
    ]
    for line in lines(told):
        if line.check == REPORTED and any(line.errors):
            words = f"{sum(line.errors):.0f} reported, though right"
            out.append([line.subject, words, str(len(line.errors)), "", "", "", ""])
    for subject, count in refused(told).items():
        out.append([subject, "refused", str(count), "", "", "", ""])
    return out


def refused(told: Iterable[Asked]) -> Mapping[str, int]:
    """How many cases a subject can't build, by its own word."""
    return Counter(label(one) for one in told if any(why.startswith("unsupported") for why in one.told.not_asked))


def _short(value: float) -> str:
    return f"{value:.1e}" if math.isfinite(value) else "lost"


FOUND = ("subject", "check", "error", "may be", "seed", "decades", "case", "kinds")


def findings(told: Iterable[Asked]) -> list[list[str]]:
    """Rows of a table under FOUND, one for each check that fails in a case."""
    return [
        [
            one.chunk.subject.name,
            check,
            _short(one.told.errors[check][0]),
            _short(one.told.errors[check][1]),
            str(one.chunk.seed),
            str(one.chunk.decades),
            str(one.number),
            ",".join(one.kinds),
        ]
        for one in told
        for check in one.told.faults
    ]


def left_out(told: Iterable[Asked]) -> list[list[str]]:
    """(law, why it was not asked, subjects, cases), the most frequent first; numbers in reasons are left out."""
    found: dict[tuple[str, str], Counter[str]] = {}
    for one in told:
        for reason in one.told.not_asked:
            law, _, why = reason.partition(": ")
            if law != "unsupported":
                key = law, re.sub(r"\d[\d.e+-]*", "...", why)
                found.setdefault(key, Counter())[one.chunk.subject.name] += 1
    rows = [
        [law, why, ", ".join(f"{name} {many}" for name, many in of.most_common()), str(of.total())]
        for (law, why), of in found.items()
    ]
    return sorted(rows, key=lambda row: -int(row[-1]))
