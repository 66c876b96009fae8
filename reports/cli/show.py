"""`crosscheck list` and `crosscheck show`: what there is to run, and a scene's stored numbers, on the terminal."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Annotated

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
    refuse_file,
    with_folder,
)
from reports.model.ending import BadInput

if TYPE_CHECKING:
    from reference.scene import Scene
    from reports.cli.terminal import Terminal
    from reports.model.cells import Cell
    from reports.model.measure import Measurement


def list_command(scene: Scenes = None, engine: EngineName = None, variant: VariantName = None) -> None:
    """Scenes, engines and variants, and what is unsupported, with the reason."""
    from engines.registry import ENGINES, INSTALLED, method_name
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
    rows = sorted((cell.scene.name, method_name(cell.engine), why) for cell, why in reasons.items() if why)
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
    """Print a scene's stored numbers: every run, order and plateau, which setting is enough, and its experiments."""
    from reports.cli.known import registered, with_remembered, with_words
    from reports.cli.selection import choose_cells, choose_engines, choose_scenes
    from reports.cli.terminal import telling
    from reports.run.store import Store

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
    refuse_file(results)
    nothing = BadInput(f"{results} holds nothing for {scene!r} and the present sources: {command}")
    if not there:
        raise nothing
    engines = choose_engines(None if given else engine, variant, given or known.engines)
    with Store.read(results / STORE) as store:
        found = store.get(choose_cells(chosen, engines, known.pages, full=True))
    if not found:
        raise nothing
    with telling(140, as_json, as_markdown) as console:
        console.keep(found.values())
        for one in chosen:
            page = next((page for page in known.pages if page.teaches(one)), None)
            _print_scene(console, one, found, page.quantity if page else "angle")
        for page in known.pages:
            for failure in page.failures if any(page.is_run_with(one) for one in chosen) else ():
                runs = [found[cell] for cell in failure.cells if cell in found]
                if runs:
                    _print_runs(console, failure.title, runs)


def _print_scene(console: Terminal, scene: Scene, rows: Mapping[Cell, Measurement], quantity: str) -> None:
    """Every run of a scene, order and plateau, and the settings that are enough for errors of this quantity."""
    from reports.cli.terminal import print_table
    from reports.model.convergence import judged, sweeps
    from reports.model.quantities import QUANTITIES
    from reports.write import page_tables
    from reports.write.tables import order_rows

    grid = [row for cell, row in rows.items() if cell.scene == scene and cell.purpose in ("sweep", "usual")]
    beside = [row for cell, row in rows.items() if cell.scene == scene and cell.purpose == "beside"]
    judged_rows = judged(grid, quantity)
    _print_runs(console, f"{scene.name}, {scene.source}", [*judged_rows, *beside])
    orders = order_rows(sweeps(judged_rows), [each.name for each in QUANTITIES])
    header = ["method", *(f"{each.label}: order, plateau [{each.unit}]" for each in QUANTITIES)]
    advice_header, advice = page_tables.advice_lines(page_tables.advice(judged_rows, quantity), quantity)
    for title, head, lines, left in (
        ("order and plateau", header, orders, 9),
        ("which setting for which accuracy", advice_header, advice, 3),
    ):
        plain = [[cell.replace("**", "") for cell in line] for line in lines]
        print_table(console, f"{scene.name}: {title}", head, plain, left)
        console.print()


def _print_runs(console: Terminal, title: str, rows: Sequence[Measurement]) -> None:
    from reports.cli.terminal import print_table
    from reports.write.tables import ERROR_HEADER, error_rows, step_words

    print_table(console, title, ERROR_HEADER, error_rows(rows), 2)
    for row in rows:
        if row.sentence:
            console.tell(f"{row.method}, {step_words(row.step)}: {row.outcome}: {row.sentence}")
    console.print()
