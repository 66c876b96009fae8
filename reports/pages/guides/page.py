"""Guides without scenes of their own: words, reactions, integrators, clusters; their numbers are stored rows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

from engines import Engine, lagrange, mujoco, pymunk
from reference.scene import Scene
from reference.scenes.four_bar.scenes import FreeFourBar
from reference.scenes.skates.sleigh import ChaplyginSleigh
from reports.model.cells import FULL, sweep_cells
from reports.model.page import Material, Page
from reports.pages.your_loop.page import PAGE as YOUR_LOOP
from reports.write.rows import lookups
from reports.write.tables import markdown, number

FOLDER = Path(__file__).parent
FOUR_BAR, SLEIGH = FreeFourBar(), ChaplyginSleigh()
SCENES: tuple[Scene, ...] = (FOUR_BAR, SLEIGH)
# Both scenes' samples are 1e-2 s apart, so that this many steps a sample make steps of a millisecond.
EVERY = 10

VARIANTS: tuple[Engine, ...] = (*pymunk.VARIANTS, pymunk.LEAPFROG, *mujoco.VARIANTS, *lagrange.VARIANTS)
INTEGRATORS: tuple[Engine, ...] = tuple(dict.fromkeys([*mujoco.METHODS, *pymunk.METHODS]))


def table(material: Material, scene: Scene, engines: Iterable[Engine], quantity: str) -> str:
    """Order, plateau, errors and cost of each method that has a row at a millisecond; empty if none has."""
    known = lookups(material, (scene,))
    body = []
    for engine in engines:
        asked = (scene.name, engine.name, engine.variant)
        row, sweep = known["at"](*asked, EVERY), known["sweep"](*asked, quantity)
        if row:
            numbers = (sweep.order, sweep.plateau, row.angle, row.reaction, 1e3 * row.cpu)
            body.append([f"{engine.name} {engine.variant}", str(row.outcome), *map(number, numbers)])
    header = ["method", "outcome", "order", "plateau", "angle [rad]", "reaction", "CPU [ms per simulated s]"]
    return markdown(header, body) if body else ""


def words(engines: Iterable[Engine], scenes: Iterable[Scene], quantity: str, material: Material) -> Mapping[str, Any]:
    """The tables by scene, and what asks for single rows."""
    tables = {scene.name: table(material, scene, engines, quantity) for scene in scenes}
    return {**lookups(material, scenes), "tables": {name: text for name, text in tables.items() if text}}


def guide(
    name: str,
    title: str,
    lesson: str,
    engines: tuple[Engine, ...] = (),
    scenes: tuple[Scene, ...] = (),
    quantity: str = "angle",
) -> Page:
    """A guide with these rows; none for a page of words."""
    given: Callable[[Material], Mapping[str, Any]] = partial(words, engines, scenes, quantity)
    return Page(
        name=name,
        title=title,
        lesson=lesson,
        scenes=(),
        engines=(),
        borrowed=sweep_cells(scenes, engines, FULL),
        template=FOLDER / f"{name}.md",
        words=given,
    )


PAGES = (
    YOUR_LOOP,
    guide("glossary", "Glossary", "The words of these pages, each in a sentence or two."),
    guide(
        "reactions",
        "How to read reactions",
        "What an engine says of its joints' forces, how to read it with the right sign, and how accurate it is.",
        VARIANTS,
        SCENES,
        "reaction",
    ),
    guide(
        "integrators",
        "Which integrator when",
        "What MuJoCo's integrators and pymunk's single scheme give on one closed loop, and when to take which.",
        INTEGRATORS,
        (FOUR_BAR,),
    ),
    guide("cluster", "More than one machine", "How to run cells, searches and the failure atlas on a Dask cluster."),
)
