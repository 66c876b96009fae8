"""`crosscheck run` runs the cells that are not stored yet and shows the progress."""

from __future__ import annotations

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated

import typer

from engines import method_name
from engines.lagrange.loading import COMPILING_NOTE, is_cold
from reports.cli.known import Choice, choose
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
    full: Annotated[bool, typer.Option("--full/--quick", help="Fine steps and stability maps too.")] = False,
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
    chosen = Selection(
        tuple(scene or ()), engine, variant, tuple(settings or ()), full, tuple(every or ()), tuple(step or ()), limit
    )
    items = chosen.items
    with telling(140, as_json, as_markdown) as console:
        with cluster.connect_cluster(scheduler) as crew, opened(results / STORE) as store:
            store.save_references(chosen.references)
            count = run_interruptible(console, store, items, fresh, limit, crew or cluster.pool(workers))
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


@dataclass(frozen=True)
class Selection:
    """The options of `crosscheck run` that choose cells. All properties may raise BadInput."""

    scenes: tuple[str, ...] = ()  # Names of scenes or pages, or references. An empty tuple means all scenes.
    engine: str | None = None
    variant: str | None = None
    settings: tuple[str, ...] = ()  # "NAME=VALUE" for parameters of the scenes.
    full: bool = False
    every: tuple[int, ...] = ()  # Selected numbers of steps between samples.
    steps: tuple[float, ...] = ()  # Selected steps [s].
    limit: float = TIME_LIMIT  # Limit of CPU seconds for a cell.

    def __post_init__(self) -> None:
        if not 0 < self.limit < float("inf"):
            raise BadInput(f"--limit is {self.limit}; it must be a finite number of seconds greater than zero")

    @cached_property
    def choice(self) -> Choice:
        return choose(self.scenes, self.engine, self.variant, self.settings)

    @property
    def references(self) -> list[str]:
        return [reference.text() for reference in self.choice.known.references]

    @property
    def _alone(self) -> bool:
        return bool(self.scenes) and not self.full

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        scenes, engines, pages = self.choice.scenes, self.choice.engines, self.choice.known.pages
        named = self.engine is not None
        return choose_cells(scenes, engines, pages, self.full, self.every, self.steps, named=named, alone=self._alone)

    @cached_property
    def items(self) -> Sequence[Cell | Task]:
        """The selected cells and tasks. A run with selected steps, and a quick run of named scenes, has no tasks."""
        known, scenes = self.choice.known, self.choice.scenes
        only_cells = self.every or self.steps or self._alone
        tasks = () if only_cells else choose_tasks(scenes, self.choice.engines, known.pages, self.full)
        if not (items := (*self.cells, *tasks)):
            compared = (method for scene in scenes for method in grid_engines(scene, known.engines, known.pages))
            methods = ", ".join(dict.fromkeys(map(method_name, compared)))
            longer = "" if self.full else "; --full has what takes longer"
            raise BadInput(f"nothing to run: pages compare these methods in what is named: {methods}{longer}")
        return items

    @property
    def left_out(self) -> list[tuple[Cell, str]]:
        """(cell, reason) for the cells of a named engine that are in the grid and are not run."""
        if self.engine is None or self.every or self.steps:
            return []
        pages = self.choice.known.pages
        return left_out(self.choice.scenes, self.choice.engines, pages, self.full, self.cells)


def run_grid(
    chosen: Selection, results: Path = FOLDER, workers: int | None = None, fresh: bool = False
) -> list[Measurement]:
    """The rows of the selected cells. Cells that are not stored in `results` are run. Raises BadInput."""
    by = cluster.pool(workers)
    with Store(results / STORE) as store:
        store.save_references(chosen.references)
        run_into(store, chosen.items, fresh, chosen.limit, by.threads, supervised=by.supervise)
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
    if is_cold(adaptive=False) and any(isinstance(item, Task) or "numba" in item.engine.packages for item in items):
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
