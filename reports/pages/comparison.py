"""The first comparison of all engines, extras among them: one linkage and one skate, at equal CPU time."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from engines import registry
from reports.model.cells import is_step
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.plots.theme import svg
from reports.plots.work_precision import ComparedRow, engines_compared
from reports.write.columns import (
    NO_JOINT,
    NOT_BUILT,
    Column,
    Line,
    empty,
    lines,
    means,
    reached,
    runs_of,
    within_budget,
)
from reports.write.page_tables import COMPARED
from reports.write.tables import NOTHING, error_words, markdown

PICTURE = "compared.svg"
SCENES = {"free_four_bar": "four-bar", "sleigh": "skate"}
COLUMNS = (Column.SHIPPED, Column.SETTINGS, Column.CODE)


def compared_lines(pages: Mapping[Page, Material]) -> list[Line]:
    """A line for each of SCENES and each engine that has rows of it on any page."""
    found: list[Line] = []
    for name in SCENES:
        for page, scene in [(each, scene) for each in pages for scene in each.scenes if scene.name == name]:
            rows = {
                (row.method, row.every): replace(row, purpose="sweep")
                for material in pages.values()
                for cell, row in material.rows.items()
                if cell.scene == scene and cell.samples is None and cell.purpose in ("sweep", "beside")
            }
            whole = replace(page, scenes=(scene,), engines=(*page.engines, *registry.OTHERS))
            found += lines([(whole, list(rows.values()))])
    return found


def picture(found: list[Line]) -> str:
    """The SVG text; empty without rows."""
    panels = []
    for name, title in SCENES.items():
        of_scene = [line for line in found if line.scene.name == name]
        if not of_scene:
            continue
        errors: dict[str, dict[str, Any]] = {}
        lacking: dict[str, dict[str, list[str]]] = {}
        for column in COLUMNS:
            pairs = [(line, Column.WHOLE if Column.WHOLE in line.columns else column) for line in of_scene]
            errors[column] = {
                line.engine: reached([rows for _, rows in line.columns.get(place, ())], line.name)
                for line, place in pairs
            }
            if column is not Column.CODE:  # not every engine has a variant with our code
                lacking[column] = {
                    word: [line.engine for line, place in pairs if empty(line, place) == word]
                    for word in (NO_JOINT, NOT_BUILT)
                }
        panels.append(ComparedRow(title, f"largest {quantity(of_scene[0].name).axis}", errors, lacking))
    if not panels:
        return ""
    return svg(engines_compared(panels), "All engines on a four-bar and on a skate: error against CPU time")


def table(found: list[Line]) -> str:
    """A line an engine and scene: the error within BUDGET in each column, and in brackets that at a millisecond."""
    body = []
    for line in found:
        whole = Column.WHOLE in line.columns
        cells = [_cell(line, Column.WHOLE if whole and column is COLUMNS[-1] else column) for column in COLUMNS]
        body.append([SCENES[line.scene.name], line.engine, *cells])
    return markdown(["scene", "engine", *COLUMNS], body, left=5) if body else ""


def _cell(line: Line, column: Column) -> str:
    if column not in line.columns and (Column.WHOLE in line.columns or column is Column.CODE):
        return NOTHING  # no variant of this kind
    if word := empty(line, column):
        return f"*{word}*"
    engine, rows = line.columns[column][-1]
    at_step = error_words(next((row for row in rows if is_step(row.step, COMPARED)), None), line.name)
    runs = runs_of(engine, line.scene, COMPARED)
    return f"{within_budget(line, column)} ({at_step}{'; ' + runs if runs else ''}){means(line, column)}"
