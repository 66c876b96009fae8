"""Tests that each page is readable with any set of rows, that its links are valid and that its programs run."""

from __future__ import annotations

import contextlib
import inspect
import io
import json
import math
import random
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import fields, replace
from functools import cache
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from engines.mujoco.writers import MJCF
from reference.scenes.catalogue import scene as scene_of
from reports.check.pictures import PictureData, Pose
from reports.cli.report import drawn, material_of
from reports.cli.selection import shown_cells
from reports.gate.prediction import all_tasks
from reports.model.catalogue import PAGES, _without_doubles, generic_page, with_scenes
from reports.model.cells import Cell
from reports.model.measure import Measurement, blank, measure
from reports.model.outcomes import Outcome
from reports.model.page import Material, Page, no_context
from reports.model.quantities import QUANTITIES
from reports.model.tasks import Answer, Motion, Task
from reports.pages.common import _written_deviations, scene_page
from reports.pages.engines.examples import ELEMENT_EXAMPLES
from reports.pages.errata import page as referees
from reports.pages.faults.page import Offsets
from reports.pages.findings import findings
from reports.pages.index import render_index, render_readme
from reports.pages.pendulum.page import NeighbourGrowth
from reports.pages.published import experiments as published
from reports.pages.rendering import render_page
from reports.pages.rolling import drawings as rolling_drawings
from reports.pages.skate import experiments as turning_round
from reports.pages.wheels.page import Folding
from reports.pages.your_loop.experiments import BeforeAndAfter
from reports.pages.your_model.page import ModelCheck
from reports.plots import theme
from reports.run.store import Store
from reports.write.experiments import observe
from reports.write.templates import anchor, headings
from reports.write.unmeasured import FILTERS, NOT_MEASURED, UNKNOWN_MARK
from tests import ROOT
from tests.committed_rows import RESULTS, answer_to, page_rows
from tests.toys import Disc, Toy

SUBSETS = 3  # of every page
FAILED = [outcome for outcome in Outcome if not outcome.comparable]
NUMBERS = [f.name for f in fields(Measurement) if f.type == "float" and f.name != "step"]
FROM_ROWS = tuple(page for page in PAGES if shown_cells(page))
# Phrases that a page contains only if an error has a plateau.
PLATEAU = ("however small the step", "at every step", "(plateau ")

Rows = Mapping[Cell, Measurement]


def some(rows: Rows, chance: random.Random) -> Rows:
    """A random selection of the rows; some rows are replaced by failures, and some numbers by NaN."""
    remaining = dict(rows)
    for of in map(attrgetter, ("engine.name", "engine.variant", "scene.name", "every", "purpose")):
        if remaining and chance.random() < 0.3:
            gone = of(chance.choice(list(remaining)))
            remaining = {cell: row for cell, row in remaining.items() if of(cell) != gone}
    share = chance.choice([0.0, 0.1, 0.5, 0.9, 0.99])
    remaining = {cell: row for cell, row in remaining.items() if chance.random() >= share}
    failing, unknown = chance.choice([0.0, 0.1, 0.7, 1.0]), chance.choice([0.0, 0.0, 0.3])
    for cell, row in remaining.items():
        if chance.random() < failing:
            remaining[cell] = blank(cell, chance.choice(FAILED), chance.choice(["", "a reason"]))
        elif chance.random() < unknown:
            remaining[cell] = replace(row, **dict.fromkeys(chance.sample(NUMBERS, 4), math.nan))
    return remaining


def prose(text: str) -> str:
    """The text of a page with CODE in place of code."""
    return re.sub(r"`[^`\n]+`", "CODE", re.sub(r"^```.*?^```$", "CODE", text, flags=re.DOTALL | re.MULTILINE))


def complaints(page: str, files: Mapping[str, str]) -> list[str]:
    """The defects of a page, such as missing numbers, incomplete sentences and dead links."""
    text = prose(files[f"{page}.md"])
    sentences = re.sub(r"^\|.*$", "TABLE", text, flags=re.MULTILINE)
    results = [f"{label} in the text" for label in ("{{", "{%", UNKNOWN_MARK, NOT_MEASURED) if label in text]
    results += [line for line in text.splitlines() if re.search(r"\b(nan|None(?! of)|Undefined|Unmeasured)\b", line)]
    for line in sentences.splitlines():
        if re.search(r"(^|[\s(])[,.;:)](\s|$)", line):
            results.append(f"torn sentence: {line}")
        if re.search(r"(?<!\|) - (rad|m|s|ms|N|off)\b", line):
            results.append(f"no number: {line}")
    results += [f"nothing follows: {match[0]}" for match in re.finditer(r":\n\n+(#.*|\Z)", sentences)]
    displayed = set(re.findall(r"\]\((\w+\.svg)\)", text))
    drawing = {name for name in files if name.endswith(".svg")}
    results += [f"picture without file: {name}" for name in displayed - drawing]
    results += [f"file without picture: {name}" for name in drawing - displayed]
    expected = {page.document for page in PAGES} | {"index.md", "errors.csv", "timings.csv", "descriptions.csv"}
    results += [f"dead link: {name}" for name in set(re.findall(r"\]\((\w+\.(?:md|csv))[)#]", text)) - expected]
    return results


@pytest.fixture
def undrawn(monkeypatch):
    """Replace pictures by empty ones, since drawing is slow."""
    drawn_picture = theme.svg
    for module in [module for name, module in sys.modules.items() if name.startswith("reports")]:
        for name, value in list(vars(module).items()):
            if inspect.isfunction(value) and value.__annotations__.get("return") == "Figure":
                monkeypatch.setattr(module, name, lambda *arguments, **settings: None)
            elif value is drawn_picture:
                monkeypatch.setattr(module, name, lambda figure, title: "<svg/>")
    monkeypatch.setattr(rolling_drawings, "roulettes", lambda: None)


def written(page: Page, rows: Rows, answers: Mapping[Task, Answer] | None = None) -> Mapping[str, str]:
    return render_page(page, Material(rows, answers or {}), "the command")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_a_page_is_readable_with_any_rows_and_answers(page, undrawn):
    rows, tasks, chance = page_rows(page), all_tasks(page), random.Random(page.name)
    failed = {cell: blank(cell, Outcome.FAILED, "RuntimeError: something") for cell in rows}
    for part, answers in (
        ({}, {}),
        (failed, {task: Answer(Outcome.ABORTED, "a signal") for task in tasks}),
        *((some(rows, chance), some_answers(tasks, chance)) for _ in range(SUBSETS)),
    ):
        assert complaints(page.name, written(page, part, answers)) == []


@pytest.mark.parametrize("page", FROM_ROWS[::3], ids=lambda page: page.name)
def test_charts_can_be_drawn_of_a_few_rows_and_of_unknown_numbers(page):
    chance, rows = random.Random(page.name), page_rows(page)
    chosen_rows = {cell: rows[cell] for cell in chance.sample(list(rows), 12)}
    for cell in list(chosen_rows)[::2]:
        chosen_rows[cell] = replace(chosen_rows[cell], **dict.fromkeys(chance.sample(NUMBERS, 6), math.nan))
    for name, text in written(replace(page, failures=(), figures=lambda material: {}), chosen_rows).items():
        assert not name.endswith(".svg") or text.startswith("<?xml")


def test_the_index_is_readable_with_any_rows():
    for seed in range(4):
        materials = {page: Material(some(page_rows(page), random.Random(f"{page.name} {seed}"))) for page in FROM_ROWS}
        text = render_index(materials, "the command")
        drawing = {finding.picture: "<svg/>" for finding in findings(materials)}
        assert complaints("index", {"index.md": text, **drawing}) == [], seed
        readme = render_readme((ROOT / "README.md").read_text(encoding="utf-8"), materials)
        assert "nan" not in readme


@pytest.mark.parametrize("page", FROM_ROWS, ids=lambda page: page.name)
def test_no_clause_is_left_out_if_all_rows_are_there(page, undrawn, monkeypatch):
    vanished: list[str] = []

    def record_clause(clause: str) -> str:
        if UNKNOWN_MARK in clause and not any(text in clause for text in PLATEAU):
            vanished.append(clause)
        return "" if UNKNOWN_MARK in clause else clause

    monkeypatch.setitem(FILTERS, "if_measured", record_clause)
    answers = {task: still(task) for task in all_tasks(page)}
    # Remarks with a context need real motions.
    observed = (
        task
        for failure in page.failures
        if failure.context is not no_context
        for task in failure.tasks
        if not isinstance(task, NeighbourGrowth)  # takes seconds
    )
    material = Material(page_rows(page), answers | {task: answer_to(task) for task in observed})
    assert complaints(page.name, render_page(page, material, "the command")) == []
    assert vanished == []


# Data of a check in which no setting is accurate enough and one run has failed.
STILL = Pose([[[0.0, 0.0], [1.0, 0.0]]], [], [])
ERRORS = {"angle": [0.0, 1e-3]}
SHOWN = PictureData([0.0, 1.0], ERRORS, [0.0, 1.0], ERRORS, [], None, None, 1.0, [[0.0, 0.0]], STILL, STILL)
WALKED = {
    "duration": 2.0,
    "error": 0.5,
    "judge_errors": {"angle": 1e-12},
    "parts": {"softness": 0.1, "step": 0.4, "smallest": 1e-5, "rest": 0.1, "falling": False},
    "opening": {"row": "loop x", "gap": 0.5, "t": 2.0},
    "notes": [],
    "tried": [{"words": "as it is", "error": 0.5, "reaction": None}, {"words": "1 ms", "error": None, "reaction": 0.5}],
    "advised": None,
}


def still(task: Task, lost: bool = False) -> Answer:
    """An invented answer; a motion has bodies at rest. With `lost`, the second half of a motion is NaN."""
    values: dict[str, Any]
    match task:
        case Motion(cell=cell):
            mechanism, times = cell.scene.mechanism(), cell.sample_count + 1
            t = np.linspace(0, cell.scene.duration, times)
            pose, twist = (np.tile(values, (times, 1, 1)) for values in (mechanism.pose, 0 * mechanism.twist))
            values = {"t": t, "pose": pose, "twist": twist, "reaction": np.zeros((times, mechanism.row_count))}
        case referees.Refereed():
            mechanism = referees.QUESTIONS[task.question].mechanism()
            pose, twist = (np.tile(values, (referees.POINTS, 1, 1)) for values in (mechanism.pose, mechanism.twist))
            values = {"pose": pose, "twist": twist}
        case Folding():
            mechanism, t = task.scene.mechanism(), np.linspace(0, task.scene.duration, 30)
            values = {"jackknifed": np.asarray(1.0), "t": t, "pose": np.tile(mechanism.pose, (30, 1, 1))}
        case NeighbourGrowth():
            values = {"growth": np.ones(len(task.times))}
        case Offsets():
            values = {"across": np.full(len(task.offsets), -0.1)}
        case published.NewtonBounds():
            values = {
                name: np.full(len(published.NEWTON_STEPS), bound / 2) for name, bound in published.NEWTON_BOUNDS.items()
            }
        case published.Acrobot() | published.DirectRK4():
            values = dict.fromkeys(("drift", "rounded"), np.full(len(published.ACROBOT_STEPS), 1e-3))
        case ModelCheck():
            values = {"found": json.dumps(WALKED), "shown": SHOWN.as_text()}
        case BeforeAndAfter():
            values = {"gap": np.array([0.1, 0.01]), "angle": np.full(2, 0.1), "iterations": np.asarray(16.0)}
        case _:
            numbers = [*(quantity.name for quantity in QUANTITIES), "error", "expected", "found", "evaluations", "when"]
            values = dict.fromkeys(numbers, np.asarray(0.5)) | dict.fromkeys(("t", "with", "without"), np.ones(2))
            values |= dict.fromkeys((*ELEMENT_EXAMPLES, "reactions", "width", "version", "stopped"), "yes")
    if lost and isinstance(task, (Motion, referees.Refereed)):
        for name in ("pose", "twist"):
            values[name][len(values[name]) // 2 :] = np.nan
    return Answer(Outcome.FINISHED, values=values)


def some_answers(tasks: Iterable[Task], chance: random.Random) -> dict[Task, Answer]:
    """Answers to a random selection of the tasks; some answers are failures."""
    results = {}
    for task in tasks:
        match chance.choice(["missing", "failed", "lost", "still", "still"]):
            case "failed":
                results[task] = Answer(chance.choice(FAILED), chance.choice(["", "a reason"]))
            case "lost" | "still" as kind:
                results[task] = still(task, kind == "lost")
            case _:
                pass
    return results


def test_a_motion_that_is_not_finite_is_reported_in_its_line():
    cell = Motion(turning_round.TURNING_ROUND[0]).cell
    material = Material({}, {Motion(cell): still(Motion(cell))})
    with pytest.raises(ZeroDivisionError):  # an exception in our code is not hidden
        observe(material, cell, "a step", lambda run: f"{1 / 0}")
    missing = Material({}, {Motion(cell): still(Motion(cell), lost=True)})
    [line] = observe(missing, cell, "a step", lambda run: "all is well")
    assert line.outcome == "**diverged**: not finite from 5 s"


# --- shape ---


MECHANISMS = tuple(page for page in FROM_ROWS if page.scenes)


@cache
def texts(page: Page) -> dict[str, str]:
    """The Markdown files of a page, rendered from the committed rows. A caller needs the fixture `undrawn`."""
    return {name: text for name, text in written(page, page_rows(page)).items() if name.endswith(".md")}


@cache
def anchors(file: str) -> frozenset[str]:
    """The anchors of the headings in a file of the results. Raises FileNotFoundError for an unknown file."""
    page = next((page for page in PAGES if file == page.document), None)
    # The index contains all pages.
    text = (RESULTS / file).read_text(encoding="utf-8") if page is None else texts(page)[file]
    return frozenset(anchor(title) for title in headings(text))


def run_program(source: str) -> tuple[dict, str]:
    """The global names and the output of a program."""
    names, printed = {"__name__": "__main__"}, io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(source, "a page", "exec"), names)
    return names, printed.getvalue()


@pytest.mark.parametrize("page", MECHANISMS, ids=lambda page: page.name)
def test_links_of_a_page_have_targets_and_its_programs_run_as_printed(page, undrawn):
    for name, text in texts(page).items():
        for scene in re.findall(r"`crosscheck export (\w+) --to mjcf --variant tuned`", text):
            assert MJCF.write(scene_of(scene).mechanism(), 1e-3, "tuned")
        for target, heading in re.findall(r"\]\((\w+\.md)?#([^)]*)\)", text):
            assert heading in anchors(target or name), (name, target, heading)
        for language, source in re.findall(r"^```(\w*)\n(.*?)^```$", text, re.DOTALL | re.MULTILINE):
            assert language == "python", f"{language}: only programs that run as they are belong on a page"
            assert run_program(source)[1].strip()


def called(name: str) -> Disc:
    """A disc in a scene of this name."""
    return type("Named", (Disc,), {"name": name})()


def test_known_deviations_belong_to_pages_and_a_page_without_an_entry_has_none():
    assert scene_page("a third party's", title="X", lesson="One.", scenes=(Disc(),)).known == {}
    assert {page.name for page in PAGES if page.known} == {*_written_deviations()}


def test_no_two_pages_have_the_same_file_name_and_none_has_that_of_the_index():
    names = ("a/b", "a b")
    pages = with_scenes((), [called(name) for name in names], (Toy(),))
    assert [page.scenes[0].name for page in pages] == list(names)
    assert len({page.document for page in pages}) == len(names)
    assert generic_page(called("index"), (Toy(),)).document == "index_2.md"
    first = Page("x", "X", "One.", (called("one"),), (Toy(),))
    second = replace(first, scenes=(called("two"),))
    remaining, troubles = _without_doubles([first, second, replace(second, name="index")])
    assert remaining == (first,)
    assert [trouble.partition(" is left out")[0] for trouble in troubles] == [
        "crosscheck.pages: the page 'x'",
        "crosscheck.pages: the page 'index'",
    ]


def test_pages_rendered_by_workers_equal_pages_of_one_process(tmp_path: Path) -> None:
    pages = [page for page in PAGES if page.name in ("glossary", "settings")]
    path = tmp_path / "cells.sqlite"
    with Store(path) as store:
        store.put(measure(next(c for c in shown_cells(pages[-1]) if c.engine.name == "pymunk"), repeat=False))
    with Store.read(path) as store:
        material = {page: material_of(page, store) for page in pages}
    built = drawn(material, (), "make report", tmp_path)
    alone = {page.name: render_page(page, values, "make report") for page, values in material.items()}
    assert set(built) == {page.name for page in pages}
    assert built == alone
