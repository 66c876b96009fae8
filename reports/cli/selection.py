"""The scenes, engines, cells and tasks that a command line selects. Errors suggest the most similar known name."""

from __future__ import annotations

import math
from collections.abc import Sequence

from engines import Engine
from reference.checks import LARGEST_COUNT
from reference.scene import Scene
from reports.gate.prediction import all_tasks, described_tasks
from reports.model.cells import FULL, QUICK, Cell, beside_cells, estimated_seconds, sweep_cells, too_much, usual_cells
from reports.model.ending import BadInput, nearest
from reports.model.page import Page
from reports.model.tasks import Task

# Longest estimated time of a cell in a quick run [s], except for the shortest cell of each method in each scene. A
# quick run of everything takes about twenty seconds on two cores.
QUICK_SECONDS = 0.02
QUICK_CELL = 0.1  # Longest estimated time [s] of the shortest cell, of a task, and of a cell in `crosscheck versions`.


def choose_scenes(words: Sequence[str], scenes: Sequence[Scene], pages: Sequence[Page]) -> tuple[Scene, ...]:
    """The scenes with these names, or on pages with these names. No names select all scenes. Raises BadInput."""
    if not words:
        return tuple(scenes)
    taught = {scene: [page.name for page in pages if page.teaches(scene)] for scene in scenes}
    possible = dict.fromkeys(
        [*(scene.name for scene in scenes), *(name for names in taught.values() for name in names)]
    )
    for name in words:
        if name not in possible:
            raise nearest("scene", name, possible)
    return tuple(scene for scene in scenes if {scene.name, *taught[scene]} & set(words))


def choose_engines(engine: str | None, variant: str | None, engines: Sequence[Engine]) -> tuple[Engine, ...]:
    """The engines with this name and this variant. None selects all names or variants. Raises BadInput."""
    from engines.registry import ABSENT

    if engine in ABSENT:
        raise BadInput(ABSENT[engine])
    named = tuple(candidate for candidate in engines if engine in (None, candidate.name))
    if engine is not None and not named:
        raise nearest("engine", engine, (candidate.name for candidate in engines), ABSENT)
    chosen = tuple(candidate for candidate in named if variant in (None, candidate.variant))
    if variant is not None and not chosen:
        kind = "variant" if engine is None else f"variant of {engine}"
        raise nearest(kind, variant, (candidate.variant for candidate in named))
    return chosen


def steps_per_sample(scene: Scene, step: float) -> int:
    """The number of steps of `step` [s] between two samples. Raises BadInput unless the number is an integer."""
    if not (math.isfinite(step) and step > 0):
        raise BadInput(f"step is {step!r} s; it must be a finite time greater than zero")
    ratio = scene.spacing / step
    if not ratio <= LARGEST_COUNT:
        raise BadInput(f"step is {step:g} s: {scene.name} would take {ratio:.3g} steps between two samples")
    every = max(1, round(ratio))
    # A step that is typed with ten digits counts as a divisor.
    if abs(ratio - every) > 1e-9 * ratio:
        raise BadInput(
            f"step {step:g} s does not divide the {scene.spacing:.10g} s between samples of {scene.name}; "
            f"{every} steps a sample would be --step {scene.spacing / every:.12g}, or --every {every}"
        )
    return every


def known_engines(pages: Sequence[Page]) -> tuple[Engine, ...]:
    """All installed engines of the registry, and of the grids, experiments and tasks of pages."""
    from engines.registry import ENGINES, INSTALLED

    compared = (engine for page in pages for engine in (*page.engines, *(c.engine for c in page.extra_cells())))
    of_tasks = (task.engine for page in pages for task in described_tasks(page) if task.engine is not None)
    named = dict.fromkeys([*ENGINES, *INSTALLED, *compared, *of_tasks])
    return tuple(engine for engine in named if not engine.missing)


def grid_engines(scene: Scene, engines: Sequence[Engine], pages: Sequence[Page]) -> tuple[Engine, ...]:
    """The engines that the scene's page compares. For a scene without a page, these are the engines in VARIANTS."""
    from engines.registry import VARIANTS

    compared = next((page.engines_of(scene) for page in pages if page.teaches(scene)), VARIANTS)
    return tuple(engine for engine in engines if engine in compared)


def _beside(engines: Sequence[Engine]) -> tuple[Engine, ...]:
    from engines.registry import OTHERS

    return tuple(engine for engine in engines if engine in OTHERS)


def choose_cells(
    scenes: Sequence[Scene],
    engines: Sequence[Engine],
    pages: Sequence[Page],
    full: bool,
    every: Sequence[int] = (),
    steps: Sequence[float] = (),
    named: bool = False,
    alone: bool = False,
    printed: bool = False,
) -> tuple[Cell, ...]:
    """The cells of the grid of these scenes, and of the experiments on their pages. Raises BadInput for invalid steps.

    full: whether all steps are run, also the steps that users choose. A quick run leaves out long cells. every, steps:
    these steps replace the grid. named: a quick run includes the shortest cell of each method even if it is long.
    alone: a quick run leaves out experiments in other scenes. printed: cells of engines outside the grid are left out
    unless a page lists them, since no page or chart shows their rows.
    """
    if every or steps:
        chosen: dict[Cell, None] = {}
        for scene in scenes:
            compared = (*grid_engines(scene, engines, pages), *_beside(engines))
            for count in dict.fromkeys([*every, *(steps_per_sample(scene, step) for step in steps)]):
                chosen.update((Cell(scene, engine, count), None) for engine in compared)
        return tuple(chosen)
    cells: list[Cell] = []
    for scene in scenes:
        compared = grid_engines(scene, engines, pages)
        cells += sweep_cells((scene,), compared, FULL if full else QUICK)
        cells += usual_cells((scene,), compared) if full else ()
        cells += () if printed else beside_cells((scene,), _beside(engines), named=named)
    cells += [
        cell
        for page in pages
        if any(page.is_run_with(scene) for scene in scenes)
        for cell in page.extra_cells()
        if cell.engine in engines and (full or (cell.purpose != "large" and not (alone and cell.scene not in scenes)))
    ]
    cells = list(dict.fromkeys(cells))
    return tuple(cells) if full else _quick(cells, named)


def left_out(
    scenes: Sequence[Scene], engines: Sequence[Engine], pages: Sequence[Page], full: bool, chosen: Sequence[Cell]
) -> list[tuple[Cell, str]]:
    """(cell, reason) for each cell in the grid that `choose_cells` has left out."""
    remaining, quick = set(chosen), f"and a quick run has {QUICK_SECONDS:g} s for a run"
    return [
        (cell, too_much(cell) or f"step_cost says {estimated_seconds(cell):.4g} s, {quick}")
        for scene in scenes
        for engine in grid_engines(scene, engines, pages)
        for cell in (Cell(scene, engine, every) for every in (FULL if full else QUICK))
        if cell not in remaining
    ]


def choose_tasks(
    scenes: Sequence[Scene], engines: Sequence[Engine], pages: Sequence[Page], full: bool
) -> tuple[Task, ...]:
    """The tasks of pages that are run with these scenes. Tasks of other engines are left out. A quick run leaves out
    tasks that take longer than QUICK_CELL."""
    tasks = (
        task
        for page in pages
        if any(page.is_run_with(scene) for scene in scenes)
        for task in all_tasks(page)
        if (task.engine is None or task.engine in engines) and (full or task.cost <= QUICK_CELL)
    )
    return tuple(dict.fromkeys(tasks))


def _quick(cells: Sequence[Cell], named: bool) -> tuple[Cell, ...]:
    """The cells of a quick run are all short cells, and each method's shortest cell if it takes at most QUICK_CELL. For
    an engine outside the grid only the longest of the short cells is run. The shortest cell of an engine that the user
    has `named` is always run. Times are estimated by the engines' formulas, so the choice does not depend on the
    machine."""
    groups: dict[tuple[Scene, Engine, str], list[Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.scene, cell.engine, cell.purpose), []).append(cell)
    chosen: set[Cell] = set()
    for (_, _, purpose), members in groups.items():
        ordered = sorted(members, key=estimated_seconds)
        short = [cell for cell in ordered if estimated_seconds(cell) <= QUICK_SECONDS]
        least = [cell for cell in ordered[:1] if named or estimated_seconds(cell) <= QUICK_CELL]
        if purpose != "beside":
            chosen.update((*short, *least))
        else:
            chosen.update(short[-1:] or (least if named else ()))
    return tuple(cell for cell in cells if cell in chosen)


def page_cells(page: Page) -> tuple[Cell, ...]:
    """All cells that a page runs. Cells of engines that are not installed are left out."""
    from engines.registry import INSTALLED

    cells: list[Cell] = []
    for scene in page.scenes:
        compared = page.engines_of(scene)
        cells += [*sweep_cells((scene,), compared, FULL), *usual_cells((scene,), compared)]
        cells += beside_cells((scene,), INSTALLED)
    return tuple(dict.fromkeys([*cells, *(cell for cell in page.extra_cells() if not cell.engine.missing)]))


def page_tasks(page: Page) -> tuple[Task, ...]:
    """All tasks of a page. Tasks of engines that are not installed are left out."""
    return tuple(task for task in all_tasks(page) if task.engine is None or not task.engine.missing)


def shown_cells(page: Page) -> tuple[Cell, ...]:
    """All cells whose rows a page can show, including borrowed cells and cells of engines that are not installed."""
    from engines.registry import OTHERS

    other_cells = (*beside_cells(page.scenes, OTHERS), *page.extra_cells())
    return tuple(dict.fromkeys([*page_cells(page), *other_cells, *page.borrowed]))
