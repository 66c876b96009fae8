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
from reports.search import raw
from reports.search.chunk import Asked
from reports.search.parts import Recipe
from reports.search.scripts import script
from reports.search.subjects import CLAIMS, ORACLES, Adapted, Subject, Told

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


def _without_link(case: raw.Model, removed: int) -> raw.Model:
    parent = case.links[removed - 1].parent
    links = [
        replace(link, parent=_after(removed, parent, link.parent))
        for body, link in enumerate(case.links, 1)
        if body != removed
    ]
    return _of_links(case, links, removed)


def _of_links(case: raw.Model, links: Sequence[raw.RawBody], removed: int = 0) -> raw.Model:
    """The model with other links, one of them perhaps gone, and those of its equalities that still have both ends."""
    before = raw.coordinates(case)
    after = raw.coordinates(replace(case, links=tuple(links), equalities=()))
    places = {each: number for number, each in enumerate(after)}

    def end(each: raw.Equality, which: int) -> int | None:
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


def _with_fewer_coordinates(case: raw.Model) -> Iterator[raw.Model]:
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
        return SECONDS + (TRIED * self.engine.building if self.engine else 0.0)

    @property
    def label(self) -> str:
        spread = f" with {self.decades} decades" if self.decades else ""
        return f"{self.subject.name}, {self.check}, case {self.number} of seed {self.seed}{spread}"

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
            "script": script(self.subject, small, self.check, self.number),
        }


def _kind_of(told: Told) -> str:
    """What a fault without a number is, its own numbers and names left out: another one is no smaller example."""
    return re.sub(r"'[^']*'|[0-9.e+-]+", "", told.words)


def oracle_of(subject: Subject, case: Any, number: int, check: str, oracles: tuple[str, ...]) -> tuple[str, ...]:
    """The one oracle that tells this fault, so that the others are not asked again and again."""
    for oracle in (one for one in (*ORACLES, CLAIMS) if one in oracles):
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
