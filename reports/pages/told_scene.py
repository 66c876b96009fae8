"""Everything that pages say of one scene, as words and tables ready for the templates."""

from __future__ import annotations

import math
from dataclasses import fields
from typing import Any

from reference.scene import Scene
from reports.gate.prediction import declared_error, soft_tasks
from reports.model.cells import Cell
from reports.model.convergence import sweeps
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page
from reports.write import page_tables, tables
from reports.write.holders import holders
from reports.write.programs import advised_settings, programs_of


def parameters(scene: Scene) -> str:
    """A table of the scene's fields, which are the only place where its numbers stand."""
    body = [[field.name, _value(getattr(scene, field.name))] for field in fields(scene)]  # type: ignore[arg-type]
    return tables.markdown(["parameter", "value"], body)


def _value(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, tuple):
        return "(" + ", ".join(map(_value, value)) + ")"
    return str(value)


def told_scene(scene: Scene, rows: list[Measurement], page: Page, material: Material) -> dict[str, Any]:
    """The scene's words and tables from the judged rows of its sweep; tables are empty without rows.

    `table` is the page's, of the methods that it features; the others are the data page's, of all methods.
    """
    engines = {f"{engine.name} {engine.variant}": engine for engine in page.engines_of(scene)}

    def declared(method: str, step: float) -> float:
        if method not in engines:
            return math.nan
        return declared_error(material.answers, scene, engines[method], page.quantity, step)

    held = holders(Cell(scene, engine, 1) for engine in engines.values())
    unsupported = [row for row in rows if row.outcome == Outcome.UNSUPPORTED]
    coarsest = min((row.every for row in unsupported), default=0)
    featured = [row for row in rows if page.featured(row)]
    advice = page_tables.advice(rows, page.quantity, tuple(engines))
    return {
        "name": scene.name,
        "source": scene.source,
        "summary": " ".join((type(scene).__doc__ or "").split("\n\n")[0].split()),
        "parameters": parameters(scene),
        "missing": not rows,
        "held": held,
        "declares": any(task in material.answers for task in soft_tasks(scene, tuple(engines.values()))),
        "step": page_tables.compared_step(rows),
        "table": page_tables.scene_table(featured, page.quantity, held, declared) if featured else "",
        "advice": page_tables.advice_table(advice, page.quantity, held) if rows else "",
        "settings": advised_settings(
            scene, advice, engines, programs_of(page) if scene is page.advised_scene else None
        ),
        "beside": page_tables.beside_table(material.beside([scene]), page.quantity),
        "work": tables.work_table(rows, page.quantity, held=held) if rows else "",
        "orders": tables.order_table(sweeps(rows), held=held) if rows else "",
        "reactions": tables.reaction_table(rows, held) if rows else "",
        "sizes": tables.size_table(rows),
        "errors": tables.error_table(rows, held),
        "unsupported": [(row.method, row.sentence) for row in unsupported if row.every == coarsest],
    }
