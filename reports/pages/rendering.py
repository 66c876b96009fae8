"""Renders the texts of all pages, pictures and tables by file name, from stored rows and answers."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
from datetime import UTC, datetime
from types import MappingProxyType
from typing import Any

from engines import Engine, method_name
from reference.scene import Scene
from reports.gate.prediction import declared_error
from reports.model import catalogue
from reports.model.cells import Cell
from reports.model.convergence import judged
from reports.model.measure import Measurement
from reports.model.page import Material, Page
from reports.pages.atlas.maps import MAPS
from reports.pages.findings import findings, pictures
from reports.pages.index import COMPARED_PICTURE, compared_lines, compared_picture, engines_of, render_index
from reports.plots import work_precision as charts
from reports.plots.theme import svg
from reports.write import page_tables, unmeasured
from reports.write.columns import describe_inner_runs, enforcement_by_method, with_displayed_variants
from reports.write.csv_files import as_csv, descriptions_csv
from reports.write.experiments import render_experiment
from reports.write.page_tables import advised_programs
from reports.write.provenance import machine, row_versions, versions
from reports.write.templates import inert_page, template_of


def scene_context(scene: Scene, rows: list[Measurement], page: Page, material: Material) -> dict[str, Any]:
    """The variables of one scene for the page's template; tables are empty without rows."""
    engines = {method_name(engine): engine for engine in page.engines_of(scene)}

    def declared(method: str, step: float) -> float:
        if method not in engines:
            return math.nan
        return declared_error(material.answers, scene, engines[method], page.quantity, step)

    enforcement = enforcement_by_method(Cell(scene, engine, 1) for engine in engines.values())
    exported = enforcement.get("mujoco tuned") == "engine"
    enforcement = enforcement if set(enforcement.values()) != {"engine"} else {}
    featured = [row for row in rows if page.featured(row)]
    step = page_tables.compared_step(rows)
    inner_runs = {
        method: runs for method, engine in engines.items() if (runs := describe_inner_runs(engine, scene, step))
    }
    advice = page_tables.advice(rows, page.quantity, tuple(engines))
    table = page_tables.scene_table(featured, page.quantity, enforcement, declared, inner_runs) if featured else ""
    return {
        "name": scene.name,
        "missing": not rows,
        "step": step,
        "table": table,
        "advice": page_tables.advice_table(advice, page.quantity, enforcement) if rows else "",
        "exported": exported,  # whether a model file without our code describes the mechanism
        "programs": advised_programs(scene, advice, engines) if scene is page.advised_scene else [],
    }


def _charts(page: Page, rows: list[Measurement], material: Material) -> dict[str, str]:
    pictures_by_name: dict[str, str] = {}
    drawable = charts.drawable(rows, page.quantity)
    if any(row.cpu > 0 for row in drawable):
        figure = charts.work_precision(rows, page.featured, page.quantity)
        pictures_by_name["work"] = svg(figure, f"{page.title}: error against CPU time")
    if any(page.featured(row) for row in drawable):
        figure = charts.error_against_step(rows, page.featured, page.quantity)
        pictures_by_name["steps"] = svg(figure, f"{page.title}: error against step")
    return {**pictures_by_name, **page.figures(material)}


def render_page(page: Page, material: Material, command: str) -> dict[str, str]:
    """The page's Markdown and its SVG pictures, by file name. Raises jinja2.UndefinedError if the template uses a name
    that the page does not define."""
    material = replace(material, rows=with_displayed_variants(material.rows))
    rows = judged(material.sweep(page.scenes), page.quantity)
    drawings = _charts(page, rows, material)
    names = {name: f"{page.name}_{name}.svg" for name in drawings}
    scenes = [
        scene_context(scene, [row for row in rows if row.scene == scene.name], page, material) for scene in page.scenes
    ]
    context = {
        "page": page,
        "scenes": scenes,
        "advised": next((scenes[i] for i, scene in enumerate(page.scenes) if scene is page.advised_scene), None),
        # The program on the page imports the page by its name, so the page must be registered.
        "registered": page.name in {registered.name for registered in catalogue.PAGES},
        "pictures": unmeasured.MissingAsNaN(names),
        "failures": [render_experiment(failure, material) for failure in page.failures],
        "maps": [stability_map for stability_map in MAPS if stability_map.page == page.name],
        "foot": f"Made by `{command}`. Versions and machine: [index](index.md). Numbers: [errors.csv](errors.csv).",
        **page.context(material),
    }
    texts = {page.document: template_of(page).render(context)} | dict(page.further(material))
    files = {names[name]: text for name, text in drawings.items()}
    files |= {program.file: program.text for scene in scenes for program in scene["programs"] if program.text}
    return files | {name: inert_page(unmeasured.without_marks(text)) for name, text in texts.items()}


def render_all(
    pages: Mapping[Page, Material],
    command: str,
    further: Mapping[str, str] = MappingProxyType({}),
    rendered: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
) -> dict[str, str]:
    """Every file of the results by name. On another machine only timings.csv and the columns of CPU time differ.

    Args:
        further: other files, to which the index can link.
        rendered: results of `render_page` that exist already, by the page's name.
    """
    files: dict[str, str] = dict(further)
    rows: dict[str, Measurement] = {}
    engines: dict[str, Engine] = {}
    for page, material in pages.items():
        files.update(rendered[page.name] if page.name in rendered else render_page(page, material, command))
        # If a cell belongs to an experiment and to a sweep, errors.csv has the row of the sweep.
        rows.update({row.key: row for row in material.rows.values() if row.purpose == "sweep" or row.key not in rows})
        engines.update({row.key: cell.engine for cell, row in material.rows.items()})
    files |= pictures(findings(pages))
    if drawing := compared_picture(compared_lines(pages)):
        files[COMPARED_PICTURE] = drawing
    files["index.md"] = render_index(pages, command, files)
    # A stored row is used only if its versions are installed, so the installed versions are those of the row.
    by_engine = {engine: row_versions(engine) for engine in dict.fromkeys(engines.values())}
    made_with = {key: by_engine[engine] for key, engine in engines.items()}
    files["errors.csv"] = as_csv(rows.values(), timings=False, made_with=made_with)
    header = f"{datetime.now(UTC):%Y-%m-%d}\n{machine()}\n{versions(engines_of(pages))}\n{command}\n"
    header += "CPU seconds: cpu per simulated second; build once"
    files["descriptions.csv"] = descriptions_csv(rows.values(), made_with)
    files["timings.csv"] = as_csv(rows.values(), timings=True, header=header)
    return files
