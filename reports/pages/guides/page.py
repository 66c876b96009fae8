"""Guides without scenes of their own: the words, and which settings to take; their numbers are stored rows."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from engines import Engine, lagrange, method_name, mujoco, pymunk
from reference.scenes.four_bar.scenes import FreeFourBar
from reports.model.cells import FULL, sweep_cells
from reports.model.page import Material, Page
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.write.rows import lookups
from reports.write.tables import markdown, number

FOLDER = Path(__file__).parent
FOUR_BAR = FreeFourBar()
# The scene's samples are 1e-2 s apart, so that this many steps a sample make steps of a millisecond.
EVERY = 10
ENGINES: tuple[Engine, ...] = tuple(dict.fromkeys([*mujoco.METHODS, *pymunk.METHODS, *lagrange.VARIANTS]))


def table(material: Material) -> str:
    """Errors, order, plateau and cost of each method that has a row at a millisecond; empty if none has."""
    known = lookups(material, (FOUR_BAR,))
    body = []
    for engine in ENGINES:
        asked = (FOUR_BAR.name, engine.name, engine.variant)
        row, sweep = known["at"](*asked, EVERY), known["sweep"](*asked)
        if row:
            numbers = (row.angle, sweep.order, sweep.plateau, row.reaction, 1e3 * row.cpu)
            body.append([method_name(engine), *map(number, numbers)])
    header = ["method", "angle [rad]", "order", "plateau [rad]", "reaction", "CPU [ms/s]"]
    return markdown(header, body) if body else ""


def context(material: Material) -> Mapping[str, Any]:
    """The table, and the functions that look up single rows."""
    return {**lookups(material, (FOUR_BAR,)), "table": table(material)}


PAGES = (
    Page(
        name="glossary",
        title="Glossary",
        lesson="The words of these pages, each in a sentence or two, and how to read their charts and tables.",
        template=FOLDER / "glossary.md",
    ),
    YOUR_LOOP,
    Page(
        name="settings",
        title="Settings",
        lesson="Which integrator, how stiff a loop, and how to read a reaction.",
        engines=ENGINES,
        borrowed=sweep_cells((FOUR_BAR,), ENGINES, FULL),
        template=FOLDER / "settings.md",
        context=context,
    ),
)
