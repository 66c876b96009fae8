"""`crosscheck run`: the cells that are not stored yet, with a bar of progress, or a line now and then into a file."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING, Annotated

import typer

from reports.cli.options import (
    FOLDER,
    STORE,
    AsJson,
    AsMarkdown,
    EngineName,
    Every,
    Folder,
    Scenes,
    Scheduler,
    Settings,
    VariantName,
    Workers,
    with_folder,
)
from reports.model.ending import BadInput, Broken

if TYPE_CHECKING:
    from reports.cli.terminal import Terminal
    from reports.model.cells import Cell
    from reports.model.measure import Measurement
    from reports.model.tasks import Task
    from reports.run.cluster import Workforce
    from reports.run.store import Store


def run(
    scene: Scenes = None,
    engine: EngineName = None,
    variant: VariantName = None,
    settings: Settings = None,
    full: Annotated[bool, typer.Option("--full/--quick", help="Fine steps and stability maps too.")] = False,
    fresh: Annotated[bool, typer.Option("--fresh", help="Run again what is already stored.")] = False,
    every: Every = None,
    step: Annotated[list[float] | None, typer.Option(help="Only this step [s]; must divide the sampling.")] = None,
    limit: Annotated[float, typer.Option(help="CPU seconds after which a cell is ended.")] = 60.0,
    workers: Workers = None,
    scheduler: Scheduler = None,
    as_json: AsJson = False,
    as_markdown: AsMarkdown = False,
    results: Folder = FOLDER,
) -> None:
    """Run the cells that are not stored yet; what is done survives an interruption."""
    from engines import method_name
    from reports.cli.known import registered, with_words
    from reports.cli.selection import choose_cells, choose_engines, choose_scenes, choose_tasks, grid_engines, left_out
    from reports.cli.terminal import opened, telling
    from reports.run.cluster import elsewhere, pool

    if not 0 < limit < float("inf"):
        raise BadInput(f"--limit is {limit}; it must be a finite number of seconds greater than zero")
    known, names, given = with_words(registered(), scene or (), engine, settings or ())
    scenes = choose_scenes(names, known.scenes, known.pages)
    engines = choose_engines(None if given else engine, variant, given or known.engines)
    alone = bool(scene) and not full
    cells = choose_cells(
        scenes, engines, known.pages, full, every or (), step or (), named=engine is not None, alone=alone
    )
    # Steps that are named are asked of the grid alone; a quick run of scenes that are named, of nothing but these.
    items = cells if every or step or alone else (*cells, *choose_tasks(scenes, engines, known.pages, full))
    if not items:
        compared = (each for scene in scenes for each in grid_engines(scene, known.engines, known.pages))
        methods = ", ".join(dict.fromkeys(method_name(each) for each in compared))
        longer = "" if full else "; --full has what takes longer"
        raise BadInput(f"nothing to run: pages compare these methods in what is named: {methods}{longer}")
    with telling(140, as_json, as_markdown) as console:
        with elsewhere(scheduler) as crew, opened(results / STORE) as store:
            store.remember(each.text() for each in known.given)
            count = run_interruptible(console, store, items, fresh, limit, crew or pool(workers))
            rows = list(store.get(cells).values())
            print_summary(console, rows)
        if engine is not None and not (every or step):
            for cell, why in left_out(scenes, engines, known.pages, full, cells):
                method = method_name(cell.engine)
                told = f"{cell.scene.name}, {method}: no step of {cell.step:.4g} s, since {why}"
                console.tell(f"{told}; --every {cell.every} runs it")
        following = with_folder("crosscheck report", results)
        refuse_without_motion(rows)
        console.say(f"{count} of {len(items)} cells run, the others were stored. Next: {following}")
        refuse_nothing_but_failures(rows)


def refuse_without_motion(rows: Sequence[Measurement]) -> None:
    """Raises BadInput if the numbers of the scenes were refused in every cell."""
    from reports.model.outcomes import Outcome

    if rows and all(row.outcome == Outcome.REFUSED for row in rows):
        raise BadInput(rows[0].sentence)


def run_interruptible(
    console: Terminal,
    store: Store,
    items: Sequence[Cell | Task],
    fresh: bool,
    limit: float,
    crew: Workforce | None = None,
) -> int:
    """Run cells and tasks with a bar of progress, by `crew` or all processors; how many were run.

    Raises KeyboardInterrupt, having said what is stored.
    """
    from engines.lagrange.loading import is_cold
    from reports.cli.terminal import interruptible
    from reports.run.cluster import pool
    from reports.run.running import run_into

    by = crew or pool(None)
    if is_cold():
        print("compiling the judge's machine code, once for this installation: up to two minutes", file=sys.stderr)
    with interruptible(console, store, items, limit, "cells", fresh) as (waiting, done, watch):
        return run_into(store, waiting, True, limit, by.threads, done, watch, supervised=by.supervise)


def refuse_nothing_but_failures(rows: Sequence[Measurement]) -> None:
    """Raises Broken where no cell gave anything: each failed, was aborted or ran out of time."""
    from reports.model.outcomes import Outcome

    if rows and all(Outcome(row.outcome).grade == 3 for row in rows):
        raise Broken(f"none of {len(rows)} cells gave a motion; the first {rows[0].outcome}: {rows[0].sentence}")


def print_summary(console: Terminal, rows: list[Measurement]) -> None:
    """A table a scene, a line a method; then what became of the experiments outside the sweeps."""
    from reports.cli.terminal import print_table
    from reports.model.convergence import judged
    from reports.write.tables import SUMMARY_HEADER, summary_rows

    told = judged(rows)
    console.keep(told)
    for scene in dict.fromkeys(row.scene for row in told if row.purpose == "sweep"):
        print_table(console, scene, SUMMARY_HEADER, summary_rows([row for row in told if row.scene == scene]), 1)
        console.print()
    extra = Counter(str(row.outcome) for row in rows if row.purpose != "sweep")
    if extra:
        console.tell("Failure experiments and maps: " + ", ".join(f"{n} {o}" for o, n in sorted(extra.items())))
