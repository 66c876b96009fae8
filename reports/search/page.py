"""The page of a search, from its stored rows alone."""

from __future__ import annotations

import json
import math
import shlex
from collections import Counter
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engines.registry import ENGINES, OTHERS
from reports.model.tasks import Answer
from reports.plots.theme import LIGHT, Theme, new_figure, settings, style_axes, svg
from reports.run.store import Store
from reports.search import plan
from reports.search.chunk import CaseResult, case_results, chunk_from_json, refused, skip_reasons, stored
from reports.search.mechanisms import SHAPES
from reports.search.oracles import LAWS, ORACLES, Oracle, column_of
from reports.search.planted import FAULTS, SIZES, Control, controls
from reports.search.recipe import LEAST_RANK, NEAREST
from reports.search.release import release_of
from reports.search.shrinking import Shrink, line_of, worst_of
from reports.search.subjects import Adapted, Alone, Subject, is_shaped
from reports.write.tables import number
from reports.write.templates import environment

RARE = 0.01  # of all cases: reasons that came up less often are counted together
LEAST, MOST = 1e-17, 1e2  # what an error of exactly zero, and one without a number, is drawn at
LINE = 0.24  # inches


def distribution(cases: Sequence[CaseResult], theme: Theme = LIGHT) -> Figure | None:
    """A line a subject, from the median to the worst error of its law of an instant; None where none was asked."""
    found: dict[str, list[float]] = {}
    for case in cases:
        for law in LAWS:
            if law in case.result.errors:
                found.setdefault(case.chunk.subject.name, []).append(case.result.errors[law][0])
    if not found:
        return None
    with settings():
        figure = new_figure(0.9 + LINE * len(found), theme, 7.0)
        axes = figure.subplots()
        style_axes(axes, theme)
        axes.grid(False, axis="y")
        for place, errors in enumerate(found.values()):
            ordered = np.sort(np.clip(np.nan_to_num(errors, posinf=MOST), LEAST, MOST))
            median, most = ordered[len(ordered) // 2], ordered[math.ceil(0.99 * (len(ordered) - 1))]
            axes.plot([median, ordered[-1]], [place, place], color=theme.first, linewidth=1.2)
            for value, mark, size in ((median, "o", 5), (most, "|", 8), (ordered[-1], ".", 6)):
                axes.plot([value], [place], mark, color=theme.first, markersize=size)
        axes.axvline(1e-9, color=theme.quiet, linewidth=0.8, linestyle=(0, (4, 3)))
        axes.set_yticks(range(len(found)), [f"{name} ({len(errors)})" for name, errors in found.items()])
        axes.set_ylim(len(found) - 0.4, -0.6)
        axes.set_xscale("log")
        axes.set_xlim(LEAST / 3, MOST)
        axes.set_xlabel("relative error; circle: median, bar: 99 %, dot: worst; (cases)")
        axes.minorticks_off()
    return figure


def known_subjects(texts: Sequence[str]) -> list[Subject]:
    """Every engine that is registered, and MuJoCo alone in the releases that these pieces, as JSON, name."""
    releases = dict.fromkeys(release_of(json.loads(text)[0]) for text in texts)
    engines = dict.fromkeys([*ENGINES, *OTHERS, plan.GROOVE.engine])
    return [*(Adapted(engine) for engine in engines), *(Alone(each) for each in releases if each is not None)]


Stored = tuple[list[CaseResult], list[tuple[Shrink, Answer]], Mapping[Control, Answer]]


def read(store: Store, published: bool = False) -> Stored:
    """The cases that are stored for the present sources, the findings among them that were made smaller, and how soon
    planted faults were found; `published`: of the plan alone (`reports.search.plan`), whose seeds nobody chose."""
    texts = store.remembered()
    subjects = known_subjects(texts)
    pieces = [piece for piece in (chunk_from_json(text, subjects) for text in texts) if piece is not None]
    cases = list(case_results(stored(store, plan.published() if published else pieces)))
    tasks = [Shrink.of(check, case) for check, case in worst_of(cases)]
    small, soon = store.answers(tasks), store.answers(controls())
    found = [(task, small[task]) for task in tasks if task in small]
    return cases, found, {task: soon[task] for task in controls() if task in soon}


def files(
    cases: Sequence[CaseResult],
    findings: Sequence[tuple[Shrink, Answer]],
    planted: Mapping[Control, Answer],
    foot: str,
    planned: int = 0,
) -> dict[str, str]:
    """search.md and its picture, by name; nothing of a search that asked nothing. `planned`: 0 for no plan."""
    if not cases:
        return {}
    picture = distribution(cases)
    out = {} if picture is None else {"search_errors.svg": svg(picture, "Errors by engine")}
    page = {
        "cases": len(cases),
        "planned": max(planned, len(cases)),
        "alone": any(isinstance(case.chunk.subject, Alone) for case in cases),
        "cases_a_seed": (plan.CASES, plan.COMPILED),
        "shapes": SHAPES if any(is_shaped(case.chunk.subject) for case in cases) else 0,
        "rank": number(LEAST_RANK, 1),
        "near": number(NEAREST, 1),
        "rule": plan.origin(),
        "seeds": ", ".join(map(str, plan.seeds())),
        "by_rule": {case.chunk.seed for case in cases} <= {*plan.seeds()},
        "questions": [(oracle.column, oracle.question) for oracle in _asked(cases)],
        "asked": _counts(cases),
        "left_out": _skipped(cases),
        "engines": list(dict.fromkeys(task.name for task in planted)),
        "planted": _planted(planted),
        "picture": next(iter(out), ""),
        "found": _found(cases, findings),
    }
    template = environment(Path(__file__).parent).get_template("own/page.md")
    out["search.md"] = template.render(page=page, foot=foot)
    return out


def _asked(cases: Sequence[CaseResult]) -> list[Oracle]:
    """The oracles that are asked by default, and those that these cases were drawn for."""
    drawn = {name for case in cases for name in case.chunk.oracles}
    return [oracle for name, oracle in ORACLES.items() if oracle.is_default or name in drawn]


def _counts(cases: Sequence[CaseResult]) -> list[list[str]]:
    """A line for each subject: cases, those refused, and of each group of checks how many it judged and found wrong."""
    subjects: dict[str, list[CaseResult]] = {}
    columns = [oracle.column for oracle in _asked(cases)]
    for case in cases:
        subjects.setdefault(case.chunk.subject.name, []).append(case)
    out = []
    for name, some in subjects.items():
        judged = Counter(group for case in some for group in {column_of(check) for check in case.result.errors})
        wrong = Counter(group for case in some for group in {column_of(check) for check in case.result.faults})
        marks = {group: f", **{count} wrong**" for group, count in wrong.items()}
        cells = [f"{judged[group]}{marks.get(group, '')}" if judged[group] else "-" for group in columns]
        out.append([name, str(len(some)), str(sum(refused(some).values())), *cells])
    return out


def _skipped(cases: Sequence[CaseResult]) -> list[list[str]]:
    """(question, why it did not apply, cases): the reasons of all subjects together, the rarest in a last line."""
    reasons = skip_reasons(cases)
    often = [reason for reason in reasons if reason[-1] >= RARE * len(cases)]
    rest = sum(count for *_, count in reasons) - sum(count for *_, count in often)
    further = [["all", f"{len(reasons) - len(often)} rarer reasons", str(rest)]] if rest else []
    columns = {name: oracle.column for name, oracle in ORACLES.items()}
    return [[columns.get(name, name), why, str(count)] for name, why, count in often] + further


def _found(cases: Sequence[CaseResult], small: Sequence[tuple[Shrink, Answer]]) -> list[list[str]]:
    """A line for each check of a subject that fails: in how many cases, the smallest mechanism, and the first case."""
    groups: dict[tuple[str, str], list[CaseResult]] = {}
    for case in cases:
        if case.chunk.subject.name != plan.GROOVE.name:
            for check in case.result.faults:
                groups.setdefault((case.chunk.subject.name, check), []).append(case)
    least = {(task.subject.name, task.check): line_of(answer) for task, answer in reversed(small)}
    return [[*key, str(len(some)), least.get(key, ""), f"`{_command(some[0])}`"] for key, some in groups.items()]


def _command(case: CaseResult) -> str:
    """What draws a case again, and writes its script."""
    chunk = case.chunk
    name, variant = ("mujoco", "alone") if isinstance(chunk.subject, Alone) else chunk.subject.name.split(" ", 1)
    words = ["crosscheck", "search", "--engine", name, "--variant", variant, "--seed", str(chunk.seed)]
    words += ["--decades", str(chunk.decades)] if chunk.decades else []
    words += ["--kinds", ",".join(chunk.kinds)] if chunk.kinds != chunk.subject.kinds else []
    return shlex.join([*words, "--cases", str(case.number + 1)])


def _planted(answers: Mapping[Control, Answer]) -> list[list[str]]:
    """A line for each fault: the case that found it in each engine, and how large it had to be if not 1e-6."""
    known = {(task.fault, task.name): _how_soon(answer) for task, answer in answers.items()}
    names = dict.fromkeys(task.name for task in answers)
    return [[fault, *(known.get((fault, name), "") for name in names)] for fault in FAULTS if answers]


def _how_soon(answer: Answer) -> str:
    if not answer.finished:
        return answer.told
    if not answer.number("built"):
        return "not built"
    if not answer.number("asked"):
        return "not asked"
    size = answer.number("size")
    if math.isnan(size):
        return f"not found in {answer.number('asked'):.0f}"
    return f"{answer.number('case') + 1:.0f}{'' if size == SIZES[0] else f' of {number(size, 1)}'}"
