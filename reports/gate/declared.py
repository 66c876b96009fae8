"""What an engine's own softness costs in a scene, as a page tells it: the judge's soft runs are tasks, kept once."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from engines import Engine
from reference.scene import Scene
from reports.gate.judge import QUANTITY_NAMES
from reports.gate.prediction import DAMPING, Kind, given, kinds, softened
from reports.model.cells import mechanism_of
from reports.model.page import Page
from reports.model.tasks import Answer, Task, Values

# The judge's own steps take minutes for more bodies than this: of those only the gate asks it.
MOST_BODIES = 20
# One stage of the judge [s] for a few bodies, about; a step has four.
STAGE = 1e-3


@dataclass(frozen=True)
class Softened(Task):
    """Largest errors, by quantity, of joints that give way as the judge's own do; see `reports.gate.prediction`."""

    scene: Scene
    rows: tuple[bool, ...]
    complete: bool

    @property
    def cost(self) -> float:
        steps = self.scene.samples * max(1, math.ceil(self.scene.spacing * DAMPING / 2))
        return 4 * STAGE * steps

    @property
    def label(self) -> str:
        soft = "soft joints" if self.complete else "joints without their velocity term"
        return f"{self.scene.name}: {soft}, by the judge"

    def run(self) -> Values:
        return {name: np.array(value) for name, value in softened(self.scene, self.rows, self.complete).items()}


def soft_tasks(scene: Scene, engines: tuple[Engine, ...]) -> tuple[Softened, ...]:
    """What the judge has to run once to tell what these engines declare in a scene; none where it has many bodies."""
    if len(mechanism_of(scene).bodies) > MOST_BODIES:
        return ()
    return tuple(Softened(scene, *kind) for kind in sorted(kinds(scene, engines)))


def declared_error(answers: Mapping[Task, Answer], scene: Scene, engine: Engine, quantity: str, step: float) -> float:
    """What the engine's declared softness alone costs at this step [s]; 0 where it declares none, NaN if not known."""
    mechanism = mechanism_of(scene)
    softness = engine.softness(mechanism, step)
    soft: dict[Kind, dict[str, float]] = {}
    for complete in (True, False):
        rows = softness.rows if softness is not None else ()
        answer = answers.get(Softened(scene, rows, complete))
        if answer is not None and answer.finished:
            soft[rows, complete] = {name: answer.number(name) for name in QUANTITY_NAMES}
    try:
        return given(soft, quantity, softness, mechanism.holonomic.tolist())
    except KeyError:  # the judge was not asked, or failed
        return math.nan


def all_tasks(page: Page) -> tuple[Task, ...]:
    """The tasks of a page, of its experiments, and of what its engines declare, each once."""
    experiments = [task for failure in page.failures for task in failure.tasks]
    declared = [task for scene in page.scenes for task in soft_tasks(scene, page.engines_of(scene))]
    return tuple(dict.fromkeys([*page.tasks, *experiments, *declared]))
