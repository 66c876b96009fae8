"""A page's material to its files, as texts by file name; nothing here writes."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace
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
from reports.pages.atlas.subjects import SUBJECTS
from reports.pages.comparison import PICTURE, compared_lines, picture
from reports.pages.findings import findings, pictures
from reports.pages.index import engines_of, render_index
from reports.plots import work_precision as charts
from reports.plots.theme import svg
from reports.write import page_tables, unmeasured
from reports.write.columns import holders, runs_of, told_rows
from reports.write.csv_files import as_csv, descriptions_csv
from reports.write.experiments import told_experiment
from reports.write.page_tables import advised_programs
from reports.write.provenance import machine, row_versions, today, versions
from reports.write.templates import inert_page, template_of


def told_scene(scene: Scene, rows: list[Measurement], page: Page, material: Material) -> dict[str, Any]:
    """The scene's words and tables from the judged rows of its sweep; tables are empty without rows."""
    engines = {method_name(engine): engine for engine in page.engines_of(scene)}

    def declared(method: str, step: float) -> float:
        if method not in engines:
            return math.nan
        return declared_error(material.answers, scene, engines[method], page.quantity, step)

    held = holders(Cell(scene, engine, 1) for engine in engines.values())
    exported = held.get("mujoco tuned") == "engine"
    held = held if set(held.values()) != {"engine"} else {}
    featured = [row for row in rows if page.featured(row)]
    step = page_tables.compared_step(rows)
    runs = {method: told for method, engine in engines.items() if (told := runs_of(engine, scene, step))}
    advice = page_tables.advice(rows, page.quantity, tuple(engines))
    return {
        "name": scene.name,
        "missing": not rows,
        "step": step,
        "table": page_tables.scene_table(featured, page.quantity, held, declared, runs) if featured else "",
        "advice": page_tables.advice_table(advice, page.quantity, held) if rows else "",
        "exported": exported,  # whether a file of settings alone holds the joints
        "programs": advised_programs(scene, advice, engines) if scene is page.advised_scene else [],
    }


def render_page(page: Page, material: Material, command: str) -> dict[str, str]:
    """The page's Markdown and its SVG pictures, by file name.

    Raises jinja2.UndefinedError when the template names what the page does not give.
    """
    material = replace(material, rows=told_rows(material.rows))
    rows = judged(material.sweep(page.scenes), page.quantity)
    files: dict[str, str] = {}
    pictures: dict[str, str] = {}

    def keep(name: str, text: str) -> None:
        files[f"{page.name}_{name}.svg"] = text
        pictures[name] = f"{page.name}_{name}.svg"

    drawable = charts.drawable(rows, page.quantity)
    if any(row.cpu > 0 for row in drawable):
        keep(
            "work",
            svg(charts.work_precision(rows, page.featured, page.quantity), f"{page.title}: error against CPU time"),
        )
    if any(page.featured(row) for row in drawable):
        keep(
            "steps",
            svg(charts.error_against_step(rows, page.featured, page.quantity), f"{page.title}: error against step"),
        )
    for name, text in page.figures(material).items():
        keep(name, text)
    scenes = [
        told_scene(scene, [row for row in rows if row.scene == scene.name], page, material) for scene in page.scenes
    ]
    files |= {each.file: each.text for scene in scenes for each in scene["programs"] if each.text}
    given = {
        "page": page,
        "scenes": scenes,
        "advised": next((scenes[i] for i, scene in enumerate(page.scenes) if scene is page.advised_scene), None),
        "registered": page.name in {each.name for each in catalogue.PAGES},  # else its code is not found by its name
        "pictures": unmeasured.Known(pictures),
        "failures": [told_experiment(failure, material) for failure in page.failures],
        "maps": [subject for subject in SUBJECTS if subject.page == page.name],
        "foot": f"Made by `{command}`. Versions and machine: [index](index.md). Numbers: [errors.csv](errors.csv).",
        **page.context(material),
    }
    texts = {page.document: template_of(page).render(given)} | dict(page.further(material))
    return files | {name: inert_page(unmeasured.without_marks(text)) for name, text in texts.items()}


def render_all(
    pages: Mapping[Page, Material],
    command: str,
    further: Mapping[str, str] = MappingProxyType({}),
    made: Mapping[str, Mapping[str, str]] = MappingProxyType({}),
) -> dict[str, str]:
    """Every file of the results by name; only timings.csv and the pages' CPU columns differ between machines.

    `further`: files of another kind beside them, which the index may name. `made`: what `render_page` gives, by the
    names of the pages for which that was done already.
    """
    files: dict[str, str] = dict(further)
    rows: dict[str, Measurement] = {}
    made_by: dict[str, Engine] = {}
    for page, material in pages.items():
        files.update(made[page.name] if page.name in made else render_page(page, material, command))
        # What one page takes for an experiment is another's sweep: the file has it there.
        rows.update({row.key: row for row in material.rows.values() if row.purpose == "sweep" or row.key not in rows})
        made_by.update({row.key: cell.engine for cell, row in material.rows.items()})
    files |= pictures(findings(pages))
    if compared := picture(compared_lines(pages)):
        files[PICTURE] = compared
    files["index.md"] = render_index(pages, command, files)
    # A stored row counts only where the versions are those that it was made with, so these are its own.
    of_engine = {engine: row_versions(engine) for engine in dict.fromkeys(made_by.values())}
    own_versions = {key: of_engine[engine] for key, engine in made_by.items()}
    files["errors.csv"] = as_csv(rows.values(), timings=False, made_with=own_versions)
    made_with = versions(engines_of(pages))
    header = f"{today()}\n{machine()}\n{made_with}\n{command}\nCPU seconds: cpu per simulated second; build once"
    files["descriptions.csv"] = descriptions_csv(rows.values(), own_versions)
    files["timings.csv"] = as_csv(rows.values(), timings=True, header=header)
    return files
