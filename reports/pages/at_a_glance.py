"""The short table of all engines at the top of the index, and the engines that are not compared."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from functools import cache
from math import isfinite
from pathlib import Path

from engines import registry
from reports.model.convergence import ENOUGH_POINTS, Verdict, sweeps
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.pages.engines.page import MATRIX
from reports.pages.engines.page import PAGE as ENGINES_PAGE
from reports.write.columns import ACCEPTED_CPU, Column, EngineLine, absence_reason, error_within, within_budget
from reports.write.tables import DASH, markdown, number

ELEMENTS = {"closes a loop": "loop", "skate": "skate", "rolls": "disc rolls on a line"}
FACTS = {"reactions": "reactions", "precision": "width"}
ORDER_SCENE = "free_four_bar"


@cache
def sentences() -> Mapping[str, Mapping[str, str]]:
    """The tables "engines" and "absent" of `at_a_glance.toml`. A table maps the name of an engine to a sentence."""
    return tomllib.loads(Path(__file__).with_name("at_a_glance.toml").read_text(encoding="utf-8"))


def glance_table(pages: Mapping[Page, Material], lines: Sequence[EngineLine], scenes: Mapping[str, str]) -> str:
    """A Markdown table with a row for each registered engine; empty if no task of the page "engines" was run. lines:
    rows of the compared scenes. scenes: name of a compared scene -> title."""
    material = next((material for page, material in pages.items() if page.name == ENGINES_PAGE.name), Material({}))
    answers = {task.method.name: answer for task in MATRIX if (answer := material.finished(task)) is not None}
    if not answers:
        return ""
    by_engine = {(line.engine, line.scene.name): line for line in lines}
    body = []
    for engine in dict.fromkeys(engine.name for engine in (*registry.VARIANTS, *registry.OTHERS)):
        values = answers[engine].values if engine in answers else {}
        built = [str(values.get(key, DASH)) for key in (*ELEMENTS.values(), *FACTS.values())]
        errors = [_least_error(by_engine.get((engine, name))) for name in scenes]
        order = _order(by_engine.get((engine, ORDER_SCENE)))
        body.append([engine, *built, *errors, order, sentences()["engines"].get(engine, DASH)])
    header = ["engine", *ELEMENTS, *FACTS, *(f"error, {title}" for title in scenes.values()), "order", "know this"]
    return markdown(header, body, left=len(header))


def _least_error(line: EngineLine | None) -> str:
    built = [column for column in line.columns if not absence_reason(line, column)] if line is not None else []
    if line is None or not built:
        return DASH
    methods = [rows for column in built for _, rows in line.columns[column]]
    least = min(error_within(rows, line.quantity, ACCEPTED_CPU) for rows in methods)
    return number(least) if isfinite(least) else within_budget(line, built[0])


def _order(line: EngineLine | None) -> str:
    """The order of convergence of an engine as shipped, its plateau, or a dash. Several methods give the best order."""
    column = Column.SHIPPED if line is not None and Column.SHIPPED in line.columns else Column.WHOLE
    if line is None or column not in line.columns:
        return DASH
    rows = [row for _, of_method in line.columns[column] for row in of_method]
    found = sweeps(rows, (quantity(line.quantity),))
    plateaus = [sweep.plateau for sweep in found if sweep.verdict is Verdict.PLATEAU]
    orders = [sweep.order for sweep in found if sweep.verdict is not Verdict.PLATEAU and sweep.points >= ENOUGH_POINTS]
    if orders:
        return f"{max(orders):.1f}"
    return f"plateau {number(min(plateaus))}" if plateaus else DASH
