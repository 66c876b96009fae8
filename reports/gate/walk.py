"""Walking the grid for a gate: the selected cases' cells in the pool, the judge beside them, and what came of it."""

from __future__ import annotations

import math
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
from reports.run.running import run_cells, worker_count
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
class PredictionJob:
    """A prediction to make: of a scene, for these kinds of softness."""

    scene: Scene
    soft: frozenset[SoftKind]

    @property
    def label(self) -> str:
        return f"the judge on {self.scene.name}"

    def __call__(self) -> Prediction:
        return prediction(self.scene, self.soft)


@dataclass(frozen=True)
class SoftPredictionJob:
    """A run of the judge to make: of a scene with a method's own softness."""

    scene: Scene
    softness: Softness

    @property
    def label(self) -> str:
        return f"the judge on {self.scene.name}, as soft as a method"

    def __call__(self) -> Mapping[str, float]:
        return errors_as_soft(self.scene, self.softness)


Job = PredictionJob | SoftPredictionJob


@dataclass(frozen=True)
class CellOrJob:
    """The function that a worker applies to a cell, or to a job of the judge."""

    function: Callable[[Any], Any]

    def __call__(self, item: Any) -> Any:
        return item() if isinstance(item, Job) else self.function(item)


@dataclass(frozen=True)
class WithJobs:
    """As `supervise`, with jobs of the judge before the cells; their results are put into `results`.

    Raises RuntimeError where the judge fails.
    """

    jobs: tuple[Job, ...]
    results: dict[Job, Any]

    def __call__(
        self, function: Callable[[Any], Any], items: Iterable[Any], limit: float, *terms: Any
    ) -> Iterator[Answer]:
        work = CellOrJob(function)
        for item, result, note in supervise(work, [*self.jobs, *items], max(limit, JUDGE_LIMIT), *terms):
            if not isinstance(item, Job):
                yield item, result, note
            elif isinstance(result, Loss):
                raise RuntimeError(f"{item.label}: {result.sentence}")
            else:
                self.results[item] = result


def walk(
    chosen: Iterable[Case], baseline: Baseline, workers: int | None = None, dearest: float | None = None
) -> dict[Case, CaseVerdict]:
    """Run what these cases need, in as many processes as there are processors, and check it.

    `dearest`: how many times the baseline's CPU time a case may take; then runs are timed as those of a report are.
    Raises RuntimeError when the judge itself fails.
    """
    chosen, workers = tuple(chosen), workers or worker_count()
    cells = {case: case.cells() for case in chosen}
    wanted = {scene: PredictionJob(scene, soft) for scene, soft in predictions(chosen).items()}
    results: dict[Job, Any] = {}
    rows = _measured(_all(cells.values()), workers, WithJobs(tuple(wanted.values()), results), dearest is not None)
    judge = {scene: results[job] for scene, job in wanted.items()}
    finished = {case: tuple(rows[cell] for cell in own) for case, own in cells.items()}
    own_soft = {
        case: SoftPredictionJob(case.scene, softness)
        for case, own in finished.items()
        if (softness := own_softness(case, own, judge[case.scene])) is not None
    }
    old = baseline.cells
    doubtful = [
        cell
        for case, own in cells.items()
        for cell in own
        if baseline.same_versions
        and (before := old.get(identity(rows[cell]))) is not None
        and moved(rows[cell], before, case.amplified)
    ]
    # Many bodies take longest, and begin first.
    soft = sorted(set(own_soft.values()), key=lambda job: -len(mechanism_of(job.scene).bodies))
    nudged = _measured(_all(map(nudged_cells, doubtful)), workers, WithJobs(tuple(soft), results))
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
        as_soft = results[own_soft[case]] if case in own_soft else None
        theory = checks(case, measured, judge[case.scene], as_soft)
        verdict = CaseVerdict(case, measured, theory, tuple(changed), before)
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


def _all(groups: Iterable[Iterable[Cell]]) -> Iterator[Cell]:
    return (cell for group in groups for cell in group)


def _measured(
    cells: Iterable[Cell], workers: int, supervised: Supervise, timed: bool = False
) -> Mapping[Cell, Measurement]:
    by_key = {cell.key: cell for cell in cells}
    rows = {row.key: row for row in run_cells(by_key.values(), workers=workers, timed=timed, supervised=supervised)}
    return {cell: rows[key] for key, cell in by_key.items()}
