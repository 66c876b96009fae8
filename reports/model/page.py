"""The parts of a page, and the data from which a page is rendered."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from engines import ConvergenceOrder, Engine
from reference.scene import Scene
from reference.trajectory import Trajectory
from reports.model.cells import FEATURED, Cell, Purpose
from reports.model.checks import Deviation
from reports.model.measure import Measurement
from reports.model.tasks import Answer, Motion, Task, trajectory_of


def no_context(material: Material) -> dict[str, Any]:
    return {}


@dataclass(frozen=True)
class Observation:
    """The outcome of a computation that is no cell, such as a stored motion or a method of the reference."""

    method: str
    setting: str
    outcome: str


@dataclass(frozen=True)
class Failure:
    """An experiment in which methods are expected to fail. `expected` and `remark` are templates with the variables of
    `context`. In a remark, `at(method, step)` is the row with the nearest step [s], and `count(outcome)` is the number
    of rows with this outcome. `count()` is the number of all rows. A clause within `if_measured` is left out if one of
    its numbers is missing."""

    title: str
    expected: str = ""  # The behaviour according to the reference.
    cells: tuple[Cell, ...] = ()  # Cells with the purpose "failure".
    observations: Callable[[Material], Sequence[Observation]] | None = None  # Uses answers.
    remark: str = ""  # Text about the outcomes.
    columns: tuple[str, ...] = ()  # Quantities with printed errors. The default is a grid of angle errors.
    tasks: tuple[Task, ...] = ()
    context: Callable[[Material], Mapping[str, Any]] = no_context
    claims: tuple[str, ...] = ()  # Expressions that are true if the remark is true (`reports.pages.claims`).


@dataclass(frozen=True)
class Material:
    """The data of a page: the stored rows of its cells, and the stored answers to its tasks."""

    rows: Mapping[Cell, Measurement]
    answers: Mapping[Task, Answer] = field(default_factory=dict)

    def finished(self, task: Task) -> Answer | None:
        answer = self.answers.get(task)
        return answer if answer is not None and answer.finished else None

    def unfinished(self, task: Task) -> str:
        """The reason why a task has no numbers, or a command that installs or runs it."""
        if answer := self.answers.get(task):
            return f"Not finished, {answer.told}."
        if task.engine is not None and task.engine.missing:
            return f"Not run here: {task.engine.missing}."
        return "Not run yet: `crosscheck run --full`, then `crosscheck report`."

    def motions(self, cells: Iterable[Cell]) -> dict[Cell, Trajectory]:
        """The stored motions of these cells. Cells that are not run or not finished are left out."""
        answers = ((cell, self.finished(Motion(cell))) for cell in cells)
        return {cell: trajectory_of(answer) for cell, answer in answers if answer is not None}

    def sweep(self, scenes: Iterable[Scene]) -> list[Measurement]:
        return self._of(scenes, "sweep")

    def usual(self, scenes: Iterable[Scene]) -> list[Measurement]:
        """The rows of these scenes at USUAL_STEPS."""
        return self._of(scenes, "usual")

    def _of(self, scenes: Iterable[Scene], purpose: Purpose) -> list[Measurement]:
        names = {scene.name for scene in scenes}
        return [row for cell, row in self.rows.items() if cell.purpose == purpose and cell.scene.name in names]

    def of(self, cells: Iterable[Cell]) -> list[Measurement]:
        return [self.rows[cell] for cell in cells if cell in self.rows]


def usual_series(row: Measurement) -> bool:
    """Whether charts show the method of the row, since it is run in every scene or is a usual variant."""
    from engines.registry import VARIANTS, method_name

    return row.variant in FEATURED or row.method in map(method_name, VARIANTS)


@dataclass(frozen=True)
class Page:
    name: str
    title: str
    lesson: str  # One sentence for the index.
    scenes: tuple[Scene, ...] = ()  # The scenes that the page explains. A scene belongs to only one page.
    engines: tuple[Engine, ...] = ()
    companions: tuple[Scene, ...] = ()  # A run of one of these scenes includes the cells of this page's failures.
    borrowed: tuple[Cell, ...] = ()  # Cells that other pages run and whose rows this page uses.
    # A template, which may extend "base.md". The default is page.md in the folder of the page, else "base.md".
    template: Path | None = None
    failures: tuple[Failure, ...] = ()
    # Whether an engine runs a scene. An engine for a special joint runs only in scenes with this joint.
    compared: Callable[[Scene, Engine], bool] = lambda scene, engine: True
    quantity: str = "angle"  # The quantity whose error is compared and charted.
    advised: str = ""  # The scene for which the page recommends settings, by default the first scene.
    featured: Callable[[Measurement], bool] = usual_series
    figures: Callable[[Material], Mapping[str, str]] = no_context  # Name -> SVG text.
    context: Callable[[Material], Mapping[str, Any]] = no_context  # Variables of the template.
    further: Callable[[Material], Mapping[str, str]] = no_context  # Name -> text of a Markdown file beside the page.
    # (scene, method) -> the order, if the motion changes the order that the engine declares.
    orders: Mapping[tuple[str, str], ConvergenceOrder] = field(default_factory=dict, compare=False)
    # (scene, method, check) -> the known deviation of this check (`reports.model.checks`).
    known: Mapping[tuple[str, str, str], Deviation] = field(default_factory=dict, compare=False)
    tasks: tuple[Task, ...] = ()  # Tasks for pictures and text. Tasks of `failures` are not included.
    cells: tuple[Cell, ...] = ()  # Cells in addition to the grid and the experiments.

    def teaches(self, scene: Scene) -> bool:
        """Whether a scene with this name, perhaps with other parameters, is on the page."""
        return scene.name in {own.name for own in self.scenes}

    def is_run_with(self, scene: Scene) -> bool:
        """Whether a run of the scene includes the cells of failures."""
        return scene.name in {other.name for other in (*self.scenes, *self.companions)}

    @property
    def advised_scene(self) -> Scene | None:
        """The scene for which the page recommends settings, or None on a page without scenes."""
        return next((scene for scene in self.scenes if self.advised in ("", scene.name)), None)

    @property
    def document(self) -> str:
        return f"{self.name}.md"

    def engines_of(self, scene: Scene) -> tuple[Engine, ...]:
        return tuple(engine for engine in self.engines if self.compared(scene, engine))

    def extra_cells(self) -> tuple[Cell, ...]:
        """The cells of the failures and the cells in `cells`, which the grid does not contain."""
        return (*(cell for failure in self.failures for cell in failure.cells), *self.cells)
