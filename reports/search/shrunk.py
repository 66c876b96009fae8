"""A finding made small: its recipe, by how much it is wrong, and a script that shows it without anything of ours."""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from engines import Engine
from reference.checks import InvalidMechanism
from reports.grid.tasks import Answer, Task, Values
from reports.search.chunk import Asked
from reports.search.scripts import script
from reports.search.shrinking import shrunk
from reports.search.subjects import ORACLES, Adapted, Subject, Told

SECONDS = 20.0  # of CPU time for one finding
TRIED = 1  # times the seconds that a shape takes to build, for engines that compile one: few shapes are tried
# Of the error that was found: what is left of it in a smaller case. Of less, it may be another fault, or a trifle.
KEPT = 0.01
MOST = 2  # findings of one check of a subject that are made smaller


@dataclass(frozen=True)
class Shrink(Task):
    """A case of a subject in which a check fails; see `chunk.Chunk` for the numbers."""

    subject: Subject
    seed: int
    number: int
    kinds: tuple[str, ...]
    decades: int
    check: str
    oracles: tuple[str, ...]

    @classmethod
    def of(cls, check: str, one: Asked) -> Shrink:
        """What makes a finding smaller."""
        chunk = one.chunk
        return cls(chunk.subject, chunk.seed, one.number, chunk.kinds, chunk.decades, check, chunk.oracles)

    @property
    def cost(self) -> float:
        return SECONDS + TRIED * getattr(self.engine, "building", 0.0)

    @property
    def label(self) -> str:
        return f"{self.subject.name}, {self.check}, case {self.number}"

    @property
    def engine(self) -> Engine | None:
        return self.subject.engine if isinstance(self.subject, Adapted) else None

    def run(self) -> Values:
        case: Any = self.subject.draw(self.seed, self.number, self.kinds, self.decades)
        oracles = oracle_of(self.subject, case, self.number, self.check, self.oracles)

        whole = self.subject.ask(case, self.number, oracles)
        why, least = _kind_of(whole), KEPT * whole.errors[self.check][0]

        def still(smaller: Any) -> bool:
            try:
                told = self.subject.ask(smaller, self.number, oracles)
            except InvalidMechanism:
                return False
            return self.check in told.faults and told.errors[self.check][0] >= least and _kind_of(told) == why

        small = shrunk(case, still, self.cost)
        told = self.subject.ask(small, self.number, oracles)
        error, bound = told.errors[self.check]
        text = self.subject.text(small)
        finding = {
            "subject": self.subject.name,
            "check": self.check,
            "oracles": list(oracles),
            "number": self.number,
            "seed": self.seed,
            "error": error if error < float("inf") else None,
            "bound": bound,
            "words": told.words,
            "case": json.loads(text),
        }
        line = f"{' '.join(small.kinds)}: {f'{error:.1e}' if error < float('inf') else 'lost'}"
        return {
            "line": f"{line}{'; ' + told.words if told.words else ''}",
            "finding": json.dumps(finding, indent=1),
            "script": script(self.subject, small, self.check),
        }


def _kind_of(told: Told) -> str:
    """What a fault without a number is, its own numbers and names left out: another one is no smaller example."""
    return re.sub(r"'[^']*'|[0-9.e+-]+", "", told.words)


def oracle_of(subject: Subject, case: Any, number: int, check: str, oracles: tuple[str, ...]) -> tuple[str, ...]:
    """The one oracle that tells this fault, so that the others are not asked again and again."""
    for oracle in (one for one in ORACLES if one in oracles):
        if check in subject.ask(case, number, (oracle,)).faults:
            return (oracle,)
    return oracles


def worst_of(told: Iterable[Asked], most: int = MOST) -> list[tuple[str, Asked]]:
    """(check, case): of each check of each subject those with fewest kinds of joints, at most so many; one of a set."""
    found: dict[tuple[str, str], dict[tuple[str, ...], Asked]] = {}
    for one in told:
        for check in one.told.faults[:1]:
            found.setdefault((one.chunk.subject.name, check), {}).setdefault(one.kinds, one)
    return [
        (check, one)
        for (_, check), kinds in found.items()
        for one in sorted(kinds.values(), key=lambda each: (len(each.kinds), each.number))[:most]
    ]


def line_of(answer: Answer) -> str:
    """What was found, for one line."""
    return str(answer.values["line"]) if answer.finished else f"not made smaller: {answer.sentence}"


def files_of(task: Shrink, answer: Answer) -> dict[str, str]:
    """A finding's files by name; none of one that could not be made smaller."""
    if not answer.finished:
        return {}
    stem = re.sub(r"\W+", "_", f"{task.subject.name} {task.check} {task.seed} {task.number}").strip("_")
    files = {f"{stem}.json": f"{answer.values['finding']}\n"}
    if answer.values["script"]:
        files[f"{stem}.py"] = str(answer.values["script"])
    return files


def replayed(finding: dict[str, Any], subject: Subject) -> Told:
    """What is found now of a finding that was written before."""
    case: Any = subject.read(json.dumps(finding["case"]))
    return subject.ask(case, finding["number"], tuple(finding["oracles"]))
