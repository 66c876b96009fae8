"""Walking the grid for a gate: the selected cases' cells in the pool, the judge beside them, and what came of it."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from engines import Softness
from reference.scene import Scene
from reports.gate.change import (
    DEAR,
    Baseline,
    Old,
    change,
    cost,
    drift,
    growth,
    identity,
    known_by_now,
    moved,
    nudged_cells,
)
from reports.gate.judge import errors_as_soft
from reports.gate.prediction import Prediction, SoftKind, prediction
from reports.gate.theory import Case, checks, own_softness, predictions
from reports.model.cells import Cell, mechanism_of
from reports.model.checks import CHANGE, Check, complaints, nearest
from reports.model.measure import Measurement
from reports.model.outcomes import Loss
from reports.run.queue import kin_of
from reports.run.running import run_cells
from reports.run.supervisor import Answer, Supervise, supervise

# The judge's largest scenes take this long [s] on a busy machine.
JUDGE_LIMIT = 600.0


@dataclass(frozen=True)
class CaseVerdict:
    """What a case's rows were checked against: theory and order, the baseline's numbers, and cells it has not.

    `before`: what the baseline knows of each row, None where it lacks it.
    """

    case: Case
    rows: tuple[Measurement, ...]
    theory: tuple[Check, ...]
    change: tuple[Check, ...] = ()
    before: tuple[Old | None, ...] = ()

    @property
    def pairs(self) -> tuple[tuple[Measurement, Old], ...]:
        """The rows that the baseline knows, and what it knows of them."""
        return tuple((row, old) for row, old in zip(self.rows, self.before, strict=False) if old is not None)

    @property
    def new(self) -> int:
        """Rows that the baseline lacks."""
        return sum(old is None for old in self.before)

    @property
    def cost(self) -> float:
        """How many times the baseline's CPU time it took; NaN if that is not known."""
        return cost(self.pairs)

    @property
    def theory_complaints(self) -> tuple[str, ...]:
        """Sentences, none if all is as promised or known."""
        return complaints(self.theory, dict(self.case.known), self.rows[-1].outcome)

    @property
    def change_complaints(self) -> tuple[str, ...]:
        return tuple(str(check) for check in self.change if not check.passed)

    @property
    def worst(self) -> Check | None:
        """The check of theory nearest to its bound; None where the engine can't build the scene."""
        return nearest(self.theory) if self.theory else None


@dataclass(frozen=True)
class Foretold:
    """What the judge is asked: a scene, and the kinds of softness."""

    scene: Scene
    soft: frozenset[SoftKind]

    @property
    def kin(self) -> Scene:
        """As a cell's: what is worked out once a process of a scene's exact motion serves both."""
        return self.scene

    @property
    def label(self) -> str:
        return f"the judge on {self.scene.name}"


@dataclass(frozen=True)
class Either:
    """What a worker does with a cell (`function`), or with a Foretold."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> Any:
        return prediction(item.scene, item.soft) if isinstance(item, Foretold) else self.function(item)


@dataclass(frozen=True)
class Judging:
    """As `supervise`, with the judge's own work beside that of the cells: first of each scene's, scenes as they come.

    found: what the judge said, as it is known. Raises RuntimeError where it fails.
    """

    asked: tuple[Foretold, ...]
    found: dict[Scene, Prediction]

    def __call__(
        self, function: Callable[[Any], Any], items: Iterable[Any], limit: float, *terms: Any
    ) -> Iterator[Answer]:
        items = tuple(items)
        place = {kin: number for number, kin in enumerate(dict.fromkeys(map(kin_of, items)))}
        jobs = [*sorted(self.asked, key=lambda item: place.get(item.scene, len(place))), *items]
        for item, result, note in supervise(Either(function), jobs, max(limit, JUDGE_LIMIT), *terms):
            if not isinstance(item, Foretold):
                yield item, result, note
            elif isinstance(result, Loss):
                raise RuntimeError(f"the judge has no prediction for {item.scene.name}: {result.sentence}")
            else:
                self.found[item.scene] = result


@dataclass(frozen=True)
class Soft:
    """What the judge is asked of a scene with a case's own softness."""

    scene: Scene
    softness: Softness

    @property
    def label(self) -> str:
        return f"the judge on {self.scene.name}, as soft as a method"


def _run(item: Soft) -> Mapping[str, float]:
    return errors_as_soft(item.scene, item.softness)


def _as_soft(asked: Iterable[Soft], workers: int) -> Mapping[Soft, Mapping[str, float]]:
    """The judge's errors, in as many processes; many bodies, which take longest, begin first."""
    items = sorted(set(asked), key=lambda item: -len(mechanism_of(item.scene).bodies))
    told = {item: result for item, result, _ in supervise(_run, items, JUDGE_LIMIT, workers)}
    for item, result in told.items():
        if isinstance(result, Loss):
            raise RuntimeError(f"{item.label}: {result.sentence}")
    return told


def walk(
    chosen: Iterable[Case], baseline: Baseline, workers: int | None = None, dearest: float | None = None
) -> dict[Case, CaseVerdict]:
    """Run what these cases need, in as many processes as there are processors, and check it.

    `dearest`: how many times the baseline's CPU time a case may take; then runs are timed as those of a report are.
    Raises RuntimeError when the judge itself fails.
    """
    chosen, workers = tuple(chosen), workers or os.cpu_count() or 1
    judging = Judging(tuple(Foretold(scene, soft) for scene, soft in predictions(chosen).items()), {})
    cells = {case: case.cells() for case in chosen}
    rows = _measured((cell for own in cells.values() for cell in own), workers, judging, dearest is not None)
    old = baseline.cells
    doubtful = [
        cell
        for case, own in cells.items()
        for cell in own
        if baseline.same_versions
        and (before := old.get(identity(rows[cell]))) is not None
        and moved(rows[cell], before, case.amplified)
    ]
    nudged = _measured((other for cell in doubtful for other in nudged_cells(cell)), workers)
    finished = {case: tuple(rows[cell] for cell in own) for case, own in cells.items()}
    own_soft = {
        case: Soft(case.scene, softness)
        for case, own in finished.items()
        if (softness := own_softness(case, own, judging.found[case.scene])) is not None
    }
    soft = _as_soft(own_soft.values(), workers)
    out: dict[Case, CaseVerdict] = {}
    for case, own in cells.items():
        measured = finished[case]
        before = tuple(old.get(identity(row)) for row in measured)
        changed: list[Check] = []
        for cell, row, then in zip(own, measured, before, strict=True):
            if then is not None and baseline.same_versions:
                others = [nudged[other] for other in nudged_cells(cell) if other in nudged]
                changed += change(row, then, others, case.amplified)
            elif then is not None:
                changed += drift(row, then)
        changed += vanished(case, before)
        told = checks(case, measured, judging.found[case.scene], soft.get(own_soft[case]) if case in own_soft else None)
        verdict = CaseVerdict(case, measured, told, tuple(changed), before)
        if dearest is not None and not math.isnan(verdict.cost):
            costly = Check(CHANGE, "CPU time", verdict.cost, dearest, sentence=" times the baseline's")
            verdict = replace(verdict, change=(*verdict.change, costly))
        out[case] = verdict
    return out


def vanished(case: Case, before: Sequence[Old | None]) -> tuple[Check, ...]:
    """A check that fails where the baseline lacks what it must have had of a case, coarse steps first.

    A baseline that was made with another grid may end at a coarser step, and it knows nothing of somebody else's scene
    or engine. It has no hole below its finest step, and of ours it has each scene in each method.
    """
    first = next((index for index, old in enumerate(reversed(before)) if old is not None), None)
    if first is None:
        lacking = len(before) if case.ours else 0
        told = ", as the baseline has no row of it: select what it has, or write it anew"
    else:
        lacking = sum(old is None for old in before) - first
        told = ", as steps are missing in the baseline between those that it has: write it anew"
    return (Check(CHANGE, "rows", float(lacking), 0.0, sentence=told),) if lacking else ()


def lost(baseline: Baseline, grid: Iterable[Case]) -> tuple[tuple[str, str], ...]:
    """(scene, method) of what a baseline has and a grid lacks."""
    there = {(case.scene.name, case.method) for case in grid}
    return tuple(
        pair for pair in dict.fromkeys((scene, method) for scene, method, *_ in baseline.cells) if pair not in there
    )


def grown(verdicts: Iterable[CaseVerdict], baseline: Baseline) -> tuple[Check, ...]:
    """With other versions: whether a method's errors grew over all its scenes; see `reports.gate.change.growth`."""
    if baseline.same_versions:
        return ()
    return growth(pair for verdict in verdicts for pair in verdict.pairs)


def remarks(verdict: CaseVerdict) -> tuple[str, ...]:
    """Sentences that change no verdict: what is known by now, and a cost that no machine or load explains."""
    known = (told for row, old in verdict.pairs for told in known_by_now(row, old))
    dear = (f"{verdict.cost:.3g} times the CPU time of the baseline",) if verdict.cost > DEAR else ()
    return tuple(dict.fromkeys([*known, *dear]))


def _measured(
    cells: Iterable[Cell], workers: int, supervised: Supervise = supervise, timed: bool = False
) -> Mapping[Cell, Measurement]:
    by_key = {cell.key: cell for cell in cells}
    rows = {row.key: row for row in run_cells(by_key.values(), workers=workers, timed=timed, supervised=supervised)}
    return {cell: rows[key] for key, cell in by_key.items()}
