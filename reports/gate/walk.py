"""Run the grid for a gate: the judge and the cells of the selected cases in worker processes, then all checks."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Any

from engines import Regularisation
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
from reports.run.supervisor import supervise

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
class JudgeRun:
    """A run of the judge: the prediction for a scene and kinds of softness, or its errors with a method's softness."""

    scene: Scene
    soft: frozenset[SoftKind] | Regularisation

    def __call__(self) -> Prediction | Mapping[str, float]:
        if isinstance(self.soft, Regularisation):
            return errors_as_soft(self.scene, self.soft)
        return prediction(self.scene, self.soft)


def call(job: JudgeRun) -> Any:
    """The function that a worker applies."""
    return job()


def run_judge(jobs: Iterable[JudgeRun], workers: int) -> dict[JudgeRun, Any]:
    """The result of every job, in worker processes, many bodies first. Raises RuntimeError where the judge fails."""
    ordered = sorted(set(jobs), key=lambda job: -len(mechanism_of(job.scene).bodies))
    results: dict[JudgeRun, Any] = {}
    for job, result, _ in supervise(call, ordered, JUDGE_LIMIT, workers):
        if isinstance(result, Loss):
            raise RuntimeError(f"the judge on {job.scene.name}: {result.sentence}")
        results[job] = result
    return results


def walk(
    chosen: Iterable[Case], baseline: Baseline, workers: int | None = None, dearest: float | None = None
) -> dict[Case, CaseVerdict]:
    """Run what these cases need, in as many processes as there are processors, and check it.

    `dearest`: how many times the baseline's CPU time a case may take; then runs are timed as those of a report are.
    Raises RuntimeError when the judge itself fails.
    """
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
        found = checks(case, measured[case], judge[case], as_soft)
        verdict = CaseVerdict(case, measured[case], found, tuple(changed), before[case])
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


def _measured(cells: Iterable[Cell], workers: int, timed: bool = False) -> Mapping[Cell, Measurement]:
    by_key = {cell.key: cell for cell in cells}
    rows = {row.key: row for row in run_cells(by_key.values(), workers=workers, timed=timed, supervised=supervise)}
    return {cell: rows[key] for key, cell in by_key.items()}
