"""Functions that run the judge and the cells of selected cases in worker processes, and check the rows."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any, NamedTuple

from engines import Regularisation
from reference.scene import Scene
from reports.gate.change import (
    DEAR,
    Baseline,
    Old,
    change,
    cost,
    describe_improvements,
    drift,
    growth,
    identity,
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
from reports.run.running import run_cells
from reports.run.supervisor import supervise
from reports.run.worker import worker_count

JUDGE_LIMIT = 600.0  # CPU seconds of one run of the judge. The largest scenes need several minutes.


@dataclass(frozen=True)
class CaseVerdict:
    """The rows of a case, the checks of theory and of change, and for each row the baseline's row or None."""

    case: Case
    rows: tuple[Measurement, ...]
    theory: tuple[Check, ...]
    change: tuple[Check, ...] = ()
    before: tuple[Old | None, ...] = ()

    @property
    def pairs(self) -> tuple[tuple[Measurement, Old], ...]:
        """(row, the baseline's row) for each row that the baseline has."""
        return tuple((row, old) for row, old in zip(self.rows, self.before, strict=False) if old is not None)

    @property
    def new(self) -> int:
        return sum(old is None for old in self.before)

    @property
    def cost(self) -> float:
        """The CPU time divided by that of the baseline, or NaN if unknown."""
        return cost(self.pairs)

    @property
    def theory_complaints(self) -> tuple[str, ...]:
        """Sentences about failed checks, and about known deviations that have changed."""
        return complaints(self.theory, dict(self.case.known), self.rows[-1].outcome)

    @property
    def change_complaints(self) -> tuple[str, ...]:
        return tuple(str(check) for check in self.change if not check.passed)

    @property
    def worst(self) -> Check | None:
        """The check of theory with the largest ratio of value to bound, or None for an unsupported scene."""
        return nearest(self.theory) if self.theory else None


class JudgeRun(NamedTuple):
    scene: Scene
    soft: frozenset[SoftKind] | Regularisation


def judged(job: JudgeRun) -> Prediction | Mapping[str, float]:
    """The prediction for a scene, or its errors with the regularisation of a method."""
    scene, soft = job
    return errors_as_soft(scene, soft) if isinstance(soft, Regularisation) else prediction(scene, soft)


def run_judge(jobs: Iterable[JudgeRun], workers: int) -> dict[JudgeRun, Any]:
    """Run the jobs in worker processes, beginning with the largest mechanisms. Raises RuntimeError if a job fails."""
    ordered = sorted(set(jobs), key=lambda job: -len(mechanism_of(job.scene).bodies))
    results: dict[JudgeRun, Any] = {}
    for job, result, _ in supervise(judged, ordered, JUDGE_LIMIT, workers):
        if isinstance(result, Loss):
            raise RuntimeError(f"the judge on {job.scene.name}: {result.sentence}")
        results[job] = result
    return results


def run_and_check(
    chosen: Iterable[Case], baseline: Baseline, workers: int | None = None, dearest: float | None = None
) -> dict[Case, CaseVerdict]:
    """Run the judge and the cells of these cases in worker processes, and check the rows. workers: number of processes,
    by default one per processor. dearest: limit of the CPU time divided by the baseline's. With this limit runs are
    timed as in a report. Raises RuntimeError if the judge fails."""
    chosen, workers = tuple(chosen), workers or worker_count()
    jobs = {scene: JudgeRun(scene, soft) for scene, soft in predictions(chosen).items()}
    results = run_judge(jobs.values(), workers)
    cells = {case: case.cells() for case in chosen}
    rows = _measured(chain(*cells.values()), workers, dearest is not None)
    measured = {case: tuple(rows[cell] for cell in of_case) for case, of_case in cells.items()}
    judge = {case: results[jobs[case.scene]] for case in chosen}
    softness = {case: own_softness(case, measured[case], judge[case]) for case in chosen}
    soft_jobs = {case: JudgeRun(case.scene, soft) for case, soft in softness.items() if soft is not None}
    results |= run_judge(soft_jobs.values(), workers)
    before = {case: tuple(baseline.cells.get(identity(row)) for row in measured[case]) for case in chosen}
    doubtful = [
        cell
        for case in chosen
        for cell, row, old in zip(cells[case], measured[case], before[case], strict=True)
        if baseline.same_versions and old is not None and moved(row, old, case.amplified)
    ]
    nudged = _measured(chain(*map(nudged_cells, doubtful)), workers)
    out: dict[Case, CaseVerdict] = {}
    for case in chosen:
        changed: list[Check] = []
        for cell, row, old in zip(cells[case], measured[case], before[case], strict=True):
            if old is not None and baseline.same_versions:
                others = [nudged[other] for other in nudged_cells(cell) if other in nudged]
                changed += change(row, old, others, case.amplified)
            elif old is not None:
                changed += drift(row, old)
        changed += vanished(case, before[case])
        as_soft = results[soft_jobs[case]] if case in soft_jobs else None
        theory = checks(case, measured[case], judge[case], as_soft)
        verdict = CaseVerdict(case, measured[case], theory, tuple(changed), before[case])
        if dearest is not None and not math.isnan(verdict.cost):
            costly = Check(CHANGE, "CPU time", verdict.cost, dearest, sentence=" times the baseline's")
            verdict = replace(verdict, change=(*verdict.change, costly))
        out[case] = verdict
    return out


def vanished(case: Case, before: Sequence[Old | None]) -> tuple[Check, ...]:
    """A check that fails if the baseline lacks rows of a case. before: the case's rows in the baseline, from coarse to
    fine steps. The finest steps, and all rows of a third party's scene or engine, may be missing in the baseline.
    Intermediate steps must not be missing."""
    finer = next((index for index, old in enumerate(reversed(before)) if old is not None), None)
    if finer is None:
        lacking = len(before) if case.ours else 0
        reason = ", as the baseline has no row of it: select other cases, or write the baseline again"
    else:
        lacking = sum(old is None for old in before) - finer
        reason = ", as the baseline lacks steps between others: write the baseline again"
    return (Check(CHANGE, "rows", float(lacking), 0.0, sentence=reason),) if lacking else ()


def lost(baseline: Baseline, grid: Iterable[Case]) -> tuple[tuple[str, str], ...]:
    """(scene, method) of the cases that are in the baseline and not in the grid."""
    in_grid = {(case.scene.name, case.method) for case in grid}
    return tuple(
        pair for pair in dict.fromkeys((scene, method) for scene, method, *_ in baseline.cells) if pair not in in_grid
    )


def grown(verdicts: Iterable[CaseVerdict], baseline: Baseline) -> tuple[Check, ...]:
    """The checks of `reports.gate.change.growth`. There are no checks for the versions of the baseline."""
    if baseline.same_versions:
        return ()
    return growth(pair for verdict in verdicts for pair in verdict.pairs)


def remarks(verdict: CaseVerdict) -> tuple[str, ...]:
    """Sentences about improvements and about large CPU times, which do not affect a verdict."""
    known = (sentence for row, old in verdict.pairs for sentence in describe_improvements(row, old))
    dear = (f"{verdict.cost:.3g} times the CPU time of the baseline",) if verdict.cost > DEAR else ()
    return tuple(dict.fromkeys([*known, *dear]))


def _measured(cells: Iterable[Cell], workers: int, timed: bool = False) -> Mapping[Cell, Measurement]:
    by_key = {cell.key: cell for cell in cells}
    rows = {row.key: row for row in run_cells(by_key.values(), workers=workers, timed=timed, supervised=supervise)}
    return {cell: rows[key] for key, cell in by_key.items()}
