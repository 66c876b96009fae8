"""The page of a search, from its stored rows alone."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, FileSystemLoader, StrictUndefined
from matplotlib.figure import Figure

from engines.registry import ENGINES, OTHERS
from reports.charts.theme import LIGHT, SERIES, Theme, new_figure, settings, style_axes, svg
from reports.grid.store import Store
from reports.grid.tasks import Answer
from reports.search.chunk import Asked, asked, from_words, lost
from reports.search.recipe import LEAST_RANK
from reports.search.release import release_of
from reports.search.shrunk import Shrink, line_of, worst_of
from reports.search.subjects import Adapted, Alone, Subject
from reports.search.summary import HEADER, label, refused, summary

LAWS = ("acceleration", "velocity")
LEAST = 1e-17  # what an error of exactly zero is drawn at


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
        "rank": f"{LEAST_RANK:g}",
        "searched": _searched(told),
        "picture": next(iter(out), ""),
        "header": HEADER,
        "lines": summary(told),
        "findings": [_finding(task, answer) for task, answer in _one_of_each(findings)],
    }
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
        autoescape=False,
    )
    out["search.md"] = environment.get_template("page.md").render(page=page, foot=foot)
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


def distribution(told: Sequence[Asked], theme: Theme = LIGHT) -> Figure | None:
    """Median to worst error of the law of one instant: a group of lines a subject, a line a kind; None without any."""
    found: dict[str, dict[str, list[float]]] = {}
    for one in told:
        for check in LAWS:
            if check in one.told.errors:
                for kind in one.kinds:
                    found.setdefault(label(one), {}).setdefault(kind, []).append(one.told.errors[check][0])
    if not found:
        return None
    kinds = list(dict.fromkeys(kind for own in found.values() for kind in own))
    marks = dict(zip(kinds, "os^Dv<>Pp*", strict=False))
    rows = [(name, kind) for name, own in found.items() for kind in own]
    with settings():
        figure = new_figure(1.1 + 0.24 * len(rows), theme)
        axes = figure.add_subplot()
        style_axes(axes, theme)
        axes.grid(False, axis="y")
        for place, (name, kind) in enumerate(rows):
            errors = np.sort(np.clip(np.nan_to_num(found[name][kind], posinf=1e2), LEAST, 1e2))
            median, most = errors[len(errors) // 2], errors[math.ceil(0.99 * (len(errors) - 1))]
            colour = getattr(theme, SERIES[kinds.index(kind) % len(SERIES)])
            axes.plot([median, errors[-1]], [place, place], color=colour, linewidth=1.4)
            axes.plot([median], [place], marks[kind], color=colour, markersize=5)
            axes.plot([most], [place], "|", color=colour, markersize=9)
            axes.plot([errors[-1]], [place], ".", color=colour, markersize=5)
        first = [place for place in range(1, len(rows)) if rows[place][0] != rows[place - 1][0]]
        for place in first:
            axes.axhline(place - 0.5, color=theme.grid, linewidth=0.7)
        axes.axvline(1e-9, color=theme.quiet, linewidth=0.8, linestyle=(0, (4, 3)))
        axes.set_yticks(
            range(len(rows)), [f"{name.split(' (')[0]}: {kind} ({len(found[name][kind])})" for name, kind in rows]
        )
        axes.set_ylim(len(rows) - 0.4, -0.6)
        axes.set_xscale("log")
        axes.set_xlim(LEAST / 2, 2e2)
        axes.set_xlabel("error, relative; mark: median, bar: 99 %, dot: worst (in brackets: cases); dashed: $10^{-9}$")
    return figure
