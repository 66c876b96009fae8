"""The index of the pages with findings, symptoms and comparisons of engines, and the generated part of the readme."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from math import isfinite
from pathlib import Path
from types import MappingProxyType
from typing import Any

from engines import Engine, registry
from reports.model.cells import USUAL_STEPS, is_step
from reports.model.convergence import ENOUGH_POINTS, Verdict, judged, sweeps
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.model.quantities import quantity
from reports.pages.engines.page import MATRIX
from reports.pages.engines.page import PAGE as ENGINES_PAGE
from reports.pages.findings import findings
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.plots.theme import svg
from reports.plots.work_precision import ComparedRow, engines_compared
from reports.write import columns as engine_tables
from reports.write import unmeasured
from reports.write.columns import ACCEPTED_CPU, Column, EngineLine, absence_reason, error_within, within_budget
from reports.write.page_tables import COMPARED_STEP, TARGETS
from reports.write.provenance import machine, versions
from reports.write.row_tables import error_words
from reports.write.tables import DASH, markdown, number
from reports.write.templates import environment, inert_page, link, with_part


@dataclass(frozen=True)
class Symptom:
    """A symptom that a user sees, a short answer, and the page with the explanation. `heading`: heading on this page,
    or ""."""

    seen: str
    answer: str
    page: str
    heading: str


@cache
def symptoms() -> tuple[Symptom, ...]:
    _, _, *lines = Path(__file__).with_name("symptoms.md").read_text(encoding="utf-8").splitlines()
    return tuple(Symptom(*(cell.strip() for cell in line.strip("|").split("|"))) for line in lines)


def foot(command: str, engines: Iterable[Engine] = ()) -> str:
    """The last line of a page. The line states the versions of the registered engines and of `engines`."""
    return f"Made by `{command}` with {versions(engines)}; timings on {machine()}."


def engines_of(pages: Iterable[Page]) -> list[Engine]:
    return list(dict.fromkeys(engine for page in pages for engine in page.engines))


COMPARED_PICTURE = "compared.svg"
COMPARED_SCENES = {"free_four_bar": "four-bar", "sleigh": "skate"}  # name -> title
COMPARED_COLUMNS = (Column.SHIPPED, Column.SETTINGS, Column.CODE)


def compared_lines(pages: Mapping[Page, Material]) -> list[EngineLine]:
    """A line for each scene in COMPARED_SCENES and each engine with rows of this scene, extras included."""
    lines: list[EngineLine] = []
    for name in COMPARED_SCENES:
        for page, scene in [(teaching, scene) for teaching in pages for scene in teaching.scenes if scene.name == name]:
            rows = {
                (row.method, row.every): replace(row, purpose="sweep")
                for material in pages.values()
                for cell, row in material.rows.items()
                if cell.scene == scene and cell.samples is None and cell.purpose in ("sweep", "beside")
            }
            with_extras = replace(page, scenes=(scene,), engines=(*page.engines, *registry.OTHERS))
            lines += engine_tables.engine_lines([(with_extras, list(rows.values()))])
    return lines


def compared_picture(lines: Sequence[EngineLine]) -> str:
    """An SVG picture of the least error against CPU time, by scene and kind of method; empty without lines."""
    rows = []
    for name, title in COMPARED_SCENES.items():
        of_scene = [line for line in lines if line.scene.name == name]
        if not of_scene:
            continue
        errors: dict[str, dict[str, Any]] = {}
        absent: dict[str, dict[str, list[str]]] = {}
        for column in COMPARED_COLUMNS:
            pairs = [(line, Column.WHOLE if Column.WHOLE in line.columns else column) for line in of_scene]
            errors[column] = {
                line.engine: engine_tables.error_by_cost(
                    [rows for _, rows in line.columns.get(filled, ())], line.quantity
                )
                for line, filled in pairs
            }
            if column is not Column.CODE:  # an engine may have no variant with our code
                absent[column] = {
                    reason: [
                        line.engine for line, filled in pairs if engine_tables.absence_reason(line, filled) == reason
                    ]
                    for reason in (engine_tables.NO_JOINT, engine_tables.NOT_BUILT)
                }
        rows.append(ComparedRow(title, f"largest {quantity(of_scene[0].quantity).heading}", errors, absent))
    if not rows:
        return ""
    return svg(engines_compared(rows), "All engines on a four-bar and on a skate: error against CPU time")


def compared_table(lines: Sequence[EngineLine]) -> str:
    """A Markdown table of errors by scene and engine: within CPU_BUDGET and, in brackets, at COMPARED_STEP."""
    body = []
    for line in lines:
        has_one_column = Column.WHOLE in line.columns
        cells = [
            _compared_cell(line, Column.WHOLE if has_one_column and column is COMPARED_COLUMNS[-1] else column)
            for column in COMPARED_COLUMNS
        ]
        body.append([COMPARED_SCENES[line.scene.name], line.engine, *cells])
    return markdown(["scene", "engine", *COMPARED_COLUMNS], body, left=5) if body else ""


def _compared_cell(line: EngineLine, column: Column) -> str:
    if column not in line.columns and (Column.WHOLE in line.columns or column is Column.CODE):
        return DASH  # the engine has no variant of this kind
    if reason := engine_tables.absence_reason(line, column):
        return f"*{reason}*"
    engine, rows = line.columns[column][-1]
    at_step = error_words(next((row for row in rows if is_step(row.step, COMPARED_STEP)), None), line.quantity)
    runs = engine_tables.describe_inner_runs(engine, line.scene, COMPARED_STEP)
    in_brackets = f"({at_step}; {runs})" if runs else f"({at_step})"
    return f"{engine_tables.within_budget(line, column)} {in_brackets}{engine_tables.remarks_of(line, column)}"


def render_index(pages: Mapping[Page, Material], command: str, files: Mapping[str, str] = MappingProxyType({})) -> str:
    """The text of the index. The index has links only to pages in `pages` and to `files`."""
    entries = [
        (page, judged([*material.sweep(page.scenes), *material.usual(page.scenes)], page.quantity))
        for page, material in pages.items()
    ]
    names = {page.name for page in pages}
    lines = compared_lines(pages)
    text = (
        environment()
        .get_template("index.md")
        .render(
            pages=list(pages),
            titles={page.name: page.title for page in pages},
            findings=findings(pages),
            symptoms=[
                (symptom, link(symptom.page, symptom.heading, files)) for symptom in symptoms() if symptom.page in names
            ],
            compared=compared_table(lines),
            glance=glance_table(pages, lines, COMPARED_SCENES),
            absent_engines=sentences()["absent"],
            equal_cost=engine_tables.equal_cost(entries),
            equal_error=engine_tables.equal_error(entries),
            equal_step=engine_tables.equal_step(entries),
            budget=1e3 * engine_tables.CPU_BUDGET,
            targets=TARGETS,
            steps=list(USUAL_STEPS),
            outcomes=list(Outcome),
            files=files,
            foot=foot(command, engines_of(pages)),
        )
    )
    return inert_page(unmeasured.without_marks(text))


def render_readme(text: str, pages: Mapping[Page, Material]) -> str:
    """The readme with its generated part, which has the lines of the page `your_loop` and their errors. Raises
    ValueError if the readme lacks the marks around this part."""
    material = next((material for page, material in pages.items() if page.name == YOUR_LOOP.name), Material({}))
    part = environment().get_template(f"{YOUR_LOOP.name}/readme.md").render(dict(YOUR_LOOP.context(material)))
    return with_part(text, "loop", unmeasured.without_marks(part).strip())


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
