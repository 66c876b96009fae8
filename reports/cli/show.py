"""`crosscheck list` and `crosscheck show`: what there is to run, and a scene's stored numbers, on the terminal."""

from __future__ import annotations

import shlex
from typing import Annotated

import typer

from reports.cli.options import (
    FOLDER,
    REFERENCES,
    STORE,
    AsJson,
    AsMarkdown,
    EngineName,
    Folder,
    Scenes,
    Settings,
    VariantName,
    with_folder,
)
from reports.model.ending import BadInput


def list_command(scene: Scenes = None, engine: EngineName = None, variant: VariantName = None) -> None:
    """Scenes, engines and variants, and what is unsupported, with the reason."""
    from engines.registry import ENGINES, INSTALLED, method
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_engines, choose_scenes
    from reports.cli.terminal import Terminal, print_table
    from reports.model.catalogue import page_of
    from reports.model.cells import Cell
    from reports.run.running import support

    known, names, given = with_words(registered(), scene or (), engine)
    scenes = choose_scenes(names, known.scenes, known.pages)
    named = given or ((*ENGINES, *INSTALLED) if engine is None else known.engines)
    engines = choose_engines(None if given else engine, variant, named)
    console = Terminal(140)
    taught = {one: page.name if (page := page_of(one, known.pages)) else "" for one in scenes}
    rows = [(one.name, taught[one], one.source, f"{one.duration:.4g}") for one in scenes]
    print_table(console, "Scenes", ["scene", "page", "source", "duration [s]"], rows, 3)
    console.print()
    print_table(
        console, "Engines", ["engine", "variant", "settings"], [(e.name, e.variant, repr(e)) for e in engines], 3
    )
    console.print()
    reasons = support([Cell(one, each, 1) for one in scenes for each in engines])
    # Sorted: workers answer in any order.
    rows = sorted((cell.scene.name, method(cell.engine), why) for cell, why in reasons.items() if why)
    if rows:
        print_table(console, "Unsupported", ["scene", "method", "why"], rows, 3)
    else:
        console.print("Every engine variant builds every scene.")


def show(
    scene: Annotated[str, typer.Argument(help=f"A scene or a page by name, or {REFERENCES}.")],
    engine: EngineName = None,
    variant: VariantName = None,
    settings: Settings = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Print a scene's stored numbers."""
    from reports.cli.known import registered, with_remembered, with_words
    from reports.cli.selection import choose_engines, choose_scenes, grid_engines
    from reports.cli.terminal import print_table, telling
    from reports.model.cells import FULL, sweep_cells
    from reports.model.convergence import judged, sweeps
    from reports.model.quantities import QUANTITIES
    from reports.run.store import Store
    from reports.write.tables import ERROR_HEADER, error_rows, order_rows

    known = registered()
    remembered: tuple[str, ...] = ()
    there = (results / STORE).exists()
    if there:
        with Store.read(results / STORE) as store:
            remembered = store.remembered()
    known, names, given = with_words(with_remembered(known, remembered), [scene], engine, settings or ())
    chosen = choose_scenes(names, known.scenes, known.pages)
    words = shlex.join([scene, *(f"--set={each}" for each in settings or ())])
    command = with_folder(f"crosscheck run {words}", results)
    nothing = BadInput(f"{results} holds nothing for {scene!r} and the present sources: {command}")
    if not there:
        raise nothing
    engines = choose_engines(None if given else engine, variant, given or known.engines)
    cells = [c for one in chosen for c in sweep_cells((one,), grid_engines(one, engines, known.pages), FULL)]
    with Store.read(results / STORE) as store:
        rows = judged(store.get(cells).values())
    if not rows:
        raise nothing
    with telling(140, as_json, as_markdown) as console:
        console.keep(rows)
        for one in chosen:
            own = [row for row in rows if row.scene == one.name]
            print_table(console, f"{one.name}, {one.source}", ERROR_HEADER, error_rows(own), 2)
            console.print()
            names = [q.name for q in QUANTITIES]
            orders = [[cell.replace("**", "") for cell in line] for line in order_rows(sweeps(own), names)]
            header = ["method", *(f"{q.label}: order, plateau [{q.unit}]" for q in QUANTITIES)]
            print_table(console, f"{one.name}: order and plateau", header, orders, 9)
