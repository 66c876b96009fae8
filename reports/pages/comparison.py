"""The first comparison of all engines, extras among them: one linkage and one skate, at equal CPU time."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from engines import registry
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.plots.engines_compared import Compared, engines_compared
from reports.plots.theme import svg
from reports.write.columns import WITHIN, Column, Line, error_within, lines, reached, runs_of
from reports.write.tables import NOTHING, markdown, number

PICTURE = "compared.svg"
SCENES = {"free_four_bar": "four-bar", "sleigh": "skate"}
COLUMNS = (Column.SHIPPED, Column.SETTINGS, Column.CODE)
MILLISECOND = 1e-3  # s


def compared_lines(pages: Mapping[Page, Material]) -> list[Line]:
    """A line for each of SCENES and each engine that has rows of it on any page."""
    found: list[Line] = []
    for name in SCENES:
        page = next((page for page in pages if name in {scene.name for scene in page.scenes}), None)
        if page is None:
            continue
        scene = next(scene for scene in page.scenes if scene.name == name)
        rows: dict[tuple[str, int], Measurement] = {}
        for material in pages.values():
            for cell, row in material.rows.items():
                if cell.scene == scene and cell.samples is None and cell.purpose in ("sweep", "beside"):
                    rows[row.method, row.every] = replace(row, purpose="sweep")
        whole = replace(page, scenes=(scene,), engines=(*page.engines, *registry.OTHERS))
        found += lines([(whole, list(rows.values()))])
    return found


def absent(line: Line, column: Column) -> bool:
    """Whether the engine has no way to hold the scene's joints in this column."""
    rows = [row for _, own in line.columns.get(column, ()) for row in own]
    return not rows or all(row.outcome == Outcome.UNSUPPORTED for row in rows)


def picture(found: list[Line]) -> str:
    """The SVG text; empty without rows."""
    rows = []
    for name, title in SCENES.items():
        own = [line for line in found if line.scene.name == name]
        if not own:
            continue
        places = {
            column: [(line, Column.WHOLE if Column.WHOLE in line.columns else column) for line in own]
            for column in COLUMNS
        }
        told = quantity(own[0].name)
        rows.append(
            Compared(
                title,
                f"largest {told.label} error [{told.unit}]",
                {
                    column: {
                        line.engine: reached([rows for _, rows in line.columns.get(place, ())], line.name)
                        for line, place in each
                    }
                    for column, each in places.items()
                },
                {
                    column: [line.engine for line, place in each if absent(line, place)]
                    for column, each in places.items()
                    if column is not Column.CODE  # not every engine has a variant with our code
                },
            )
        )
    if not rows:
        return ""
    return svg(engines_compared(rows), "All engines on a four-bar and on a skate: error against CPU time")


def table(found: list[Line]) -> str:
    """A line an engine and scene: the error within BUDGET in each column, and in brackets that at a millisecond."""
    body = []
    for line in found:
        cells = []
        for column in COLUMNS:
            if column not in line.columns:
                cells.append("*no such joint*" if Column.WHOLE not in line.columns else NOTHING)
                continue
            cells.append(_cell(line, column))
        if Column.WHOLE in line.columns:
            cells[-1] = _cell(line, Column.WHOLE)
        body.append([SCENES[line.scene.name], line.engine, *cells])
    return markdown(["scene", "engine", *COLUMNS], body, left=5) if body else ""


def _cell(line: Line, column: Column) -> str:
    methods = line.columns[column]
    if absent(line, column):
        return "*no such joint*"
    least = min(error_within(rows, line.name, WITHIN) for _, rows in methods)
    at_cost = number(least) if math.isfinite(least) else NOTHING
    engine, rows = methods[-1]
    row = next((row for row in rows if abs(row.step - MILLISECOND) < 0.01 * MILLISECOND), None)
    at_step = NOTHING if row is None else number(getattr(row, line.name))
    if row is not None and not Outcome(row.outcome).comparable:
        at_step = str(row.outcome)
    runs = runs_of(engine, line.scene, MILLISECOND)
    return f"{at_cost} ({at_step}{'; ' + runs if runs else ''})"
