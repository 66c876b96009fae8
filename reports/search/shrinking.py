"""Test-case reduction. Bodies and joints are removed, and integers are made smaller, while the check still fails."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any

from engines import Engine
from reference.checks import InvalidMechanism
from reports.model.tasks import Answer, Task, Values
from reports.search.chunk import CaseResult, Chunk
from reports.search.parts import Case, case_from_json, case_to_json
from reports.search.scripts import write_script
from reports.search.subjects import ORACLES, OracleResult, Subject


def shrink_case(case: Case, still: Callable[[Case], bool], seconds: float) -> Case:
    """The smallest failing case that is found in `seconds` of CPU time. `still`: whether a smaller case fails in the
    same way."""
    end = time.process_time() + seconds
    seen: set[Case] = {case}
    reduced = True
    while reduced and time.process_time() < end:
        reduced = False
        for smaller in (*_with_less(case), *_with_smaller_numbers(case)):
            if smaller in seen:
                continue
            seen.add(smaller)
            if still(smaller):
                case, reduced = smaller, True
                break
            if time.process_time() > end:
                break
    return case


def _with_less(case: Any) -> Iterator[Any]:
    for removed in range(len(case.parts), 0, -1):
        if len(case.parts) > 1:
            yield _without_part(case, removed)
    for link in range(len(case.links)):
        yield replace(case, links=case.links[:link] + case.links[link + 1 :])


def _without_part(case: Any, removed: int) -> Any:
    """A copy without a body and without the body's joints. Children of the body get the body's parent."""
    parent = case.parts[removed - 1].parent

    def renumbered(body: int) -> int:
        return parent if body == removed else body - (body > removed)

    parts = [replace(p, parent=renumbered(p.parent)) for body, p in enumerate(case.parts, 1) if body != removed]
    links = [
        replace(link, first=renumbered(link.first), second=renumbered(link.second))
        for link in case.links
        if removed not in (link.first, link.second)
    ]
    return replace(case, parts=tuple(parts), links=tuple(links))


# Fields that are not quantities and are not reduced.
IDENTITY_FIELDS = {"parent", "first", "second", "kind", "shape"}


def _with_smaller_numbers(value: Any) -> Iterator[Any]:
    """Yield copies in which one number, or all numbers of a tuple, are nearer to zero."""
    if is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            if field.name not in IDENTITY_FIELDS:
                for smaller in _with_smaller_numbers(getattr(value, field.name)):
                    yield replace(value, **{field.name: smaller})
    elif isinstance(value, tuple):
        if value and all(type(item) is int for item in value) and any(value) and len(value) > 1:
            yield tuple(0 for _ in value)
        for index, item in enumerate(value):
            for smaller in _with_smaller_numbers(item):
                yield (*value[:index], smaller, *value[index + 1 :])
    elif isinstance(value, bool):
        if value:
            yield False
    elif isinstance(value, int) and value:
        step = 1 if value > 0 else -1
        yield from dict.fromkeys([0, step, int(value / 2), value - step])


SHRINK_TIME = 20.0  # CPU time for one finding [s].
KEPT_SHARE = 0.01  # Smallest ratio of the error to the original error; a smaller error may have another cause.
FINDINGS_SHRUNK = 2  # Number of findings that are reduced for each check and subject.


@dataclass(frozen=True)
class Shrink(Task):
    """A task that reduces a case in which a check fails. `chunk` contains only this case."""

    check: str
    chunk: Chunk

    @classmethod
    def of(cls, check: str, case: CaseResult) -> Shrink:
        return cls(check, replace(case.chunk, first=case.number, count=1))

    @property
    def cost(self) -> float:
        return SHRINK_TIME + (self.engine.build_time if self.engine else 0.0)

    @property
    def label(self) -> str:
        spread = f" with {self.chunk.decades} decades" if self.chunk.decades else ""
        return f"{self.subject.name}, {self.check}, case {self.chunk.first} of seed {self.chunk.seed}{spread}"

    @property
    def subject(self) -> Subject:
        return self.chunk.subject

    @property
    def engine(self) -> Engine | None:
        return self.chunk.engine

    def run(self) -> Values:
        """The smallest case as a line of text, as JSON for `replay_finding`, and as a script."""
        subject, number = self.subject, self.chunk.first
        case = self.chunk.draw(number)
        oracles = self._oracle(case)
        full_result = subject.ask(case, number, oracles)
        reason, least = _kind_of(full_result), KEPT_SHARE * full_result.errors[self.check][0]

        def still(smaller: Any) -> bool:
            try:
                result = subject.ask(smaller, number, oracles)
            except InvalidMechanism:
                return False
            return self.check in result.faults and result.errors[self.check][0] >= least and _kind_of(result) == reason

        small = shrink_case(case, still, self.cost)
        result = subject.ask(small, number, oracles)
        error, bound = result.errors[self.check]
        finite = error < float("inf")
        finding = {
            "subject": subject.name,
            "check": self.check,
            "oracles": list(oracles),
            "number": number,
            "seed": self.chunk.seed,
            "error": error if finite else None,
            "bound": bound,
            "words": result.words,
            "case": json.loads(case_to_json(small)),
        }
        line = f"{' '.join(small.kinds)}: {f'{error:.1e}' if finite else 'lost'}"
        return {
            "line": f"{line}{'; ' + result.words if result.words else ''}",
            "finding": json.dumps(finding, indent=1),
            "script": write_script(subject, small, self.check, number),
        }

    def _oracle(self, case: Any) -> tuple[str, ...]:
        for oracle in (name for name in ORACLES if name in self.chunk.oracles):
            if self.check in self.subject.ask(case, self.chunk.first, (oracle,)).faults:
                return (oracle,)
        return self.chunk.oracles


def _kind_of(result: OracleResult) -> str:
    """The message of a fault without numbers and names. A reduced case must have the same message."""
    return re.sub(r"'[^']*'|[0-9.e+-]+", "", result.words)


def choose_worst(cases: Iterable[CaseResult]) -> list[tuple[str, CaseResult]]:
    """Pairs (check, case), at most FINDINGS_SHRUNK for each subject and check. Cases with few kinds of joints are
    preferred. Of several cases with the same kinds, only the first is used."""
    by_check: dict[tuple[str, str], dict[tuple[str, ...], CaseResult]] = {}
    for case in cases:
        for check in case.result.faults[:1]:
            by_check.setdefault((case.chunk.subject.name, check), {}).setdefault(case.kinds, case)
    return [
        (check, case)
        for (_, check), kinds in by_check.items()
        for case in sorted(kinds.values(), key=lambda case: (len(case.kinds), case.number))[:FINDINGS_SHRUNK]
    ]


def line_of(answer: Answer) -> str:
    return str(answer.values["line"]) if answer.finished else f"not reduced: {answer.sentence}"


def files_of(task: Shrink, answer: Answer) -> dict[str, str]:
    """The files of a reduced finding by name; empty if the reduction did not finish."""
    if not answer.finished:
        return {}
    stem = re.sub(r"\W+", "_", f"{task.subject.name} {task.check} {task.chunk.seed} {task.chunk.first}").strip("_")
    files = {f"{stem}.json": f"{answer.values['finding']}\n"}
    if answer.values["script"]:
        files[f"{stem}.py"] = str(answer.values["script"])
    return files


def replay_finding(finding: dict[str, Any], subject: Subject) -> OracleResult:
    case: Any = case_from_json(json.dumps(finding["case"]), subject.case)
    return subject.ask(case, finding["number"], tuple(finding["oracles"]))
