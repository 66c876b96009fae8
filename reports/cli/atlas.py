"""`crosscheck atlas`: maps of the outcomes of methods over the step and a parameter of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated

import typer

from engines.registry import VARIANTS
from reports.cli.options import FOLDER, STORE, Folder, Scheduler, Workers, listed
from reports.cli.report import published, refuse_outside_a_checkout, write_files
from reports.cli.terminal import Terminal, interruptible, opened
from reports.model.cells import Cell
from reports.model.measure import Measurement
from reports.pages.atlas.maps import FILE, MAPS, as_csv, columns_of, read, run_columns, stored_column
from reports.run import cluster
from reports.run.running import run_into

MAP_LIMIT = 600.0  # Limit of CPU seconds for one cell. All known cells need far less time.
STRIDE = 4  # Every fourth step is run first. Steps between two equal outcomes are left out.
SMALL = 16  # Maps with fewer points along a side are run completely.
VARIANTS_SHOWN = ("default", "tuned")
ATLAS = "atlas"  # Name of the folder with the columns of the maps, inside the folder of results.


def atlas(
    scenes: Annotated[str | None, typer.Option(help="Maps by name, with commas between; all if none is named.")] = None,
    points: Annotated[int, typer.Option(min=2, max=200, help="Of a map, along each side.")] = 40,
    every_point: Annotated[
        bool, typer.Option("--every-point", help="Do not leave out the steps between two of equal outcomes.")
    ] = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    results: Folder = FOLDER,
    publish: Annotated[
        bool, typer.Option("--publish", help="Write the file from which the published page is made, too.")
    ] = False,
) -> None:
    """Map where methods fail, over the step and a parameter of the scene. A full run does not include the maps."""
    known = {stability_map.name: stability_map for stability_map in MAPS}
    names = tuple(known) if scenes is None else listed("--scenes", [scenes], known)
    if publish:
        refuse_outside_a_checkout()
    engines = tuple(engine for engine in VARIANTS if engine.variant in VARIANTS_SHOWN)
    columns = [column for name in names for column in columns_of(known[name], engines, points)]
    terminal, run_now = Terminal(140), 0
    with cluster.connect_cluster(scheduler, workers) as crew, opened(results / STORE) as store:

        def run(cells: list[Cell]) -> Mapping[Cell, Measurement]:
            nonlocal run_now
            with interruptible(terminal, store, cells, MAP_LIMIT, "cells") as (waiting, done, watch):
                run_now += len(waiting)
                run_into(store, waiting, False, MAP_LIMIT, crew.threads, done, watch, False, crew.supervise)
            return store.get(cells)

        rows = run_columns(columns, run, 1 if every_point or points < SMALL else STRIDE)
    stored = [stored_column(column, of_column) for column, of_column in zip(columns, rows, strict=True)]
    cells = sum(column.run_count for column in stored)
    for folder in (results / ATLAS, *([published()] if publish else [])):
        others = [column for column in read(folder / FILE) if column.subject not in names]
        write_files({folder / FILE: as_csv([*stored, *others])}, f"{cells} cells written to {folder / FILE}")
    terminal.say(f"{run_now} of {cells} cells were run, the others were stored")
