"""The page of a search, from its stored rows alone."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from engines.registry import ENGINES, OTHERS
from reports.model.tasks import Answer
from reports.plots.theme import svg
from reports.run.store import Store
from reports.search.chunk import Asked, asked, from_words, lost
from reports.search.picture import distribution
from reports.search.recipe import LEAST_RANK
from reports.search.release import release_of
from reports.search.renumbered import SHAPES
from reports.search.shrunk import Shrink, line_of, worst_of
from reports.search.subjects import Adapted, Alone, Subject, is_shaped
from reports.search.summary import HEADER, refused, summary
from reports.write.templates import environment


def known_subjects(words: Sequence[str]) -> list[Subject]:
    """Every engine that is registered, and MuJoCo alone in the releases that these words name."""
    releases = dict.fromkeys(release_of(json.loads(word)[0]) for word in words)
    engines = dict.fromkeys([*ENGINES, *OTHERS])
    return [*(Adapted(engine) for engine in engines), *(Alone(each) for each in releases if each is not None)]


def read(store: Store) -> tuple[list[Asked], list[tuple[Shrink, Answer]]]:
    """The cases that are stored for the present sources, and the findings among them that were made smaller."""
    words = store.remembered()
    subjects = known_subjects(words)
    pieces = [piece for piece in (from_words(word, subjects) for word in words) if piece is not None]
    whole = store.answers(pieces)
    answers = {piece: whole[piece] for piece in pieces if piece in whole}
    singles = lost(answers)
    single = store.answers(singles)
    told = list(asked(answers | {piece: single[piece] for piece in singles if piece in single}))
    tasks = [Shrink.of(check, one) for check, one in worst_of(told)]
    small = store.answers(tasks)
    return told, [(task, small[task]) for task in tasks if task in small]


def files(told: Sequence[Asked], findings: Sequence[tuple[Shrink, Answer]], foot: str) -> dict[str, str]:
    """search.md and its picture, by name; nothing of a search that asked nothing."""
    if not told:
        return {}
    picture = distribution(told)
    out = {} if picture is None else {"search_errors.svg": svg(picture, "Errors by engine and kind of joint")}
    page = {
        "cases": len(told),
        "alone": any(isinstance(one.chunk.subject, Alone) for one in told),
        "shapes": SHAPES if any(is_shaped(one.chunk.subject) for one in told) else 0,
        "rank": f"{LEAST_RANK:g}",
        "searched": _searched(told),
        "picture": next(iter(out), ""),
        "header": HEADER,
        "lines": summary(told),
        "findings": [_finding(task, answer) for task, answer in _one_of_each(findings)],
    }
    template = environment(Path(__file__).parent).get_template("own/page.md")
    out["search.md"] = template.render(page=page, foot=foot)
    return out


def _searched(told: Sequence[Asked]) -> list[list[str]]:
    """A line for each subject, set of kinds, seed and spread."""
    groups: dict[tuple[str, tuple[str, ...], int, int], list[Asked]] = {}
    for one in told:
        chunk = one.chunk
        groups.setdefault((chunk.subject.name, chunk.kinds, chunk.seed, chunk.decades), []).append(one)
    return [
        [
            name,
            ", ".join(kinds) + (f"; {decades} decades more" if decades else ""),
            str(seed),
            str(len(group)),
            str(sum(refused(group).values())),
            str(sum(bool(one.told.faults) for one in group)),
        ]
        for (name, kinds, seed, decades), group in groups.items()
    ]


def _one_of_each(findings: Sequence[tuple[Shrink, Answer]]) -> list[tuple[Shrink, Answer]]:
    """Of each subject, check and set of kinds that is left the first: the same fault comes up often."""
    found: dict[tuple[str, str, str], tuple[Shrink, Answer]] = {}
    for task, answer in findings:
        kinds = line_of(answer).split(":")[0]
        found.setdefault((task.subject.name, task.check, kinds), (task, answer))
    return list(found.values())


def _finding(task: Shrink, answer: Answer) -> Mapping[str, Any]:
    title = f"{task.subject.name}: {task.check}, case {task.number} of seed {task.seed}"
    if not answer.finished:
        return {"title": title, "text": line_of(answer), "language": "", "script": "\n"}
    values = answer.values
    script = str(values["script"])
    text = f"The smallest mechanism with {line_of(answer)}."
    if not script:
        text += " It needs the adapter; this is the recipe."
        told = json.loads(str(values["finding"]))
        script = f"{json.dumps(told['case'])}\n"
    return {"title": title, "text": text, "language": "python" if values["script"] else "json", "script": script}
