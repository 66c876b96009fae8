"""The scenes, engines and cells that a command line selects; an unknown name is refused with the nearest known one."""

from __future__ import annotations

import math
from collections.abc import Sequence

from engines import Engine
from reference.checks import LARGEST_COUNT
from reference.scene import Scene
from reports.gate.prediction import all_tasks
from reports.model.cells import FULL, QUICK, Cell, beside_cells, estimated_seconds, sweep_cells, too_much, usual_cells
from reports.model.ending import BadInput, nearest
from reports.model.page import Page
from reports.model.tasks import Task

# A quick run over everything takes about twenty seconds of two cores. For that no cell of it takes longer than
# QUICK_SECONDS, but for the shortest of each method in each scene: that one is left out only beyond QUICK_CELL, as
# tasks and cells of many versions are. By the formulas of engines and tasks alone [s].
QUICK_SECONDS = 0.02
QUICK_CELL = 0.1


def choose_scenes(words: Sequence[str], scenes: Sequence[Scene], pages: Sequence[Page]) -> tuple[Scene, ...]:
    """The scenes of these names, or of the pages of these names; all of them for no word. Raises BadInput."""
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
    """The engines of this name and variant; None takes all. Raises BadInput."""
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
    """How many steps [s] fit between two samples of a scene. Raises BadInput unless it is a whole number."""
    if not (math.isfinite(step) and step > 0):
        raise BadInput(f"step is {step!r} s; it must be a finite time greater than zero")
    ratio = scene.spacing / step
    if not ratio <= LARGEST_COUNT:
        raise BadInput(f"step is {step:g} s: {scene.name} would take {ratio:.3g} steps between two samples")
    every = max(1, round(ratio))
    # 1e-9: a step typed with ten digits or more is meant to divide.
    if abs(ratio - every) > 1e-9 * ratio:
        raise BadInput(
            f"step {step:g} s does not divide the {scene.spacing:.10g} s between samples of {scene.name}; "
            f"{every} steps a sample would be --step {scene.spacing / every:.12g}, or --every {every}"
        )
    return every


def known_engines(pages: Sequence[Page]) -> tuple[Engine, ...]:
    """Every engine that can be named: the registry's, those of a page's grid, those of its experiments."""
    from engines.registry import ENGINES, INSTALLED

    compared = (engine for page in pages for engine in (*page.engines, *(c.engine for c in page.extra_cells())))
    of_tasks = (task.engine for page in pages for task in all_tasks(page) if task.engine is not None)
    named = dict.fromkeys([*ENGINES, *INSTALLED, *compared, *of_tasks])
    return tuple(engine for engine in named if not engine.missing)


def grid_engines(scene: Scene, engines: Sequence[Engine], pages: Sequence[Page]) -> tuple[Engine, ...]:
    """The engines that the scene's page compares; for a scene without a page the variants of all scenes."""
    from engines.registry import VARIANTS

    compared = next((page.engines_of(scene) for page in pages if page.teaches(scene)), VARIANTS)
    return tuple(engine for engine in engines if engine in compared)


def _beside(engines: Sequence[Engine]) -> tuple[Engine, ...]:
    """The engines among these that are extras."""
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
) -> tuple[Cell, ...]:
    """The cells of a run: the grid, with the failures of the pages that teach these scenes; the steps that people
    use too if full.

    A quick run leaves out what would take long (`_quick`), but for the shortest cell of an engine that was `named` in a
    scene; with `alone`, experiments in other scenes too. `every` or `steps` replace the grid by these steps
    alone. Raises BadInput for steps that can't be.
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
        cells += beside_cells((scene,), _beside(engines))
    cells += [
        cell
        for page in pages
        if any(page.is_run_with(scene) for scene in scenes)
        for cell in page.extra_cells()
        if cell.engine in engines and (full or (cell.purpose != "large" and not (alone and cell.scene not in scenes)))
    ]
    cells = list(dict.fromkeys(cells))
    return tuple(cells) if full else _quick(cells, math.inf if named else QUICK_CELL)


def left_out(
    scenes: Sequence[Scene], engines: Sequence[Engine], pages: Sequence[Page], full: bool, chosen: Sequence[Cell]
) -> list[tuple[Cell, str]]:
    """The cells of the grid that are not among those chosen by `choose_cells`, each with the reason."""
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
    """The tasks of the pages that are run with these scenes, of these engines or of none.

    A quick run leaves out what would take longer than QUICK_CELL.
    """
    tasks = (
        task
        for page in pages
        if any(page.is_run_with(scene) for scene in scenes)
        for task in all_tasks(page)
        if (task.engine is None or task.engine in engines) and (full or task.cost <= QUICK_CELL)
    )
    return tuple(dict.fromkeys(tasks))


def _quick(cells: Sequence[Cell], most: float) -> tuple[Cell, ...]:
    """Those for which a quick run has the time: of an engine beside the grid one step, the finest that is short.

    Seconds are those of the engines' own formulas, so that the choice is the same everywhere, whatever was measured.
    """
    groups: dict[tuple[Scene, Engine, str], list[Cell]] = {}
    for cell in cells:
        groups.setdefault((cell.scene, cell.engine, cell.purpose), []).append(cell)
    chosen: set[Cell] = set()
    for (_, _, purpose), members in groups.items():
        ordered = sorted(members, key=estimated_seconds)
        short = [cell for cell in ordered if estimated_seconds(cell) <= QUICK_SECONDS]
        least = [cell for cell in ordered[:1] if estimated_seconds(cell) <= most]
        chosen.update(short[-1:] if purpose == "beside" else (*short, *least))
    return tuple(cell for cell in cells if cell in chosen)


def page_cells(page: Page) -> tuple[Cell, ...]:
    """All cells of a page, without those that it borrows from other pages."""
    from engines.registry import INSTALLED

    cells: list[Cell] = []
    for scene in page.scenes:
        compared = page.engines_of(scene)
        cells += [*sweep_cells((scene,), compared, FULL), *usual_cells((scene,), compared)]
        cells += beside_cells((scene,), INSTALLED)
    return tuple(dict.fromkeys([*cells, *(cell for cell in page.extra_cells() if not cell.engine.missing)]))


def page_tasks(page: Page) -> tuple[Task, ...]:
    """All tasks of a page, without those of engines that are not installed."""
    return tuple(task for task in all_tasks(page) if task.engine is None or not task.engine.missing)


def shown_cells(page: Page) -> tuple[Cell, ...]:
    """All cells whose rows a page can print: its own, those of engines that are not installed, and borrowed ones."""
    from engines.registry import OTHERS

    other_cells = (*beside_cells(page.scenes, OTHERS), *page.extra_cells())
    return tuple(dict.fromkeys([*page_cells(page), *other_cells, *page.borrowed]))
