"""`crosscheck run` runs the cells that are not stored yet and shows the progress."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, NamedTuple

import typer

from engines import method_name
from engines.lagrange.loading import COMPILING_NOTE, is_cold
from reports.cli.known import choose
from reports.cli.options import (
    FOLDER,
    STORE,
    AsJson,
    AsMarkdown,
    DeviceName,
    EngineName,
    Every,
    Folder,
    Scenes,
    Scheduler,
    Settings,
    VariantName,
    Workers,
    choose_device,
    with_folder,
)
from reports.cli.selection import choose_cells, choose_tasks, grid_engines, left_out
from reports.cli.terminal import Terminal, interruptible, opened, print_table, telling
from reports.model.cells import Cell
from reports.model.convergence import judged
from reports.model.ending import BadInput, Broken
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.tasks import Task
from reports.run import cluster
from reports.run.running import TIME_LIMIT, run_into
from reports.run.store import Store
from reports.write.row_tables import SUMMARY_HEADER, summary_rows


def run(
    scene: Scenes = None,
    engine: EngineName = None,
    variant: VariantName = None,
    settings: Settings = None,
    full: Annotated[
        bool | None, typer.Option("--full/--quick", help="Fine steps and stability maps too; --quick is the default.")
    ] = None,
    pages: Annotated[bool, typer.Option("--pages", help="Like --full, without rows that no page prints.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run again what is already stored.")] = False,
    every: Every = None,
    step: Annotated[list[float] | None, typer.Option(help="Only this step [s]; must divide the sampling.")] = None,
    limit: Annotated[float, typer.Option(help="CPU seconds after which a cell is ended.")] = TIME_LIMIT,
    workers: Workers = None,
    scheduler: Scheduler = None,
    device: DeviceName = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Run the cells that are not stored yet. An interrupted run can be continued."""
    choose_device(device)
    if not 0 < limit < float("inf"):
        raise BadInput(f"--limit is {limit}; it must be a finite number of seconds greater than zero")
    if pages and full is not None:
        raise BadInput(f"--pages and --{'full' if full else 'quick'} are different choices of cells; give one of them")
    names, own = scene or (), settings or ()
    chosen = select(names, engine, variant, own, bool(full or pages), every or (), step or (), pages)
    items = chosen.items
    with telling(140, as_json, as_markdown) as console:
        with cluster.connect_cluster(scheduler, workers) as crew, opened(results / STORE) as store:
            store.save_references(chosen.references)
            count = run_interruptible(console, store, items, fresh, limit, crew)
            rows = list(store.get(chosen.cells).values())
            print_summary(console, rows)
        for cell, why in chosen.left_out:
            method = method_name(cell.engine)
            words = f"{cell.scene.name}, {method}: no step of {cell.step:.4g} s, since {why}"
            console.tell(f"{words}; --every {cell.every} runs it")
        refuse_without_motion(rows)
        following = with_folder("crosscheck report", results)
        console.say(f"{count} of {len(items)} cells run, the others were stored. Next: {following}")
        refuse_nothing_but_failures(rows)


class Selected(NamedTuple):
    cells: tuple[Cell, ...]
    items: Sequence[Cell | Task]  # The cells, and the tasks of pages.
    references: list[str]
    left_out: list[tuple[Cell, str]]  # Cells of a named engine that are in the grid and are not run, with the reason.


def select(
    scenes: Sequence[str] = (),
    engine: str | None = None,
    variant: str | None = None,
    settings: Sequence[str] = (),
    full: bool = False,
    every: Sequence[int] = (),
    steps: Sequence[float] = (),
    printed: bool = False,
) -> Selected:
    """What `crosscheck run` runs with these options. A run with selected steps [s], or with selected numbers `every` of
    steps between samples, has no tasks, and neither has a quick run of named scenes. printed: see `choose_cells`.
    Raises BadInput."""
    choice = choose(scenes, engine, variant, settings)
    known, given = choice.known, (choice.scenes, choice.engines, choice.known.pages, full)
    alone, is_named, at_steps = bool(scenes) and not full, engine is not None, bool(every or steps)
    cells = choose_cells(*given, every, steps, named=is_named, alone=alone, printed=printed)
    if not (items := (*cells, *(() if at_steps or alone else choose_tasks(*given)))):
        compared = (method for scene in choice.scenes for method in grid_engines(scene, known.engines, known.pages))
        methods = ", ".join(dict.fromkeys(map(method_name, compared)))
        longer = "" if full else "; --full has what takes longer"
        raise BadInput(f"nothing to run: pages compare these methods in what is named: {methods}{longer}")
    omitted = left_out(*given, cells) if is_named and not at_steps else []
    return Selected(cells, items, [reference.text() for reference in known.references], omitted)


def run_grid(
    chosen: Selected, results: Path = FOLDER, workers: int | None = None, fresh: bool = False
) -> list[Measurement]:
    """The rows of the selected cells. Cells that are not stored in `results` are run. Raises BadInput."""
    by = cluster.pool(workers)
    with Store(results / STORE) as store:
        store.save_references(chosen.references)
        run_into(store, chosen.items, fresh, TIME_LIMIT, by.threads, supervised=by.supervise)
        rows = list(store.get(chosen.cells).values())
    refuse_without_motion(rows)
    return rows


def refuse_without_motion(rows: Sequence[Measurement]) -> None:
    """Raise BadInput if every cell was refused, since the parameters of the scenes are then invalid."""
    if rows and all(row.outcome == Outcome.REFUSED for row in rows):
        raise BadInput(rows[0].sentence)


def run_interruptible(
    console: Terminal,
    store: Store,
    items: Sequence[Cell | Task],
    fresh: bool,
    limit: float,
    crew: cluster.Workforce | None = None,
) -> int:
    """Run cells and tasks, show the progress, and return the number of items run. All processors are used by default.
    After Ctrl-C it prints a line about the stored rows and raises KeyboardInterrupt."""
    by = crew or cluster.pool(None)
    if is_cold() and any(isinstance(item, Task) or "numba" in item.engine.packages for item in items):
        print(COMPILING_NOTE, file=sys.stderr)
    with interruptible(console, store, items, limit, "cells", fresh) as (waiting, done, watch):
        return run_into(store, waiting, True, limit, by.threads, done, watch, supervised=by.supervise)


def refuse_nothing_but_failures(rows: Sequence[Measurement]) -> None:
    """Raise Broken if every cell has failed, was aborted or has timed out."""
    if rows and all(Outcome(row.outcome).grade == 3 for row in rows):
        raise Broken(f"none of {len(rows)} cells gave a motion; the first {rows[0].outcome}: {rows[0].sentence}")


def print_summary(console: Terminal, rows: list[Measurement]) -> None:
    judged_rows = judged(rows)
    console.keep(judged_rows)
    for scene in dict.fromkeys(row.scene for row in judged_rows if row.purpose == "sweep"):
        lines = summary_rows([row for row in judged_rows if row.scene == scene])
        print_table(console, scene, SUMMARY_HEADER, lines, 1)
        console.print()
    extra = Counter(str(row.outcome) for row in rows if row.purpose != "sweep")
    if extra:
        console.tell("Failure experiments and maps: " + ", ".join(f"{n} {o}" for o, n in sorted(extra.items())))
