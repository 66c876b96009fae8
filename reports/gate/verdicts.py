"""The grid as a gate: every scene in every method, what is promised of it, and what its rows are checked against."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from engines import Engine, Promise, Softness, Unpromised
from engines.motions import is_prescribed
from reference.scene import Scene
from reports.gate.judge import errors_as_soft
from reports.gate.order_check import order
from reports.gate.prediction import Prediction, kinds, prediction
from reports.gate.theory import theory
from reports.model.cells import FULL, QUICK, Cell, mechanism_of, sweep_cells
from reports.model.checks import Check, Deviation
from reports.model.measure import Measurement
from reports.model.outcomes import Outcome
from reports.model.page import Page

# The report's quick steps, and one finer where it is cheap (COST_LIMIT: one run's estimated seconds): the order of a
# fast motion shows only below its time scale.
STEPS = (*QUICK, 3 * QUICK[-1])
COST_LIMIT = 0.5


@dataclass(frozen=True)
class Case:
    """One scene in one method: what is promised, and which checks (by name) are known to be missed."""

    scene: Scene
    engine: Engine
    promise: Promise | Unpromised
    known: tuple[tuple[str, Deviation], ...] = ()

    @property
    def method(self) -> str:
        return f"{self.engine.name} {self.engine.variant}"

    @property
    def label(self) -> str:
        return f"{self.scene.name}-{self.method}"

    @property
    def ours(self) -> bool:
        """Whether scene and engine are those of this suite, whose rows are published."""
        return {type(each).__module__.partition(".")[0] for each in (self.scene, self.engine)} <= {
            "reference",
            "engines",
        }

    @property
    def amplified(self) -> float:
        """How many times the usual rounding of velocities the method carries."""
        return self.promise.amplified if isinstance(self.promise, Promise) else 1.0

    def cells(self) -> tuple[Cell, ...]:
        """What is run of it, coarse steps first.

        In a motion that is prescribed a wrong mass shows in the reactions alone, so those of first order, which are
        wrong by as much as they change in a step, need finer ones.
        """
        mechanism = mechanism_of(self.scene)
        alone = is_prescribed(mechanism) and isinstance(self.promise, Promise) and self.promise.of("reaction") == 1
        rigid = self.engine.softness(mechanism, self.scene.spacing) is None
        steps = FULL if alone and rigid else STEPS
        return sweep_cells((self.scene,), (self.engine,), steps, COST_LIMIT)


def cases(pages: Iterable[Page]) -> tuple[Case, ...]:
    """The grid: what an engine promises of a scene's mechanism, unless the page knows better of that motion."""
    return tuple(
        _case(page, scene, engine) for page in pages for scene in page.scenes for engine in page.engines_of(scene)
    )


def _case(page: Page, scene: Scene, engine: Engine) -> Case:
    method = f"{engine.name} {engine.variant}"
    known = {check: value for (name, own, check), value in page.known.items() if (name, own) == (scene.name, method)}
    promise = page.orders.get((scene.name, method)) or engine.order(mechanism_of(scene))
    return Case(scene, engine, promise, tuple(known.items()))


def predictions(chosen: Iterable[Case]) -> dict[Scene, frozenset]:
    """Scene -> the kinds of softness that these cases ask the judge for."""
    by_scene: dict[Scene, list[Engine]] = {}
    for case in chosen:
        by_scene.setdefault(case.scene, []).append(case.engine)
    return {scene: kinds(scene, engines) for scene, engines in by_scene.items()}


def own_softness(case: Case, rows: Sequence[Measurement], judge: Prediction) -> Softness | None:
    """The softness of a case whose cost no other softness tells of, so that the judge has to run with it; else None.

    Through singular positions nothing is in proportion to softness.
    """
    softness = case.engine.softness(mechanism_of(case.scene), rows[-1].step)
    wanted = isinstance(case.promise, Promise) and Outcome(rows[-1].outcome).comparable
    return softness if wanted and not math.isfinite(judge.give("angle", softness)) else None


def checks(
    case: Case,
    rows: Sequence[Measurement],
    judge: Prediction | None = None,
    as_soft: Mapping[str, float] | None = None,
) -> tuple[Check, ...]:
    """Theory at the finest step and the order over all, of a case's rows from coarse to fine; none if unsupported.

    `judge`: the scene's prediction, `as_soft`: its errors with `own_softness`; worked out here unless they are given.
    """
    if judge is None:
        judge = prediction(case.scene, kinds(case.scene, [case.engine]))
    finest = rows[-1]
    softness = case.engine.softness(mechanism_of(case.scene), finest.step)
    own = own_softness(case, rows, judge)
    if own is not None and as_soft is None:
        as_soft = errors_as_soft(case.scene, own)
    found = theory(judge, case.promise, softness, finest, rows[:-1], as_soft)
    return (*found, *order(case.promise, rows)) if found else ()
