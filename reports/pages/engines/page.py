"""The page of engines; each table is made from rows or answers, and empty where there are none."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from math import inf
from typing import Any

from engines import method_name, registry
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Failure, Material, Page
from reports.model.tasks import Answer
from reports.pages.engines.experiments import (
    ASKED,
    BORROWED,
    CHARTED,
    CODE,
    COMPILED,
    CONTACT,
    FREE,
    SWEPT,
    TOO_OLD,
    YES,
    Capabilities,
    VelocityTerm,
)
from reports.plots.theme import svg
from reports.plots.work_precision import work_precision
from reports.write.columns import Column, column_of
from reports.write.provenance import engine_versions
from reports.write.tables import markdown, number


def rows_of(material: Material, scenes: Iterable[str]) -> list[Measurement]:
    """The rows of these scenes in all engines, those beside the grid as if they were of it; no user's tricks."""
    names = {*scenes}
    return [
        replace(row, purpose="sweep")
        for cell, row in material.rows.items()
        if cell.scene.name in names
        and cell.purpose in ("sweep", "beside")
        and column_of(cell.scene, cell.engine) is not Column.NAIVE
    ]


def missed(row: Measurement | None, field: str = "angle") -> float:
    """The error of a run that can be compared; infinite for any other."""
    usable = row is not None and Outcome(row.outcome).comparable and getattr(row, field) > 0
    return getattr(row, field) if usable else inf


def matrix(answers: Mapping[Capabilities, Answer]) -> str:
    """A column an engine, from what it built; empty where nothing was asked yet."""
    engines = [task.method for task in answers]
    body = [[what, *(verdict(str(answer.values[what])) for answer in answers.values())] for what in ASKED]
    body += [[what, *(str(answer.values[what]) for answer in answers.values())] for what in ("reactions", "width")]
    body.append(["version", *(engine_versions([engine]) for engine in engines)])
    return markdown(["", *(engine.name for engine in engines)], body, left=len(engines) + 1) if engines else ""


def verdict(told: str) -> str:
    """The word of a cell. The engine lacks a thing only where the sentence names a place in its documentation."""
    if told in (YES, CONTACT, CODE):
        return told
    if told.startswith(TOO_OLD):
        return "too old"
    return "**has none**" if "https://" in told else "not built"


def sentences(answers: Mapping[Capabilities, Answer]) -> list[tuple[str, str, str, str]]:
    """(engine, what, the word, the sentence) of what is not built."""
    return [
        (task.method.name, what, verdict(told), told)
        for task, answer in answers.items()
        for what in ASKED
        if (told := str(answer.values[what])) not in (YES, CONTACT, CODE)
    ]


NAME = "engines"
# One of each, as shipped where that is a variant: what is built does not depend on settings, but for constructions.
ASKED_OF = tuple({engine.name: engine for engine in reversed((*registry.VARIANTS, *registry.OTHERS))}.values())[::-1]
MATRIX = tuple(map(Capabilities, ASKED_OF))
# Of what declares a compliance of its loops, which a law can follow; the settings that make it small.
TERMS = tuple(
    VelocityTerm(engine)
    for engine in (*registry.VARIANTS, *registry.OTHERS)
    if engine.variant == "tuned"
    and (soft := engine.regularisation(FREE.mechanism(), 1e-3)) is not None
    and soft.compliance
)
EXPERIMENTS = (
    Failure(
        title="Compiled models",
        expected="The same model as in C, with an error that no step makes smaller where a loop turns.",
        cells=COMPILED,
        columns=("angle", "gap", "reaction"),
    ),
)


def shown(rows: Sequence[Measurement], field: str) -> set[tuple[str, str]]:
    """(scene, method) of each engine as shipped, and of the variant of it that comes nearest to the truth."""
    chosen: set[tuple[str, str]] = set()
    for scene, engine in dict.fromkeys((row.scene, row.engine) for row in rows):
        own = [row for row in rows if (row.scene, row.engine) == (scene, engine)]
        best = min(own, key=lambda row: missed(row, field))
        chosen |= {(scene, best.method)} | {(scene, row.method) for row in own if row.variant == "default"}
    return chosen


def figures(material: Material) -> dict[str, str]:
    """Work and precision by quantity."""
    drawn: dict[str, str] = {}
    for field, names in CHARTED.items():
        rows = [row for row in rows_of(material, names) if missed(row, field) < inf and row.cpu > 0]
        if rows:
            chosen = shown(rows, field)
            figure = work_precision(rows, lambda row, chosen=chosen: (row.scene, row.method) in chosen, field)
            drawn[f"work_{field}"] = svg(
                figure, f"Each engine as shipped and at its best: {field} error against CPU time"
            )
    return drawn


def _terms(material: Material) -> str:
    body = [
        [method_name(task.method), *(number(float(answer.array(name).max())) for name in ("with", "without"))]
        for task in TERMS
        if (answer := material.finished(task)) is not None
    ]
    header = ["method", "from the law with the velocity term", "from the law without it"]
    return markdown(header, body) if body else ""


def context(material: Material) -> Mapping[str, Any]:
    """Tables by name, each empty where nothing was run."""
    answers = {task: answer for task in MATRIX if (answer := material.finished(task)) is not None}
    return {
        "matrix": matrix(answers),
        "refused": sentences(answers),
        "terms": _terms(material),
        "absent": list(registry.ABSENT.values()),
    }


PAGE = Page(
    name=NAME,
    title="Engines side by side",
    lesson="What each engine builds, what it costs, how near it comes; and why engines of one order differ twentyfold.",
    companions=(FREE,),
    borrowed=BORROWED,
    cells=SWEPT,
    failures=EXPERIMENTS,
    figures=figures,
    context=context,
    tasks=(*MATRIX, *TERMS),
)
