"""Whether the grid's gates notice a wrong model: right and wrong at the same steps, from coarse to fine."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from engines import Engine, method_name
from reference.scene import Scene
from reports.gate.change import Old, moved
from reports.gate.prediction import Prediction, kinds, prediction
from reports.gate.theory import Case, checks
from reports.model.catalogue import PAGES
from reports.model.cells import FULL, Cell, estimated_cost
from reports.model.measure import Measurement, measure
from reports.model.outcomes import Outcome
from reports.model.quantities import QUANTITIES
from tests.wrong.mistakes import Mistake, mistaken


@dataclass(frozen=True)
class Trial:
    """Mistakes of one relative size in a scene and engine, in runs that are estimated to step `limit` [s] at most."""

    scene: Scene
    engine: Engine
    relative: float
    mistakes: tuple[Mistake, ...]
    limit: float

    @property
    def method(self) -> str:
        return method_name(self.engine)


@dataclass(frozen=True)
class Sighting:
    """What noticed a mistake: the check of theory that the wrong model fails and the right one passes, "" without one.

    `every`: the last number of steps a sample that was tried. `changed`: whether at any of them the gate of change sees
    another row than the right model's. `shift`: the largest difference between an error and the right model's (in m,
    rad, and per s; relative), at the step where the right model's largest error, `noise`, is least.
    """

    check: str = ""
    every: int = 0
    changed: bool = False
    shift: float = math.inf
    noise: float = math.inf

    def after(self, every: int, right: Measurement, wrong: Measurement, amplified: float) -> Sighting:
        """This and one more step, at which nothing has noticed the mistake yet."""
        before = Old(Outcome(right.outcome), {quantity.name: getattr(right, quantity.name) for quantity in QUANTITIES})
        out = replace(self, every=every, changed=self.changed or moved(wrong, before, amplified))
        noise = max((abs(error) for error in before.errors.values() if not math.isnan(error)), default=0.0)
        return replace(out, shift=shift(right, wrong), noise=noise) if noise < self.noise else out


def shift(right: Measurement, wrong: Measurement) -> float:
    """The largest difference between two rows' errors; infinite if they end differently or know different ones."""
    pairs = [(getattr(right, quantity.name), getattr(wrong, quantity.name)) for quantity in QUANTITIES]
    if right.outcome != wrong.outcome or any(math.isnan(one) != math.isnan(other) for one, other in pairs):
        return math.inf
    return max((abs(one - other) for one, other in pairs if not math.isnan(one)), default=0.0)


def noticed(trials: Sequence[Trial]) -> tuple[Mapping[Mistake, Sighting], ...]:
    """What noticed the mistakes of trials in one scene, in their order: the judge works the scene out once."""
    scene = trials[0].scene
    judge = prediction(scene, kinds(scene, [trial.engine for trial in trials]))
    return tuple(sightings(trial, judge) for trial in trials)


def sightings(trial: Trial, judge: Prediction) -> Mapping[Mistake, Sighting]:
    """Every mistake with what noticed it. Empty where the engine can't build the scene.

    Runs at finer and finer steps, those alone which nothing has noticed yet. In the grid a wrong engine is wrong at
    every step, so a wrong row is judged with the coarser wrong ones.
    """
    scene, engine = trial.scene, trial.engine
    page = next(page for page in PAGES if scene.name in {each.name for each in page.scenes})
    promise = page.orders.get((scene.name, trial.method)) or engine.order(scene.mechanism())
    case = Case(scene, engine, promise)
    found: dict[Mistake, Sighting] = {}
    waiting = {mistake: Sighting() for mistake in trial.mistakes}
    rights: list[Measurement] = []
    wrongs: dict[Mistake, list[Measurement]] = {mistake: [] for mistake in trial.mistakes}
    for every in FULL:
        cell = Cell(scene, engine, every)
        if not waiting or (rights and estimated_cost(cell) > trial.limit):
            break
        right = measure(cell, repeat=False)
        if right.outcome == Outcome.UNSUPPORTED:
            return {}
        rights.append(right)
        held = {(check.name, check.quantity) for check in checks(case, rights, judge) if check.passed}
        for mistake, before in tuple(waiting.items()):
            wrong = measure(replace(cell, engine=mistaken(engine, mistake, trial.relative)), repeat=False)
            wrongs[mistake].append(wrong)
            waiting[mistake] = before.after(every, right, wrong, case.amplified)
            told = [check for check in checks(case, wrongs[mistake], judge) if (check.name, check.quantity) in held]
            failed = [check for check in told if not check.passed]
            if failed:
                worst = max(failed, key=lambda check: check.nearness)
                found[mistake] = replace(waiting.pop(mistake), check=str(worst))
    return found | waiting
