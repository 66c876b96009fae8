"""The page of a search, from stored results."""

from __future__ import annotations

import json
import math
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from engines.registry import ENGINES, OTHERS
from reports.model.tasks import Answer
from reports.plots.theme import LIGHT, new_figure, settings, style_axes, svg
from reports.run.store import Store
from reports.search import plan
from reports.search.chunk import (
    CaseResult,
    chunk_from_json,
    count_refusals,
    count_skip_reasons,
    iter_case_results,
    stored_answers,
)
from reports.search.mechanisms import SHAPE_COUNT
from reports.search.planted import FAULT_SIZES, PLANTED_FAULTS, PlantedControl, all_controls
from reports.search.recipe import DEPENDENCE_LIMIT, SINGULAR_LIMIT
from reports.search.release import release_of
from reports.search.shrinking import Shrink, choose_worst, line_of
from reports.search.subjects import LAW_CHECKS, ORACLES, Adapted, Alone, Oracle, Subject, column_of, is_shaped
from reports.write.tables import number
from reports.write.templates import environment

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RARE_SHARE = 0.01  # Skip reasons with a smaller share of all cases are counted together.
AXIS_LEAST, AXIS_MOST = 1e-17, 1e2  # Limits of the axis, to which errors are clipped.
ROW_INCHES = 0.24


def draw_distribution(cases: Sequence[CaseResult]) -> Figure | None:
    """A figure with a line for each subject from the median to the largest error of instants, or None without
    errors."""
    errors_by_subject: dict[str, list[float]] = {}
    for case in cases:
        for law in LAW_CHECKS:
            if law in case.result.errors:
                errors_by_subject.setdefault(case.chunk.subject.name, []).append(case.result.errors[law][0])
    if not errors_by_subject:
        return None
    with settings():
        figure = new_figure(0.9 + ROW_INCHES * len(errors_by_subject), width=7.0)
        axes = figure.subplots()
        style_axes(axes)
        axes.grid(False, axis="y")
        for row, errors in enumerate(errors_by_subject.values()):
            ordered = np.sort(np.clip(np.nan_to_num(errors, posinf=AXIS_MOST), AXIS_LEAST, AXIS_MOST))
            median, most = ordered[len(ordered) // 2], ordered[math.ceil(0.99 * (len(ordered) - 1))]
            axes.plot([median, ordered[-1]], [row, row], color=LIGHT.first, linewidth=1.2)
            for value, mark, size in ((median, "o", 5), (most, "|", 8), (ordered[-1], ".", 6)):
                axes.plot([value], [row], mark, color=LIGHT.first, markersize=size)
        axes.axvline(1e-9, color=LIGHT.quiet, linewidth=0.8, linestyle=(0, (4, 3)))
        axes.set_yticks(
            range(len(errors_by_subject)), [f"{name} ({len(errors)})" for name, errors in errors_by_subject.items()]
        )
        axes.set_ylim(len(errors_by_subject) - 0.4, -0.6)
        axes.set_xscale("log")
        axes.set_xlim(AXIS_LEAST / 3, AXIS_MOST)
        axes.set_xlabel("relative error; circle: median, bar: 99 %, dot: worst; (cases)")
        axes.minorticks_off()
    return figure


def known_subjects(texts: Sequence[str]) -> list[Subject]:
    """All registered engines, and MuJoCo alone in the releases that occur in these chunks (JSON texts)."""
    releases = dict.fromkeys(release_of(json.loads(text)[0]) for text in texts)
    engines = dict.fromkeys([*ENGINES, *OTHERS])
    return [*(Adapted(engine) for engine in engines), *(Alone(release) for release in releases if release is not None)]


Stored = tuple[list[CaseResult], list[tuple[Shrink, Answer]], Mapping[PlantedControl, Answer]]


def read_stored(store: Store, published: bool = False) -> Stored:
    """The stored cases, reduced findings, and controls with planted faults. `published`: only cases of
    `plan.published_chunks`."""
    texts = store.load_references()
    subjects = known_subjects(texts)
    chunks = [chunk for chunk in (chunk_from_json(text, subjects) for text in texts) if chunk is not None]
    cases = list(iter_case_results(stored_answers(store, plan.published_chunks() if published else chunks)))
    tasks = [Shrink.of(check, case) for check, case in choose_worst(cases)]
    small, controls = store.answers(tasks), store.answers(all_controls())
    reduced = [(task, small[task]) for task in tasks if task in small]
    return cases, reduced, {task: controls[task] for task in all_controls() if task in controls}


def render_page(
    cases: Sequence[CaseResult],
    findings: Sequence[tuple[Shrink, Answer]],
    planted: Mapping[PlantedControl, Answer],
    foot: str,
    planned: int = 0,
) -> dict[str, str]:
    """The files search.md and search_errors.svg; empty without cases. `planned`: number of planned cases, or 0."""
    if not cases:
        return {}
    picture = draw_distribution(cases)
    out = {} if picture is None else {"search_errors.svg": svg(picture, "Errors by engine")}
    page = {
        "cases": len(cases),
        "planned": max(planned, len(cases)),
        "alone": any(isinstance(case.chunk.subject, Alone) for case in cases),
        "cases_a_seed": (plan.PLANNED_CASES, plan.COMPILED_CASES),
        "shapes": SHAPE_COUNT if any(is_shaped(case.chunk.subject) for case in cases) else 0,
        "rank": number(DEPENDENCE_LIMIT, 1),
        "near": number(SINGULAR_LIMIT, 1),
        "rule": plan.seed_origin(),
        "seeds": ", ".join(map(str, plan.published_seeds())),
        "by_rule": {case.chunk.seed for case in cases} <= {*plan.published_seeds()},
        "questions": [(oracle.column, oracle.question) for oracle in _shown_oracles(cases)],
        "asked": _count_rows(cases),
        "left_out": _skip_rows(cases),
        "engines": list(dict.fromkeys(task.name for task in planted)),
        "planted": _planted_rows(planted),
        "picture": next(iter(out), ""),
        "found": _finding_rows(cases, findings),
    }
    template = environment(Path(__file__).parent).get_template("own/page.md")
    out["search.md"] = template.render(page=page, foot=foot)
    return out


def _shown_oracles(cases: Sequence[CaseResult]) -> list[Oracle]:
    used = {name for case in cases for name in case.chunk.oracles}
    return [oracle for name, oracle in ORACLES.items() if oracle.is_default or name in used]


def _count_rows(cases: Sequence[CaseResult]) -> list[list[str]]:
    """A row for each subject, with the number of cases, the number of refused cases, and by oracle the judged and
    failed cases."""
    subjects: dict[str, list[CaseResult]] = {}
    columns = [oracle.column for oracle in _shown_oracles(cases)]
    for case in cases:
        subjects.setdefault(case.chunk.subject.name, []).append(case)
    out = []
    for name, some in subjects.items():
        judged = Counter(group for case in some for group in {column_of(check) for check in case.result.errors})
        wrong = Counter(group for case in some for group in {column_of(check) for check in case.result.faults})
        marks = {group: f", **{count} wrong**" for group, count in wrong.items()}
        cells = [f"{judged[group]}{marks.get(group, '')}" if judged[group] else "-" for group in columns]
        out.append([name, str(len(some)), str(sum(count_refusals(some).values())), *cells])
    return out


def _skip_rows(cases: Sequence[CaseResult]) -> list[list[str]]:
    """Rows (oracle, skip reason, number of cases). Rare reasons are counted together in the last row."""
    reasons = count_skip_reasons(cases)
    frequent = [reason for reason in reasons if reason[-1] >= RARE_SHARE * len(cases)]
    rare_count = sum(count for *_, count in reasons) - sum(count for *_, count in frequent)
    rare_row = [["all", f"{len(reasons) - len(frequent)} rarer reasons", str(rare_count)]] if rare_count else []
    columns = {name: oracle.column for name, oracle in ORACLES.items()}
    return [[columns.get(name, name), text, str(count)] for name, text, count in frequent] + rare_row


def _finding_rows(cases: Sequence[CaseResult], small: Sequence[tuple[Shrink, Answer]]) -> list[list[str]]:
    """A row for each failing check of a subject, with the number of cases, the smallest mechanism and a command that
    finds a case."""
    groups: dict[tuple[str, str], list[CaseResult]] = {}
    for case in cases:
        for check in case.result.faults:
            groups.setdefault((case.chunk.subject.name, check), []).append(case)
    smallest = {(task.subject.name, task.check): line_of(answer) for task, answer in reversed(small)}
    return [[*key, str(len(some)), smallest.get(key, ""), f"`{_command(some[0])}`"] for key, some in groups.items()]


def _command(case: CaseResult) -> str:
    chunk = case.chunk
    name, variant = ("mujoco", "alone") if isinstance(chunk.subject, Alone) else chunk.subject.name.split(" ", 1)
    command = ["crosscheck", "search", "--engine", name, "--variant", variant, "--seed", str(chunk.seed)]
    command += ["--decades", str(chunk.decades)] if chunk.decades else []
    command += ["--kinds", ",".join(chunk.kinds)] if chunk.kinds != chunk.subject.kinds else []
    return shlex.join([*command, "--cases", str(case.number + 1)])


def _planted_rows(answers: Mapping[PlantedControl, Answer]) -> list[list[str]]:
    cells = {(task.fault, task.name): _control_cell(answer) for task, answer in answers.items()}
    names = dict.fromkeys(task.name for task in answers)
    return [[fault, *(cells.get((fault, name), "") for name in names)] for fault in PLANTED_FAULTS if answers]


def _control_cell(answer: Answer) -> str:
    """The number of the case that detects a fault, and the size of the fault unless it is the smallest size."""
    if not answer.finished:
        return answer.told
    if not answer.number("built"):
        return "not built"
    if not answer.number("asked"):
        return "not asked"
    size = answer.number("size")
    if math.isnan(size):
        return f"not found in {answer.number('asked'):.0f}"
    return f"{answer.number('case') + 1:.0f}{'' if size == FAULT_SIZES[0] else f' of {number(size, 1)}'}"
