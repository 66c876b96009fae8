"""`crosscheck list` prints the scenes and engines. `crosscheck show` prints the stored numbers of a scene."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from typing import Annotated

import typer

from engines.registry import ENGINES, INSTALLED, method_name
from reference.scene import Scene
from reports.cli.known import choose, registered, with_stored
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
from reports.cli.selection import choose_cells, choose_engines
from reports.cli.terminal import Terminal, print_table, telling
from reports.model.catalogue import page_of
from reports.model.cells import Cell
from reports.model.convergence import judged, sweeps
from reports.model.ending import BadInput
from reports.model.measure import Measurement
from reports.model.quantities import QUANTITIES
from reports.pages.errata.page import engine_rows, slip_rows
from reports.run.running import support
from reports.run.store import Store
from reports.write import page_tables
from reports.write.row_tables import ERROR_HEADER, error_rows, order_rows
from reports.write.tables import step_words


def list_command(scene: Scenes = None, engine: EngineName = None, variant: VariantName = None) -> None:
    """List scenes, engines and variants, and unsupported combinations with the reason."""
    choice = choose(scene or (), engine, variant)
    engines = choice.engines if engine is not None else choose_engines(None, variant, (*ENGINES, *INSTALLED))
    terminal, scenes = Terminal(140), choice.scenes
    pages = {listed: page.name if (page := page_of(listed, choice.known.pages)) else "" for listed in scenes}
    rows = [(listed.name, pages[listed], listed.source, f"{listed.duration:.4g}") for listed in scenes]
    print_table(terminal, "Scenes", ["scene", "page", "source", "duration [s]"], rows, 3)
    terminal.print()
    rows = [(method.name, method.variant, repr(method)) for method in engines]
    print_table(terminal, "Engines", ["engine", "variant", "settings"], rows, 3)
    terminal.print()
    reasons = support([Cell(listed, method, 1) for listed in scenes for method in engines])
    # The rows are sorted, since workers answer in any order.
    rows = sorted((cell.scene.name, method_name(cell.engine), reason) for cell, reason in reasons.items() if reason)
    if rows:
        print_table(terminal, "Unsupported", ["scene", "method", "why"], rows, 3)
    else:
        terminal.print("Every engine variant builds every scene.")


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
    available, is_there = registered(), (results / STORE).exists()
    if is_there:
        with Store.read(results / STORE) as store:
            available = with_stored(available, store.load_references())
    choice = choose([scene], engine, variant, settings or (), available)
    refuse_file(results)
    stored: Mapping[Cell, Measurement] = {}
    if is_there:
        with Store.read(results / STORE) as store:
            stored = store.get(choose_cells(choice.scenes, choice.engines, choice.known.pages, full=True))
    if not stored:
        text = shlex.join([scene, *(f"--set={setting}" for setting in settings or ())])
        command = with_folder(f"crosscheck run {text}", results)
        raise BadInput(f"{results} holds nothing for {scene!r} and the present sources: {command}")
    with telling(140, as_json, as_markdown) as terminal:
        terminal.keep(stored.values())
        for single in choice.scenes:
            page = next((page for page in choice.known.pages if page.teaches(single)), None)
            _print_scene(terminal, single, stored, page.quantity if page else "angle")
        for page in choice.known.pages:
            for failure in page.failures if any(page.is_run_with(single) for single in choice.scenes) else ():
                if runs := [stored[cell] for cell in failure.cells if cell in stored]:
                    _print_runs(terminal, failure.title, runs)


def _print_scene(terminal: Terminal, scene: Scene, rows: Mapping[Cell, Measurement], quantity: str) -> None:
    grid = [row for cell, row in rows.items() if cell.scene == scene and cell.purpose in ("sweep", "usual")]
    beside = [row for cell, row in rows.items() if cell.scene == scene and cell.purpose == "beside"]
    judged_rows = judged(grid, quantity)
    _print_runs(terminal, f"{scene.name}, {scene.source}", [*judged_rows, *beside])
    orders = order_rows(sweeps(judged_rows), [entry.name for entry in QUANTITIES])
    header = ["method", *(f"{entry.label}: order, plateau [{entry.unit}]" for entry in QUANTITIES)]
    advice_header, advice = page_tables.advice_lines(page_tables.advice(judged_rows, quantity), quantity)
    for title, head, lines, left_aligned in (
        ("order and plateau", header, orders, 9),
        ("which setting for which accuracy", advice_header, advice, 3),
    ):
        plain = [[cell.replace("**", "") for cell in line] for line in lines]
        print_table(terminal, f"{scene.name}: {title}", head, plain, left_aligned)
        terminal.print()


def _print_runs(terminal: Terminal, title: str, rows: Sequence[Measurement]) -> None:
    print_table(terminal, title, ERROR_HEADER, error_rows(rows), 2)
    for row in rows:
        if row.sentence:
            terminal.tell(f"{row.method}, {step_words(row.step)}: {row.outcome}: {row.sentence}")
    terminal.print()


VALUES = ("printed, and its value", "right, and its value", "derivative, and all values' unit", "verdict")
ENGINES_HEADER = ("no.", "engine", "its motion", "unit", "printed misses by", "right misses by")
CAUCHY = "The derivative is that of a position (11: of a velocity; 19: the loop's closure), by Cauchy's integral."


def errata(
    number: Annotated[list[int] | None, typer.Argument(help="Only these numbers of the list of errata.")] = None,
    engines: Annotated[bool, typer.Option("--engines", help="What engines say of it too (some seconds).")] = False,
) -> None:
    """The chapter's printed slips: each formula's value as printed and as it must be, and what decides."""
    rows = slip_rows()
    known = [int(row[0]) for row in rows]
    if unknown := [word for word in number or () if word not in known]:
        raise BadInput(f"no slip has the number {unknown[0]}; there are {', '.join(map(str, known))}")
    terminal, chosen = Terminal(150), number or known
    header = ("no.", "where", *VALUES)
    print_table(terminal, "Printed slips of the chapter", header, [r for r in rows if int(r[0]) in chosen], len(header))
    terminal.print(f"\n{CAUCHY}")
    if engines:
        rows, lost = engine_rows()
        terminal.print()
        print_table(terminal, "Engines as referees", ENGINES_HEADER, [r for r in rows if int(r[0]) in chosen], 4)
        for sentence in lost:
            terminal.print(sentence, markup=False)
