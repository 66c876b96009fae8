"""The glossary, and the page on settings with numbers from stored rows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from engines import Engine, lagrange, method_name, mujoco, pymunk
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import FULL, sweep_cells
from reports.model.page import Material, Page
from reports.pages.your_loop.experiments import MILLISECONDS_PER_SAMPLE
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.write.rows import lookups
from reports.write.tables import markdown, number

GUIDES = Path(__file__).parent
SETTINGS_LOOP = FreeFourBar()
LOOP_METHODS: tuple[Engine, ...] = tuple(dict.fromkeys([*mujoco.METHODS, *pymunk.METHODS, *lagrange.VARIANTS]))


def table(material: Material) -> str:
    """A Markdown table with the errors, the order, the plateau and the cost of each method that has a row at 1 ms."""
    look_up = lookups(material, (SETTINGS_LOOP,))
    body = []
    for engine in LOOP_METHODS:
        method = (SETTINGS_LOOP.name, engine.name, engine.variant)
        row, sweep = look_up["at"](*method, MILLISECONDS_PER_SAMPLE), look_up["sweep"](*method)
        if row:
            numbers = (row.angle, sweep.order, sweep.plateau, row.reaction, 1e3 * row.cpu)
            body.append([method_name(engine), *map(number, numbers)])
    header = ["method", "angle [rad]", "order", "plateau [rad]", "reaction", "CPU [ms/s]"]
    return markdown(header, body) if body else ""


def context(material: Material) -> Mapping[str, Any]:
    return {**lookups(material, (SETTINGS_LOOP,)), "table": table(material)}


PAGES = (
    Page(
        name="glossary",
        title="Glossary",
        lesson="The terms of these pages, each in a sentence or two, and how to read their charts and tables.",
        template=GUIDES / "glossary.md",
    ),
    YOUR_LOOP,
    Page(
        name="settings",
        title="Settings",
        lesson="Which integrator, how stiff a loop, and how to read a reaction.",
        engines=LOOP_METHODS,
        borrowed=sweep_cells((SETTINGS_LOOP,), LOOP_METHODS, FULL),
        template=GUIDES / "settings.md",
        context=context,
    ),
)
