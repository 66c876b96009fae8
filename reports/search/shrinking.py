"""A case made smaller as long as it still does what is asked: fewer bodies, fewer joints, smaller whole numbers."""

from __future__ import annotations

import json
import re
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from typing import Any, TypeVar

from engines import Engine
from reference.checks import InvalidMechanism
from reports.model.tasks import Answer, Task, Values
from reports.search import mujoco_alone
from reports.search.chunk import CaseResult
from reports.search.parts import CLAIMS, ORACLES, Recipe
from reports.search.scripts import script
from reports.search.subjects import Adapted, Result, Subject

Case = TypeVar("Case")


def shrunk(case: Case, still: Callable[[Case], bool], seconds: float) -> Case:
    """The smallest case found within so many seconds of CPU time; `still` says whether a smaller one is as wrong."""
    end = time.process_time() + seconds
    tried: set[Case] = {case}
    going = True
    while going and time.process_time() < end:
        going = False
        for smaller in (*_with_less(case), *_with_smaller_numbers(case)):
            if smaller in tried:
                continue
            tried.add(smaller)
            if still(smaller):
                case, going = smaller, True
                break
            if time.process_time() > end:
                break
    return case


def _with_less(case: Any) -> Iterator[Any]:
    """Without a body, or without a joint; bodies first, since joints go with them."""
    if isinstance(case, Recipe):
        for body in range(len(case.parts), 0, -1):
            if len(case.parts) > 1:
                yield _without_part(case, body)
        for link in range(len(case.links)):
            yield replace(case, links=case.links[:link] + case.links[link + 1 :])
    else:
        for body in range(len(case.links), 0, -1):
            if len(case.links) > 1:
                yield _without_link(case, body)
        for equality in range(len(case.equalities)):
            yield replace(case, equalities=case.equalities[:equality] + case.equalities[equality + 1 :])
        yield from _with_fewer_coordinates(case)


def _after(removed: int, parent: int, body: int) -> int:
    """A body's number when one is gone; its parent stands for the one that is gone."""
    return parent if body == removed else body - (body > removed)


def _without_part(case: Recipe, removed: int) -> Recipe:
    parent = case.parts[removed - 1].parent
    parts = [
        replace(part, parent=_after(removed, parent, part.parent))
        for body, part in enumerate(case.parts, 1)
        if body != removed
    ]
    links = [
        replace(link, first=_after(removed, 0, link.first), second=_after(removed, 0, link.second))
        for link in case.links
        if removed not in (link.first, link.second)
    ]
    return replace(case, parts=tuple(parts), links=tuple(links))


def _without_link(case: mujoco_alone.Model, removed: int) -> mujoco_alone.Model:
    parent = case.links[removed - 1].parent
    links = [
        replace(link, parent=_after(removed, parent, link.parent))
        for body, link in enumerate(case.links, 1)
        if body != removed
    ]
    return _of_links(case, links, removed)


def _of_links(case: mujoco_alone.Model, links: Sequence[mujoco_alone.RawBody], removed: int = 0) -> mujoco_alone.Model:
    """The model with other links, one of them perhaps gone, and those of its equalities that still have both ends."""
    before = mujoco_alone.coordinates(case)
    after = mujoco_alone.coordinates(replace(case, links=tuple(links), equalities=()))
    places = {each: number for number, each in enumerate(after)}

    def end(each: mujoco_alone.Equality, which: int) -> int | None:
        if each.kind in ("connect", "weld"):
            return None if removed and which == removed else _after(removed, 0, which) if removed else which
        if which >= len(before) or before[which][0] == removed:
            return None
        body, what = before[which]
        return places.get((_after(removed, 0, body) if removed else body, what))

    equalities = []
    for each in case.equalities:
        first, second = end(each, each.first), end(each, each.second)
        if first is not None and second is not None:
            equalities.append(replace(each, first=first, second=second))
    return replace(case, links=tuple(links), equalities=tuple(equalities))


def _with_fewer_coordinates(case: mujoco_alone.Model) -> Iterator[mujoco_alone.Model]:
    for place, link in enumerate(case.links):
        for fewer in (replace(link, slides=max(link.slides - 1, 0)), replace(link, turns=False)):
            if fewer != link and (fewer.slides or fewer.turns):
                yield _of_links(case, [*case.links[:place], fewer, *case.links[place + 1 :]])


# Which bodies are joined is no number that is small or large.
NAMES = {"parent", "first", "second", "kind", "shape", "slides", "turns"}


def _with_smaller_numbers(value: Any) -> Iterator[Any]:
    """The same with one number, or all of a tuple, nearer to zero."""
    if is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            if field.name not in NAMES:
                for smaller in _with_smaller_numbers(getattr(value, field.name)):
                    yield replace(value, **{field.name: smaller})
    elif isinstance(value, tuple):
        if value and all(type(one) is int for one in value) and any(value) and len(value) > 1:
            yield tuple(0 for _ in value)
        for place, one in enumerate(value):
            for smaller in _with_smaller_numbers(one):
                yield (*value[:place], smaller, *value[place + 1 :])
    elif isinstance(value, bool):
        if value:
            yield False
    elif isinstance(value, int) and value:
        step = 1 if value > 0 else -1
        yield from dict.fromkeys([0, step, int(value / 2), value - step])


SECONDS = 20.0  # of CPU time for one finding
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
    def of(cls, check: str, case: CaseResult) -> Shrink:
        """What makes a finding smaller."""
        chunk = case.chunk
        return cls(chunk.subject, chunk.seed, case.number, chunk.kinds, chunk.decades, check, chunk.oracles)

    @property
    def cost(self) -> float:
        return SECONDS + (self.engine.building if self.engine else 0.0)  # few shapes of a compiled engine are tried

    @property
    def label(self) -> str:
        spread = f" with {self.decades} decades" if self.decades else ""
        return f"{self.subject.name}, {self.check}, case {self.number} of seed {self.seed}{spread}"

    @property
    def engine(self) -> Engine | None:
        return self.subject.engine if isinstance(self.subject, Adapted) else None

    def run(self) -> Values:
        """The smallest case, in a line and as JSON (`replayed` reads it), and a script of it."""
        case: Any = self.subject.draw(self.seed, self.number, self.kinds, self.decades)
        oracles = self._oracle(case)
        whole = self.subject.ask(case, self.number, oracles)
        why, least = _kind_of(whole), KEPT * whole.errors[self.check][0]

        def still(smaller: Any) -> bool:
            try:
                result = self.subject.ask(smaller, self.number, oracles)
            except InvalidMechanism:
                return False
            return self.check in result.faults and result.errors[self.check][0] >= least and _kind_of(result) == why

        small = shrunk(case, still, self.cost)
        result = self.subject.ask(small, self.number, oracles)
        error, bound = result.errors[self.check]
        finite = error < float("inf")
        finding = {
            "subject": self.subject.name,
            "check": self.check,
            "oracles": list(oracles),
            "number": self.number,
            "seed": self.seed,
            "error": error if finite else None,
            "bound": bound,
            "words": result.words,
            "case": json.loads(self.subject.text(small)),
        }
        line = f"{' '.join(small.kinds)}: {f'{error:.1e}' if finite else 'lost'}"
        return {
            "line": f"{line}{'; ' + result.words if result.words else ''}",
            "finding": json.dumps(finding, indent=1),
            "script": script(self.subject, small, self.check, self.number),
        }

    def _oracle(self, case: Any) -> tuple[str, ...]:
        """The one oracle that finds this fault, so that the others are not asked again and again."""
        for oracle in (name for name in (*ORACLES, CLAIMS) if name in self.oracles):
            if self.check in self.subject.ask(case, self.number, (oracle,)).faults:
                return (oracle,)
        return self.oracles


def _kind_of(result: Result) -> str:
    """What a fault without a number is, its own numbers and names left out: another one is no smaller example."""
    return re.sub(r"'[^']*'|[0-9.e+-]+", "", result.words)


def worst_of(cases: Iterable[CaseResult], most: int = MOST) -> list[tuple[str, CaseResult]]:
    """(check, case): of each check of each subject those with fewest kinds of joints, at most so many; one of a set."""
    found: dict[tuple[str, str], dict[tuple[str, ...], CaseResult]] = {}
    for case in cases:
        for check in case.result.faults[:1]:
            found.setdefault((case.chunk.subject.name, check), {}).setdefault(case.kinds, case)
    return [
        (check, case)
        for (_, check), kinds in found.items()
        for case in sorted(kinds.values(), key=lambda case: (len(case.kinds), case.number))[:most]
    ]


def line_of(answer: Answer) -> str:
    """The finding in one line."""
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


def replayed(finding: dict[str, Any], subject: Subject) -> Result:
    """The present result of a finding that was written before."""
    case: Any = subject.read(json.dumps(finding["case"]))
    return subject.ask(case, finding["number"], tuple(finding["oracles"]))
